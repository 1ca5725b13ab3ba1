//! Stencils: stars with their coefficient rows, for many nodes.

use crate::basis::n_monomials;
use crate::diagnostics::UsedStars;
use crate::error::MfdmError;
use crate::mwls::Mwls;
use crate::parallel::take_pieces;
use crate::repair::{Demand, StarOutcome, sound_star};
use crate::slopes::{KnownSlopes, Slopes};
use crate::solve::Event;
use crate::star::{StarChoice, StarFinder};
use crate::surroundings::{Metric, Surroundings};
use nmt_cloud::Nearest;
use nmt_geom::point::{dot, sub};
use nmt_geom::{NodeId, Point};
use std::collections::BTreeMap;
use std::ops::Range;

/// Stars per piece of work.
const PIECE: usize = 1024;

/// Order, size and choice of stars.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StarParams {
    /// Order p of the MWLS polynomial.
    pub order: usize,
    /// Nodes in a star, the centre included.
    pub size: usize,
    /// How they are chosen.
    pub choice: StarChoice,
    /// g of the weight; 0 meets the centre's value exactly.
    pub smoothing: f64,
}

impl StarParams {
    /// The nearest `size` nodes, interpolating.
    pub fn nearest(order: usize, size: usize) -> Self {
        Self { order, size, choice: StarChoice::Nearest, smoothing: 0.0 }
    }

    /// Monomial of the first row: 1 where the centre's value is met exactly, otherwise 0.
    fn first_row(&self) -> usize {
        usize::from(self.smoothing == 0.0)
    }
}

/// What became of the stars of a cloud.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StarReport {
    /// Nodes in a star as asked for.
    pub size: usize,
    /// How they were chosen.
    pub choice: StarChoice,
    /// Hidden nodes passed over, in all stars together.
    pub hidden_nodes_skipped: usize,
    /// Stars that had to be enlarged.
    pub enlarged: usize,
    /// Stars whose polynomial is of a lower order.
    pub order_lowered: usize,
    /// Largest condition number of a star's system.
    pub worst_condition: f64,
    /// Interior nodes whose own coefficient in their ∇² row has the wrong sign, at order 2.
    pub wrong_sign: usize,
}

impl StarReport {
    /// Takes in the stars of another part of the cloud.
    pub(crate) fn join(&mut self, other: &Self) {
        self.hidden_nodes_skipped += other.hidden_nodes_skipped;
        self.enlarged += other.enlarged;
        self.order_lowered += other.order_lowered;
        self.worst_condition = self.worst_condition.max(other.worst_condition);
        self.wrong_sign += other.wrong_sign;
    }

    pub(crate) fn add(&mut self, outcome: &StarOutcome, order: usize) {
        self.hidden_nodes_skipped += outcome.hidden;
        self.enlarged += usize::from(outcome.enlarged);
        self.order_lowered += usize::from(outcome.order < order);
        self.worst_condition = self.worst_condition.max(outcome.condition);
        self.wrong_sign += usize::from(outcome.wrong_sign);
    }
}

/// The stars of consecutive nodes and the rows of their derivatives.
#[derive(Clone, Debug)]
pub struct Stencils {
    params: StarParams,
    metric: Metric,
    first: usize,       // number of the first node
    starts: Vec<usize>, // first star entry of each node, shape (n,)
    sizes: Vec<u32>,    // nodes in each star, shape (n,)
    nodes: Vec<NodeId>, // star after star, each ascending; those of mended stars at the end, their first ones left
    rows: Vec<f64>,     // for a star of m nodes, (n_monomials − first row) rows of m, in scaled coordinates
    radii: Vec<f64>,    // radius of each star, user's length unit
    outcomes: Vec<StarOutcome>,
    known: BTreeMap<NodeId, KnownSlopes>, // of nodes whose gradient is known in part
}

/// The stencil of one node.
#[derive(Clone, Copy, Debug)]
pub struct Stencil<'a> {
    /// The star's nodes, ascending.
    pub nodes: &'a [NodeId],
    /// Radius of the star in stretched coordinates, user's length unit.
    pub radius: f64,
    first_row: usize,
    rows: &'a [f64],
}

