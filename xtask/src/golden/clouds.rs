//! Clouds against the reference's: node by node, segment by segment, edge by edge.

use super::fixture::{Table, numbers};
use super::{Entry, Scale, common, meshes, read_problem};
use crate::root;
use anyhow::{Context as _, Result, bail};
use nmt::pipeline::{cloud_params, section};
use nmt::problem::Overrides;
use nmt_cloud::{Cloud, NodeKind, Section, generate_with};
use nmt_curve::{ArcTable, Curve};
use nmt_geom::{EdgeId, LoopId, NodeId};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

const NODES: &[&str] = &["subdomain", "node", "x", "y", "kind", "edge1", "edge2"];
const SEGMENTS: &[&str] = &["subdomain", "loop", "from", "to", "edge"];
const CENSUS: &[&str] = &["subdomain", "grid", "outside", "in_hole", "near_edge", "near_node", "kept"];
const EDGES: &[&str] = &["subdomain", "edge", "length", "n", "left_out", "closing_error"];

/// Expected and found entries of a case, in the same order where they agree.
pub fn entries(problem: &Path, expected: &Path) -> Result<(Vec<Entry>, Vec<Entry>)> {
    let clouds = clouds(problem)?;
    let sizes: Vec<f64> = clouds.iter().map(|(_, cloud)| cloud.size()).collect();
    let mut of_reference = Vec::new();
    for (name, columns) in [("nodes", NODES), ("segments", SEGMENTS), ("census", CENSUS), ("edges", EDGES)] {
        let mut table = Table::read(&expected.join(format!("{name}.csv")), columns)?;
        if name == "segments" {
            table.rows = undirected(std::mem::take(&mut table.rows));
        }
        of_reference.extend(table_entries(name, table.columns(), &table.rows, &sizes));
    }
    let (of_meshes, found_in_meshes) = meshes::entries(&clouds, expected)?;
    of_reference.extend(of_meshes);
    let (of_common_edges, found_common_edges) = common::entries(&clouds, &sizes, expected)?;
    of_reference.extend(of_common_edges);
    let mut found = Vec::new();
    let tables = [
        ("nodes", NODES, of_all(&clouds, |_, cloud| Ok(node_rows(cloud)))?),
        ("segments", SEGMENTS, undirected(of_all(&clouds, |_, cloud| Ok(segment_rows(cloud)))?)),
        ("census", CENSUS, of_all(&clouds, |_, cloud| Ok(vec![census_row(cloud)]))?),
        ("edges", EDGES, of_all(&clouds, edge_rows)?),
    ];
    for (name, columns, rows) in tables {
        let columns: Vec<String> = columns.iter().map(|name| (*name).into()).collect();
        found.extend(table_entries(name, &columns, &rows, &sizes));
    }
    found.extend(found_in_meshes);
    found.extend(found_common_edges);
    Ok((of_reference, found))
}

/// The rows of all subdomains, each begun with the subdomain's number.
fn of_all(
    clouds: &[(Section, Cloud)],
    rows: impl Fn(&Section, &Cloud) -> Result<Vec<Vec<f64>>>,
) -> Result<Vec<Vec<f64>>> {
    let mut table = Vec::new();
    for (k, (section, cloud)) in clouds.iter().enumerate() {
        table.extend(rows(section, cloud)?.into_iter().map(|row| [vec![from_one(k)], row].concat()));
    }
    Ok(table)
}

/// The clouds of a problem, made with the random numbers that the reference uses.
pub fn clouds(file: &Path) -> Result<Vec<(Section, Cloud)>> {
    let problem = read_problem(file, &Overrides::default())?;
    let random = root().join("fixtures/golden/random.csv");
    let text = fs::read_to_string(&random).with_context(|| format!("{} cannot be read", random.display()))?;
    let random: Vec<Vec<f64>> = text.lines().map(numbers).collect::<Result<_>>()?;
    let cloud = |subdomain| {
        let section = section(subdomain);
        let params = cloud_params(&problem, subdomain);
        let irregular = params.irregularity > 0.0;
        // 2r − 1 and 2r′ − 1; a node without a row would silently stay where it is, and is refused below.
        let draw = |node: usize, draw: usize| {
            let row = random.get(node).map_or(&[] as &[f64], |row| row);
            [2 * draw, 2 * draw + 1].map(|k| row.get(k).map_or(0.0, |r| 2.0 * r - 1.0))
        };
        let cloud = generate_with(&section, &params, draw)?;
        if irregular && cloud.n_nodes() > random.len() {
            bail!("{}: {} nodes, and {} rows of random numbers", file.display(), cloud.n_nodes(), random.len());
        }
        cloud.check()?;
        Ok((section, cloud))
    };
    problem.subdomains.iter().map(cloud).collect()
}

