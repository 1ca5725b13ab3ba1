//! Which triangle holds a point: a grid of buckets over the triangles.

use crate::mesh::Mesh;
use nmt_geom::point::{cross, sub};
use nmt_geom::{Bbox, Point, TriId, segment};

/// Finds the triangle that holds a point, in O(1) for meshes of even density.
#[derive(Clone, Debug)]
pub struct TriangleIndex<'a> {
    mesh: &'a Mesh,
    origin: Point,
    cell: [f64; 2],
    shape: [usize; 2],
    starts: Vec<u32>,
    entries: Vec<TriId>,
}

impl<'a> TriangleIndex<'a> {
    /// Indexes the triangles of `mesh`, about one a bucket.
    pub fn new(mesh: &'a Mesh) -> Self {
        let envelope = mesh.cloud().boundary().envelope();
        let extent = [envelope.width(), envelope.height()];
        let side = (extent[0] * extent[1] / mesh.n_triangles().max(1) as f64).sqrt();
        let shape = extent.map(|e| ((e / side).ceil() as usize).clamp(1, mesh.n_triangles().max(1)));
        let cell = std::array::from_fn(|d| extent[d] / shape[d] as f64);
        let n_cells = shape[0] * shape[1];
        let mut index = Self { mesh, origin: envelope.min, cell, shape, starts: vec![0; n_cells + 1], entries: vec![] };
        mesh.triangles().for_each(|t| index.buckets(t).for_each(|b| index.starts[b + 1] += 1));
        (0..n_cells).for_each(|b| index.starts[b + 1] += index.starts[b]);
        let mut next = index.starts.clone();
        index.entries = vec![TriId(0); index.starts[n_cells] as usize];
        for t in mesh.triangles() {
            for b in index.buckets(t) {
                index.entries[next[b] as usize] = t;
                next[b] += 1;
            }
        }
        index
    }

    fn column(&self, v: f64, d: usize) -> usize {
        let c = (v - self.origin[d]) / self.cell[d];
        if c > 0.0 { (c as usize).min(self.shape[d] - 1) } else { 0 }
    }

    fn buckets(&self, t: TriId) -> impl Iterator<Item = usize> + use<> {
        let b = Bbox::of(self.mesh.corners(t));
        let columns = self.column(b.min[0], 0)..=self.column(b.max[0], 0);
        let rows = self.column(b.min[1], 1)..=self.column(b.max[1], 1);
        let width = self.shape[0];
        rows.flat_map(move |row| columns.clone().map(move |column| row * width + column))
    }

    /// The triangle that holds `p`, its border included: the first by number. `None` where `p` is farther than
    /// `tolerance` (user's length unit) from every triangle; within it, the nearest.
    pub fn locate(&self, p: Point, tolerance: f64) -> Option<TriId> {
        let bucket = self.column(p[1], 1) * self.shape[0] + self.column(p[0], 0);
        let here = &self.entries[self.starts[bucket] as usize..self.starts[bucket + 1] as usize];
        if let Some(t) = here.iter().copied().find(|&t| barycentric(self.mesh.corners(t), p).iter().all(|l| *l >= 0.0))
        {
            return Some(t);
        }
        // Rounding, or a point just off the boundary: the nearest triangle of the buckets in reach.
        let columns = self.column(p[0] - tolerance, 0)..=self.column(p[0] + tolerance, 0);
        let rows = self.column(p[1] - tolerance, 1)..=self.column(p[1] + tolerance, 1);
        let mut nearest: Option<(f64, TriId)> = None;
        for row in rows {
            for column in columns.clone() {
                let b = row * self.shape[0] + column;
                for &t in &self.entries[self.starts[b] as usize..self.starts[b + 1] as usize] {
                    let distance = distance_to_triangle(self.mesh.corners(t), p);
                    let nearer = nearest.is_none_or(|(best, u)| (distance, t) < (best, u));
                    if distance <= tolerance && nearer {
                        nearest = Some((distance, t));
                    }
                }
            }
        }
        nearest.map(|(_, t)| t)
    }
}

/// Barycentric coordinates of `p`; they sum to 1, none is negative inside.
#[inline]
pub fn barycentric([a, b, c]: [Point; 3], p: Point) -> [f64; 3] {
    let twice_area = cross(sub(b, a), sub(c, a));
    let to_b = cross(sub(p, a), sub(c, a)) / twice_area;
    let to_c = cross(sub(b, a), sub(p, a)) / twice_area;
    [1.0 - to_b - to_c, to_b, to_c]
}

fn distance_to_triangle(corners: [Point; 3], p: Point) -> f64 {
    if barycentric(corners, p).iter().all(|l| *l >= 0.0) {
        return 0.0;
    }
    let [a, b, c] = corners;
    [(a, b), (b, c), (c, a)].iter().fold(f64::INFINITY, |d, (q, r)| d.min(segment::distance_to(p, *q, *r)))
}
