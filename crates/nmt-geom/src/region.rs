//! A main contour with holes, as polygons: every fault at once, and the overlap of two regions.

use crate::bbox::Bbox;
use crate::ids::LoopId;
use crate::locate::{Crossing, Location, Locator};
use crate::point::{Point, along, sub};
use crate::ring::{self, sides};
use crate::segment;
use crate::segment_index::SegmentIndex;

/// The polygon of a main contour and those of its holes, either orientation; the last corner joins the first.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Region {
    /// Corners of the main contour.
    pub contour: Vec<Point>,
    /// Corners of each hole.
    pub holes: Vec<Vec<Point>>,
}

/// What is wrong with a region; `at` is a point of the plane, in the user's length unit.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum RegionFault {
    /// A loop crosses or touches itself; `segments` are the numbers of the two sides of the polygon.
    SelfIntersection {
        /// The loop.
        ring: LoopId,
        /// Where.
        at: Point,
        /// Sides of that loop's polygon, counted from 0.
        segments: [usize; 2],
    },
    /// A loop encloses nothing.
    ZeroArea {
        /// The loop.
        ring: LoopId,
    },
    /// A hole crosses or touches the main contour.
    HoleMeetsContour {
        /// The hole, counted from 0.
        hole: usize,
        /// Where.
        at: Point,
    },
    /// A hole lies outside the main contour.
    HoleOutside {
        /// The hole, counted from 0.
        hole: usize,
    },
    /// Two holes cross or touch.
    HolesMeet {
        /// The holes, counted from 0.
        holes: [usize; 2],
        /// Where.
        at: Point,
    },
    /// A hole lies within another one.
    HoleInHole {
        /// The inner hole, counted from 0.
        inner: usize,
        /// The outer hole.
        outer: usize,
    },
}

/// Area below this fraction of size² is none.
///
/// A wall of 1e-9 of its length would need 10⁹ nodes along it; rounding of the corners makes an area of 1e-16.
const ZERO_AREA_REL: f64 = 1.0e-12;

impl Region {
    /// The loops, the main contour first.
    pub fn loops(&self) -> impl Iterator<Item = &Vec<Point>> {
        std::iter::once(&self.contour).chain(&self.holes)
    }

    /// Envelope of the main contour.
    pub fn envelope(&self) -> Bbox {
        Bbox::of(self.contour.iter().copied())
    }

    /// A look-up of where points lie: inside is within the main contour and outside the holes.
    pub fn locator(&self) -> Locator {
        Locator::new(self.loops().flat_map(|ring| sides(ring)).map(|(a, b)| [a, b]))
    }

    /// Everything that is wrong with the region, none where it is sound; O(n log n) in the number of sides.
    ///
    /// Loops nearer than `tolerance` (user's length unit) touch. The first fault of each kind between the same loops is
    /// reported.
    ///
    /// ```
    /// use nmt_geom::{Region, RegionFault};
    /// let bow_tie = Region { contour: vec![[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]], holes: vec![] };
    /// assert!(matches!(bow_tie.faults(1e-9)[0], RegionFault::SelfIntersection { at: [0.5, 0.5], .. }));
    /// ```
    pub fn faults(&self, tolerance: f64) -> Vec<RegionFault> {
        self.faults_with(&self.segment_index(), tolerance)
    }

    /// An index of the sides, loop after loop, each side by the number of its first corner.
    pub fn segment_index(&self) -> SegmentIndex {
        SegmentIndex::new(self.loops().flat_map(|ring| sides(ring)).map(|(a, b)| [a, b]))
    }

