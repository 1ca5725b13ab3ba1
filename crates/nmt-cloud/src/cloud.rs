//! The cloud: coordinates, kinds, outline edges, spacing.

use crate::boundary::Closing;
use crate::census::Census;
use crate::clearance::Clearance;
use crate::error::CloudError;
use crate::lattice::Lattice;
use crate::nested::NestedLattice;
use crate::sow::LocalClearance;
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
    edges: Vec<NodeEdges>,       // shape (n_boundary,)
    fractions: Option<Vec<f64>>, // shape (n_boundary,)
    spacing: [f64; 2],
    clearance: Clearance,
    born: Option<Born>,
    local: Option<Local>,
    closings: Vec<Closing>,
    census: Census,
}

/// Spacings of a graded cloud.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Local {
    pub lattice: NestedLattice,
    pub asked: Vec<f64>, // shape (n_nodes,), user's length unit
    pub clearance: LocalClearance,
    pub may_miss_dips: bool,
}

/// Where interior nodes come from.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Born {
    pub lattice: Lattice,
    pub sites: Vec<u32>, // shape (n_interior,)
}

impl Born {
    /// True where every interior node is less than half a spacing from its site along x and y.
    pub fn all_within_boxes(&self, interior: &[Point]) -> bool {
        let half = self.lattice.spacing().map(|h| 0.5 * h);
        self.sites.iter().zip(interior).all(|(&site, p)| {
            let [i, j] = self.lattice.site_of(site);
            let site = self.lattice.site(i, j);
            (0..2).all(|d| (p[d] - site[d]).abs() < half[d])
        })
    }
}

/// What a cloud is put together from.
pub(crate) struct CloudParts {
    pub xy: Vec<Point>, // those of the boundary first
    pub n_vertices: usize,
    pub boundary: RealBoundary,
    pub fractions: Option<Vec<f64>>,
    pub spacing: [f64; 2],
    pub clearance: Clearance,
    pub born: Option<Born>,
    pub local: Option<Local>,
    pub closings: Vec<Closing>,
    pub census: Census,
}

impl Cloud {
    /// Puts a cloud together from a real boundary (whose first `n_vertices` nodes are vertices) and interior nodes.
    ///
    /// `spacing` is [h_x, h_y], the scale of visibility. Such a cloud has no lattice, keeps no clearance, and does not know
    /// where its nodes lie along their edges.
    pub fn from_parts(
        boundary: RealBoundary,
        n_vertices: usize,
        interior: Vec<Point>,
        spacing: [f64; 2],
        census: Census,
    ) -> Self {
        let mut xy = boundary.xy().to_vec();
        xy.extend(interior);
        let (clearance, closings) = (Clearance::NONE, Vec::new());
        Self::new(CloudParts {
            xy,
            n_vertices,
            boundary,
            fractions: None,
            spacing,
            clearance,
            born: None,
            local: None,
            closings,
            census,
        })
    }

    /// The same cloud with its interior nodes elsewhere, shape (n_interior, 2), in the same order.
    ///
    /// Boundary, clearance and census stay; the lattice does where every node is still in the box of its site.
    ///
    /// # Errors
    /// [`CloudError::OtherNumber`] where `interior` has another length than the cloud has interior nodes.
    pub fn with_interior(mut self, interior: &[Point]) -> Result<Self, CloudError> {
        let n_boundary = self.n_boundary();
        if interior.len() != self.n_interior() {
            return Err(CloudError::OtherNumber { given: interior.len(), n_interior: self.n_interior() });
        }
        self.xy[n_boundary..].copy_from_slice(interior);
        self.born = self.born.filter(|born| born.all_within_boxes(interior));
        Ok(self)
    }

