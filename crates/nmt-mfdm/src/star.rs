//! Stars: the nearest visible nodes of a point \[D10\].

use crate::surroundings::Surroundings;
use nmt_cloud::{Nearest, Scratch};
use nmt_geom::NodeId;
use nmt_geom::point::distance_squared;

/// Nodes in a star by default, the centre included: 6, 9, 20, 30 for orders 1 to 4.
pub fn default_star(order: usize) -> usize {
    match order {
        1 => 6,
        2 => 9,
        3 => 20,
        _ => 30,
    }
}

/// Chooses stars; one a thread, with room to be used again.
pub struct StarFinder<'a> {
    surroundings: &'a Surroundings<'a>,
    nearest: &'a Nearest<'a>,
    scratch: Scratch,
    hidden: Vec<f64>, // distance² of the hidden nodes met
}

impl<'a> StarFinder<'a> {
    /// `nearest` is that of `surroundings`.
    pub fn new(surroundings: &'a Surroundings<'a>, nearest: &'a Nearest<'a>) -> Self {
        Self { surroundings, nearest, scratch: Scratch::default(), hidden: Vec::new() }
    }

    /// The `size` visible nodes nearest to `node`, itself included, by number into `out` (fewer where there are no
    /// more); returns how many hidden nodes were passed over.
    pub fn find(&mut self, node: NodeId, size: usize, out: &mut Vec<NodeId>) -> usize {
        let (surroundings, hidden) = (self.surroundings, &mut self.hidden);
        let places = surroundings.stretched();
        let centre = places[node.index()];
        let farthest =
            |out: &[NodeId]| out.iter().fold(0.0f64, |r, other| r.max(distance_squared(places[other.index()], centre)));
        self.nearest.nearest(centre, size, |_| true, &mut self.scratch, out);
        if surroundings.all_visible(node, farthest(out).sqrt()) {
            return 0;
        }
        hidden.clear();
        let accept = |other: NodeId| {
            let visible = surroundings.sees(node, other);
            if !visible {
                hidden.push(distance_squared(places[other.index()], centre));
            }
            visible
        };
        self.nearest.nearest(centre, size, accept, &mut self.scratch, out);
        let limit = farthest(out);
        hidden.iter().filter(|d2| **d2 < limit).count()
    }
}
