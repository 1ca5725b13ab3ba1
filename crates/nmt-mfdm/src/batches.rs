//! The variational form with hats, its stars made and dropped batch by batch.
//!
//! The rows of all stars would be most of what a solution holds: 0.4 kB a node at order 2, 3.4 kB at order 4. Nodes are in
//! spatial order, so that the polynomials which some thousand consecutive equations take are little more than those of their
//! own nodes; stars at the rims of batches are found twice.

use crate::assembly::{Frame, Setting};
use crate::basis::n_monomials;
use crate::circulation::{hole_equations, nodes_of_equations};
use crate::diagnostics::UsedStars;
use crate::error::MfdmError;
use crate::gauss::Rule;
use crate::mend::{ROUNDS, nodes_around, touched};
use crate::problem::Formulation;
use crate::repair::StarOutcome;
use crate::solve::{Event, Stage};
use crate::stencils::{Outcome, StarParams, StarReport, Stencils, half_as_many_again};
use crate::surroundings::Surroundings;
use crate::system::{Equation, LinearSystem};
use crate::system_maker::SystemMaker;
use crate::variational::{self, Firmness};
use crate::weak::WeakForm;
use nmt_cloud::Nearest;
use nmt_geom::NodeId;
use std::collections::BTreeMap;

/// Coefficients of stars that are held at a time, 16 MB, unless these are fewer stars than [`LEAST`].
const HELD: usize = 1 << 21;

/// Equations whose stars are held at a time, at least: of fewer the rims would be much.
const LEAST: usize = 1 << 14;

/// The system and what became of the stars.
pub(crate) struct Batched {
    pub system: LinearSystem,
    /// By their numbers, those to put in their places: of stars that were mended since they left their nodes soft.
    pub anew: BTreeMap<usize, Equation>,
    /// Of each equation, with these.
    pub firmness: Vec<Firmness>,
    /// Of the holes' constants.
    pub equations: Vec<Equation>,
    pub stars: StarReport,
    pub used_stars: UsedStars,
}

/// Makes the equations of a problem with interpolating polynomials by `stars`.
///
/// # Errors
/// As the equations have them; [`MfdmError::PoorStar`] where a star carries no polynomial at all.
pub(crate) fn assemble(
    frame: Frame,
    around: (&Surroundings, &Nearest),
    stars: StarParams,
    rule: &Rule,
    observer: &mut dyn FnMut(Event),
) -> Result<Batched, MfdmError> {
    let a_star = n_monomials(stars.order) * stars.size;
    Making::new(frame, around, stars, rule).assemble((HELD / a_star).max(LEAST), observer)
}

/// What batches are made from, and what was met so far.
struct Making<'a> {
    frame: Frame<'a>,
    around: (&'a Surroundings<'a>, &'a Nearest<'a>),
    params: StarParams,
    rule: &'a Rule,
    larger: BTreeMap<NodeId, usize>, // nodes asked for, of stars that are mended
    sizes: Vec<u32>,                 // of the stars, 0 where not met yet
    outcomes: Vec<Outcome>,
    is_met: Vec<bool>,      // room for marks
    room: Option<Stencils>, // of the batch before
}

impl<'a> Making<'a> {
    fn new(
        frame: Frame<'a>,
        around: (&'a Surroundings<'a>, &'a Nearest<'a>),
        params: StarParams,
        rule: &'a Rule,
    ) -> Self {
        let n_nodes = frame.mesh.cloud().n_nodes();
        let (sizes, outcomes, is_met) = (vec![0; n_nodes], vec![Outcome::default(); n_nodes], vec![false; n_nodes]);
        Self { frame, around, params, rule, larger: BTreeMap::new(), sizes, outcomes, is_met, room: None }
    }

