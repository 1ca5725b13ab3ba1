//! Inside, outside or on the boundary: ray casting with exact predicates, on slabs of y.

use crate::bbox::Bbox;
use crate::point::Point;
use crate::predicates::side;
use crate::segment;
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

/// Segments per slab of y that the index aims at; more makes look-ups slower, fewer makes the index larger.
const ENTRIES_PER_SEGMENT: f64 = 4.0;

/// Answers "where is this point?" for the even–odd region between closed polygons, in O(segments at that height).
#[derive(Clone, Debug)]
pub struct Locator {
    segments: Vec<[Point; 2]>,
    envelope: Bbox,
    slab_height: f64,
    starts: Vec<u32>,  // first entry of each slab, shape (n_slabs + 1,)
    entries: Vec<u32>, // segments by slab
}

impl Locator {
    /// Indexes the sides of closed polygons.
    pub fn new(segments: impl IntoIterator<Item = [Point; 2]>) -> Self {
        let segments: Vec<_> = segments.into_iter().collect();
        let envelope = Bbox::of(segments.iter().flatten().copied());
        let rise: f64 = segments.iter().map(|[a, b]| (b[1] - a[1]).abs()).sum();
        let height = envelope.height();
        // A slab a segment on average, unless tall segments would fill too many of them.
        let wanted = (ENTRIES_PER_SEGMENT * segments.len() as f64 * height / rise).min(segments.len() as f64);
        let n_slabs = if wanted.is_finite() && wanted >= 1.0 { wanted as usize } else { 1 };
        let mut locator = Self {
            segments,
            envelope,
            slab_height: height / n_slabs as f64,
            starts: vec![0; n_slabs + 1],
            entries: Vec::new(),
        };
        let spans: Vec<_> = locator
            .segments
            .iter()
            .map(|[a, b]| locator.slab(a[1].min(b[1]), n_slabs)..=locator.slab(a[1].max(b[1]), n_slabs))
            .collect();
        spans.iter().cloned().flatten().for_each(|slab| locator.starts[slab + 1] += 1);
        (0..n_slabs).for_each(|slab| locator.starts[slab + 1] += locator.starts[slab]);
        let mut next = locator.starts.clone();
        locator.entries = vec![0; locator.starts[n_slabs] as usize];
        for (k, span) in spans.into_iter().enumerate() {
            for slab in span {
                locator.entries[next[slab] as usize] = k as u32;
                next[slab] += 1;
            }
        }
        locator
    }

    fn slab(&self, y: f64, n_slabs: usize) -> usize {
        let slab = (y - self.envelope.min[1]) / self.slab_height;
        if slab > 0.0 { (slab as usize).min(n_slabs - 1) } else { 0 }
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
        if !self.envelope.contains(p, 0.0) {
            return Location::Outside;
        }
        let slab = self.slab(p[1], self.starts.len() - 1);
        let entries = &self.entries[self.starts[slab] as usize..self.starts[slab + 1] as usize];
        let mut inside = false;
        for &k in entries {
            let [a, b] = self.segments[k as usize];
            match ray_crossing(p, a, b) {
                Crossing::On => return Location::OnBoundary,
                Crossing::Right => inside = !inside,
                Crossing::None => {}
            }
        }
        if inside { Location::Inside } else { Location::Outside }
    }
}

/// How the ray from a point towards +x meets a segment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Crossing {
    None,
    Right,
    On,
}

/// Half-open in y, so that a ray through a corner counts it once; paper, Sec. 4.3 (`internal_point`).
fn ray_crossing(p: Point, a: Point, b: Point) -> Crossing {
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

    proptest! {
        #[test]
        fn the_slabs_agree_with_a_plain_loop_over_all_sides(
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
