//! Results from the recovered field: torque, stresses, extremes, residual; paper, eq. (16) \[D14\].

mod extremes;
mod residual;
mod stress;

pub use extremes::{Extreme, Extremes, extremes};
pub use residual::residuals;
pub(crate) use residual::residuals_against;
pub use stress::{Stress, StressIntegral, stress_integrals};

/// T = 2∫F + 2Σ c_k A_k.
pub(crate) fn torque(volume: f64, constants: &[f64], hole_areas: &[f64]) -> f64 {
    2.0 * volume + 2.0 * constants.iter().zip(hole_areas).map(|(c, area)| c * area).sum::<f64>()
}
