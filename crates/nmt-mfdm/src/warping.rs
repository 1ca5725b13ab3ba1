//! The warping function: torsion by displacements, beside the stress function and independent of it.
//!
//! σ = −(r − r₀) + rot w, with rot w = (∂w/∂y, −∂w/∂x), has the divergence −2 of ∇F (Gθ = 1) and the circulation
//! 2A around every hole, whatever w is. The w for which ∇²w = 0 and ∂w/∂n = x n_y − y n_x makes it ∇F. Its problem has fluxes on
//! all edges and no constants of holes. Where F is 0 on a hole instead, σ has an [`Outflow`] q there, and ∂w/∂n also −q×n.

use crate::blend::NodalPolynomials;
use crate::boundary_value::{Discrete, nodal_solution};
use crate::error::MfdmError;
use crate::flux::Fluxes;
use crate::lanes::Lanes;
use crate::operator::Operator;
use crate::outflow::Outflow;
use crate::params::SolveParams;
use crate::problem::{Formulation, Test, Trial};
use crate::quadrature::RuleLanes;
use crate::solution::TorsionSolution;
use crate::solve::Event;
use crate::solver::LinearSolve;
use crate::source::Source;
use crate::system::NodeCondition;
use crate::true_edges::{Sample, visit_pieces};
use nmt_cloud::Section;
use nmt_geom::point::{cross, sub};
use nmt_geom::{NodeId, Point, TriId};
use nmt_tri::Mesh;
use std::array::from_fn;

/// The relative residual of the linear system that is good enough: any w gives a bound, and what is left enters it squared.
const TARGET: f64 = 1.0e-7;

/// The warping function of a section at the nodes of its mesh.
pub(crate) struct NodalWarping {
    /// w, shape (n_nodes,).
    pub values: Vec<f64>,
    frame: StressFrame,
    linear: LinearSolve,
}

/// What stresses have beside the warping function.
pub(crate) struct StressFrame {
    /// r₀.
    centre: Point,
    /// Of the holes on which F = 0.
    outflows: Vec<Outflow>,
}

/// How the warping function is found beside the solution of torsion with `params`: in the variational form, blends and hats,
/// of the same order, at least 2.
pub(crate) fn warping_params(params: &SolveParams) -> SolveParams {
    SolveParams {
        formulation: Formulation::Variational,
        order: params.order_used().max(2),
        trial: Trial::Blended,
        test: Test::Hat,
        smoothing: 0.0,
        star: None,
        gauss: None,
        ..*params
    }
}

/// How it is found where that leaves J in doubt: by linear finite elements, whose w is never much worse than the mesh.
pub(crate) fn elements_params(params: &SolveParams) -> SolveParams {
    SolveParams { formulation: Formulation::Fem, ..warping_params(params) }
}

impl StressFrame {
    /// That of a section whose holes have their circulation, which `mesh` meshes.
    pub fn of_circulation(mesh: &Mesh) -> Self {
        Self { centre: mesh.centroid(), outflows: Vec::new() }
    }

    /// That of a `solution`, with outflows of the holes on which F = 0.
    pub fn of(mesh: &Mesh, solution: &TorsionSolution) -> Self {
        Self { centre: mesh.centroid(), outflows: Outflow::of_holes(mesh, solution) }
    }

    /// σ at `p` where w = 0.
    fn stress(&self, p: Point) -> Point {
        let [x, y] = sub(p, self.centre);
        let add = |[a, b]: Point, [c, d]: Point| [a + c, b + d];
        self.outflows.iter().map(|outflow| outflow.field(p)).fold([-x, -y], add)
    }

    /// Whether it changes within a triangle by more than a rule sees.
    pub fn is_steep(&self, corners: [Point; 3]) -> bool {
        self.outflows.iter().any(|outflow| outflow.is_near(corners))
    }

