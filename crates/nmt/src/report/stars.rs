//! What the report says of the equations: their functions, their stars.

use nmt_mfdm::{Formulation, SolveParams, StarChoice, StarReport, default_gauss};
use serde::Serialize;

/// How the variational form is made equations.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct VariationalReport {
    /// Trial functions.
    pub trial: &'static str,
    /// Test functions.
    pub test: &'static str,
    /// Gauss points a triangle.
    pub gauss: usize,
}

impl VariationalReport {
    /// Of the variational formulation; the others have neither.
    pub(super) fn of(params: &SolveParams) -> Option<Self> {
        let SolveParams { trial, test, gauss, order, .. } = params;
        let report = Self { trial: trial.name(), test: test.name(), gauss: gauss.unwrap_or(default_gauss(*order)) };
        (params.formulation == Formulation::Variational).then_some(report)
    }
}

/// What became of the stars of the equations.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct StarsReport {
    /// Nodes in a star.
    pub size: usize,
    /// How they are chosen.
    pub choice: &'static str,
    /// Present, and true, where nothing is said of that, and they are balanced since the cloud is graded.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub for_graded_cloud: bool,
    /// g of the weight, where it smooths.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub smoothing: Option<f64>,
    /// Hidden nodes passed over.
    pub hidden_nodes_skipped: usize,
    /// Stars enlarged.
    pub enlarged: usize,
    /// Stars of lower order.
    pub order_lowered: usize,
    /// Interior nodes whose own coefficient in their ∇² row has the wrong sign.
    pub wrong_sign: usize,
    /// Largest condition number.
    pub worst_condition: f64,
}

impl StarsReport {
    /// Of the meshless formulations; finite elements have no stars.
    pub(super) fn of(params: &SolveParams, report: &StarReport) -> Option<Self> {
        let StarReport { size, choice, hidden_nodes_skipped, enlarged, order_lowered, worst_condition, wrong_sign } =
            *report;
        let smoothing = (params.smoothing > 0.0).then_some(params.smoothing);
        let stars = Self {
            size,
            choice: choice.name(),
            for_graded_cloud: params.stars.is_none() && choice == StarChoice::Balanced,
            smoothing,
            hidden_nodes_skipped,
            enlarged,
            order_lowered,
            wrong_sign,
            worst_condition,
        };
        (params.formulation != Formulation::Fem).then_some(stars)
    }
}
