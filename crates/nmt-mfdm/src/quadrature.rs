//! A field at all points of a Gauss rule on a triangle, four points at a time.

use crate::basis::{INVERSE, MAX_MONOMIALS, MAX_ORDER, row};
use crate::blend::{NodalPolynomials, barycentric_gradients};
use crate::gauss::Rule;
use crate::lanes::{Lanes, WIDTH};
use crate::vectors::widest;
use nmt_geom::point::sub;
use nmt_geom::{Point, TriId};
use nmt_tri::Mesh;
use std::array::from_fn;

/// Groups of four points.
const FOURS: usize = 2;

/// A rule of at most eight points; those that are missing weigh nothing.
#[derive(Clone, Debug)]
pub(crate) struct RuleLanes {
    lambda: [[Lanes; 3]; FOURS],
    /// They sum to 1.
    pub weights: [Lanes; FOURS],
}

impl From<&Rule> for RuleLanes {
    fn from(rule: &Rule) -> Self {
        let points = rule.points.iter().zip(&rule.weights).enumerate();
        let mut all = Self { lambda: [[Lanes::all(1.0 / 3.0); 3]; FOURS], weights: [Lanes::default(); FOURS] };
        for (k, (lambda, weight)) in points.take(FOURS * WIDTH) {
            (0..3).for_each(|a| all.lambda[k / WIDTH][a].0[k % WIDTH] = lambda[a]);
            all.weights[k / WIDTH].0[k % WIDTH] = *weight;
        }
        all
    }
}

impl RuleLanes {
    /// The rule on a part of the triangle that has these barycentric coordinates at its corners.
    pub fn of_part(&self, [a, b, c]: [[f64; 3]; 3]) -> Self {
        let lambda = self.lambda.map(|[x, y, z]| from_fn(|k| x * a[k] + y * b[k] + z * c[k]));
        Self { lambda, weights: self.weights }
    }

    /// Its points on a triangle.
    pub fn places(&self, corners: [Point; 3]) -> [[Lanes; 2]; FOURS] {
        self.lambda.map(|[a, b, c]| from_fn(|d| a * corners[0][d] + b * corners[1][d] + c * corners[2][d]))
    }
}

/// Value and gradient of a field at four points.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct AtFour {
    pub value: Lanes,
    pub gradient: [Lanes; 2],
}

impl NodalPolynomials {
    /// Value and gradient at the points of a rule, as [`Self::slope`] has them.
    pub(crate) fn slopes_at(&self, mesh: &Mesh, triangle: TriId, rule: &RuleLanes) -> [AtFour; FOURS] {
        self.at_rule::<true>(mesh, triangle, rule)
    }

    /// As [`Self::slopes_at`], without gradients, in half the time.
    pub(crate) fn values_at(&self, mesh: &Mesh, triangle: TriId, rule: &RuleLanes) -> [Lanes; FOURS] {
        self.at_rule::<false>(mesh, triangle, rule).map(|four| four.value)
    }

    fn at_rule<const WITH_GRADIENT: bool>(&self, mesh: &Mesh, triangle: TriId, rule: &RuleLanes) -> [AtFour; FOURS] {
        widest(
            #[inline(always)]
            || match self.blended_order() {
                0 => self.of_order::<0, WITH_GRADIENT>(mesh, triangle, rule),
                1 => self.of_order::<1, WITH_GRADIENT>(mesh, triangle, rule),
                2 => self.of_order::<2, WITH_GRADIENT>(mesh, triangle, rule),
                3 => self.of_order::<3, WITH_GRADIENT>(mesh, triangle, rule),
                _ => self.of_order::<MAX_ORDER, WITH_GRADIENT>(mesh, triangle, rule),
            },
        )
    }

