//! Stars: the nearest visible nodes of a point \[D10\].

use crate::visibility::Visibility;
use nmt_cloud::{Nearest, Scratch};
use nmt_geom::point::distance_squared;
use nmt_geom::{NodeId, Point};

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
    xy: &'a [Point],
    nearest: &'a Nearest<'a>,
    visibility: &'a Visibility,
    scratch: Scratch,
    hidden: Vec<f64>, // distance² of the hidden nodes met
}

impl<'a> StarFinder<'a> {
    /// `nearest` indexes the cloud's nodes `xy`.
    pub fn new(xy: &'a [Point], nearest: &'a Nearest<'a>, visibility: &'a Visibility) -> Self {
        Self { xy, nearest, visibility, scratch: Scratch::default(), hidden: Vec::new() }
    }

    /// The `size` visible nodes nearest to `node`, itself included, by number into `out` (fewer where there are no
    /// more); returns how many hidden nodes were passed over.
    pub fn find(&mut self, node: NodeId, size: usize, out: &mut Vec<NodeId>) -> usize {
        let centre = self.xy[node.index()];
        let farthest = |out: &[NodeId]| {
            out.iter().fold(0.0f64, |r, other| r.max(distance_squared(self.xy[other.index()], centre)))
        };
        self.nearest.nearest(centre, size, |_| true, &mut self.scratch, out);
        if self.visibility.all_within(centre, farthest(out).sqrt()) {
            return 0;
        }
        let (visibility, xy, hidden) = (self.visibility, self.xy, &mut self.hidden);
        hidden.clear();
        let accept = |other: NodeId| {
            let visible = visibility.sees(xy, node, other);
            if !visible {
                hidden.push(distance_squared(xy[other.index()], centre));
            }
            visible
        };
        self.nearest.nearest(centre, size, accept, &mut self.scratch, out);
        let limit = farthest(out);
        hidden.iter().filter(|d2| **d2 < limit).count()
    }
}
