//! The largest F and the largest τ, and where.

use crate::blend::NodalPolynomials;
use crate::post::stress::Stress;
use nmt_geom::{NodeId, Point};
use nmt_tri::Mesh;

/// Values that agree within this fraction are one maximum, and the smallest node number has it: symmetric sections have
/// several, whose values differ by rounding alone.
const SAME_VALUE_REL: f64 = 1.0e-9;

/// A largest value and its place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extreme {
    /// The value.
    pub value: f64,
    /// Where.
    pub at: Point,
    /// The node it was found at.
    pub node: NodeId,
}

/// The extremes of a solution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extremes {
    /// Largest |F| over nodes (its sign kept), refined by one Newton step.
    pub f_max: Extreme,
    /// Largest τ over nodes.
    pub tau_max: Extreme,
}

/// The largest F and τ of a field.
///
/// A negative twist turns every sign: the largest |F| is then the most negative F.
pub fn extremes(mesh: &Mesh, field: &NodalPolynomials) -> Extremes {
    let nodes = || (0..mesh.cloud().n_nodes()).map(NodeId::of);
    let f_node = largest(nodes().map(|node| field.at_node(node).value.abs()));
    let tau = |node: NodeId| Stress::of_gradient(field.at_node(node).gradient).magnitude();
    let tau_node = largest(nodes().map(tau));
    let tau_max = Extreme { value: tau(tau_node), at: mesh.xy()[tau_node.index()], node: tau_node };
    Extremes { f_max: newton(mesh, field, f_node), tau_max }
}

fn largest(values: impl Iterator<Item = f64>) -> NodeId {
    let (mut best, mut at) = (f64::NEG_INFINITY, 0);
    for (node, value) in values.enumerate() {
        if value > best + SAME_VALUE_REL * best.abs() || best == f64::NEG_INFINITY {
            (best, at) = (value, node);
        }
    }
    NodeId::of(at)
}

/// One Newton step on the node's polynomial towards the maximum, where the node is interior, the Hessian definite and the
/// step at most the local spacing; otherwise the node itself.
fn newton(mesh: &Mesh, field: &NodalPolynomials, node: NodeId) -> Extreme {
    let at = mesh.xy()[node.index()];
    let here = field.at_node(node);
    let unmoved = Extreme { value: here.value, at, node };
    let [xx, xy, yy] = field.hessian_at_node(node);
    let determinant = xx * yy - xy * xy;
    // Definite: of one sign, against F's.
    if node.index() < mesh.cloud().n_boundary() || determinant <= 0.0 || xx * here.value >= 0.0 {
        return unmoved;
    }
    let [g_x, g_y] = here.gradient;
    let step = [-(yy * g_x - xy * g_y) / determinant, -(xx * g_y - xy * g_x) / determinant];
    if step[0].hypot(step[1]) > mesh.cloud().local_spacing(node) {
        return unmoved;
    }
    let top = [at[0] + step[0], at[1] + step[1]];
    Extreme { value: field.polynomial(node, at, top).value, at: top, node }
}