    /// [`Self::faults`] with the index of its sides.
    pub(crate) fn faults_with(&self, index: &SegmentIndex, tolerance: f64) -> Vec<RegionFault> {
        let mut faults = self.meeting_loops(index, tolerance);
        let size = self.loops().flatten().fold(Bbox::EMPTY, |mut envelope, p| {
            envelope.include(*p);
            envelope
        });
        for (k, ring) in self.loops().enumerate() {
            let crosses_itself =
                faults.iter().any(|f| matches!(f, RegionFault::SelfIntersection { ring, .. } if ring.index() == k));
            let own = Bbox::of(ring.iter().copied()).size();
            if !crosses_itself && ring::signed_area(ring).abs() <= ZERO_AREA_REL * own * size.size().min(own) {
                faults.push(RegionFault::ZeroArea { ring: LoopId::of(k) });
            }
        }
        self.misplaced_holes(index, &mut faults);
        faults
    }

    /// The loop and the number in it of every side of the index.
    fn sides_by_number(&self) -> Vec<Side> {
        let of_loop = |(ring, corners): (usize, &Vec<Point>)| {
            let side = move |number: usize| Side { ring, number };
            (0..corners.len()).map(side)
        };
        self.loops().enumerate().flat_map(of_loop).collect()
    }

    fn meeting_loops(&self, index: &SegmentIndex, tolerance: f64) -> Vec<RegionFault> {
        let names = self.sides_by_number();
        let lengths: Vec<usize> = self.loops().map(Vec::len).collect();
        let mut faults: Vec<RegionFault> = Vec::new();
        let mut reported = std::collections::BTreeSet::new();
        for [i, j] in index.close_pairs(tolerance) {
            let (s, t) = (names[i], names[j]);
            if reported.contains(&(s.ring, t.ring)) {
                continue;
            }
            let ([a, b], [c, d]) = (index.segment(i), index.segment(j));
            let at = if s.ring == t.ring {
                let last = lengths[s.ring] - 1;
                own_sides_meet([a, b], [c, d], t.number == s.number + 1, s.number == 0 && t.number == last)
            } else {
                sides_meet([a, b], [c, d], tolerance)
            };
            let Some(at) = at else { continue };
            reported.insert((s.ring, t.ring));
            faults.push(match (s.ring, t.ring) {
                (r, q) if r == q => {
                    RegionFault::SelfIntersection { ring: LoopId::of(r), at, segments: [s.number, t.number] }
                }
                (0, hole) => RegionFault::HoleMeetsContour { hole: hole - 1, at },
                (r, q) => RegionFault::HolesMeet { holes: [r - 1, q - 1], at },
            });
        }
        faults
    }

    /// Holes that meet no other loop, yet lie outside the contour or in another hole: one corner decides.
    ///
    /// A ray from it crosses the loops around it an odd number of times.
    fn misplaced_holes(&self, index: &SegmentIndex, faults: &mut Vec<RegionFault>) {
        let mut meets = vec![false; self.holes.len()];
        for fault in faults.iter() {
            match fault {
                RegionFault::HoleMeetsContour { hole, .. } => meets[*hole] = true,
                RegionFault::HolesMeet { holes, .. } => holes.iter().for_each(|hole| meets[*hole] = true),
                _ => {}
            }
        }
        let sides = self.sides_by_number();
        let mut crossed: Vec<usize> = Vec::new();
        for (k, hole) in self.holes.iter().enumerate() {
            let (Some(&corner), false) = (hole.first(), meets[k]) else { continue };
            crossed.clear();
            index.crossed_by_ray(corner, |crossing, side| {
                if crossing == Crossing::Right {
                    crossed.push(sides[side].ring);
                }
                false
            });
            crossed.sort_unstable();
            let around = |ring: usize| crossed.iter().filter(|other| **other == ring).count() % 2 == 1;
            if !around(0) {
                faults.push(RegionFault::HoleOutside { hole: k });
                continue;
            }
            let mut others = crossed.clone();
            others.dedup();
            let outer = others.into_iter().find(|&r| r > 0 && r != k + 1 && around(r));
            if let Some(ring) = outer {
                faults.push(RegionFault::HoleInHole { inner: k, outer: ring - 1 });
            }
        }
    }
}

/// A side of a region's polygons.
#[derive(Clone, Copy, Debug)]
struct Side {
    ring: usize,
    number: usize,
}

