//! The local formulation: one equation a node, ∇²u = −s inside and where a flux is given; paper, eq. (17).

use crate::assembly::{Frame, Setting, dirichlet_row};
use crate::error::MfdmError;
use crate::system::{LinearSystem, RowSum};
use crate::system_maker::SystemMaker;

/// Collocates −∇²u = s at every unknown node, times the square of its star's radius, so that all rows are of one size
/// whatever the spacing. The polynomial of a node with a flux meets n·∇u = q.
///
/// The flux itself collocated from a one-sided star is no equation to trust: its own coefficient may be small or of the
/// wrong sign, and on irregular clouds the error then scatters by two orders of magnitude and need not fall.
pub(crate) fn assemble(setting: &Setting) -> Result<LinearSystem, MfdmError> {
    let Setting { frame: Frame { mesh, roles, source, .. }, stencils } = setting;
    // Only smoothing polynomials have Dirichlet rows, which are summed.
    let sum = || RowSum::new(if stencils.interpolates() { 0 } else { mesh.cloud().n_nodes() });
    let mut made = SystemMaker::new(roles);
    made.extend(0..roles.n_unknowns, sum, |sum, k, system| -> Result<(), MfdmError> {
        let node = roles.node(k);
        if let Some(of_value) = dirichlet_row(setting, node, sum)? {
            system.push(&of_value);
            return Ok(());
        }
        stencils.laplacian(node).for_each(|(other, c)| system.add(roles.of(other), -c));
        let radius = stencils.of(node).radius;
        // The row holds for u less the slope that a flux makes known.
        let known = stencils.known_share(node, stencils.laplacian(node), mesh.xy());
        system.end(radius * radius * source.at(mesh.xy()[node.index()])? - known);
        Ok(())
    })?;
    Ok(made.system())
}
