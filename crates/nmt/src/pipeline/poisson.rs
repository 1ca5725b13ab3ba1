//! The last stage of a Poisson problem: ∇²u = f in every subdomain, each alone.

use super::{MeshPart, Observer, elimination_fault, of_solution};
use crate::error::NmtError;
use crate::problem::{Formula, Place, PoissonSettings, Problem, ProblemError, Subdomain};
use nmt_geom::{NodeId, Point};
use nmt_mfdm::{ErrorNorms, MfdmError, PoissonProblem, PoissonSolution, SolveParams, solve_poisson_observed};

/// One subdomain of a Poisson problem solved.
#[derive(Clone, Debug)]
pub struct PoissonPart {
    /// The subdomain with its mesh.
    pub part: MeshPart,
    /// How it was solved: formulation, order, stars.
    pub params: SolveParams,
    /// The solution.
    pub solution: PoissonSolution,
    /// What it was solved from.
    pub data: PoissonData,
    /// How near it comes to the exact solution, where that is given.
    pub errors: Option<PoissonErrors>,
}

/// The data of one subdomain.
#[derive(Clone, Debug)]
pub struct PoissonData {
    /// f, g and the exact u.
    pub settings: PoissonSettings,
    /// ∂u/∂n on each edge, by [`nmt_geom::EdgeId`]; `None` where u = g.
    pub fluxes: Vec<Option<Formula>>,
}

/// A solution against the exact one.
#[derive(Clone, Debug, PartialEq)]
pub struct PoissonErrors {
    /// The exact u at the nodes, shape (n_nodes,).
    pub exact: Vec<f64>,
    /// Errors of u.
    pub value: ErrorNorms,
    /// Errors of ∇u; `None` where the exact gradient is infinite somewhere.
    pub gradient: Option<ErrorNorms>,
}

impl PoissonPart {
    /// ∇u at the nodes, from each node's own polynomial, shape (n_nodes, 2).
    pub fn gradients(&self) -> Vec<[f64; 2]> {
        (0..self.solution.u.len()).map(|node| self.solution.field.at_node(NodeId::of(node)).gradient).collect()
    }

    /// u less the exact u at the nodes, where that is given.
    pub fn error_at_nodes(&self) -> Option<Vec<f64>> {
        let errors = self.errors.as_ref()?;
        Some(self.solution.u.iter().zip(&errors.exact).map(|(u, exact)| u - exact).collect())
    }
}

/// Solutions of all subdomains of a Poisson problem, each alone: nothing joins them along common edges.
///
/// # Errors
/// [`NmtError::Problem`] where a formula is not finite, the problem is one of torsion, or steps of elimination are left out
/// and the mesh is not sound without them; [`NmtError::Solve`] where the numerics fail.
pub fn poisson_solutions(
    problem: &Problem,
    meshes: Vec<MeshPart>,
    observer: &mut Observer,
) -> Result<Vec<PoissonPart>, NmtError> {
    let Some(settings) = &problem.solve.poisson else {
        let message = "the problem has no `source`, and is one of torsion";
        let remedy = "give source = \"f(x, y)\" in [solve], or solve it as torsion";
        return Err(NmtError::Problem(vec![problem.source.error(&Place::File(0..0), "", message, remedy)]));
    };
    if let Some(fault) = meshes.iter().find_map(|part| elimination_fault(problem, part)) {
        return Err(NmtError::Problem(vec![fault]));
    }
    let solve = |(k, part): (usize, MeshPart)| {
        let subdomain = &problem.subdomains[k];
        solve_part(problem, subdomain, settings, part, &mut of_solution(k, observer))
    };
    meshes.into_iter().enumerate().map(solve).collect()
}

fn solve_part(
    problem: &Problem,
    subdomain: &Subdomain,
    settings: &PoissonSettings,
    part: MeshPart,
    observer: &mut dyn FnMut(nmt_mfdm::Event),
) -> Result<PoissonPart, NmtError> {
    let params = problem.solve.params(subdomain.formulation);
    let (solution, errors) = solve_on(problem, subdomain, settings, (&part, &params), observer)?;
    let data = PoissonData { settings: settings.clone(), fluxes: subdomain.fluxes.clone() };
    Ok(PoissonPart { part, params, solution, data, errors })
}

