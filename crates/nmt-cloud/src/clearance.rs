//! Which grid points become interior nodes: inside, and clear of the boundary; paper, eqs (7)–(9) \[D6\]\[D7\].

use crate::census::Census;
use crate::lattice::Lattice;
use crate::section::ClearanceUnit;
use nmt_geom::point::sub;
use nmt_geom::tol::{CLEARANCE_SLACK_REL, SAME_POINT_REL};
use nmt_geom::{Bbox, LoopId, Point, RealBoundary, SegmentIndex, segment, side};
use std::cmp::Ordering;

/// The least distances of an interior node, already less the slack of \[D7\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clearance {
    /// From every segment of the real boundary, user's length unit.
    pub segment: f64,
    /// From every boundary node, user's length unit.
    pub node: f64,
    /// Factors of x and y, each at least 1, of the coordinates that distances are measured in: 1 and 1, or for
    /// [`ClearanceUnit::Scaled`] those that make both spacings max(h_x, h_y).
    pub stretch: [f64; 2],
}

impl Clearance {
    /// No least distance: of clouds that were not generated here.
    pub const NONE: Self = Self { segment: 0.0, node: 0.0, stretch: [1.0; 2] };

    /// `edge` and `node` are fractions of the spacing, ⅓ and ½ in the paper; `size` is the diagonal of the envelope.
    pub fn new(lattice: &Lattice, size: f64, unit: ClearanceUnit, edge: f64, node: f64) -> Self {
        let spacing = lattice.spacing();
        let h = spacing[0].max(spacing[1]);
        let stretch = match unit {
            ClearanceUnit::Max => [1.0; 2],
            ClearanceUnit::Scaled => spacing.map(|own| h / own),
        };
        Self::stretched_by(stretch, h, size, edge, node)
    }

    /// For the spacing `h`, the same along x and y: of a node of a graded cloud.
    pub fn of_spacing(h: f64, size: f64, edge: f64, node: f64) -> Self {
        Self::stretched_by([1.0; 2], h, size, edge, node)
    }

    fn stretched_by(stretch: [f64; 2], h: f64, size: f64, edge: f64, node: f64) -> Self {
        let slack = CLEARANCE_SLACK_REL * size * stretch[0].max(stretch[1]);
        // Even without clearance a node is no point of the boundary.
        let least = SAME_POINT_REL * size;
        let limit = |fraction: f64| (fraction * h - slack).max(least);
        Self { segment: limit(edge), node: limit(node), stretch }
    }

    /// The larger of the two.
    pub fn reach(&self) -> f64 {
        self.segment.max(self.node)
    }

    /// How far along x and y a distance of `reach` extends, user's length unit.
    pub(crate) fn extent(&self, reach: f64) -> [f64; 2] {
        self.stretch.map(|factor| reach / factor)
    }

    fn stretched(&self, p: Point) -> Point {
        [p[0] * self.stretch[0], p[1] * self.stretch[1]]
    }

    /// Distance of `p` from the segment `a b` in the stretched coordinates.
    fn distance(&self, p: Point, a: Point, b: Point) -> f64 {
        segment::distance_to(self.stretched(p), self.stretched(a), self.stretched(b))
    }

    /// True where `p` keeps both distances; `index` holds the segments of the real boundary.
    pub fn holds(&self, p: Point, index: &SegmentIndex) -> bool {
        let window = Bbox::of([p]).grown(self.extent(self.reach()));
        !index.any_in(&window, |k| {
            let [a, b] = index.segment(k);
            self.distance(p, a, b) < self.segment
                || self.distance(p, a, a) < self.node
                || self.distance(p, b, b) < self.node
        })
    }
}

/// What became of a grid point; the first that applies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
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
    abscissae: Vec<f64>, // of the columns, N_x of them
    fates: Vec<Fate>,    // shape (N_y − 2, N_x − 2)
}

