//! Common edges of subdomains, as the report tells them: the paper's topological matrix.

use nmt_cloud::{Cloud, Section};
use nmt_geom::Point;
use nmt_merge::{CommonEdge, Side, common_edges};
use serde::Serialize;

/// A common edge: a row of the paper's topological matrix.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CommonEdgeReport {
    /// Names of the two subdomains.
    pub between: [String; 2],
    /// Name of the edge of each.
    pub edges: [String; 2],
    /// Where it begins, following the first one's edge.
    pub from: Point,
    /// Where it ends; where it begins for a whole circle.
    pub to: Point,
    /// Number of nodes of each on it.
    pub nodes: [usize; 2],
    /// True where these are the same places, so that the two meshes can be welded along it.
    pub conforming: bool,
}

/// The common edges of subdomains (name, outlines, cloud); `None` where there is one subdomain alone.
pub(super) fn of_parts<'a>(
    parts: impl Iterator<Item = (&'a str, &'a Section, &'a Cloud)>,
) -> Option<Vec<CommonEdgeReport>> {
    let parts: Vec<_> = parts.collect();
    if parts.len() < 2 {
        return None;
    }
    let sides: Vec<Side> = parts.iter().map(|&(_, section, cloud)| Side { section, cloud }).collect();
    let report = |edge: CommonEdge| CommonEdgeReport {
        between: edge.between.map(|subdomain| parts[subdomain.index()].0.to_owned()),
        conforming: edge.is_conforming(&sides),
        nodes: edge.nodes.each_ref().map(Vec::len),
        edges: edge.names,
        from: edge.from,
        to: edge.to,
    };
    Some(common_edges(&sides).into_iter().map(report).collect())
}
