//! The variational formulation with linear hats as test functions, and linear finite elements; paper, eq. (18) \[D13\].

use crate::assembly::{Frame, Setting, dirichlet_row};
use crate::blend::barycentric_gradients;
use crate::error::MfdmError;
use crate::system::{Equation, LinearSystem, RowSum};
use crate::weak::{Gathered, WeakForm};
use nmt_geom::{NodeId, TriId};
use nmt_tri::{Mesh, NodeTris};

/// One equation an unknown: ∫∇u·∇v = ∫s·v + ∫q·v with the node's hat v.
pub(crate) fn assemble(setting: &Setting, weak: &WeakForm) -> Result<LinearSystem, MfdmError> {
    LinearSystem::of_pieces(setting.frame.roles, |piece| {
        let mut maker = EquationMaker::new(setting, weak);
        LinearSystem::of(setting.frame.roles, piece.map(|k| maker.of(k)))
    })
}

/// Makes equations; one a thread, with room to be used again.
pub(crate) struct EquationMaker<'a> {
    setting: &'a Setting<'a>,
    weak: &'a WeakForm<'a>,
    sum: RowSum,
    gathered: Gathered,
}

impl<'a> EquationMaker<'a> {
    pub fn new(setting: &'a Setting<'a>, weak: &'a WeakForm<'a>) -> Self {
        let sum = RowSum::new(setting.frame.mesh.cloud().n_nodes());
        Self { setting, weak, sum, gathered: Gathered::default() }
    }

    /// The equation of unknown `k`.
    ///
    /// # Errors
    /// [`MfdmError::Datum`] where the source is not finite.
    pub fn of(&mut self, k: usize) -> Result<Equation, MfdmError> {
        let Frame { mesh, roles, node_tris, source, fluxes, source_rule } = self.setting.frame;
        let node = roles.node(k);
        if let Some(equation) = dirichlet_row(self.setting, node, &mut self.sum)? {
            return Ok(equation);
        }
        let around = node_tris.around(node);
        let slopes = around.iter().map(|&t| (t, hat_slope(mesh, t, node)));
        self.weak.add(slopes, &mut self.gathered, &mut self.sum);
        let rhs = source.with_hat(mesh, source_rule, fluxes, node, around)?;
        Ok(Equation { row: self.sum.take(roles), rhs })
    }
}

/// ∫|∇v|² of a node's hat.
pub(crate) fn hat_energy(mesh: &Mesh, node_tris: &NodeTris, node: NodeId) -> f64 {
    let of_triangle = |&t: &TriId| {
        let slope = hat_slope(mesh, t, node);
        mesh.area(t) * (slope[0] * slope[0] + slope[1] * slope[1])
    };
    node_tris.around(node).iter().map(of_triangle).sum()
}

/// Gradient on `triangle` of the hat of one of its nodes.
fn hat_slope(mesh: &Mesh, triangle: TriId, node: NodeId) -> [f64; 2] {
    let corner = mesh.tri_nodes()[triangle.index()].iter().position(|n| *n == node);
    corner.map_or([0.0; 2], |corner| barycentric_gradients(mesh.corners(triangle))[corner])
}
