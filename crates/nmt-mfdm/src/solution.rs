//! What a solution holds: nodal values, the recovered field, results, diagnostics.

use crate::blend::{FieldValue, NodalPolynomials};
use crate::diagnostics::UsedStars;
use crate::post::{Extreme, Stress};
use crate::problem::HoleCondition;
use crate::solver::LinearSolve;
use crate::stencils::StarReport;
use nmt_geom::{NodeId, Point};
use nmt_tri::{Mesh, TriangleIndex};

/// The Prandtl problem solved: everything is scaled by the Gθ of the problem.
///
/// Units follow the user's: F is stress × length, τ stress, J length⁴, torque stress × length³.
#[derive(Clone, Debug, PartialEq)]
pub struct TorsionSolution {
    /// F at the nodes, shape (n_nodes,).
    pub f: Vec<f64>,
    /// The recovered field: nodal polynomials of one order more than the equations', to be blended \[D14\].
    pub field: NodalPolynomials,
    /// Each hole's condition and constant.
    pub holes: Vec<HoleResult>,
    /// Torsion constant J = T/(Gθ); under [`HoleCondition::Zero`] with a hole just 2∫F/(Gθ).
    pub j: f64,
    /// T = 2∫F + 2Σc_kA_k.
    pub torque: f64,
    /// θ, twist per unit length.
    pub twist: f64,
    /// Gθ.
    pub g_theta: f64,
    /// W_t = |T|/τ_max, length³.
    pub w_t: f64,
    /// Largest F, with one Newton step from the node.
    pub f_max: Extreme,
    /// Largest τ over all nodes.
    pub tau_max: Extreme,
    /// Interior nodes + holes under circulation.
    pub unknowns: usize,
    /// How the linear system was solved.
    pub linear: LinearSolve,
    /// What became of the stars of the equations.
    pub stars: StarReport,
    /// What became of the stars of the recovery.
    pub recovery_stars: StarReport,
    /// The star of each node in the equations, to be looked at.
    pub used_stars: UsedStars,
}

/// One hole in a solution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HoleResult {
    /// What holds on it.
    pub condition: HoleCondition,
    /// F on it: its constant, or 0.
    pub f: f64,
    /// Area of the polygon through its nodes.
    pub area: f64,
}

impl TorsionSolution {
    /// τ at a node, from the node's own polynomial (16).
    pub fn stress_at_node(&self, node: NodeId) -> Stress {
        Stress::of_gradient(self.field.at_node(node).gradient)
    }

    /// F and its derivatives at a point: the blend on the triangle that holds it; `None` where none does within
    /// `tolerance` (user's length unit).
    pub fn at(&self, mesh: &Mesh, index: &TriangleIndex, p: Point, tolerance: f64) -> Option<FieldValue> {
        index.locate(p, tolerance).map(|triangle| self.field.blend(mesh, triangle, p))
    }
}
