//! Points, curves and surfaces of the sections, with their names and nodes: what mesh.msh says.

use super::names::Names;
use crate::pipeline::MeshPart;
use nmt_cloud::NodeKind;
use nmt_geom::{Bbox, EdgeId, NodeId, Point, SubdomainId};
use nmt_merge::{CommonEdge, MeshSide, common_edges, weld_at};

/// Meshes as Gmsh looks at them.
pub(super) struct Model {
    /// Coordinates of the nodes of the file, shape (n_nodes, 2).
    pub xy: Vec<Point>,
    /// The node of the file of every node of each subdomain.
    pub nodes_of: Vec<Vec<NodeId>>,
    /// True where subdomains share the nodes of their common edges.
    pub is_welded: bool,
    /// Nodes where curves begin and end, ascending.
    pub points: Vec<NodeId>,
    pub curves: Vec<Curve>,
    /// One a subdomain.
    pub surfaces: Vec<Surface>,
    /// Names of the subdomains, then of the edges of each, then of the common edges.
    pub groups: Vec<Group>,
    /// Every node with what it lies in, sorted.
    pub owners: Vec<(Entity, NodeId)>,
}

/// A part of an edge from a vertex, or an end of a common edge, to the next.
pub(super) struct Curve {
    /// In order; where it closes, the first one again at the end.
    pub nodes: Vec<NodeId>,
    /// Numbers of its names in [`Model::groups`]: its edge, on a welded common edge that of the other side too, and the
    /// common edge.
    pub groups: Vec<usize>,
}

/// A subdomain.
pub(super) struct Surface {
    pub envelope: Bbox,
    pub bounds: Vec<Bound>,
}

/// A curve around a surface.
pub(super) struct Bound {
    pub curve: usize,
    /// True where the curve has the material on its right.
    pub is_reversed: bool,
}

/// A name of surfaces (dimension 2) or of curves (dimension 1).
pub(super) struct Group {
    pub dimension: u8,
    pub name: String,
}

/// What a node lies in, by number; in the order of the file.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Entity {
    Point(usize),
    Curve(usize),
    Surface(usize),
}

/// A segment of the real boundary in the nodes of the file.
struct Piece {
    from: NodeId,
    to: NodeId,
    edge: EdgeId,
    /// The common edge that it lies on.
    interface: Option<usize>,
    starts_at_vertex: bool,
}

impl Model {
    pub(super) fn new(parts: &[&MeshPart]) -> Self {
        let sides: Vec<MeshSide> =
            parts.iter().map(|part| MeshSide { name: &part.name, section: &part.section, mesh: &part.mesh }).collect();
        let common = if parts.len() < 2 {
            Vec::new()
        } else {
            common_edges(&sides.iter().map(MeshSide::side).collect::<Vec<_>>())
        };
        let Joined { xy, nodes_of, is_welded } = Joined::new(&sides, &common);
        // The loops of each part.
        let rings: Vec<Vec<Vec<Piece>>> =
            (0..parts.len()).map(|k| rings(parts[k], SubdomainId::of(k), &common, &nodes_of[k])).collect();
        let is_end = ends(rings.iter().flatten(), xy.len());
        let points: Vec<NodeId> = (0..xy.len()).filter(|&node| is_end[node]).map(NodeId::of).collect();

        let (mut groups, first_edges) = names(parts);
        let (mut curves, mut surfaces) = (Vec::<Curve>::new(), Vec::new());
        let mut along: Vec<Vec<usize>> = vec![Vec::new(); common.len()];
        for (k, rings) in rings.iter().enumerate() {
            let mut bounds = Vec::new();
            for run in rings.iter().flat_map(|ring| runs(ring, &is_end)) {
                let nodes: Vec<NodeId> = run.iter().take(1).map(|p| p.from).chain(run.iter().map(|p| p.to)).collect();
                let group = first_edges[k] + run[0].edge.index();
                let along = run[0].interface.map(|interface| &mut along[interface]);
                // The other side of a welded common edge came first and led the other way.
                let there = |&&curve: &&usize| curves[curve].nodes.iter().rev().eq(&nodes);
                if let Some(&curve) = along.as_ref().and_then(|along| along.iter().find(there)) {
                    curves[curve].groups.push(group);
                    bounds.push(Bound { curve, is_reversed: true });
                } else {
                    along.into_iter().for_each(|along| along.push(curves.len()));
                    bounds.push(Bound { curve: curves.len(), is_reversed: false });
                    curves.push(Curve { nodes, groups: vec![group] });
                }
            }
            let envelope = Bbox::of(nodes_of[k].iter().map(|node| xy[node.index()]));
            surfaces.push(Surface { envelope, bounds });
        }
        for (name, along) in interface_names(parts, &common).into_iter().zip(along) {
            // A common edge shorter than the segments of both sides is on none of them.
            if along.is_empty() {
                continue;
            }
            along.into_iter().for_each(|curve| curves[curve].groups.push(groups.len()));
            groups.push(Group { dimension: 1, name });
        }
        let mut taken = Names::default();
        groups.iter_mut().for_each(|group| group.name = taken.give(&group.name));
        let owners = owners(xy.len(), &nodes_of, &curves, &points);
        Self { xy, nodes_of, is_welded, points, curves, surfaces, groups, owners }
    }

