//! Meshes of adjacent subdomains to one conforming mesh.

use crate::common_edges::{CommonEdge, Side, common_edges};
use crate::error::MergeError;
use nmt_cloud::Section;
use nmt_geom::point::{cross, sub};
use nmt_geom::tol::SAME_POINT_REL;
use nmt_geom::{Bbox, EdgeId, NodeId, Point, SubdomainId};
use nmt_tri::{Mesh, edges};

/// The area that moving the nodes of common edges by [`SAME_POINT_REL`] of the size explains, in squares of the size: the
/// way around every subdomain is a few sizes.
const AREA_REL: f64 = 1.0e2 * SAME_POINT_REL;

/// One subdomain with its mesh, borrowed.
#[derive(Clone, Copy, Debug)]
pub struct MeshSide<'a> {
    /// Its name.
    pub name: &'a str,
    /// Its outlines.
    pub section: &'a Section,
    /// Its mesh.
    pub mesh: &'a Mesh,
}

impl<'a> MeshSide<'a> {
    /// The same with its cloud alone.
    pub fn side(&self) -> Side<'a> {
        Side { section: self.section, cloud: self.mesh.cloud() }
    }
}

/// One conforming mesh of several subdomains.
#[derive(Clone, Debug, PartialEq)]
pub struct Welded {
    xy: Vec<Point>,               // shape (n_nodes, 2), user's length unit
    tri_nodes: Vec<[NodeId; 3]>,  // shape (n_triangles, 3), counter-clockwise
    tri_region: Vec<SubdomainId>, // shape (n_triangles,)
    regions: Vec<String>,
    node_map: Vec<Vec<NodeId>>, // by subdomain, shape (n_nodes of its cloud,)
    outer: Vec<OuterSegment>,
    interfaces: Vec<Interface>,
    area: f64, // of the parts
}

/// A segment on the outside of a welded mesh, or around a hole that nothing fills; the material lies on the left of
/// `from → to`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OuterSegment {
    /// First node.
    pub from: NodeId,
    /// Last node.
    pub to: NodeId,
    /// The subdomain beside it.
    pub region: SubdomainId,
    /// The edge of that it lies on.
    pub edge: EdgeId,
}

/// A common edge inside a welded mesh.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Interface {
    /// The two subdomains.
    pub between: [SubdomainId; 2],
    /// The edge of each.
    pub edges: [EdgeId; 2],
    /// Its nodes in order; where it closes, the first one again at the end.
    pub nodes: Vec<NodeId>,
}

impl Welded {
    /// Coordinates of the nodes, shape (n_nodes, 2), user's length unit: those of the first subdomain, then those of each
    /// other that are not on its common edges with earlier ones.
    pub fn xy(&self) -> &[Point] {
        &self.xy
    }

    /// Nodes of each triangle, shape (n_triangles, 3), counter-clockwise; subdomain after subdomain.
    pub fn tri_nodes(&self) -> &[[NodeId; 3]] {
        &self.tri_nodes
    }

    /// The subdomain of each triangle, shape (n_triangles,).
    pub fn tri_region(&self) -> &[SubdomainId] {
        &self.tri_region
    }

    /// Names of the subdomains.
    pub fn regions(&self) -> &[String] {
        &self.regions
    }

    /// The welded node of every node of a subdomain's cloud.
    pub fn nodes_of(&self, subdomain: SubdomainId) -> &[NodeId] {
        &self.node_map[subdomain.index()]
    }

    /// The outer boundary, subdomain after subdomain.
    pub fn outer(&self) -> &[OuterSegment] {
        &self.outer
    }

    /// The common edges.
    pub fn interfaces(&self) -> &[Interface] {
        &self.interfaces
    }

    /// Area of a triangle by cross product \[D9\].
    fn area(&self, [a, b, c]: [NodeId; 3]) -> f64 {
        let [a, b, c] = [a, b, c].map(|node| self.xy[node.index()]);
        cross(sub(b, a), sub(c, a)) / 2.0
    }

    /// Checks the invariants: areas positive and summing to those of the parts, every segment of the outer boundary in one
    /// triangle, every other edge in two.
    ///
    /// # Errors
    /// The first invariant that is broken.
    pub fn check(&self) -> Result<(), MergeError> {
        let areas = || self.tri_nodes.iter().map(|&nodes| self.area(nodes));
        if let Some((triangle, area)) = areas().enumerate().find(|&(_, area)| area <= 0.0) {
            return Err(MergeError::FlatTriangle { triangle, area });
        }
        let (sum, size) = (areas().sum::<f64>(), Bbox::of(self.xy.iter().copied()).size());
        if (sum - self.area).abs() > AREA_REL * size * size {
            return Err(MergeError::Area { sum, area: self.area });
        }
        let mut outer: Vec<[u32; 2]> = self.outer.iter().map(|s| sorted(s.from, s.to)).collect();
        outer.sort_unstable();
        let edges = edges(&self.tri_nodes);
        for edge in &edges {
            let expected = if outer.binary_search(&edge.nodes).is_ok() { 1 } else { 2 };
            if edge.n_triangles != expected {
                let nodes = edge.nodes.map(|node| node as usize);
                return Err(MergeError::MeshEdge { nodes, found: edge.n_triangles, expected });
            }
        }
        let is_bare = |nodes: &&[u32; 2]| edges.binary_search_by(|edge| edge.nodes.cmp(nodes)).is_err();
        match outer.iter().find(is_bare) {
            Some(bare) => Err(MergeError::MeshEdge { nodes: bare.map(|n| n as usize), found: 0, expected: 1 }),
            None => Ok(()),
        }
    }
}

