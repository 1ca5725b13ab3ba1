//! A closed polygon, given by its corners in order; the last joins the first.

use crate::bbox::Bbox;
use crate::point::{Point, cross, distance, sub};
use crate::segment::distance_to;

/// Signed area: positive where the corners run counter-clockwise; square of the user's length unit.
pub fn signed_area(ring: &[Point]) -> f64 {
    let Some(&origin) = ring.first() else { return 0.0 };
    sides(ring).map(|(a, b)| cross(sub(a, origin), sub(b, origin))).sum::<f64>() / 2.0
}

/// Centroid of the enclosed area; of the corners where the area is zero.
pub fn centroid(ring: &[Point]) -> Point {
    let Some(&origin) = ring.first() else { return [0.0; 2] };
    let (mut twice_area, mut moment) = (0.0, [0.0; 2]);
    for (a, b) in sides(ring) {
        let (u, v) = (sub(a, origin), sub(b, origin));
        let w = cross(u, v);
        twice_area += w;
        (0..2).for_each(|d| moment[d] += w * (u[d] + v[d]));
    }
    if twice_area == 0.0 {
        let n = ring.len() as f64;
        return [ring.iter().map(|p| p[0]).sum::<f64>() / n, ring.iter().map(|p| p[1]).sum::<f64>() / n];
    }
    [origin[0] + moment[0] / (3.0 * twice_area), origin[1] + moment[1] / (3.0 * twice_area)]
}

/// Length of all sides.
pub fn perimeter(ring: &[Point]) -> f64 {
    sides(ring).map(|(a, b)| distance(a, b)).sum()
}

/// The sides in order: side k leads from corner k to the next.
pub fn sides(ring: &[Point]) -> impl Iterator<Item = (Point, Point)> {
    let n = ring.len();
    (0..n).map(move |k| (ring[k], ring[(k + 1) % n]))
}

/// Lines across a ring on which [`inner_points`] looks for its points, each way.
const LINES: usize = 64;

/// Least distance of inner points, in depths of the deeper one: a ring that is about round has one.
const APART: f64 = 1.25;

/// A point inside a ring.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InnerPoint {
    /// Where it lies.
    pub at: Point,
    /// Its distance from the sides.
    pub depth: f64,
}

/// Points inside, as deep as they come, that are as far apart as they are deep: one in the middle of a circle, a row of them
/// along a slot; none where nothing is enclosed. O(sides), some hundred times.
///
/// They are taken from the middles of what lies inside on 64 lines along each axis, the deepest first.
pub fn inner_points(ring: &[Point]) -> Vec<InnerPoint> {
    let envelope = Bbox::of(ring.iter().copied());
    let middles = [0, 1].into_iter().flat_map(|axis| {
        let (low, extent) = (envelope.min[axis], envelope.max[axis] - envelope.min[axis]);
        (0..LINES).flat_map(move |k| {
            let at = low + extent * (k as f64 + 0.5) / LINES as f64;
            let mut crossings: Vec<f64> = sides(ring).filter_map(|side| crossing(side, axis, at)).collect();
            crossings.sort_by(f64::total_cmp);
            let (inside, _) = crossings.as_chunks::<2>();
            let middle = |[a, b]: &[f64; 2]| if axis == 0 { [at, 0.5 * (a + b)] } else { [0.5 * (a + b), at] };
            inside.iter().map(middle).collect::<Vec<Point>>()
        })
    });
    let depth = |p: Point| sides(ring).map(|(a, b)| distance_to(p, a, b)).fold(f64::INFINITY, f64::min);
    let mut candidates: Vec<InnerPoint> = middles.map(|at| InnerPoint { at, depth: depth(at) }).collect();
    candidates.sort_by(|a, b| b.depth.total_cmp(&a.depth));
    let mut taken: Vec<InnerPoint> = Vec::new();
    for point in candidates.into_iter().filter(|point| point.depth > 0.0) {
        if taken.iter().all(|other| distance(point.at, other.at) >= APART * other.depth) {
            taken.push(point);
        }
    }
    taken
}

