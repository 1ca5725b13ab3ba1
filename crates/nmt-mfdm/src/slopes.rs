//! What a boundary condition tells of the gradient at a node, and polynomials that meet it: the generalised degrees of
//! freedom of the meshless finite difference method \[D15\] (J. Orkisz, in *Handbook of Computational Solid Mechanics*, 1998).

use crate::basis::{MAX_MONOMIALS, row};
use nmt_geom::Point;
use nmt_geom::point::{dot, sub};

/// Which part of a polynomial's gradient at its centre is known.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) enum Slopes {
    /// None.
    #[default]
    Free,
    /// Its component across this unit vector: of the gradient, one number is free.
    Along(Point),
    /// All of it.
    Known,
}

impl Slopes {
    /// The columns that are left of the two linear monomials.
    pub fn n_free(self) -> usize {
        match self {
            Self::Free => 2,
            Self::Along(_) => 1,
            Self::Known => 0,
        }
    }

    /// The monomials that are free in the place of all.
    #[inline]
    pub fn restrict(self, basis: &mut [f64; MAX_MONOMIALS]) {
        match self {
            Self::Free => {}
            Self::Along(t) => {
                basis[1] = t[0] * basis[1] + t[1] * basis[2];
                basis.copy_within(3.., 2);
            }
            Self::Known => basis.copy_within(3.., 1),
        }
    }

    /// Spreads coefficients of the free monomials, which begin `all`, over all of them, in groups of `n` (one a monomial);
    /// those of the constant take the first `constant` entries. What is known counts as 0.
    pub fn spread(self, all: &mut [f64], constant: usize, n: usize) {
        if self == Self::Free {
            return;
        }
        let (missing, linear) = ((2 - self.n_free()) * n, constant + 2 * n);
        all.copy_within(linear - missing..all.len() - missing, linear);
        match self {
            Self::Free => {}
            Self::Along(t) => {
                (constant..constant + n).for_each(|k| (all[k], all[k + n]) = (t[0] * all[k], t[1] * all[k]))
            }
            Self::Known => all[constant..linear].fill(0.0),
        }
    }

    /// The part of a gradient that is known.
    pub fn known_part(self, gradient: Point) -> Point {
        match self {
            Self::Free => [0.0; 2],
            Self::Along(t) => sub(gradient, t.map(|c| c * dot(t, gradient))),
            Self::Known => gradient,
        }
    }
}

/// A gradient known in part, in the stretched coordinates of stars.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct KnownSlopes {
    /// Which part.
    pub slopes: Slopes,
    /// Its value, 1/user's length unit.
    pub gradient: Point,
}

/// The gradient of monomial `m` at the centre.
pub(crate) fn gradient_of_monomial(m: usize) -> Point {
    [row(1, 0), row(0, 1)].map(|linear| f64::from(u8::from(m == linear)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::basis::{monomials, n_monomials};
    use crate::mwls::{MAX_CONDITION, Mwls};
    use proptest::prelude::*;

    proptest! {
        /// One-sided stars, as on a boundary; the polynomial and the slope that is known come from the same function.
        #[test]
        fn polynomials_that_meet_a_slope_reproduce_every_polynomial_of_their_order(
            order in 2usize..=4,
            angle in 0.0..std::f64::consts::TAU,
            all_known: bool,
            met: bool,
            jitter in prop::collection::vec(prop::array::uniform2(-0.2..0.2f64), 35),
            coefficients in prop::collection::vec(-1.0..1.0f64, MAX_MONOMIALS),
        ) {
            let mut star: Vec<Point> =
                (0..35).map(|k| [f64::from(k % 7) - 3.0 + jitter[k as usize][0], f64::from(k / 7) + jitter[k as usize][1].abs()]).collect();
            star[3] = [0.0, 0.0];
            let slopes = if all_known { Slopes::Known } else { Slopes::Along([angle.cos(), angle.sin()]) };
            let gradient = slopes.known_part([coefficients[1], coefficients[2]]);
            let value = |p: Point| {
                let mut basis = [0.0; MAX_MONOMIALS];
                monomials(p, order, &mut basis);
                (0..n_monomials(order)).map(|m| coefficients[m] * basis[m]).sum::<f64>() - dot(gradient, p)
            };
            let mut mwls = Mwls::default();
            let g = if met { 0.0 } else { 0.3 };
            let condition =
                mwls.factorise_meeting(star.iter().copied(), [0.0; 2], met.then_some(3), slopes, order, g);
            prop_assert!(condition < MAX_CONDITION, "{}", condition);
            let mut fitted = [0.0; MAX_MONOMIALS];
            mwls.fit(|k| value(star[k]), &mut fitted);
            let mut rows = Vec::new();
            mwls.rows(&mut rows);
            prop_assert_eq!(rows.len(), (n_monomials(order) - mwls.first_row()) * star.len());
            for m in mwls.first_row()..n_monomials(order) {
                let degree = (0..=order).find(|degree| m < n_monomials(*degree)).expect("a degree");
                let known = dot(gradient, gradient_of_monomial(m));
                let expected = (coefficients[m] - known) * mwls.radius().powi(degree as i32);
                let first = (m - mwls.first_row()) * star.len();
                let by_row: f64 = (0..star.len()).map(|k| rows[first + k] * value(star[k])).sum();
                let tolerance = 1e-12 * condition * mwls.radius().powi(order as i32); // rounding times condition
                prop_assert!((fitted[m] - expected).abs() < tolerance, "fit {}: {} {}", m, fitted[m], expected);
                prop_assert!((by_row - expected).abs() < tolerance, "row {}: {} {}", m, by_row, expected);
            }
        }
    }
}
