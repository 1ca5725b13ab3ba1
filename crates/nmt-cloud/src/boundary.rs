//! Nodes at vertices and on edges, joined to the real boundary; paper, Secs 4.1–4.2.

use crate::error::CloudError;
use crate::section::{CloudParams, GivenNode, Section};
use crate::spacing::{Spacing, least_segments};
use nmt_curve::{ArcTable, Curve, Division, EdgeNodes, OutlineEdge, SpacingTable, divide_by_chords, node_count};
use nmt_geom::point::{along, distance, sub};
use nmt_geom::{Bbox, BoundaryLoop, EdgeId, NodeId, Point, RealBoundary};

/// The real boundary, and where its nodes lie on the outline.
pub(crate) struct BoundaryNodes {
    pub boundary: RealBoundary,
    pub n_vertices: usize,
    /// Arc length from the beginning of its edge to each boundary node, as a fraction of the edge; 0 at vertices.
    pub fractions: Vec<f64>,
    /// Edges divided by chords.
    pub closings: Vec<Closing>,
}

/// How a division by equal chords closed; paper, eq. (5) \[D3\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Closing {
    /// The edge.
    pub edge: EdgeId,
    /// Length of the equal chords, user's length unit.
    pub chord: f64,
    /// Nodes that no longer fitted.
    pub left_out: usize,
    /// By how much the last chord, to the end of the edge, misses that length; user's length unit.
    pub closing_error: f64,
}

/// Segments that each edge is divided into by its own count, (2) \[D4\] or its `nodes`; by [`EdgeId`].
///
/// A division by chords may make fewer, and an edge whose nodes are given as many as these say.
pub fn segment_counts(section: &Section, params: &CloudParams) -> Vec<usize> {
    let rate_of = |nodes: [usize; 2], envelope: Bbox| {
        let [width, height] = [envelope.width(), envelope.height()];
        [nodes[0] as f64 / width, nodes[1] as f64 / height]
    };
    let main_rate = rate_of(params.nodes, section.contour.envelope());
    let mut counts = Vec::new();
    for (k, outline) in section.loops().enumerate() {
        let own = k.checked_sub(1).and_then(|hole| params.hole_nodes.get(hole).copied().flatten());
        let rate = own.map_or(main_rate, |nodes| rate_of(nodes, outline.envelope()));
        for edge in &outline.edges {
            // A closed edge of n nodes has n segments, an open one n − 1.
            let n_nodes = edge.nodes.unwrap_or_else(|| node_count(&edge.curve, rate));
            counts.push(if edge.curve.is_closed() { n_nodes.max(3) } else { n_nodes.max(2) - 1 });
        }
    }
    counts
}

/// Places the boundary nodes: every vertex, then the nodes of every edge by its rule or as they are given, each that is
/// not fixed displaced along its edge by ±Amp of the shorter of its two segments where the cloud is irregular.
///
/// With a `spacing` the rule is equal parts of ∫ds/h, as many as make the segments no longer than it asks for.
/// `random` gives 2r − 1 and 2r′ − 1 of (10) for a node and a draw.
pub(crate) fn boundary_nodes(
    section: &Section,
    params: &CloudParams,
    spacing: Option<&Spacing>,
    random: &mut dyn FnMut(usize, usize) -> [f64; 2],
) -> Result<BoundaryNodes, CloudError> {
    let counts = if spacing.is_none() { segment_counts(section, params) } else { Vec::new() };
    let mut draft = Draft::at_vertices(section);
    let n_vertices = draft.xy.len();
    let (mut first_vertex, mut first_edge) = (0, 0);
    for outline in section.loops() {
        let mut ring = BoundaryLoop::default();
        for (e, edge) in outline.edges.iter().enumerate() {
            let failed = |source| CloudError::Edge { edge: first_edge + e, source };
            let given = params.edge_nodes.get(first_edge + e).and_then(Option::as_deref);
            let path = EdgePath::new(&edge.curve).map_err(failed)?;
            let (places, closing) = match (given, spacing) {
                (Some(nodes), _) => (Places::given(nodes), None),
                (None, Some(spacing)) => (Places::graded(&path, edge, first_edge + e, spacing)?, None),
                (None, None) => Places::new(&edge.curve, counts[first_edge + e], params.division).map_err(failed)?,
            };
            let edge_id = EdgeId::of(first_edge + e);
            draft.closings.extend(closing.map(|closing| Closing { edge: edge_id, ..closing }));
            draft.begin_edge(&mut ring, NodeId::of(first_vertex + e), edge_id);
            for s in 1..places.n_segments() {
                let fixed = given.and_then(|nodes| nodes.get(s - 1)).and_then(|node| Some((node.fraction, node.at?)));
                if let Some((fraction, at)) = fixed {
                    draft.push_at(&mut ring, at, fraction, edge_id);
                    continue;
                }
                let slide = match params.irregularity {
                    0.0 => 0.0,
                    amplitude => amplitude * random(draft.xy.len(), 0)[0],
                };
                draft.push(&mut ring, &path, places.slid(s, slide), edge_id);
            }
        }
        draft.loops.push(ring);
        first_vertex += outline.vertices.len();
        first_edge += outline.edges.len();
    }
    let boundary = RealBoundary::new(draft.xy, draft.loops)?;
    Ok(BoundaryNodes { boundary, n_vertices, fractions: draft.fractions, closings: draft.closings })
}

