//! The variational formulation with linear hats as test functions, and linear finite elements; paper, eq. (18) \[D13\].

use crate::assembly::{Setting, dirichlet_row};
use crate::blend::barycentric_gradients;
use crate::error::MfdmError;
use crate::system::{Equation, LinearSystem, RowSum};
use crate::weak::{Gathered, WeakForm};
use nmt_geom::{NodeId, TriId};
use nmt_tri::Mesh;

/// One equation an unknown: ∫∇u·∇v = ∫s·v + ∫q·v with the node's hat v.
pub(crate) fn assemble(setting: &Setting, weak: &WeakForm) -> Result<LinearSystem, MfdmError> {
    let Setting { mesh, roles, node_tris, source, fluxes, .. } = setting;
    let n_nodes = mesh.cloud().n_nodes();
    LinearSystem::of_pieces(roles, |piece| {
        let (mut sum, mut gathered) = (RowSum::new(n_nodes), Gathered::default());
        let equation = |k: usize| {
            let node = roles.node(k);
            if let Some(equation) = dirichlet_row(setting, node, &mut sum)? {
                return Ok(equation);
            }
            let around = node_tris.around(node);
            let slopes = around.iter().map(|&t| (t, hat_slope(mesh, t, node)));
            weak.add(slopes, &mut gathered, &mut sum);
            let rhs = source.with_hat(mesh, &setting.source_rule, fluxes, node, around)?;
            Ok(Equation { row: sum.take(roles), rhs })
        };
        LinearSystem::of(roles, piece.map(equation))
    })
}

/// Gradient on `triangle` of the hat of one of its nodes.
fn hat_slope(mesh: &Mesh, triangle: TriId, node: NodeId) -> [f64; 2] {
    let corner = mesh.tri_nodes()[triangle.index()].iter().position(|n| *n == node);
    corner.map_or([0.0; 2], |corner| barycentric_gradients(mesh.corners(triangle))[corner])
}
