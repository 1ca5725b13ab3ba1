//! Gauss rules on the triangle.

/// Points (barycentric coordinates) and weights of a rule; the weights sum to 1, the integral is the triangle's area
/// times the weighted sum.
#[derive(Clone, Debug, PartialEq)]
pub struct Rule {
    /// Barycentric coordinates of the points.
    pub points: Vec<[f64; 3]>,
    /// Weight of each point.
    pub weights: Vec<f64>,
}

/// Three interior points, exact to degree 2; Strang and Fix, An Analysis of the Finite Element Method (1973), Table 4.1.
pub fn three_points() -> Rule {
    let (a, b) = (2.0 / 3.0, 1.0 / 6.0);
    Rule { points: vec![[a, b, b], [b, a, b], [b, b, a]], weights: vec![1.0 / 3.0; 3] }
}

/// Six points, exact to degree 4; Dunavant, Int. J. Numer. Methods Eng. 21 (1985) 1129–1148, in closed form.
pub fn six_points() -> Rule {
    let root = (38.0 - 44.0 * 0.4f64.sqrt()).sqrt();
    let mut rule = Rule { points: Vec::with_capacity(6), weights: Vec::with_capacity(6) };
    for sign in [1.0, -1.0] {
        let near = (8.0 - 10f64.sqrt() + sign * root) / 18.0;
        let far = 1.0 - 2.0 * near;
        rule.points.extend([[far, near, near], [near, far, near], [near, near, far]]);
        let weight = (620.0 + sign * (213_125.0 - 53_320.0 * 10f64.sqrt()).sqrt()) / 3720.0;
        rule.weights.extend([weight; 3]);
    }
    rule
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Mean over the triangle of λ₁ᵃλ₂ᵇ: 2 a! b!/(a + b + 2)!.
    fn exact_mean(a: usize, b: usize) -> f64 {
        let factorial = |n: usize| (1..=n).product::<usize>() as f64;
        2.0 * factorial(a) * factorial(b) / factorial(a + b + 2)
    }

    fn worst_error(rule: &Rule, degree: usize) -> f64 {
        let mean = |a: usize, b: usize| -> f64 {
            let value = |p: &[f64; 3]| p[0].powi(a as i32) * p[1].powi(b as i32);
            rule.points.iter().zip(&rule.weights).map(|(p, w)| w * value(p)).sum()
        };
        (0..=degree).map(|a| (mean(a, degree - a) - exact_mean(a, degree - a)).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn three_points_are_exact_to_degree_2_and_six_points_to_degree_4() {
        for (rule, degree) in [(three_points(), 2), (six_points(), 4)] {
            for lower in 0..=degree {
                assert!(worst_error(&rule, lower) < 1e-15, "degree {lower}"); // rounding
            }
            assert!(worst_error(&rule, degree + 1) > 1e-6, "the rule claims less than it can");
        }
    }
}