    /// Triangles of a subdomain in the nodes of the file.
    pub(super) fn triangles<'a>(&'a self, k: usize, part: &'a MeshPart) -> impl Iterator<Item = [NodeId; 3]> + 'a {
        part.mesh.tri_nodes().iter().map(move |nodes| nodes.map(|node| self.nodes_of[k][node.index()]))
    }
}

/// The nodes of the file.
struct Joined {
    xy: Vec<Point>,
    nodes_of: Vec<Vec<NodeId>>,
    is_welded: bool,
}

impl Joined {
    /// Welded where all common edges conform, else subdomain after subdomain.
    fn new(sides: &[MeshSide], common: &[CommonEdge]) -> Self {
        if let Some(welded) = Some(common).filter(|c| !c.is_empty()).and_then(|common| weld_at(sides, common).ok()) {
            let nodes_of = (0..sides.len()).map(|k| welded.nodes_of(SubdomainId::of(k)).to_vec()).collect();
            return Self { xy: welded.xy().to_vec(), nodes_of, is_welded: true };
        }
        let mut xy = Vec::new();
        let nodes_of = |side: &MeshSide| {
            let start = xy.len();
            xy.extend_from_slice(side.mesh.xy());
            (start..xy.len()).map(NodeId::of).collect()
        };
        let nodes_of = sides.iter().map(nodes_of).collect();
        Self { xy, nodes_of, is_welded: false }
    }
}

/// The loops of a subdomain, each segment with the common edge that both its ends lie on.
fn rings(part: &MeshPart, subdomain: SubdomainId, common: &[CommonEdge], nodes: &[NodeId]) -> Vec<Vec<Piece>> {
    let cloud = part.mesh.cloud();
    let segments = cloud.boundary().segments();
    let mut leaving = vec![usize::MAX; cloud.n_nodes()];
    segments.iter().enumerate().for_each(|(s, segment)| leaving[segment.from.index()] = s);
    let mut interfaces = vec![None; segments.len()];
    for (interface, edge) in common.iter().enumerate() {
        for side in (0..2).filter(|&side| edge.between[side] == subdomain) {
            let on = &edge.nodes[side];
            let closing = on.last().zip(on.first()).filter(|_| edge.is_closed());
            for (&p, &q) in on.iter().zip(on.iter().skip(1)).chain(closing) {
                for (from, to) in [(p, q), (q, p)] {
                    let s = leaving[from.index()];
                    if segments.get(s).is_some_and(|found| found.to == to && found.edge == edge.edges[side]) {
                        interfaces[s] = Some(interface);
                    }
                }
            }
        }
    }
    let boundary = cloud.boundary();
    let mut rings: Vec<Vec<Piece>> = (0..boundary.n_loops()).map(|_| Vec::new()).collect();
    for (s, segment) in segments.iter().enumerate() {
        rings[boundary.loop_of_segment(s).index()].push(Piece {
            from: nodes[segment.from.index()],
            to: nodes[segment.to.index()],
            edge: segment.edge,
            interface: interfaces[s],
            starts_at_vertex: cloud.kind(segment.from) == NodeKind::Vertex,
        });
    }
    rings
}

