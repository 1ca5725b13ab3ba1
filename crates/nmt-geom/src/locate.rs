//! Inside, outside or on the boundary: ray casting with exact predicates.

use crate::point::Point;
use crate::predicates::side;
use crate::segment;
use crate::segment_index::SegmentIndex;
use std::cmp::Ordering;

/// Where a point lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Location {
    /// Strictly inside: in the material.
    Inside,
    /// Exactly on a segment of the boundary.
    OnBoundary,
    /// Outside the main contour, or in a hole.
    Outside,
}

/// Answers "where is this point?" for the even–odd region between closed polygons, in O(log n) and what the ray from the
/// point towards +x crosses.
#[derive(Clone, Debug)]
pub struct Locator {
    index: SegmentIndex,
}

impl Locator {
    /// Indexes the sides of closed polygons.
    pub fn new(segments: impl IntoIterator<Item = [Point; 2]>) -> Self {
        Self { index: SegmentIndex::new(segments) }
    }

    /// Where `p` lies; exact for the coordinates given.
    ///
    /// ```
    /// use nmt_geom::{Location, Locator};
    /// let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    /// let locator = Locator::new((0..4).map(|k| [square[k], square[(k + 1) % 4]]));
    /// assert_eq!(locator.locate([0.5, 1.0]), Location::OnBoundary);
    /// assert_eq!(locator.locate([0.5, 1.0 - 1e-16]), Location::Inside);
    /// ```
    pub fn locate(&self, p: Point) -> Location {
        self.index.locate(p)
    }

    /// Whether no point of the region is nearer to `p` than `radius`.
    pub fn misses_disc(&self, p: Point, radius: f64) -> bool {
        !self.index.any_within(p, radius) && self.locate(p) == Location::Outside
    }
}

/// How the ray from a point towards +x meets a segment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Crossing {
    None,
    Right,
    On,
}

/// Half-open in y, so that a ray through a corner counts it once; paper, Sec. 4.3 (`internal_point`).
pub(crate) fn ray_crossing(p: Point, a: Point, b: Point) -> Crossing {
    let spans = (a[1] > p[1]) != (b[1] > p[1]);
    if !spans {
        // Its ends may still touch the ray's height: then only lying on it matters.
        let touches = a[1] == p[1] || b[1] == p[1];
        return if touches && segment::contains(p, a, b) { Crossing::On } else { Crossing::None };
    }
    if p[0] > a[0].max(b[0]) {
        return Crossing::None;
    }
    match side(a, b, p) {
        Ordering::Equal => Crossing::On,
        left => {
            let upwards = b[1] > a[1];
            if (left == Ordering::Greater) == upwards { Crossing::Right } else { Crossing::None }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ring::sides;
    use proptest::prelude::*;

    fn locator(rings: &[&[Point]]) -> Locator {
        Locator::new(rings.iter().flat_map(|ring| sides(ring)).map(|(a, b)| [a, b]))
    }

    #[test]
    fn the_grid_of_the_thin_box_has_no_point_inside_and_118_on_the_boundary() {
        // Box [0,4]×[0,2] with a wall of 0.1, 21 × 21 grid: counted in exact rational arithmetic.
        let outer = [[0.0, 0.0], [4.0, 0.0], [4.0, 2.0], [0.0, 2.0]];
        let inner = [[0.1, 0.1], [3.9, 0.1], [3.9, 1.9], [0.1, 1.9]];
        let locator = locator(&[&outer, &inner]);
        let (mut inside, mut on) = (0, 0);
        for j in 0..=20 {
            for i in 0..=20 {
                // Coordinates as the decimal fractions they stand for.
                let p = [(i * 2) as f64 / 10.0, j as f64 / 10.0];
                match locator.locate(p) {
                    Location::Inside => inside += 1,
                    Location::OnBoundary => on += 1,
                    Location::Outside => {}
                }
            }
        }
        assert_eq!((inside, on), (0, 118));
    }

    #[test]
    fn a_ray_through_corners_counts_each_once() {
        let diamond = [[0.0, -1.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0]];
        let locator = locator(&[&diamond]);
        assert_eq!(locator.locate([0.0, 0.0]), Location::Inside);
        assert_eq!(locator.locate([-2.0, 0.0]), Location::Outside);
        assert_eq!(locator.locate([-0.5, 1.0]), Location::Outside);
        assert_eq!(locator.locate([1.0, 0.0]), Location::OnBoundary);
    }

    #[test]
    fn a_disc_is_missed_where_neither_sides_nor_material_come_near() {
        let (outer, hole) =
            ([[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]], [[1.0, 1.0], [3.0, 1.0], [3.0, 3.0], [1.0, 3.0]]);
        let locator = locator(&[&outer, &hole]);
        assert!(locator.misses_disc([5.0, 2.0], 0.9) && !locator.misses_disc([5.0, 2.0], 1.1));
        assert!(locator.misses_disc([2.0, 2.0], 0.9) && !locator.misses_disc([2.0, 2.0], 1.1)); // in the hole
        assert!(!locator.misses_disc([0.5, 2.0], 0.1)); // in the material
    }

    proptest! {
        #[test]
        fn the_index_agrees_with_a_plain_loop_over_all_sides(
            corners in prop::collection::vec(prop::array::uniform2(0i32..8), 3..12),
            p in prop::array::uniform2(0i32..8),
        ) {
            let ring: Vec<Point> = corners.iter().map(|c| c.map(f64::from)).collect();
            let p = p.map(f64::from);
            let on = sides(&ring).any(|(a, b)| segment::contains(p, a, b));
            let inside = sides(&ring).filter(|&(a, b)| ray_crossing(p, a, b) == Crossing::Right).count() % 2 == 1;
            let expected = if on { Location::OnBoundary } else if inside { Location::Inside } else { Location::Outside };
            prop_assert_eq!(locator(&[&ring]).locate(p), expected);
        }
    }
}
