//! A star that cannot carry its polynomial is enlarged, then the order is lowered; who it was is kept.

use crate::basis::{MAX_MONOMIALS, MAX_ORDER, n_monomials, row};
use crate::mwls::{MAX_CONDITION, Mwls};
use crate::slopes::Slopes;
use crate::star::{StarChoice, StarFinder, default_star};
use nmt_geom::NodeId;

/// A star of order p whose condition number is above `SOUND_CONDITION[p]` is enlarged, to see whether more nodes help;
/// the best one is kept.
///
/// Measured on irregular clouds: stars of order 2 lie between 5 and 60, but one in 10⁵, at a wall, reaches 400, and its
/// polynomial is then wrong by as much as its stress is: J of a square at 41 across is off by 7e-5 with that star, by
/// 1e-5 with 10 nodes in it. Stars of order 3 lie between 100 and 350.
pub(crate) const SOUND_CONDITION: [f64; MAX_ORDER + 1] = [1.0, 20.0, 100.0, 500.0, 3000.0];

/// g of the weights that are tried where a star keeps a wrong sign: a neighbour much nearer than all others has nearly all
/// the weight, the polynomial falls from 1 to 0 on the way to it, and what the others leave of the second derivative along
/// that way may be of either sign. Rows reproduce polynomials whatever the weights.
const FLATTER: [f64; 3] = [0.25, 0.5, 1.0];

/// g of the weights where a hole smaller than the spacing makes a clump of nodes in a star, which then come from all sides \[D18\]:
/// where nothing holds the values on the hole, at the rows of ∇², and where fields are recovered.
///
/// With steep weights polynomials follow the differences within the clump, and are far off where the star has its other nodes.
pub(crate) const EVEN: f64 = 0.5;

/// The same in variational equations, where the values on the hole are known, or one unknown constant.
///
/// Plate 2 × 1 with 32 holes of 1/5 and 1/16 of the spacing, orders 2 to 4, irregular by 0 to 0.4: J is off by 9e-4 at most; with
/// [`EVEN`] by 4e-3, with the nearest nodes by 6e-3.
pub(crate) const EVEN_WHERE_HELD: f64 = 0.1;

/// From this order on stars take whole shells of equally distant nodes \[D16\].
const WHOLE_SHELLS: usize = 4;

/// A star is enlarged to these parts of its size, in eighths, before the order is lowered.
const ENLARGEMENTS: [usize; 6] = [8, 9, 10, 12, 16, 24];

/// The sizes tried for a polynomial of `order`; a plane, the least there is, may take every visible node.
fn sizes(first: usize, order: usize) -> impl Iterator<Item = usize> {
    let ordinary = ENLARGEMENTS.into_iter().map(move |eighths| (first * eighths).div_ceil(8));
    let further = (3..usize::BITS - 8).map(move |doublings| first << doublings).take_while(|size| *size < 1 << 40);
    ordinary.chain(further.filter(move |_| order == 1))
}

/// What one node's star came to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StarOutcome {
    /// Order of the polynomial it carries; 0 where it carries none.
    pub order: usize,
    /// True where it has more nodes than asked for.
    pub enlarged: bool,
    /// Hidden nodes passed over.
    pub hidden: usize,
    /// Condition number of its system.
    pub condition: f64,
    /// True where the node's own coefficient in its ∇² row is not negative, and no larger star mended it.
    pub wrong_sign: bool,
    /// g of the weights of its polynomial to a hundredth, where they are flatter than asked for, else 0; the centre's value is met
    /// all the same.
    pub flattening: f64,
}

/// What a star must carry.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Demand {
    pub order: usize,
    pub size: usize,
    /// g of the weight.
    pub smoothing: f64,
    /// g of the weights of the polynomial, at least `smoothing`; it meets the centre's value where `smoothing` is 0.
    pub flattening: f64,
    /// The node's own coefficient in its ∇² row, at order 2, shall be negative: with the wrong sign the row couples the
    /// node to itself as a source, and the local system loses its diagonal.
    pub negative_diagonal: bool,
    /// What is known of the gradient at the node.
    pub slopes: Slopes,
    /// g of the weights where a hole smaller than the spacing makes a clump in the star.
    pub evening: f64,
}

/// Choices and g that are tried, one after the other, where the star as it was asked for has a wrong sign or, where `evening` is given, a
/// clump.
fn remedies(asked: StarChoice, evening: Option<f64>) -> impl Iterator<Item = (StarChoice, f64)> {
    let first = evening.or_else(|| (asked != StarChoice::Balanced).then_some(0.0));
    let flatter = FLATTER.into_iter().filter(move |g| evening.is_none_or(|evening| *g > evening));
    first.into_iter().chain(flatter).map(|g| (StarChoice::Balanced, g))
}

