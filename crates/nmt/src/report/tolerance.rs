//! The way to a tolerance: one line a cloud.

use crate::pipeline::{SolvedPart, Step};
use serde::Serialize;

/// How a subdomain was solved to a tolerance.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ToleranceReport {
    /// The relative error of J asked for.
    pub asked: f64,
    /// Whether the estimate of the results meets it.
    pub reached: bool,
    /// Why no finer cloud was solved, and the remedy; absent where it is reached.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stop: Option<String>,
    /// One entry a cloud, in order; the results are those of the best.
    pub steps: Vec<StepReport>,
}

/// One solution on the way.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct StepReport {
    /// Nodes.
    pub nodes: usize,
    /// J.
    #[serde(rename = "J")]
    pub j: f64,
    /// The estimated error of J as a fraction of it; `null` where the cloud is too coarse for an estimate.
    pub error: Option<f64>,
    /// Seconds from its cloud to its estimate, filled in by whoever holds the clock.
    pub seconds: f64,
}

impl ToleranceReport {
    /// Of a solution with a history.
    pub fn of(solved: &SolvedPart, asked: f64) -> Option<Self> {
        if solved.history.is_empty() {
            return None;
        }
        let step = |step: &Step| StepReport {
            nodes: step.nodes,
            j: step.j,
            error: Some(step.error).filter(|error| error.is_finite()),
            seconds: 0.0,
        };
        Some(Self {
            asked,
            reached: Step::of(solved).error <= asked,
            stop: solved.stop.as_ref().map(ToString::to_string),
            steps: solved.history.iter().map(step).collect(),
        })
    }
}
