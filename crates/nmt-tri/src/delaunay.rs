//! Constrained Delaunay triangulation of any cloud: the only file that names spade.

use crate::error::MeshError;
use nmt_cloud::Cloud;
use nmt_geom::Point;
use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation as _};

/// Says that a side of a triangle has no neighbour.
pub(crate) const NO_TRIANGLE: u32 = u32::MAX;

/// Triangles with their neighbours; counter-clockwise, side k leads from node k to node k + 1.
#[derive(Clone, Debug, Default)]
pub(crate) struct Triangles {
    pub nodes: Vec<[u32; 3]>,
    pub neighbours: Vec<[u32; 3]>,
}

/// Triangulates the convex hull of all nodes with the segments of the real boundary as constraints.
pub(crate) fn constrained(cloud: &Cloud) -> Result<Triangles, MeshError> {
    triangulate(cloud, cloud.boundary().segments().iter().map(|s| [s.from.index(), s.to.index()]).collect())
}

/// Triangulates the convex hull of all nodes, whatever the real boundary; the paper's `delaunay`.
pub(crate) fn plain(cloud: &Cloud) -> Result<Triangles, MeshError> {
    triangulate(cloud, Vec::new())
}

fn triangulate(cloud: &Cloud, constraints: Vec<[usize; 2]>) -> Result<Triangles, MeshError> {
    let scale = power_of_two_near(cloud.size());
    let points: Vec<Point2<f64>> =
        cloud.xy().iter().map(|p| Point2::new(fit(p[0] * scale), fit(p[1] * scale))).collect();
    let mut conflicts = Vec::new();
    let cdt = ConstrainedDelaunayTriangulation::<Point2<f64>>::try_bulk_load_cdt(points, constraints, |segment| {
        conflicts.push(segment);
    })
    .map_err(|_| unusable_coordinate(cloud.xy()))?;
    if cdt.num_vertices() != cloud.n_nodes() {
        return Err(same_node(cloud.xy()));
    }
    if let Some(&[from, to]) = conflicts.first() {
        return Err(MeshError::BareSegment { nodes: [from, to], from: cloud.xy()[from], to: cloud.xy()[to] });
    }
    // Inner faces are numbered from 1; 0 is the outside.
    let n = cdt.num_inner_faces();
    let mut triangles = Triangles { nodes: Vec::with_capacity(n), neighbours: Vec::with_capacity(n) };
    for face in cdt.inner_faces() {
        let edges = face.adjacent_edges();
        triangles.nodes.push(edges.map(|edge| edge.from().fix().index() as u32));
        triangles.neighbours.push(edges.map(|edge| match edge.rev().face().as_inner() {
            Some(inner) => (inner.fix().index() - 1) as u32,
            None => NO_TRIANGLE,
        }));
    }
    Ok(triangles)
}

/// A power of two that brings `size` near 1: scaling by it is exact, so that it changes no triangle.
pub(crate) fn power_of_two_near(size: f64) -> f64 {
    let exponent = size.log2().round();
    if exponent.is_finite() { (-exponent.clamp(-1000.0, 1000.0)).exp2() } else { 1.0 }
}

/// Rounding noise about zero (below 1e-40 of the size) to zero: spade does not take coordinates below 2⁻¹⁴².
fn fit(v: f64) -> f64 {
    if v.abs() < 1e-40 { 0.0 } else { v }
}

fn unusable_coordinate(xy: &[Point]) -> MeshError {
    let node = xy.iter().position(|p| !(p[0].abs() < 1e100 && p[1].abs() < 1e100)).unwrap_or(0);
    MeshError::Coordinate { node, at: xy.get(node).copied().unwrap_or_default() }
}

fn same_node(xy: &[Point]) -> MeshError {
    let mut order: Vec<usize> = (0..xy.len()).collect();
    order.sort_by(|&i, &j| xy[i][0].total_cmp(&xy[j][0]).then(xy[i][1].total_cmp(&xy[j][1])).then(i.cmp(&j)));
    let pair = order.windows(2).find(|w| xy[w[0]] == xy[w[1]]);
    let nodes = pair.map_or([0, 0], |w| [w[0], w[1]]);
    MeshError::SameNode { nodes, at: xy.get(nodes[0]).copied().unwrap_or_default() }
}
