//! A triangle of the mesh, and the integrals of monomials about its corners over it.

use crate::basis::{INVERSE, MAX_MONOMIALS, MAX_ORDER, monomials, n_monomials, row};
use crate::blend::barycentric_gradients;
use nmt_geom::point::sub;
use nmt_geom::{NodeId, Point, TriId};
use nmt_tri::Mesh;

/// A triangle with what the weak form asks of it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Element {
    pub triangle: TriId,
    pub nodes: [NodeId; 3],
    pub corners: [Point; 3],
    pub area: f64,
    /// Gradients of the hats of its nodes.
    pub slopes: [[f64; 2]; 3],
}

impl Element {
    #[inline(always)]
    pub fn new(mesh: &Mesh, triangle: TriId) -> Self {
        let corners = mesh.corners(triangle);
        Self {
            triangle,
            nodes: mesh.tri_nodes()[triangle.index()],
            corners,
            area: mesh.area(triangle),
            slopes: barycentric_gradients(corners),
        }
    }

    /// Gradient of the hat of one of its nodes; 0 for any other.
    #[inline]
    pub fn hat_slope(&self, node: NodeId) -> [f64; 2] {
        self.nodes.iter().position(|n| *n == node).map_or([0.0; 2], |corner| self.slopes[corner])
    }
}

/// ∫φ_m and ∫λ_aφ_m, φ_m the monomials of degree ≤ P about a corner a in (x − x_a, y − y_a); see [`row`].
pub(crate) struct CornerIntegrals<const P: usize> {
    plain: [f64; MAX_MONOMIALS],
    with_own: [f64; MAX_MONOMIALS],
}

impl<const P: usize> CornerIntegrals<P> {
    /// Over a triangle, about its corner `a`, in closed form.
    ///
    /// With the sides s and t from a to b and c, d!·φ_m of the degree d are the coefficients of (λ_b·s + λ_c·t)^d, a side
    /// standing for its linear form s_x·X + s_y·Y. Since ∫λ_bᵖλ_c^q = 2A·p! q!/(p + q + 2)!, the integrals are those of
    /// Σ sᵖt^q over p + q = d, which is s times the sum of the degree below, and t^d.
    #[inline(always)]
    pub fn of_triangle(element: &Element, a: usize) -> Self {
        let [s, t] = [1, 2].map(|next| sub(element.corners[(a + next) % 3], element.corners[a]));
        let mut sums = [0.0; MAX_MONOMIALS];
        let mut power = [0.0; MAX_ORDER + 1]; // t^d
        (sums[0], power[0]) = (1.0, 1.0);
        let mut integrals = Self::ZERO;
        let mut factor = element.area; // 2A/(d + 2)!
        for d in 0..P + 1 {
            if d > 0 {
                factor *= INVERSE[d + 2];
                power[d] = t[1] * power[d - 1];
                for b in (1..d).rev() {
                    power[b] = t[0] * power[b] + t[1] * power[b - 1];
                }
                power[0] *= t[0];
                for b in 0..d + 1 {
                    let by_x = if b < d { s[0] * sums[row(d - 1 - b, b)] } else { 0.0 };
                    let by_y = if b > 0 { s[1] * sums[row(d - b, b - 1)] } else { 0.0 };
                    sums[row(d - b, b)] = power[b] + by_x + by_y;
                }
            }
            for b in 0..d + 1 {
                integrals.plain[row(d - b, b)] = factor * sums[row(d - b, b)];
                integrals.with_own[row(d - b, b)] = factor * INVERSE[d + 3] * sums[row(d - b, b)];
            }
        }
        integrals
    }

    /// By places with weights, in the coordinates of an element and about its corner `a`.
    pub fn of_places(element: &Element, a: usize, places: impl Iterator<Item = ([f64; 3], f64)>) -> Self {
        let [s, t] = [1, 2].map(|next| sub(element.corners[(a + next) % 3], element.corners[a]));
        let mut integrals = Self::ZERO;
        let mut basis = [0.0; MAX_MONOMIALS];
        for (lambda, weight) in places {
            let [by_s, by_t] = [1, 2].map(|next| lambda[(a + next) % 3]);
            monomials([0, 1].map(|d| by_s * s[d] + by_t * t[d]), P, &mut basis);
            for (m, value) in basis.iter().enumerate().take(n_monomials(P)) {
                integrals.plain[m] += weight * value;
                integrals.with_own[m] += weight * lambda[a] * value;
            }
        }
        integrals
    }

    const ZERO: Self = Self { plain: [0.0; MAX_MONOMIALS], with_own: [0.0; MAX_MONOMIALS] };

    /// Adds ∫g·∇(λ_aφ_m), g constant, to `moments`; `along` is g·∇λ_a.
    #[inline(always)]
    pub fn add_along(&self, g: [f64; 2], along: f64, moments: &mut [f64; MAX_MONOMIALS]) {
        for d in 0..P + 1 {
            for b in 0..d + 1 {
                // The derivative of hᵃkᵇ/(a! b!) along h is the monomial (a − 1, b).
                let by_x = if b < d { g[0] * self.with_own[row(d - 1 - b, b)] } else { 0.0 };
                let by_y = if b > 0 { g[1] * self.with_own[row(d - b, b - 1)] } else { 0.0 };
                moments[row(d - b, b)] += along * self.plain[row(d - b, b)] + by_x + by_y;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gauss::Rule;

    #[test]
    fn integrals_in_closed_form_are_those_of_a_rule_that_is_exact() {
        let corners = [[0.3, -0.2], [1.4, 0.1], [0.6, 0.9]];
        let element = Element {
            triangle: TriId::of(0),
            nodes: [0, 1, 2].map(NodeId::of),
            corners,
            area: 0.5 * nmt_geom::point::cross(sub(corners[1], corners[0]), sub(corners[2], corners[0])),
            slopes: barycentric_gradients(corners),
        };
        let rule = Rule::of(12).expect("a rule of twelve points"); // exact to degree 6
        for a in 0..3 {
            let places = rule.points.iter().zip(&rule.weights).map(|(lambda, weight)| (*lambda, weight * element.area));
            let by_points = CornerIntegrals::<MAX_ORDER>::of_places(&element, a, places);
            let closed = CornerIntegrals::<MAX_ORDER>::of_triangle(&element, a);
            for m in 0..MAX_MONOMIALS {
                assert!((closed.plain[m] - by_points.plain[m]).abs() < 1e-15, "corner {a}, monomial {m}"); // rounding
                assert!((closed.with_own[m] - by_points.with_own[m]).abs() < 1e-15, "corner {a}, monomial {m}");
            }
        }
    }
}
