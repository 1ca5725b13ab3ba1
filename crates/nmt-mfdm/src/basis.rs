//! Taylor monomials to order p in a star's scaled coordinates \[D11\].

/// Largest order of a nodal polynomial.
pub const MAX_ORDER: usize = 4;

/// Number of monomials of [`MAX_ORDER`].
pub const MAX_MONOMIALS: usize = n_monomials(MAX_ORDER);

/// 1/n: a multiplication costs a tenth of a division, and monomials are most of the work at Gauss points.
pub(crate) const INVERSE: [f64; MAX_ORDER + 4] =
    [0.0, 1.0, 1.0 / 2.0, 1.0 / 3.0, 1.0 / 4.0, 1.0 / 5.0, 1.0 / 6.0, 1.0 / 7.0];

/// Number of monomials of degree ≤ p: (p + 1)(p + 2)/2.
pub const fn n_monomials(order: usize) -> usize {
    (order + 1) * (order + 2) / 2
}

/// Row of the monomial hᵃkᵇ/(a! b!), which is also that of the derivative ∂ᵃ⁺ᵇ/∂xᵃ∂yᵇ.
pub const fn row(a: usize, b: usize) -> usize {
    let degree = a + b;
    degree * (degree + 1) / 2 + b
}

/// The monomials 1, h, k, h²/2, hk, k²/2, … to `order` at scaled coordinates (h, k), into `out[..n_monomials(order)]`.
///
/// With them the coefficients of a polynomial are its derivatives at the centre, in scaled coordinates.
///
/// ```
/// let mut out = [0.0; nmt_mfdm::MAX_MONOMIALS];
/// nmt_mfdm::monomials([2.0, 3.0], 2, &mut out);
/// assert_eq!(out[..6], [1.0, 2.0, 3.0, 2.0, 6.0, 4.5]);
/// ```
#[inline(always)]
pub fn monomials([h, k]: [f64; 2], order: usize, out: &mut [f64]) {
    out[0] = 1.0;
    for degree in 1..order + 1 {
        let (first, below) = (degree * (degree + 1) / 2, (degree - 1) * degree / 2);
        // hᵃkᵇ/(a! b!) from the row below: times h/a, and the last one times k/b.
        for b in 0..degree {
            out[first + b] = out[below + b] * h * INVERSE[degree - b];
        }
        out[first + degree] = out[below + degree - 1] * k * INVERSE[degree];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn monomials_are_powers_over_factorials_in_the_order_of_their_rows() {
        let (h, k): (f64, f64) = (0.7, -0.4);
        let mut out = [0.0; MAX_MONOMIALS];
        monomials([h, k], MAX_ORDER, &mut out);
        let factorial = |n: usize| (1..=n).product::<usize>() as f64;
        for a in 0..=MAX_ORDER {
            for b in 0..=MAX_ORDER - a {
                let expected = h.powi(a as i32) * k.powi(b as i32) / (factorial(a) * factorial(b));
                assert!((out[row(a, b)] - expected).abs() < 1e-15, "{a} {b}"); // rounding
            }
        }
    }
}
