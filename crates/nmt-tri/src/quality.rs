//! Shape of the triangles: 4√3·A/(l₁² + l₂² + l₃²), angles, histogram.

use crate::mesh::Mesh;
use nmt_geom::TriId;
use nmt_geom::point::{cross, distance_squared, dot, sub};

/// Shape of all triangles of a mesh; dimensionless.
#[derive(Clone, Debug, PartialEq)]
pub struct Quality {
    /// Shape measure of the worst triangle: 1 is equilateral, 0 flat.
    pub min: f64,
    /// Mean of the shape measure.
    pub mean: f64,
    /// Smallest angle of any triangle, degrees.
    pub min_angle_deg: f64,
    /// The triangle with the smallest shape measure.
    pub worst: TriId,
    /// Triangles by shape measure: [0, 0.1), …, [0.9, 1].
    pub histogram: [usize; 10],
}

/// Shape measure 4√3·A/(l₁² + l₂² + l₃²) of one triangle: 1 equilateral, 0 flat.
pub fn shape(mesh: &Mesh, triangle: TriId) -> f64 {
    let [a, b, c] = mesh.corners(triangle);
    let squares = distance_squared(a, b) + distance_squared(b, c) + distance_squared(c, a);
    4.0 * 3f64.sqrt() * mesh.area(triangle) / squares
}

/// Shape of all triangles; `None` where there are none.
pub fn quality(mesh: &Mesh) -> Option<Quality> {
    let mut quality =
        Quality { min: f64::INFINITY, mean: 0.0, min_angle_deg: 180.0, worst: TriId(0), histogram: [0; 10] };
    for t in mesh.triangles() {
        let q = shape(mesh, t);
        quality.mean += q;
        quality.histogram[((q * 10.0).clamp(0.0, 9.0)) as usize] += 1;
        if q < quality.min {
            quality.min = q;
            quality.worst = t;
        }
        let [a, b, c] = mesh.corners(t);
        for (p, q, r) in [(a, b, c), (b, c, a), (c, a, b)] {
            let (u, v) = (sub(q, p), sub(r, p));
            quality.min_angle_deg = quality.min_angle_deg.min(cross(u, v).atan2(dot(u, v)).to_degrees());
        }
    }
    quality.mean /= mesh.n_triangles() as f64;
    (mesh.n_triangles() > 0).then_some(quality)
}
