//! The weak equation of the constant on each hole: ∮ ∂F/∂n ds = 2GθA in the form ∫∇F·∇v = 2Gθ(∫v + A) \[D12\].

use crate::assembly::Frame;
use crate::element::Element;
use crate::problem::Formulation;
use crate::row_sum::RowSum;
use crate::system::{Equation, SplitRow};
use crate::weak::{Gathered, TestFunction, WeakForm};
use nmt_geom::point::dot;
use nmt_geom::{LoopId, NodeId, TriId};
use nmt_tri::{Mesh, NodeTris};

/// Element layers about a hole in which v is 1, for the local formulation.
///
/// With v on the hole's nodes alone the local solution's error next to the hole, where its equations are weakest, enters
/// in full: 5e-5 instead of 1e-6 for a square with a round hole at 81 across, 1.1e-2 instead of 4e-4 for a thick box.
const LOCAL_LAYERS: usize = 2;

/// The equations of all holes.
///
/// v is linear on each triangle, 1 at the hole's nodes and 0 on every other boundary; in the local formulation it is 1 at
/// all nodes within two element layers of the hole too, in the variational one 0 at all other nodes.
pub(crate) fn hole_equations(frame: &Frame, weak: &WeakForm, formulation: Formulation) -> Vec<Equation> {
    let Frame { mesh, node_tris, roles, .. } = *frame;
    let (mut sum, mut gathered) = (RowSum::new(mesh.cloud().n_nodes()), Gathered::default());
    let equation = |ring: Ring| {
        for &t in ring.triangles.iter().filter(|t| ring.corners_of_one(mesh, **t) != [true; 3]) {
            let element = Element::new(mesh, t);
            weak.add(TestFunction::Linear(&element, ring.slope(mesh, &element)), &mut gathered, &mut sum);
        }
        let n_ones = |t: TriId| ring.corners_of_one(mesh, t).iter().filter(|one| **one).count() as f64;
        let integral = |t: &TriId| mesh.area(*t) * n_ones(*t) / 3.0;
        let rhs = 2.0 * (ring.triangles.iter().map(integral).sum::<f64>() + hole_area(mesh, ring.hole));
        Equation { row: sum.take(roles), rhs }
    };
    (0..roles.n_holes).map(|hole| Ring::new(mesh, node_tris, hole, formulation)).map(equation).collect()
}

/// The left sides of the equations of all holes as linear elements have them, v being 1 on the hole's nodes alone.
pub(crate) fn of_elements(frame: &Frame) -> Vec<SplitRow> {
    let Frame { mesh, node_tris, roles, .. } = *frame;
    let mut sum = RowSum::new(if roles.n_holes == 0 { 0 } else { mesh.cloud().n_nodes() });
    let row = |hole: usize| {
        let ring = Ring::new(mesh, node_tris, hole, Formulation::Fem);
        for &t in &ring.triangles {
            let element = Element::new(mesh, t);
            let slope = ring.slope(mesh, &element);
            let slopes = element.slopes();
            (0..3).for_each(|a| sum.add(element.nodes[a], element.area * dot(slope, slopes[a])));
        }
        sum.take(roles)
    };
    (0..roles.n_holes).map(row).collect()
}

/// The nodes whose polynomials enter the equations of the holes, ascending.
pub(crate) fn nodes_of_equations(frame: &Frame, formulation: Formulation) -> Vec<NodeId> {
    let Frame { mesh, node_tris, roles, .. } = *frame;
    let mut nodes = Vec::new();
    for hole in 0..roles.n_holes {
        let ring = Ring::new(mesh, node_tris, hole, formulation);
        let integrated = ring.triangles.iter().filter(|t| ring.corners_of_one(mesh, **t) != [true; 3]);
        nodes.extend(integrated.flat_map(|t| mesh.tri_nodes()[t.index()]));
    }
    nodes.sort_unstable();
    nodes.dedup();
    nodes
}

/// The v of a hole.
struct Ring {
    hole: usize,
    /// Nodes where v is 1, ascending.
    ones: Vec<NodeId>,
    /// The triangles around them, ascending; ∇v vanishes where v is 1 on the whole triangle.
    triangles: Vec<TriId>,
}

impl Ring {
    fn new(mesh: &Mesh, node_tris: &NodeTris, hole: usize, formulation: Formulation) -> Self {
        let layers = if formulation == Formulation::Local { LOCAL_LAYERS } else { 0 };
        let ones = nodes_of_one(mesh, node_tris, hole, layers);
        let mut triangles: Vec<TriId> = ones.iter().flat_map(|node| node_tris.around(*node)).copied().collect();
        triangles.sort_unstable();
        triangles.dedup();
        Self { hole, ones, triangles }
    }

    /// ∇v on a triangle.
    fn slope(&self, mesh: &Mesh, element: &Element) -> [f64; 2] {
        let (of_one, slopes) = (self.corners_of_one(mesh, element.triangle), element.slopes());
        [0, 1].map(|d| (0..3).filter(|a| of_one[*a]).map(|a| slopes[a][d]).sum())
    }

    fn corners_of_one(&self, mesh: &Mesh, triangle: TriId) -> [bool; 3] {
        mesh.tri_nodes()[triangle.index()].map(|node| self.ones.binary_search(&node).is_ok())
    }
}

/// Area of the polygon through a hole's nodes, user's length unit squared.
pub(crate) fn hole_area(mesh: &Mesh, hole: usize) -> f64 {
    mesh.cloud().boundary().loop_area(LoopId::of(hole + 1))
}

/// The hole's nodes and the interior ones within `layers` triangles of them, ascending.
fn nodes_of_one(mesh: &Mesh, node_tris: &NodeTris, hole: usize, layers: usize) -> Vec<NodeId> {
    let n_boundary = mesh.cloud().n_boundary();
    let segments = mesh.cloud().boundary().loop_segments(LoopId::of(hole + 1));
    let mut ones: Vec<NodeId> = segments.iter().map(|s| s.from).collect();
    ones.sort_unstable();
    let mut front = ones.clone();
    for _ in 0..layers {
        let mut next: Vec<NodeId> = front
            .iter()
            .flat_map(|node| node_tris.around(*node))
            .flat_map(|t| mesh.tri_nodes()[t.index()])
            .filter(|node| node.index() >= n_boundary && ones.binary_search(node).is_err())
            .collect();
        next.sort_unstable();
        next.dedup();
        ones.extend(&next);
        ones.sort_unstable();
        front = next;
    }
    ones
}
