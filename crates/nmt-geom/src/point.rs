//! Vector arithmetic on points of the plane.

/// A point of the plane, `[x, y]`, in the user's length unit.
pub type Point = [f64; 2];

/// `p − q`.
#[inline]
pub fn sub(p: Point, q: Point) -> Point {
    [p[0] - q[0], p[1] - q[1]]
}

/// `p + t·v`.
#[inline]
pub fn along(p: Point, t: f64, v: Point) -> Point {
    [p[0] + t * v[0], p[1] + t * v[1]]
}

/// The point at fraction `t` of the way from `p` to `q`; exactly `p` at 0 and `q` at 1.
#[inline]
pub fn lerp(p: Point, q: Point, t: f64) -> Point {
    [p[0] * (1.0 - t) + q[0] * t, p[1] * (1.0 - t) + q[1] * t]
}

/// Scalar product.
#[inline]
pub fn dot(u: Point, v: Point) -> f64 {
    u[0] * v[0] + u[1] * v[1]
}

/// Third component of the vector product: positive where `v` is counter-clockwise of `u`.
#[inline]
pub fn cross(u: Point, v: Point) -> f64 {
    u[0] * v[1] - u[1] * v[0]
}

/// Square of the distance between two points.
#[inline]
pub fn distance_squared(p: Point, q: Point) -> f64 {
    let d = sub(p, q);
    dot(d, d)
}

/// Distance between two points, without overflow.
#[inline]
pub fn distance(p: Point, q: Point) -> f64 {
    (p[0] - q[0]).hypot(p[1] - q[1])
}
