//! Fluxes on the boundary: ∂u/∂n = q on the true edge, which the mesh has a polygon for.

use crate::error::MfdmError;
use crate::slopes::{KnownSlopes, Slopes};
use nmt_cloud::{Cloud, Section};
use nmt_curve::{ArcTable, Curve};
use nmt_geom::point::{cross, distance, dot, lerp, sub};
use nmt_geom::{EdgeId, NodeId, Point, Segment, TriId};
use nmt_tri::Mesh;
use std::collections::HashMap;
use std::collections::hash_map::Entry;

/// ∂u/∂n = q on an edge.
pub(crate) type Flux<'a> = &'a (dyn Fn(Point) -> f64 + Sync);

/// Points and weights of Gauss–Legendre rules on [0, 1]: four along an edge, exact to degree 7; two across a sliver.
pub(crate) const ALONG: [[f64; 2]; 4] = [
    [0.069_431_844_202_973_71, 0.173_927_422_568_726_93],
    [0.330_009_478_207_571_87, 0.326_072_577_431_273_07],
    [0.669_990_521_792_428_1, 0.326_072_577_431_273_07],
    [0.930_568_155_797_026_3, 0.173_927_422_568_726_93],
];
const ACROSS: [[f64; 2]; 2] = [[0.211_324_865_405_187_1, 0.5], [0.788_675_134_594_812_9, 0.5]];

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

/// The conditions at one node: n·∇u = q on each of the edges that meet there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NodeFlux {
    /// The node.
    pub node: NodeId,
    sides: (Side, Option<Side>),
}

/// n·∇u = q on one side of a node.
#[derive(Clone, Copy, Debug)]
struct Side {
    normal: Point, // outward unit normal
    q: f64,
}

/// Sides whose normals differ by less than this sine, or point away from each other as nearly, are one boundary: the
/// gradient from both would be that of small differences.
const CORNER_SINE: f64 = 0.5;

impl NodeFlux {
    /// What the conditions say of the gradient in coordinates stretched by `stretch`: at a corner all of it, otherwise
    /// its component along the normal.
    pub fn known(&self, stretch: [f64; 2]) -> KnownSlopes {
        let (a, b) = self.sides;
        let sine = b.map_or(0.0, |b| cross(a.normal, b.normal));
        if let Some(b) = b.filter(|_| sine.abs() > CORNER_SINE) {
            let (p, q) = (a.normal.map(|c| c * b.q / sine), b.normal.map(|c| c * a.q / sine));
            let gradient = [q[1] - p[1], p[0] - q[0]];
            return KnownSlopes { slopes: Slopes::Known, gradient: [0, 1].map(|d| gradient[d] / stretch[d]) };
        }
        // One normal for both: at a cusp the second is turned about, since they point away from each other.
        let Side { normal, q } = b.map_or(a, |b| {
            let sign = if dot(a.normal, b.normal) < 0.0 { -1.0 } else { 1.0 };
            Side { normal: [0, 1].map(|d| a.normal[d] + sign * b.normal[d]), q: a.q + sign * b.q }
        });
        // ∂/∂x = stretch_x·∂/∂X, so that n·∇u is a slope across in stretched coordinates too.
        let across = [0, 1].map(|d| stretch[d] * normal[d]);
        let square = dot(across, across);
        let along = [-across[1], across[0]].map(|c| c / square.sqrt());
        KnownSlopes { slopes: Slopes::Along(along), gradient: across.map(|c| c * q / square) }
    }
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
    /// Integrals over the edges that have a flux (`by_edge`, one an edge of the section), and the conditions at the nodes
    /// `free`, ascending, all of whose edges have one.
    ///
    /// # Errors
    /// [`MfdmError::Datum`] where a flux is not finite, [`MfdmError::Curve`] where an edge has no length.
    pub fn new(mesh: &Mesh, section: &Section, by_edge: &[Option<Flux>], free: &[NodeId]) -> Result<Self, MfdmError> {
        let cloud = mesh.cloud();
        let curves: Vec<&Curve> = section.loops().flat_map(|outline| outline.edges.iter().map(|e| &e.curve)).collect();
        let mut tables: HashMap<EdgeId, ArcTable> = HashMap::new();
        let triangles = boundary_triangles(mesh);
        let mut fluxes = Self::default();
        let mut at_nodes: HashMap<NodeId, NodeFlux> = HashMap::new();
        for segment in cloud.boundary().segments() {
            let Some(&flux) = by_edge.get(segment.edge.index()).and_then(Option::as_ref) else { continue };
            let curve = curves[segment.edge.index()];
            let table = match tables.entry(segment.edge) {
                Entry::Occupied(known) => known.into_mut(),
                Entry::Vacant(new) => new.insert(ArcTable::new(curve).map_err(|source| MfdmError::Curve { source })?),
            };
            let Some(&triangle) = triangles.get(&(segment.from, segment.to)) else { continue };
            let piece = Piece::new(cloud, segment, curve, table);
            fluxes.sample(&piece, triangle, flux)?;
            for (node, s) in [(segment.from, 0.0), (segment.to, 1.0)] {
                if free.binary_search(&node).is_ok() {
                    let (at, tangent) = (cloud.xy()[node.index()], piece.direction(s));
                    // The material is on the left.
                    let side = Side { normal: [tangent[1], -tangent[0]], q: finite(flux, at)? };
                    match at_nodes.entry(node) {
                        Entry::Vacant(new) => drop(new.insert(NodeFlux { node, sides: (side, None) })),
                        Entry::Occupied(mut known) => known.get_mut().sides.1 = Some(side),
                    }
                }
            }
        }
        fluxes.edges.sort_by_key(|sample| sample.triangle);
        fluxes.slivers.sort_by_key(|sample| sample.triangle);
        fluxes.nodes = free.iter().filter_map(|node| at_nodes.get(node).copied()).collect();
        Ok(fluxes)
    }

