//! The star of one node as the equations use it, opened up: who is in it, who was passed over, and the ∇² row.

use crate::basis::row;
use crate::boundary_value::{Discrete, star_of_equations};
use crate::error::MfdmError;
use crate::flux::Fluxes;
use crate::params::SolveParams;
use crate::poisson::PoissonProblem;
use crate::problem::{Formulation, TorsionProblem};
use crate::repair::StarOutcome;
use crate::solver::TARGET;
use crate::source::Source;
use crate::star::StarChoice;
use crate::stencils::Stencils;
use crate::surroundings::Surroundings;
use crate::system::Roles;
use crate::weight::weight;
use nmt_cloud::Cloud;
use nmt_geom::NodeId;
use nmt_geom::point::distance;
use nmt_tri::Mesh;

/// A node of a star.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StarMember {
    /// The node.
    pub node: NodeId,
    /// Its distance from the centre in user's coordinates, user's length unit.
    pub distance: f64,
    /// Its weight; infinite at the centre where the polynomial meets its value exactly (g = 0).
    pub weight: f64,
    /// Its coefficient in the centre's ∇² row, 1/length²; `None` where the polynomial has no second derivative.
    pub laplacian: Option<f64>,
}

/// The star of one node.
#[derive(Clone, Debug, PartialEq)]
pub struct NodeStar {
    /// The node.
    pub node: NodeId,
    /// Nodes asked for, the centre included.
    pub asked: usize,
    /// How they are chosen, unless only the other choice gives a sound star, or the nearest are those of a hole smaller than the
    /// spacing.
    pub choice: StarChoice,
    /// What it came to: order, condition, enlarged or not, hidden nodes.
    pub outcome: StarOutcome,
    /// Distance of its farthest node in stretched coordinates, user's length unit.
    pub radius: f64,
    /// Factors of x and y to stretched coordinates: nodes within an ellipse of semi-axes radius/stretch belong.
    pub stretch: [f64; 2],
    /// Its nodes, the centre first, then by stretched distance: the weights fall.
    pub members: Vec<StarMember>,
    /// Nodes nearer than the farthest that are not visible, by number.
    pub hidden: Vec<NodeId>,
}

impl NodeStar {
    /// The star of `node` in the equations of a torsion problem; `None` for finite elements, which have none.
    ///
    /// It is that of the solution: larger than others where it was mended, since it left its node soft \[D13\].
    ///
    /// # Errors
    /// As [`crate::solve`], but for what the linear system and the recovery may say.
    pub fn in_torsion(
        problem: &TorsionProblem,
        mesh: &Mesh,
        params: &SolveParams,
        node: NodeId,
    ) -> Result<Option<Self>, MfdmError> {
        problem.check()?;
        let conditions = Roles::of_torsion(mesh, problem.holes);
        let fluxes = Fluxes::default();
        star_of_equations(
            Discrete { mesh, conditions, source: Source::Constant(2.0), fluxes: &fluxes, target: TARGET },
            params,
            node,
        )
    }

    /// The star of `node` in the equations of a Poisson problem, as [`Self::in_torsion`].
    ///
    /// # Errors
    /// As [`crate::solve_poisson`], but for what the linear system and the recovery may say.
    pub fn in_poisson(
        problem: &PoissonProblem,
        mesh: &Mesh,
        params: &SolveParams,
        node: NodeId,
    ) -> Result<Option<Self>, MfdmError> {
        problem.with_discrete(mesh, |discrete| star_of_equations(discrete, params, node))
    }

    /// The star of `node` that `params` choose, before any is mended; `None` for finite elements, which have none.
    ///
    /// # Errors
    /// [`MfdmError::Order`], [`MfdmError::Smoothing`] or [`MfdmError::StarSize`] where a parameter is out of range.
    pub fn of(cloud: &Cloud, params: &SolveParams, node: NodeId) -> Result<Option<Self>, MfdmError> {
        params.check()?;
        if params.formulation == Formulation::Fem || node.index() >= cloud.n_nodes() {
            return Ok(None);
        }
        let surroundings = Surroundings::new(cloud);
        let nearest = surroundings.nearest();
        let stars = params.star_params(cloud, &surroundings.metric())?;
        let stencils = Stencils::new(&surroundings, &nearest, stars, node.index()..node.index() + 1);
        Ok(Some(Self::in_stencils(cloud, &surroundings, &stencils, node)))
    }

    /// The star that `stencils` have.
    pub(crate) fn in_stencils(cloud: &Cloud, surroundings: &Surroundings, stencils: &Stencils, node: NodeId) -> Self {
        let stars = stencils.params();
        let (stencil, outcome) = (stencils.of(node), stencils.outcome(node));
        let (places, stretch) = (surroundings.stretched(), surroundings.metric().stretch());
        let stretched = |other: NodeId| distance(places[other.index()], places[node.index()]);
        // The centre's value is met where that was asked for, whatever the weights of the others.
        let g = |other: NodeId| if other == node { stars.smoothing } else { stars.smoothing.max(outcome.flattening) };
        let member = |(k, &other): (usize, &NodeId)| {
            let part = |m: usize, d: usize| stencil.row(m)[k] * (stretch[d] / stencil.radius).powi(2);
            let rho = stretched(other) / stencil.radius;
            StarMember {
                node: other,
                distance: distance(cloud.xy()[other.index()], cloud.xy()[node.index()]),
                weight: weight(rho * rho, g(other), outcome.order),
                laplacian: (outcome.order >= 2).then(|| part(row(2, 0), 0) + part(row(0, 2), 1)),
            }
        };
        let mut members: Vec<StarMember> = stencil.nodes.iter().enumerate().map(member).collect();
        members.sort_by(|a, b| {
            let by_distance = stretched(a.node).total_cmp(&stretched(b.node)).then(a.node.cmp(&b.node));
            (a.node != node).cmp(&(b.node != node)).then(by_distance)
        });
        let is_hidden = |other: &NodeId| stretched(*other) < stencil.radius && !surroundings.sees(node, *other);
        let hidden = (0..cloud.n_nodes()).map(NodeId::of).filter(is_hidden).collect();
        let (asked, choice, radius) = (stars.size, stars.choice, stencil.radius);
        Self { node, asked, choice, outcome, radius, stretch, members, hidden }
    }

    /// Sign of the node's own coefficient in its ∇² row: −1 is the right one; 0 where there is no second derivative.
    pub fn diagonal(&self) -> i8 {
        let own = self.members.iter().find(|member| member.node == self.node).and_then(|member| member.laplacian);
        own.map_or(0, |value| if value > 0.0 { 1 } else { -i8::from(value < 0.0) })
    }
}
