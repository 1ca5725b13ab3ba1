//! Stencils: stars with their coefficient rows, for many nodes.

use crate::basis::{n_monomials, row};
use crate::diagnostics::UsedStars;
use crate::error::MfdmError;
use crate::parallel::map_owned;
use crate::repair::{Demand, EVEN, StarOutcome};
use crate::row_sum::Marks;
use crate::slopes::{KnownSlopes, Slopes};
use crate::solve::Event;
use crate::sound_stars::{SoundStars, Wanted};
use crate::star::StarChoice;
use crate::surroundings::{Metric, Surroundings};
use nmt_cloud::Nearest;
use nmt_geom::point::{dot, sub};
use nmt_geom::{NodeId, Point};
use std::collections::BTreeMap;
use std::ops::Range;

/// Stars per piece of work.
const PIECE: usize = 512;

/// Pieces between two tellings of how many nodes are done: cores wait for each other at each.
const AT_ONCE: usize = 64;

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
    /// g of the weights where a hole smaller than the spacing makes a clump of nodes in the star, which then come from all sides
    /// \[D18\].
    pub evening: f64,
}

impl StarParams {
    /// The nearest `size` nodes, interpolating.
    pub fn nearest(order: usize, size: usize) -> Self {
        Self { order, size, choice: StarChoice::Nearest, smoothing: 0.0, evening: EVEN }
    }

    /// Rows of a star.
    fn n_rows(&self, kept: Kept) -> usize {
        match kept {
            Kept::Derivatives => n_monomials(self.order) - self.first_row(),
            Kept::Laplacian => 1,
        }
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

/// Which rows are kept of each star.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kept {
    /// Those of all derivatives.
    Derivatives,
    /// That of ∇² alone, of interpolating polynomials: what the local equations need, a fifth of the whole at order 2.
    Laplacian,
}

/// The stars of nodes and the rows of their derivatives.
#[derive(Clone, Debug)]
pub struct Stencils {
    params: StarParams,
    kept: Kept,
    n_rows: usize, // of a star
    size: usize,   // nodes in most stars
    metric: Metric,
    of: Numbers,
    stars: Vec<Star>,   // shape (n,)
    nodes: Vec<NodeId>, // star after star, each ascending; those of another size than most at the end, their first ones left
    rows: Vec<f64>,     // for a star of m nodes, its rows of m, in scaled coordinates
    outcomes: Vec<Outcome>,
    known: BTreeMap<NodeId, KnownSlopes>, // of nodes whose gradient is known in part
}

impl Kept {
    fn wanted(self) -> Wanted<'static> {
        match self {
            Self::Derivatives => Wanted::Rows,
            Self::Laplacian => Wanted::Laplacian,
        }
    }
}

/// Where a star is, and how large: a line of the cache.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(64))]
struct Star {
    start: usize, // its first node; its rows begin where so many rows' worth of nodes do
    radius: f64,  // user's length unit
    size: u32,    // nodes in it
    marks: Marks, // of its nodes, where it is of the size of most and has the rows of all derivatives; none otherwise
}

const _: () = assert!(size_of::<Star>() == 64);

/// [`StarOutcome`] in 16 bytes.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Outcome {
    condition: f64,
    hidden: u32,
    order: u8,
    enlarged: bool,
    wrong_sign: bool,
    hundredths: u8, // of the g of flatter weights, or 0
}

impl From<StarOutcome> for Outcome {
    fn from(outcome: StarOutcome) -> Self {
        let StarOutcome { order, enlarged, hidden, condition, wrong_sign, flattening } = outcome;
        let hidden = u32::try_from(hidden).unwrap_or(u32::MAX);
        let hundredths = (100.0 * flattening).round() as u8;
        Self { condition, hidden, order: order as u8, enlarged, wrong_sign, hundredths }
    }
}

