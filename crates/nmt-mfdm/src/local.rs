//! The local formulation: one equation a interior node, ∇²F = −2Gθ; paper, eq. (17).

use crate::basis::row;
use crate::parallel::map_chunks;
use crate::stencils::Stencils;
use crate::system::{LinearSystem, Roles, SplitRow};
use nmt_geom::NodeId;
use nmt_tri::Mesh;

/// Collocates −∇²F = 2 (Gθ = 1) at every interior node, each equation multiplied by its star's radius², so that all
/// rows are of one size whatever the spacing.
pub(crate) fn assemble(mesh: &Mesh, stencils: &Stencils, roles: &Roles) -> LinearSystem {
    let n_boundary = mesh.cloud().n_boundary();
    let pieces = map_chunks(n_boundary..mesh.cloud().n_nodes(), |piece| {
        piece.map(|node| laplacian_row(stencils, roles, NodeId::of(node))).collect::<Vec<_>>()
    });
    let mut system = LinearSystem::new(roles.n_holes);
    for (k, equation) in pieces.into_iter().flatten().enumerate() {
        let radius = stencils.of(NodeId::of(n_boundary + k)).radius;
        system.push(&equation, 2.0 * radius * radius);
    }
    system
}

fn laplacian_row(stencils: &Stencils, roles: &Roles, node: NodeId) -> SplitRow {
    let stencil = stencils.of(node);
    let (xx, yy) = (stencil.row(row(2, 0)), stencil.row(row(0, 2)));
    let [s_x, s_y] = stencils.metric().stretch().map(|stretch| stretch * stretch);
    let mut split = SplitRow::default();
    for (k, &other) in stencil.nodes.iter().enumerate() {
        split.add(roles.of(other), -(xx[k] * s_x + yy[k] * s_y));
    }
    split
}
