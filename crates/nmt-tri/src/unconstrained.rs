//! The paper's own way to a mesh, Sec. 5: Delaunay of all nodes, elimination, completion; each step by itself.

use crate::complete::complete;
use crate::delaunay::{NO_TRIANGLE, Triangles, plain};
use crate::eliminate::{Cause, Judge};
use crate::error::MeshError;
use crate::order::in_order;
use crate::ties::{Placed, settle};
use nmt_cloud::Cloud;
use nmt_geom::NodeId;

/// Which of the four steps are taken; the paper's `elim`. All of them by default.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Elimination {
    /// Drop triangles whose centroid is outside the main contour (12).
    pub outside: bool,
    /// Drop those whose centroid is in a hole.
    pub in_hole: bool,
    /// Drop those that are too small \[D8\].
    pub tiny: bool,
    /// Fill what is missing at segments of the real boundary.
    pub complete: bool,
}

impl Default for Elimination {
    fn default() -> Self {
        Self { outside: true, in_hole: true, tiny: true, complete: true }
    }
}

impl Elimination {
    /// The steps by name, in their order.
    pub const STEPS: [&str; 4] = ["outside", "in_hole", "tiny", "complete"];

    /// True where all steps are taken, which makes a sound mesh.
    pub fn is_whole(&self) -> bool {
        *self == Self::default()
    }
}

/// Triangles by what became of them: `delaunay − outside − in_hole − tiny − crossing + completed` are in the mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MeshCensus {
    /// Delaunay triangles of all nodes.
    pub delaunay: usize,
    /// Dropped: centroid outside the main contour.
    pub outside: usize,
    /// Dropped: centroid in a hole.
    pub in_hole: usize,
    /// Dropped: too small.
    pub tiny: usize,
    /// Taken away by completion: they cross a bare segment, or lie beside a gap too narrow to be filled alone.
    pub crossing: usize,
    /// Added by completion.
    pub completed: usize,
}

/// The triangles after each step; each list counter-clockwise, smallest node first, sorted.
#[derive(Clone, Debug, PartialEq)]
pub struct Stages {
    /// All Delaunay triangles.
    pub delaunay: Vec<[NodeId; 3]>,
    /// What elimination leaves.
    pub eliminated: Vec<[NodeId; 3]>,
    /// What completion makes of it.
    pub completed: Vec<[NodeId; 3]>,
    /// Counts of the steps.
    pub census: MeshCensus,
}

/// Takes the steps one after the other.
///
/// # Errors
/// [`MeshError`] where two nodes coincide, or a segment of the real boundary stays bare although completion is asked for.
pub fn stages(cloud: &Cloud, elimination: &Elimination) -> Result<Stages, MeshError> {
    let all = settled(cloud, plain(cloud)?);
    let mut census = MeshCensus { delaunay: all.nodes.len(), ..MeshCensus::default() };
    let judge = Judge::new(cloud);
    let mut kept = Vec::with_capacity(all.nodes.len());
    for &nodes in &all.nodes {
        match judge.cause(nodes, elimination) {
            None => kept.push(nodes),
            Some(Cause::Outside) => census.outside += 1,
            Some(Cause::InHole) => census.in_hole += 1,
            Some(Cause::Tiny) => census.tiny += 1,
        }
    }
    let eliminated = sorted(cloud, &kept);
    let mut completed = eliminated.clone();
    if elimination.complete {
        let filled = complete(cloud, kept)?;
        (census.crossing, census.completed) = (filled.taken, filled.added);
        if filled.added > 0 {
            completed = sorted(cloud, &settled(cloud, with_neighbours(filled.triangles)).nodes);
        }
    }
    Ok(Stages { delaunay: sorted(cloud, &all.nodes), eliminated, completed, census })
}

/// The triangles with ties settled by node number.
fn settled(cloud: &Cloud, triangles: Triangles) -> Triangles {
    let n_sides = 3 * triangles.nodes.len() as u32;
    let mut placed = Placed { xy: cloud.xy(), triangles };
    settle(&mut placed, 0..n_sides);
    placed.triangles
}

fn sorted(cloud: &Cloud, triangles: &[[u32; 3]]) -> Vec<[NodeId; 3]> {
    in_order(cloud.n_nodes(), || triangles.iter().copied())
}

/// Finds the triangle beyond each side.
fn with_neighbours(nodes: Vec<[u32; 3]>) -> Triangles {
    let mut sides: Vec<([u32; 2], u32, usize)> = Vec::with_capacity(3 * nodes.len());
    for (t, corners) in nodes.iter().enumerate() {
        for k in 0..3 {
            let (a, b) = (corners[k], corners[(k + 1) % 3]);
            sides.push(([a.min(b), a.max(b)], t as u32, k));
        }
    }
    sides.sort_unstable();
    let mut neighbours = vec![[NO_TRIANGLE; 3]; nodes.len()];
    for pair in sides.chunk_by(|a, b| a.0 == b.0) {
        if let &[(_, t, k), (_, u, m)] = pair {
            neighbours[t as usize][k] = u;
            neighbours[u as usize][m] = t;
        }
    }
    Triangles { nodes, neighbours }
}
