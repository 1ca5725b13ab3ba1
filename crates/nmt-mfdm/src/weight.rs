//! The MWLS weight of a node by its distance; paper, Sec. 7, and MFDMtool.

/// Weight 1/ρ^(2(p+1)) at relative distance `rho` = distance/radius of the star, dimensionless: the interpolating one.
///
/// `rho > 0`; the centre's own node has an infinite weight and is met exactly.
#[inline]
pub fn weight(rho_squared: f64, order: usize) -> f64 {
    rho_squared.powi(-(order as i32 + 1))
}
