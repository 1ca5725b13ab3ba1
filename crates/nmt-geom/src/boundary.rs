//! The real boundary: the polygon through all boundary nodes, each segment knowing its edge of the outline.

use crate::bbox::Bbox;
use crate::error::GeomError;
use crate::ids::{EdgeId, LoopId, NodeId};
use crate::point::Point;
use crate::region::{Region, RegionFault};
use crate::ring;
use crate::segment_index::SegmentIndex;

/// A straight piece of the real boundary; the material lies on the left of `from → to`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Segment {
    /// First node.
    pub from: NodeId,
    /// Last node.
    pub to: NodeId,
    /// The edge of the outline it lies on.
    pub edge: EdgeId,
}

/// Nodes around one loop and the edges of the segments between them, either orientation: segment k leads from node k to
/// the next, the last one back to the first.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct BoundaryLoop {
    /// Nodes in order.
    pub nodes: Vec<NodeId>,
    /// Edge of each segment, as many as nodes.
    pub edges: Vec<EdgeId>,
}

/// The paper's real envelope of a subdomain: loops of boundary nodes joined by segments.
///
/// Loop 0 is the main contour, counter-clockwise; the others are holes, clockwise: the material is on the left of every
/// segment.
#[derive(Clone, Debug, PartialEq)]
pub struct RealBoundary {
    xy: Vec<Point>,          // shape (n_boundary, 2)
    segments: Vec<Segment>,  // loop after loop, in order
    loop_starts: Vec<usize>, // first segment of each loop, shape (n_loops + 1,)
    index: SegmentIndex,
}

impl RealBoundary {
    /// Joins boundary nodes `0..xy.len()` to loops, the main contour first.
    ///
    /// # Errors
    /// [`GeomError`] where a loop has fewer than three nodes or names one that does not exist, where its edges are not
    /// one a segment, or where a coordinate is not finite.
    pub fn new(xy: Vec<Point>, loops: Vec<BoundaryLoop>) -> Result<Self, GeomError> {
        if let Some(node) = xy.iter().position(|p| !(p[0].is_finite() && p[1].is_finite())) {
            return Err(GeomError::NotFinite { node, at: xy[node] });
        }
        let segments = Vec::with_capacity(xy.len());
        let mut boundary = Self { segments, xy, loop_starts: vec![0], index: SegmentIndex::new([]) };
        for (k, BoundaryLoop { nodes, edges }) in loops.into_iter().enumerate() {
            let n = nodes.len();
            if n < 3 {
                return Err(GeomError::LoopTooShort { ring: k, n_nodes: n });
            }
            if edges.len() != n {
                return Err(GeomError::EdgesMissing { ring: k, n_nodes: n, n_edges: edges.len() });
            }
            let n_nodes = boundary.xy.len();
            if let Some(node) = nodes.iter().find(|node| node.index() >= n_nodes) {
                return Err(GeomError::NoSuchNode { ring: k, node: node.0, n_nodes });
            }
            let corners: Vec<Point> = nodes.iter().map(|node| boundary.xy[node.index()]).collect();
            let counter_clockwise = ring::signed_area(&corners) > 0.0;
            let given = |s: usize| Segment { from: nodes[s], to: nodes[(s + 1) % n], edge: edges[s] };
            if counter_clockwise == (k == 0) {
                boundary.segments.extend((0..n).map(given));
            } else {
                let reversed = |s: Segment| Segment { from: s.to, to: s.from, edge: s.edge };
                boundary.segments.extend((0..n).rev().map(given).map(reversed));
            }
            boundary.loop_starts.push(boundary.segments.len());
        }
        boundary.index = SegmentIndex::new(boundary.all_ends());
        Ok(boundary)
    }

    /// Coordinates of the boundary nodes, shape (n_boundary, 2).
    pub fn xy(&self) -> &[Point] {
        &self.xy
    }

    /// Number of loops: the main contour and the holes.
    pub fn n_loops(&self) -> usize {
        self.loop_starts.len() - 1
    }

    /// All segments, loop after loop.
    pub fn segments(&self) -> &[Segment] {
        &self.segments
    }

    /// Segments of one loop, in order.
    pub fn loop_segments(&self, ring: LoopId) -> &[Segment] {
        &self.segments[self.loop_starts[ring.index()]..self.loop_starts[ring.index() + 1]]
    }

