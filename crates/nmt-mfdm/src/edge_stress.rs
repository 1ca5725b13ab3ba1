//! τ along the true edges of a section, and its circulation around every loop: ∮τ·ds = 2GθA \[D12\].

use crate::error::MfdmError;
use crate::post::Stress;
use crate::problem::HoleCondition;
use crate::solution::TorsionSolution;
use crate::true_edges::{ALONG, Piece};
use nmt_cloud::Section;
use nmt_curve::{ArcTable, Curve};
use nmt_geom::point::{cross, dot, sub};
use nmt_geom::{EdgeId, LoopId, NodeId, Segment};
use nmt_tri::Mesh;
use std::collections::BTreeMap;

/// Points and weights of the Gauss–Legendre rule of two points on [0, 1], exact for a cubic.
const TWO_POINTS: [[f64; 2]; 2] = [[0.211_324_865_405_187_1, 0.5], [0.788_675_134_594_812_9, 0.5]];

/// τ at a node of an edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgePoint {
    /// The node.
    pub node: NodeId,
    /// Arc length along the true edge from its first vertex, user's length unit.
    pub s: f64,
    /// The same as a fraction of the edge, 0 at its first vertex and 1 at its last.
    pub fraction: f64,
    /// τ from the node's own polynomial, as at every node.
    pub stress: Stress,
    /// τ along the edge's tangent, which leads from its first vertex to its last; on a boundary free of stress ±τ.
    pub tangential: f64,
    /// τ along the outward normal: 0 but for the error of the solution.
    pub normal: f64,
}

/// τ along one edge of the outline.
#[derive(Clone, Debug, PartialEq)]
pub struct EdgeStress {
    /// The edge.
    pub edge: EdgeId,
    /// The loop it belongs to: 0 the main contour, then the holes.
    pub ring: LoopId,
    /// Its length, user's length unit.
    pub length: f64,
    /// Its nodes in order, both end vertices included (of a closed edge its one vertex twice), shape (n_edge_nodes,).
    pub points: Vec<EdgePoint>,
    /// True where the edge leads counter-clockwise around its loop.
    pub is_counter_clockwise: bool,
}

impl EdgeStress {
    /// The first of its points with the largest τ; `None` where it has none.
    pub fn largest(&self) -> Option<&EdgePoint> {
        let larger = |best: &'_ EdgePoint, p: &EdgePoint| p.stress.magnitude() > best.stress.magnitude();
        self.points.iter().fold(None, |best, p| if best.is_none_or(|b| larger(b, p)) { Some(p) } else { best })
    }

    /// Mean of τ over its length.
    pub fn mean(&self) -> f64 {
        self.integral(|p| p.stress.magnitude()) / self.length
    }

    /// ∫τ_t ds from its first vertex to its last; stress × length.
    pub fn circulation(&self) -> f64 {
        self.integral(|p| p.tangential)
    }

    /// Integral over the edge of the cubics through each four neighbouring nodes.
    fn integral(&self, of: impl Fn(&EdgePoint) -> f64) -> f64 {
        let points: Vec<[f64; 2]> = self.points.iter().map(|p| [p.s, of(p)]).collect();
        let interval = |i: usize| {
            let first = i.saturating_sub(1).min(points.len().saturating_sub(4));
            let near = &points[first..(first + 4).min(points.len())];
            let (from, length) = (points[i][0], points[i + 1][0] - points[i][0]);
            let sum: f64 = TWO_POINTS.iter().map(|[at, weight]| weight * lagrange(near, from + at * length)).sum();
            length * sum
        };
        (0..points.len().saturating_sub(1)).map(interval).sum()
    }
}

/// The polynomial through `points` (abscissa, value) at `x`.
fn lagrange(points: &[[f64; 2]], x: f64) -> f64 {
    let term = |(k, [at, value]): (usize, &[f64; 2])| {
        let others = points.iter().enumerate().filter(|(other, _)| *other != k);
        value * others.map(|(_, [other, _])| (x - other) / (at - other)).product::<f64>()
    };
    points.iter().enumerate().map(term).sum()
}

