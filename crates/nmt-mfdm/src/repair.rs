//! A star that cannot carry its polynomial is enlarged, then the order is lowered; who it was is kept.

use crate::basis::n_monomials;
use crate::mwls::{MAX_CONDITION, Mwls};
use crate::star::{StarFinder, default_star};
use nmt_geom::{NodeId, Point};

/// A star is enlarged to at most this many times its size before the order is lowered.
const MAX_ENLARGEMENT: usize = 2;

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
/// its factorised system into `mwls`.
pub(crate) fn sound_star(
    finder: &mut StarFinder,
    mwls: &mut Mwls,
    xy: &[Point],
    node: NodeId,
    order: usize,
    size: usize,
    star: &mut Vec<NodeId>,
) -> StarOutcome {
    for lower in (1..=order).rev() {
        let first_size = if lower == order { size } else { default_star(lower) }.max(n_monomials(lower));
        let step = (first_size / 4).max(1);
        let mut last_found = 0;
        for wanted in (first_size..=first_size * MAX_ENLARGEMENT).step_by(step) {
            let hidden = finder.find(node, wanted, star);
            if star.len() == last_found {
                break; // no more nodes are visible
            }
            last_found = star.len();
            let Some(centre) = star.iter().position(|n| *n == node) else { break };
            let condition = mwls.factorise(star.iter().map(|n| xy[n.index()]), xy[node.index()], centre, lower);
            if condition <= MAX_CONDITION {
                return StarOutcome { order: lower, enlarged: wanted > first_size, hidden, condition };
            }
        }
    }
    StarOutcome { order: 0, enlarged: true, hidden: 0, condition: f64::INFINITY }
}