    /// The loop that segment `k` of [`Self::segments`] belongs to.
    pub fn loop_of_segment(&self, k: usize) -> LoopId {
        LoopId::of(self.loop_starts.partition_point(|&start| start <= k).saturating_sub(1))
    }

    /// The ends of a segment.
    pub fn ends(&self, segment: &Segment) -> [Point; 2] {
        [self.xy[segment.from.index()], self.xy[segment.to.index()]]
    }

    /// The ends of every segment, in the order of [`Self::segments`].
    pub fn all_ends(&self) -> impl Iterator<Item = [Point; 2]> {
        self.segments.iter().map(|segment| self.ends(segment))
    }

    /// Corners of a loop's polygon, in order.
    pub fn polygon(&self, ring: LoopId) -> Vec<Point> {
        self.loop_segments(ring).iter().map(|segment| self.xy[segment.from.index()]).collect()
    }

    /// Area enclosed by a loop's polygon, positive; square of the user's length unit.
    pub fn loop_area(&self, ring: LoopId) -> f64 {
        ring::signed_area(&self.polygon(ring)).abs()
    }

    /// Area of the material: within the main contour, less the holes.
    pub fn area(&self) -> f64 {
        (0..self.n_loops()).map(|k| ring::signed_area(&self.polygon(LoopId::of(k)))).sum()
    }

    /// Centroid of the material, the polygon's.
    pub fn centroid(&self) -> Point {
        let mut moment = [0.0; 2];
        for ring in 0..self.n_loops() {
            let polygon = self.polygon(LoopId::of(ring));
            let (area, centroid) = (ring::signed_area(&polygon), ring::centroid(&polygon));
            (0..2).for_each(|d| moment[d] += area * centroid[d]);
        }
        moment.map(|m| m / self.area())
    }

    /// Envelope of all boundary nodes.
    pub fn envelope(&self) -> Bbox {
        Bbox::of(self.xy.iter().copied())
    }

    /// The segments by their numbers in [`Self::segments`]: which are near, and where a point lies.
    pub fn index(&self) -> &SegmentIndex {
        &self.index
    }

    /// What is wrong with the polygon: a boundary too coarse for its curves crosses itself.
    pub fn faults(&self) -> Vec<RegionFault> {
        let mut loops = (0..self.n_loops()).map(|k| self.polygon(LoopId::of(k)));
        Region { contour: loops.next().unwrap_or_default(), holes: loops.collect() }.faults_with(&self.index, 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ids(numbers: &[u32]) -> Vec<NodeId> {
        numbers.iter().map(|&n| NodeId(n)).collect()
    }

    fn tube() -> Result<RealBoundary, GeomError> {
        let xy = vec![
            [0.0, 0.0],
            [0.0, 4.0],
            [4.0, 4.0],
            [4.0, 0.0], // clockwise
            [1.0, 1.0],
            [2.0, 1.0],
            [2.0, 2.0],
            [1.0, 2.0], // counter-clockwise
        ];
        let ring = |nodes: &[u32], first: u32| BoundaryLoop {
            nodes: ids(nodes),
            edges: (first..first + 4).map(EdgeId).collect(),
        };
        RealBoundary::new(xy, vec![ring(&[0, 1, 2, 3], 0), ring(&[4, 5, 6, 7], 4)])
    }

    #[test]
    fn the_material_is_on_the_left_of_every_segment() -> Result<(), GeomError> {
        let boundary = tube()?;
        assert_eq!(boundary.area(), 15.0);
        assert_eq!(boundary.loop_area(LoopId(1)), 1.0);
        // (16·2 − 1·1.5)/15
        assert!(boundary.centroid().iter().all(|c| (c - 30.5 / 15.0).abs() < 1e-15));
        let first = boundary.loop_segments(LoopId(0))[0];
        // The last segment given led from node 3 to node 0 on edge 3; it comes first, turned round.
        assert_eq!((first.from, first.to, first.edge), (NodeId(0), NodeId(3), EdgeId(3)));
        assert_eq!(boundary.loop_of_segment(3), LoopId(0));
        assert_eq!(boundary.loop_of_segment(4), LoopId(1));
        Ok(())
    }

    #[test]
    fn a_loop_with_a_missing_node_is_an_error_that_names_it() {
        let ring = BoundaryLoop { nodes: ids(&[0, 1, 7]), edges: vec![EdgeId(0); 3] };
        let error = RealBoundary::new(vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], vec![ring]);
        assert_eq!(error, Err(GeomError::NoSuchNode { ring: 0, node: 7, n_nodes: 3 }));
    }
}