/// Where two sides of one loop meet, apart from the corner that neighbours share.
fn own_sides_meet(s: [Point; 2], t: [Point; 2], t_follows_s: bool, s_follows_t: bool) -> Option<Point> {
    let [a, b] = s;
    let [c, d] = t;
    if t_follows_s || s_follows_t {
        // Neighbours share a corner; they meet elsewhere only where one folds back along the other.
        let folds = |tip: Point, other: [Point; 2]| segment::contains(tip, other[0], other[1]);
        let (free_s, free_t) = if t_follows_s { (a, d) } else { (b, c) };
        return [(free_t, s), (free_s, t)].into_iter().find(|(tip, other)| folds(*tip, *other)).map(|(tip, _)| tip);
    }
    segment::touch(a, b, c, d).then(|| segment::meeting_point(a, b, c, d))
}

/// Where sides of different loops cross, touch or come within `tolerance`.
fn sides_meet(s: [Point; 2], t: [Point; 2], tolerance: f64) -> Option<Point> {
    let ([a, b], [c, d]) = (s, t);
    if segment::touch(a, b, c, d) {
        return Some(segment::meeting_point(a, b, c, d));
    }
    [(a, t), (b, t), (c, s), (d, s)]
        .into_iter()
        .find(|(p, [q, r])| segment::distance_to(*p, *q, *r) <= tolerance)
        .map(|(p, _)| p)
}

/// A region with an index of its sides, to be compared with many others.
#[derive(Clone, Debug)]
pub struct IndexedRegion {
    index: SegmentIndex,
    contour: Bbox,
}

impl IndexedRegion {
    /// Indexes the sides of a region; O(n log n).
    pub fn new(region: &Region) -> Self {
        Self { index: region.segment_index(), contour: region.envelope() }
    }

    /// Envelope of the main contour.
    pub fn envelope(&self) -> Bbox {
        self.contour
    }

    /// True where `p` is inside and no side is nearer than `depth`.
    fn holds_deep(&self, p: Point, depth: f64) -> bool {
        self.index.locate(p) == Location::Inside && !self.index.any_within(p, depth)
    }

    /// The sides whose boxes meet `window`, in order.
    fn sides_in(&self, window: &Bbox) -> Vec<[Point; 2]> {
        let mut numbers = Vec::new();
        self.index.any_in(window, |k| {
            numbers.push(k);
            false
        });
        numbers.sort_unstable();
        numbers.into_iter().map(|k| self.index.segment(k)).collect()
    }
}

/// A point that lies in the interior of both regions by more than about `tolerance`; `None` where they are apart,
/// adjacent, or one fills a hole of the other. O(m log n), m the sides of either within the envelope of the other.
///
/// Both regions must be free of [`Region::faults`].
///
/// ```
/// use nmt_geom::{IndexedRegion, Region, overlap};
/// let square = |x: f64| {
///     let contour = vec![[x, 0.0], [x + 1.0, 0.0], [x + 1.0, 1.0], [x, 1.0]];
///     IndexedRegion::new(&Region { contour, holes: vec![] })
/// };
/// assert_eq!(overlap(&square(0.0), &square(1.0), 1e-9), None); // a common side
/// assert!(overlap(&square(0.0), &square(0.9), 1e-9).is_some());
/// ```
pub fn overlap(a: &IndexedRegion, b: &IndexedRegion, tolerance: f64) -> Option<Point> {
    if !a.envelope().overlaps(&b.envelope(), 0.0) {
        return None;
    }
    // Where two sides cross, the points just beside the crossing, in the four quadrants, decide: one of them is inside
    // both regions unless the crossing is the noise of a common edge. Otherwise one region holds the other's corners,
    // or both are the same: a point beside each side, on its inner side, decides.
    let sides_of_a = a.sides_in(&b.envelope().grown([tolerance; 2]));
    let sides_of_b = b.sides_in(&a.envelope().grown([tolerance; 2]));
    // The smaller region first: it refuses most points, and at less cost.
    let (small, large) = if a.index.len() <= b.index.len() { (a, b) } else { (b, a) };
    let in_both = |p: &Point| small.holds_deep(*p, tolerance) && large.holds_deep(*p, tolerance);
    let crossings = proper_crossings(a, &sides_of_b, tolerance);
    crossings
        .into_iter()
        .flat_map(|(at, reach)| quadrants(at, reach))
        .find(in_both)
        .or_else(|| sides_of_a.into_iter().flat_map(|side| points_beside(side, tolerance)).find(in_both))
        .or_else(|| sides_of_b.into_iter().flat_map(|side| points_beside(side, tolerance)).find(in_both))
}

