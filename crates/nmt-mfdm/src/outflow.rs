//! What flows out of holes on which F = 0: sources within them, beside the warping function.
//!
//! The stresses of [`crate::warping`] have the circulation that belongs to a hole whose constant is free. Where F is 0 on the
//! hole, ∇F has another flow through its edge; sources within the hole make up for it, without divergence in the material. They
//! are as far from the edge as they can be, and many in a long hole: what they do at the edge, the warping function has to undo.

use crate::blend::{NodalPolynomials, gradient_of_plane};
use crate::circulation::hole_area;
use crate::gauss::six_points;
use crate::lanes::Lanes;
use crate::problem::HoleCondition;
use crate::quadrature::RuleLanes;
use crate::solution::TorsionSolution;
use nmt_geom::point::{dot, sub};
use nmt_geom::ring::inner_points;
use nmt_geom::{LoopId, NodeId, Point, TriId};
use nmt_tri::{Mesh, NodeTris};
use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::TAU;

/// Layers of triangles about a hole over which its flow is averaged, at most. Beside the corners of a hole the recovered ∇F is at its
/// worst: taken on the edge alone, the flow is so far off that it makes most of the estimate.
const MOST_LAYERS: u32 = 50;

/// Longest sides of a triangle.
const NEAR: f64 = 1.5;

/// The field strength·(r − at)/|r − at|² of a source, of which 2π·strength flows out of its hole.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Outflow {
    at: Point,
    strength: f64, // length², for Gθ = 1
}

impl Outflow {
    /// Those of the holes on which F = 0 in `solution`.
    pub fn of_holes(mesh: &Mesh, solution: &TorsionSolution) -> Vec<Self> {
        let is_zero = |hole: &usize| solution.holes[*hole].condition == HoleCondition::Zero;
        let holes: Vec<usize> = (0..solution.holes.len()).filter(is_zero).collect();
        if holes.is_empty() {
            return Vec::new();
        }
        let node_tris = NodeTris::new(mesh.cloud().n_nodes(), mesh.tri_nodes());
        let of_hole = |hole: usize| {
            let nodes = nodes_of(mesh, hole);
            let ramp = Ramp::new(mesh, &node_tris, &nodes);
            // ∇F and −(r − r₀) have the same divergence: any line around the hole would do.
            let flow = ramp.flow(mesh, &node_tris, &solution.field, solution.g_theta);
            let lacking = flow + 2.0 * hole_area(mesh, hole);
            let within = inner_points(&nodes.iter().map(|node| mesh.xy()[node.index()]).collect::<Vec<_>>());
            // Each stands for as much of the edge as it is deep.
            let a_depth = lacking / (TAU * within.iter().map(|point| point.depth).sum::<f64>());
            within.into_iter().map(move |point| Self { at: point.at, strength: a_depth * point.depth })
        };
        holes.into_iter().flat_map(of_hole).collect()
    }

    /// Whether it is nearer to a triangle's centre than [`NEAR`] of the longest side: its field changes there by more than a rule
    /// sees.
    pub fn is_near(&self, [a, b, c]: [Point; 3]) -> bool {
        let longest = [sub(b, a), sub(c, b), sub(a, c)].map(|side| dot(side, side)).into_iter().fold(0.0, f64::max);
        let to_centre = sub([0, 1].map(|d| (a[d] + b[d] + c[d]) / 3.0), self.at);
        dot(to_centre, to_centre) < NEAR * NEAR * longest
    }

    /// Its field at a place.
    pub fn field(&self, p: Point) -> Point {
        let offset = sub(p, self.at);
        let factor = self.strength / dot(offset, offset);
        offset.map(|c| factor * c)
    }

    /// Its field at four places.
    pub fn field_at(&self, [x, y]: [Lanes; 2]) -> [Lanes; 2] {
        let (x, y) = (x - Lanes::all(self.at[0]), y - Lanes::all(self.at[1]));
        let factor = Lanes::all(self.strength) / (x * x + y * y);
        [x * factor, y * factor]
    }
}

/// The nodes of a hole in their order.
fn nodes_of(mesh: &Mesh, hole: usize) -> Vec<NodeId> {
    mesh.cloud().boundary().loop_segments(LoopId::of(hole + 1)).iter().map(|segment| segment.from).collect()
}

/// A function that is 1 on a hole's nodes, falls by the same step from one layer of nodes about it to the next, and is 0 on every
/// other boundary.
struct Ramp(BTreeMap<NodeId, f64>);

