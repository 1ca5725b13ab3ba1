//! Poisson problems with data of the user's: ∇²u = f, u = g or ∂u/∂n = q on the edges; and the error against a known u.

use crate::blend::{FieldValue, NodalPolynomials, place};
use crate::boundary_value::{Discrete, solve_discrete};
use crate::diagnostics::UsedStars;
use crate::error::MfdmError;
use crate::flux::{Flux, Fluxes};
use crate::gauss::{Rule, seven_points};
use crate::parallel::map_chunks;
use crate::params::SolveParams;
use crate::post::residuals_against;
use crate::solve::{Event, Stage};
use crate::solver::{LinearSolve, TARGET};
use crate::source::Source;
use crate::stencils::StarReport;
use crate::system::NodeCondition;
use nmt_cloud::Section;
use nmt_geom::{NodeId, Point, TriId};
use nmt_tri::Mesh;

/// ∇²u = f in a section; on each edge u = g, or ∂u/∂n = q with n outward (out of the material, into a hole).
#[derive(Clone)]
pub struct PoissonProblem<'a> {
    /// f.
    pub source: &'a (dyn Fn(Point) -> f64 + Sync),
    /// g, on the edges without a flux.
    pub boundary: &'a (dyn Fn(Point) -> f64 + Sync),
    /// q of each edge, by [`nmt_geom::EdgeId`] (the contour's edges, then each hole's); `None`, or none at all, for u = g.
    pub fluxes: Vec<Option<Flux<'a>>>,
    /// The section the mesh was made from: the true edges, which fluxes are integrated along.
    pub section: &'a Section,
}

/// A Poisson problem solved.
#[derive(Clone, Debug, PartialEq)]
pub struct PoissonSolution {
    /// u at the nodes, shape (n_nodes,).
    pub u: Vec<f64>,
    /// The recovered field \[D14\].
    pub field: NodalPolynomials,
    /// Number of unknowns.
    pub unknowns: usize,
    /// How the linear system was solved.
    pub linear: LinearSolve,
    /// What became of the stars of the equations.
    pub stars: StarReport,
    /// The star of each node in the equations, to be looked at.
    pub used_stars: UsedStars,
}

/// Errors of a solution against the exact one, or of its gradient; below, u stands for either.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ErrorNorms {
    /// Largest |u_i − u(x_i)| over nodes.
    pub max: f64,
    /// (∫|u_h − u|²)^½ of the recovered field.
    pub l2: f64,
    /// Largest |u| over nodes, to make them relative.
    pub scale: f64,
    /// (∫|u|²)^½.
    pub l2_scale: f64,
}

/// Solves a Poisson problem on a mesh.
///
/// Dirichlet values are those at the nodes; a node between an edge with a value and one with a flux has the value. In the
/// variational form fluxes are integrated over the true edges, and the weak form over the slivers between them and the
/// polygon too; in the local form ∇²u = f holds at nodes with a flux as it does inside, and their polynomials meet
/// n·∇u = q with the true normal \[D15\] (at a corner between two such edges both, at a smoother vertex their sum, at a cusp their
/// difference).
///
/// # Errors
/// [`MfdmError`] where a datum is not finite, no edge has a value, or as for torsion ([`crate::solve`]).
///
/// ```
/// use nmt_cloud::{CloudParams, Section, generate};
/// use nmt_curve::Outline;
/// use nmt_mfdm::{PoissonProblem, SolveParams, solve_poisson};
/// use nmt_tri::Mesh;
///
/// let section = Section::solid(Outline::circle([0.0, 0.0], 1.0));
/// let cloud = generate(&section, &CloudParams { nodes: [21, 21], irregularity: 0.2, ..CloudParams::default() })?;
/// let mesh = Mesh::constrained(cloud)?;
/// let exact = |p: [f64; 2]| 3.0 * p[0] * p[0] - 2.0 * p[0] * p[1] + p[1];
/// let problem = PoissonProblem { source: &|_| 6.0, boundary: &exact, fluxes: vec![], section: &section };
/// let solution = solve_poisson(&problem, &mesh, &SolveParams::default())?;
/// assert!(solution.errors(&mesh, exact).max < 1e-12); // order 2 meets a quadratic
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn solve_poisson(
    problem: &PoissonProblem,
    mesh: &Mesh,
    params: &SolveParams,
) -> Result<PoissonSolution, MfdmError> {
    solve_poisson_observed(problem, mesh, params, &mut |_| {})
}

/// [`solve_poisson`], telling `observer` the beginning and the end of each stage, and within stages how far they are.
///
/// # Errors
/// As [`solve_poisson`].
pub fn solve_poisson_observed(
    problem: &PoissonProblem,
    mesh: &Mesh,
    params: &SolveParams,
    observer: &mut dyn FnMut(Event),
) -> Result<PoissonSolution, MfdmError> {
    let (solved, field) = problem.with_discrete(mesh, |discrete| solve_discrete(discrete, params, observer))?;
    observer(Event::Ended(Stage::Post));
    if solved.values.iter().any(|u| !u.is_finite()) {
        return Err(MfdmError::Singular { n: solved.unknowns });
    }
    Ok(PoissonSolution {
        u: solved.values,
        field,
        unknowns: solved.unknowns,
        linear: solved.linear,
        stars: solved.stars,
        used_stars: solved.used_stars,
    })
}

