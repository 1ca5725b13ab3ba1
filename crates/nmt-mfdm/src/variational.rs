//! The variational formulation: blended trial functions, linear hats as test functions; paper, eq. (18) \[D13\].

use crate::blend::barycentric_gradients;
use crate::parallel::map_chunks;
use crate::stencils::Stencils;
use crate::system::{LinearSystem, Roles, RowSum, SplitRow};
use crate::weak::{Gathered, WeakForm};
use nmt_geom::{NodeId, TriId};
use nmt_tri::{Mesh, NodeTris};

/// One equation a interior node: ∫∇F·∇v = 2∫v (Gθ = 1) with the node's hat v.
pub(crate) fn assemble(mesh: &Mesh, stencils: &Stencils, node_tris: &NodeTris, roles: &Roles) -> LinearSystem {
    struct Equation {
        row: SplitRow,
        rhs: f64,
    }
    let n_nodes = mesh.cloud().n_nodes();
    let weak = WeakForm::new(mesh, stencils);
    let pieces = map_chunks(mesh.cloud().n_boundary()..n_nodes, |piece| {
        let (mut sum, mut gathered) = (RowSum::new(n_nodes), Gathered::default());
        let equation = |node: usize| {
            let tris = node_tris.around(NodeId::of(node));
            let slopes = tris.iter().map(|&t| (t, hat_slope(mesh, t, NodeId::of(node))));
            weak.add(slopes, &mut gathered, &mut sum);
            // ∫v is a third of the areas around; twice that on the right.
            let rhs = tris.iter().map(|&t| mesh.area(t)).sum::<f64>() * 2.0 / 3.0;
            Equation { row: sum.take(roles), rhs }
        };
        piece.map(equation).collect::<Vec<_>>()
    });
    let mut system = LinearSystem::new(roles.n_holes);
    pieces.into_iter().flatten().for_each(|equation| system.push(&equation.row, equation.rhs));
    system
}

/// Gradient on `triangle` of the hat of one of its nodes.
fn hat_slope(mesh: &Mesh, triangle: TriId, node: NodeId) -> [f64; 2] {
    let corner = mesh.tri_nodes()[triangle.index()].iter().position(|n| *n == node);
    corner.map_or([0.0; 2], |corner| barycentric_gradients(mesh.corners(triangle))[corner])
}
