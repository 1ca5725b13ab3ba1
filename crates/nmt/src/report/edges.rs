//! What the report says of τ along the edges.

use crate::edges::{EdgeTable, loop_name};
use crate::pipeline::SolvedPart;
use crate::report::text::{number, place};
use nmt_geom::Point;
use nmt_mfdm::{Circulation, EdgeStress};
use serde::Serialize;

/// τ along one edge.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EdgeReport {
    /// Name.
    pub name: String,
    /// `contour`, or the name of the hole it bounds.
    #[serde(rename = "loop")]
    pub ring: String,
    /// Length of the true edge.
    pub length: f64,
    /// Largest τ at its nodes.
    pub tau_max: f64,
    /// Where.
    pub tau_max_at: Point,
    /// Mean of τ over its length.
    pub tau_mean: f64,
    /// Largest magnitude of τ's component along the normal: 0 but for the error of the solution.
    pub tau_n_max: f64,
    /// Its vertices where the exact τ is infinite.
    pub tau_singular_at: Vec<Point>,
}

/// ∮τ·ds of one loop.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LoopReport {
    /// `contour`, or the name of the hole.
    pub name: String,
    /// ∮τ·ds counter-clockwise, from τ at the nodes.
    pub circulation: f64,
    /// Its exact value; `null` on a hole with F = 0, where nothing prescribes it.
    pub expected: Option<f64>,
    /// (circulation − expected)/|expected|.
    pub difference: Option<f64>,
    /// Area that the loop's true curves enclose.
    pub area: f64,
    /// Its vertices where the exact τ is infinite: an integral through nodes misses part of such a peak.
    pub singular: usize,
}

/// τ along the edges of a subdomain and around its loops.
pub(super) struct AlongEdges {
    pub edges: Vec<EdgeReport>,
    pub loops: Vec<LoopReport>,
}

impl AlongEdges {
    pub(super) fn of(solved: &SolvedPart) -> Self {
        let table = EdgeTable::of(solved);
        let xy = solved.part.mesh.xy();
        let edge = |edge: &EdgeStress| {
            let largest = edge.largest()?;
            let ends = [edge.points.first()?, edge.points.last()?];
            let mut singular: Vec<_> =
                ends.map(|p| p.node).into_iter().filter(|node| table.is_singular(*node)).collect();
            singular.dedup();
            Some(EdgeReport {
                name: solved.part.edge_names.get(edge.edge.index()).cloned().unwrap_or_default(),
                ring: loop_name(solved, edge.ring).into(),
                length: edge.length,
                tau_max: largest.stress.magnitude(),
                tau_max_at: xy[largest.node.index()],
                tau_mean: edge.mean(),
                tau_n_max: edge.points.iter().map(|p| p.normal.abs()).fold(0.0, f64::max),
                tau_singular_at: singular.iter().map(|node| xy[node.index()]).collect(),
            })
        };
        let around = |circulation: &Circulation| LoopReport {
            name: loop_name(solved, circulation.ring).into(),
            circulation: circulation.value,
            expected: circulation.expected,
            difference: circulation.difference(),
            area: circulation.area,
            singular: {
                let own = table.edges.iter().filter(|edge| edge.ring == circulation.ring);
                own.filter_map(|edge| edge.points.first()).filter(|p| table.is_singular(p.node)).count()
            },
        };
        Self { edges: table.edges.iter().filter_map(edge).collect(), loops: table.loops.iter().map(around).collect() }
    }
}

/// The table of edges: heads, then a row an edge; the column of singular vertices only where there are some.
pub(super) fn rows(edges: &[EdgeReport], unit: &str) -> Vec<Vec<String>> {
    let heads = ["edge", "length", "largest τ", "at", "mean τ", "infinite at"].map(str::to_owned).to_vec();
    let row = |edge: &EdgeReport| {
        let singular: Vec<String> = edge.tau_singular_at.iter().map(|p| place(*p)).collect();
        vec![
            edge.name.clone(),
            format!("{}{unit}", number(edge.length)),
            number(edge.tau_max),
            place(edge.tau_max_at),
            number(edge.tau_mean),
            singular.join(", "),
        ]
    };
    let mut rows: Vec<Vec<String>> = std::iter::once(heads).chain(edges.iter().map(row)).collect();
    if edges.iter().all(|edge| edge.tau_singular_at.is_empty()) {
        rows.iter_mut().for_each(|row| row.truncate(5));
    }
    rows
}

/// What is said of one loop's circulation.
pub(super) fn circulation(around: &LoopReport) -> String {
    let value = number(around.circulation);
    match (around.expected, around.difference) {
        (Some(expected), Some(difference)) => {
            let peaks = if around.singular > 0 { " (misses peaks at re-entrant vertices)" } else { "" };
            format!("{value}; exact {}, difference {difference:.1e}{peaks}", number(expected))
        }
        _ => format!("{value}; not prescribed where F = 0"),
    }
}
