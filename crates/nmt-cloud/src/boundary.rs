//! Nodes at vertices and on edges, joined to the real boundary; paper, Secs 4.1–4.2.

use crate::error::CloudError;
use crate::generate::{evenly, on_line};
use crate::irregular::Displacements;
use crate::section::{CloudParams, Section};
use nmt_curve::{ArcTable, Curve, Outline, node_count};
use nmt_geom::{BoundaryLoop, EdgeId, NodeId, Point, RealBoundary};

/// The real boundary and how many of its nodes are vertices.
pub(crate) struct BoundaryNodes {
    pub boundary: RealBoundary,
    pub n_vertices: usize,
}

/// Places the boundary nodes: every vertex, then the nodes of every edge, evenly by arc length, each displaced along its
/// edge by ±Amp of a segment where the cloud is irregular.
pub(crate) fn boundary_nodes(
    section: &Section,
    params: &CloudParams,
    displacements: &mut Displacements,
) -> Result<BoundaryNodes, CloudError> {
    let envelope = section.contour.envelope();
    let rate_of = |nodes: [usize; 2], width: f64, height: f64| [nodes[0] as f64 / width, nodes[1] as f64 / height];
    let main_rate = rate_of(params.nodes, envelope.width(), envelope.height());
    let mut xy: Vec<Point> = section.loops().flat_map(|outline| outline.vertices.iter().copied()).collect();
    let n_vertices = xy.len();
    let mut loops = Vec::new();
    let (mut first_vertex, mut first_edge) = (0, 0);
    for (k, outline) in section.loops().enumerate() {
        let own = k.checked_sub(1).and_then(|hole| params.hole_nodes.get(hole).copied().flatten());
        let rate = own.map_or(main_rate, |nodes| {
            let own_envelope = outline.envelope();
            rate_of(nodes, own_envelope.width(), own_envelope.height())
        });
        loops.push(loop_nodes(outline, rate, first_vertex, first_edge, params.irregularity, displacements, &mut xy)?);
        first_vertex += outline.vertices.len();
        first_edge += outline.edges.len();
    }
    Ok(BoundaryNodes { boundary: RealBoundary::new(xy, loops)?, n_vertices })
}

fn loop_nodes(
    outline: &Outline,
    rate: [f64; 2],
    first_vertex: usize,
    first_edge: usize,
    irregularity: f64,
    displacements: &mut Displacements,
    xy: &mut Vec<Point>,
) -> Result<BoundaryLoop, CloudError> {
    let mut ring = BoundaryLoop::default();
    for (k, edge) in outline.edges.iter().enumerate() {
        // A closed edge of n nodes has n segments, an open one n − 1.
        let n_nodes = edge.nodes.unwrap_or_else(|| node_count(&edge.curve, rate));
        let n_segments = if edge.curve.is_closed() { n_nodes.max(3) } else { n_nodes.max(2) - 1 };
        let path = EdgePath::new(&edge.curve).map_err(|source| CloudError::Edge { edge: first_edge + k, source })?;
        let edge_id = EdgeId::of(first_edge + k);
        ring.nodes.push(NodeId::of(first_vertex + k));
        ring.edges.push(edge_id);
        for s in 1..n_segments {
            let node = xy.len();
            let slide = if irregularity > 0.0 { irregularity * displacements.draw(node, 0)[0] } else { 0.0 };
            xy.push(path.point_at(evenly(s, n_segments) + slide / n_segments as f64));
            ring.nodes.push(NodeId::of(node));
            ring.edges.push(edge_id);
        }
    }
    Ok(ring)
}

/// An edge parametrised by the fraction of its length.
enum EdgePath {
    Line { from: Point, to: Point },
    Curved(ArcTable),
}

impl EdgePath {
    fn new(curve: &Curve) -> Result<Self, nmt_curve::CurveError> {
        match curve {
            Curve::Line { from, to } => Ok(Self::Line { from: *from, to: *to }),
            curve => Ok(Self::Curved(ArcTable::new(curve)?)),
        }
    }

    fn point_at(&self, fraction: f64) -> Point {
        match self {
            Self::Line { from, to } => on_line(*from, *to, fraction),
            Self::Curved(table) => table.point_at(fraction * table.length()),
        }
    }
}
