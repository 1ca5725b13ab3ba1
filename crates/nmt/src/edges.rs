//! τ along the edges of a solved subdomain: what edges.csv, edges.svg and the report's table are made from.

use crate::pipeline::SolvedPart;
use crate::report::singular_vertices;
use nmt_geom::point::distance;
use nmt_geom::tol::SAME_POINT_REL;
use nmt_geom::{LoopId, NodeId};
use nmt_mfdm::{Circulation, EdgeStress, circulations, edge_stresses};

/// τ along all edges of one subdomain.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EdgeTable {
    /// τ along each edge, by [`nmt_geom::EdgeId`].
    pub edges: Vec<EdgeStress>,
    /// ∮τ·ds of each loop, the main contour first.
    pub loops: Vec<Circulation>,
    /// Vertices where the exact τ is infinite.
    pub singular: Vec<NodeId>,
}

impl EdgeTable {
    /// That of a solved subdomain.
    pub fn of(solved: &SolvedPart) -> Self {
        let SolvedPart { part, solution, .. } = solved;
        // An edge that has no length was told, with its place, when its cloud was generated: the tables are not empty.
        let edges = edge_stresses(&part.mesh, &part.section, solution).unwrap_or_default();
        let loops = circulations(&part.mesh, &part.section, solution, &edges).unwrap_or_default();
        let cloud = part.mesh.cloud();
        let places = singular_vertices(&part.section);
        let tolerance = SAME_POINT_REL * cloud.size();
        let is_singular = |node: &usize| places.iter().any(|p| distance(*p, cloud.xy()[*node]) <= tolerance);
        let singular = (0..cloud.n_vertices()).filter(is_singular).map(NodeId::of).collect();
        Self { edges, loops, singular }
    }

    /// True at a vertex where the exact τ is infinite.
    pub fn is_singular(&self, node: NodeId) -> bool {
        self.singular.binary_search(&node).is_ok()
    }
}

/// What files and pictures call a loop: `contour`, or the hole's name.
pub fn loop_name(solved: &SolvedPart, ring: LoopId) -> &str {
    let hole = ring.index().checked_sub(1).and_then(|hole| solved.part.hole_names.get(hole));
    hole.map_or("contour", |name| name)
}
