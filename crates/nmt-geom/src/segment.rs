//! Two points joined: nearest point, distance, crossing, overlap.

use crate::point::{Point, along, cross, distance_squared, dot, sub};
use crate::predicates::side;
use std::cmp::Ordering;

/// Fraction of the way from `a` to `b`, in [0, 1], of the point of the segment nearest to `p`.
#[inline]
pub fn nearest_fraction(p: Point, a: Point, b: Point) -> f64 {
    let ab = sub(b, a);
    let length_squared = dot(ab, ab);
    if length_squared > 0.0 { (dot(sub(p, a), ab) / length_squared).clamp(0.0, 1.0) } else { 0.0 }
}

/// The point of the segment `a b` nearest to `p`.
#[inline]
pub fn nearest_point(p: Point, a: Point, b: Point) -> Point {
    along(a, nearest_fraction(p, a, b), sub(b, a))
}

/// Distance of `p` from the segment `a b` \[D6\], in the user's length unit.
///
/// ```
/// assert_eq!(nmt_geom::segment::distance_to([3.0, 4.0], [-1.0, 0.0], [0.0, 0.0]), 5.0);
/// ```
#[inline]
pub fn distance_to(p: Point, a: Point, b: Point) -> f64 {
    // Not `hypot`: lengths are far from overflow, and this is asked for every star.
    distance_squared(p, nearest_point(p, a, b)).sqrt()
}

/// True where `p` is a point of the closed segment `a b`; exact.
pub fn contains(p: Point, a: Point, b: Point) -> bool {
    let between = |d: usize| (a[d].min(b[d])..=a[d].max(b[d])).contains(&p[d]);
    between(0) && between(1) && side(a, b, p) == Ordering::Equal
}

/// True where the closed segments `a b` and `c d` share a point; exact.
pub fn touch(a: Point, b: Point, c: Point, d: Point) -> bool {
    let (c_side, d_side, a_side, b_side) = (side(a, b, c), side(a, b, d), side(c, d, a), side(c, d, b));
    let opposite = |s: Ordering, t: Ordering| s != Ordering::Equal && t == s.reverse();
    (opposite(c_side, d_side) && opposite(a_side, b_side))
        || contains(c, a, b)
        || contains(d, a, b)
        || contains(a, c, d)
        || contains(b, c, d)
}

/// True where the open segments cross and each pair of ends lies on opposite sides of the other segment's line, by
/// more than `margin`: touching and running along do not count \[D10\].
#[inline]
pub fn cross_properly(a: Point, b: Point, c: Point, d: Point, margin: f64) -> bool {
    let (ab, cd) = (sub(b, a), sub(d, c));
    let beyond = |direction: Point, s: f64, t: f64| {
        let limit = margin * dot(direction, direction).sqrt();
        (s > limit && t < -limit) || (s < -limit && t > limit)
    };
    beyond(ab, cross(ab, sub(c, a)), cross(ab, sub(d, a))) && beyond(cd, cross(cd, sub(a, c)), cross(cd, sub(b, c)))
}

/// A point the two segments share, for a message: the crossing of their lines, or an end that lies on the other.
pub fn meeting_point(a: Point, b: Point, c: Point, d: Point) -> Point {
    let (ab, cd) = (sub(b, a), sub(d, c));
    let denominator = cross(ab, cd);
    let t = cross(sub(c, a), cd) / denominator;
    if t.is_finite() && (0.0..=1.0).contains(&t) {
        return along(a, t, ab);
    }
    *[c, d, a, b].iter().find(|&&p| contains(p, a, b) && contains(p, c, d)).unwrap_or(&nearest_point(c, a, b))
}

/// The part of a segment that another one covers, as fractions of the way along it, `from < to`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Overlap {
    /// Where it begins, 0 at the segment's first point.
    pub from: f64,
    /// Where it ends, 1 at the segment's last point.
    pub to: f64,
}

/// The part of `a b` that `c d` runs along, where both ends of `c d` lie within `tolerance` of the line of `a b` and the
/// part is longer than `tolerance`.
///
/// ```
/// let half = nmt_geom::segment::collinear_overlap([0.0, 0.0], [2.0, 0.0], [5.0, 0.0], [1.0, 0.0], 1e-9);
/// assert_eq!(half.map(|o| (o.from, o.to)), Some((0.5, 1.0)));
/// ```
pub fn collinear_overlap(a: Point, b: Point, c: Point, d: Point, tolerance: f64) -> Option<Overlap> {
    let ab = sub(b, a);
    let length = dot(ab, ab).sqrt();
    let off_line = |p: Point| (cross(ab, sub(p, a)) / length).abs();
    if length <= tolerance || off_line(c) > tolerance || off_line(d) > tolerance {
        return None;
    }
    let fraction = |p: Point| dot(sub(p, a), ab) / (length * length);
    let (s, t) = (fraction(c), fraction(d));
    let (from, to) = (s.min(t).max(0.0), s.max(t).min(1.0));
    ((to - from) * length > tolerance).then_some(Overlap { from, to })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn touching_or_running_along_is_no_proper_crossing() {
        let (a, b) = ([0.0, 0.0], [2.0, 0.0]);
        assert!(cross_properly(a, b, [1.0, -1.0], [1.0, 1.0], 1e-9));
        assert!(!cross_properly(a, b, [1.0, 0.0], [1.0, 1.0], 1e-9));
        assert!(!cross_properly(a, b, [0.5, 0.0], [1.5, 0.0], 1e-9));
        assert!(!cross_properly(a, b, [1.0, -1e-10], [1.0, 1.0], 1e-9));
        assert!(!cross_properly(a, b, [3.0, -1.0], [3.0, 1.0], 1e-9));
    }

    #[test]
    fn closed_segments_touch_at_ends_and_along_each_other() {
        assert!(touch([0.0, 0.0], [1.0, 1.0], [1.0, 1.0], [2.0, 0.0]));
        assert!(touch([0.0, 0.0], [2.0, 2.0], [1.0, 1.0], [3.0, 3.0]));
        assert!(!touch([0.0, 0.0], [1.0, 1.0], [2.0, 2.0], [3.0, 3.0]));
        assert!(!touch([0.0, 0.0], [1.0, 0.0], [0.0, 1e-300], [1.0, 1e-300]));
    }

    #[test]
    fn a_meeting_point_lies_on_both_segments() {
        assert_eq!(meeting_point([0.0, 0.0], [2.0, 0.0], [1.0, -1.0], [1.0, 1.0]), [1.0, 0.0]);
        assert_eq!(meeting_point([0.0, 0.0], [2.0, 0.0], [1.0, 0.0], [3.0, 0.0]), [1.0, 0.0]);
    }
}
