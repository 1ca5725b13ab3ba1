//! Gauss rules on the triangle.

use crate::basis::MAX_ORDER;

/// The numbers of points there are rules for.
pub const GAUSS_POINTS: [usize; 6] = [1, 3, 4, 6, 7, 12];

/// Points (barycentric coordinates) and weights of a rule; the weights sum to 1, the integral is the triangle's area
/// times the weighted sum.
#[derive(Clone, Debug, PartialEq)]
pub struct Rule {
    /// Barycentric coordinates of the points.
    pub points: Vec<[f64; 3]>,
    /// Weight of each point.
    pub weights: Vec<f64>,
}

impl Rule {
    /// The rule of `n` points, one of [`GAUSS_POINTS`]: exact to degree 1, 2, 3, 4, 5 and 6.
    pub fn of(n: usize) -> Option<Self> {
        match n {
            1 => Some(one_point()),
            3 => Some(three_points()),
            4 => Some(four_points()),
            6 => Some(six_points()),
            7 => Some(seven_points()),
            12 => Some(twelve_points()),
            _ => None,
        }
    }

    /// The degree to which it is exact, at most 4: more than that no polynomial of ours asks for.
    pub(crate) fn degree(&self) -> usize {
        // Rounding is 1e-16, and of a degree that is not met the error is 1e-3 and more.
        (1..=MAX_ORDER).take_while(|degree| self.worst_error(*degree) < 1.0e-12).last().unwrap_or(0)
    }

    /// Of the means over the triangle of λ₁ᵃλ₂ᵇ, a + b = `degree`, which are 2 a! b!/(a + b + 2)!.
    fn worst_error(&self, degree: usize) -> f64 {
        let factorial = |n: usize| (1..=n).product::<usize>() as f64;
        let error = |a: usize| {
            let b = degree - a;
            let value = |p: &[f64; 3]| p[0].powi(a as i32) * p[1].powi(b as i32);
            let mean: f64 = self.points.iter().zip(&self.weights).map(|(p, w)| w * value(p)).sum();
            (mean - 2.0 * factorial(a) * factorial(b) / factorial(degree + 2)).abs()
        };
        (0..=degree).map(error).fold(0.0, f64::max)
    }

    fn new() -> Self {
        Self { points: Vec::new(), weights: Vec::new() }
    }

    /// The three points (1 − 2a, a, a).
    fn with_three(mut self, a: f64, weight: f64) -> Self {
        let b = 1.0 - 2.0 * a;
        self.points.extend([[b, a, a], [a, b, a], [a, a, b]]);
        self.weights.extend([weight; 3]);
        self
    }

    /// The six points of the coordinates c, d, 1 − c − d.
    fn with_six(mut self, c: f64, d: f64, weight: f64) -> Self {
        let e = 1.0 - c - d;
        self.points.extend([[c, d, e], [d, e, c], [e, c, d], [c, e, d], [e, d, c], [d, c, e]]);
        self.weights.extend([weight; 6]);
        self
    }

    fn with_centroid(mut self, weight: f64) -> Self {
        self.points.push([1.0 / 3.0; 3]);
        self.weights.push(weight);
        self
    }
}

/// The centroid, exact to degree 1.
fn one_point() -> Rule {
    Rule::new().with_centroid(1.0)
}

/// Four points, exact to degree 3, the centroid with a negative weight; Strang and Fix, Table 4.1.
fn four_points() -> Rule {
    Rule::new().with_centroid(-9.0 / 16.0).with_three(0.2, 25.0 / 48.0)
}

/// Seven points, exact to degree 5; Radon (1948), in closed form.
pub(crate) fn seven_points() -> Rule {
    let root = 15f64.sqrt();
    Rule::new()
        .with_centroid(9.0 / 40.0)
        .with_three((6.0 - root) / 21.0, (155.0 - root) / 1200.0)
        .with_three((6.0 + root) / 21.0, (155.0 + root) / 1200.0)
}

/// Twelve points, exact to degree 6; Dunavant (1985), his figures polished to double precision by solving the moment
/// equations.
fn twelve_points() -> Rule {
    Rule::new()
        .with_three(0.249_286_745_170_910_42, 0.116_786_275_726_379_37)
        .with_three(0.063_089_014_491_502_23, 0.050_844_906_370_206_82)
        .with_six(0.053_145_049_844_816_95, 0.310_352_451_033_784_4, 0.082_851_075_618_373_58)
}

/// Three interior points, exact to degree 2; Strang and Fix, An Analysis of the Finite Element Method (1973), Table 4.1.
pub fn three_points() -> Rule {
    Rule::new().with_three(1.0 / 6.0, 1.0 / 3.0)
}

/// Six points, exact to degree 4; Dunavant, Int. J. Numer. Methods Eng. 21 (1985) 1129–1148, in closed form.
pub fn six_points() -> Rule {
    let root = (38.0 - 44.0 * 0.4f64.sqrt()).sqrt();
    [1.0, -1.0].iter().fold(Rule::new(), |rule, sign| {
        let near = (8.0 - 10f64.sqrt() + sign * root) / 18.0;
        let weight = (620.0 + sign * (213_125.0 - 53_320.0 * 10f64.sqrt()).sqrt()) / 3720.0;
        rule.with_three(near, weight)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_rule_is_exact_to_its_degree_and_no_further() {
        for (n, degree) in GAUSS_POINTS.into_iter().zip(1..) {
            let rule = Rule::of(n).expect("a rule of that many points");
            assert_eq!(rule.degree(), degree.min(MAX_ORDER));
            assert_eq!((rule.points.len(), rule.weights.len()), (n, n));
            for lower in 0..=degree {
                assert!(rule.worst_error(lower) < 1e-15, "{n} points, degree {lower}"); // rounding
            }
            assert!(rule.worst_error(degree + 1) > 1e-7, "{n} points: the rule claims less than it can");
        }
        assert_eq!(Rule::of(5), None);
    }
}
