//! How well the recovered field satisfies the differential equation.

use crate::blend::NodalPolynomials;
use crate::parallel::map_chunks;
use nmt_geom::{Point, TriId};
use nmt_tri::Mesh;

/// |∇²F + 2Gθ| of the blend at the centroid of every triangle, in units of Gθ's.
pub fn residuals(mesh: &Mesh, field: &NodalPolynomials, g_theta: f64) -> Vec<f64> {
    residuals_against(mesh, field, |_| -2.0 * g_theta)
}

/// |∇²u − f| of the blend at the centroid of every triangle.
pub(crate) fn residuals_against(
    mesh: &Mesh,
    field: &NodalPolynomials,
    source: impl Fn(Point) -> f64 + Sync,
) -> Vec<f64> {
    let parts = map_chunks(0..mesh.n_triangles(), |piece| {
        let residual = |t: usize| {
            let corners = mesh.corners(TriId::of(t));
            let centroid = [0, 1].map(|d| corners.iter().map(|p| p[d]).sum::<f64>() / 3.0);
            (field.blend(mesh, TriId::of(t), centroid).laplacian - source(centroid)).abs()
        };
        piece.map(residual).collect::<Vec<f64>>()
    });
    parts.into_iter().flatten().collect()
}
