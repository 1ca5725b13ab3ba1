//! Which grid points become interior nodes: inside, and clear of the boundary; paper, eqs (7)–(9) \[D6\]\[D7\].

use crate::census::Census;
use crate::lattice::Lattice;
use nmt_geom::point::{distance_squared, sub};
use nmt_geom::tol::CLEARANCE_SLACK_REL;
use nmt_geom::{LoopId, Point, RealBoundary, SegmentIndex, segment, side};
use std::cmp::Ordering;

/// The least distances of an interior node, user's length unit, already less the slack of \[D7\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clearance {
    /// From every segment of the real boundary.
    pub segment: f64,
    /// From every boundary node.
    pub node: f64,
}

impl Clearance {
    /// `edge` and `node` are fractions of max(h_x, h_y): ⅓ and ½ in the paper.
    pub fn new(lattice: &Lattice, size: f64, edge: f64, node: f64) -> Self {
        let [h_x, h_y] = lattice.spacing();
        let h = h_x.max(h_y);
        let slack = CLEARANCE_SLACK_REL * size;
        Self { segment: edge * h - slack, node: node * h - slack }
    }

    /// The larger of the two.
    pub fn reach(&self) -> f64 {
        self.segment.max(self.node)
    }

    /// True where `p` keeps both distances; `index` holds the segments of the real boundary.
    pub fn holds(&self, p: Point, index: &SegmentIndex) -> bool {
        let mut clear = true;
        index.candidates(p, p, self.reach(), |k| {
            let [a, b] = index.segment(k);
            clear = clear
                && segment::distance_to(p, a, b) >= self.segment
                && distance_squared(p, a).sqrt() >= self.node
                && distance_squared(p, b).sqrt() >= self.node;
        });
        clear
    }
}

/// What became of a grid point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Fate {
    Kept,
    Outside,
    InHole,
    NearEdge,
    NearNode,
}

/// The interior grid points with their fates, row by row.
pub(crate) struct Sieve<'a> {
    lattice: &'a Lattice,
    fates: Vec<Fate>, // shape (N_y − 2, N_x − 2)
}

impl<'a> Sieve<'a> {
    /// Sieves every interior grid point in O(points + boundary segments): even–odd crossings of each row with the
    /// boundary, then the surroundings of each segment.
    pub fn new(lattice: &'a Lattice, boundary: &RealBoundary, clearance: &Clearance) -> Self {
        let [columns, rows] = lattice.interior_shape();
        let mut sieve = Self { lattice, fates: vec![Fate::Kept; columns * rows] };
        sieve.mark_outside(boundary);
        sieve.mark_near(boundary, clearance);
        sieve
    }

    fn slot(&self, i: usize, j: usize) -> usize {
        (j - 1) * self.lattice.interior_shape()[0] + i - 1
    }

    /// Ray casting (`internal_point`), a row at a time: sites left of an odd number of crossings are inside.
    fn mark_outside(&mut self, boundary: &RealBoundary) {
        let [columns, rows] = self.lattice.interior_shape();
        if columns == 0 || rows == 0 {
            return;
        }
        // (row, first column right of the crossing, is it a hole's?)
        let mut crossings: Vec<(u32, u32, bool)> = Vec::new();
        let mut on_boundary: Vec<(usize, bool)> = Vec::new();
        for ring in 0..boundary.n_loops() {
            let hole = ring > 0;
            for s in boundary.loop_segments(LoopId::of(ring)) {
                let [a, b] = boundary.ends(s);
                self.sites_on(a, b, |slot| on_boundary.push((slot, hole)));
                for j in self.lattice.interior_range(1, a[1].min(b[1]), a[1].max(b[1])) {
                    let y = self.lattice.coordinate(1, j);
                    if (a[1] > y) != (b[1] > y) {
                        crossings.push((j as u32, self.first_right_of(a, b, y) as u32, hole));
                    }
                }
            }
        }
        crossings.sort_unstable();
        let mut next = 0;
        for j in 1..=rows {
            let (mut in_contour, mut in_hole) = (false, false);
            for i in 1..=columns {
                while next < crossings.len() && crossings[next].0 as usize == j && crossings[next].1 as usize <= i {
                    if crossings[next].2 {
                        in_hole = !in_hole
                    } else {
                        in_contour = !in_contour
                    }
                    next += 1;
                }
                let slot = self.slot(i, j);
                if !in_contour {
                    self.fates[slot] = Fate::Outside;
                } else if in_hole {
                    self.fates[slot] = Fate::InHole;
                }
            }
            while next < crossings.len() && crossings[next].0 as usize == j {
                next += 1;
            }
        }
        for (slot, hole) in on_boundary {
            self.fates[slot] = if hole { Fate::InHole } else { Fate::Outside };
        }
    }

