//! The parts along which the outlines of two subdomains coincide, without a look at nodes.

use crate::overlap::common_part;
use crate::track::Track;
use nmt_cloud::Section;
use nmt_curve::Curve;
use nmt_geom::point::{distance, distance_squared, dot, sub};
use nmt_geom::tol::SAME_POINT_REL;
use nmt_geom::{Bbox, EdgeId, Point, SegmentIndex};

/// Points at which two curves are compared, besides the ends and middles of the pieces they are looked at in.
const PROBES: u32 = 32;

/// A vertex may miss its curve by this many tolerances: rounding of a formula with a vertical tangent there moves its end
/// by 1e-8 of the size.
pub(crate) const VERTEX_SLACK: f64 = 100.0;

/// A part of an edge of one subdomain that runs along one of another.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Part {
    /// The two subdomains, the smaller number first.
    pub subdomains: [usize; 2],
    /// The edge of each.
    pub edges: [EdgeId; 2],
    /// Where it begins, following the first edge: a vertex of one side, of the first where both have one there.
    pub from: Point,
    /// Where it ends.
    pub to: Point,
    /// Fractions of each curve's parameter at `from` and `to`; of the second falling where it leads the other way.
    pub u: [[f64; 2]; 2],
}

/// What two points may differ by and still be one: 1e-9 of the size of the whole problem.
pub(crate) fn same_point(sections: &[&Section]) -> f64 {
    let envelope = sections.iter().fold(Bbox::EMPTY, |all, section| all.union(section.contour.envelope()));
    SAME_POINT_REL * envelope.size()
}

/// Every part that two subdomains have in common, ordered by the numbers of the subdomains, then of the edges, then along
/// the first edge.
pub(crate) fn common_parts(sections: &[&Section], tolerance: f64) -> Vec<Part> {
    let edges: Vec<Edge> = sections.iter().enumerate().flat_map(|(k, section)| edges_of(k, section)).collect();
    // Every piece of every edge as the diagonal of its box.
    let (mut boxes, mut owners) = (Vec::new(), Vec::new());
    for (k, edge) in edges.iter().enumerate() {
        match &edge.track {
            Some(track) => boxes.extend(track.boxes()),
            None => boxes.push(edge.ends),
        }
        owners.resize(boxes.len(), k);
    }
    let are_apart = |p: usize, q: usize| edges[owners[p]].subdomain != edges[owners[q]].subdomain;
    let near = SegmentIndex::new(boxes).close_pairs_of(tolerance, are_apart);
    let mut pairs: Vec<[usize; 2]> = near.into_iter().map(|pair| pair.map(|piece| owners[piece])).collect();
    pairs.sort_unstable();
    pairs.dedup();
    let parts_of = |&[i, j]: &[usize; 2]| {
        let (a, b) = (&edges[i], &edges[j]);
        let part = |Stretch { from, to, u }: Stretch| Part {
            subdomains: [a.subdomain, b.subdomain],
            edges: [a.edge, b.edge],
            from,
            to,
            u,
        };
        stretches(a, b, tolerance).into_iter().map(part)
    };
    let mut parts: Vec<Part> = pairs.iter().flat_map(parts_of).collect();
    parts.sort_by_key(|part| (part.subdomains, part.edges));
    parts
}

/// An edge of an outline and whose it is.
struct Edge<'s> {
    subdomain: usize,
    edge: EdgeId,
    curve: &'s Curve,
    ends: [Point; 2],
    /// `None` for a line, of which there may be very many.
    track: Option<Track<'s>>,
}

fn edges_of(subdomain: usize, section: &Section) -> Vec<Edge<'_>> {
    let mut edges = Vec::new();
    for outline in section.loops() {
        let next = outline.vertices.iter().cycle().skip(1);
        for ((from, to), edge) in outline.vertices.iter().zip(next).zip(&outline.edges) {
            let track = (!edge.curve.is_straight()).then(|| Track::new(&edge.curve));
            let number = EdgeId::of(edges.len());
            edges.push(Edge { subdomain, edge: number, curve: &edge.curve, ends: [*from, *to], track });
        }
    }
    edges
}

