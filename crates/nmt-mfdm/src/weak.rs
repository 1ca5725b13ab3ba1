//! ∫∇F·∇v over the triangles, F the trial function, v linear on each triangle; paper, eq. (18) \[D13\].
//!
//! The left side of the variational form (v a hat) and of the circulation on holes (v one around a hole) alike.

use crate::basis::{MAX_MONOMIALS, MAX_ORDER, monomials, n_monomials, row};
use crate::blend::barycentric_gradients;
use crate::error::MfdmError;
use crate::flux::Fluxes;
use crate::gauss::Rule;
use crate::parallel::map_chunks;
use crate::problem::Trial;
use crate::shapes::{ShapeFinder, Shapes, TrialSpace};
use crate::stencils::Stencils;
use crate::system::RowSum;
use crate::true_edges::of_triangle;
use nmt_geom::{NodeId, TriId};
use nmt_tri::{Mesh, barycentric};

/// What a nodal polynomial contributes by its Taylor coefficients.
type Moments = [f64; MAX_MONOMIALS];

/// Integrates the weak form.
pub(crate) struct WeakForm<'a> {
    mesh: &'a Mesh,
    fluxes: &'a Fluxes,
    rule: &'a Rule,
    trial: TrialGradients<'a>,
}

/// Where the gradient of the trial function comes from.
enum TrialGradients<'a> {
    /// From the nodal polynomials.
    Blended(&'a Stencils),
    /// ∫∇φ_j over each triangle, computed before.
    Integrated(Vec<Integrals>),
}

/// ∫∇φ_j over one triangle, by node.
#[derive(Clone, Debug, Default)]
struct Integrals {
    nodes: Vec<NodeId>,
    by_x: Vec<f64>,
    by_y: Vec<f64>,
}

/// Room for one row, to be used again for the next; and the integrals over triangles that the last rows needed.
///
/// Each triangle enters three rows, and in the order of the nodes these are not far from each other. Whoever changes the
/// stencils begins anew.
#[derive(Default)]
pub(crate) struct Gathered {
    nodes: Vec<NodeId>,
    moments: Vec<Moments>,
    of_star: Vec<f64>,        // of one of these nodes
    kept: Vec<TriId>,         // the triangle in each slot
    integrals: Vec<[f64; 2]>, // slot after slot, corner after corner, ∫∇(λ_a φ_m) of every monomial
}

/// Triangles whose integrals are kept, at most: some rows of a cloud of 10⁶ nodes.
const KEPT: usize = 1 << 14;

/// The triangle of an empty slot.
const EMPTY: TriId = TriId(u32::MAX);

impl<'a> WeakForm<'a> {
    /// The blend of the polynomials of `stencils`.
    pub fn blended(mesh: &'a Mesh, stencils: &'a Stencils, fluxes: &'a Fluxes, rule: &'a Rule) -> Self {
        Self { mesh, fluxes, rule, trial: TrialGradients::Blended(stencils) }
    }

    /// The trial functions of `space`.
    ///
    /// # Errors
    /// [`MfdmError::PoorPlace`] where a Gauss point's star carries no polynomial.
    pub fn new(space: TrialSpace<'a>, fluxes: &'a Fluxes, rule: &'a Rule) -> Result<Self, MfdmError> {
        let mesh = space.mesh;
        if space.kind == Trial::Blended {
            return Ok(Self::blended(mesh, space.stencils, fluxes, rule));
        }
        let pieces = map_chunks(0..mesh.n_triangles(), |piece| {
            let (mut finder, mut shapes) = (ShapeFinder::new(space), Shapes::default());
            let mut sums = [0, 1].map(|_| RowSum::new(mesh.cloud().n_nodes()));
            let mut integrals = Vec::with_capacity(piece.len());
            for t in piece.map(TriId::of) {
                for (p, weight) in places(mesh, rule, fluxes, t) {
                    finder.at(t, p, &mut shapes)?;
                    for (k, &node) in shapes.nodes.iter().enumerate() {
                        sums[0].add(node, weight * shapes.by_x[k]);
                        sums[1].add(node, weight * shapes.by_y[k]);
                    }
                }
                let mut own = Integrals::default();
                sums[0].drain(|node, sum| {
                    own.nodes.push(node);
                    own.by_x.push(sum);
                });
                sums[1].drain(|_, sum| own.by_y.push(sum));
                integrals.push(own);
            }
            Ok(integrals)
        });
        let integrals = pieces.into_iter().collect::<Result<Vec<_>, MfdmError>>()?;
        let trial = TrialGradients::Integrated(integrals.into_iter().flatten().collect());
        Ok(Self { mesh, fluxes, rule, trial })
    }

    /// Adds ∫∇F·∇v for the v whose constant gradient is `slope(t, k)` of the triangles given: the row of coefficients of
    /// the nodal values.
    pub fn add(&self, triangles: impl Iterator<Item = (TriId, [f64; 2])>, gathered: &mut Gathered, sum: &mut RowSum) {
        match &self.trial {
            TrialGradients::Blended(stencils) => self.add_blended(stencils, triangles, gathered, sum),
            TrialGradients::Integrated(integrals) => {
                for (triangle, slope) in triangles {
                    let Integrals { nodes, by_x, by_y } = &integrals[triangle.index()];
                    for (k, &node) in nodes.iter().enumerate() {
                        sum.add(node, slope[0] * by_x[k] + slope[1] * by_y[k]);
                    }
                }
            }
        }
    }