/// Slides the edge nodes of an existing boundary along their edges, each by ±Amp of the shorter of its two segments.
///
/// `fractions` are those of the boundary nodes, which must be numbered and joined as [`boundary_nodes`] does.
pub(crate) fn slide(
    section: &Section,
    boundary: &RealBoundary,
    n_vertices: usize,
    fractions: &[f64],
    amplitude: f64,
    random: &mut dyn FnMut(usize, usize) -> [f64; 2],
) -> Result<BoundaryNodes, CloudError> {
    let mut draft = Draft::at_vertices(section);
    let edges: Vec<&Curve> = section.loops().flat_map(|outline| &outline.edges).map(|edge| &edge.curve).collect();
    if n_vertices != draft.xy.len() || edges.len() != n_vertices {
        return Err(CloudError::OtherSection { vertices: draft.xy.len(), n_vertices });
    }
    // The nodes of each edge by number, which is their order along it.
    let mut on_edge = vec![Vec::new(); edges.len()];
    for segment in boundary.segments() {
        for node in [segment.from, segment.to] {
            if node.index() >= n_vertices {
                let Some(nodes) = on_edge.get_mut(segment.edge.index()) else {
                    return Err(CloudError::OtherSection { vertices: draft.xy.len(), n_vertices });
                };
                nodes.push(node);
            }
        }
    }
    let mut edge = 0;
    for outline in section.loops() {
        let mut ring = BoundaryLoop::default();
        for _ in &outline.edges {
            let curve = edges[edge];
            let path = EdgePath::new(curve).map_err(|source| CloudError::Edge { edge, source })?;
            on_edge[edge].sort_unstable();
            on_edge[edge].dedup();
            let inner = on_edge[edge].iter().map(|node| fractions[node.index()]);
            let places = Places::Listed(std::iter::once(0.0).chain(inner).chain([1.0]).collect());
            draft.begin_edge(&mut ring, NodeId::of(edge), EdgeId::of(edge));
            for s in 1..places.n_segments() {
                let slide = amplitude * random(draft.xy.len(), 0)[0];
                draft.push(&mut ring, &path, places.slid(s, slide), EdgeId::of(edge));
            }
            edge += 1;
        }
        draft.loops.push(ring);
    }
    let boundary = RealBoundary::new(draft.xy, draft.loops)?;
    Ok(BoundaryNodes { boundary, n_vertices, fractions: draft.fractions, closings: Vec::new() })
}

/// Boundary nodes on the way to a real boundary.
struct Draft {
    xy: Vec<Point>,
    fractions: Vec<f64>,
    loops: Vec<BoundaryLoop>,
    closings: Vec<Closing>,
}

impl Draft {
    /// The vertices: contour first, then holes.
    fn at_vertices(section: &Section) -> Self {
        let xy: Vec<Point> = section.loops().flat_map(|outline| outline.vertices.iter().copied()).collect();
        Self { fractions: vec![0.0; xy.len()], xy, loops: Vec::new(), closings: Vec::new() }
    }

    /// Goes on with `ring` from a vertex along an edge.
    fn begin_edge(&self, ring: &mut BoundaryLoop, vertex: NodeId, edge: EdgeId) {
        ring.nodes.push(vertex);
        ring.edges.push(edge);
    }

    /// Adds a node of an edge.
    fn push(&mut self, ring: &mut BoundaryLoop, path: &EdgePath, fraction: f64, edge: EdgeId) {
        self.push_at(ring, path.point_at(fraction), fraction, edge);
    }

    /// Adds a node of an edge where it is told to lie.
    fn push_at(&mut self, ring: &mut BoundaryLoop, at: Point, fraction: f64, edge: EdgeId) {
        ring.nodes.push(NodeId::of(self.xy.len()));
        ring.edges.push(edge);
        self.xy.push(at);
        self.fractions.push(fraction);
    }
}