/// One mesh of all parts, the nodes of both sides of every common edge being one.
///
/// Nodes must coincide to 1e-9 of the size of the whole problem, which `conforming = true` sees to; a welded node has the
/// coordinates of the first subdomain's. Subdomains that meet in a point alone stay apart there.
///
/// # Errors
/// [`MergeError::Apart`] for the first node on a common edge that has none of the other side at its place; another where
/// the result would break an invariant of [`Welded::check`].
///
/// ```
/// use nmt_cloud::{CloudParams, Section, generate};
/// use nmt_curve::Outline;
/// use nmt_merge::{MeshSide, weld};
/// use nmt_tri::Mesh;
///
/// let sections = [0.0, 2.0].map(|x| Section::solid(Outline::rectangle([x, 0.0], [x + 2.0, 1.0])));
/// let params = CloudParams { nodes: [9, 5], ..CloudParams::default() };
/// let meshes = [Mesh::constrained(generate(&sections[0], &params)?)?, Mesh::constrained(generate(&sections[1], &params)?)?];
/// let welded = weld(&[0, 1].map(|k| MeshSide { name: ["left", "right"][k], section: &sections[k], mesh: &meshes[k] }))?;
/// assert_eq!(welded.xy().len(), 17 * 5);
/// assert_eq!(welded.interfaces()[0].nodes.len(), 5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn weld(parts: &[MeshSide]) -> Result<Welded, MergeError> {
    let sides: Vec<Side> = parts.iter().map(MeshSide::side).collect();
    weld_at(parts, &common_edges(&sides))
}

/// [`weld`] at common edges that are known.
///
/// # Errors
/// Those of [`weld`].
pub fn weld_at(parts: &[MeshSide], common: &[CommonEdge]) -> Result<Welded, MergeError> {
    let sides: Vec<Side> = parts.iter().map(MeshSide::side).collect();
    if let Some((edge, apart)) = common.iter().find_map(|edge| Some((edge, edge.first_apart(&sides)?))) {
        let name = |side: usize| parts[edge.between[side].index()].name.to_owned();
        return Err(MergeError::Apart {
            subdomain: name(apart.side),
            neighbour: name(1 - apart.side),
            node: apart.node.index(),
            at: apart.at,
        });
    }
    // All nodes in one row, subdomain after subdomain; one that is another's belongs to the smallest number.
    let mut starts = vec![0];
    starts.extend(parts.iter().scan(0, |n, part| {
        *n += part.mesh.cloud().n_nodes();
        Some(*n)
    }));
    let mut same: Vec<usize> = (0..starts[parts.len()]).collect();
    for edge in common {
        let row = |side: usize, k: usize| starts[edge.between[side].index()] + edge.nodes[side][k].index();
        for k in 0..edge.nodes[0].len().min(edge.nodes[1].len()) {
            let [p, q] = [row(0, k), row(1, k)].map(|row| first_of(&same, row));
            same[p.max(q)] = p.min(q);
        }
    }
    let mut xy = Vec::with_capacity(same.len());
    let mut welded = Vec::with_capacity(same.len());
    for (part, start) in parts.iter().zip(&starts) {
        for (k, &at) in part.mesh.xy().iter().enumerate() {
            let first = first_of(&same, start + k);
            // An earlier node has its number already.
            let node = welded.get(first).copied().unwrap_or(NodeId::of(xy.len()));
            if node.index() == xy.len() {
                xy.push(at);
            }
            welded.push(node);
        }
    }
    let node_map: Vec<Vec<NodeId>> = starts.windows(2).map(|ends| welded[ends[0]..ends[1]].to_vec()).collect();
    let (mut tri_nodes, mut tri_region) = (Vec::new(), Vec::new());
    for (k, part) in parts.iter().enumerate() {
        tri_nodes.extend(part.mesh.tri_nodes().iter().map(|nodes| nodes.map(|node| node_map[k][node.index()])));
        tri_region.resize(tri_nodes.len(), SubdomainId::of(k));
    }
    let interface = |edge: &CommonEdge| {
        let map = &node_map[edge.between[0].index()];
        let mut nodes: Vec<NodeId> = edge.nodes[0].iter().map(|node| map[node.index()]).collect();
        nodes.extend(nodes.first().copied().filter(|_| edge.is_closed()));
        Interface { between: edge.between, edges: edge.edges, nodes }
    };
    let interfaces: Vec<Interface> = common.iter().map(interface).collect();
    let pairs = interfaces.iter().flat_map(|interface| interface.nodes.windows(2));
    let mut inside: Vec<[u32; 2]> = pairs.map(|pair| sorted(pair[0], pair[1])).collect();
    inside.sort_unstable();
    let mut outer = Vec::new();
    for (k, part) in parts.iter().enumerate() {
        for segment in part.mesh.cloud().boundary().segments() {
            let [from, to] = [segment.from, segment.to].map(|node| node_map[k][node.index()]);
            if inside.binary_search(&sorted(from, to)).is_err() {
                outer.push(OuterSegment { from, to, region: SubdomainId::of(k), edge: segment.edge });
            }
        }
    }
    let regions = parts.iter().map(|part| part.name.to_owned()).collect();
    let area = parts.iter().map(|part| part.mesh.total_area()).sum();
    let welded = Welded { xy, tri_nodes, tri_region, regions, node_map, outer, interfaces, area };
    welded.check()?;
    Ok(welded)
}

/// The smallest row that is the same node.
fn first_of(same: &[usize], mut row: usize) -> usize {
    while same[row] != row {
        row = same[row];
    }
    row
}

fn sorted(p: NodeId, q: NodeId) -> [u32; 2] {
    [p.0.min(q.0), p.0.max(q.0)]
}
