//! Nodes for both sides of common edges, made before the clouds, so that their meshes can be welded.

use crate::coincide::{Part, common_parts, same_point};
use crate::error::MergeError;
use nmt_cloud::{CloudError, CloudParams, GivenNode, Section, Spacing, segment_counts};
use nmt_curve::{ArcTable, Curve, SpacingTable};
use nmt_geom::point::{along, sub};
use nmt_geom::{EdgeId, Point, SubdomainId};

/// A count of segments is met to this, so that rounding adds none; as in (2) \[D4\].
const COUNT_SLACK: f64 = 1.0e-6;

/// One subdomain before its cloud is generated, borrowed.
#[derive(Clone, Copy, Debug)]
pub struct Planned<'a> {
    /// Its outlines.
    pub section: &'a Section,
    /// Density of its cloud.
    pub params: &'a CloudParams,
    /// True where its nodes on common edges shall be those of its neighbours.
    pub conforming: bool,
}

/// Nodes of the edges of each subdomain, for [`CloudParams::edge_nodes`], such that both sides of every common edge of a
/// conforming subdomain have the same nodes.
///
/// The ends of a common edge are vertices, of one side or both. Between them both sides have as many segments as the side
/// asks for whose own count there is the larger, of equal arc length along the first side's edge, at the same coordinates
/// to the bit; these nodes do not slide. What is left of an edge beside its common parts is divided by its own count,
/// evenly, and slides as usual. An edge without a common part is left to its own division (`None`).
///
/// Where a side is graded, the segments between are equal parts of ∫ds/h instead, h being the smaller spacing of the two
/// sides at each place; and what is left of a graded edge is divided by its own spacing.
///
/// # Errors
/// [`MergeError::Edge`] for a common edge without a length, [`MergeError::Spacing`] for a subdomain whose spacing is none.
///
/// ```
/// use nmt_cloud::{CloudParams, Section, generate};
/// use nmt_curve::Outline;
/// use nmt_merge::{Planned, Side, common_edges, conform};
///
/// let sections = [[0.0, 0.0], [2.0, 0.7]].map(|p| Section::solid(Outline::rectangle(p, [p[0] + 2.0, p[1] + 2.0])));
/// let mut params = [5, 9].map(|n| CloudParams { nodes: [n, n], irregularity: 0.2, ..CloudParams::default() });
/// let planned = [0, 1].map(|k| Planned { section: &sections[k], params: &params[k], conforming: k == 0 });
/// let edge_nodes = conform(&planned)?;
/// params.iter_mut().zip(edge_nodes).for_each(|(params, edge_nodes)| params.edge_nodes = edge_nodes);
/// let clouds = [generate(&sections[0], &params[0])?, generate(&sections[1], &params[1])?];
/// let sides = [0, 1].map(|k| Side { section: &sections[k], cloud: &clouds[k] });
/// let common = common_edges(&sides);
/// assert_eq!([common[0].from, common[0].to], [[2.0, 0.7], [2.0, 2.0]]);
/// assert!(common[0].is_conforming(&sides) && common[0].nodes[0].len() == 7);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn conform(planned: &[Planned]) -> Result<Vec<EdgeNodes>, MergeError> {
    let sections: Vec<&Section> = planned.iter().map(|p| p.section).collect();
    let tolerance = same_point(&sections);
    let mut edges: Vec<Vec<Divided>> = Vec::with_capacity(planned.len());
    let spacing = |(k, p): (usize, &Planned)| match p.params.grading {
        None => Ok(None),
        Some(_) => Spacing::new(p.section, p.params)
            .map(Some)
            .map_err(|source| MergeError::Spacing { subdomain: SubdomainId::of(k), source }),
    };
    let spacings = planned.iter().enumerate().map(spacing).collect::<Result<Vec<_>, MergeError>>()?;
    for Planned { section, params, .. } in planned {
        let counts = segment_counts(section, params);
        edges.push(counts.into_iter().map(|n_segments| Divided { n_segments, shared: Vec::new() }).collect());
    }
    for part in common_parts(&sections, tolerance) {
        if part.subdomains.iter().any(|&k| planned[k].conforming) {
            share(&part, &sections, &spacings, &mut edges)?;
        }
    }
    let nodes_of = |(k, divided): (usize, Vec<Divided>)| -> Result<EdgeNodes, MergeError> {
        let edges = divided.into_iter().enumerate().map(|(e, divided)| {
            if divided.shared.is_empty() {
                return Ok(None);
            }
            let path = Path::new(sections[k], k, EdgeId::of(e))?;
            Ok(Some(divided.nodes(tolerance / path.length, &path, spacings[k].as_ref())?))
        });
        edges.collect()
    };
    edges.into_iter().enumerate().map(nodes_of).collect()
}