impl From<Outcome> for StarOutcome {
    fn from(outcome: Outcome) -> Self {
        let Outcome { condition, hidden, order, enlarged, wrong_sign, hundredths } = outcome;
        let flattening = f64::from(hundredths) / 100.0;
        Self { order: order.into(), enlarged, hidden: hidden as usize, condition, wrong_sign, flattening }
    }
}

/// The part of [`Stencils`] that one piece of work fills.
struct Piece<'a> {
    first: usize, // place of its first node
    nodes: &'a mut [NodeId],
    rows: &'a mut [f64],
    stars: &'a mut [Star],
    outcomes: &'a mut [Outcome],
}

/// What does not fit there.
struct Filled {
    n: usize,
    others: Vec<Other>,
    known: BTreeMap<NodeId, KnownSlopes>,
}

/// A star of another size than most.
struct Other {
    place: usize,
    nodes: Vec<NodeId>,
    rows: Vec<f64>,
}

/// Which nodes have stencils.
#[derive(Clone, Debug)]
enum Numbers {
    Consecutive(Range<usize>),
    Some {
        nodes: Vec<NodeId>, // ascending
        parts: [Places; 2], // before and after the largest gap between their numbers
    },
}

/// The places of nodes in a list.
#[derive(Clone, Debug)]
struct Places {
    first: usize,  // number of the first of the nodes
    own: Vec<u32>, // of each node from the first to the last; beyond the end of the list where a node is not in it
}

impl Places {
    /// Those of `nodes`, ascending, from place `offset` on.
    fn new(nodes: &[NodeId], offset: usize) -> Self {
        let first = nodes.first().map_or(0, |node| node.index());
        let end = nodes.last().map_or(0, |node| node.index() + 1);
        let mut own = vec![u32::MAX; end - first];
        (offset as u32..).zip(nodes).for_each(|(place, node)| own[node.index() - first] = place);
        Self { first, own }
    }

    #[inline]
    fn place(&self, node: NodeId) -> usize {
        self.own.get(node.index().wrapping_sub(self.first)).map_or(usize::MAX, |place| *place as usize)
    }
}

impl Numbers {
    /// The given nodes, ascending.
    fn some(nodes: Vec<NodeId>) -> Self {
        let gap = |k: &usize| nodes[*k].0 - nodes[*k - 1].0;
        let (before, after) = nodes.split_at((1..nodes.len()).max_by_key(gap).unwrap_or(0));
        let parts = [Places::new(before, 0), Places::new(after, before.len())];
        Self::Some { nodes, parts }
    }

    fn len(&self) -> usize {
        match self {
            Self::Consecutive(range) => range.len(),
            Self::Some { nodes, .. } => nodes.len(),
        }
    }

    fn node(&self, place: usize) -> NodeId {
        match self {
            Self::Consecutive(range) => NodeId::of(range.start + place),
            Self::Some { nodes, .. } => nodes[place],
        }
    }

    /// Beyond the last where a node has none.
    #[inline]
    fn place(&self, node: NodeId) -> usize {
        match self {
            Self::Consecutive(range) => node.index().wrapping_sub(range.start),
            Self::Some { parts: [before, after], .. } => {
                if node.index() < after.first {
                    before.place(node)
                } else {
                    after.place(node)
                }
            }
        }
    }
}

