//! What the files hold of a solved subdomain, whatever was solved.

use crate::pipeline::{MeshPart, PoissonPart, Solved, SolvedPart};
use nmt_geom::NodeId;
use nmt_mfdm::{StarDiagnostics, Stress, residuals};

/// The arrays of one solved subdomain.
#[derive(Clone, Debug)]
pub struct NodeFields<'a> {
    /// The subdomain with its mesh.
    pub(crate) part: &'a MeshPart,
    /// Name and values at nodes, each of shape (n_nodes,), the same names in every subdomain.
    pub(crate) at_nodes: Vec<(&'static str, Vec<f64>)>,
    /// Residual of the differential equation at centroids, shape (n_triangles,).
    pub(crate) residual: Vec<f64>,
    /// What each triangle contributes to the error estimate, shape (n_triangles,).
    pub(crate) error_indicator: Option<Vec<f64>>,
    /// The star of each node in the equations; empty for finite elements.
    pub(crate) stars: Vec<StarDiagnostics>,
}

impl<'a> NodeFields<'a> {
    /// Of torsion: `F, tau_zx, tau_zy, tau`, τ from the node's own polynomial, and |∇²F + 2Gθ|.
    pub fn of_torsion(solved: &'a SolvedPart) -> Self {
        let SolvedPart { part, solution, estimate, .. } = solved;
        let nodes = (0..part.mesh.cloud().n_nodes()).map(NodeId::of);
        let stresses: Vec<Stress> = nodes.map(|node| solution.stress_at_node(node)).collect();
        let of_stress = |of: fn(&Stress) -> f64| stresses.iter().map(of).collect();
        Self {
            part,
            at_nodes: vec![
                ("F", solution.f.clone()),
                ("tau_zx", of_stress(|stress| stress.zx)),
                ("tau_zy", of_stress(|stress| stress.zy)),
                ("tau", of_stress(|stress| stress.magnitude())),
            ],
            residual: residuals(&part.mesh, &solution.field, solution.g_theta),
            error_indicator: estimate.made().map(|estimate| estimate.indicators.clone()),
            stars: solution.used_stars.diagnostics(&part.mesh),
        }
    }

    /// Of a Poisson problem: `u, u_x, u_y`, the gradient from the node's own polynomial, and |∇²u − f|; where the exact
    /// solution is given, `exact` and `error`, u less that.
    pub fn of_poisson(solved: &'a PoissonPart) -> Self {
        let PoissonPart { part, solution, data, .. } = solved;
        let gradients = solved.gradients();
        let along = |axis: usize| gradients.iter().map(|gradient| gradient[axis]).collect();
        let mut at_nodes = vec![("u", solution.u.clone()), ("u_x", along(0)), ("u_y", along(1))];
        if let (Some(errors), Some(error)) = (&solved.errors, solved.error_at_nodes()) {
            at_nodes.extend([("exact", errors.exact.clone()), ("error", error)]);
        }
        Self {
            part,
            at_nodes,
            residual: solution.residuals(&part.mesh, |p| data.settings.source.at(p)),
            error_indicator: None,
            stars: solution.used_stars.diagnostics(&part.mesh),
        }
    }

    /// Of whatever was solved.
    pub fn of(solved: &'a Solved) -> Vec<Self> {
        match solved {
            Solved::Torsion(parts) => parts.iter().map(Self::of_torsion).collect(),
            Solved::Poisson(parts) => parts.iter().map(Self::of_poisson).collect(),
        }
    }
}
