//! What the report says of a Poisson problem.

use crate::pipeline::{PoissonErrors, PoissonPart};
use crate::problem::Formula;
use crate::report::linear::LinearSolverReport;
use crate::report::stars::{StarsReport, VariationalReport};
use nmt_curve::{ArcTable, Curve};
use nmt_geom::Point;
use nmt_mfdm::ErrorNorms;
use serde::Serialize;

/// Pieces of equal arc length that a flux is integrated over, each by the rule of [`GAUSS`]: a smooth q to rounding.
const PIECES: usize = 64;

/// Points and weights of the Gauss–Legendre rule of three points on [0, 1].
const GAUSS: [[f64; 2]; 3] =
    [[0.112_701_665_379_258_31, 5.0 / 18.0], [0.5, 4.0 / 9.0], [0.887_298_334_620_741_7, 5.0 / 18.0]];

/// The solution of a Poisson problem in one subdomain.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PoissonReport {
    /// "poisson".
    pub problem: &'static str,
    /// f of ∇²u = f.
    pub source: String,
    /// g on the edges without a flux.
    pub boundary: String,
    /// The exact u, where it is given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub exact: Option<String>,
    /// Formulation.
    pub formulation: &'static str,
    /// Order p of the equations; of finite elements 1.
    pub order: usize,
    /// Trial and test functions and Gauss points of the variational formulation.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    pub variational: Option<VariationalReport>,
    /// One entry an edge with a flux.
    pub fluxes: Vec<FluxReport>,
    /// Number of unknowns.
    pub unknowns: usize,
    /// Smallest u at nodes.
    pub u_min: f64,
    /// Where.
    pub u_min_at: Point,
    /// Largest u at nodes.
    pub u_max: f64,
    /// Where.
    pub u_max_at: Point,
    /// Against the exact u, where it is given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub errors: Option<ErrorReport>,
    /// ‖b − Ax‖/‖b‖.
    pub linear_residual: f64,
    /// How the linear system was solved.
    pub linear_solver: LinearSolverReport,
    /// What became of the stars; absent for finite elements, which have none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stars: Option<StarsReport>,
}

/// An edge with a flux.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FluxReport {
    /// Its name.
    pub edge: String,
    /// q of ∂u/∂n = q, n outward.
    pub neumann: String,
    /// ∫q ds over the true edge; `null` where q is too large for that.
    pub integral: Option<f64>,
}

/// How far a solution is from the exact one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ErrorReport {
    /// Largest |u_h − u| at nodes.
    pub max: f64,
    /// The same over the largest |u|; `null` where u = 0.
    pub max_relative: Option<f64>,
    /// (∫(u_h − u)²)^½ of the recovered field.
    pub l2: f64,
    /// The same over (∫u²)^½.
    pub l2_relative: Option<f64>,
    /// Largest |∇u_h − ∇u| at nodes; `null`, like those below, where the exact gradient is infinite somewhere.
    pub gradient_max: Option<f64>,
    /// (∫|∇u_h − ∇u|²)^½, the H¹ seminorm of the error.
    pub h1: Option<f64>,
    /// The same over (∫|∇u|²)^½.
    pub h1_relative: Option<f64>,
}

impl PoissonReport {
    pub(super) fn of(solved: &PoissonPart) -> Self {
        let PoissonPart { part, params, solution, data, errors } = solved;
        let text = |formula: &Formula| formula.text().to_owned();
        let curves = part.section.loops().flat_map(|outline| &outline.edges);
        let flux = |((edge, name), flux): ((&nmt_curve::OutlineEdge, &String), &Option<Formula>)| {
            let q = flux.as_ref()?;
            Some(FluxReport { edge: name.clone(), neumann: text(q), integral: integral(&edge.curve, q) })
        };
        let (mut least, mut most) = (0, 0);
        for (node, u) in solution.u.iter().enumerate() {
            least = if *u < solution.u[least] { node } else { least };
            most = if *u > solution.u[most] { node } else { most };
        }
        Self {
            problem: "poisson",
            source: text(&data.settings.source),
            boundary: data.settings.boundary.as_ref().map_or("0".into(), text),
            exact: data.settings.exact.as_ref().map(text),
            formulation: params.formulation.name(),
            order: params.order_used(),
            variational: VariationalReport::of(params),
            fluxes: curves.zip(&part.edge_names).zip(&data.fluxes).filter_map(flux).collect(),
            unknowns: solution.unknowns,
            u_min: solution.u[least],
            u_min_at: part.mesh.xy()[least],
            u_max: solution.u[most],
            u_max_at: part.mesh.xy()[most],
            errors: errors.as_ref().map(ErrorReport::of),
            linear_residual: solution.linear.residual,
            linear_solver: LinearSolverReport::of(&solution.linear),
            stars: StarsReport::of(params, &solution.stars),
        }
    }
}

impl ErrorReport {
    fn of(errors: &PoissonErrors) -> Self {
        let relative = |error: f64, size: f64| (size > 0.0).then(|| error / size);
        let PoissonErrors { value: ErrorNorms { max, l2, scale, l2_scale }, gradient, .. } = errors;
        Self {
            max: *max,
            max_relative: relative(*max, *scale),
            l2: *l2,
            l2_relative: relative(*l2, *l2_scale),
            gradient_max: gradient.map(|g| g.max),
            h1: gradient.map(|g| g.l2),
            h1_relative: gradient.and_then(|g| relative(g.l2, g.l2_scale)),
        }
    }
}

/// ∫q ds over an edge.
fn integral(curve: &Curve, q: &Formula) -> Option<f64> {
    let table = ArcTable::new(curve).ok()?;
    let step = table.length() / PIECES as f64;
    let samples = (0..PIECES).flat_map(|k| GAUSS.map(|[at, weight]| [(k as f64 + at) * step, weight * step]));
    let sum: f64 = samples.map(|[s, weight]| weight * q.at(table.point_at(s))).sum();
    Some(sum).filter(|sum| sum.is_finite())
}