    /// [`assemble`] with `batch` equations at a time.
    fn assemble(mut self, batch: usize, observer: &mut dyn FnMut(Event)) -> Result<Batched, MfdmError> {
        let Self { frame, params, rule, .. } = self;
        let n_nodes = frame.mesh.cloud().n_nodes();
        let n = frame.roles.n_unknowns;
        let (mut made, mut firmness) = (SystemMaker::new(frame.roles), Vec::with_capacity(n));
        for first in (0..n.max(1)).step_by(batch) {
            let unknowns = first..(first + batch).min(n);
            if first > 0 {
                observer(Event::Ended(Stage::Assemble));
            }
            observer(Event::Begun(Stage::Stencils));
            let stencils = self.stencils_around(unknowns.clone())?;
            // Nodes whose values are known come along.
            observer(Event::Nodes { done: n_nodes - (n - unknowns.end), of: n_nodes });
            observer(Event::Ended(Stage::Stencils));
            observer(Event::Begun(Stage::Assemble));
            let weak = WeakForm::blended(&stencils, frame.fluxes, rule);
            firmness.extend(variational::append(&frame.with(&stencils), &weak, unknowns, &mut made)?);
            self.room = Some(stencils);
        }
        self.room = None;
        let system = made.system();
        // Nodes that enter no equation have stars too.
        let rest: Vec<NodeId> = (0..n_nodes).filter(|&node| self.sizes[node] == 0).map(NodeId::of).collect();
        for nodes in rest.chunks(batch) {
            self.stencils(nodes.to_vec())?;
        }
        let anew = self.mend(batch, &mut firmness)?;
        let of_holes = nodes_of_equations(&frame, Formulation::Variational);
        let stencils = self.stencils(of_holes)?;
        let weak = WeakForm::blended(&stencils, frame.fluxes, rule);
        let equations = hole_equations(&frame, &weak, Formulation::Variational);
        let mut report = StarReport { size: params.size, choice: params.choice, ..StarReport::default() };
        self.outcomes.iter().for_each(|outcome| report.add(&StarOutcome::from(*outcome), params.order));
        let used_stars = UsedStars::new(params, 0, self.larger, BTreeMap::new());
        Ok(Batched { system, anew, firmness, equations, stars: report, used_stars })
    }

    /// The equations of nodes that are soft and of those around, made anew with larger stars, by number; `firmness` of them too.
    fn mend(&mut self, batch: usize, firmness: &mut [Firmness]) -> Result<BTreeMap<usize, Equation>, MfdmError> {
        let soft_unknowns = (0..firmness.len()).filter(|&k| firmness[k].is_soft());
        let mut soft: Vec<NodeId> = soft_unknowns.map(|k| self.frame.roles.node(k)).collect();
        let mut anew = BTreeMap::new();
        for _ in 0..ROUNDS {
            if soft.is_empty() {
                break;
            }
            let enlarged = soft.iter().map(|&node| (node, half_as_many_again(self.sizes[node.index()])));
            self.larger.extend(enlarged.collect::<Vec<_>>());
            let touched = touched(self.frame, &soft);
            for unknowns in touched.chunks(batch) {
                for (k, equation) in self.equations(unknowns)? {
                    firmness[k].own = equation.row.of_unknown(k);
                    anew.insert(k, equation);
                }
            }
            soft = touched.into_iter().filter(|&k| firmness[k].is_soft()).map(|k| self.frame.roles.node(k)).collect();
        }
        Ok(anew)
    }

    /// The equations of unknowns, ascending, each with its number.
    fn equations(&mut self, unknowns: &[usize]) -> Result<Vec<(usize, Equation)>, MfdmError> {
        let stencils = self.stencils_around(unknowns.iter().copied())?;
        let setting: Setting = self.frame.with(&stencils);
        let weak = WeakForm::blended(&stencils, self.frame.fluxes, self.rule);
        variational::equations(&setting, &weak, unknowns)
    }

    /// The stencils whose polynomials enter the equations of unknowns.
    fn stencils_around(&mut self, unknowns: impl Iterator<Item = usize>) -> Result<Stencils, MfdmError> {
        let nodes = nodes_around(self.frame, unknowns, &mut self.is_met);
        self.stencils(nodes)
    }

