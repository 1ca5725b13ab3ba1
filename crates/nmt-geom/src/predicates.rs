//! Exact orientation of three points: the one file that names the crate `robust`.

use crate::point::Point;
use robust::{Coord, orient2d};
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
    let c = |q: Point| Coord { x: q[0], y: q[1] };
    let det = orient2d(c(a), c(b), c(p));
    det.partial_cmp(&0.0).unwrap_or(Ordering::Equal)
}
