//! The local formulation: one equation a node, ∇²u = −s inside and where a flux is given; paper, eq. (17).

use crate::assembly::{Frame, Setting, dirichlet_row};
use crate::diagnostics::UsedStars;
use crate::error::MfdmError;
use crate::row_sum::RowSum;
use crate::slopes::KnownSlopes;
use crate::solve::{Event, Stage};
use crate::stencils::{Kept, StarParams, StarReport, Stencils};
use crate::surroundings::Surroundings;
use crate::system::LinearSystem;
use crate::system_maker::SystemMaker;
use nmt_cloud::Nearest;
use nmt_geom::NodeId;
use std::collections::BTreeMap;
use std::ops::Range;

/// Nodes whose stars are held at a time, 5 MB.
const BATCH: usize = 1 << 15;

/// The system and what became of the stars.
pub(crate) struct Batched {
    pub system: LinearSystem,
    pub stars: StarReport,
    pub used_stars: UsedStars,
}

/// Collocates −∇²u = s at every unknown node, times the square of its star's radius, so that all rows are of one size
/// whatever the spacing. The polynomial of a node with a flux meets n·∇u = q.
///
/// The flux itself collocated from a one-sided star is no equation to trust: its own coefficient may be small or of the
/// wrong sign, and on irregular clouds the error then scatters by two orders of magnitude and need not fall.
pub(crate) fn assemble(setting: &Setting) -> Result<LinearSystem, MfdmError> {
    let roles = setting.frame.roles;
    let mut made = SystemMaker::new(roles);
    append(setting, 0..roles.n_unknowns, &mut made)?;
    Ok(made.system())
}

/// [`assemble`] with interpolating polynomials by `params` that meet what is `known` of their gradients, the stars made and
/// dropped batch by batch: all of them would be as much as the matrix and the mesh.
///
/// # Errors
/// As the equations have them; [`MfdmError::PoorStar`] where a star carries no plane, or one inside no polynomial of order 2.
pub(crate) fn assemble_in_batches(
    frame: Frame,
    around: (&Surroundings, &Nearest),
    params: StarParams,
    known: impl Fn(NodeId) -> Option<KnownSlopes> + Sync,
    observer: &mut dyn FnMut(Event),
) -> Result<Batched, MfdmError> {
    let Frame { mesh, roles, .. } = frame;
    let (n_nodes, n_boundary) = (mesh.cloud().n_nodes(), mesh.cloud().n_boundary());
    // Equations need the stars of unknown nodes alone; those of holes have others beside them.
    let first = if roles.n_holes == 0 && roles.n_unknowns == n_nodes - n_boundary { n_boundary } else { 0 };
    let mut made = SystemMaker::new(roles);
    let mut stars = StarReport { size: params.size, choice: params.choice, ..StarReport::default() };
    let mut all_known = BTreeMap::new();
    let mut stencils = Stencils::empty(params, around.0.metric());
    // One batch at least, of no node.
    for first in (first..n_nodes.max(first + 1)).step_by(BATCH) {
        let range = first..(first + BATCH).min(n_nodes);
        observer(Event::Begun(Stage::Stencils));
        stencils = stencils.for_range(around, Kept::Laplacian, range.clone(), &known, &mut |_| {});
        stencils.require(range.clone(), mesh.xy(), 1)?;
        stencils.require(range.start.max(n_boundary)..range.end, mesh.xy(), 2)?;
        stars.join(&stencils.report());
        all_known.extend(range.clone().map(NodeId::of).filter_map(|node| Some((node, stencils.known_of(node)?))));
        observer(Event::Nodes { done: range.end, of: n_nodes });
        observer(Event::Ended(Stage::Stencils));
        observer(Event::Begun(Stage::Assemble));
        append(&frame.with(&stencils), roles.unknowns_of(range.clone()), &mut made)?;
        if range.end < n_nodes {
            observer(Event::Ended(Stage::Assemble));
        }
    }
    let used_stars = UsedStars::new(params, first, BTreeMap::new(), all_known);
    Ok(Batched { system: made.system(), stars, used_stars })
}

/// Appends the equations of `unknowns`.
fn append(setting: &Setting, unknowns: Range<usize>, made: &mut SystemMaker<RowSum>) -> Result<(), MfdmError> {
    let Setting { frame: Frame { mesh, roles, source, .. }, stencils } = setting;
    // Only smoothing polynomials have Dirichlet rows, which are summed.
    let sum = || RowSum::new(if stencils.interpolates() { 0 } else { mesh.cloud().n_nodes() });
    made.extend(unknowns, sum, |sum, k, system| -> Result<(), MfdmError> {
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
    Ok(())
}