    /// The stencils of nodes, ascending, mended ones as they are by now.
    fn stencils(&mut self, nodes: Vec<NodeId>) -> Result<Stencils, MfdmError> {
        let room = self.room.take().unwrap_or_else(|| Stencils::empty(self.params, self.around.0.metric()));
        let mut stencils = room.for_others(self.around, nodes.clone(), |_| None);
        let xy = self.frame.mesh.xy();
        nodes.iter().try_for_each(|node| stencils.require(node.index()..node.index() + 1, xy, 1))?;
        let mended = nodes.iter().filter_map(|node| Some((*node, *self.larger.get(node)?)));
        stencils.replace(self.around.0, self.around.1, &mended.collect::<Vec<_>>());
        for (node, size, outcome) in stencils.outcomes() {
            (self.sizes[node.index()], self.outcomes[node.index()]) = (size, outcome);
        }
        Ok(stencils)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flux::Fluxes;
    use crate::gauss::six_points;
    use crate::mend::mend;
    use crate::problem::HoleCondition;
    use crate::source::Source;
    use crate::star::default_star;
    use crate::system::{Dirichlet, Roles};
    use crate::variational;
    use nmt_cloud::{CloudParams, Section, generate};
    use nmt_curve::Outline;
    use nmt_tri::{Mesh, NodeTris};

    #[test]
    fn batches_of_any_size_make_the_equations_of_all_stars_held_at_once() {
        let section = Section {
            contour: Outline::rectangle([0.0, 0.0], [2.0, 1.0]),
            holes: vec![Outline::circle([1.2, 0.5], 0.2)],
        };
        let params = CloudParams { nodes: [41, 21], irregularity: 0.45, seed: 3, ..CloudParams::default() };
        let mesh = Mesh::constrained(generate(&section, &params).expect("a cloud")).expect("a mesh");
        let surroundings = Surroundings::new(mesh.cloud());
        let nearest = surroundings.nearest();
        let n_nodes = mesh.cloud().n_nodes();
        let conditions = Roles::of_torsion(&mesh, HoleCondition::Circulation);
        let roles = Roles::new(conditions, mesh.cloud().n_interior(), Dirichlet::Eliminated);
        let (node_tris, fluxes) = (NodeTris::new(n_nodes, mesh.tri_nodes()), Fluxes::default());
        let rule = six_points();
        let source = Source::Constant(2.0);
        let frame =
            Frame { mesh: &mesh, node_tris: &node_tris, roles: &roles, source, fluxes: &fluxes, source_rule: &rule };
        let around = (&surroundings, &nearest);
        for order in 2..=4 {
            let stars = StarParams::nearest(order, default_star(order));
            let mut stencils = Stencils::new(around.0, around.1, stars, 0..n_nodes);
            let weak = WeakForm::blended(&stencils, &fluxes, &rule);
            let mut system = variational::assemble(&frame.with(&stencils), &weak).expect("a system");
            let larger = mend(frame, around, &rule, &mut stencils, &mut system, 0..roles.n_unknowns).expect("a system");
            assert!(order > 2 || !larger.is_empty(), "some star of order 2 is mended");
            let weak = WeakForm::blended(&stencils, &fluxes, &rule);
            let holes = hole_equations(&frame, &weak, Formulation::Variational);
            for batch in [37, 10_000] {
                let mut found =
                    Making::new(frame, around, stars, &rule).assemble(batch, &mut |_| {}).expect("a system");
                found.system.mend(found.anew, Vec::new());
                assert_eq!(found.stars, stencils.report(), "order {order}, {batch} at a time");
                assert_eq!(found.used_stars, UsedStars::new(stars, 0, larger.clone(), BTreeMap::new()));
                assert_eq!(found.system.rhs, system.rhs);
                assert_eq!(found.system.hole_columns, system.hole_columns);
                for (k, firmness) in found.firmness.iter().enumerate() {
                    assert_eq!(*firmness, Firmness::of(system.matrix.diagonal(k), &frame, roles.node(k)));
                }
                for k in 0..system.n() {
                    let row = |system: &LinearSystem| system.matrix.row(k).entries().collect::<Vec<_>>();
                    assert_eq!(row(&found.system), row(&system), "order {order}, equation {k}");
                }
                assert_eq!(found.equations.len(), 1);
                assert_eq!(found.equations[0].row.unknowns, holes[0].row.unknowns);
            }
        }
    }
}
