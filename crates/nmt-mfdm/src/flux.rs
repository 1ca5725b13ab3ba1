//! Fluxes on the boundary: ∂u/∂n = q on the true edge, which the mesh has a polygon for.

use crate::error::MfdmError;
use crate::slopes::{KnownSlopes, Slopes};
use crate::true_edges::{Sample, visit_pieces};
use nmt_cloud::Section;
use nmt_geom::point::{cross, dot};
use nmt_geom::{EdgeId, NodeId, Point};
use nmt_tri::Mesh;
use std::collections::HashMap;
use std::collections::hash_map::Entry;

/// ∂u/∂n = q on an edge.
pub(crate) type Flux<'a> = &'a (dyn Fn(Point) -> f64 + Sync);

/// The conditions at one node: n·∇u = q on each of the edges that meet there.
#[derive(Clone, Copy, Debug)]
pub(crate) struct NodeFlux {
    /// The node.
    pub node: NodeId,
    sides: (Side, Option<Side>),
}

/// n·∇u = q on one side of a node.
#[derive(Clone, Copy, Debug)]
struct Side {
    normal: Point, // outward unit normal
    q: f64,
}

/// Sides whose normals differ by less than this sine, or point away from each other as nearly, are one boundary: the
/// gradient from both would be that of small differences.
const CORNER_SINE: f64 = 0.5;

impl NodeFlux {
    /// What the conditions say of the gradient in coordinates stretched by `stretch`: at a corner all of it, otherwise
    /// its component along the normal.
    pub fn known(&self, stretch: [f64; 2]) -> KnownSlopes {
        let (a, b) = self.sides;
        let sine = b.map_or(0.0, |b| cross(a.normal, b.normal));
        if let Some(b) = b.filter(|_| sine.abs() > CORNER_SINE) {
            let (p, q) = (a.normal.map(|c| c * b.q / sine), b.normal.map(|c| c * a.q / sine));
            let gradient = [q[1] - p[1], p[0] - q[0]];
            return KnownSlopes { slopes: Slopes::Known, gradient: [0, 1].map(|d| gradient[d] / stretch[d]) };
        }
        // One normal for both: at a cusp the second is turned about, since they point away from each other.
        let Side { normal, q } = b.map_or(a, |b| {
            let sign = if dot(a.normal, b.normal) < 0.0 { -1.0 } else { 1.0 };
            Side { normal: [0, 1].map(|d| a.normal[d] + sign * b.normal[d]), q: a.q + sign * b.q }
        });
        // ∂/∂x = stretch_x·∂/∂X, so that n·∇u is a slope across in stretched coordinates too.
        let across = [0, 1].map(|d| stretch[d] * normal[d]);
        let square = dot(across, across);
        let along = [-across[1], across[0]].map(|c| c / square.sqrt());
        KnownSlopes { slopes: Slopes::Along(along), gradient: across.map(|c| c * q / square) }
    }
}

/// All fluxes of a problem.
#[derive(Clone, Debug, Default)]
pub(crate) struct Fluxes {
    /// Over the edges with a flux, by triangle.
    pub edges: Vec<Sample>,
    /// Over the slivers between segments and curves, by triangle: the weak form is integrated over the true section.
    pub slivers: Vec<Sample>,
    /// By node, ascending.
    pub nodes: Vec<NodeFlux>,
}

impl Fluxes {
    /// No flux anywhere.
    pub const NONE: Self = Self { edges: Vec::new(), slivers: Vec::new(), nodes: Vec::new() };

    /// Integrals over the edges that have a flux (`by_edge`, one an edge of the section), and the conditions at the nodes
    /// `free`, ascending, all of whose edges have one.
    ///
    /// # Errors
    /// [`MfdmError::Datum`] where a flux is not finite, [`MfdmError::Curve`] where an edge has no length.
    pub fn new(mesh: &Mesh, section: &Section, by_edge: &[Option<Flux>], free: &[NodeId]) -> Result<Self, MfdmError> {
        let cloud = mesh.cloud();
        let flux_of = |edge: EdgeId| by_edge.get(edge.index()).copied().flatten();
        let mut fluxes = Self::default();
        let mut at_nodes: HashMap<NodeId, NodeFlux> = HashMap::new();
        visit_pieces(
            mesh,
            section,
            |edge| flux_of(edge).is_some(),
            |segment, piece, triangle| {
                let Some(flux) = flux_of(segment.edge) else { return Ok(()) };
                for (_, at, ds) in piece.along() {
                    fluxes.edges.push(Sample { triangle, at, weight: ds * finite(flux, at)? });
                }
                fluxes.slivers.extend(piece.sliver(triangle));
                for (node, s) in [(segment.from, 0.0), (segment.to, 1.0)] {
                    if free.binary_search(&node).is_ok() {
                        let side = Side { normal: piece.normal(s), q: finite(flux, cloud.xy()[node.index()])? };
                        match at_nodes.entry(node) {
                            Entry::Vacant(new) => drop(new.insert(NodeFlux { node, sides: (side, None) })),
                            Entry::Occupied(mut known) => known.get_mut().sides.1 = Some(side),
                        }
                    }
                }
                Ok(())
            },
        )?;
        fluxes.edges.sort_by_key(|sample| sample.triangle);
        fluxes.slivers.sort_by_key(|sample| sample.triangle);
        fluxes.nodes = free.iter().filter_map(|node| at_nodes.get(node).copied()).collect();
        Ok(fluxes)
    }

    /// The condition at a node.
    pub fn of_node(&self, node: NodeId) -> Option<&NodeFlux> {
        self.nodes.binary_search_by_key(&node, |flux| flux.node).ok().map(|k| &self.nodes[k])
    }
}

/// The value of a flux.
fn finite(flux: Flux, at: Point) -> Result<f64, MfdmError> {
    let value = flux(at);
    if value.is_finite() { Ok(value) } else { Err(MfdmError::Datum { quantity: "flux", at, value }) }
}
