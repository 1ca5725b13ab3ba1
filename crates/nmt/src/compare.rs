//! The formulations side by side on the same cloud and mesh: what each costs and how near its J comes, or the u of a
//! Poisson problem.
//!
//! [`compare`] solves every subdomain by every one of [`methods`], [`Comparison`] holds the rows, [`text`] and
//! [`Comparison::json`] write them down, [`unknowns_svg`] and [`time_svg`] draw them. See docs/compare.md.

mod picture;
mod poisson;
mod text;

pub use picture::{time_svg, unknowns_svg};
pub use poisson::PoissonFigures;
pub use text::text;

use crate::error::NmtError;
use crate::pipeline::{MeshPart, elimination_fault, torsion};
use crate::problem::Problem;
use nmt_mfdm::{Formulation, MfdmError, SolveParams, Test, Trial, solve};
use serde::Serialize;

/// One way to solve: what is varied in a comparison. All else is the default of its order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Method {
    /// The formulation.
    pub formulation: Formulation,
    /// p of its polynomials; 1 for finite elements.
    pub order: usize,
    /// Trial functions, of the variational formulation.
    pub trial: Trial,
    /// Test functions, of the variational formulation.
    pub test: Test,
}

impl Method {
    /// What the others are held against where no exact J is given: variational, blended trial, hats, order 4.
    pub const REFERENCE: Self = Self::variational(4, Trial::Blended, Test::Hat);

    const fn variational(order: usize, trial: Trial, test: Test) -> Self {
        Self { formulation: Formulation::Variational, order, trial, test }
    }

    const fn other(formulation: Formulation, order: usize) -> Self {
        Self { formulation, order, trial: Trial::Blended, test: Test::Hat }
    }

    /// Its name in the table: `fem`, `local 2`, `variational 2 blended+hat`.
    pub fn name(&self) -> String {
        let name = self.formulation.name();
        match self.formulation {
            Formulation::Fem => name.to_owned(),
            Formulation::Local => format!("{name} {}", self.order),
            Formulation::Variational => format!("{name} {} {}+{}", self.order, self.trial.name(), self.test.name()),
        }
    }

    fn params(&self) -> SolveParams {
        let Self { formulation, order, trial, test } = *self;
        SolveParams { formulation, order, trial, test, ..SolveParams::default() }
    }
}

/// All that are compared, in the order of the table.
pub fn methods() -> [Method; 10] {
    use {Test::Hat, Trial::Blended, Trial::Mwls};
    [
        Method::other(Formulation::Fem, 1),
        Method::other(Formulation::Local, 2),
        Method::other(Formulation::Local, 3),
        Method::other(Formulation::Local, 4),
        Method::variational(2, Blended, Hat),
        Method::variational(3, Blended, Hat),
        Method::REFERENCE,
        Method::variational(2, Blended, Test::Trial),
        Method::variational(2, Mwls, Hat),
        Method::variational(2, Mwls, Test::Trial),
    ]
}

/// One subdomain, on one cloud, solved by one method; the field names are those of compare.json.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// Name of the subdomain.
    pub subdomain: String,
    /// N_x and N_y of its cloud.
    pub density: [usize; 2],
    /// Number of its nodes.
    pub nodes: usize,
    /// Name of the method.
    pub method: String,
    /// Its formulation.
    pub formulation: &'static str,
    /// Its order p.
    pub order: usize,
    /// Trial functions, of the variational formulation.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub trial: Option<&'static str>,
    /// Test functions, of the variational formulation.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub test: Option<&'static str>,
    /// What came out.
    #[serde(flatten)]
    pub outcome: Outcome,
    /// From stencils to results, by the clock of whoever calls.
    pub seconds: f64,
}

/// Numbers, or why there are none.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Outcome {
    /// Torsion was solved.
    Solved(Figures),
    /// A Poisson problem was solved.
    Poisson(PoissonFigures),
    /// It was not.
    Failed {
        /// What the numerics say, with the remedy.
        error: String,
    },
}

/// What is compared.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Figures {
    /// Number of equations.
    pub unknowns: usize,
    /// Torsion constant.
    #[serde(rename = "J")]
    pub j: f64,
    /// Largest stress at nodes.
    pub tau_max: f64,
    /// J/reference − 1; `None` where the reference itself failed.
    #[serde(rename = "J_difference")]
    pub j_difference: Option<f64>,
    /// Stars whose polynomial is of a lower order than asked for: too few nodes, or badly placed ones.
    pub order_lowered: usize,
}

impl Row {
    fn new(method: Method, part: &MeshPart, density: [usize; 2], outcome: Outcome, seconds: f64) -> Self {
        let Method { formulation, order, trial, test } = method;
        let is_variational = formulation == Formulation::Variational;
        Self {
            subdomain: part.name.clone(),
            density,
            nodes: part.mesh.cloud().n_nodes(),
            method: method.name(),
            formulation: formulation.name(),
            order,
            trial: is_variational.then(|| trial.name()),
            test: is_variational.then(|| test.name()),
            outcome,
            seconds,
        }
    }

    /// The numbers of torsion, where it was solved.
    pub fn figures(&self) -> Option<&Figures> {
        match &self.outcome {
            Outcome::Solved(figures) => Some(figures),
            Outcome::Poisson(_) | Outcome::Failed { .. } => None,
        }
    }

    /// The numbers of a Poisson problem, where it was solved.
    pub fn poisson(&self) -> Option<&PoissonFigures> {
        match &self.outcome {
            Outcome::Poisson(figures) => Some(figures),
            Outcome::Solved(_) | Outcome::Failed { .. } => None,
        }
    }

