//! ∫∇F·∇v over the triangles, F the trial function, v linear on each triangle; paper, eq. (18) \[D13\].
//!
//! The left side of the variational form (v a hat) and of the circulation on holes (v one around a hole) alike.

use crate::basis::{MAX_MONOMIALS, MAX_ORDER, n_monomials, row};
use crate::element::{CornerIntegrals, Element, side_means};
use crate::error::MfdmError;
use crate::flux::Fluxes;
use crate::gauss::Rule;
use crate::parallel::map_chunks;
use crate::problem::Trial;
use crate::shapes::{ShapeFinder, Shapes, TrialSpace};
use crate::stencils::Stencils;
use crate::system::RowSum;
use crate::true_edges::of_triangle;
use nmt_geom::point::{cross, dot, sub};
use nmt_geom::{NodeId, TriId};
use nmt_tri::{Mesh, barycentric};
use std::array::from_fn;

/// What a nodal polynomial contributes by its derivatives at the node.
type Moments = [f64; MAX_MONOMIALS];

/// Integrates the weak form.
pub(crate) struct WeakForm<'a> {
    fluxes: &'a Fluxes,
    rule: &'a Rule,
    degree: usize, // to which the rule is exact
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

/// Room for one row, to be used again for the next.
#[derive(Default)]
pub(crate) struct Gathered {
    nodes: Vec<NodeId>, // whose polynomials enter
    moments: Vec<Moments>,
    of_star: Vec<f64>, // of one of these nodes
}

impl Gathered {
    /// Place of the moments of a node, which are 0 at first.
    fn slot(&mut self, node: NodeId) -> usize {
        // Neighbours of one node are few and asked for in turn: a search from the end finds them at once.
        self.nodes.iter().rposition(|n| *n == node).unwrap_or_else(|| {
            self.nodes.push(node);
            self.moments.push([0.0; MAX_MONOMIALS]);
            self.nodes.len() - 1
        })
    }

    /// Adds what flows along a constant g through the side from the node in slot `from` to that in `to`: ∫(g·n)u, where u
    /// blends the polynomials of the two.
    #[inline(always)]
    fn add_side<const P: usize>(&mut self, g: [f64; 2], side: [f64; 2], [from, to]: [usize; 2]) {
        let means = side_means::<P>(side);
        let flow = cross(g, side);
        let mut way_back = flow;
        for d in 0..P + 1 {
            for m in (0..d + 1).map(|b| row(d - b, b)) {
                self.moments[from][m] += flow * means[m];
                self.moments[to][m] += way_back * means[m];
            }
            way_back = -way_back;
        }
    }
}

/// Nodes in the usual star of order 2: its loops are of known length.
const USUAL: usize = 9;

impl<'a> WeakForm<'a> {
    /// The blend of the polynomials of `stencils`.
    pub fn blended(stencils: &'a Stencils, fluxes: &'a Fluxes, rule: &'a Rule) -> Self {
        Self { fluxes, rule, degree: rule.degree(), trial: TrialGradients::Blended(stencils) }
    }

