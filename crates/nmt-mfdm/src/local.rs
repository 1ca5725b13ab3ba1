//! The local formulation: one equation a node, ∇²u = −s inside and where a flux is given; paper, eq. (17).

use crate::assembly::{Frame, Setting, dirichlet_row};
use crate::error::MfdmError;
use crate::system::{Equation, LinearSystem, RowSum, SplitRow};

/// Collocates −∇²u = s at every unknown node, times the square of its star's radius, so that all rows are of one size
/// whatever the spacing. The polynomial of a node with a flux meets n·∇u = q.
///
/// The flux itself collocated from a one-sided star is no equation to trust: its own coefficient may be small or of the
/// wrong sign, and on irregular clouds the error then scatters by two orders of magnitude and need not fall.
pub(crate) fn assemble(setting: &Setting) -> Result<LinearSystem, MfdmError> {
    let Setting { frame: Frame { mesh, roles, source, .. }, stencils } = setting;
    LinearSystem::of_pieces(roles, |piece| {
        // Only smoothing polynomials have Dirichlet rows, which are summed.
        let mut sum = RowSum::new(if stencils.interpolates() { 0 } else { mesh.cloud().n_nodes() });
        let equation = |k: usize| {
            let node = roles.node(k);
            if let Some(equation) = dirichlet_row(setting, node, &mut sum)? {
                return Ok(equation);
            }
            let stencil = stencils.of(node);
            let mut equation = Equation { row: SplitRow::default(), rhs: source.at(mesh.xy()[node.index()])? };
            equation.rhs *= stencil.radius * stencil.radius;
            // The row holds for u less the slope that a flux makes known.
            equation.rhs -= stencils.known_share(node, stencils.laplacian(node), mesh.xy());
            stencils.laplacian(node).for_each(|(other, c)| equation.row.add(roles.of(other), -c));
            Ok(equation)
        };
        LinearSystem::of(roles, piece.map(equation))
    })
}
