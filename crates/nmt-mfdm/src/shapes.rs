//! Shape functions at any place: what each nodal value contributes to the trial function and its gradient there; paper,
//! eq. (18) \[D13\].

use crate::basis::{MAX_MONOMIALS, monomials, n_monomials, row};
use crate::blend::{barycentric_gradients, place};
use crate::error::MfdmError;
use crate::mwls::{MAX_CONDITION, Mwls};
use crate::problem::Trial;
use crate::row_sum::RowSum;
use crate::star::StarFinder;
use crate::stencils::{StarParams, Stencils};
use crate::surroundings::Surroundings;
use nmt_cloud::Nearest;
use nmt_geom::{NodeId, Point, TriId};
use nmt_tri::{Mesh, barycentric};

/// Shape functions at one place; the vectors are of one length.
#[derive(Clone, Debug, Default)]
pub(crate) struct Shapes {
    /// Nodes, ascending.
    pub nodes: Vec<NodeId>,
    /// φ_j.
    pub value: Vec<f64>,
    /// ∂φ_j/∂x.
    pub by_x: Vec<f64>,
    /// ∂φ_j/∂y.
    pub by_y: Vec<f64>,
}

/// What shape functions are made from.
#[derive(Clone, Copy)]
pub(crate) struct TrialSpace<'a> {
    pub kind: Trial,
    pub mesh: &'a Mesh,
    /// Of every node, for blends.
    pub stencils: &'a Stencils,
    pub surroundings: &'a Surroundings<'a>,
    pub nearest: &'a Nearest<'a>,
    /// Of the stars about places that are no nodes, for [`Trial::Mwls`].
    pub params: StarParams,
}

/// Evaluates shape functions; one a thread, with room to be used again.
pub(crate) struct ShapeFinder<'a> {
    space: TrialSpace<'a>,
    finder: StarFinder<'a>,
    mwls: Mwls,
    star: Vec<NodeId>,
    rows: Vec<f64>,
    sums: [RowSum; 3],
}

impl<'a> ShapeFinder<'a> {
    pub fn new(space: TrialSpace<'a>) -> Self {
        let sum = || RowSum::new(space.mesh.cloud().n_nodes());
        Self {
            space,
            finder: StarFinder::new(space.surroundings, space.nearest, space.params.choice),
            mwls: Mwls::default(),
            star: Vec::new(),
            rows: Vec::new(),
            sums: [sum(), sum(), sum()],
        }
    }

    /// The shape functions at `p` in `triangle`, into `out`. Of a place beyond the triangle (the sliver between a segment
    /// and its curve) blends are continued; stars are those of the nearest place on the triangle.
    ///
    /// # Errors
    /// [`MfdmError::PoorPlace`] where no star of the place carries the polynomial.
    pub fn at(&mut self, triangle: TriId, p: Point, out: &mut Shapes) -> Result<(), MfdmError> {
        [&mut out.value, &mut out.by_x, &mut out.by_y].into_iter().for_each(Vec::clear);
        out.nodes.clear();
        match self.space.kind {
            Trial::Blended => self.blended(triangle, p, out),
            Trial::Mwls => return self.moving(triangle, p, out),
        }
        Ok(())
    }

    /// φ_j = Σ_a λ_a·(what node j contributes to the polynomial of corner a).
    fn blended(&mut self, triangle: TriId, p: Point, out: &mut Shapes) {
        let TrialSpace { mesh, stencils, .. } = self.space;
        let corners = mesh.corners(triangle);
        let (lambda, slopes) = (barycentric(corners, p), barycentric_gradients(corners));
        let order = stencils.order();
        for (a, &node) in mesh.tri_nodes()[triangle.index()].iter().enumerate() {
            let stencil = stencils.of(node);
            let [s_x, s_y] = stencils.metric().stretch().map(|stretch| stretch / stencil.radius);
            let mut basis = [0.0; MAX_MONOMIALS];
            monomials([(p[0] - corners[a][0]) * s_x, (p[1] - corners[a][1]) * s_y], order, &mut basis);
            let mut add = |other: NodeId, m: (usize, usize), coefficient: f64| {
                let (i, j) = m;
                let value = basis[row(i, j)];
                let by_x = if i > 0 { s_x * basis[row(i - 1, j)] } else { 0.0 };
                let by_y = if j > 0 { s_y * basis[row(i, j - 1)] } else { 0.0 };
                self.sums[0].add(other, coefficient * lambda[a] * value);
                self.sums[1].add(other, coefficient * (slopes[a][0] * value + lambda[a] * by_x));
                self.sums[2].add(other, coefficient * (slopes[a][1] * value + lambda[a] * by_y));
            };
            if stencils.interpolates() {
                add(node, (0, 0), 1.0);
            }
            for degree in stencil.first_row()..=order {
                for j in 0..=degree {
                    let m = (degree - j, j);
                    for (&other, &coefficient) in stencil.nodes.iter().zip(stencil.row(row(m.0, m.1))) {
                        add(other, m, coefficient);
                    }
                }
            }
        }
        let [value, by_x, by_y] = &mut self.sums;
        value.drain(|node, sum| {
            out.nodes.push(node);
            out.value.push(sum);
        });
        by_x.drain(|_, sum| out.by_x.push(sum));
        by_y.drain(|_, sum| out.by_y.push(sum));
    }

    /// The star of the place itself, as the paper has it; derivatives are those of its polynomial (diffuse derivatives).
    fn moving(&mut self, triangle: TriId, p: Point, out: &mut Shapes) -> Result<(), MfdmError> {
        let TrialSpace { mesh, surroundings, params, .. } = self.space;
        let corners = mesh.corners(triangle);
        let inside = barycentric(corners, p).map(|l| l.max(0.0));
        let total: f64 = inside.iter().sum();
        let p = place(corners, inside.map(|l| l / total));
        let metric = surroundings.metric();
        let StarParams { order, size, smoothing, .. } = params;
        let mut best: Option<(f64, usize)> = None;
        for eighths in [8, 9, 10, 12, 16, 24] {
            let wanted = (size * eighths).div_ceil(8);
            let condition = self.factorise(p, wanted, order, smoothing);
            if best.is_none_or(|(least, _)| condition < least) {
                best = Some((condition, wanted));
            }
            if condition <= MAX_CONDITION {
                break;
            }
        }
        match best {
            Some((condition, wanted)) if condition <= MAX_CONDITION => self.factorise(p, wanted, order, smoothing),
            _ => return Err(MfdmError::PoorPlace { at: p, order, tried: self.star.len() }),
        };
        self.rows.clear();
        self.mwls.rows(&mut self.rows);
        let n = self.star.len();
        let slopes = metric.stretch().map(|stretch| stretch / self.mwls.radius());
        out.nodes.extend(&self.star);
        out.value.extend(&self.rows[..n]);
        let derivative = |m: usize, slope: f64| self.rows[m * n..(m + 1) * n].iter().map(move |c| c * slope);
        if n_monomials(order) > 1 {
            out.by_x.extend(derivative(row(1, 0), slopes[0]));
            out.by_y.extend(derivative(row(0, 1), slopes[1]));
        }
        Ok(())
    }

    fn factorise(&mut self, p: Point, wanted: usize, order: usize, smoothing: f64) -> f64 {
        self.finder.find_at(p, wanted, &mut self.star);
        let places = self.space.surroundings.stretched();
        let centre = self.space.surroundings.metric().stretched(p);
        let points = self.star.iter().map(|node| places[node.index()]);
        self.mwls.factorise(points, centre, None, order, smoothing)
    }
}