/// Where a side crosses the line of one coordinate: its other one.
fn crossing((a, b): (Point, Point), axis: usize, at: f64) -> Option<f64> {
    let other = 1 - axis;
    let share = (at - a[axis]) / (b[axis] - a[axis]);
    ((a[axis] <= at) != (b[axis] <= at)).then(|| a[other] + share * (b[other] - a[other]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::locate::{Location, Locator};
    use proptest::prelude::*;
    use std::f64::consts::{SQRT_2, TAU};

    const L: [Point; 6] = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];

    #[test]
    fn the_l_of_three_unit_squares_has_area_3_and_centroid_five_sixths() {
        assert_eq!(signed_area(&L), 3.0);
        assert_eq!(perimeter(&L), 8.0);
        let c = centroid(&L);
        assert!((c[0] - 5.0 / 6.0).abs() < 1e-15 && (c[1] - 5.0 / 6.0).abs() < 1e-15); // rounding
    }

    #[test]
    fn reversing_a_ring_negates_its_area_and_keeps_its_centroid() {
        let reversed: Vec<_> = L.iter().rev().copied().collect();
        assert_eq!(signed_area(&reversed), -3.0);
        assert!(distance(centroid(&reversed), centroid(&L)) < 1e-15); // rounding
    }

    #[test]
    fn inner_points_are_far_from_the_sides() {
        let depth = |ring: &[Point], p| sides(ring).map(|(a, b)| distance_to(p, a, b)).fold(f64::INFINITY, f64::min);
        let slanted = [[0.0, 0.0], [1.0, 1.0], [0.999, 1.001], [-0.001, 0.001]];
        let triangle = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0]];
        // Radii of the largest circles inside.
        let rings: [(&[Point], f64); 3] =
            [(&L, 2.0 - SQRT_2), (&slanted, 0.000_5 * SQRT_2), (&triangle, 1.5 - 5f64.sqrt() / 2.0)];
        for (ring, deepest) in rings {
            let points = inner_points(ring);
            assert!(points[0].depth > 0.8 * deepest, "{:?} of {deepest}", points[0]);
            for (k, point) in points.iter().enumerate() {
                assert_eq!(point.depth, depth(ring, point.at));
                assert!(points[..k].iter().all(|other| distance(point.at, other.at) >= APART * other.depth));
            }
        }
    }

    #[test]
    fn a_circle_has_one_inner_point_and_a_slot_a_row_of_them() {
        let angle = |k: usize| TAU * k as f64 / 90.0;
        let circle: Vec<Point> = (0..90).map(|k| [3.0 + angle(k).cos(), angle(k).sin()]).collect();
        let points = inner_points(&circle);
        assert!(points.len() == 1 && distance(points[0].at, [3.0, 0.0]) < 0.02, "{points:?}");
        let slot = [[0.0, 0.0], [10.0, 0.0], [10.0, 1.0], [0.0, 1.0]];
        let mut along: Vec<f64> = inner_points(&slot).iter().filter(|p| p.depth > 0.45).map(|p| p.at[0]).collect();
        along.sort_by(f64::total_cmp);
        assert!(along[0] < 1.0 && along[along.len() - 1] > 9.0);
        assert!(along.windows(2).all(|pair| (0.6..1.3).contains(&(pair[1] - pair[0]))), "{along:?}");
    }

    #[test]
    fn nothing_lies_within_a_ring_without_an_area() {
        assert_eq!(inner_points(&[]), []);
        assert_eq!(inner_points(&[[0.0, 0.0], [1.0, 2.0]]), []);
    }

    proptest! {
        #[test]
        fn inner_points_lie_inside_whatever_the_shape(radii in prop::collection::vec(0.01..1.0f64, 3..40)) {
            // Star-shaped about the origin.
            let angle = |k: usize| TAU * k as f64 / radii.len() as f64;
            let ring: Vec<Point> = (0..radii.len()).map(|k| [radii[k] * angle(k).cos(), radii[k] * angle(k).sin()]).collect();
            let (points, locator) = (inner_points(&ring), Locator::new(sides(&ring).map(|(a, b)| [a, b])));
            prop_assert!(!points.is_empty());
            for point in points {
                prop_assert_eq!(locator.locate(point.at), Location::Inside);
            }
        }
    }
}