impl<'a> Sieve<'a> {
    /// Sieves every interior grid point in O(points + boundary segments): even–odd crossings of each row with the
    /// boundary, then the surroundings of each segment.
    pub fn new(lattice: &'a Lattice, boundary: &RealBoundary, clearance: &Clearance) -> Self {
        let [columns, rows] = lattice.interior_shape();
        let abscissae = (0..lattice.shape[0]).map(|i| lattice.coordinate(0, i)).collect();
        let mut sieve = Self { lattice, abscissae, fates: vec![Fate::Kept; columns * rows] };
        if columns > 0 && rows > 0 {
            sieve.mark_outside(boundary);
            sieve.mark_near(boundary, clearance);
        }
        sieve
    }

    fn slot(&self, i: usize, j: usize) -> usize {
        (j - 1) * self.lattice.interior_shape()[0] + i - 1
    }

    /// Ray casting (`internal_point`), a row at a time: sites left of an odd number of crossings are inside.
    fn mark_outside(&mut self, boundary: &RealBoundary) {
        let [columns, rows] = self.lattice.interior_shape();
        let mut crossings: Vec<Crossing> = Vec::new();
        let mut on_boundary: Vec<(usize, Fate)> = Vec::new();
        for ring in 0..boundary.n_loops() {
            let fate = if ring > 0 { Fate::InHole } else { Fate::Outside };
            for s in boundary.loop_segments(LoopId::of(ring)) {
                let [a, b] = boundary.ends(s);
                self.sites_on(a, b, |slot| on_boundary.push((slot, fate)));
                for j in self.lattice.interior_range(1, a[1].min(b[1]), a[1].max(b[1])) {
                    let y = self.lattice.coordinate(1, j);
                    if (a[1] > y) != (b[1] > y) {
                        let column = self.first_right_of(a, b, y) as u32;
                        crossings.push(Crossing { row: j as u32, column, hole: ring > 0 });
                    }
                }
            }
        }
        crossings.sort_unstable_by_key(|c| (c.row, c.column));
        let mut next = crossings.into_iter().peekable();
        for (j, row) in (1..=rows as u32).zip(self.fates.chunks_mut(columns)) {
            let (mut in_contour, mut in_hole, mut from) = (false, false, 1);
            let fate = |in_contour: bool, in_hole: bool| match (in_contour, in_hole) {
                (false, _) => Fate::Outside,
                (true, true) => Fate::InHole,
                (true, false) => Fate::Kept,
            };
            while let Some(c) = next.next_if(|c| c.row == j) {
                let to = (c.column as usize).clamp(from, columns + 1);
                row[from - 1..to - 1].fill(fate(in_contour, in_hole));
                from = to;
                if c.hole {
                    in_hole = !in_hole;
                } else {
                    in_contour = !in_contour;
                }
            }
            row[from - 1..].fill(fate(in_contour, in_hole));
        }
        for (slot, fate) in on_boundary {
            self.fates[slot] = fate;
        }
    }