/// Finds the star of `node` that carries what is demanded, or a polynomial of the highest lower order; its nodes into
/// `star`, its factorised system into `mwls`.
pub(crate) fn sound_star(
    finder: &mut StarFinder,
    mwls: &mut Mwls,
    node: NodeId,
    demand: Demand,
    star: &mut Vec<NodeId>,
) -> StarOutcome {
    let asked = finder.choice();
    for order in (1..=demand.order).rev() {
        let first_size = if order == demand.order { demand.size } else { default_star(order) }.max(n_monomials(order));
        let demand = Demand { order, negative_diagonal: demand.negative_diagonal && order == 2, ..demand };
        let mut best: Option<Candidate> = None;
        let mut is_last_best = false;
        let mut further = None;
        let mut way: Option<(StarChoice, f64)> = Some((asked, 0.0));
        while let Some((choice, g)) = way {
            finder.choose(choice);
            let demand = Demand { flattening: g.max(demand.smoothing), ..demand };
            let mut last_found = 0;
            for wanted in sizes(first_size, order) {
                let candidate = try_star(finder, mwls, node, demand, wanted, star);
                is_last_best = false;
                if star.len() == last_found {
                    break; // no more nodes are visible
                }
                last_found = star.len();
                if best.is_none_or(|best| candidate.rank() < best.rank()) {
                    best = Some(candidate);
                    is_last_best = true;
                }
                let is_sound = candidate.condition <= SOUND_CONDITION[order] && !candidate.wrong_sign;
                if is_sound || candidate.clumped {
                    break;
                }
            }
            let evening = best.is_some_and(|best| best.clumped).then_some(demand.evening);
            let is_settled = best.is_some_and(|best| !best.wrong_sign && !best.clumped);
            way = if is_settled { None } else { further.get_or_insert_with(|| remedies(asked, evening)).next() };
        }
        if let Some(best) = best.filter(|best| best.condition <= MAX_CONDITION) {
            let Candidate { choice, flattening, wanted, hidden, condition, wrong_sign, .. } = best;
            if !is_last_best {
                finder.choose(choice);
                try_star(finder, mwls, node, Demand { flattening, ..demand }, wanted, star);
            }
            finder.choose(asked);
            let enlarged = wanted > first_size;
            let flattening = if flattening > demand.smoothing { flattening } else { 0.0 };
            return StarOutcome { order, enlarged, hidden, condition, wrong_sign, flattening };
        }
        finder.choose(asked);
    }
    StarOutcome { enlarged: true, condition: f64::INFINITY, ..StarOutcome::default() }
}

/// The nearest nodes for a polynomial of `order`; returns how many hidden ones were passed over.
pub(crate) fn find_star(
    finder: &mut StarFinder,
    node: NodeId,
    wanted: usize,
    order: usize,
    star: &mut Vec<NodeId>,
) -> usize {
    if order < WHOLE_SHELLS { finder.find(node, wanted, star) } else { finder.find_shells(node, wanted, star) }
}

/// A star that was tried.
#[derive(Clone, Copy)]
struct Candidate {
    choice: StarChoice,
    flattening: f64,
    wanted: usize,
    hidden: usize,
    condition: f64,
    wrong_sign: bool,
    clumped: bool, // by steep weights
}

impl Candidate {
    /// Smaller is better: what cannot be used, then clumps, then signs, then conditions.
    fn rank(&self) -> (bool, bool, bool, f64) {
        (self.condition > MAX_CONDITION, self.clumped, self.wrong_sign, self.condition)
    }
}

fn try_star(
    finder: &mut StarFinder,
    mwls: &mut Mwls,
    node: NodeId,
    demand: Demand,
    wanted: usize,
    star: &mut Vec<NodeId>,
) -> Candidate {
    let hidden = find_star(finder, node, wanted, demand.order, star);
    let places = finder.surroundings().stretched();
    let condition = match star.iter().position(|n| *n == node) {
        Some(centre) => {
            let met = (demand.smoothing == 0.0).then_some(centre);
            let points = star.iter().map(|n| places[n.index()]);
            mwls.factorise_meeting(points, places[node.index()], met, demand.slopes, demand.order, demand.flattening)
        }
        None => f64::INFINITY,
    };
    let wrong_sign = demand.negative_diagonal
        && condition <= MAX_CONDITION
        && laplacian_diagonal(mwls, finder, star.iter().position(|n| *n == node)) >= 0.0;
    let clumped = demand.flattening < demand.evening && finder.surroundings().is_clumped(star, mwls.radius());
    Candidate { choice: finder.choice(), flattening: demand.flattening, wanted, hidden, condition, wrong_sign, clumped }
}

/// The node's own coefficient in its ∇² row, in scaled coordinates: ∇² of the polynomial through 1 at the node, 0 at the
/// others.
fn laplacian_diagonal(mwls: &mut Mwls, finder: &StarFinder, centre: Option<usize>) -> f64 {
    let mut fitted = [0.0; MAX_MONOMIALS];
    mwls.fit(|k| if Some(k) == centre { 1.0 } else { 0.0 }, &mut fitted);
    let [s_x, s_y] = finder.surroundings().metric().stretch();
    fitted[row(2, 0)] * s_x * s_x + fitted[row(0, 2)] * s_y * s_y
}