/// One entry a number; its id names the file, the keys of the row and the column.
pub fn table_entries<'a>(
    name: &'a str,
    columns: &'a [String],
    rows: &'a [Vec<f64>],
    sizes: &'a [f64],
) -> impl Iterator<Item = Entry> + 'a {
    let n_keys = match name {
        "nodes" | "edges" => 2,
        "segments" | "common_edges" => 4,
        "common_nodes" => 3,
        _ => 1,
    };
    rows.iter().flat_map(move |row| {
        let size = sizes.get(row[0] as usize - 1).copied().unwrap_or(1.0);
        let keys: Vec<String> = (0..n_keys).map(|k| format!("{} {}", columns[k], row[k])).collect();
        (n_keys..columns.len()).map(move |k| {
            let is_length =
                matches!(&*columns[k], "x" | "y" | "length" | "closing_error" | "from_x" | "from_y" | "to_x" | "to_y");
            let scale = if is_length { Scale::Length(size) } else { Scale::Exact };
            Entry { id: format!("{name}.csv, {}, {}", keys.join(", "), columns[k]), value: row[k], scale }
        })
    })
}

/// Segments of a loop in order of their nodes: which way a loop runs and where it begins is each program's own.
fn undirected(mut rows: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
    for row in &mut rows {
        if row[2] > row[3] {
            row.swap(2, 3);
        }
    }
    rows.sort_by(|a, b| a.partial_cmp(b).unwrap_or(std::cmp::Ordering::Equal));
    rows
}

/// A number that the reference counts from 1.
pub fn from_one(number: usize) -> f64 {
    (number + 1) as f64
}

fn node_rows(cloud: &Cloud) -> Vec<Vec<f64>> {
    let row = |node: usize| {
        let id = NodeId::of(node);
        let kind = match cloud.kind(id) {
            NodeKind::Vertex => 1.0,
            NodeKind::Edge => 2.0,
            NodeKind::Interior => 3.0,
        };
        // The reference names the one edge of an edge node once.
        let edges = cloud.edges(id).map_or([0.0; 2], |e| [e.first, e.second].map(|edge| from_one(edge.index())));
        let edges = if kind == 2.0 { [edges[0], 0.0] } else { edges };
        vec![from_one(node), cloud.xy()[node][0], cloud.xy()[node][1], kind, edges[0], edges[1]]
    };
    (0..cloud.n_nodes()).map(row).collect()
}

fn segment_rows(cloud: &Cloud) -> Vec<Vec<f64>> {
    let boundary = cloud.boundary();
    let of_loop = |ring: usize| {
        let number = |segment: &nmt_geom::Segment| [segment.from.index(), segment.to.index(), segment.edge.index()];
        let row = move |segment| [vec![from_one(ring)], number(segment).map(from_one).to_vec()].concat();
        boundary.loop_segments(LoopId::of(ring)).iter().map(row)
    };
    (0..boundary.n_loops()).flat_map(of_loop).collect()
}

fn census_row(cloud: &Cloud) -> Vec<f64> {
    let c = cloud.census();
    [c.grid, c.outside, c.in_hole, c.near_edge, c.near_node, c.kept].map(|n| n as f64).to_vec()
}

fn edge_rows(section: &Section, cloud: &Cloud) -> Result<Vec<Vec<f64>>> {
    let mut on_edge: BTreeMap<EdgeId, usize> = BTreeMap::new();
    for node in cloud.n_vertices()..cloud.n_boundary() {
        if let Some(edges) = cloud.edges(NodeId::of(node)) {
            *on_edge.entry(edges.first).or_default() += 1;
        }
    }
    let curves: Vec<&Curve> = section.loops().flat_map(|outline| &outline.edges).map(|edge| &edge.curve).collect();
    let row = |(k, curve): (usize, &&Curve)| {
        let closing = cloud.closings().iter().find(|closing| closing.edge == EdgeId::of(k));
        let left_out = closing.map_or(0, |closing| closing.left_out);
        let ends = if curve.is_closed() { 1 } else { 2 };
        let n = on_edge.get(&EdgeId::of(k)).copied().unwrap_or(0) + ends + left_out;
        let length = ArcTable::new(curve)?.length();
        Ok(vec![from_one(k), length, n as f64, left_out as f64, closing.map_or(0.0, |closing| closing.closing_error)])
    };
    curves.iter().enumerate().map(row).collect()
}