    /// The first column whose site at height `y` is not strictly left of the segment; exact.
    fn first_right_of(&self, a: Point, b: Point, y: f64) -> usize {
        let (low, high) = if a[1] < b[1] { (a, b) } else { (b, a) };
        let x = low[0] + (y - low[1]) / (high[1] - low[1]) * (high[0] - low[0]);
        let is_left = |i: usize| side(low, high, [self.lattice.coordinate(0, i), y]) == Ordering::Greater;
        let near = self.lattice.interior_range(0, x, x);
        let mut first = near.start;
        while first < near.end && is_left(first) {
            first += 1;
        }
        while first > 1 && !is_left(first - 1) {
            first -= 1;
        }
        first
    }

    /// Calls `visit` with every interior site that lies exactly on the segment.
    fn sites_on(&self, a: Point, b: Point, mut visit: impl FnMut(usize)) {
        let slope = sub(b, a);
        for j in self.lattice.interior_range(1, a[1].min(b[1]), a[1].max(b[1])) {
            let y = self.lattice.coordinate(1, j);
            let (x0, x1) = if slope[1] == 0.0 {
                (a[0].min(b[0]), a[0].max(b[0]))
            } else {
                let x = a[0] + ((y - a[1]) / slope[1]).clamp(0.0, 1.0) * slope[0];
                (x, x)
            };
            for i in self.lattice.interior_range(0, x0, x1) {
                if segment::contains([self.lattice.coordinate(0, i), y], a, b) {
                    visit(self.slot(i, j));
                }
            }
        }
    }

    fn mark_near(&mut self, boundary: &RealBoundary, clearance: &Clearance) {
        let lattice = self.lattice;
        for [a, b] in boundary.all_ends() {
            sites_near(lattice, a, b, clearance.segment, |i, j| self.doom(i, j, Fate::NearEdge));
        }
        for &p in boundary.xy() {
            sites_near(lattice, p, p, clearance.node, |i, j| self.doom(i, j, Fate::NearNode));
        }
    }

    fn doom(&mut self, i: usize, j: usize, fate: Fate) {
        let slot = self.slot(i, j);
        if self.fates[slot] == Fate::Kept {
            self.fates[slot] = fate;
        }
    }

    /// The kept sites (i, j), row by row.
    pub fn kept(&self) -> impl Iterator<Item = (usize, usize)> {
        let columns = self.lattice.interior_shape()[0];
        let kept = self.fates.iter().enumerate().filter(|(_, fate)| **fate == Fate::Kept);
        kept.map(move |(slot, _)| (slot % columns + 1, slot / columns + 1))
    }

    /// Counts by cause.
    pub fn census(&self) -> Census {
        let count = |fate: Fate| self.fates.iter().filter(|f| **f == fate).count();
        Census {
            grid: self.fates.len(),
            outside: count(Fate::Outside),
            in_hole: count(Fate::InHole),
            near_edge: count(Fate::NearEdge),
            near_node: count(Fate::NearNode),
            kept: count(Fate::Kept),
        }
    }
}

