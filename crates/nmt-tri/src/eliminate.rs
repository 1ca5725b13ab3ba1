//! Which Delaunay triangles do not belong to the mesh; paper, Secs 5.2–5.4, eqs (12)–(15).

use crate::unconstrained::Elimination;
use nmt_cloud::Cloud;
use nmt_geom::point::{cross, sub};
use nmt_geom::{Location, LoopId, NodeId, Point, SegmentIndex};

/// Triangles smaller than this fraction of the envelope's area are dropped \[D8\].
///
/// The paper's 1e-12, which is an area there and deletes whole meshes of micrometre geometry.
const TINY_REL: f64 = 1.0e-12;

/// In a graded cloud, those smaller than this fraction of the square of the spacing at their nodes.
///
/// It is what the other is for a uniform cloud of 10⁴ nodes; the smallest triangles of a graded one may be 1e-14 of the
/// envelope, and sound.
const TINY_LOCAL_REL: f64 = 1.0e-8;

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
    tiny: TinyArea<'a>,
}

impl<'a> Judge<'a> {
    pub fn new(cloud: &'a Cloud) -> Self {
        let boundary = cloud.boundary();
        let of_loops = |loops: std::ops::Range<usize>| {
            let segments = loops.flat_map(|ring| boundary.loop_segments(LoopId::of(ring)));
            SegmentIndex::new(segments.map(|segment| boundary.ends(segment)))
        };
        Self {
            xy: cloud.xy(),
            contour: of_loops(0..1),
            holes: of_loops(1..boundary.n_loops()),
            tiny: TinyArea::of(cloud),
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
        (elimination.tiny && area < self.tiny.at(nodes)).then_some(Cause::Tiny)
    }
}

/// The area below which a triangle, or a gap for one, is tiny.
#[derive(Clone, Copy)]
pub(crate) struct TinyArea<'a> {
    cloud: &'a Cloud,
    of_envelope: f64, // square of the user's length unit
}

impl<'a> TinyArea<'a> {
    pub fn of(cloud: &'a Cloud) -> Self {
        let envelope = cloud.boundary().envelope();
        Self { cloud, of_envelope: TINY_REL * (envelope.width() * envelope.height()) }
    }

    /// For a triangle or gap with these nodes, square of the user's length unit.
    pub fn at(&self, nodes: impl IntoIterator<Item = u32>) -> f64 {
        if !self.cloud.is_graded() {
            return self.of_envelope;
        }
        let spacings = nodes.into_iter().map(|node| self.cloud.local_spacing(NodeId(node)));
        TINY_LOCAL_REL * spacings.fold(f64::INFINITY, f64::min).powi(2)
    }
}