impl PoissonProblem<'_> {
    /// What `work` makes of the problem with its conditions and fluxes on a mesh.
    pub(crate) fn with_discrete<T>(
        &self,
        mesh: &Mesh,
        work: impl FnOnce(Discrete) -> Result<T, MfdmError>,
    ) -> Result<T, MfdmError> {
        let conditions = self.conditions(mesh)?;
        let is_free = |node: &usize| conditions[*node] == NodeCondition::Flux;
        let free: Vec<NodeId> = (0..conditions.len()).filter(is_free).map(NodeId::of).collect();
        let fluxes = Fluxes::new(mesh, self.section, &self.fluxes, &free)?;
        work(Discrete { mesh, conditions, source: Source::Minus(self.source), fluxes: &fluxes, target: TARGET })
    }

    /// The condition at each boundary node.
    fn conditions(&self, mesh: &Mesh) -> Result<Vec<NodeCondition>, MfdmError> {
        let cloud = mesh.cloud();
        let n_edges = self.section.n_edges();
        let found = cloud.boundary().segments().iter().map(|s| s.edge.index() + 1).max().unwrap_or(0);
        if found > n_edges || self.fluxes.len() > n_edges {
            return Err(MfdmError::Conditions { found, given: n_edges.max(self.fluxes.len()) });
        }
        let has_flux = |edge: usize| self.fluxes.get(edge).is_some_and(Option::is_some);
        // A segment without a flux gives both its nodes their value.
        let mut is_free = vec![true; cloud.n_boundary()];
        for segment in cloud.boundary().segments().iter().filter(|s| !has_flux(s.edge.index())) {
            [segment.from, segment.to].iter().for_each(|node| is_free[node.index()] = false);
        }
        if is_free.iter().all(|free| *free) {
            return Err(MfdmError::NoValue);
        }
        let condition = |(node, free): (usize, bool)| {
            let (at, value) = (cloud.xy()[node], (self.boundary)(cloud.xy()[node]));
            match (free, value.is_finite()) {
                (true, _) => Ok(NodeCondition::Flux),
                (false, true) => Ok(NodeCondition::Value(value)),
                (false, false) => Err(MfdmError::Datum { quantity: "boundary value", at, value }),
            }
        };
        is_free.into_iter().enumerate().map(condition).collect()
    }
}

impl PoissonSolution {
    /// Errors against the exact solution.
    pub fn errors(&self, mesh: &Mesh, exact: impl Fn(Point) -> f64 + Sync) -> ErrorNorms {
        let at_node = |node: NodeId, p: Point| {
            let u = exact(p);
            Compared { error: (self.u[node.index()] - u).abs(), size: u.abs() }
        };
        let inside = |field: &FieldValue, p: Point| {
            let u = exact(p);
            Compared { error: (field.value - u).abs(), size: u.abs() }
        };
        self.norms(mesh, at_node, inside)
    }

    /// Errors of the gradient against the exact one: `l2` is the H¹ seminorm of the error.
    pub fn gradient_errors(&self, mesh: &Mesh, exact: impl Fn(Point) -> [f64; 2] + Sync) -> ErrorNorms {
        let compared = |found: [f64; 2], p: Point| {
            let g = exact(p);
            Compared { error: (found[0] - g[0]).hypot(found[1] - g[1]), size: g[0].hypot(g[1]) }
        };
        let at_node = |node: NodeId, p: Point| compared(self.field.at_node(node).gradient, p);
        self.norms(mesh, at_node, |field, p| compared(field.gradient, p))
    }

    /// |∇²u − f| of the recovered field at the centroid of every triangle.
    pub fn residuals(&self, mesh: &Mesh, source: impl Fn(Point) -> f64 + Sync) -> Vec<f64> {
        residuals_against(mesh, &self.field, source)
    }

    fn norms(
        &self,
        mesh: &Mesh,
        at_node: impl Fn(NodeId, Point) -> Compared,
        inside: impl Fn(&FieldValue, Point) -> Compared + Sync,
    ) -> ErrorNorms {
        let rule = Rule::of(12).unwrap_or_else(seven_points);
        let squares = map_chunks(0..mesh.n_triangles(), |piece| {
            let mut sums = [0.0; 2];
            for t in piece.map(TriId::of) {
                let corners = mesh.corners(t);
                for (lambda, weight) in rule.points.iter().zip(&rule.weights) {
                    let p = place(corners, *lambda);
                    let Compared { error, size } = inside(&self.field.blend(mesh, t, p), p);
                    sums[0] += weight * mesh.area(t) * error * error;
                    sums[1] += weight * mesh.area(t) * size * size;
                }
            }
            sums
        });
        let total = |k: usize| squares.iter().map(|sums| sums[k]).sum::<f64>().sqrt();
        let mut norms = ErrorNorms { max: 0.0, scale: 0.0, l2: total(0), l2_scale: total(1) };
        for (node, p) in mesh.xy().iter().enumerate() {
            let Compared { error, size } = at_node(NodeId::of(node), *p);
            (norms.max, norms.scale) = (largest(norms.max, error), largest(norms.scale, size));
        }
        norms
    }
}

/// A found value beside the exact one.
struct Compared {
    error: f64,
    size: f64,
}

/// The larger of two; NaN, which is no value at all, wins.
fn largest(a: f64, b: f64) -> f64 {
    if a.is_nan() || a > b { a } else { b }
}