/// Which nodes are vertices or ends of common edges, on any side, so that both sides of a welded one are cut alike.
fn ends<'a>(rings: impl Iterator<Item = &'a Vec<Piece>> + Clone, n_nodes: usize) -> Vec<bool> {
    let mut is_end = vec![false; n_nodes];
    for ring in rings.clone() {
        for (before, piece) in ring.iter().cycle().skip(ring.len().saturating_sub(1)).zip(ring) {
            let is_cut = (before.edge, before.interface) != (piece.edge, piece.interface);
            is_end[piece.from.index()] |= piece.starts_at_vertex || is_cut;
        }
    }
    // A closed curve has to begin somewhere.
    for ring in rings {
        if let Some(first) = ring.first().filter(|_| !ring.iter().any(|piece| is_end[piece.from.index()])) {
            is_end[first.from.index()] = true;
        }
    }
    is_end
}

/// A loop in curves.
fn runs<'a>(ring: &'a [Piece], is_end: &[bool]) -> Vec<Vec<&'a Piece>> {
    let start = ring.iter().position(|piece| is_end[piece.from.index()]).unwrap_or(0);
    let (head, tail) = ring.split_at(start);
    let pieces: Vec<&Piece> = tail.iter().chain(head).collect();
    pieces.chunk_by(|_, next| !is_end[next.from.index()]).map(<[_]>::to_vec).collect()
}

/// Names wanted for subdomains and edges; the number of the first edge of each subdomain among them.
fn names(parts: &[&MeshPart]) -> (Vec<Group>, Vec<usize>) {
    let mut groups: Vec<Group> = parts.iter().map(|part| Group { dimension: 2, name: part.name.clone() }).collect();
    let mut first_edges = Vec::with_capacity(parts.len());
    for part in parts {
        first_edges.push(groups.len());
        let name = |edge: &String| if parts.len() > 1 { format!("{}/{edge}", part.name) } else { edge.clone() };
        groups.extend(part.edge_names.iter().map(|edge| Group { dimension: 1, name: name(edge) }));
    }
    (groups, first_edges)
}

/// Names wanted for common edges: of both subdomains, with a number where they have several.
fn interface_names(parts: &[&MeshPart], common: &[CommonEdge]) -> Vec<String> {
    // Common edges are ordered by their subdomains.
    let of_pair = |pair: &[CommonEdge]| -> Vec<String> {
        let [a, b] = pair[0].between.map(|k| &parts[k.index()].name);
        match pair.len() {
            1 => vec![format!("{a}|{b}")],
            n => (1..=n).map(|number| format!("{a}|{b} {number}")).collect(),
        }
    };
    common.chunk_by(|p, q| p.between == q.between).flat_map(of_pair).collect()
}

fn owners(n_nodes: usize, nodes_of: &[Vec<NodeId>], curves: &[Curve], points: &[NodeId]) -> Vec<(Entity, NodeId)> {
    let mut owners = vec![Entity::Surface(0); n_nodes];
    let mut own = |node: NodeId, entity: Entity| owners[node.index()] = entity;
    for (k, nodes) in nodes_of.iter().enumerate() {
        nodes.iter().for_each(|&node| own(node, Entity::Surface(k)));
    }
    for (k, curve) in curves.iter().enumerate() {
        curve.nodes.iter().for_each(|&node| own(node, Entity::Curve(k)));
    }
    points.iter().enumerate().for_each(|(k, &node)| own(node, Entity::Point(k)));
    let mut owners: Vec<(Entity, NodeId)> =
        owners.into_iter().enumerate().map(|(node, entity)| (entity, NodeId::of(node))).collect();
    owners.sort_unstable();
    owners
}