impl Ramp {
    fn new(mesh: &Mesh, node_tris: &NodeTris, hole: &[NodeId]) -> Self {
        let mut layers: BTreeMap<NodeId, u32> = hole.iter().map(|node| (*node, 0)).collect();
        let (mut front, mut n_layers): (Vec<NodeId>, u32) = (hole.to_vec(), 1);
        while n_layers < MOST_LAYERS {
            let triangles = front.iter().flat_map(|node| node_tris.around(*node));
            let around: BTreeSet<NodeId> = triangles.flat_map(|t| mesh.tri_nodes()[t.index()]).collect();
            front = around.into_iter().filter(|node| !layers.contains_key(node)).collect();
            if front.is_empty() || front.iter().any(|node| node.index() < mesh.cloud().n_boundary()) {
                break;
            }
            layers.extend(front.iter().map(|node| (*node, n_layers)));
            n_layers += 1;
        }
        let height = |layer: u32| 1.0 - f64::from(layer) / f64::from(n_layers);
        Self(layers.into_iter().map(|(node, layer)| (node, height(layer))).collect())
    }

    /// −∫∇F·∇v + 2∫v of the ramp v, what flows out of the hole for Gθ = 1; F is the field over `g_theta`.
    fn flow(&self, mesh: &Mesh, node_tris: &NodeTris, field: &NodalPolynomials, g_theta: f64) -> f64 {
        let triangles: BTreeSet<TriId> = self.0.keys().flat_map(|node| node_tris.around(*node)).copied().collect();
        let rule = RuleLanes::from(&six_points());
        let through = |t: TriId| {
            let height = |node: NodeId| self.0.get(&node).copied().unwrap_or(0.0);
            let slope = gradient_of_plane(mesh, t, height);
            let mut sum = Lanes::default();
            for (four, weight) in field.slopes_at(mesh, t, &rule).iter().zip(rule.weights) {
                sum += weight * (four.gradient[0] * slope[0] + four.gradient[1] * slope[1]);
            }
            let heights = mesh.tri_nodes()[t.index()].map(height);
            mesh.area(t) * (2.0 * heights.iter().sum::<f64>() / 3.0 - sum.sum() / g_theta)
        };
        triangles.into_iter().map(through).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{SolveParams, TorsionProblem, solve};
    use nmt_cloud::{CloudParams, Section, generate};
    use nmt_curve::Outline;

    #[test]
    fn the_sources_of_a_tube_are_its_logarithm() -> Result<(), Box<dyn std::error::Error>> {
        let (a, b) = (0.5f64, 1.0f64);
        let tube = Section { contour: Outline::circle([3.0, 1.0], b), holes: vec![Outline::circle([3.0, 1.0], a)] };
        let params = CloudParams { nodes: [41, 41], irregularity: 0.3, ..CloudParams::default() };
        let mesh = Mesh::constrained(generate(&tube, &params)?)?;
        let problem = TorsionProblem { holes: HoleCondition::Zero, shear_modulus: 7.0, ..TorsionProblem::default() };
        let solution = solve(&problem, &mesh, &SolveParams::default())?;
        let outflows = Outflow::of_holes(&mesh, &solution);
        // F = (b² − r²)/2 + A·ln(r/b) for Gθ = 1, 0 at both radii.
        let exact = (b * b - a * a) / (2.0 * (b / a).ln());
        let sum: f64 = outflows.iter().map(|outflow| outflow.strength).sum();
        assert!((sum - exact).abs() < 1e-4 * exact, "{sum} {exact}"); // 2e-5 measured
        for p in [[3.6, 1.0], [2.5, 0.2]] {
            let [x, y] = p.map(Lanes::all);
            let add = |a: Point, b: Point| [a[0] + b[0], a[1] + b[1]];
            let field = outflows.iter().map(|outflow| outflow.field(p)).fold([0.0; 2], add);
            let lanes = outflows.iter().map(|outflow| outflow.field_at([x, y]).map(|c| c.0[2])).fold([0.0; 2], add);
            assert_eq!(field, lanes);
            let offset = sub(p, [3.0, 1.0]);
            let expected = offset.map(|c| exact * c / dot(offset, offset));
            assert!((0..2).all(|d| (field[d] - expected[d]).abs() < 0.02), "{field:?} {expected:?}"); // of the polygon's middle
        }
        let solution = solve(&TorsionProblem::default(), &mesh, &SolveParams::default())?;
        assert!(Outflow::of_holes(&mesh, &solution).is_empty(), "holes with circulation have none");
        Ok(())
    }
}
