//! Edges, and the triangles around each node; built when asked for.

use nmt_geom::{NodeId, TriId};

/// An edge of the mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MeshEdge {
    /// Its nodes, the smaller number first.
    pub nodes: [u32; 2],
    /// In how many triangles it is.
    pub n_triangles: usize,
}

/// Every edge once, sorted by its nodes.
pub fn edges(tri_nodes: &[[NodeId; 3]]) -> Vec<MeshEdge> {
    let sides = |[a, b, c]: &[NodeId; 3]| [(a, b), (b, c), (c, a)].map(|(p, q)| [p.0.min(q.0), p.0.max(q.0)]);
    let mut all: Vec<[u32; 2]> = tri_nodes.iter().flat_map(sides).collect();
    all.sort_unstable();
    all.chunk_by(|p, q| p == q).map(|run| MeshEdge { nodes: run[0], n_triangles: run.len() }).collect()
}

/// The triangles around each node, ascending.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NodeTris {
    starts: Vec<u32>, // shape (n_nodes + 1,)
    tris: Vec<TriId>,
}

impl NodeTris {
    /// Collects them in O(triangles).
    pub fn new(n_nodes: usize, tri_nodes: &[[NodeId; 3]]) -> Self {
        let mut starts = vec![0u32; n_nodes + 1];
        tri_nodes.iter().flatten().for_each(|node| starts[node.index() + 1] += 1);
        (0..n_nodes).for_each(|node| starts[node + 1] += starts[node]);
        let mut next = starts.clone();
        let mut tris = vec![TriId(0); 3 * tri_nodes.len()];
        for (t, nodes) in tri_nodes.iter().enumerate() {
            for node in nodes {
                tris[next[node.index()] as usize] = TriId::of(t);
                next[node.index()] += 1;
            }
        }
        Self { starts, tris }
    }

    /// Triangles that `node` is a corner of.
    pub fn around(&self, node: NodeId) -> &[TriId] {
        &self.tris[self.starts[node.index()] as usize..self.starts[node.index() + 1] as usize]
    }
}