    pub(crate) fn new(parts: CloudParts) -> Self {
        let CloudParts { xy, n_vertices, boundary, fractions, spacing, clearance, born, local, closings, census } =
            parts;
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
        Self { xy, n_vertices, boundary, edges, fractions, spacing, clearance, born, local, closings, census }
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

    /// [h_x, h_y] of the background grid, user's length unit; of a graded cloud those of its coarsest lattice.
    pub fn spacing(&self) -> [f64; 2] {
        self.spacing
    }

    /// max(h_x, h_y); of a graded cloud the largest spacing.
    pub fn max_spacing(&self) -> f64 {
        self.spacing[0].max(self.spacing[1])
    }

    /// The spacing at a node, which clearances and visibility are measured in, user's length unit: what was asked for at
    /// the place where it was generated, or [`Self::max_spacing`] where the cloud is not graded.
    pub fn local_spacing(&self, node: NodeId) -> f64 {
        let asked = self.local.as_ref().and_then(|local| local.asked.get(node.index()));
        asked.copied().unwrap_or_else(|| self.max_spacing())
    }

    /// True where the spacing varies, as asked by a [`crate::Grading`].
    pub fn is_graded(&self) -> bool {
        self.local.is_some()
    }

    /// True where dips of the function that a graded cloud follows may have been passed over; see [`crate::Spacing::may_miss_dips`].
    pub fn may_miss_dips(&self) -> bool {
        self.local.as_ref().is_some_and(|local| local.may_miss_dips)
    }

    /// The nested lattices that the interior nodes of a graded cloud come from; `None` for others.
    pub fn nested_lattice(&self) -> Option<&NestedLattice> {
        self.local.as_ref().map(|local| &local.lattice)
    }

    pub(crate) fn local(&self) -> Option<&Local> {
        self.local.as_ref()
    }

    /// The least distances of interior nodes from the boundary, as they were generated; of a graded cloud where it is
    /// coarsest.
    pub fn clearance(&self) -> &Clearance {
        &self.clearance
    }

    /// The least distances of a node from the boundary: those of all, or of its own spacing in a graded cloud.
    pub fn clearance_of(&self, node: NodeId) -> Clearance {
        self.local.as_ref().map_or(self.clearance, |local| local.clearance.at(self.local_spacing(node)))
    }

    /// Where each boundary node lies along its edge, shape (n_boundary,): the arc length from the edge's first vertex as a
    /// fraction of the edge; 0 at vertices. `None` for a cloud put together by [`Self::from_parts`].
    pub fn edge_fractions(&self) -> Option<&[f64]> {
        self.fractions.as_deref()
    }

    /// The background grid that the interior nodes come from; `None` where they do not come from one.
    pub fn lattice(&self) -> Option<&Lattice> {
        self.born.as_ref().map(|born| &born.lattice)
    }

    /// The site of every interior node, shape (n_interior,), as its number j·N_x + i on [`Self::lattice`].
    ///
    /// A node is nearer than half a spacing to its site along x and along y, and no two have the same.
    pub fn sites(&self) -> Option<&[u32]> {
        self.born.as_ref().map(|born| &*born.sites)
    }

    /// How each edge that was divided by chords closed, in order of the edges.
    pub fn closings(&self) -> &[Closing] {
        &self.closings
    }

    /// Generated and deleted grid points by cause.
    pub fn census(&self) -> Census {
        self.census
    }

    /// Length of the diagonal of the envelope, user's length unit.
    pub fn size(&self) -> f64 {
        self.boundary.envelope().size()
    }

    /// Checks the invariants: finite coordinates, a sound real boundary, interior nodes strictly inside and clear of it,
    /// each in the box of its own site.
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
        let index = self.boundary.index();
        let interior = &self.xy[self.n_boundary()..];
        if let Some(&at) = interior.iter().find(|&&p| index.locate(p) != nmt_geom::Location::Inside) {
            return Err(CloudError::InteriorOutside { at });
        }
        let clearance = |k: usize| self.clearance_of(NodeId::of(self.n_boundary() + k));
        if let Some((_, &at)) = interior.iter().enumerate().find(|&(k, &p)| !clearance(k).holds(p, index)) {
            return Err(CloudError::TooNear { at });
        }
        let sound = |local: &Local| {
            local.asked.len() == self.n_nodes() && local.asked.iter().all(|h| *h > 0.0 && *h <= self.max_spacing())
        };
        if !self.local.as_ref().is_none_or(sound) {
            return Err(CloudError::NoLocalSpacing);
        }
        let Some(born) = &self.born else { return Ok(()) };
        let in_order = born.sites.windows(2).all(|pair| pair[0] < pair[1]);
        if !in_order || born.sites.len() != interior.len() || !born.all_within_boxes(interior) {
            return Err(CloudError::OffSites);
        }
        Ok(())
    }
}
