//! How the linear system was solved.

use nmt_mfdm::LinearSolve;
use serde::Serialize;

/// The solver, and what its iteration did.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LinearSolverReport {
    /// `direct`, `cg` or `bicgstab`.
    pub method: &'static str,
    /// The most that a right side took; absent, with what follows, where nothing was iterated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub iterations: Option<usize>,
    /// Levels of the multigrid.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub levels: Option<usize>,
    /// Entries of the matrices of all levels over those of the finest.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub operator_complexity: Option<f64>,
    /// The iteration did not converge, and the direct solver took over.
    pub fell_back: bool,
}

impl LinearSolverReport {
    pub(super) fn of(how: &LinearSolve) -> Self {
        Self {
            method: how.method.name(),
            iterations: how.iteration.map(|i| i.iterations),
            levels: how.iteration.map(|i| i.levels),
            operator_complexity: how.iteration.map(|i| i.operator_complexity),
            fell_back: how.fell_back,
        }
    }

    /// In a line.
    pub(super) fn line(&self, residual: f64) -> String {
        let what = match (self.iterations, self.levels) {
            (Some(iterations), Some(levels)) => {
                format!("{}, {iterations} iterations, multigrid of {levels} levels", self.method)
            }
            _ if self.fell_back => format!("{}, after an iteration that did not converge", self.method),
            _ => self.method.to_owned(),
        };
        format!("{what}, residual {residual:.1e}")
    }
}
