//! Which Delaunay triangles do not belong to the mesh; paper, Secs 5.2–5.4, eqs (12)–(15).

use crate::unconstrained::Elimination;
use nmt_cloud::Cloud;
use nmt_geom::point::{cross, sub};
use nmt_geom::{Location, LoopId, Point, SegmentIndex};

/// Triangles smaller than this fraction of the envelope's area are dropped \[D8\].
///
/// The paper's 1e-12, which is an area there and deletes whole meshes of micrometre geometry.
const TINY_REL: f64 = 1.0e-12;

/// Why a triangle is dropped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Cause {
    Outside,
    InHole,
    Tiny,
}

/// Judges triangles one by one.
pub(crate) struct Judge<'a> {
    xy: &'a [Point],
    contour: SegmentIndex,
    holes: SegmentIndex,
    tiny: f64, // area, square of the user's length unit
}

impl<'a> Judge<'a> {
    pub fn new(cloud: &'a Cloud) -> Self {
        let boundary = cloud.boundary();
        let of_loops = |loops: std::ops::Range<usize>| {
            let segments = loops.flat_map(|ring| boundary.loop_segments(LoopId::of(ring)));
            SegmentIndex::new(segments.map(|segment| boundary.ends(segment)))
        };
        let envelope = boundary.envelope();
        Self {
            xy: cloud.xy(),
            contour: of_loops(0..1),
            holes: of_loops(1..boundary.n_loops()),
            tiny: tiny_area(envelope.width() * envelope.height()),
        }
    }

    /// The first step that drops the triangle; `None` where it stays.
    pub fn cause(&self, nodes: [u32; 3], elimination: &Elimination) -> Option<Cause> {
        let [a, b, c] = nodes.map(|node| self.xy[node as usize]);
        // (12), written so that it does not overflow.
        let centroid = [0, 1].map(|d: usize| a[d] + ((b[d] - a[d]) + (c[d] - a[d])) / 3.0);
        if elimination.outside && self.contour.locate(centroid) == Location::Outside {
            return Some(Cause::Outside);
        }
        if elimination.in_hole && self.holes.locate(centroid) == Location::Inside {
            return Some(Cause::InHole);
        }
        let area = 0.5 * cross(sub(b, a), sub(c, a));
        (elimination.tiny && area < self.tiny).then_some(Cause::Tiny)
    }
}

/// The area below which a triangle is tiny, from the area of the envelope.
pub(crate) fn tiny_area(envelope: f64) -> f64 {
    TINY_REL * envelope
}
