//! Exact orientation of three points, and of a point and a circle: the one file that names the crate `robust`.

use crate::point::Point;
use robust::{Coord, incircle, orient2d};
use std::cmp::Ordering;

/// On which side of the directed line `a → b` the point `p` lies: `Greater` left, `Less` right, `Equal` exactly on it.
///
/// Exact for the coordinates given, whatever their size.
///
/// ```
/// use std::cmp::Ordering;
/// assert_eq!(nmt_geom::side([0.0, 0.0], [1.0, 0.0], [0.5, 1e-300]), Ordering::Greater);
/// ```
#[inline]
pub fn side(a: Point, b: Point, p: Point) -> Ordering {
    let det = orient2d(coord(a), coord(b), coord(p));
    det.partial_cmp(&0.0).unwrap_or(Ordering::Equal)
}

/// Where the point `p` lies with respect to the circle through `a`, `b`, `c`, which run counter-clockwise: `Greater`
/// inside, `Less` outside, `Equal` exactly on it.
///
/// Exact as long as fourth powers of the coordinates neither overflow nor underflow: bring them near 1 first.
///
/// ```
/// use std::cmp::Ordering;
/// let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
/// assert_eq!(nmt_geom::in_circle(square[0], square[1], square[2], square[3]), Ordering::Equal);
/// ```
#[inline]
pub fn in_circle(a: Point, b: Point, c: Point, p: Point) -> Ordering {
    let det = incircle(coord(a), coord(b), coord(c), coord(p));
    det.partial_cmp(&0.0).unwrap_or(Ordering::Equal)
}

fn coord(p: Point) -> Coord<f64> {
    Coord { x: p[0], y: p[1] }
}
