//! Common edges against the reference's: which edges, from where to where, and the nodes of both sides in order.

use super::Entry;
use super::clouds::{from_one, table_entries};
use super::fixture::Table;
use anyhow::Result;
use nmt_cloud::{Cloud, Section};
use nmt_merge::{CommonEdge, Side, common_edges};
use std::path::Path;

const COMMON_EDGES: &[&str] =
    &["subdomain1", "subdomain2", "edge1", "edge2", "from_x", "from_y", "to_x", "to_y", "n1", "n2"];
const COMMON_NODES: &[&str] = &["common_edge", "side", "place", "node"];

/// Expected and found entries of the common edges; none of one subdomain, which has no files of them.
pub fn entries(clouds: &[(Section, Cloud)], sizes: &[f64], expected: &Path) -> Result<(Vec<Entry>, Vec<Entry>)> {
    if clouds.len() < 2 {
        return Ok((Vec::new(), Vec::new()));
    }
    let (mut of_reference, mut of_nmt) = (Vec::new(), Vec::new());
    let sides: Vec<Side> = clouds.iter().map(|(section, cloud)| Side { section, cloud }).collect();
    let common = common_edges(&sides);
    let nodes = common.iter().enumerate().flat_map(|(k, edge)| node_rows(k, edge)).collect();
    for (name, columns, rows) in [
        ("common_edges", COMMON_EDGES, common.iter().map(edge_row).collect::<Vec<_>>()),
        ("common_nodes", COMMON_NODES, nodes),
    ] {
        let table = Table::read(&expected.join(format!("{name}.csv")), columns)?;
        of_reference.extend(table_entries(name, table.columns(), &table.rows, sizes));
        of_nmt.extend(table_entries(name, table.columns(), &rows, sizes));
    }
    Ok((of_reference, of_nmt))
}

fn edge_row(edge: &CommonEdge) -> Vec<f64> {
    let between = edge.between.map(|subdomain| from_one(subdomain.index()));
    let edges = edge.edges.map(|edge| from_one(edge.index()));
    let counts = edge.nodes.each_ref().map(|nodes| nodes.len() as f64);
    [between, edges, edge.from, edge.to, counts].concat()
}

fn node_rows(k: usize, edge: &CommonEdge) -> Vec<Vec<f64>> {
    let row = |side: usize, place: usize| [k, side, place, edge.nodes[side][place].index()].map(from_one).to_vec();
    (0..2).flat_map(|side| (0..edge.nodes[side].len()).map(move |place| row(side, place))).collect()
}
