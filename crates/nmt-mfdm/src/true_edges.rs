//! The true edges of a section, which its mesh has a polygon for: the piece of an edge beside each segment, and places on it
//! and in the sliver between.

use crate::error::MfdmError;
use nmt_cloud::{Cloud, Section};
use nmt_curve::{ArcTable, Curve};
use nmt_geom::point::{cross, distance, dot, lerp, sub};
use nmt_geom::{EdgeId, NodeId, Point, Segment, TriId};
use nmt_tri::Mesh;
use std::collections::HashMap;
use std::collections::hash_map::Entry;

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
    /// ds, or q·ds of a flux, on an edge; the area (negative where the curve runs inside the polygon) in a sliver.
    pub weight: f64,
}

/// The samples of a triangle, of those given by triangle; mostly there are none at all.
#[inline]
pub(crate) fn of_triangle(samples: &[Sample], triangle: TriId) -> &[Sample] {
    if samples.is_empty() {
        return samples;
    }
    let first = samples.partition_point(|sample| sample.triangle < triangle);
    let last = samples.partition_point(|sample| sample.triangle <= triangle);
    &samples[first..last]
}

/// Visits the pieces of the edges that are `wanted`, in the order of the segments, with the triangle beside each.
///
/// # Errors
/// [`MfdmError::Curve`] where an edge has no length, and what `visit` has.
pub(crate) fn visit_pieces(
    mesh: &Mesh,
    section: &Section,
    wanted: impl Fn(EdgeId) -> bool,
    mut visit: impl FnMut(&Segment, &Piece, TriId) -> Result<(), MfdmError>,
) -> Result<(), MfdmError> {
    let triangles = boundary_triangles(mesh);
    visit_edges(mesh.cloud(), section, wanted, |segment, piece| match triangles.get(&(segment.from, segment.to)) {
        Some(triangle) => visit(segment, piece, *triangle),
        None => Ok(()),
    })
}

/// Visits the pieces of the edges that are `wanted`, in the order of the segments.
///
/// # Errors
/// As [`visit_pieces`].
pub(crate) fn visit_edges(
    cloud: &Cloud,
    section: &Section,
    wanted: impl Fn(EdgeId) -> bool,
    mut visit: impl FnMut(&Segment, &Piece) -> Result<(), MfdmError>,
) -> Result<(), MfdmError> {
    let curves: Vec<&Curve> = section.loops().flat_map(|outline| outline.edges.iter().map(|e| &e.curve)).collect();
    let mut tables: HashMap<EdgeId, ArcTable> = HashMap::new();
    for segment in cloud.boundary().segments().iter().filter(|segment| wanted(segment.edge)) {
        let Some(&curve) = curves.get(segment.edge.index()) else {
            return Err(MfdmError::Conditions { found: segment.edge.index() + 1, given: curves.len() });
        };
        let table = match tables.entry(segment.edge) {
            Entry::Occupied(known) => known.into_mut(),
            Entry::Vacant(new) => new.insert(ArcTable::new(curve).map_err(|source| MfdmError::Curve { source })?),
        };
        visit(segment, &Piece::new(cloud, segment, curve, table))?;
    }
    Ok(())
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

    /// Outward unit normal at fraction `s` of its length: the material is on the left.
    pub fn normal(&self, s: f64) -> Point {
        let [x, y] = self.direction(s);
        [y, -x]
    }

    /// Places along it: fraction of its length, place, ds.
    pub fn along(&self) -> impl Iterator<Item = (f64, Point, f64)> + '_ {
        ALONG.iter().map(|&[s, weight]| (s, self.point(s), weight * self.length))
    }

    /// Places in the sliver between it and its segment, continued from `triangle`.
    pub fn sliver(&self, triangle: TriId) -> impl Iterator<Item = Sample> + '_ {
        self.beyond_segment().map(move |(at, weight)| Sample { triangle, at, weight })
    }

    /// Places in the sliver with their areas, as of [`Sample::weight`].
    pub fn beyond_segment(&self) -> impl Iterator<Item = (Point, f64)> + '_ {
        let curved: &[[f64; 2]] = if self.is_straight { &[] } else { &ALONG };
        curved.iter().flat_map(move |&[s, weight]| {
            let (at, chord) = (self.point(s), lerp(self.from, self.to, s));
            let (forward, out) = (sub(self.to, self.from), sub(at, chord));
            let along = self.direction(s).map(|c| c * self.length);
            ACROSS.iter().map(move |&[t, share]| {
                let by_s = lerp(forward, along, t);
                (lerp(chord, at, t), weight * share * cross(out, by_s))
            })
        })
    }

    /// Length of the whole edge.
    pub fn edge_length(&self) -> f64 {
        self.table.length()
    }

    /// Unit tangent at fraction `s` of its length, forwards along it even where it turns back.
    pub fn tangent(&self, s: f64) -> Point {
        self.unit_tangent(s, |_| self.s[1] < self.s[0])
    }

    /// Unit vector along it at fraction `s` of its length.
    pub fn direction(&self, s: f64) -> Point {
        self.unit_tangent(s, |tangent| dot(tangent, sub(self.to, self.from)) < 0.0)
    }

    /// The tangent of its curve, or that turned round.
    fn unit_tangent(&self, s: f64, is_turned: impl Fn(Point) -> bool) -> Point {
        let tangent = match self.is_straight {
            true => sub(self.to, self.from),
            false => self.curve.direction_at(self.table.parameter_at(self.at(s))),
        };
        let length = tangent[0].hypot(tangent[1]).max(f64::MIN_POSITIVE);
        let sign = if is_turned(tangent) { -1.0 } else { 1.0 };
        tangent.map(|c| sign * c / length)
    }
}