    /// The trial functions of `space`.
    ///
    /// # Errors
    /// [`MfdmError::PoorPlace`] where a Gauss point's star carries no polynomial.
    pub fn new(space: TrialSpace<'a>, fluxes: &'a Fluxes, rule: &'a Rule) -> Result<Self, MfdmError> {
        let mesh = space.mesh;
        if space.kind == Trial::Blended {
            return Ok(Self::blended(space.stencils, fluxes, rule));
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
        Ok(Self { fluxes, rule, degree: rule.degree(), trial })
    }

    /// Adds ∫∇F·∇v for the v whose constant gradient is told with each element: the row of coefficients of the nodal values.
    pub fn add<'e>(
        &self,
        elements: impl Iterator<Item = (&'e Element, [f64; 2])>,
        gathered: &mut Gathered,
        sum: &mut RowSum,
    ) {
        match &self.trial {
            TrialGradients::Blended(stencils) => match stencils.order() {
                // Loops of known length take half the time.
                0 => self.add_blended::<0>(stencils, elements, gathered, sum),
                1 => self.add_blended::<1>(stencils, elements, gathered, sum),
                2 => self.add_blended::<2>(stencils, elements, gathered, sum),
                3 => self.add_blended::<3>(stencils, elements, gathered, sum),
                _ => self.add_blended::<MAX_ORDER>(stencils, elements, gathered, sum),
            },
            TrialGradients::Integrated(integrals) => {
                for (element, slope) in elements {
                    let Integrals { nodes, by_x, by_y } = &integrals[element.triangle.index()];
                    for (k, &node) in nodes.iter().enumerate() {
                        sum.add(node, slope[0] * by_x[k] + slope[1] * by_y[k]);
                    }
                }
            }
        }
    }

    fn add_blended<'e, const P: usize>(
        &self,
        stencils: &Stencils,
        elements: impl Iterator<Item = (&'e Element, [f64; 2])>,
        gathered: &mut Gathered,
        sum: &mut RowSum,
    ) {
        gathered.nodes.clear();
        gathered.moments.clear();
        let is_exact = self.degree >= P;
        for (element, slope) in elements {
            let slots = element.nodes.map(|node| gathered.slot(node));
            if is_exact {
                // ∫∇u·g over a triangle is what flows along g through its sides.
                for (a, b) in [(0, 1), (1, 2), (2, 0)] {
                    let side = sub(element.corners[b], element.corners[a]);
                    gathered.add_side::<P>(slope, side, [slots[a], slots[b]]);
                }
            }
            let slivers = of_triangle(&self.fluxes.slivers, element.triangle);
            if is_exact && slivers.is_empty() {
                continue;
            }
            let points = self.rule.points.iter().zip(&self.rule.weights);
            let points = points.map(|(lambda, weight)| (*lambda, weight * element.area));
            let beyond = slivers.iter().map(|s| (barycentric(element.corners, s.at), s.weight));
            for (a, slot) in slots.into_iter().enumerate() {
                let places = points.clone().filter(|_| !is_exact).chain(beyond.clone());
                let along = dot(slope, element.slopes[a]);
                let integrals = CornerIntegrals::<P>::of_places(element, a, places);
                integrals.add_along(slope, along, &mut gathered.moments[slot]);
            }
        }
        for (&node, moments) in gathered.nodes.iter().zip(&gathered.moments) {
            if stencils.interpolates() {
                sum.add(node, moments[0]);
            }
            let stencil = stencils.of(node);
            // Rows are those of scaled coordinates.
            let scale = stencils.metric().stretch().map(|stretch| stretch / stencil.radius);
            let mut powers = [1.0; MAX_MONOMIALS];
            for degree in 1..=P {
                (0..degree).for_each(|b| powers[row(degree - b, b)] = scale[0] * powers[row(degree - 1 - b, b)]);
                powers[row(0, degree)] = scale[1] * powers[row(0, degree - 1)];
            }
            let factors: [f64; MAX_MONOMIALS] = from_fn(|m| moments[m] * powers[m]);
            let factors = &factors[stencil.first_row()..n_monomials(P)];
            if let Ok(nodes) = <&[NodeId; USUAL]>::try_from(stencil.nodes) {
                let of_star = combined::<USUAL>(stencil.rows(), factors);
                (0..USUAL).for_each(|i| sum.add(nodes[i], of_star[i]));
                continue;
            }
            let of_star = &mut gathered.of_star;
            of_star.clear();
            of_star.resize(stencil.nodes.len(), 0.0);
            for (m, factor) in (stencil.first_row()..).zip(factors) {
                of_star.iter_mut().zip(stencil.row(m)).for_each(|(total, coefficient)| *total += factor * coefficient);
            }
            stencil.nodes.iter().zip(of_star.iter()).for_each(|(&other, &total)| sum.add(other, total));
        }
    }
}

/// The sum of rows of `N` coefficients, each times its factor.
fn combined<const N: usize>(rows: &[f64], factors: &[f64]) -> [f64; N] {
    let mut total = [0.0; N];
    for (row, factor) in rows.as_chunks::<N>().0.iter().zip(factors) {
        (0..N).for_each(|i| total[i] += factor * row[i]);
    }
    total
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