/// Nodes that the edges of one subdomain are given, by [`EdgeId`].
pub type EdgeNodes = Vec<Option<Vec<GivenNode>>>;

/// An edge on the way to its nodes.
struct Divided {
    /// By its own count.
    n_segments: usize,
    shared: Vec<Shared>,
}

/// A stretch of an edge with its nodes, ends included, in order along it.
struct Shared {
    nodes: Vec<(f64, Point)>,
}

impl Divided {
    /// The nodes between the ends of the edge; nearer than `same` (a fraction of it) two are one.
    fn nodes(mut self, same: f64, path: &Path, spacing: Option<&Spacing>) -> Result<Vec<GivenNode>, MergeError> {
        self.shared.retain(|shared| !shared.nodes.is_empty());
        self.shared.sort_by(|a, b| a.nodes[0].0.total_cmp(&b.nodes[0].0));
        let mut given: Vec<GivenNode> = Vec::new();
        let mut before = 0.0;
        let own = |given: &mut Vec<GivenNode>, from: f64, to: f64| -> Result<(), MergeError> {
            let parts = match spacing {
                None => equal_parts(segments(self.n_segments, to - from)),
                Some(spacing) => {
                    let place = |t: f64| path.table.point_at((from + (to - from) * t) * path.length);
                    path.parts_by(&[spacing], (to - from) * path.length, place, f64::INFINITY)?
                }
            };
            let inner = parts[1..parts.len() - 1].iter();
            given.extend(inner.map(|t| GivenNode { fraction: from + (to - from) * t, at: None }));
            Ok(())
        };
        for Shared { nodes } in &self.shared {
            let start = nodes[0].0;
            if start - before > same {
                own(&mut given, before, start)?;
            }
            for &(fraction, at) in nodes {
                let last = given.last().map_or(0.0, |node| node.fraction);
                if fraction - last > same && 1.0 - fraction > same {
                    given.push(GivenNode { fraction, at: Some(at) });
                }
                before = fraction.max(before);
            }
        }
        if 1.0 - before > same {
            own(&mut given, before, 1.0)?;
        }
        Ok(given)
    }
}

/// Segments of a fraction of an edge that has so many.
fn segments(n_segments: usize, fraction: f64) -> usize {
    (n_segments as f64 * fraction - COUNT_SLACK).ceil().max(1.0) as usize
}

/// The ends of `n` equal parts, from 0 to 1.
fn equal_parts(n: usize) -> Vec<f64> {
    (0..=n).map(|k| k as f64 / n as f64).collect()
}

