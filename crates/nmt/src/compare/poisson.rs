//! The rows of a Poisson problem: how near u comes to the exact one or, without it, to the best of them.

use super::{Method, Outcome, Row, methods};
use crate::error::NmtError;
use crate::pipeline::{MeshPart, PoissonErrors, solve_on};
use crate::problem::{PoissonSettings, Problem, Subdomain};
use nmt_mfdm::{MfdmError, PoissonSolution};
use serde::Serialize;

/// An integral below this share of area times largest |u| is what is left where u cancels: relative to that, every method
/// would be far off.
const CANCELS_REL: f64 = 1.0e-3;

/// What is compared of a Poisson problem; relative numbers are `None` where there is nothing to divide by.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PoissonFigures {
    /// Number of equations.
    pub unknowns: usize,
    /// ∫u over the mesh.
    pub integral: f64,
    /// (∫(u_h − u)²)^½/(∫u²)^½ of the recovered field, where the exact u is given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub l2_error: Option<f64>,
    /// Largest |u_h − u| at nodes over the largest |u|, where the exact u is given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_error: Option<f64>,
    /// ∫u over that of the reference, less 1, where no exact u is given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub integral_difference: Option<f64>,
    /// Largest difference of u at nodes from that of the reference, over its largest |u|, where no exact u is given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_difference: Option<f64>,
    /// Stars whose polynomial is of a lower order than asked for: too few nodes, or badly placed ones.
    pub order_lowered: usize,
}

/// One method's solution with its errors, or why there is none.
type Solved = Result<(PoissonSolution, Option<PoissonErrors>), MfdmError>;

/// A subdomain by every method.
pub(super) fn rows(
    problem: &Problem,
    subdomain: &Subdomain,
    settings: &PoissonSettings,
    part: &MeshPart,
    clock: &mut dyn FnMut(&Method) -> f64,
) -> Result<Vec<Row>, NmtError> {
    let mut runs: Vec<(Method, Solved, f64)> = Vec::with_capacity(methods().len());
    for method in methods() {
        let start = clock(&method);
        let solved = match solve_on(problem, subdomain, settings, (part, &method.params()), &mut |_| {}) {
            Ok(solved) => Ok(solved),
            Err(NmtError::Solve { source, .. }) => Err(source),
            // A fault of the data is one for every method.
            Err(other) => return Err(other),
        };
        runs.push((method, solved, clock(&method) - start));
    }
    let best =
        runs.iter().find(|(method, ..)| *method == Method::REFERENCE).and_then(|(_, solved, _)| solved.as_ref().ok());
    let row = |(method, solved, seconds): &(Method, Solved, f64)| {
        let outcome = match solved {
            Ok((solution, errors)) => Outcome::Poisson(figures(solution, errors.as_ref(), best.map(|(u, _)| u), part)),
            Err(error) => Outcome::Failed { error: error.to_string() },
        };
        Row::new(*method, part, subdomain.nodes, outcome, *seconds)
    };
    Ok(runs.iter().map(row).collect())
}

fn figures(
    solution: &PoissonSolution,
    errors: Option<&PoissonErrors>,
    best: Option<&PoissonSolution>,
    part: &MeshPart,
) -> PoissonFigures {
    let over = |value: f64, size: f64| (size > 0.0).then(|| value / size).filter(|share| share.is_finite());
    let integral = solution.field.volume(&part.mesh);
    let best = best.filter(|_| errors.is_none());
    let largest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, |most: f64, v| most.max(v.abs()));
    let size = best.map_or(0.0, |best| largest(&mut best.u.iter().copied()));
    let area: f64 = part.mesh.triangles().map(|t| part.mesh.area(t)).sum();
    let of_best = best.map(|best| best.field.volume(&part.mesh)).filter(|v| v.abs() > CANCELS_REL * area * size);
    let apart = best.map(|best| largest(&mut solution.u.iter().zip(&best.u).map(|(u, v)| u - v)));
    PoissonFigures {
        unknowns: solution.unknowns,
        integral,
        l2_error: errors.and_then(|errors| over(errors.value.l2, errors.value.l2_scale)),
        max_error: errors.and_then(|errors| over(errors.value.max, errors.value.scale)),
        integral_difference: of_best.map(|of_best| integral / of_best - 1.0),
        max_difference: apart.and_then(|apart| over(apart, size)),
        order_lowered: solution.stars.order_lowered,
    }
}