    fn add_blended(
        &self,
        stencils: &Stencils,
        triangles: impl Iterator<Item = (TriId, [f64; 2])>,
        gathered: &mut Gathered,
        sum: &mut RowSum,
    ) {
        gathered.nodes.clear();
        gathered.moments.clear();
        let n = n_monomials(stencils.order());
        if gathered.kept.is_empty() {
            let slots = KEPT.min(self.mesh.n_triangles());
            gathered.kept = vec![EMPTY; slots];
            gathered.integrals = vec![[0.0; 2]; 3 * n * slots];
        }
        for (triangle, slope) in triangles {
            let slot = triangle.index() % gathered.kept.len();
            let integrals = &mut gathered.integrals[3 * n * slot..3 * n * (slot + 1)];
            if gathered.kept[slot] != triangle {
                gathered.kept[slot] = triangle;
                let corners = integrals.chunks_exact_mut(n).enumerate();
                corners.for_each(|(corner, own)| self.integrate(stencils, triangle, corner, own));
            }
            for (corner, own) in integrals.chunks_exact(n).enumerate() {
                let node = self.mesh.tri_nodes()[triangle.index()][corner];
                // Neighbours of one node are few and asked for in turn: a search from the end finds them at once.
                let slot = gathered.nodes.iter().rposition(|n| *n == node).unwrap_or_else(|| {
                    gathered.nodes.push(node);
                    gathered.moments.push([0.0; MAX_MONOMIALS]);
                    gathered.nodes.len() - 1
                });
                let moments = gathered.moments[slot].iter_mut().zip(own);
                moments.for_each(|(moment, by)| *moment += slope[0] * by[0] + slope[1] * by[1]);
            }
        }
        for (&node, moments) in gathered.nodes.iter().zip(&gathered.moments) {
            if stencils.interpolates() {
                sum.add(node, moments[0]);
            }
            let stencil = stencils.of(node);
            let of_star = &mut gathered.of_star;
            of_star.clear();
            of_star.resize(stencil.nodes.len(), 0.0);
            for (m, moment) in moments.iter().enumerate().take(n).skip(stencil.first_row()) {
                of_star.iter_mut().zip(stencil.row(m)).for_each(|(total, coefficient)| *total += moment * coefficient);
            }
            stencil.nodes.iter().zip(of_star.iter()).for_each(|(&other, &total)| sum.add(other, total));
        }
    }

    /// ∫∇(λ_a φ_m) over the triangle, and the slivers at its segments, for every monomial φ_m of corner a.
    fn integrate(&self, stencils: &Stencils, triangle: TriId, corner: usize, integrals: &mut [[f64; 2]]) {
        // Loops of known length take half the time.
        match stencils.order() {
            0 => self.integrate_order::<0>(stencils, triangle, corner, integrals),
            1 => self.integrate_order::<1>(stencils, triangle, corner, integrals),
            2 => self.integrate_order::<2>(stencils, triangle, corner, integrals),
            3 => self.integrate_order::<3>(stencils, triangle, corner, integrals),
            _ => self.integrate_order::<MAX_ORDER>(stencils, triangle, corner, integrals),
        }
    }

    #[inline(always)]
    fn integrate_order<const P: usize>(
        &self,
        stencils: &Stencils,
        triangle: TriId,
        corner: usize,
        integrals: &mut [[f64; 2]],
    ) {
        let corners = self.mesh.corners(triangle);
        let node = self.mesh.tri_nodes()[triangle.index()][corner];
        let radius = stencils.of(node).radius;
        let [s_x, s_y] = stencils.metric().stretch().map(|stretch| stretch / radius);
        let area = self.mesh.area(triangle);
        let lambda_slope = barycentric_gradients(corners)[corner];
        integrals.fill([0.0; 2]);
        let mut basis = [0.0; MAX_MONOMIALS];
        let mut add = |lambda: &[f64; 3], weight: f64| {
            let offset = |d: usize| (0..3).map(|a| lambda[a] * (corners[a][d] - corners[corner][d])).sum::<f64>();
            monomials([offset(0) * s_x, offset(1) * s_y], P, &mut basis);
            let value_part = lambda_slope.map(|slope| weight * slope);
            let slope_part = [weight * lambda[corner] * s_x, weight * lambda[corner] * s_y];
            for degree in 0..=P {
                for b in 0..=degree {
                    let a = degree - b;
                    let by_x = if a > 0 { basis[row(a - 1, b)] } else { 0.0 };
                    let by_y = if b > 0 { basis[row(a, b - 1)] } else { 0.0 };
                    let (value, sum) = (basis[row(a, b)], &mut integrals[row(a, b)]);
                    sum[0] += value_part[0] * value + slope_part[0] * by_x;
                    sum[1] += value_part[1] * value + slope_part[1] * by_y;
                }
            }
        };
        for (lambda, weight) in self.rule.points.iter().zip(&self.rule.weights) {
            add(lambda, weight * area);
        }
        if !self.fluxes.slivers.is_empty() {
            for sample in of_triangle(&self.fluxes.slivers, triangle) {
                add(&barycentric(corners, sample.at), sample.weight);
            }
        }
    }
}

/// The Gauss points of a triangle and of the slivers at its segments, with their weights (areas).
pub(crate) fn places<'m>(
    mesh: &'m Mesh,
    rule: &'m Rule,
    fluxes: &'m Fluxes,
    triangle: TriId,
) -> impl Iterator<Item = ([f64; 2], f64)> + 'm {
    let (corners, area) = (mesh.corners(triangle), mesh.area(triangle));
    let own = rule.points.iter().zip(&rule.weights).map(move |(lambda, weight)| {
        let at = |d: usize| (0..3).map(|a| lambda[a] * corners[a][d]).sum::<f64>();
        ([at(0), at(1)], weight * area)
    });
    own.chain(of_triangle(&fluxes.slivers, triangle).iter().map(|sample| (sample.at, sample.weight)))
}
