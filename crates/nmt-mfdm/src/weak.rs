//! ∫∇F·∇v over the triangles, F the blend of the nodal polynomials, v linear on each triangle; paper, eq. (18) \[D13\].
//!
//! The left side of the variational form (v a hat) and of the circulation on holes (v one around a hole) alike.

use crate::basis::{MAX_MONOMIALS, monomials, n_monomials, row};
use crate::blend::barycentric_gradients;
use crate::gauss::{Rule, three_points};
use crate::stencils::Stencils;
use crate::system::RowSum;
use nmt_geom::{NodeId, TriId};
use nmt_tri::Mesh;

/// What a nodal polynomial contributes by its Taylor coefficients.
type Moments = [f64; MAX_MONOMIALS];

/// Integrates the weak form for the polynomials of `stencils`.
pub(crate) struct WeakForm<'a> {
    mesh: &'a Mesh,
    stencils: &'a Stencils,
    rule: Rule,
}

/// Room for one row, to be used again for the next.
#[derive(Default)]
pub(crate) struct Gathered {
    nodes: Vec<NodeId>,
    moments: Vec<Moments>,
}

impl<'a> WeakForm<'a> {
    /// Three Gauss points are exact for order 2: the gradient of the blend is then quadratic.
    pub fn new(mesh: &'a Mesh, stencils: &'a Stencils) -> Self {
        Self { mesh, stencils, rule: three_points() }
    }

    /// Adds ∫∇F·∇v for the v whose constant gradient is `slope(t, k)` of the triangles given: the row of coefficients of
    /// the nodal values.
    pub fn add(&self, triangles: impl Iterator<Item = (TriId, [f64; 2])>, gathered: &mut Gathered, sum: &mut RowSum) {
        gathered.nodes.clear();
        gathered.moments.clear();
        for (triangle, slope) in triangles {
            for corner in 0..3 {
                self.gather(triangle, corner, slope, gathered);
            }
        }
        let n = n_monomials(self.stencils.order());
        for (&node, moments) in gathered.nodes.iter().zip(&gathered.moments) {
            sum.add(node, moments[0]);
            let stencil = self.stencils.of(node);
            for (m, moment) in moments.iter().enumerate().take(n).skip(1) {
                for (&other, coefficient) in stencil.nodes.iter().zip(stencil.row(m)) {
                    sum.add(other, moment * coefficient);
                }
            }
        }
    }

    /// Adds ∫ slope·∇(λ_a φ_m) over the triangle for every monomial φ_m of corner a.
    fn gather(&self, triangle: TriId, corner: usize, slope: [f64; 2], gathered: &mut Gathered) {
        let corners = self.mesh.corners(triangle);
        let node = self.mesh.tri_nodes()[triangle.index()][corner];
        let radius = self.stencils.of(node).radius;
        let [s_x, s_y] = self.stencils.metric().stretch().map(|stretch| stretch / radius);
        let order = self.stencils.order();
        let area = self.mesh.area(triangle);
        let lambda_slope = barycentric_gradients(corners)[corner];
        let along = slope[0] * lambda_slope[0] + slope[1] * lambda_slope[1];
        // Neighbours of one node are few and asked for in turn: a search from the end finds them at once.
        let slot = gathered.nodes.iter().rposition(|n| *n == node).unwrap_or_else(|| {
            gathered.nodes.push(node);
            gathered.moments.push([0.0; MAX_MONOMIALS]);
            gathered.nodes.len() - 1
        });
        let moments = &mut gathered.moments[slot];
        let mut basis = [0.0; MAX_MONOMIALS];
        for (lambda, weight) in self.rule.points.iter().zip(&self.rule.weights) {
            let offset = |d: usize| (0..3).map(|a| lambda[a] * (corners[a][d] - corners[corner][d])).sum::<f64>();
            monomials([offset(0) * s_x, offset(1) * s_y], order, &mut basis);
            let (value_part, slope_part) = (weight * area * along, weight * area * lambda[corner]);
            for degree in 0..=order {
                for b in 0..=degree {
                    let a = degree - b;
                    let by_x = if a > 0 { slope[0] * s_x * basis[row(a - 1, b)] } else { 0.0 };
                    let by_y = if b > 0 { slope[1] * s_y * basis[row(a, b - 1)] } else { 0.0 };
                    moments[row(a, b)] += value_part * basis[row(a, b)] + slope_part * (by_x + by_y);
                }
            }
        }
    }
}