    /// Stars whose polynomial is of a lower order than asked for.
    fn order_lowered(&self) -> usize {
        match &self.outcome {
            Outcome::Solved(figures) => figures.order_lowered,
            Outcome::Poisson(figures) => figures.order_lowered,
            Outcome::Failed { .. } => 0,
        }
    }
}

/// Every row of one or more runs of [`compare`]; [`Comparison::json`] writes it as compare.json.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// Version of nmt.
    pub nmt: String,
    /// Title of the problem.
    pub title: String,
    /// Name of the length unit.
    pub units: String,
    /// What J, or u, is held against.
    pub reference: String,
    /// f of ∇²u = f, where it is a Poisson problem.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub source: Option<String>,
    /// Its exact u, where it is given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub exact: Option<String>,
    /// J of the exact solution, where it was given.
    #[serde(rename = "exact_J", skip_serializing_if = "Option::is_none")]
    pub exact_j: Option<f64>,
    /// The rows: clouds in the order asked for, then subdomains, then methods.
    pub rows: Vec<Row>,
}

impl Comparison {
    /// Without rows yet.
    pub fn new(problem: &Problem, exact_j: Option<f64>) -> Self {
        let poisson = problem.solve.poisson.as_ref();
        let exact = poisson.and_then(|settings| Some(settings.exact.as_ref()?.text().to_owned()));
        let is_exact = exact_j.is_some() || exact.is_some();
        Self {
            nmt: env!("CARGO_PKG_VERSION").into(),
            title: problem.title.clone(),
            units: problem.units.clone(),
            reference: if is_exact { "exact".into() } else { Method::REFERENCE.name() },
            source: poisson.map(|settings| settings.source.text().to_owned()),
            exact,
            exact_j,
            rows: Vec::new(),
        }
    }

    /// compare.json.
    ///
    /// # Errors
    /// Where a number is not finite, which no solution's is.
    pub fn json(&self) -> Result<String, serde_json::Error> {
        serde_json::to_string_pretty(self).map(|text| text + "\n")
    }

    /// Rows without numbers: methods that could not solve the problem.
    pub fn n_failures(&self) -> usize {
        self.rows.iter().filter(|row| matches!(row.outcome, Outcome::Failed { .. })).count()
    }

    /// Whether errors can be drawn: against an exact J or an exact u.
    pub fn has_errors(&self) -> bool {
        self.exact_j.is_some() || self.exact.is_some()
    }

    /// Rows by cloud: one slice a subdomain and density.
    pub fn clouds(&self) -> impl Iterator<Item = &[Row]> {
        self.rows.chunks(methods().len())
    }
}

/// Solves every subdomain by every method; the file's load, condition on holes and shear moduli hold, or its data of a
/// Poisson problem; its formulation, order and star do not. `clock`, told the method that begins or ends, returns seconds
/// since a moment of the caller's choice.
///
/// J is held against `exact_j`, u against the file's `exact`; without it, both are held against those of
/// [`Method::REFERENCE`] on the same cloud. A method that fails says why in its row.
///
/// # Errors
/// [`NmtError::Problem`] where steps of elimination are left out and the mesh is not sound without them, or where a formula
/// of a Poisson problem is not finite.
pub fn compare(
    problem: &Problem,
    meshes: &[MeshPart],
    exact_j: Option<f64>,
    clock: &mut dyn FnMut(&Method) -> f64,
) -> Result<Vec<Row>, NmtError> {
    if let Some(fault) = meshes.iter().find_map(|part| elimination_fault(problem, part)) {
        return Err(NmtError::Problem(vec![fault]));
    }
    let mut rows = Vec::with_capacity(meshes.len() * methods().len());
    if let Some(settings) = &problem.solve.poisson {
        for (subdomain, part) in problem.subdomains.iter().zip(meshes) {
            rows.extend(poisson::rows(problem, subdomain, settings, part, clock)?);
        }
        return Ok(rows);
    }
    for (subdomain, part) in problem.subdomains.iter().zip(meshes) {
        let torsion = torsion(problem, subdomain);
        let mut runs = Vec::with_capacity(methods().len());
        for method in methods() {
            let start = clock(&method);
            let solution = solve(&torsion, &part.mesh, &method.params());
            runs.push(Run { method, solution, seconds: clock(&method) - start });
        }
        let of_reference = || {
            let run = runs.iter().find(|run| run.method == Method::REFERENCE)?;
            run.solution.as_ref().ok().map(|solution| solution.j)
        };
        let reference = exact_j.or_else(of_reference);
        rows.extend(runs.iter().map(|run| run.row(part, subdomain.nodes, reference)));
    }
    Ok(rows)
}

/// One method's solution and how long it took.
struct Run {
    method: Method,
    solution: Result<nmt_mfdm::TorsionSolution, MfdmError>,
    seconds: f64,
}

impl Run {
    fn row(&self, part: &MeshPart, density: [usize; 2], reference: Option<f64>) -> Row {
        let outcome = match &self.solution {
            Ok(solution) => Outcome::Solved(Figures {
                unknowns: solution.unknowns,
                j: solution.j,
                tau_max: solution.tau_max.value,
                j_difference: reference.map(|j| solution.j / j - 1.0),
                order_lowered: solution.stars.order_lowered,
            }),
            Err(error) => Outcome::Failed { error: error.to_string() },
        };
        Row::new(self.method, part, density, outcome, self.seconds)
    }
}

#[cfg(test)]
mod tests;