/// A number of spacings is met to this fraction, so that rounding adds no segment; as in (2) \[D4\].
const COUNT_SLACK: f64 = 1.0e-6;

/// Segments of a closed edge are a multiple of this, where their number follows from a spacing.
const QUARTERS: usize = 4;

/// Why an edge cannot be divided by a spacing.
enum EdgeFault {
    Curve(nmt_curve::CurveError),
    Spacing(CloudError),
}

impl From<nmt_curve::CurveError> for EdgeFault {
    fn from(source: nmt_curve::CurveError) -> Self {
        Self::Curve(source)
    }
}

/// Where the nodes of an edge lie before they slide: fractions of its length.
enum Places {
    /// Evenly, in so many segments.
    Even(usize),
    /// At these, from 0 to 1.
    Listed(Vec<f64>),
}

impl Places {
    /// The places by `division`, and how it closed where it is by chords; the edge of that is the caller's to name.
    fn new(
        curve: &Curve,
        n_segments: usize,
        division: Division,
    ) -> Result<(Self, Option<Closing>), nmt_curve::CurveError> {
        // Equal chords of a line are its equal parts.
        if division == Division::Arc || curve.is_straight() {
            return Ok((Self::Even(n_segments), None));
        }
        let n_nodes = if curve.is_closed() { n_segments } else { n_segments + 1 };
        let EdgeNodes { mut fractions, chord, left_out, closing_error, .. } = divide_by_chords(curve, n_nodes)?;
        if curve.is_closed() {
            fractions.push(1.0);
        }
        Ok((Self::Listed(fractions), Some(Closing { edge: EdgeId(0), chord, left_out, closing_error })))
    }

    /// The places by a spacing.
    fn graded(path: &EdgePath, edge: &OutlineEdge, number: usize, spacing: &Spacing) -> Result<Self, CloudError> {
        let length = path.length();
        let table = SpacingTable::new(length, |s| spacing.at(path.point_at(s / length)).map_err(EdgeFault::Spacing));
        let table = table.map_err(|fault| match fault {
            EdgeFault::Curve(nmt_curve::CurveError::NodeCount { most, .. }) => {
                CloudError::TooFine { spacing: spacing.finest(), limit: most as f64, place: " on one edge" }
            }
            EdgeFault::Curve(source) => CloudError::Edge { edge: number, source },
            EdgeFault::Spacing(error) => error,
        })?;
        let asked = table.spacings();
        let n = match edge.nodes {
            Some(_) => least_segments(edge),
            None => {
                let n = least_segments(edge).max((asked - COUNT_SLACK * asked.max(1.0)).ceil() as usize);
                // A circle or an ellipse whose spacing is symmetric gets nodes that are.
                if edge.curve.is_closed() { n.next_multiple_of(QUARTERS) } else { n }
            }
        };
        Ok(Self::Listed(table.equal_parts(n)))
    }

    /// The places of nodes that are given.
    fn given(nodes: &[GivenNode]) -> Self {
        let inner = nodes.iter().map(|node| node.fraction);
        Self::Listed(std::iter::once(0.0).chain(inner).chain([1.0]).collect())
    }

    fn n_segments(&self) -> usize {
        match self {
            Self::Even(n) => *n,
            Self::Listed(fractions) => fractions.len() - 1,
        }
    }

    /// Node `s` slid by `slide` of the shorter of its segments; below ½, so that the order is kept.
    fn slid(&self, s: usize, slide: f64) -> f64 {
        match self {
            Self::Even(n) => evenly(s, *n) + slide / *n as f64,
            Self::Listed(f) => f[s] + slide * (f[s] - f[s - 1]).min(f[s + 1] - f[s]),
        }
    }
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

    fn length(&self) -> f64 {
        match self {
            Self::Line { from, to } => distance(*from, *to),
            Self::Curved(table) => table.length(),
        }
    }

    fn point_at(&self, fraction: f64) -> Point {
        match self {
            Self::Line { from, to } => on_line(*from, *to, fraction),
            Self::Curved(table) => table.point_at(fraction * table.length()),
        }
    }
}

/// Fraction of the way that the end of segment `k` of `n` lies along an edge.
fn evenly(k: usize, n_segments: usize) -> f64 {
    k as f64 / n_segments as f64
}

/// The point at fraction `t` of a straight edge; paper, eq. (1).
///
/// Written with the difference, so that nodes of a horizontal or vertical edge share a coordinate to the bit.
fn on_line(from: Point, to: Point, t: f64) -> Point {
    along(from, t, sub(to, from))
}
