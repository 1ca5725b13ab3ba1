//! The cloud: coordinates, kinds, outline edges, spacing.

use crate::census::Census;
use crate::error::CloudError;
use nmt_geom::{EdgeId, LoopId, NodeId, Point, RealBoundary};

/// What kind of node it is; the paper's Nodes_codes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum NodeKind {
    /// A vertex of the outline: fixed, on two edges (the seam of a circle: on one).
    Vertex,
    /// On one edge.
    Edge,
    /// Inside.
    Interior,
}

impl NodeKind {
    /// The word of the reports and files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Vertex => "vertex",
            Self::Edge => "edge",
            Self::Interior => "interior",
        }
    }
}

/// The one or two edges a boundary node lies on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NodeEdges {
    /// The edge of the segment that ends here, following the outline as the user gave it.
    pub first: EdgeId,
    /// The edge of the segment that starts here; the same one at a node within an edge.
    pub second: EdgeId,
}

/// Nodes of one subdomain: vertices, then edge nodes, then interior nodes.
#[derive(Clone, Debug, PartialEq)]
pub struct Cloud {
    xy: Vec<Point>, // shape (n_nodes, 2), user's length unit
    n_vertices: usize,
    boundary: RealBoundary,
    edges: Vec<NodeEdges>, // shape (n_boundary,)
    spacing: [f64; 2],
    census: Census,
}

impl Cloud {
    /// Puts a cloud together from a real boundary (whose first `n_vertices` nodes are vertices) and interior nodes.
    ///
    /// `spacing` is [h_x, h_y], the scale of clearances and visibility.
    pub fn from_parts(
        boundary: RealBoundary,
        n_vertices: usize,
        interior: Vec<Point>,
        spacing: [f64; 2],
        census: Census,
    ) -> Self {
        let none = NodeEdges { first: EdgeId(u32::MAX), second: EdgeId(u32::MAX) };
        let mut edges = vec![none; boundary.xy().len()];
        for segment in boundary.segments() {
            edges[segment.to.index()].first = segment.edge;
            edges[segment.from.index()].second = segment.edge;
        }
        // Report the edges in the order of the outline, whichever way the loop was turned: the first vertex of a loop
        // begins its first edge.
        for ring in 0..boundary.n_loops() {
            let segments = boundary.loop_segments(LoopId::of(ring));
            let Some(first_vertex) = segments.iter().map(|s| s.from).min() else { continue };
            let first_edge = segments.iter().map(|s| s.edge).min();
            let NodeEdges { first, second } = edges[first_vertex.index()];
            if first != second && Some(first) == first_edge {
                for segment in segments {
                    let NodeEdges { first, second } = edges[segment.from.index()];
                    edges[segment.from.index()] = NodeEdges { first: second, second: first };
                }
            }
        }
        let mut xy = boundary.xy().to_vec();
        xy.extend(interior);
        Self { xy, n_vertices, boundary, edges, spacing, census }
    }

    /// Coordinates, shape (n_nodes, 2), user's length unit.
    pub fn xy(&self) -> &[Point] {
        &self.xy
    }

    /// Number of nodes.
    pub fn n_nodes(&self) -> usize {
        self.xy.len()
    }

    /// Number of boundary nodes: they come first.
    pub fn n_boundary(&self) -> usize {
        self.edges.len()
    }

    /// Number of vertices: they come before the other boundary nodes.
    pub fn n_vertices(&self) -> usize {
        self.n_vertices
    }

    /// Number of interior nodes: they come last.
    pub fn n_interior(&self) -> usize {
        self.n_nodes() - self.n_boundary()
    }

    /// Kind of a node.
    pub fn kind(&self, node: NodeId) -> NodeKind {
        if node.index() < self.n_vertices {
            NodeKind::Vertex
        } else if node.index() < self.n_boundary() {
            NodeKind::Edge
        } else {
            NodeKind::Interior
        }
    }

    /// The edges a boundary node lies on; `None` for an interior node.
    pub fn edges(&self, node: NodeId) -> Option<NodeEdges> {
        self.edges.get(node.index()).copied()
    }

    /// The polygon through all boundary nodes.
    pub fn boundary(&self) -> &RealBoundary {
        &self.boundary
    }

    /// [h_x, h_y] of the background grid, user's length unit.
    pub fn spacing(&self) -> [f64; 2] {
        self.spacing
    }

    /// max(h_x, h_y): the length that clearances and visibility are measured in.
    pub fn max_spacing(&self) -> f64 {
        self.spacing[0].max(self.spacing[1])
    }

    /// Generated and deleted grid points by cause.
    pub fn census(&self) -> Census {
        self.census
    }

    /// Length of the diagonal of the envelope, user's length unit.
    pub fn size(&self) -> f64 {
        self.boundary.envelope().size()
    }

    /// Checks the invariants: finite coordinates, a sound real boundary, interior nodes strictly inside.
    ///
    /// # Errors
    /// The first invariant that is broken, as [`CloudError`].
    pub fn check(&self) -> Result<(), CloudError> {
        if let Some(node) = self.xy.iter().position(|p| !(p[0].is_finite() && p[1].is_finite())) {
            return Err(nmt_geom::GeomError::NotFinite { node, at: self.xy[node] }.into());
        }
        if let Some(fault) = self.boundary.faults().first() {
            let at = crate::generate::place_of(fault, &self.boundary);
            return Err(CloudError::BoundaryCrosses { at, remedy: "give the outline more nodes".into() });
        }
        let locator = self.boundary.locator();
        let interior = &self.xy[self.n_boundary()..];
        if let Some(&at) = interior.iter().find(|&&p| locator.locate(p) != nmt_geom::Location::Inside) {
            return Err(CloudError::InteriorOutside { at });
        }
        Ok(())
    }
}
