//! A closed polygon, given by its corners in order; the last joins the first.

use crate::point::{Point, cross, distance, sub};

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

#[cfg(test)]
mod tests {
    use super::*;

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
}