/// The solution on one mesh, and its errors where the exact solution is given.
pub(crate) fn solve_on(
    problem: &Problem,
    subdomain: &Subdomain,
    settings: &PoissonSettings,
    (part, params): (&MeshPart, &SolveParams),
    observer: &mut dyn FnMut(nmt_mfdm::Event),
) -> Result<(PoissonSolution, Option<PoissonErrors>), NmtError> {
    let solved =
        poisson_on(subdomain, settings, part, |poisson| solve_poisson_observed(poisson, &part.mesh, params, observer));
    let solution = solved.map_err(|error| {
        let fault = datum_fault(problem, subdomain, settings, &error);
        fault.map_or(NmtError::Solve { subdomain: part.name.clone(), source: error }, |f| NmtError::Problem(vec![f]))
    })?;
    let errors = match &settings.exact {
        Some(exact) => {
            let errors = errors(exact, &solution, part);
            Some(errors.map_err(|fault| NmtError::Problem(vec![exact_fault(problem, &part.name, exact, fault)]))?)
        }
        None => None,
    };
    Ok((solution, errors))
}

/// What `work` makes of the Poisson problem of a subdomain.
pub(crate) fn poisson_on<T>(
    subdomain: &Subdomain,
    settings: &PoissonSettings,
    part: &MeshPart,
    work: impl FnOnce(&PoissonProblem) -> T,
) -> T {
    let source = |p: Point| settings.source.at(p);
    let boundary = |p: Point| settings.boundary.as_ref().map_or(0.0, |formula| formula.at(p));
    let fluxes: Vec<_> = subdomain.fluxes.iter().map(|flux| flux.as_ref().map(|q| move |p: Point| q.at(p))).collect();
    let as_function = |flux| flux as &(dyn Fn(Point) -> f64 + Sync);
    work(&PoissonProblem {
        source: &source,
        boundary: &boundary,
        fluxes: fluxes.iter().map(|flux| flux.as_ref().map(as_function)).collect(),
        section: &part.section,
    })
}

/// A datum that is not finite, in the terms of the file.
fn datum_fault(
    problem: &Problem,
    subdomain: &Subdomain,
    settings: &PoissonSettings,
    error: &MfdmError,
) -> Option<ProblemError> {
    let MfdmError::Datum { quantity, at, value } = *error else { return None };
    // Which flux: the one that has no value there.
    let without_value = || subdomain.fluxes.iter().flatten().find(|flux| !flux.at(at).is_finite());
    let (key, formula) = match quantity {
        "source" => ("source", Some(&settings.source)),
        "boundary value" => ("boundary", settings.boundary.as_ref()),
        _ => ("neumann", without_value()),
    };
    Some(not_finite(problem, &subdomain.name, key, formula?, at, value))
}

fn not_finite(problem: &Problem, name: &str, key: &str, formula: &Formula, at: Point, value: f64) -> ProblemError {
    let message = format!("`{key}` is {value} at {}", crate::report::place(at));
    let item = format!("subdomain \"{name}\"");
    problem.source.error(&formula.place, item, message, "give a formula that is finite on the section")
}

/// Why there are no errors.
enum ExactFault {
    NotFinite(Point, f64),
    TooLarge,
}

fn exact_fault(problem: &Problem, name: &str, exact: &Formula, fault: ExactFault) -> ProblemError {
    match fault {
        ExactFault::NotFinite(at, value) => not_finite(problem, name, "exact", exact, at, value),
        ExactFault::TooLarge => {
            let message = "`exact` has no mean square on the section: it is too large, or not finite somewhere";
            problem.source.error(&exact.place, format!("subdomain \"{name}\""), message, "correct the formula")
        }
    }
}

fn errors(exact: &Formula, solution: &PoissonSolution, part: &MeshPart) -> Result<PoissonErrors, ExactFault> {
    let at_nodes: Vec<f64> = part.mesh.xy().iter().map(|p| exact.at(*p)).collect();
    if let Some(node) = at_nodes.iter().position(|u| !u.is_finite()) {
        return Err(ExactFault::NotFinite(part.mesh.xy()[node], at_nodes[node]));
    }
    let is_finite =
        |norms: &ErrorNorms| [norms.max, norms.l2, norms.scale, norms.l2_scale].iter().all(|n| n.is_finite());
    let value = solution.errors(&part.mesh, |p| exact.at(p));
    let gradient = solution.gradient_errors(&part.mesh, |p| exact.gradient(p));
    if !is_finite(&value) {
        return Err(ExactFault::TooLarge);
    }
    Ok(PoissonErrors { exact: at_nodes, value, gradient: Some(gradient).filter(is_finite) })
}
