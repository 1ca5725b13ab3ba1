//! Smoothing that keeps the cloud honest: interior nodes move to the middle of the triangles around them.

use crate::adjacency::NodeTris;
use crate::mesh::Mesh;
use nmt_cloud::Cloud;
use nmt_geom::point::{cross, lerp, sub};
use nmt_geom::{NodeId, Point};

/// A node that would turn a triangle over or come too near to the boundary goes this many times half as far.
const HALVINGS: u32 = 3;

/// A triangle keeps at least this fraction of the mean area around its node: a move must not make slivers on its way.
const LEAST_SHARE: f64 = 0.02;

/// The cloud of `mesh` after so many sweeps over its interior nodes, each moved to the centroid of the triangles around it
/// (their centroids, weighted by area).
///
/// Boundary nodes stay. No move turns a triangle over, and the clearances of the cloud are kept: where the whole way does
/// not do, a half, a quarter or an eighth of it is tried, else the node stays. In order of the nodes, each seeing those before
/// it moved, so that the result is the same everywhere. Triangulate the cloud anew: the triangles it came with are no longer
/// Delaunay.
///
/// ```
/// use nmt_cloud::{CloudParams, Section, generate};
/// use nmt_curve::Outline;
/// use nmt_tri::{Mesh, quality, smooth};
///
/// let disc = Section::solid(Outline::circle([0.0, 0.0], 1.0));
/// let cloud = generate(&disc, &CloudParams { nodes: [21, 21], irregularity: 0.4, ..CloudParams::default() })?;
/// let mesh = Mesh::constrained(cloud)?;
/// let smoothed = Mesh::constrained(smooth(&mesh, 3))?;
/// assert_eq!(smoothed.check(), Ok(()));
/// let mean = |mesh: &Mesh| quality(mesh).map(|q| q.mean);
/// assert!(mean(&smoothed) > mean(&mesh));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn smooth(mesh: &Mesh, sweeps: usize) -> Cloud {
    let cloud = mesh.cloud();
    let n_boundary = cloud.n_boundary();
    let around = NodeTris::new(cloud.n_nodes(), mesh.tri_nodes());
    let index = cloud.boundary().index();
    let mut xy = cloud.xy().to_vec();
    for _ in 0..sweeps {
        for node in n_boundary..xy.len() {
            let ring = Ring { mesh, triangles: &around, node };
            let Some(middle) = ring.middle(&xy) else { continue };
            let (from, least) = (xy[node], LEAST_SHARE * middle.mean_area);
            for halving in 0..=HALVINGS {
                let to = lerp(from, middle.at, 0.5f64.powi(halving as i32));
                if ring.keeps_areas(&xy, to, least) && cloud.clearance_of(NodeId::of(node)).holds(to, index) {
                    xy[node] = to;
                    break;
                }
            }
        }
    }
    // As many places as interior nodes: this cannot fail, and an unchanged cloud would be the honest answer if it did.
    cloud.clone().with_interior(&xy[n_boundary..]).unwrap_or_else(|_| cloud.clone())
}

/// The triangles around a node.
struct Ring<'a> {
    mesh: &'a Mesh,
    triangles: &'a NodeTris,
    node: usize,
}

/// Where the triangles around a node have their middle.
struct Middle {
    at: Point,
    mean_area: f64,
}

impl Ring<'_> {
    /// The two other corners of each triangle, counter-clockwise after the node.
    fn opposite_sides(&self) -> impl Iterator<Item = [NodeId; 2]> + '_ {
        self.triangles.around(NodeId::of(self.node)).iter().map(|t| {
            let nodes = self.mesh.tri_nodes()[t.index()];
            let k = nodes.iter().position(|n| n.index() == self.node).unwrap_or(0);
            [nodes[(k + 1) % 3], nodes[(k + 2) % 3]]
        })
    }

    fn middle(&self, xy: &[Point]) -> Option<Middle> {
        let p = xy[self.node];
        let (mut twice_area, mut moment, mut n) = (0.0, [0.0; 2], 0.0);
        for [a, b] in self.opposite_sides() {
            let (u, v) = (sub(xy[a.index()], p), sub(xy[b.index()], p));
            let w = cross(u, v);
            twice_area += w;
            n += 1.0;
            (0..2).for_each(|d| moment[d] += w * (u[d] + v[d]) / 3.0);
        }
        let at = [p[0] + moment[0] / twice_area, p[1] + moment[1] / twice_area];
        (twice_area > 0.0 && at.iter().all(|c| c.is_finite())).then_some(Middle { at, mean_area: 0.5 * twice_area / n })
    }

    /// True where every triangle around the node, moved to `to`, has at least the area `least`, or more than before.
    fn keeps_areas(&self, xy: &[Point], to: Point, least: f64) -> bool {
        self.opposite_sides().all(|[a, b]| {
            let (q, r) = (xy[a.index()], xy[b.index()]);
            let area = |p: Point| 0.5 * cross(sub(q, p), sub(r, p));
            let new = area(to);
            new > 0.0 && (new >= least || new >= area(xy[self.node]))
        })
    }
}
