//! A triangle of the mesh, and the integrals of monomials about its corners over it and along its sides.

use crate::basis::{INVERSE, monomials, row};
use crate::blend::barycentric_gradients;
use nmt_geom::point::{cross, sub};
use nmt_geom::{NodeId, Point, TriId};
use nmt_tri::Mesh;

/// A triangle with what the weak form asks of it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Element {
    pub triangle: TriId,
    pub nodes: [NodeId; 3],
    pub corners: [Point; 3],
    pub area: f64,
}

impl Element {
    #[inline(always)]
    pub fn new(mesh: &Mesh, triangle: TriId) -> Self {
        let nodes = mesh.tri_nodes()[triangle.index()];
        let [a, b, c] = nodes.map(|node| mesh.xy()[node.index()]);
        // As the mesh has it, without another look at the corners.
        Self { triangle, nodes, corners: [a, b, c], area: cross(sub(b, a), sub(c, a)) / 2.0 }
    }

    /// Gradients of the hats of its nodes.
    pub fn slopes(&self) -> [[f64; 2]; 3] {
        barycentric_gradients(self.corners)
    }

    /// A triangle with one of its nodes first, which lies `at` its place.
    #[inline(always)]
    pub fn about(mesh: &Mesh, triangle: TriId, node: NodeId, at: Point) -> Self {
        let [a, b, c] = mesh.tri_nodes()[triangle.index()];
        // Which of three it is cannot be foreseen: looked up, not branched on.
        let first = usize::from(b == node) + 2 * usize::from(c == node);
        let following = [b, c, a, b, b];
        let (next, last) = (following[first], following[first + 1]);
        let [from, to] = [next, last].map(|node| mesh.xy()[node.index()]);
        let area = cross(sub(from, at), sub(to, at)) / 2.0;
        Self { triangle, nodes: [node, next, last], corners: [at, from, to], area }
    }
}

/// Means of λ_aφ_m along the side from a corner a to another, φ_m the N monomials of degree ≤ P about a; see [`row`].
///
/// At the share t of the side s, λ_a is 1 − t and φ_m, of degree d, tᵈ times what it is at the end: the mean is
/// φ_m(s)/((d + 1)(d + 2)). About the other end s is −s, so that the means of odd degree change their sign.
#[inline(always)]
pub(crate) fn side_means<const P: usize, const N: usize>(side: [f64; 2]) -> [f64; N] {
    let mut means = [0.0; N];
    monomials(side, P, &mut means);
    for d in 0..P + 1 {
        (0..d + 1).for_each(|b| means[row(d - b, b)] *= INVERSE[d + 1] * INVERSE[d + 2]);
    }
    means
}

/// ∫φ_m and ∫λ_aφ_m, φ_m the N monomials of degree ≤ P about a corner a in (x − x_a, y − y_a); see [`row`].
pub(crate) struct CornerIntegrals<const P: usize, const N: usize> {
    plain: [f64; N],
    with_own: [f64; N],
}

impl<const P: usize, const N: usize> CornerIntegrals<P, N> {
    /// By places with weights, in the coordinates of an element and about its corner `a`.
    pub fn of_places(element: &Element, a: usize, places: impl Iterator<Item = ([f64; 3], f64)>) -> Self {
        let [s, t] = [1, 2].map(|next| sub(element.corners[(a + next) % 3], element.corners[a]));
        let mut integrals = Self::ZERO;
        let mut basis = [0.0; N];
        for (lambda, weight) in places {
            let [by_s, by_t] = [1, 2].map(|next| lambda[(a + next) % 3]);
            monomials([0, 1].map(|d| by_s * s[d] + by_t * t[d]), P, &mut basis);
            for (m, value) in basis.iter().enumerate() {
                integrals.plain[m] += weight * value;
                integrals.with_own[m] += weight * lambda[a] * value;
            }
        }
        integrals
    }

    const ZERO: Self = Self { plain: [0.0; N], with_own: [0.0; N] };

    /// Adds ∫g·∇(λ_aφ_m), g constant, to `moments`; `along` is g·∇λ_a.
    #[inline(always)]
    pub fn add_along(&self, g: [f64; 2], along: f64, moments: &mut [f64; N]) {
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
    use crate::basis::{MAX_MONOMIALS, MAX_ORDER};
    use crate::gauss::Rule;
    use nmt_geom::point::dot;

    #[test]
    fn the_flow_through_the_sides_is_that_of_a_rule_that_is_exact() {
        let corners = [[0.3, -0.2], [1.4, 0.1], [0.6, 0.9]];
        let element = Element {
            triangle: TriId::of(0),
            nodes: [0, 1, 2].map(NodeId::of),
            corners,
            area: 0.5 * cross(sub(corners[1], corners[0]), sub(corners[2], corners[0])),
        };
        let rule = Rule::of(12).expect("a rule of twelve points"); // exact to degree 6
        let slope = [0.7, -1.3];
        for a in 0..3 {
            let (mut by_points, mut by_sides) = ([0.0; MAX_MONOMIALS], [0.0; MAX_MONOMIALS]);
            let places = rule.points.iter().zip(&rule.weights).map(|(lambda, weight)| (*lambda, weight * element.area));
            let integrals = CornerIntegrals::<MAX_ORDER, MAX_MONOMIALS>::of_places(&element, a, places);
            integrals.add_along(slope, dot(slope, element.slopes()[a]), &mut by_points);
            // λ_a is 0 on the third side.
            for (other, way) in [((a + 1) % 3, 1.0), ((a + 2) % 3, -1.0)] {
                let side = sub(corners[other], corners[a]);
                let means = side_means::<MAX_ORDER, MAX_MONOMIALS>(side);
                (0..MAX_MONOMIALS).for_each(|m| by_sides[m] += way * cross(slope, side) * means[m]);
            }
            for m in 0..MAX_MONOMIALS {
                assert!((by_sides[m] - by_points[m]).abs() < 1e-15, "corner {a}, monomial {m}"); // rounding
            }
        }
    }
}
