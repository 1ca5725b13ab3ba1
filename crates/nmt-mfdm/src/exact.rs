//! Exact solutions of the Prandtl problem, to check against; Gθ = 1 throughout.
//!
//! Timoshenko and Goodier, Theory of Elasticity, 3rd ed. (1970), Ch. 10.

use nmt_geom::Point;
use std::f64::consts::PI;

/// Exact torsion of a section: J, the largest stress function and the largest stress.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExactTorsion {
    /// Torsion constant J = T/(Gθ), length⁴.
    pub j: f64,
    /// Largest value of F, length² (Gθ = 1).
    pub f_max: f64,
    /// Largest stress, length (Gθ = 1).
    pub tau_max: f64,
}

/// An ellipse of semi-axes a and b; a circle where they are equal. F = a²b²/(a² + b²)·(1 − x²/a² − y²/b²).
pub fn ellipse(a: f64, b: f64) -> ExactTorsion {
    let k = a * a * b * b / (a * a + b * b);
    ExactTorsion { j: PI * a.powi(3) * b.powi(3) / (a * a + b * b), f_max: k, tau_max: 2.0 * k / a.min(b) }
}

/// An equilateral triangle of side s.
pub fn equilateral_triangle(s: f64) -> ExactTorsion {
    let root3 = 3f64.sqrt();
    ExactTorsion { j: root3 / 80.0 * s.powi(4), f_max: s * s / 18.0, tau_max: root3 / 4.0 * s }
}

/// A ring of radii `inner < outer` under circulation: half of r⁴ differences.
pub fn ring(inner: f64, outer: f64) -> ExactTorsion {
    ExactTorsion {
        j: PI / 2.0 * (outer.powi(4) - inner.powi(4)),
        f_max: (outer * outer - inner * inner) / 2.0,
        tau_max: outer,
    }
}

/// F of the rectangle [0, a] × [0, b] at a point, by its series; terms fall as exp(−nπ·distance/a).
pub fn rectangle_f(a: f64, b: f64, p: Point) -> f64 {
    let (x, y) = (p[0], p[1] - b / 2.0);
    let term = |n: f64| {
        let k = n * PI / a;
        8.0 * a * a / (PI * n).powi(3) * cosh_ratio(k * y, k * b / 2.0) * (k * x).sin()
    };
    x * (a - x) - odd_sum(term)
}

/// A rectangle of sides a and b.
pub fn rectangle(a: f64, b: f64) -> ExactTorsion {
    let (a, b) = (a.min(b), a.max(b));
    let j_term = |n: f64| (n * PI * b / (2.0 * a)).tanh() / n.powi(5);
    let tau_term = |n: f64| 1.0 / (n * n * (n * PI * b / (2.0 * a)).cosh());
    ExactTorsion {
        j: a.powi(3) * b * (1.0 / 3.0 - 64.0 / PI.powi(5) * a / b * odd_sum(j_term)),
        f_max: rectangle_f(a, b, [a / 2.0, b / 2.0]),
        tau_max: a * (1.0 - 8.0 / (PI * PI) * odd_sum(tau_term)),
    }
}

/// cosh(u)/cosh(v) for |u| ≤ v, without overflow.
fn cosh_ratio(u: f64, v: f64) -> f64 {
    let u = u.abs();
    (u - v).exp() * (1.0 + (-2.0 * u).exp()) / (1.0 + (-2.0 * v).exp())
}

/// Σ over n = 1, 3, 5, … 4 001: the tails of n⁻⁵ and of the exponentials are below rounding, that of n⁻³·sin 1e-8 of a
/// term only on the boundary, where the ratio of cosh is 1.
fn odd_sum(term: impl Fn(f64) -> f64) -> f64 {
    (0..=2000).rev().map(|k| term(f64::from(2 * k + 1))).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_unit_square_and_the_one_by_two_have_the_known_constants() {
        // 30-digit evaluations of the series.
        let square = rectangle(1.0, 1.0);
        assert!((square.j - 0.140_577_014_955_153_7).abs() < 1e-15);
        assert!((square.f_max - 0.147_342_706_563_027_64).abs() < 1e-14);
        assert!((square.tau_max - 0.675_314_483_313_567_6).abs() < 1e-14);
        assert!((rectangle(2.0, 1.0).j - 0.457_363_354_239_141_5).abs() < 1e-15);
        assert_eq!(rectangle(2.0, 1.0), rectangle(1.0, 2.0));
    }
}