impl<'a> Stencil<'a> {
    /// What each node contributes to derivative `m` (see [`crate::row`]; at least [`Self::first_row`]) at the centre in
    /// scaled coordinates: multiply by (stretch_x/radius)^a·(stretch_y/radius)^b for ∂ᵃ⁺ᵇ/∂xᵃ∂yᵇ.
    pub fn row(&self, m: usize) -> &'a [f64] {
        let k = m - self.first_row;
        &self.rows[k * self.nodes.len()..(k + 1) * self.nodes.len()]
    }

    /// 1 where the polynomial meets the centre's value exactly, so that there is no row for it; 0 where it smooths.
    pub fn first_row(&self) -> usize {
        self.first_row
    }
}

impl Stencils {
    /// Stencils of the nodes `range` of a cloud.
    ///
    /// A star that cannot carry the polynomial is enlarged, then its order lowered (the rows of the missing derivatives
    /// are 0); [`Self::report`] tells.
    pub fn new(surroundings: &Surroundings, nearest: &Nearest, params: StarParams, range: Range<usize>) -> Self {
        Self::meeting(surroundings, nearest, params, range, |_| None, &mut |_| {})
    }

    /// As [`Self::new`], the polynomials meeting what is `known` of the gradient at their nodes: their rows hold for values
    /// less the known slope; telling how many nodes are done.
    pub(crate) fn meeting(
        surroundings: &Surroundings,
        nearest: &Nearest,
        params: StarParams,
        range: Range<usize>,
        known: impl Fn(NodeId) -> Option<KnownSlopes> + Sync,
        observer: &mut dyn FnMut(Event),
    ) -> Self {
        let of = range.len();
        let metric = surroundings.metric();
        let first = range.start;
        let part = |piece: Range<usize>| {
            let mut finder = StarFinder::new(surroundings, nearest, params.choice);
            let (mut mwls, mut star) = (Mwls::default(), Vec::new());
            let mut part = Self::empty(params, metric, piece.start);
            for node in piece {
                let node = NodeId::of(node);
                part.known.extend(known(node).map(|known| (node, known)));
                let demand = part.demand(surroundings, node, params.size);
                let outcome = sound_star(&mut finder, &mut mwls, node, demand, &mut star);
                part.push(&star, &mut mwls, outcome);
            }
            part
        };
        let mut all = Self::empty(params, metric, first);
        take_pieces(range, PIECE, part, |part: Self| {
            let offset = all.nodes.len();
            all.starts.extend(part.starts.iter().map(|start| start + offset));
            all.sizes.extend(part.sizes);
            all.nodes.extend(part.nodes);
            all.rows.extend(part.rows);
            all.radii.extend(part.radii);
            all.outcomes.extend(part.outcomes);
            all.known.extend(part.known);
            observer(Event::Nodes { done: all.outcomes.len(), of });
        });
        all
    }

    /// What the star of a node must carry.
    fn demand(&self, surroundings: &Surroundings, node: NodeId, size: usize) -> Demand {
        let StarParams { order, smoothing, .. } = self.params;
        let known = self.known.get(&node);
        let negative_diagonal = node.index() >= surroundings.n_boundary() || known.is_some();
        let slopes = known.map_or(Slopes::Free, |known| known.slopes);
        Demand { order, size, smoothing, flattening: smoothing, negative_diagonal, slopes }
    }

    /// Appends the star that `mwls` holds.
    fn push(&mut self, star: &[NodeId], mwls: &mut Mwls, outcome: StarOutcome) {
        let before = self.rows.len();
        if outcome.order > 0 {
            mwls.rows(&mut self.rows);
        }
        self.rows.resize(before + self.n_rows() * star.len(), 0.0);
        self.starts.push(self.nodes.len());
        self.sizes.push(star.len() as u32);
        self.nodes.extend(star);
        self.radii.push(if mwls.radius() > 0.0 { mwls.radius() } else { 1.0 });
        self.outcomes.push(outcome);
    }

    /// How the stars are chosen.
    pub(crate) fn params(&self) -> StarParams {
        self.params
    }

    /// Rows of a star.
    fn n_rows(&self) -> usize {
        n_monomials(self.params.order) - self.params.first_row()
    }

    /// Half as many nodes again as the star of `node` has.
    pub(crate) fn half_as_many_again(&self, node: NodeId) -> usize {
        (3 * self.sizes[node.index() - self.first] as usize).div_ceil(2)
    }