fn proper_crossings(a: &IndexedRegion, sides: &[[Point; 2]], tolerance: f64) -> Vec<(Point, [Point; 2])> {
    let mut found = Vec::new();
    for &[c, d] in sides {
        a.index.candidates(c, d, tolerance, |k| {
            let [p, q] = a.index.segment(k);
            if segment::cross_properly(p, q, c, d, tolerance) {
                found.push((segment::meeting_point(p, q, c, d), [sub(q, p), sub(d, c)]));
            }
        });
    }
    found
}

/// Points beside a crossing, along the four bisectors of the two directions, at shrinking distances.
fn quadrants(at: Point, directions: [Point; 2]) -> Vec<Point> {
    let mut points = Vec::new();
    for scale in [0.25, 0.02, 1e-3, 1e-5] {
        for (s, t) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
            points.push(along(along(at, s * scale, directions[0]), t * scale, directions[1]));
        }
    }
    points
}

/// Points beside the middle of a side, on either side of it, at two depths.
fn points_beside([p, q]: [Point; 2], tolerance: f64) -> Vec<Point> {
    let (v, middle) = (sub(q, p), along(p, 0.5, sub(q, p)));
    let length = v[0].hypot(v[1]);
    if length <= tolerance {
        return Vec::new();
    }
    let normal = [-v[1] / length, v[0] / length];
    let depths = [0.1 * length, 4.0 * tolerance];
    depths.into_iter().flat_map(|depth| [depth, -depth]).map(|side| along(middle, side, normal)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(x: f64, y: f64, side: f64) -> Vec<Point> {
        vec![[x, y], [x + side, y], [x + side, y + side], [x, y + side]]
    }

    fn region(contour: Vec<Point>, holes: Vec<Vec<Point>>) -> Region {
        Region { contour, holes }
    }

    fn common_point(a: &Region, b: &Region) -> Option<Point> {
        overlap(&IndexedRegion::new(a), &IndexedRegion::new(b), 1e-8)
    }

    #[test]
    fn a_plate_with_thousands_of_holes_is_checked_quickly() {
        // Each pair of loops would be 10⁸ comparisons: this takes some hundredths of a second.
        let n = 100;
        let place = |k: usize| ((k % n) as f64, (k / n) as f64);
        let mut holes: Vec<Vec<Point>> =
            (0..n * n).map(|k| square(place(k).0 + 0.25, place(k).1 + 0.25, 0.5)).collect();
        let plate = |holes: &[Vec<Point>]| region(square(0.0, 0.0, n as f64), holes.to_vec());
        assert_eq!(plate(&holes).faults(1e-9), vec![]);
        let whole = plate(&holes);
        let indexed = IndexedRegion::new(&whole);
        for hole in holes.iter().step_by(7) {
            assert_eq!(overlap(&indexed, &IndexedRegion::new(&region(hole.clone(), vec![])), 1e-7), None);
        }
        // One hole in another, one beyond the plate, two that share a side.
        holes[5000] = square(place(5001).0 + 0.3, place(5001).1 + 0.3, 0.1);
        holes[17] = square(-2.0, -2.0, 0.5);
        holes[9999] = square(place(9998).0 + 0.75, place(9998).1 + 0.25, 0.5);
        let faults = plate(&holes).faults(1e-9);
        assert!(faults.contains(&RegionFault::HoleInHole { inner: 5000, outer: 5001 }), "{faults:?}");
        assert!(faults.contains(&RegionFault::HoleOutside { hole: 17 }), "{faults:?}");
        assert!(matches!(faults[0], RegionFault::HolesMeet { holes: [9998, 9999], .. }), "{faults:?}");
        assert_eq!(faults.len(), 3);
    }

    #[test]
    fn a_square_with_two_holes_apart_is_sound() {
        let r = region(square(0.0, 0.0, 4.0), vec![square(0.5, 0.5, 1.0), square(2.0, 2.0, 1.0)]);
        assert_eq!(r.faults(1e-9), vec![]);
    }

    #[test]
    fn every_misplaced_hole_is_named() {
        let holes = vec![
            square(5.0, 0.0, 1.0),
            square(3.5, 3.5, 1.0),
            square(0.5, 0.5, 2.0),
            square(1.0, 1.0, 0.5),
            square(2.25, 0.2, 0.5),
        ];
        let faults = region(square(0.0, 0.0, 4.0), holes).faults(1e-9);
        assert!(faults.contains(&RegionFault::HoleOutside { hole: 0 }), "{faults:?}");
        assert!(faults.iter().any(|f| matches!(f, RegionFault::HoleMeetsContour { hole: 1, .. })), "{faults:?}");
        assert!(faults.contains(&RegionFault::HoleInHole { inner: 3, outer: 2 }), "{faults:?}");
        assert!(faults.iter().any(|f| matches!(f, RegionFault::HolesMeet { holes: [2, 4], .. })), "{faults:?}");
        assert_eq!(faults.len(), 4, "{faults:?}");
    }

    #[test]
    fn a_vertex_on_another_side_and_a_fold_are_self_intersections() {
        let touching = vec![[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [2.0, 0.0], [0.0, 4.0]];
        let fold = vec![[0.0, 0.0], [4.0, 0.0], [2.0, 0.0], [2.0, 2.0]];
        for (contour, at) in [(touching, [2.0, 0.0]), (fold, [2.0, 0.0])] {
            let faults = region(contour, vec![]).faults(1e-9);
            assert!(matches!(faults[..], [RegionFault::SelfIntersection { at: p, .. }] if p == at), "{faults:?}");
        }
    }

    #[test]
    fn points_in_a_row_enclose_nothing() {
        let faults = region(vec![[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]], vec![]).faults(1e-9);
        assert!(!faults.is_empty());
    }

    #[test]
    fn adjacent_regions_and_a_filled_hole_do_not_overlap() {
        let a = region(square(0.0, 0.0, 2.0), vec![square(0.5, 0.5, 1.0)]);
        let beside = region(vec![[2.0, 0.0], [4.0, 0.0], [2.0, 2.0]], vec![]);
        let inclusion = region(square(0.5, 0.5, 1.0), vec![]);
        assert_eq!(common_point(&a, &beside), None);
        assert_eq!(common_point(&a, &inclusion), None);
        assert_eq!(common_point(&inclusion, &a), None);
    }

    #[test]
    fn regions_that_cross_contain_or_equal_each_other_overlap() {
        let a = region(square(0.0, 0.0, 2.0), vec![]);
        for b in [square(1.0, 1.0, 2.0), square(0.5, 0.5, 1.0), square(0.0, 0.0, 2.0), square(0.0, 0.0, 1.0)] {
            let b = region(b, vec![]);
            assert!(common_point(&a, &b).is_some(), "{b:?}");
            assert!(common_point(&b, &a).is_some(), "{b:?}");
        }
        let cross = region(vec![[-1.0, 0.5], [3.0, 0.5], [3.0, 1.5], [-1.0, 1.5]], vec![]);
        assert!(common_point(&a, &cross).is_some());
    }
}