/// A part of the first of two edges that runs along the second.
struct Stretch {
    from: Point,
    to: Point,
    u: [[f64; 2]; 2],
}

fn stretches(a: &Edge, b: &Edge, tolerance: f64) -> Vec<Stretch> {
    if let (Curve::Line { from: a0, to: a1 }, Curve::Line { from: b0, to: b1 }) = (a.curve, b.curve) {
        let fraction = |p: Point, from: Point, to: Point| dot(sub(p, from), sub(to, from)) / distance_squared(from, to);
        let part = common_part([*a0, *a1], [*b0, *b1], tolerance);
        let stretch = part.map(|part| Stretch {
            from: part.from,
            to: part.to,
            u: [[*a0, *a1], [*b0, *b1]]
                .map(|[p, q]| [part.from, part.to].map(|end| fraction(end, p, q).clamp(0.0, 1.0))),
        });
        return stretch.into_iter().collect();
    }
    let lines = [a, b].map(|edge| edge.track.is_none().then(|| Track::new(edge.curve)));
    let [Some(a_track), Some(b_track)] =
        [(a, &lines[0]), (b, &lines[1])].map(|(edge, line)| edge.track.as_ref().or(line.as_ref()))
    else {
        return Vec::new();
    };
    let breaks = breaks(a, b, a_track, tolerance);
    breaks.windows(2).filter_map(|ends| coinciding(ends[0], ends[1], a_track, b_track, b, tolerance)).collect()
}

/// A place along the first edge where a common part may end.
#[derive(Clone, Copy)]
struct Break {
    u: f64,
    at: Point,
}

/// The vertices of both edges along the first, its own ends included.
fn breaks(a: &Edge, b: &Edge, a_track: &Track, tolerance: f64) -> Vec<Break> {
    let mut breaks = vec![Break { u: 0.0, at: a.ends[0] }, Break { u: 1.0, at: a.ends[1] }];
    for &at in &b.ends {
        if breaks.iter().all(|known| distance(known.at, at) > tolerance)
            && let Some(foot) = a_track.foot(at, VERTEX_SLACK * tolerance)
        {
            breaks.push(Break { u: foot.u, at });
        }
    }
    breaks.sort_by(|p, q| p.u.total_cmp(&q.u));
    breaks
}

/// The stretch of the first curve between two breaks, where all of it lies on the second.
fn coinciding(from: Break, to: Break, a: &Track, b: &Track, b_edge: &Edge, tolerance: f64) -> Option<Stretch> {
    let inner = (1..PROBES).map(|k| from.u + (to.u - from.u) * f64::from(k) / f64::from(PROBES));
    let mut farthest = 0.0_f64;
    for u in inner.chain(a.probes(from.u, to.u)) {
        let p = a.curve().point(u);
        b.foot(p, tolerance)?;
        farthest = farthest.max(distance(p, from.at));
    }
    if farthest <= tolerance {
        return None;
    }
    // Which way the second curve leads, from two points that are no ends of it.
    let third = |k: f64| Some(b.foot(a.curve().point(from.u + (to.u - from.u) * k / 3.0), tolerance)?.u);
    let forward = third(1.0)? < third(2.0)?;
    let on_b = |end: Break, is_first: bool| {
        let at_end = b_edge.ends.map(|vertex| distance(vertex, end.at) <= tolerance);
        match at_end {
            // The seam of a closed edge is its beginning and its end.
            [true, true] => Some(if is_first == forward { 0.0 } else { 1.0 }),
            [true, false] => Some(0.0),
            [false, true] => Some(1.0),
            [false, false] => b.foot(end.at, VERTEX_SLACK * tolerance).map(|foot| foot.u),
        }
    };
    let second = [on_b(from, true)?, on_b(to, false)?];
    Some(Stretch { from: from.at, to: to.at, u: [[from.u, to.u], second] })
}
