//! The MWLS weight of a node by its distance; paper, Sec. 7, and MFDMtool.

/// Weight 1/(ρ² + g⁴/(ρ² + g²))^(p+1) at relative distance ρ = distance/radius of the star; all dimensionless.
///
/// With g = 0 it is 1/ρ^(2(p+1)), infinite at ρ = 0: the polynomial meets the value there exactly. With g > 0 it is
/// 1/g^(2(p+1)) at ρ = 0 and the polynomial smooths.
#[inline]
pub fn weight(rho_squared: f64, g: f64, order: usize) -> f64 {
    if g == 0.0 {
        return rho_squared.powi(-(order as i32 + 1));
    }
    let g2 = g * g;
    (rho_squared + g2 * g2 / (rho_squared + g2)).powi(-(order as i32 + 1))
}
