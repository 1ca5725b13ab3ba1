//! Meshes against the reference's: counts of every step, area, and the triangles wherever Delaunay is unique.

use super::fixture::Table;
use super::{Entry, Scale};
use anyhow::{Context as _, Result};
use nmt_cloud::{Cloud, Section};
use nmt_geom::Point;
use nmt_geom::point::{cross, distance_squared, dot, sub};
use nmt_tri::{Elimination, Mesh, MeshCensus};
use std::collections::BTreeSet;
use std::path::Path;

const MESH: &[&str] =
    &["subdomain", "delaunay", "outside", "in_hole", "tiny", "crossing", "completed", "triangles", "area"];
const TRIANGLES: &[&str] = &["subdomain", "node1", "node2", "node3"];

/// A fourth node is on the circle of three where its power is below this fraction of the squared longest side; as for the
/// ties of nmt-tri.
const COCIRCULAR_REL: f64 = 1.0e-9;

/// Expected and found entries of the meshes of all subdomains, by the paper's way.
pub fn entries(clouds: &[(Section, Cloud)], expected: &Path) -> Result<(Vec<Entry>, Vec<Entry>)> {
    let counts = Table::read(&expected.join("mesh.csv"), MESH)?;
    let triangles = Table::read(&expected.join("triangles.csv"), TRIANGLES)?;
    let (mut of_reference, mut of_nmt) = (Vec::new(), Vec::new());
    for (k, (_, cloud)) in clouds.iter().enumerate() {
        let number = (k + 1) as f64;
        let row = counts.rows.iter().find(|row| row[0] == number).with_context(|| format!("mesh.csv: no {number}"))?;
        let (mesh, census) = Mesh::unconstrained(cloud.clone(), &Elimination::default())?;
        mesh.check()?;
        let MeshCensus { delaunay, outside, in_hole, tiny, crossing, completed } = census;
        // Nodes of a skew side are on one line but for rounding: exact predicates make triangles of them on the hull, Qhull
        // does not. They go as tiny or outside; what elimination leaves is the same.
        let kept = delaunay - outside - in_hole - tiny;
        let kept_there = row[1] - row[2] - row[3] - row[4];
        let counts = [
            ("in_hole", in_hole, row[3]),
            ("left by elimination", kept, kept_there),
            ("crossing", crossing, row[5]),
            ("completed", completed, row[6]),
            ("triangles", mesh.n_triangles(), row[7]),
        ];
        let mut add = |name: &str, there: f64, here: f64, scale: Scale| {
            let id = format!("mesh.csv, subdomain {number}, {name}");
            of_reference.push(Entry { id: id.clone(), value: there, scale });
            of_nmt.push(Entry { id, value: here, scale });
        };
        counts.into_iter().for_each(|(name, here, there)| add(name, there, here as f64, Scale::Exact));
        add("area", row[8], mesh.total_area(), Scale::Itself);
        // Nodes count from 1 there.
        let theirs: BTreeSet<[u32; 3]> = triangles
            .rows
            .iter()
            .filter(|row| row[0] == number)
            .map(|row| [row[1], row[2], row[3]].map(|node| node as u32 - 1))
            .collect();
        let ours: BTreeSet<[u32; 3]> = mesh.tri_nodes().iter().map(|nodes| nodes.map(|node| node.0)).collect();
        let differ = ours.symmetric_difference(&theirs).filter(|t| !is_tied(cloud.xy(), **t)).count();
        let id = format!("triangles.csv, subdomain {number}, triangles that differ without a tie");
        of_reference.push(Entry { id: id.clone(), value: 0.0, scale: Scale::Exact });
        of_nmt.push(Entry { id, value: differ as f64, scale: Scale::Exact });
    }
    Ok((of_reference, of_nmt))
}

/// True where a fourth node lies on the circle through the corners, so that Delaunay leaves the diagonal open.
fn is_tied(xy: &[Point], nodes: [u32; 3]) -> bool {
    let [a, b, c] = nodes.map(|node| xy[node as usize]);
    let twice_area = cross(sub(b, a), sub(c, a)).abs();
    let longest = distance_squared(a, b).max(distance_squared(b, c)).max(distance_squared(c, a));
    let on_circle = |d: &Point| {
        let [u, v, w] = [sub(a, *d), sub(b, *d), sub(c, *d)];
        let lift = |p: Point| dot(p, p);
        let incircle = lift(u) * cross(v, w) + lift(v) * cross(w, u) + lift(w) * cross(u, v);
        incircle.abs() <= COCIRCULAR_REL * twice_area * longest
    };
    xy.iter().enumerate().any(|(n, d)| !nodes.contains(&(n as u32)) && on_circle(d))
}
