//! ∫∇F·∇v over the triangles, F the trial function, v linear on each triangle; paper, eq. (18) \[D13\].
//!
//! The left side of the variational form (v a hat) and of the circulation on holes (v one around a hole) alike.

use crate::basis::{MAX_MONOMIALS, MAX_ORDER, n_monomials, row};
use crate::blend::place;
use crate::element::{CornerIntegrals, Element, side_means};
use crate::error::MfdmError;
use crate::flux::Fluxes;
use crate::gauss::Rule;
use crate::hat::Hat;
use crate::parallel::map_chunks;
use crate::problem::Trial;
use crate::row_sum::RowSum;
use crate::shapes::{ShapeFinder, Shapes, TrialSpace};
use crate::stencils::Stencils;
use crate::true_edges::of_triangle;
use nmt_geom::point::{cross, dot, sub};
use nmt_geom::{NodeId, TriId};
use nmt_tri::{Mesh, barycentric};

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

/// A test function v, or a part of one.
#[derive(Clone, Copy)]
pub(crate) enum TestFunction<'e> {
    /// Linear on one element, with this gradient.
    Linear(&'e Element, [f64; 2]),
    /// The hat of a node.
    Hat(&'e Hat),
}

/// Room for one row, to be used again for the next.
#[derive(Default)]
pub(crate) struct Gathered {
    nodes: Vec<NodeId>, // whose polynomials enter
    moments: Vec<f64>,  // what each contributes by its derivatives at its node, shape (n, n_monomials)
    spokes: Vec<Spoke>, // from the node of a hat, in slot 0, to the others; shape (n - 1,)
    ends: Vec<usize>,   // the spoke of the last side of each element about it
    of_star: Vec<f64>,  // of one of these nodes
}

/// The side between the node of a hat and a node around it.
struct Spoke {
    side: [f64; 2],
    /// Flow through it along the gradients of the hat on both sides of it.
    flow: f64,
}

impl Gathered {
    fn clear(&mut self) {
        self.nodes.clear();
        self.moments.clear();
        self.spokes.clear();
        self.ends.clear();
    }

    /// Place of the moments of a node, which are 0 at first.
    fn slot<const N: usize>(&mut self, node: NodeId) -> usize {
        self.nodes.iter().position(|n| *n == node).unwrap_or_else(|| self.new_slot::<N>(node))
    }

    /// A place for the moments of a node that has none.
    fn new_slot<const N: usize>(&mut self, node: NodeId) -> usize {
        self.nodes.push(node);
        self.moments.extend([0.0; N]);
        self.nodes.len() - 1
    }

    /// Places for the moments of the node of a hat, in slot 0, and of the nodes around it, the second of each element first;
    /// with the spokes between.
    #[inline(always)]
    fn begin_hat<const N: usize>(&mut self, node: NodeId, hat: &Hat) {
        let spoke =
            |element: &Element, end: usize| Spoke { side: sub(element.corners[end], element.corners[0]), flow: 0.0 };
        self.nodes.push(node);
        for element in hat.elements() {
            self.nodes.push(element.nodes[1]);
            self.spokes.push(spoke(element, 1));
        }
        for element in hat.elements() {
            let last = element.nodes[2];
            // The element that follows counter-clockwise has its spoke; at the boundary none does.
            let end = hat.element_from(last).unwrap_or_else(|| {
                self.nodes.push(last);
                self.spokes.push(spoke(element, 2));
                self.spokes.len() - 1
            });
            self.ends.push(end);
        }
        self.moments.resize(self.nodes.len() * N, 0.0);
    }
}

/// Adds what flows through the side from the node in slot `from` to that in `to`: `flow` times the mean of u, which blends
/// the polynomials of the two, along it.
#[inline(always)]
fn add_side<const P: usize, const N: usize>(
    moments: &mut [[f64; N]],
    flow: f64,
    side: [f64; 2],
    [from, to]: [usize; 2],
) {
    let means = side_means::<P, N>(side);
    for (moment, mean) in moments[from].iter_mut().zip(&means) {
        *moment += flow * mean;
    }
    let to = &mut moments[to];
    let mut way_back = flow;
    for d in 0..P + 1 {
        (0..d + 1).for_each(|b| to[row(d - b, b)] += way_back * means[row(d - b, b)]);
        way_back = -way_back;
    }
}

/// Nodes in the usual star of order 2, and its rows where it interpolates: their loops are of known length.
const USUAL: usize = 9;
const USUAL_ROWS: usize = n_monomials(2) - 1;

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

    /// Adds ∫∇F·∇v: the row of coefficients of the nodal values.
    #[inline(always)]
    pub fn add(&self, test: TestFunction, gathered: &mut Gathered, sum: &mut RowSum) {
        match &self.trial {
            TrialGradients::Blended(stencils) => match stencils.order() {
                // Loops of known length take half the time.
                0 => self.add_blended::<0, { n_monomials(0) }>(stencils, test, gathered, sum),
                1 => self.add_blended::<1, { n_monomials(1) }>(stencils, test, gathered, sum),
                2 => self.add_blended::<2, { n_monomials(2) }>(stencils, test, gathered, sum),
                3 => self.add_blended::<3, { n_monomials(3) }>(stencils, test, gathered, sum),
                _ => self.add_blended::<MAX_ORDER, MAX_MONOMIALS>(stencils, test, gathered, sum),
            },
            TrialGradients::Integrated(integrals) => match test {
                TestFunction::Linear(element, g) => add_integrated(integrals, element, g, sum),
                TestFunction::Hat(hat) => {
                    hat.elements().iter().for_each(|e| add_integrated(integrals, e, e.slopes()[0], sum));
                }
            },
        }
    }

    #[inline(always)]
    fn add_blended<const P: usize, const N: usize>(
        &self,
        stencils: &Stencils,
        test: TestFunction,
        gathered: &mut Gathered,
        sum: &mut RowSum,
    ) {
        gathered.clear();
        match test {
            TestFunction::Linear(element, g) => self.gather_linear::<P, N>(element, g, gathered),
            TestFunction::Hat(hat) => self.gather_hat::<P, N>(hat, gathered),
        }
        spread::<P, N>(stencils, gathered, sum);
    }

    fn gather_linear<const P: usize, const N: usize>(&self, element: &Element, g: [f64; 2], gathered: &mut Gathered) {
        let slots = element.nodes.map(|node| gathered.slot::<N>(node));
        let moments = gathered.moments.as_chunks_mut::<N>().0;
        if self.is_exact::<P>() {
            // ∫∇u·g over a triangle is what flows along g through its sides.
            for (a, b) in [(0, 1), (1, 2), (2, 0)] {
                let side = sub(element.corners[b], element.corners[a]);
                add_side::<P, N>(moments, cross(g, side), side, [slots[a], slots[b]]);
            }
        }
        self.add_places::<P, N>(element, g, slots, moments);
    }

    #[inline(always)]
    fn gather_hat<const P: usize, const N: usize>(&self, hat: &Hat, gathered: &mut Gathered) {
        let elements = hat.elements();
        let Some(node) = elements.first().map(|element| element.nodes[0]) else { return };
        gathered.begin_hat::<N>(node, hat);
        // What is looked up through `gathered` would be read again after every sum.
        let (spokes, moments) = (gathered.spokes.as_mut_slice(), gathered.moments.as_chunks_mut::<N>().0);
        for (k, (element, &end)) in elements.iter().zip(&gathered.ends).enumerate() {
            let [at, from, to] = element.corners;
            let (opposite, factor) = (sub(to, from), -0.5 / element.area);
            // The gradient of the hat is normal to the opposite side, and 1 over the height.
            let flow = |side: [f64; 2]| factor * dot(opposite, side);
            let (out, back) = (sub(from, at), sub(to, at));
            spokes[k].flow += flow(out);
            spokes[end].flow -= flow(back);
            let slots = [k + 1, end + 1];
            if self.is_exact::<P>() {
                add_side::<P, N>(moments, flow(opposite), opposite, slots);
            }
            if !self.is_exact::<P>() || !of_triangle(&self.fluxes.slivers, element.triangle).is_empty() {
                self.add_places::<P, N>(element, element.slopes()[0], [0, slots[0], slots[1]], moments);
            }
        }
        if self.is_exact::<P>() {
            for (k, &Spoke { side, flow }) in spokes.iter().enumerate() {
                add_side::<P, N>(moments, flow, side, [0, k + 1]);
            }
        }
    }

    /// Whether the rule integrates the blend exactly, as the sides do.
    fn is_exact<const P: usize>(&self) -> bool {
        self.degree >= P
    }

    /// Adds what the rule integrates, where it is not exact, and what lies beyond an element's segments.
    fn add_places<const P: usize, const N: usize>(
        &self,
        element: &Element,
        g: [f64; 2],
        slots: [usize; 3],
        moments: &mut [[f64; N]],
    ) {
        let points = self.rule.points.iter().zip(&self.rule.weights).filter(|_| !self.is_exact::<P>());
        let points = points.map(|(lambda, weight)| (*lambda, weight * element.area));
        let slivers = of_triangle(&self.fluxes.slivers, element.triangle).iter();
        let beyond = slivers.map(|sample| (barycentric(element.corners, sample.at), sample.weight));
        let slopes = element.slopes();
        for (a, slot) in slots.into_iter().enumerate() {
            let integrals = CornerIntegrals::<P, N>::of_places(element, a, points.clone().chain(beyond.clone()));
            integrals.add_along(g, dot(g, slopes[a]), &mut moments[slot]);
        }
    }
}