    #[inline(always)]
    fn of_order<const ORDER: usize, const WITH_GRADIENT: bool>(
        &self,
        mesh: &Mesh,
        triangle: TriId,
        rule: &RuleLanes,
    ) -> [AtFour; FOURS] {
        let corners = mesh.corners(triangle);
        let nodes = mesh.tri_nodes()[triangle.index()];
        let slopes = barycentric_gradients(corners);
        let mut fours = [AtFour::default(); FOURS];
        for a in 0..3 {
            let (b, c) = ((a + 1) % 3, (a + 2) % 3);
            let (own, scale) = (self.coefficients(nodes[a]), self.slopes(nodes[a]));
            let scaled = |k: usize| {
                let offset = sub(corners[k], corners[a]);
                [offset[0] * scale[0], offset[1] * scale[1]]
            };
            let (to_b, to_c) = (scaled(b), scaled(c));
            for (lambda, four) in rule.lambda.iter().zip(&mut fours) {
                let at = from_fn(|d| lambda[b] * to_b[d] + lambda[c] * to_c[d]);
                let basis = monomials::<ORDER>(at);
                let (mut value, mut along) = (Lanes::all(own[0]), [Lanes::default(); 2]);
                for degree in 1..=ORDER {
                    for b in 0..=degree {
                        value += basis[row(degree - b, b)] * own[row(degree - b, b)];
                    }
                    // The derivative of hᵃkᵇ/(a! b!) along h is the monomial (a − 1, b).
                    for b in 0..degree {
                        if WITH_GRADIENT {
                            let lower = basis[row(degree - 1 - b, b)];
                            along[0] += lower * own[row(degree - b, b)];
                            along[1] += lower * own[row(degree - 1 - b, b + 1)];
                        }
                    }
                }
                four.value += lambda[a] * value;
                if WITH_GRADIENT {
                    for d in 0..2 {
                        four.gradient[d] += value * slopes[a][d] + lambda[a] * (along[d] * scale[d]);
                    }
                }
            }
        }
        fours
    }
}

/// [`crate::monomials`] at four points.
#[inline(always)]
fn monomials<const ORDER: usize>([h, k]: [Lanes; 2]) -> [Lanes; MAX_MONOMIALS] {
    let mut basis = [Lanes::default(); MAX_MONOMIALS];
    basis[0] = Lanes::all(1.0);
    for degree in 1..=ORDER {
        for b in 0..degree {
            basis[row(degree - b, b)] = basis[row(degree - 1 - b, b)] * h * INVERSE[degree - b];
        }
        basis[row(0, degree)] = basis[row(0, degree - 1)] * k * INVERSE[degree];
    }
    basis
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::blend::place;
    use crate::blend::tests::fields_of_all_orders;
    use crate::gauss::{seven_points, six_points};

    #[test]
    fn four_points_at_a_time_are_as_one_by_one() -> Result<(), Box<dyn std::error::Error>> {
        let (mesh, fields) = fields_of_all_orders()?;
        for (field, rule) in fields.iter().flat_map(|field| [(field, six_points()), (field, seven_points())]) {
            let lanes = RuleLanes::from(&rule);
            assert!((lanes.weights.iter().flat_map(|w| w.0).sum::<f64>() - 1.0).abs() < 1e-15);
            for t in mesh.triangles() {
                let (corners, fours) = (mesh.corners(t), field.slopes_at(&mesh, t, &lanes));
                let values = field.values_at(&mesh, t, &lanes);
                for (k, lambda) in rule.points.iter().enumerate() {
                    let p = place(corners, *lambda);
                    let (value, gradient) = field.slope(&mesh, t, p);
                    let (four, lane) = (fours[k / WIDTH], k % WIDTH);
                    let close = |x: f64, y: f64| (x - y).abs() <= 1e-12 * (1.0 + x.abs()); // rounding
                    assert!(close(value, four.value.0[lane]) && values[k / WIDTH] == four.value);
                    assert!((0..2).all(|d| close(gradient[d], four.gradient[d].0[lane])));
                }
            }
        }
        Ok(())
    }
}