/// The stencil of one node.
#[derive(Clone, Copy, Debug)]
pub struct Stencil<'a> {
    /// The star's nodes, ascending.
    pub nodes: &'a [NodeId],
    /// Radius of the star in stretched coordinates, user's length unit.
    pub radius: f64,
    marks: &'a Marks,
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

    /// All rows, from [`Self::first_row`] on.
    pub(crate) fn rows(&self) -> &'a [f64] {
        self.rows
    }

    /// Its nodes as bits, where those lie in few words.
    #[inline(always)]
    pub(crate) fn marks(&self) -> Option<&'a Marks> {
        (!self.marks.is_none()).then_some(self.marks)
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
        Self::meeting((surroundings, nearest), params, Kept::Derivatives, range, |_| None, &mut |_| {})
    }

    /// As [`Self::new`], the polynomials meeting what is `known` of the gradient at their nodes: their rows hold for values
    /// less the known slope; telling how many nodes are done.
    pub(crate) fn meeting(
        around: (&Surroundings, &Nearest),
        params: StarParams,
        kept: Kept,
        range: Range<usize>,
        known: impl Fn(NodeId) -> Option<KnownSlopes> + Sync,
        observer: &mut dyn FnMut(Event),
    ) -> Self {
        Self::empty(params, around.0.metric()).for_range(around, kept, range, known, observer)
    }

    /// As [`Self::new`] of the given nodes, ascending, meeting what is `known` of their gradients.
    pub(crate) fn of_some(
        around: (&Surroundings, &Nearest),
        params: StarParams,
        nodes: Vec<NodeId>,
        known: impl Fn(NodeId) -> Option<KnownSlopes> + Sync,
    ) -> Self {
        Self::empty(params, around.0.metric()).for_others(around, nodes, known)
    }

    /// Those of other nodes, ascending, in the room of these.
    pub(crate) fn for_others(
        self,
        around: (&Surroundings, &Nearest),
        nodes: Vec<NodeId>,
        known: impl Fn(NodeId) -> Option<KnownSlopes> + Sync,
    ) -> Self {
        self.made_of(around, Kept::Derivatives, Numbers::some(nodes), known, &mut |_| {})
    }

    /// As [`Self::meeting`], in the room of these.
    pub(crate) fn for_range(
        self,
        around: (&Surroundings, &Nearest),
        kept: Kept,
        range: Range<usize>,
        known: impl Fn(NodeId) -> Option<KnownSlopes> + Sync,
        observer: &mut dyn FnMut(Event),
    ) -> Self {
        self.made_of(around, kept, Numbers::Consecutive(range), known, observer)
    }

    fn made_of(
        mut self,
        (surroundings, nearest): (&Surroundings, &Nearest),
        kept: Kept,
        numbers: Numbers,
        known: impl Fn(NodeId) -> Option<KnownSlopes> + Sync,
        observer: &mut dyn FnMut(Event),
    ) -> Self {
        let (n, params) = (numbers.len(), self.params);
        let all = &mut self;
        let n_rows = params.n_rows(kept);
        (all.kept, all.n_rows, all.size, all.of) = (kept, n_rows, params.size, numbers);
        // What was there is written over, but for stars of another size than most, to which nothing leads.
        all.nodes.resize(n * all.size, NodeId(0));
        all.rows.resize(n * n_rows * all.size, 0.0);
        all.stars.clear();
        all.stars.extend((0..n).map(|k| Star { start: k * params.size, ..Star::default() }));
        all.outcomes.resize(n, Outcome::default());
        let size = all.size.max(1);
        let mut pieces = (0..n)
            .step_by(PIECE)
            .zip(all.nodes.chunks_mut(PIECE * size))
            .zip(all.rows.chunks_mut(PIECE * size * n_rows))
            .zip(all.stars.chunks_mut(PIECE))
            .zip(all.outcomes.chunks_mut(PIECE))
            .map(|((((first, nodes), rows), stars), outcomes)| Piece { first, nodes, rows, stars, outcomes });
        let of = &all.of;
        let fill = |piece: Piece| {
            let mut finder = SoundStars::new(surroundings, nearest, params.choice);
            let nodes = (piece.first..piece.first + piece.stars.len()).map(|place| of.node(place));
            let known: BTreeMap<_, _> = nodes.clone().filter_map(|node| Some((node, known(node)?))).collect();
            let demand = |node: NodeId| demand_of(params, surroundings, node, known.get(&node), params.size);
            let (mut k, mut others) = (0, Vec::new());
            finder.each(nodes, demand, kept.wanted(), |star| {
                let own = &mut piece.stars[k];
                (own.size, own.radius) = (star.nodes.len() as u32, star.radius);
                own.marks = if kept == Kept::Derivatives { Marks::of(star.nodes) } else { Marks::default() };
                piece.outcomes[k] = Outcome::from(star.outcome);
                if star.nodes.len() == size {
                    piece.nodes[k * size..(k + 1) * size].copy_from_slice(star.nodes);
                    piece.rows[k * size * n_rows..(k + 1) * size * n_rows].copy_from_slice(star.values);
                } else {
                    others.push(Other {
                        place: piece.first + k,
                        nodes: star.nodes.to_vec(),
                        rows: star.values.to_vec(),
                    });
                }
                k += 1;
            });
            Filled { n: k, others, known }
        };
        let (mut done, mut others, mut all_known) = (0, Vec::new(), BTreeMap::new());
        loop {
            let batch: Vec<Piece> = pieces.by_ref().take(AT_ONCE).collect();
            if batch.is_empty() {
                break;
            }
            for filled in map_owned(batch, fill) {
                done += filled.n;
                others.extend(filled.others);
                all_known.extend(filled.known);
            }
            observer(Event::Nodes { done, of: n });
        }
        drop(pieces);
        // Stars of another size than most follow those.
        all.nodes.reserve_exact(others.iter().map(|other: &Other| other.nodes.len()).sum());
        all.rows.reserve_exact(others.iter().map(|other| other.rows.len()).sum());
        for Other { place, nodes, rows } in others {
            all.append(place, &nodes, &rows);
        }
        all.known = all_known;
        self
    }

    /// Gives the node at a place another star; that it had is left.
    fn append(&mut self, place: usize, nodes: &[NodeId], rows: &[f64]) {
        // Rows begin where nodes do.
        let star = &mut self.stars[place];
        (star.start, star.size, star.marks) = (self.nodes.len(), nodes.len() as u32, Marks::default());
        self.nodes.extend(nodes);
        self.rows.extend(rows);
    }

    /// How the stars are chosen.
    pub(crate) fn params(&self) -> StarParams {
        self.params
    }

    /// Half as many nodes again as the star of `node` has.
    pub(crate) fn half_as_many_again(&self, node: NodeId) -> usize {
        half_as_many_again(self.stars[self.of.place(node)].size)
    }

    /// Gives nodes other stars, of the sizes told at least, each sound as those of [`Self::new`] are.
    pub(crate) fn replace(&mut self, surroundings: &Surroundings, nearest: &Nearest, stars: &[(NodeId, usize)]) {
        let mut finder = SoundStars::new(surroundings, nearest, self.params.choice);
        for &(node, size) in stars {
            let k = self.of.place(node);
            let demand = demand_of(self.params, surroundings, node, self.known.get(&node), size);
            let star = finder.one(node, demand, self.kept.wanted());
            self.stars[k].radius = star.radius;
            self.outcomes[k] = Outcome::from(StarOutcome { enlarged: true, ..star.outcome });
            self.append(k, star.nodes, star.values);
        }
    }

    /// A constant about each of `n_nodes` nodes, its value: blended, they are the linear interpolant of finite elements.
    pub(crate) fn constants(n_nodes: usize) -> Self {
        let mut stencils = Self::empty(StarParams::nearest(0, 0), Metric::plain());
        stencils.of = Numbers::Consecutive(0..n_nodes);
        stencils.stars = vec![Star { radius: 1.0, ..Star::default() }; n_nodes];
        stencils
    }

    /// Requires the stars of the nodes `range` to carry polynomials of `order`.
    ///
    /// # Errors
    /// [`MfdmError::PoorStar`] for the first node whose star does not.
    pub fn require(&self, range: Range<usize>, xy: &[Point], order: usize) -> Result<(), MfdmError> {
        match range.clone().find(|node| self.outcome(NodeId::of(*node)).order < order) {
            Some(node) => {
                let tried = self.of(NodeId::of(node)).nodes.len();
                Err(MfdmError::PoorStar { node, at: xy[node], order, tried })
            }
            None => Ok(()),
        }
    }

    /// What became of the star of a node of the range.
    pub fn outcome(&self, node: NodeId) -> StarOutcome {
        self.outcomes.get(self.of.place(node)).copied().map(StarOutcome::from).unwrap_or_default()
    }

    /// Each node with the size of its star and what became of it, ascending.
    pub(crate) fn outcomes(&self) -> impl Iterator<Item = (NodeId, u32, Outcome)> {
        let each = self.stars.iter().zip(&self.outcomes).enumerate();
        each.map(|(place, (star, outcome))| (self.of.node(place), star.size, *outcome))
    }

    /// No star yet.
    pub(crate) fn empty(params: StarParams, metric: Metric) -> Self {
        Self {
            params,
            kept: Kept::Derivatives,
            n_rows: params.n_rows(Kept::Derivatives),
            size: params.size,
            metric,
            of: Numbers::Consecutive(0..0),
            stars: Vec::new(),
            nodes: Vec::new(),
            rows: Vec::new(),
            outcomes: Vec::new(),
            known: BTreeMap::new(),
        }
    }

    /// How to find these stars again.
    pub(crate) fn used(&self) -> UsedStars {
        if self.params.order == 0 {
            return UsedStars::default();
        }
        let first = if self.of.len() > 0 { self.of.node(0).index() } else { 0 };
        UsedStars::new(self.params, first, BTreeMap::new(), self.known.clone())
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
    #[inline(always)]
    pub fn of(&self, node: NodeId) -> Stencil<'_> {
        let Star { start, size, radius, marks } = &self.stars[self.of.place(node)];
        let star = *start..*start + *size as usize;
        let n_rows = self.n_rows;
        Stencil {
            nodes: &self.nodes[star.clone()],
            radius: *radius,
            marks,
            first_row: self.params.first_row(),
            rows: &self.rows[n_rows * star.start..n_rows * star.end],
        }
    }

    /// What each node of the star contributes to ∇²u at its centre, times the square of the star's radius.
    pub(crate) fn laplacian(&self, node: NodeId) -> impl Iterator<Item = (NodeId, f64)> {
        let Stencil { nodes, rows, .. } = self.of(node);
        let row_of = |m: usize| &rows[(m - self.params.first_row()) * nodes.len()..];
        let [s_x, s_y] = self.metric.stretch().map(|stretch| stretch * stretch);
        let ((xx, s_x), (yy, s_y)) = match self.kept {
            Kept::Derivatives => ((row_of(row(2, 0)), s_x), (row_of(row(0, 2)), s_y)),
            Kept::Laplacian => ((rows, 1.0), (rows, 0.0)),
        };
        nodes.iter().zip(xx.iter().zip(yy)).map(move |(&other, (xx, yy))| (other, xx * s_x + yy * s_y))
    }

    /// What the polynomial of a node meets of its gradient.
    pub(crate) fn known(&self, node: NodeId) -> KnownSlopes {
        self.known_of(node).unwrap_or_default()
    }

    /// As [`Self::known`], `None` where nothing is known.
    pub(crate) fn known_of(&self, node: NodeId) -> Option<KnownSlopes> {
        self.known.get(&node).copied()
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
        self.outcomes.iter().for_each(|outcome| report.add(&StarOutcome::from(*outcome), self.params.order));
        report
    }
}

/// What the star of a node must carry.
fn demand_of(
    params: StarParams,
    surroundings: &Surroundings,
    node: NodeId,
    known: Option<&KnownSlopes>,
    size: usize,
) -> Demand {
    let StarParams { order, smoothing, evening, .. } = params;
    let negative_diagonal = node.index() >= surroundings.n_boundary() || known.is_some();
    let slopes = known.map_or(Slopes::Free, |known| known.slopes);
    Demand { order, size, smoothing, flattening: smoothing, negative_diagonal, slopes, evening }
}

/// Half as many nodes again.
pub(crate) fn half_as_many_again(size: u32) -> usize {
    (3 * size as usize).div_ceil(2)
}