fn add_integrated(integrals: &[Integrals], element: &Element, g: [f64; 2], sum: &mut RowSum) {
    let Integrals { nodes, by_x, by_y } = &integrals[element.triangle.index()];
    for (k, &node) in nodes.iter().enumerate() {
        sum.add(node, g[0] * by_x[k] + g[1] * by_y[k]);
    }
}

/// Adds what the polynomials of the nodes gathered make of the nodal values.
#[inline(always)]
fn spread<const P: usize, const N: usize>(stencils: &Stencils, gathered: &mut Gathered, sum: &mut RowSum) {
    let stretch = stencils.metric().stretch();
    for (&node, moments) in gathered.nodes.iter().zip(gathered.moments.as_chunks::<N>().0) {
        let stencil = stencils.of(node);
        // Rows are those of scaled coordinates.
        let inverse = 1.0 / stencil.radius;
        let scale = stretch.map(|stretch| stretch * inverse);
        let mut powers = [1.0; N];
        for degree in 1..P + 1 {
            (0..degree).for_each(|b| powers[row(degree - b, b)] = scale[0] * powers[row(degree - 1 - b, b)]);
            powers[row(0, degree)] = scale[1] * powers[row(0, degree - 1)];
        }
        (0..N).for_each(|m| powers[m] *= moments[m]);
        let factors = &powers[stencil.first_row()..];
        if let (Ok(nodes), Some(marks)) = (<&[NodeId; USUAL]>::try_from(stencil.nodes), stencil.marks()) {
            let rows = stencil.rows().as_chunks().0;
            // Loops of known length take half the time.
            let of_star = match (<&[_; USUAL_ROWS]>::try_from(rows), <&[_; USUAL_ROWS]>::try_from(factors)) {
                (Ok(rows), Ok(factors)) => combined::<USUAL>(rows, factors),
                _ => combined::<USUAL>(rows, factors),
            };
            sum.add_marked(marks, nodes, &of_star);
            if stencil.first_row() == 1 {
                // A star has its own node.
                sum.add_again(node, moments[0]);
            }
            continue;
        }
        if stencils.interpolates() {
            sum.add(node, moments[0]);
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

/// The sum of rows of `N` coefficients, each times its factor.
#[inline(always)]
fn combined<const N: usize>(rows: &[[f64; N]], factors: &[f64]) -> [f64; N] {
    let mut total = [0.0; N];
    for (row, factor) in rows.iter().zip(factors) {
        for (total, coefficient) in total.iter_mut().zip(row) {
            *total += factor * coefficient;
        }
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
    let own =
        rule.points.iter().zip(&rule.weights).map(move |(lambda, weight)| (place(corners, *lambda), weight * area));
    own.chain(of_triangle(&fluxes.slivers, triangle).iter().map(|sample| (sample.at, sample.weight)))
}
