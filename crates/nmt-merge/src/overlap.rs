//! The coinciding part of two straight outline edges.

use nmt_geom::Point;
use nmt_geom::point::distance;
use nmt_geom::segment::collinear_overlap;

/// Where two edges run along each other, in the direction of the first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CommonPart {
    pub from: Point,
    pub to: Point,
}

/// The part that the edges `a` and `b` (their ends) have in common, where it is longer than `tolerance` (user's length
/// unit); `None` where they only touch or cross.
///
/// Its end points are ends of the edges to the bit, those of `a` where both have one there.
pub(crate) fn common_part(a: [Point; 2], b: [Point; 2], tolerance: f64) -> Option<CommonPart> {
    // The longer edge fixes the line: that of a short one, extended to the ends of a long one, would be off by far more
    // than the short one's own ends are.
    let length = |[p, q]: [Point; 2]| distance(p, q);
    let [base, other] = if length(b) > length(a) { [b, a] } else { [a, b] };
    collinear_overlap(base[0], base[1], other[0], other[1], tolerance)?;
    // An end of the common part is an end of an edge: of `a`, unless it lies beyond `b`.
    let beyond = |p: Point, inner: Point, edge: [Point; 2]| {
        let direction = [inner[0] - p[0], inner[1] - p[1]];
        let ahead =
            |q: Point| (q[0] - p[0]) * direction[0] + (q[1] - p[1]) * direction[1] > tolerance * length([p, inner]);
        ahead(edge[0]) && ahead(edge[1])
    };
    let nearest = |p: Point| if distance(p, b[0]) <= distance(p, b[1]) { b[0] } else { b[1] };
    let end = |p: Point, inner: Point| if beyond(p, inner, b) { nearest(p) } else { p };
    Some(CommonPart { from: end(a[0], a[1]), to: end(a[1], a[0]) })
}

#[cfg(test)]
mod tests {
    use super::*;

    const TOLERANCE: f64 = 1e-9;

    fn part(a: [Point; 2], b: [Point; 2]) -> Option<[Point; 2]> {
        common_part(a, b, TOLERANCE).map(|part| [part.from, part.to])
    }

    #[test]
    fn the_common_part_leads_along_the_first_edge_whichever_way_the_second_one_goes() {
        let a = [[0.0, 0.0], [4.0, 0.0]];
        for (b, expected) in [
            ([[0.0, 0.0], [4.0, 0.0]], [[0.0, 0.0], [4.0, 0.0]]),  // the same
            ([[1.0, 0.0], [3.0, 0.0]], [[1.0, 0.0], [3.0, 0.0]]),  // within
            ([[-1.0, 0.0], [9.0, 0.0]], [[0.0, 0.0], [4.0, 0.0]]), // around
            ([[3.0, 0.0], [9.0, 0.0]], [[3.0, 0.0], [4.0, 0.0]]),  // across the end
            ([[-5.0, 0.0], [0.5, 0.0]], [[0.0, 0.0], [0.5, 0.0]]), // across the beginning
        ] {
            assert_eq!(part(a, b), Some(expected), "{b:?}");
            assert_eq!(part(a, [b[1], b[0]]), Some(expected), "{b:?} turned");
        }
    }

    #[test]
    fn edges_that_touch_cross_or_run_side_by_side_have_nothing_in_common() {
        let a = [[0.0, 0.0], [4.0, 0.0]];
        for b in [
            [[4.0, 0.0], [6.0, 0.0]],   // goes on
            [[4.0, 0.0], [4.0, 2.0]],   // a corner
            [[2.0, -1.0], [2.0, 1.0]],  // a crossing
            [[0.0, 1e-6], [4.0, 1e-6]], // beside it
            [[0.0, 0.0], [4.0, 1e-6]],  // a small angle
            [[5.0, 0.0], [6.0, 0.0]],   // farther on
        ] {
            assert_eq!(part(a, b), None, "{b:?}");
            assert_eq!(part(b, a), None, "{b:?} first");
        }
    }

    #[test]
    fn a_short_edge_with_noise_at_its_ends_still_lies_on_a_long_one() {
        // Extended to the ends of the long edge, the short one's line would be off by 1e-6.
        let short = [[2.0, 4e-10], [2.001, -4e-10]];
        assert_eq!(part(short, [[0.0, 0.0], [4.0, 0.0]]), Some(short));
    }

    #[test]
    fn where_both_edges_end_the_first_ones_end_is_taken() {
        let a = [[0.0, 0.0], [4.0, 0.0]];
        assert_eq!(part(a, [[1e-10, 0.0], [4.0, 1e-10]]), Some(a));
    }
}
