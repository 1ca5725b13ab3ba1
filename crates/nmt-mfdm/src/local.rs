//! The local formulation: one equation a node, ∇²u = −s inside, n·∇u = q where a flux is given; paper, eq. (17).

use crate::assembly::{Setting, dirichlet_row};
use crate::basis::row;
use crate::error::MfdmError;
use crate::stencils::Stencils;
use crate::system::{Equation, LinearSystem, Roles, RowSum, SplitRow};
use nmt_geom::NodeId;

/// Collocates −∇²u = s at every interior node and n·∇u = q at those with a flux, each equation multiplied by its star's
/// radius to the power of its derivatives, so that all rows are of one size whatever the spacing.
pub(crate) fn assemble(setting: &Setting) -> Result<LinearSystem, MfdmError> {
    let Setting { mesh, stencils, roles, source, fluxes, .. } = setting;
    LinearSystem::of_pieces(roles, |piece| {
        // Only smoothing polynomials have Dirichlet rows, which are summed.
        let mut sum = RowSum::new(if stencils.interpolates() { 0 } else { mesh.cloud().n_nodes() });
        let equation = |k: usize| {
            let node = roles.node(k);
            if let Some(equation) = dirichlet_row(setting, node, &mut sum)? {
                return Ok(equation);
            }
            let radius = stencils.of(node).radius;
            if let Some(flux) = fluxes.of_node(node) {
                return Ok(Equation { row: slope_row(stencils, roles, node, flux.normal), rhs: flux.q * radius });
            }
            let rhs = source.at(mesh.xy()[node.index()])? * radius * radius;
            Ok(Equation { row: laplacian_row(stencils, roles, node), rhs })
        };
        LinearSystem::of(roles, piece.map(equation))
    })
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

fn slope_row(stencils: &Stencils, roles: &Roles, node: NodeId, normal: [f64; 2]) -> SplitRow {
    let stencil = stencils.of(node);
    let (by_x, by_y) = (stencil.row(row(1, 0)), stencil.row(row(0, 1)));
    let [s_x, s_y] = stencils.metric().stretch();
    let mut split = SplitRow::default();
    for (k, &other) in stencil.nodes.iter().enumerate() {
        split.add(roles.of(other), normal[0] * s_x * by_x[k] + normal[1] * s_y * by_y[k]);
    }
    split
}
