//! A main contour with holes, as polygons: every fault at once, and the overlap of two regions.

use crate::bbox::Bbox;
use crate::ids::LoopId;
use crate::locate::{Location, Locator};
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
        let mut faults = self.meeting_loops(tolerance);
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
        self.misplaced_holes(&mut faults);
        faults
    }

    fn meeting_loops(&self, tolerance: f64) -> Vec<RegionFault> {
        struct Side {
            ring: usize,
            number: usize,
        }
        let names: Vec<Side> = self
            .loops()
            .enumerate()
            .flat_map(|(ring, corners)| (0..corners.len()).map(move |number| Side { ring, number }))
            .collect();
        let index = SegmentIndex::new(self.loops().flat_map(|ring| sides(ring)).map(|(a, b)| [a, b]));
        let mut faults: Vec<RegionFault> = Vec::new();
        let mut reported = std::collections::BTreeSet::new();
        for [i, j] in index.close_pairs(tolerance) {
            let (s, t) = (&names[i], &names[j]);
            if reported.contains(&(s.ring, t.ring)) {
                continue;
            }
            let ([a, b], [c, d]) = (index.segment(i), index.segment(j));
            let at = if s.ring == t.ring {
                let n = self.loops().nth(s.ring).map_or(0, Vec::len);
                own_sides_meet([a, b], [c, d], t.number == s.number + 1, s.number == 0 && t.number == n - 1)
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
    fn misplaced_holes(&self, faults: &mut Vec<RegionFault>) {
        let meets = |hole: usize, faults: &[RegionFault]| {
            faults.iter().any(|f| match f {
                RegionFault::HoleMeetsContour { hole: h, .. } => *h == hole,
                RegionFault::HolesMeet { holes, .. } => holes.contains(&hole),
                _ => false,
            })
        };
        let ring_locator = |ring: &[Point]| Locator::new(sides(ring).map(|(a, b)| [a, b]));
        let contour = ring_locator(&self.contour);
        let holes: Vec<_> =
            self.holes.iter().map(|hole| (ring_locator(hole), Bbox::of(hole.iter().copied()))).collect();
        for (k, hole) in self.holes.iter().enumerate() {
            let Some(&corner) = hole.first() else { continue };
            if meets(k, faults) {
                continue;
            }
            if contour.locate(corner) == Location::Outside {
                faults.push(RegionFault::HoleOutside { hole: k });
                continue;
            }
            let outer = holes.iter().enumerate().find(|(other, (locator, envelope))| {
                *other != k && envelope.contains(corner, 0.0) && locator.locate(corner) == Location::Inside
            });
            if let Some((outer, _)) = outer {
                faults.push(RegionFault::HoleInHole { inner: k, outer });
            }
        }
    }
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

/// A point that lies in the interior of both regions by more than about `tolerance`; `None` where they are apart,
/// adjacent, or one fills a hole of the other.
///
/// Both regions must be free of [`Region::faults`].
pub fn overlap(a: &Region, b: &Region, tolerance: f64) -> Option<Point> {
    if !a.envelope().overlaps(&b.envelope(), 0.0) {
        return None;
    }
    let deep_inside = |region: &Region| {
        let locator = region.locator();
        let index = SegmentIndex::new(region.loops().flat_map(|ring| sides(ring)).map(|(p, q)| [p, q]));
        move |p: Point| locator.locate(p) == Location::Inside && !index.any_within(p, tolerance)
    };
    let (in_a, in_b) = (deep_inside(a), deep_inside(b));
    // Where two sides cross, the points just beside the crossing, in the four quadrants, decide: one of them is inside
    // both regions unless the crossing is the noise of a common edge. Otherwise one region holds the other's corners,
    // or both are the same: a point beside each side, on its inner side, decides.
    let crossings = proper_crossings(a, b, tolerance);
    crossings
        .into_iter()
        .flat_map(|(at, reach)| quadrants(at, reach))
        .chain(inner_points(a, tolerance))
        .chain(inner_points(b, tolerance))
        .find(|&p| in_a(p) && in_b(p))
}

fn proper_crossings(a: &Region, b: &Region, tolerance: f64) -> Vec<(Point, [Point; 2])> {
    let index = SegmentIndex::new(a.loops().flat_map(|ring| sides(ring)).map(|(p, q)| [p, q]));
    let mut found = Vec::new();
    for (c, d) in b.loops().flat_map(|ring| sides(ring)) {
        index.candidates(c, d, tolerance, |k| {
            let [p, q] = index.segment(k);
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

/// A point beside the middle of every side, inside the region, at several depths.
fn inner_points(region: &Region, tolerance: f64) -> Vec<Point> {
    let locator = region.locator();
    let mut points = Vec::new();
    for ring in region.loops() {
        for (p, q) in sides(ring) {
            let (v, middle) = (sub(q, p), along(p, 0.5, sub(q, p)));
            let length = v[0].hypot(v[1]);
            if length <= tolerance {
                continue;
            }
            let normal = [-v[1] / length, v[0] / length];
            for depth in [0.1 * length, 4.0 * tolerance] {
                for side in [depth, -depth] {
                    let inner = along(middle, side, normal);
                    if locator.locate(inner) == Location::Inside {
                        points.push(inner);
                    }
                }
            }
        }
    }
    points
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
        assert_eq!(overlap(&a, &beside, 1e-8), None);
        assert_eq!(overlap(&a, &inclusion, 1e-8), None);
        assert_eq!(overlap(&inclusion, &a, 1e-8), None);
    }

    #[test]
    fn regions_that_cross_contain_or_equal_each_other_overlap() {
        let a = region(square(0.0, 0.0, 2.0), vec![]);
        for b in [square(1.0, 1.0, 2.0), square(0.5, 0.5, 1.0), square(0.0, 0.0, 2.0), square(0.0, 0.0, 1.0)] {
            let b = region(b, vec![]);
            assert!(overlap(&a, &b, 1e-8).is_some(), "{b:?}");
            assert!(overlap(&b, &a, 1e-8).is_some(), "{b:?}");
        }
        let cross = region(vec![[-1.0, 0.5], [3.0, 0.5], [3.0, 1.5], [-1.0, 1.5]], vec![]);
        assert!(overlap(&a, &cross, 1e-8).is_some());
    }
}