    /// Gives nodes other stars, of the sizes told at least, each sound as those of [`Self::new`] are.
    pub(crate) fn replace(&mut self, surroundings: &Surroundings, nearest: &Nearest, stars: &[(NodeId, usize)]) {
        let mut finder = StarFinder::new(surroundings, nearest, self.params.choice);
        let (mut mwls, mut star) = (Mwls::default(), Vec::new());
        for &(node, size) in stars {
            let k = node.index() - self.first;
            let demand = self.demand(surroundings, node, size);
            let outcome = sound_star(&mut finder, &mut mwls, node, demand, &mut star);
            self.push(&star, &mut mwls, StarOutcome { enlarged: true, ..outcome });
            // What was appended takes the place of the node's own.
            self.starts.swap_remove(k);
            self.sizes.swap_remove(k);
            self.radii.swap_remove(k);
            self.outcomes.swap_remove(k);
        }
    }

    /// A constant about each of `n_nodes` nodes, its value: blended, they are the linear interpolant of finite elements.
    pub(crate) fn constants(n_nodes: usize) -> Self {
        let mut stencils = Self::empty(StarParams::nearest(0, 0), Metric::plain(), 0);
        stencils.starts = vec![0; n_nodes];
        stencils.sizes = vec![0; n_nodes];
        stencils.radii = vec![1.0; n_nodes];
        stencils
    }

    /// Requires the stars of the nodes `range` to carry polynomials of `order`.
    ///
    /// # Errors
    /// [`MfdmError::PoorStar`] for the first node whose star does not.
    pub fn require(&self, range: Range<usize>, xy: &[Point], order: usize) -> Result<(), MfdmError> {
        match range.clone().find(|node| self.outcomes[node - self.first].order < order) {
            Some(node) => {
                let tried = self.of(NodeId::of(node)).nodes.len();
                Err(MfdmError::PoorStar { node, at: xy[node], order, tried })
            }
            None => Ok(()),
        }
    }

    /// What became of the star of a node of the range.
    pub fn outcome(&self, node: NodeId) -> StarOutcome {
        self.outcomes.get(node.index() - self.first).copied().unwrap_or_default()
    }

    /// Numbers of the nodes that have a stencil.
    pub fn range(&self) -> Range<usize> {
        self.first..self.first + self.radii.len()
    }

    fn empty(params: StarParams, metric: Metric, first: usize) -> Self {
        Self {
            params,
            metric,
            first,
            starts: Vec::new(),
            sizes: Vec::new(),
            nodes: Vec::new(),
            rows: Vec::new(),
            radii: Vec::new(),
            outcomes: Vec::new(),
            known: BTreeMap::new(),
        }
    }

    /// How to find these stars again, of which `larger` were enlarged.
    pub(crate) fn used(&self, larger: BTreeMap<NodeId, usize>) -> UsedStars {
        if self.params.order == 0 {
            return UsedStars::default();
        }
        UsedStars::new(self.params, self.first, larger, self.known.clone())
    }

    /// The metric of their coordinates.
    pub fn metric(&self) -> Metric {
        self.metric
    }

    /// Order of the polynomials.
    pub fn order(&self) -> usize {
        self.params.order
    }

    /// True where polynomials meet the values at their own nodes.
    pub(crate) fn interpolates(&self) -> bool {
        self.params.first_row() == 1
    }

    /// The stencil of a node of the range.
    pub fn of(&self, node: NodeId) -> Stencil<'_> {
        let k = node.index() - self.first;
        let star = self.starts[k]..self.starts[k] + self.sizes[k] as usize;
        let n_rows = self.n_rows();
        Stencil {
            nodes: &self.nodes[star.clone()],
            radius: self.radii[k],
            first_row: self.params.first_row(),
            rows: &self.rows[n_rows * star.start..n_rows * star.end],
        }
    }

    /// What the polynomial of a node meets of its gradient.
    pub(crate) fn known(&self, node: NodeId) -> KnownSlopes {
        self.known.get(&node).copied().unwrap_or_default()
    }

    /// What the known slope of a node adds to Σ c·u over its star: Σ c·g·(x_k − x).
    pub(crate) fn known_share(
        &self,
        node: NodeId,
        coefficients: impl Iterator<Item = (NodeId, f64)>,
        xy: &[Point],
    ) -> f64 {
        let KnownSlopes { slopes, gradient } = self.known(node);
        if slopes == Slopes::Free {
            return 0.0;
        }
        let place = |node: NodeId| self.metric.stretched(xy[node.index()]);
        coefficients.map(|(other, c)| c * dot(gradient, sub(place(other), place(node)))).sum()
    }

    /// What became of the stars.
    pub fn report(&self) -> StarReport {
        let mut report = StarReport { size: self.params.size, choice: self.params.choice, ..StarReport::default() };
        // Constants have no stars.
        self.outcomes.iter().for_each(|outcome| report.add(outcome, self.params.order));
        report
    }
}