    /// The first column whose site at height `y` is not strictly left of the segment; exact.
    fn first_right_of(&self, a: Point, b: Point, y: f64) -> usize {
        let (low, high) = if a[1] < b[1] { (a, b) } else { (b, a) };
        let x = low[0] + (y - low[1]) / (high[1] - low[1]) * (high[0] - low[0]);
        let is_left = |i: usize| side(low, high, [self.abscissae[i], y]) == Ordering::Greater;
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
                if segment::contains([self.abscissae[i], y], a, b) {
                    visit(self.slot(i, j));
                }
            }
        }
    }

    fn mark_near(&mut self, boundary: &RealBoundary, clearance: &Clearance) {
        let lattice = self.lattice;
        let segments = boundary.all_ends();
        sites_near(lattice, segments, clearance, clearance.segment, |i, j| self.doom(i, j, Fate::NearEdge));
        let nodes = boundary.all_ends().map(|[a, _]| [a, a]);
        sites_near(lattice, nodes, clearance, clearance.node, |i, j| self.doom(i, j, Fate::NearNode));
    }

    fn doom(&mut self, i: usize, j: usize, fate: Fate) {
        let slot = self.slot(i, j);
        if self.fates[slot] == Fate::Kept {
            self.fates[slot] = fate;
        }
    }

    /// Calls `visit` with the kept sites, row by row: the number of the site, j·N_x + i, and its place.
    pub fn kept(&self, mut visit: impl FnMut(u32, Point)) {
        let columns = self.lattice.interior_shape()[0].max(1);
        for (row, j) in self.fates.chunks(columns).zip(1..) {
            let y = self.lattice.coordinate(1, j);
            for (fate, i) in row.iter().zip(1..) {
                if *fate == Fate::Kept {
                    visit(self.lattice.number(i, j), [self.abscissae[i], y]);
                }
            }
        }
    }

    /// Counts by cause.
    pub fn census(&self) -> Census {
        let mut counts = [0usize; 5];
        for &fate in &self.fates {
            counts[fate as usize] += 1;
        }
        let count = |fate: Fate| counts[fate as usize];
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

/// Where a row of the grid crosses the boundary.
#[derive(Clone, Copy, Debug)]
struct Crossing {
    row: u32,
    column: u32, // the first site right of it
    hole: bool,
}

/// A set of interior sites, a bit each.
pub(crate) struct SiteSet(Vec<u64>);

impl SiteSet {
    /// The sites nearer to the boundary than `reach`, distances being those of `clearance`.
    pub fn near(lattice: &Lattice, boundary: &RealBoundary, clearance: &Clearance, reach: f64) -> Self {
        let mut set = Self(vec![0; lattice.shape[0] * lattice.shape[1] / 64 + 1]);
        sites_near(lattice, boundary.all_ends(), clearance, reach, |i, j| {
            let site = lattice.number(i, j);
            set.0[site as usize / 64] |= 1 << (site % 64);
        });
        set
    }

    /// True where the site of this number is in it.
    pub fn contains(&self, site: u32) -> bool {
        self.0[site as usize / 64] >> (site % 64) & 1 == 1
    }
}

/// Segments in a row that are looked at together, at most, and how far they may extend, as a fraction of the radius asked
/// for: where the boundary is much finer than the grid, whole rows of segments are near to the same sites.
const MOST_IN_A_ROW: usize = 256;
const ROW_EXTENT: f64 = 0.25;

/// Calls `visit` with every interior site nearer than `radius` to one of the segments, distances being those of
/// `clearance`; with some more than once. Segments that follow each other should be neighbours.
fn sites_near(
    lattice: &Lattice,
    segments: impl IntoIterator<Item = [Point; 2]>,
    clearance: &Clearance,
    radius: f64,
    mut visit: impl FnMut(usize, usize),
) {
    let most = clearance.extent(ROW_EXTENT * radius);
    let mut row: Vec<[Point; 2]> = Vec::with_capacity(MOST_IN_A_ROW);
    let mut envelope = Bbox::EMPTY;
    for [a, b] in segments {
        let mut grown = envelope;
        grown.include(a);
        grown.include(b);
        let together = grown.width() <= most[0] && grown.height() <= most[1] && row.len() < MOST_IN_A_ROW;
        if !together && !row.is_empty() {
            sites_near_row(lattice, &row, envelope, clearance, radius, &mut visit);
            row.clear();
            grown = Bbox::of([a, b]);
        }
        envelope = grown;
        row.push([a, b]);
    }
    if !row.is_empty() {
        sites_near_row(lattice, &row, envelope, clearance, radius, &mut visit);
    }
}

/// The same for the segments of a row within a common envelope: most sites are near all of them or none.
fn sites_near_row(
    lattice: &Lattice,
    row: &[[Point; 2]],
    envelope: Bbox,
    clearance: &Clearance,
    radius: f64,
    visit: &mut impl FnMut(usize, usize),
) {
    if let [[a, b]] = *row {
        return sites_near_one(lattice, a, b, clearance, radius, visit);
    }
    let Bbox { min, max } = envelope;
    let [reach_x, reach_y] = clearance.extent(radius);
    let squared = |x: f64, y: f64| (x * clearance.stretch[0]).powi(2) + (y * clearance.stretch[1]).powi(2);
    // Squares, and a hair to either side: what is nearer to the limit than rounding is decided segment by segment.
    let (surely, hardly) = (radius * radius * (1.0 - 1e-9), radius * radius * (1.0 + 1e-9));
    for j in lattice.interior_range(1, min[1] - reach_y, max[1] + reach_y) {
        let y = lattice.coordinate(1, j);
        let (near_y, far_y) = ((min[1] - y).max(y - max[1]).max(0.0), (max[1] - y).max(y - min[1]));
        for i in lattice.interior_range(0, min[0] - reach_x, max[0] + reach_x) {
            let x = lattice.coordinate(0, i);
            let (near_x, far_x) = ((min[0] - x).max(x - max[0]).max(0.0), (max[0] - x).max(x - min[0]));
            if squared(near_x, near_y) > hardly {
                continue;
            }
            let within = |&[a, b]: &[Point; 2]| clearance.distance([x, y], a, b) < radius;
            if squared(far_x, far_y) < surely || row.iter().any(within) {
                visit(i, j);
            }
        }
    }
}

/// The same for one segment, row by row of the grid.
fn sites_near_one(
    lattice: &Lattice,
    a: Point,
    b: Point,
    clearance: &Clearance,
    radius: f64,
    visit: &mut impl FnMut(usize, usize),
) {
    let [reach_x, reach_y] = clearance.extent(radius);
    let (low, high) = if a[1] <= b[1] { (a, b) } else { (b, a) };
    let slope = (high[0] - low[0]) / (high[1] - low[1]);
    for j in lattice.interior_range(1, low[1] - reach_y, high[1] + reach_y) {
        let y = lattice.coordinate(1, j);
        // Where the segment is nearer to the row than `radius`, its abscissae span this.
        let x_at = |y: f64| low[0] + (y.clamp(low[1], high[1]) - low[1]) * slope;
        let (x0, x1) = if slope.is_finite() { (x_at(y - reach_y), x_at(y + reach_y)) } else { (a[0], b[0]) };
        for i in lattice.interior_range(0, x0.min(x1) - reach_x, x0.max(x1) + reach_x) {
            if clearance.distance([lattice.coordinate(0, i), y], a, b) < radius {
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
        let sieve = Sieve::new(&lattice, &triangle, &Clearance::NONE);
        // Strictly inside: i + j < 8 with i, j from 1 to 7: 21 of 49.
        assert_eq!(sieve.census(), Census { grid: 49, outside: 28, kept: 21, ..Census::default() });
    }

    proptest! {
        #[test]
        fn the_sieve_agrees_with_a_test_of_every_point_against_every_segment(
            radii in prop::collection::vec(1u32..6, 5..12),
            shape in prop::array::uniform2(3usize..24),
            unit in prop::sample::select(ClearanceUnit::ALL.to_vec()),
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
            let clearance = Clearance::new(&lattice, size, unit, 1.0 / 3.0, 0.5);
            let mut kept = Vec::new();
            Sieve::new(&lattice, &boundary, &clearance).kept(|number, p| kept.push((number, p)));
            let index = boundary.index();
            for j in 1..shape[1] - 1 {
                for i in 1..shape[0] - 1 {
                    let p = lattice.site(i, j);
                    let expected = index.locate(p) == Location::Inside && clearance.holds(p, index);
                    prop_assert_eq!(kept.contains(&(lattice.number(i, j), p)), expected, "site ({}, {}) at {:?}", i, j, p);
                }
            }
        }
    }
}
