//! How far the results of torsion may be off.

use crate::pipeline::SolvedPart;
use crate::report::singular::singular_vertices;
use crate::report::text::{number, significant};
use serde::Serialize;

/// Estimates of the errors of a solution; see [`nmt_mfdm::ErrorEstimate`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ErrorEstimateReport {
    /// Of J.
    #[serde(rename = "J")]
    pub j: f64,
    /// Of J, as a fraction of it.
    #[serde(rename = "J_relative")]
    pub j_relative: f64,
    /// Lower and upper bound of J.
    #[serde(rename = "J_bounds")]
    pub j_bounds: [f64; 2],
    /// Of T; 0 where it is given.
    pub torque: f64,
    /// Of θ; 0 where it is given.
    pub twist: f64,
    /// Of τ_max; `null` where the exact τ is infinite.
    pub tau_max: Option<f64>,
}

impl ErrorEstimateReport {
    /// Of a solution, where there is one.
    pub fn of(solved: &SolvedPart) -> Option<Self> {
        let estimate = solved.estimate.made()?;
        let is_finite = singular_vertices(&solved.part.section).is_empty();
        Some(Self {
            j: estimate.j,
            j_relative: estimate.relative(solved.solution.j),
            j_bounds: estimate.j_bounds,
            torque: estimate.torque,
            twist: estimate.twist,
            tau_max: is_finite.then_some(estimate.tau_max),
        })
    }

    /// The bounds of J, in as many digits as tell them apart, with the unit of J.
    pub(super) fn bounds(&self, unit: &str) -> String {
        let [low, high] = self.j_bounds;
        let distance = (high - low) / high.abs();
        let digits = if distance > 0.0 { (1.5 - distance.log10()).ceil().clamp(7.0, 15.0) as usize } else { 15 };
        let rounded = |bound: f64| significant(bound, digits);
        let bounds = format!("{} to {}{unit}", rounded(low), rounded(high));
        // The error of J is estimated as its distance from the farther bound: then J is farther from all that lies between the
        // bounds than half of what they are apart, and the middle is not.
        if self.j >= 1.5 * (high - low) {
            format!("{bounds}, their middle {} is nearer than J", rounded(0.5 * (low + high)))
        } else {
            bounds
        }
    }

    /// The errors, in the order of the results.
    pub(super) fn errors(&self) -> String {
        let Self { j, j_relative, torque, twist, .. } = self;
        let of_load = if *twist > 0.0 { format!("θ {}", short(*twist)) } else { format!("T {}", short(*torque)) };
        let tau_max =
            self.tau_max.map_or("τ_max none, as it is infinite".to_owned(), |e| format!("τ_max {}", short(e)));
        format!("J {} (relative {}), {of_load}, {tau_max}", short(*j), short(*j_relative))
    }
}

/// Two significant digits.
fn short(error: f64) -> String {
    let rounded = format!("{error:.1e}").parse::<f64>().unwrap_or(error);
    if (1e-3..1e4).contains(&rounded) { number(rounded) } else { format!("{error:.1e}") }
}