/// Calls `visit` with every interior site nearer than `radius` to the segment `a b`.
pub(crate) fn sites_near(lattice: &Lattice, a: Point, b: Point, radius: f64, mut visit: impl FnMut(usize, usize)) {
    let (low, high) = if a[1] <= b[1] { (a, b) } else { (b, a) };
    let slope = (high[0] - low[0]) / (high[1] - low[1]);
    for j in lattice.interior_range(1, low[1] - radius, high[1] + radius) {
        let y = lattice.coordinate(1, j);
        // Where the segment is nearer to the row than `radius`, its abscissae span this.
        let x_at = |y: f64| low[0] + (y.clamp(low[1], high[1]) - low[1]) * slope;
        let (x0, x1) = if slope.is_finite() { (x_at(y - radius), x_at(y + radius)) } else { (a[0], b[0]) };
        for i in lattice.interior_range(0, x0.min(x1) - radius, x0.max(x1) + radius) {
            if segment::distance_to([lattice.coordinate(0, i), y], a, b) < radius {
                visit(i, j);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nmt_geom::{BoundaryLoop, EdgeId, Location, NodeId};
    use proptest::prelude::*;

    fn polygon(corners: Vec<Point>) -> RealBoundary {
        let n = corners.len() as u32;
        let ring = BoundaryLoop { nodes: (0..n).map(NodeId).collect(), edges: vec![EdgeId(0); n as usize] };
        RealBoundary::new(corners, vec![ring]).expect("a polygon of at least three corners")
    }

    fn envelope_lattice(boundary: &RealBoundary, shape: [usize; 2]) -> Lattice {
        Lattice::new(boundary.envelope(), shape)
    }

    #[test]
    fn grid_points_exactly_on_a_skew_edge_are_outside_even_without_clearance() {
        let triangle = polygon(vec![[0.0, 0.0], [4.0, 0.0], [0.0, 4.0]]);
        let lattice = envelope_lattice(&triangle, [9, 9]);
        let none = Clearance { segment: 0.0, node: 0.0 };
        let sieve = Sieve::new(&lattice, &triangle, &none);
        // Strictly inside: i + j < 8 with i, j from 1 to 7: 21 of 49.
        assert_eq!(sieve.census(), Census { grid: 49, outside: 28, kept: 21, ..Census::default() });
    }

    proptest! {
        #[test]
        fn the_sieve_agrees_with_a_test_of_every_point_against_every_segment(
            radii in prop::collection::vec(1u32..6, 5..12),
            shape in prop::array::uniform2(3usize..24),
        ) {
            // A star-shaped polygon with small integer radii: many ties.
            let n = radii.len() as f64;
            let corner = |(k, r): (usize, &u32)| {
                let t = std::f64::consts::TAU * k as f64 / n;
                [(f64::from(*r) * t.cos() * 4.0).round(), (f64::from(*r) * t.sin() * 4.0).round()]
            };
            let corners: Vec<Point> = radii.iter().enumerate().map(corner).collect();
            prop_assume!(nmt_geom::ring::signed_area(&corners) > 1.0);
            let boundary = polygon(corners);
            prop_assume!(boundary.faults().is_empty());
            let lattice = envelope_lattice(&boundary, shape);
            let size = boundary.envelope().size();
            let clearance = Clearance::new(&lattice, size, 1.0 / 3.0, 0.5);
            let kept: Vec<_> = Sieve::new(&lattice, &boundary, &clearance).kept().collect();
            let (locator, index) = (boundary.locator(), boundary.segment_index());
            for j in 1..shape[1] - 1 {
                for i in 1..shape[0] - 1 {
                    let p = lattice.site(i, j);
                    let expected = locator.locate(p) == Location::Inside && clearance.holds(p, &index);
                    prop_assert_eq!(kept.contains(&(i, j)), expected, "site ({}, {}) at {:?}", i, j, p);
                }
            }
        }
    }
}