    /// Adds the integrals over one segment's piece of its edge.
    fn sample(&mut self, piece: &Piece, triangle: TriId, flux: Flux) -> Result<(), MfdmError> {
        for [s, weight] in ALONG {
            let at = piece.point(s);
            self.edges.push(Sample { triangle, at, weight: weight * piece.length * finite(flux, at)? });
            if piece.is_straight {
                continue;
            }
            let chord = lerp(piece.from, piece.to, s);
            let (forward, out) = (sub(piece.to, piece.from), sub(at, chord));
            let along = piece.direction(s).map(|c| c * piece.length);
            for [t, share] in ACROSS {
                let by_s = lerp(forward, along, t);
                self.slivers.push(Sample {
                    triangle,
                    at: lerp(chord, at, t),
                    weight: weight * share * cross(out, by_s),
                });
            }
        }
        Ok(())
    }

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

/// The value of a flux.
fn finite(flux: Flux, at: Point) -> Result<f64, MfdmError> {
    let value = flux(at);
    if value.is_finite() { Ok(value) } else { Err(MfdmError::Datum { quantity: "flux", at, value }) }
}

/// The triangle at each segment of the boundary, by its nodes counter-clockwise.
fn boundary_triangles(mesh: &Mesh) -> HashMap<(NodeId, NodeId), TriId> {
    let n_boundary = mesh.cloud().n_boundary();
    let sides = |(t, [a, b, c]): (usize, &[NodeId; 3])| [(*a, *b), (*b, *c), (*c, *a)].map(|side| (side, TriId::of(t)));
    let all = mesh.tri_nodes().iter().enumerate().flat_map(sides);
    all.filter(|((a, b), _)| a.index() < n_boundary && b.index() < n_boundary).collect()
}

/// The piece of an edge that a segment stands for, from the segment's first node to its last.
pub(crate) struct Piece<'a> {
    from: Point,
    to: Point,
    table: &'a ArcTable,
    curve: &'a Curve,
    pub is_straight: bool,
    pub s: [f64; 2], // arc lengths of its ends along the edge
    pub length: f64,
}

impl<'a> Piece<'a> {
    pub fn new(cloud: &Cloud, segment: &Segment, curve: &'a Curve, table: &'a ArcTable) -> Self {
        let [from, to] = cloud.boundary().ends(segment);
        let fraction = |node: NodeId| cloud.edge_fractions().map(|all| all[node.index()]);
        let is_vertex = |node: NodeId| node.index() < cloud.n_vertices();
        // A vertex is at the edge's beginning or at its end: where it lies, or on a closed edge, on the nearer side.
        let end = |node: NodeId, other: NodeId, at: Point| {
            if !is_vertex(node) {
                return fraction(node).unwrap_or(0.0);
            }
            let (start, finish) = (curve.point(0.0), curve.point(1.0));
            let closed = distance(start, finish) <= 0.5 * distance(from, to);
            let at_start = if closed {
                fraction(other).is_some_and(|f| f < 0.5)
            } else {
                distance(at, start) <= distance(at, finish)
            };
            if at_start { 0.0 } else { 1.0 }
        };
        let fractions = [end(segment.from, segment.to, from), end(segment.to, segment.from, to)];
        let is_straight = curve.is_straight() || cloud.edge_fractions().is_none();
        let s = fractions.map(|f| f * table.length());
        let length = if is_straight { distance(from, to) } else { (s[1] - s[0]).abs() };
        Self { from, to, table, curve, is_straight, s, length }
    }

    /// The place at fraction `s` of its length.
    pub fn point(&self, s: f64) -> Point {
        if self.is_straight { lerp(self.from, self.to, s) } else { self.table.point_at(self.at(s)) }
    }

    fn at(&self, s: f64) -> f64 {
        self.s[0] + s * (self.s[1] - self.s[0])
    }

    /// Unit vector along it at fraction `s` of its length.
    pub fn direction(&self, s: f64) -> Point {
        let chord = sub(self.to, self.from);
        let tangent =
            if self.is_straight { chord } else { self.curve.direction_at(self.table.parameter_at(self.at(s))) };
        let length = tangent[0].hypot(tangent[1]).max(f64::MIN_POSITIVE);
        let sign = if dot(tangent, chord) < 0.0 { -1.0 } else { 1.0 };
        tangent.map(|c| sign * c / length)
    }
}
