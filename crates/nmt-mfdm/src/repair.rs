//! A star that cannot carry its polynomial is enlarged, then the order is lowered; who it was is kept.

use crate::basis::{MAX_ORDER, n_monomials};
use crate::mwls::{MAX_CONDITION, Mwls};
use crate::star::{StarFinder, default_star};
use nmt_geom::{NodeId, Point};

/// A star of order p whose condition number is above `SOUND_CONDITION[p]` is enlarged, to see whether more nodes help;
/// the best one is kept.
///
/// Measured on irregular clouds: stars of order 2 lie between 5 and 60, but one in 10⁵, at a wall, reaches 400, and its
/// polynomial is then wrong by as much as its stress is: J of a square at 41 across is off by 7e-5 with that star, by
/// 1e-5 with 10 nodes in it. Stars of order 3 lie between 100 and 350.
const SOUND_CONDITION: [f64; MAX_ORDER + 1] = [1.0, 20.0, 100.0, 500.0, 3000.0];

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
}

/// Finds the star of `node` that carries a polynomial of `order`, or of the highest lower one; its nodes into `star`,
/// its factorised system into `mwls`. `places` are the stretched coordinates of the nodes.
pub(crate) fn sound_star(
    finder: &mut StarFinder,
    mwls: &mut Mwls,
    places: &[Point],
    node: NodeId,
    order: usize,
    size: usize,
    star: &mut Vec<NodeId>,
) -> StarOutcome {
    for lower in (1..=order).rev() {
        let first_size = if lower == order { size } else { default_star(lower) }.max(n_monomials(lower));
        let mut best: Option<Candidate> = None;
        let mut last_found = 0;
        for wanted in sizes(first_size, lower) {
            let candidate = try_star(finder, mwls, places, node, lower, wanted, star);
            if star.len() == last_found {
                break; // no more nodes are visible
            }
            last_found = star.len();
            if best.is_none_or(|best| candidate.condition < best.condition) {
                best = Some(candidate);
            }
            if candidate.condition <= SOUND_CONDITION[lower] {
                break;
            }
        }
        if let Some(best) = best.filter(|best| best.condition <= MAX_CONDITION) {
            // The star of the last try may not be the best one: find that again.
            let Candidate { wanted, hidden, condition } = best;
            try_star(finder, mwls, places, node, lower, wanted, star);
            return StarOutcome { order: lower, enlarged: wanted > first_size, hidden, condition };
        }
    }
    StarOutcome { order: 0, enlarged: true, hidden: 0, condition: f64::INFINITY }
}

/// A star that was tried.
#[derive(Clone, Copy)]
struct Candidate {
    wanted: usize,
    hidden: usize,
    condition: f64,
}

fn try_star(
    finder: &mut StarFinder,
    mwls: &mut Mwls,
    places: &[Point],
    node: NodeId,
    order: usize,
    wanted: usize,
    star: &mut Vec<NodeId>,
) -> Candidate {
    let hidden = finder.find(node, wanted, star);
    let condition = match star.iter().position(|n| *n == node) {
        Some(centre) => mwls.factorise(star.iter().map(|n| places[n.index()]), places[node.index()], centre, order),
        None => f64::INFINITY,
    };
    Candidate { wanted, hidden, condition }
}