/// The circulation of τ around one loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Circulation {
    /// The loop.
    pub ring: LoopId,
    /// ∮τ·ds counter-clockwise, from τ at the nodes; stress × length.
    pub value: f64,
    /// What it is of the exact solution; `None` on a hole with F = 0, where nothing prescribes it.
    ///
    /// By Stokes ∮τ·ds = 2Gθ times the area of the material within, and 2GθA_k more for each hole in there under
    /// circulation: 2GθA of a hole, and of the contour with all that it encloses.
    pub expected: Option<f64>,
    /// Area that the loop's true curves enclose, square of the user's length unit.
    pub area: f64,
}

impl Circulation {
    /// (value − expected)/|expected|: a check of the whole solution, since every τ on the loop enters.
    pub fn difference(&self) -> Option<f64> {
        self.expected.map(|expected| (self.value - expected) / expected.abs())
    }
}

/// τ along every edge of `section`, by edge; `solution` is that of `mesh`, whose cloud was generated from it.
///
/// ```
/// use nmt_cloud::{CloudParams, Section, generate};
/// use nmt_curve::Outline;
/// use nmt_mfdm::{SolveParams, TorsionProblem, circulations, edge_stresses, solve};
/// use nmt_tri::Mesh;
///
/// // On a circle of radius 1 with Gθ = 1, τ = 1 all around, and ∮τ ds = 2π.
/// let circle = Section::solid(Outline::circle([0.0, 0.0], 1.0));
/// let mesh = Mesh::constrained(generate(&circle, &CloudParams { nodes: [21, 21], ..CloudParams::default() })?)?;
/// let solution = solve(&TorsionProblem::default(), &mesh, &SolveParams::default())?;
/// let edges = edge_stresses(&mesh, &circle, &solution)?;
/// assert!((edges[0].mean() - 1.0).abs() < 1e-6);
/// let around = circulations(&mesh, &circle, &solution, &edges)?;
/// assert!((around[0].value - std::f64::consts::TAU).abs() < 1e-5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`MfdmError::EdgesUnknown`] where the cloud was put together from parts, [`MfdmError::Curve`] where an edge has no
/// length.
pub fn edge_stresses(mesh: &Mesh, section: &Section, solution: &TorsionSolution) -> Result<Vec<EdgeStress>, MfdmError> {
    let boundary = mesh.cloud().boundary();
    let edges = MeasuredEdges::new(mesh, section)?;
    let mut all = Vec::with_capacity(edges.curves.len());
    for ring in (0..boundary.n_loops()).map(LoopId::of) {
        let mut by_edge: BTreeMap<EdgeId, Vec<(&Segment, Piece)>> = BTreeMap::new();
        for segment in boundary.loop_segments(ring) {
            by_edge.entry(segment.edge).or_default().push((segment, edges.piece(mesh, segment)?));
        }
        for (edge, pieces) in by_edge {
            let length = edges.tables.get(edge.index()).map_or(0.0, ArcTable::length);
            all.push(edge_stress(solution, edge, ring, length, pieces));
        }
    }
    all.sort_by_key(|stress| stress.edge);
    Ok(all)
}

/// τ at the nodes of one edge, whose segments lead along it or all against it.
fn edge_stress(
    solution: &TorsionSolution,
    edge: EdgeId,
    ring: LoopId,
    length: f64,
    mut pieces: Vec<(&Segment, Piece)>,
) -> EdgeStress {
    let along = pieces.iter().map(|(_, piece)| piece.s[1] - piece.s[0]).sum::<f64>() >= 0.0;
    // The end of each piece that comes first on the edge, the one that comes last, and the way of the tangent.
    let (first, last, way) = if along { (0, 1, 1.0) } else { (1, 0, -1.0) };
    pieces.sort_by(|(_, a), (_, b)| a.s[first].total_cmp(&b.s[first]));
    let point = |(segment, piece): &(&Segment, Piece), end: usize| {
        let node = if end == 0 { segment.from } else { segment.to };
        let forward = piece.direction(end as f64);
        let stress = solution.stress_at_node(node);
        let tau = [stress.zx, stress.zy];
        EdgePoint {
            node,
            s: piece.s[end],
            fraction: (piece.s[end] / length).clamp(0.0, 1.0),
            stress,
            tangential: way * dot(tau, forward),
            // The material is on the left of every segment.
            normal: dot(tau, [forward[1], -forward[0]]),
        }
    };
    let ends = pieces.last().map(|piece| point(piece, last));
    let points = pieces.iter().map(|piece| point(piece, first)).chain(ends).collect();
    EdgeStress { edge, ring, length, points, is_counter_clockwise: along == (ring.index() == 0) }
}