    /// [`Self::stress`] at four places.
    fn stress_at(&self, [x, y]: [Lanes; 2]) -> [Lanes; 2] {
        let about = [Lanes::all(self.centre[0]) - x, Lanes::all(self.centre[1]) - y];
        let add = |[a, b]: [Lanes; 2], [c, d]: [Lanes; 2]| [a + c, b + d];
        self.outflows.iter().map(|outflow| outflow.field_at([x, y])).fold(about, add)
    }
}

impl NodalWarping {
    /// Solves for w in a `frame` with [`warping_params`] or [`elements_params`], its equations taken over from the `operator` of the
    /// stress function where that has the same.
    ///
    /// w is known up to a constant: it is 0 at the first vertex.
    ///
    /// # Errors
    /// As [`crate::solve`]; [`MfdmError::Curve`] where an edge has no length.
    pub fn solve(
        mesh: &Mesh,
        section: &Section,
        frame: StressFrame,
        params: &SolveParams,
        operator: Option<Operator>,
        observer: &mut dyn FnMut(Event),
    ) -> Result<Self, MfdmError> {
        let mut fluxes = Fluxes::default();
        visit_pieces(
            mesh,
            section,
            |_| true,
            |_, piece, triangle| {
                for (s, at, ds) in piece.along() {
                    let q = -cross(frame.stress(at), piece.normal(s));
                    fluxes.edges.push(Sample { triangle, at, weight: ds * q });
                }
                fluxes.slivers.extend(piece.sliver(triangle));
                Ok(())
            },
        )?;
        fluxes.edges.sort_by_key(|sample| sample.triangle);
        fluxes.slivers.sort_by_key(|sample| sample.triangle);
        let mut conditions = vec![NodeCondition::Flux; mesh.cloud().n_boundary()];
        conditions[0] = NodeCondition::Value(0.0);
        let discrete = Discrete { mesh, conditions, source: Source::Constant(0.0), fluxes: &fluxes, target: TARGET };
        let (nodal, _) = nodal_solution(discrete, params, operator, observer)?;
        Ok(Self { values: nodal.values, frame, linear: nodal.linear })
    }

    /// Its stresses, from the field through its values.
    pub fn with_field(self, field: NodalPolynomials) -> Warping {
        Warping { field, frame: self.frame, linear: self.linear }
    }
}

/// The warping function of a section, made a field.
pub(crate) struct Warping {
    /// w.
    pub field: NodalPolynomials,
    pub frame: StressFrame,
    /// How the linear system was solved.
    pub linear: LinearSolve,
}

impl Warping {
    /// Its stresses.
    pub fn stresses(&self) -> Stresses<'_> {
        Stresses { field: &self.field, frame: &self.frame }
    }
}

/// σ of a warping function.
#[derive(Clone, Copy)]
pub(crate) struct Stresses<'a> {
    /// w.
    pub field: &'a NodalPolynomials,
    pub frame: &'a StressFrame,
}

impl Stresses<'_> {
    /// σ at `p` in `triangle`.
    pub fn at(&self, mesh: &Mesh, triangle: TriId, p: Point) -> [f64; 2] {
        self.with_rotation(p, self.field.slope(mesh, triangle, p).1)
    }

    /// σ at the points of a rule on `triangle`.
    pub fn at_rule(&self, mesh: &Mesh, triangle: TriId, rule: &RuleLanes) -> [[Lanes; 2]; 2] {
        let places = rule.places(mesh.corners(triangle));
        let w = self.field.slopes_at(mesh, triangle, rule);
        from_fn(|k| {
            let [x, y] = self.frame.stress_at(places[k]);
            [x + w[k].gradient[1], y - w[k].gradient[0]]
        })
    }

    /// σ at a node, of its own polynomial.
    pub fn at_node(&self, mesh: &Mesh, node: NodeId) -> [f64; 2] {
        self.with_rotation(mesh.xy()[node.index()], self.field.at_node(node).gradient)
    }

    fn with_rotation(&self, p: Point, [w_x, w_y]: [f64; 2]) -> [f64; 2] {
        let [x, y] = self.frame.stress(p);
        [x + w_y, y - w_x]
    }
}