/// Gives both sides of a common part its nodes.
fn share(
    part: &Part,
    sections: &[&Section],
    spacings: &[Option<Spacing>],
    edges: &mut [Vec<Divided>],
) -> Result<(), MergeError> {
    let [a, b] = part.subdomains;
    let paths = [Path::new(sections[a], a, part.edges[0])?, Path::new(sections[b], b, part.edges[1])?];
    let ends = [0, 1].map(|side| part.u[side].map(|u| paths[side].fraction_to(u)));
    let own = |side: usize| {
        let [from, to] = ends[side];
        segments(edges[part.subdomains[side]][part.edges[side].index()].n_segments, (to - from).abs())
    };
    let graded: Vec<&Spacing> = part.subdomains.iter().filter_map(|&k| spacings[k].as_ref()).collect();
    let uniform = (0..2).filter(|&side| spacings[part.subdomains[side]].is_none()).map(own).max();
    let fractions = if graded.is_empty() {
        equal_parts(own(0).max(own(1)))
    } else {
        // A side that is not graded wants its own count, evenly.
        let length = (ends[0][1] - ends[0][0]).abs() * paths[0].length;
        let most = uniform.map_or(f64::INFINITY, |n| length / n as f64);
        paths[0].parts_by(&graded, length, |t| paths[0].between(part, ends[0], t), most)?
    };
    let n = fractions.len() - 1;
    let at = |k: usize| match k {
        0 => part.from,
        k if k == n => part.to,
        k => paths[0].between(part, ends[0], fractions[k]),
    };
    let places: Vec<Point> = (0..=n).map(at).collect();
    for side in 0..2 {
        let [from, to] = ends[side];
        let fraction = |k: usize| if k == n { to } else { from + (to - from) * fractions[k] };
        let mut nodes: Vec<(f64, Point)> = places.iter().enumerate().map(|(k, &p)| (fraction(k), p)).collect();
        if to < from {
            nodes.reverse();
        }
        edges[part.subdomains[side]][part.edges[side].index()].shared.push(Shared { nodes });
    }
    Ok(())
}

/// Why a stretch cannot be divided by a spacing.
enum Fault {
    Spacing(CloudError),
    Curve(nmt_curve::CurveError),
}

impl From<nmt_curve::CurveError> for Fault {
    fn from(source: nmt_curve::CurveError) -> Self {
        Self::Curve(source)
    }
}

/// An edge by its own length.
struct Path<'s> {
    subdomain: SubdomainId,
    curve: &'s Curve,
    table: ArcTable,
    length: f64,
    edge: EdgeId,
}

impl<'s> Path<'s> {
    fn new(section: &'s Section, subdomain: usize, edge: EdgeId) -> Result<Self, MergeError> {
        let subdomain = SubdomainId::of(subdomain);
        let found = section.loops().flat_map(|outline| &outline.edges).nth(edge.index());
        let missing = || nmt_curve::CurveError::NoLength { point: section.contour.envelope().min };
        let curve = &found.ok_or_else(|| MergeError::Edge { subdomain, edge, source: missing() })?.curve;
        let table = ArcTable::new(curve).map_err(|source| MergeError::Edge { subdomain, edge, source })?;
        let length = table.length();
        Ok(Self { subdomain, curve, table, length, edge })
    }

    /// Equal parts of ∫ds/h on a stretch of `length`, as fractions of it: h is the least of `spacings` at `place(fraction)`, and
    /// at most `most`.
    fn parts_by(
        &self,
        spacings: &[&Spacing],
        length: f64,
        place: impl Fn(f64) -> Point,
        most: f64,
    ) -> Result<Vec<f64>, MergeError> {
        let subdomain = self.subdomain;
        let h = |s: f64| -> Result<f64, CloudError> {
            let p = place(s / length);
            spacings.iter().try_fold(most, |least, spacing| Ok(least.min(spacing.at(p)?)))
        };
        let table = SpacingTable::new(length, |s| h(s).map_err(Fault::Spacing));
        let table = table.map_err(|fault| match fault {
            Fault::Spacing(source) => MergeError::Spacing { subdomain, source },
            Fault::Curve(source) => MergeError::Edge { subdomain, edge: self.edge, source },
        })?;
        let asked = table.spacings();
        Ok(table.equal_parts((asked - COUNT_SLACK * asked.max(1.0)).ceil().max(1.0) as usize))
    }

    /// Fraction of the length at a fraction of the parameter.
    fn fraction_to(&self, u: f64) -> f64 {
        (self.table.length_to(u) / self.length).clamp(0.0, 1.0)
    }

    /// The point at fraction `t` of the way along a part that has the `ends` as fractions of the length.
    fn between(&self, part: &Part, ends: [f64; 2], t: f64) -> Point {
        if self.curve.is_straight() {
            // Written with the difference, so that nodes of a horizontal or vertical edge share a coordinate to the bit.
            return along(part.from, t, sub(part.to, part.from));
        }
        self.table.point_at((ends[0] + (ends[1] - ends[0]) * t) * self.length)
    }
}
