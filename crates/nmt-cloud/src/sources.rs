//! Points and segments that the spacing grows from, many of them: the least of size + growth·distance at a place.

use nmt_geom::point::distance_squared;
use nmt_geom::{Bbox, Point, segment};

/// A spacing along a segment (a point, where its ends are one), and how it grows with the distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Source {
    pub ends: [Point; 2],
    pub size: f64,
    pub growth: f64,
}

impl Source {
    pub fn point(at: Point, size: f64, growth: f64) -> Self {
        Self { ends: [at, at], size, growth }
    }

    #[inline]
    pub fn at(&self, p: Point) -> f64 {
        self.size + self.growth * self.distance(p)
    }

    /// Distance of `p` from the segment.
    #[inline]
    pub fn distance(&self, p: Point) -> f64 {
        let [a, b] = self.ends;
        let q = if a == b { a } else { segment::nearest_point(p, a, b) };
        distance_squared(p, q).sqrt()
    }
}

/// Sources in a leaf.
const IN_A_LEAF: usize = 4;

/// Sources in a tree of boxes: the least at a place is found in O(log n) where it is that of a source nearby.
#[derive(Clone, Debug, Default)]
pub(crate) struct SourceTree {
    sources: Vec<Source>, // in the order of the leaves
    boxes: Vec<TreeBox>,  // a box before its first half, that before the second
}

#[derive(Clone, Copy, Debug)]
struct TreeBox {
    envelope: Bbox,
    size: f64,   // the least
    growth: f64, // the least
    first: u32,  // its sources
    count: u32,  // of a leaf; 0 where it is halved
    second: u32, // the box of its second half
}

impl SourceTree {
    /// O(n log n).
    pub fn new(mut sources: Vec<Source>) -> Self {
        let mut boxes = Vec::with_capacity(sources.len());
        if !sources.is_empty() {
            add_box(&mut boxes, &mut sources, 0);
        }
        Self { sources, boxes }
    }

    /// All sources; their numbers are their places here.
    pub fn sources(&self) -> &[Source] {
        &self.sources
    }

    /// The least of `most` and of what the sources give at `p`.
    pub fn least(&self, p: Point, most: f64) -> f64 {
        let mut best = most;
        if !self.boxes.is_empty() {
            self.descend(0, p, &mut best);
        }
        best
    }

    /// What a box's sources give at least.
    fn bound(&self, at: usize, p: Point) -> f64 {
        let TreeBox { envelope: Bbox { min, max }, size, growth, .. } = self.boxes[at];
        let off = |d: usize| (min[d] - p[d]).max(p[d] - max[d]).max(0.0);
        size + growth * (off(0) * off(0) + off(1) * off(1)).sqrt()
    }

    fn descend(&self, at: usize, p: Point, best: &mut f64) {
        let TreeBox { first, count, second, .. } = self.boxes[at];
        if count > 0 {
            for source in &self.sources[first as usize..(first + count) as usize] {
                *best = best.min(source.at(p));
            }
            return;
        }
        // The more promising half first: it makes the other superfluous more often.
        let halves = [at + 1, second as usize].map(|half| (self.bound(half, p), half));
        let [near, far] = if halves[1].0 < halves[0].0 { [halves[1], halves[0]] } else { halves };
        for (bound, half) in [near, far] {
            if bound < *best {
                self.descend(half, p, best);
            }
        }
    }
}

/// Adds the box of `sources`, whose first has number `first`, and those of its halves along its longer side.
fn add_box(boxes: &mut Vec<TreeBox>, sources: &mut [Source], first: u32) {
    let at = boxes.len();
    let envelope = Bbox::of(sources.iter().flat_map(|source| source.ends));
    let least = |of: fn(&Source) -> f64| sources.iter().map(of).fold(f64::INFINITY, f64::min);
    let (size, growth) = (least(|s| s.size), least(|s| s.growth));
    let is_leaf = sources.len() <= IN_A_LEAF;
    let count = if is_leaf { sources.len() as u32 } else { 0 };
    boxes.push(TreeBox { envelope, size, growth, first, count, second: 0 });
    if is_leaf {
        return;
    }
    let d = usize::from(envelope.height() > envelope.width());
    let middle = |s: &Source| s.ends[0][d] + s.ends[1][d];
    let half = sources.len() / 2;
    sources.select_nth_unstable_by(half, |a, b| middle(a).total_cmp(&middle(b)));
    let (front, back) = sources.split_at_mut(half);
    add_box(boxes, front, first);
    boxes[at].second = boxes.len() as u32;
    add_box(boxes, back, first + half as u32);
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_tree_finds_the_least_of_all_sources(
            drawn in prop::collection::vec((prop::array::uniform4(-1.0..1.0f64), 0.001..0.5f64, 0.01..0.5f64, any::<bool>()), 0..60),
            places in prop::collection::vec(prop::array::uniform2(-2.0..2.0f64), 1..20),
        ) {
            let sources: Vec<Source> = drawn.iter().map(|&([a, b, c, d], size, growth, is_point)| {
                Source { ends: [[a, b], if is_point { [a, b] } else { [c, d] }], size, growth }
            }).collect();
            let tree = SourceTree::new(sources.clone());
            for p in places {
                let expected = sources.iter().map(|s| s.at(p)).fold(0.4, f64::min);
                prop_assert_eq!(tree.least(p, 0.4), expected);
            }
        }
    }
}