/// The circulation of τ around every loop, from `edges` of [`edge_stresses`].
///
/// # Errors
/// As [`edge_stresses`].
pub fn circulations(
    mesh: &Mesh,
    section: &Section,
    solution: &TorsionSolution,
    edges: &[EdgeStress],
) -> Result<Vec<Circulation>, MfdmError> {
    let measured = MeasuredEdges::new(mesh, section)?;
    let n_loops = mesh.cloud().boundary().n_loops();
    let value = |ring: LoopId| -> f64 {
        let own = edges.iter().filter(|edge| edge.ring == ring);
        own.map(|edge| if edge.is_counter_clockwise { edge.circulation() } else { -edge.circulation() }).sum()
    };
    let rings = (0..n_loops).map(LoopId::of);
    let around = |ring: LoopId| -> Result<Circulation, MfdmError> {
        Ok(Circulation { ring, value: value(ring), expected: None, area: measured.area(mesh, ring)? })
    };
    let mut all = rings.map(around).collect::<Result<Vec<_>, _>>()?;
    let by_area = |area: f64| 2.0 * solution.g_theta * area;
    let mut enclosed = all.first().map_or(0.0, |contour| by_area(contour.area));
    for (hole, result) in all.iter_mut().skip(1).zip(&solution.holes) {
        match result.condition {
            HoleCondition::Circulation => hole.expected = Some(by_area(hole.area)),
            HoleCondition::Zero => enclosed += hole.value - by_area(hole.area),
        }
    }
    if let Some(contour) = all.first_mut() {
        contour.expected = Some(enclosed);
    }
    Ok(all)
}

/// The curves of a section with their lengths.
struct MeasuredEdges<'a> {
    curves: Vec<&'a Curve>,
    tables: Vec<ArcTable>,
}

impl<'a> MeasuredEdges<'a> {
    fn new(mesh: &Mesh, section: &'a Section) -> Result<Self, MfdmError> {
        if mesh.cloud().edge_fractions().is_none() {
            return Err(MfdmError::EdgesUnknown);
        }
        let curves: Vec<&Curve> = section.loops().flat_map(|outline| outline.edges.iter().map(|e| &e.curve)).collect();
        let table = |curve: &&Curve| ArcTable::new(curve).map_err(|source| MfdmError::Curve { source });
        let tables = curves.iter().map(table).collect::<Result<_, _>>()?;
        Ok(Self { curves, tables })
    }

    /// The piece of its edge that a segment stands for.
    fn piece(&self, mesh: &Mesh, segment: &Segment) -> Result<Piece<'_>, MfdmError> {
        match (self.curves.get(segment.edge.index()), self.tables.get(segment.edge.index())) {
            (Some(curve), Some(table)) => Ok(Piece::new(mesh.cloud(), segment, curve, table)),
            _ => {
                let found = mesh.cloud().boundary().segments().iter().map(|s| s.edge.index() + 1).max().unwrap_or(0);
                Err(MfdmError::Conditions { found, given: self.curves.len() })
            }
        }
    }

    /// Area within the true curves of a loop: that of its polygon and of the slivers beyond.
    fn area(&self, mesh: &Mesh, ring: LoopId) -> Result<f64, MfdmError> {
        let boundary = mesh.cloud().boundary();
        let mut slivers = 0.0;
        for segment in boundary.loop_segments(ring) {
            let piece = self.piece(mesh, segment)?;
            if !piece.is_straight {
                let [from, _] = boundary.ends(segment);
                let swept = |s: f64| cross(sub(piece.point(s), from), piece.direction(s));
                slivers += 0.5 * piece.length * ALONG.iter().map(|[s, weight]| weight * swept(*s)).sum::<f64>();
            }
        }
        let polygon = boundary.loop_area(ring);
        // Segments lead clockwise around holes.
        Ok(if ring.index() == 0 { polygon + slivers } else { polygon - slivers })
    }
}
