//! Fluxes on the boundary: ∂u/∂n = q on the true edge, which the mesh has a polygon for.

use nmt_geom::{NodeId, Point, TriId};

/// A place with its weight in an integral.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample {
    /// The triangle whose functions are continued to the place.
    pub triangle: TriId,
    /// The place.
    pub at: Point,
    /// q·ds on an edge, the area (negative where the curve runs inside the polygon) in a sliver.
    pub weight: f64,
}

/// The condition at one node: Σ (n·∇u − q) = 0 over the edges that meet there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NodeFlux {
    /// The node.
    pub node: NodeId,
    /// Sum of the outward unit normals.
    pub normal: [f64; 2],
    /// Sum of the q.
    pub q: f64,
}

/// All fluxes of a problem.
#[derive(Clone, Debug, Default)]
pub(crate) struct Fluxes {
    /// Over the edges with a flux, by triangle.
    pub edges: Vec<Sample>,
    /// Over the slivers between segments and curves, by triangle: the weak form is integrated over the true section.
    pub slivers: Vec<Sample>,
    /// By node, ascending.
    pub nodes: Vec<NodeFlux>,
}

impl Fluxes {
    /// The samples of a triangle.
    pub fn of_triangle(samples: &[Sample], triangle: TriId) -> &[Sample] {
        let first = samples.partition_point(|sample| sample.triangle < triangle);
        let last = samples.partition_point(|sample| sample.triangle <= triangle);
        &samples[first..last]
    }

    /// The condition at a node.
    pub fn of_node(&self, node: NodeId) -> Option<&NodeFlux> {
        self.nodes.binary_search_by_key(&node, |flux| flux.node).ok().map(|k| &self.nodes[k])
    }
}
