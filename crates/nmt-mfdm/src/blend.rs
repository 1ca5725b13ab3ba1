//! Nodal polynomials blended by barycentric coordinates: value and gradient anywhere \[D13\]\[D14\].
//!
//! On each triangle the field is Σ λ_a(x)·P_a(x) over its three nodes: continuous, and exact for polynomials of the
//! order. It is the trial space of the variational form and the recovered field of every result (a partition of unity
//! of nodal polynomials, as in the FE–meshfree methods of Rajendran and Zhang, 2007).

use crate::basis::{MAX_MONOMIALS, MAX_ORDER, monomials, n_monomials, row};
use crate::error::MfdmError;
use crate::gauss::{Rule, seven_points, six_points};
use crate::lanes::Lanes;
use crate::parallel::{CHUNK, map_chunks, take_pieces};
use crate::quadrature::RuleLanes;
use crate::repair::Demand;
use crate::solve::Event;
use crate::sound_stars::{SoundStar, SoundStars, Wanted};
use crate::stencils::{StarParams, StarReport};
use crate::surroundings::{Metric, Surroundings};
use nmt_cloud::Nearest;
use nmt_geom::point::{cross, sub};
use nmt_geom::{NodeId, Point, TriId};
use nmt_tri::{Mesh, barycentric};
use std::ops::Range;
use std::sync::Arc;

/// Value and derivatives of a field at a point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FieldValue {
    /// F.
    pub value: f64,
    /// [∂F/∂x, ∂F/∂y].
    pub gradient: [f64; 2],
    /// ∂²F/∂x² + ∂²F/∂y².
    pub laplacian: f64,
}

/// The polynomial of every node of a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct NodalPolynomials {
    order: usize,
    blended_order: usize,   // of what is blended: 0 where the field is the linear interpolant
    coefficients: Vec<f64>, // Taylor coefficients in scaled coordinates, shape (n_nodes, n_monomials)
    radii: Arc<[f64]>,      // in stretched coordinates, user's length unit
    metric: Metric,
    report: StarReport,
}

impl NodalPolynomials {
    /// Fits a polynomial of `params.order` to the nodal `values` about every node, from its own star.
    ///
    /// A star that carries none of the order gives one of a lower order, at least a plane; the report tells.
    ///
    /// # Errors
    /// [`MfdmError::PoorStar`] where a node sees too few others for a plane.
    pub fn fit(
        surroundings: &Surroundings,
        nearest: &Nearest,
        params: StarParams,
        values: &[f64],
    ) -> Result<Self, MfdmError> {
        let [field] = Self::fit_fields((surroundings, nearest), params, [values], &mut |_| {})?;
        Ok(field)
    }

    /// [`Self::fit`] of several fields on the same stars, telling how many nodes are done.
    pub(crate) fn fit_fields<const N: usize>(
        (surroundings, nearest): (&Surroundings, &Nearest),
        params: StarParams,
        fields: [&[f64]; N],
        observer: &mut dyn FnMut(Event),
    ) -> Result<[Self; N], MfdmError> {
        struct Part<const N: usize> {
            coefficients: [Vec<f64>; N],
            radii: Vec<f64>,
            report: StarReport,
            poor: Option<MfdmError>,
        }
        let n = n_monomials(params.order);
        let n_nodes = surroundings.xy().len();
        let StarParams { order, size, choice, smoothing, evening } = params;
        let demand = Demand {
            order,
            size,
            smoothing,
            flattening: smoothing,
            negative_diagonal: false,
            slopes: crate::slopes::Slopes::Free,
            evening,
        };
        let part = |piece: Range<usize>| {
            let mut stars = SoundStars::new(surroundings, nearest, choice);
            let mut part = Part {
                coefficients: [(); N].map(|()| Vec::with_capacity(n * piece.len())),
                radii: Vec::with_capacity(piece.len()),
                report: StarReport::default(),
                poor: None,
            };
            stars.each(
                piece.map(NodeId::of),
                |_| demand,
                Wanted::Polynomials(&fields),
                |star| {
                    let SoundStar { node, nodes, radius, outcome, values } = star;
                    if outcome.order == 0 && part.poor.is_none() {
                        let at = surroundings.xy()[node.index()];
                        part.poor = Some(MfdmError::PoorStar { node: node.index(), at, order: 1, tried: nodes.len() });
                    }
                    let of_fields = values.chunks_exact(n).zip(&mut part.coefficients);
                    of_fields.for_each(|(own, coefficients)| coefficients.extend(own));
                    part.radii.push(radius);
                    part.report.add(&outcome, params.order);
                },
            );
            part
        };
        let mut coefficients = [(); N].map(|()| Vec::with_capacity(n * n_nodes));
        let mut radii = Vec::with_capacity(n_nodes);
        let mut report = StarReport { size: params.size, choice: params.choice, ..StarReport::default() };
        let mut poor = None;
        take_pieces(0..n_nodes, CHUNK, part, |part: Part<N>| {
            poor = poor.take().or(part.poor);
            coefficients.iter_mut().zip(part.coefficients).for_each(|(all, own)| all.extend(own));
            radii.extend(part.radii);
            report.join(&part.report);
            observer(Event::Nodes { done: radii.len(), of: n_nodes });
        });
        let radii: Arc<[f64]> = radii.into();
        let field = |coefficients| Self {
            order: params.order,
            blended_order: params.order,
            coefficients,
            radii: Arc::clone(&radii),
            metric: surroundings.metric(),
            report,
        };
        poor.map_or_else(|| Ok(coefficients.map(field)), Err)
    }

    /// The linear interpolant of `values`: on each triangle the plane through its three nodes. At a node its gradient is
    /// the mean of those of the triangles around, by area, as finite element programs give it.
    pub fn linear(mesh: &Mesh, values: &[f64]) -> Self {
        let n_nodes = values.len();
        let mut coefficients = vec![0.0; 3 * n_nodes];
        let mut areas = vec![0.0; n_nodes];
        for t in mesh.triangles() {
            let (nodes, area) = (mesh.tri_nodes()[t.index()], mesh.area(t));
            let gradient = gradient_of_plane(mesh, t, |node| values[node.index()]);
            for node in nodes.map(NodeId::index) {
                coefficients[3 * node + 1] += area * gradient[0];
                coefficients[3 * node + 2] += area * gradient[1];
                areas[node] += area;
            }
        }
        for (node, value) in values.iter().enumerate() {
            coefficients[3 * node] = *value;
            if areas[node] > 0.0 {
                (1..3).for_each(|d| coefficients[3 * node + d] /= areas[node]);
            }
        }
        let report = StarReport::default();
        Self {
            order: 1,
            blended_order: 0,
            coefficients,
            radii: vec![1.0; n_nodes].into(),
            metric: Metric::plain(),
            report,
        }
    }

    /// Order of the polynomials at the nodes.
    pub fn order(&self) -> usize {
        self.order
    }

    /// Whether the field is the linear interpolant of the nodal values ([`Self::linear`]).
    pub fn is_linear_interpolant(&self) -> bool {
        self.blended_order == 0
    }

    /// What became of the stars.
    pub fn report(&self) -> StarReport {
        self.report
    }

    /// The field times `factor`.
    pub fn scaled(mut self, factor: f64) -> Self {
        self.coefficients.iter_mut().for_each(|c| *c *= factor);
        self
    }

    /// Coefficients of flatter polynomials than that of `node`, with its value: its plane, the plane with the mean gradient, by
    /// area, of those through the values at the corners of the triangles `around`, and the value alone.
    pub(crate) fn flatter(&self, mesh: &Mesh, node: NodeId, around: &[TriId]) -> [Vec<f64>; 3] {
        let plane = |gradient: [f64; 2]| {
            let mut coefficients = vec![0.0; n_monomials(self.order)];
            coefficients[0] = self.coefficients(node)[0];
            let slopes = self.slopes(node);
            let linear = coefficients.iter_mut().skip(1).zip(gradient).zip(slopes);
            linear.for_each(|((coefficient, slope), scale)| *coefficient = slope / scale);
            coefficients
        };
        let area: f64 = around.iter().map(|&t| mesh.area(t)).sum();
        let mut mean = [0.0; 2];
        for &t in around {
            let gradient = gradient_of_plane(mesh, t, |node| self.coefficients(node)[0]);
            (0..2).for_each(|d| mean[d] += mesh.area(t) / area * gradient[d]);
        }
        [plane(self.at_node(node).gradient), plane(mean), plane([0.0; 2])]
    }

    /// Puts other coefficients in the place of those of a node; tells these.
    pub(crate) fn replace(&mut self, node: NodeId, coefficients: &[f64]) -> Vec<f64> {
        let n = n_monomials(self.order);
        let own = &mut self.coefficients[node.index() * n..(node.index() + 1) * n];
        let before = own.to_vec();
        own.copy_from_slice(coefficients);
        before
    }

    /// Order of what is blended.
    pub(crate) fn blended_order(&self) -> usize {
        self.blended_order
    }

    /// Taylor coefficients of a node's polynomial, in scaled coordinates.
    pub(crate) fn coefficients(&self, node: NodeId) -> &[f64] {
        let n = n_monomials(self.order);
        &self.coefficients[node.index() * n..(node.index() + 1) * n]
    }

    /// Scaled coordinates by user's, along x and y: stretch over radius.
    pub(crate) fn slopes(&self, node: NodeId) -> [f64; 2] {
        self.metric.stretch().map(|stretch| stretch / self.radii[node.index()])
    }

    /// Value and derivatives of a node's own polynomial at that node.
    pub fn at_node(&self, node: NodeId) -> FieldValue {
        let (c, [s_x, s_y]) = (self.coefficients(node), self.slopes(node));
        let laplacian = if self.order >= 2 { c[row(2, 0)] * s_x * s_x + c[row(0, 2)] * s_y * s_y } else { 0.0 };
        FieldValue { value: c[0], gradient: [c[row(1, 0)] * s_x, c[row(0, 1)] * s_y], laplacian }
    }

    /// [∂²/∂x², ∂²/∂x∂y, ∂²/∂y²] of a node's own polynomial at that node.
    pub fn hessian_at_node(&self, node: NodeId) -> [f64; 3] {
        if self.order < 2 {
            return [0.0; 3];
        }
        let (c, [s_x, s_y]) = (self.coefficients(node), self.slopes(node));
        [c[row(2, 0)] * s_x * s_x, c[row(1, 1)] * s_x * s_y, c[row(0, 2)] * s_y * s_y]
    }

    /// Value and derivatives at `p` of the polynomial of `node`, which lies at `centre`.
    pub fn polynomial(&self, node: NodeId, centre: Point, p: Point) -> FieldValue {
        let (c, [s_x, s_y]) = (self.coefficients(node), self.slopes(node));
        let scaled = [(p[0] - centre[0]) * s_x, (p[1] - centre[1]) * s_y];
        let mut basis = [0.0; MAX_MONOMIALS];
        monomials(scaled, self.blended_order, &mut basis);
        // The derivative of hᵃkᵇ/(a! b!) along h is the monomial (a − 1, b): a shift of the coefficients.
        let shifted = |da: usize, db: usize| -> f64 {
            let Some(lower) = self.blended_order.checked_sub(da + db) else { return 0.0 };
            let mut sum = 0.0;
            for degree in 0..=lower {
                for b in 0..=degree {
                    sum += c[row(degree - b + da, b + db)] * basis[row(degree - b, b)];
                }
            }
            sum
        };
        let laplacian = shifted(2, 0) * s_x * s_x + shifted(0, 2) * s_y * s_y;
        FieldValue { value: shifted(0, 0), gradient: [shifted(1, 0) * s_x, shifted(0, 1) * s_y], laplacian }
    }

    /// Value and derivatives of the blend at `p` in `triangle`.
    ///
    /// ∇F = Σ (P_a ∇λ_a + λ_a ∇P_a), ∇²F = Σ (2 ∇λ_a·∇P_a + λ_a ∇²P_a).
    pub fn blend(&self, mesh: &Mesh, triangle: TriId, p: Point) -> FieldValue {
        let corners = mesh.corners(triangle);
        let lambda = barycentric(corners, p);
        let slopes = barycentric_gradients(corners);
        let mut field = FieldValue::default();
        for (a, &node) in mesh.tri_nodes()[triangle.index()].iter().enumerate() {
            let own = self.polynomial(node, corners[a], p);
            field.value += lambda[a] * own.value;
            field.laplacian += lambda[a] * own.laplacian;
            for d in 0..2 {
                field.gradient[d] += own.value * slopes[a][d] + lambda[a] * own.gradient[d];
                field.laplacian += 2.0 * slopes[a][d] * own.gradient[d];
            }
        }
        field
    }

    /// Value and gradient of the blend at `p` in `triangle`, as [`Self::blend`] has them.
    pub(crate) fn slope(&self, mesh: &Mesh, triangle: TriId, p: Point) -> (f64, [f64; 2]) {
        match self.blended_order {
            0 => self.slope_of_order::<0>(mesh, triangle, p),
            1 => self.slope_of_order::<1>(mesh, triangle, p),
            2 => self.slope_of_order::<2>(mesh, triangle, p),
            3 => self.slope_of_order::<3>(mesh, triangle, p),
            _ => self.slope_of_order::<MAX_ORDER>(mesh, triangle, p),
        }
    }

    fn slope_of_order<const ORDER: usize>(&self, mesh: &Mesh, triangle: TriId, p: Point) -> (f64, [f64; 2]) {
        let corners = mesh.corners(triangle);
        let (lambda, slopes) = (barycentric(corners, p), barycentric_gradients(corners));
        let (mut value, mut gradient) = (0.0, [0.0; 2]);
        let mut basis = [0.0; MAX_MONOMIALS];
        for (a, &node) in mesh.tri_nodes()[triangle.index()].iter().enumerate() {
            let (c, [s_x, s_y]) = (self.coefficients(node), self.slopes(node));
            monomials([(p[0] - corners[a][0]) * s_x, (p[1] - corners[a][1]) * s_y], ORDER, &mut basis);
            let (mut own, mut along) = (c[0], [0.0; 2]);
            for degree in 1..=ORDER {
                for b in 0..=degree {
                    own += c[row(degree - b, b)] * basis[row(degree - b, b)];
                }
                // The derivative of hᵃkᵇ/(a! b!) along h is the monomial (a − 1, b).
                for b in 0..degree {
                    let lower = basis[row(degree - 1 - b, b)];
                    along[0] += c[row(degree - b, b)] * lower;
                    along[1] += c[row(degree - 1 - b, b + 1)] * lower;
                }
            }
            value += lambda[a] * own;
            gradient[0] += own * slopes[a][0] + lambda[a] * along[0] * s_x;
            gradient[1] += own * slopes[a][1] + lambda[a] * along[1] * s_y;
        }
        (value, gradient)
    }

    /// Integral of a quantity of the blend over a triangle by `rule`.
    pub fn integrate(&self, mesh: &Mesh, triangle: TriId, rule: &Rule, of: impl Fn(&FieldValue) -> f64) -> f64 {
        let corners = mesh.corners(triangle);
        let weighted = rule
            .points
            .iter()
            .zip(&rule.weights)
            .map(|(lambda, weight)| weight * of(&self.blend(mesh, triangle, place(corners, *lambda))));
        mesh.area(triangle) * weighted.sum::<f64>()
    }

    /// A rule that integrates the blend exactly: it is of one degree more than its polynomials.
    pub(crate) fn rule(&self) -> Rule {
        if self.blended_order <= 3 { six_points() } else { seven_points() }
    }

    /// ∫F over the whole mesh, exact for the blend.
    pub fn volume(&self, mesh: &Mesh) -> f64 {
        let rule = RuleLanes::from(&self.rule());
        let parts = map_chunks(0..mesh.n_triangles(), |piece| {
            piece.map(|t| self.volume_over(mesh, &rule, TriId::of(t))).collect::<Vec<f64>>()
        });
        parts.into_iter().flatten().sum()
    }

    /// ∫F over some triangles.
    pub(crate) fn volume_of(&self, mesh: &Mesh, triangles: &[TriId]) -> f64 {
        let rule = RuleLanes::from(&self.rule());
        triangles.iter().map(|&t| self.volume_over(mesh, &rule, t)).sum()
    }

    fn volume_over(&self, mesh: &Mesh, rule: &RuleLanes, triangle: TriId) -> f64 {
        let values = self.values_at(mesh, triangle, rule);
        let sums = rule.weights.iter().zip(values).fold(Lanes::default(), |sums, (weight, f)| sums + *weight * f);
        mesh.area(triangle) * sums.sum()
    }
}

/// The place with these barycentric coordinates.
#[inline]
pub(crate) fn place(corners: [Point; 3], lambda: [f64; 3]) -> Point {
    [0, 1].map(|d| (0..3).map(|a| lambda[a] * corners[a][d]).sum())
}

/// The gradient of the plane through the values at the corners of a triangle.
pub(crate) fn gradient_of_plane(mesh: &Mesh, triangle: TriId, value: impl Fn(NodeId) -> f64) -> [f64; 2] {
    let slopes = barycentric_gradients(mesh.corners(triangle));
    let values = mesh.tri_nodes()[triangle.index()].map(value);
    [0, 1].map(|d| (0..3).map(|a| values[a] * slopes[a][d]).sum())
}

/// ∇λ of the three barycentric coordinates, constant on the triangle; 1/user's length unit.
#[inline]
pub fn barycentric_gradients([a, b, c]: [Point; 3]) -> [[f64; 2]; 3] {
    let twice_area = cross(sub(b, a), sub(c, a));
    [(b, c), (c, a), (a, b)].map(|(p, q)| [(p[1] - q[1]) / twice_area, (q[0] - p[0]) / twice_area])
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use nmt_cloud::{CloudParams, Section, generate};
    use nmt_curve::Outline;

    /// Polynomials of every order through the same values, on an irregular cloud.
    pub(crate) fn fields_of_all_orders() -> Result<(Mesh, Vec<NodalPolynomials>), Box<dyn std::error::Error>> {
        let square = Section::solid(Outline::rectangle([0.0, 0.0], [2.0, 1.0]));
        let params = CloudParams { nodes: [13, 9], irregularity: 0.3, ..CloudParams::default() };
        let mesh = Mesh::constrained(generate(&square, &params)?)?;
        let values: Vec<f64> = mesh.xy().iter().map(|p| (2.0 * p[0]).sin() * (1.0 + p[1]).exp()).collect();
        let surroundings = Surroundings::new(mesh.cloud());
        let nearest = surroundings.nearest();
        let mut fields = vec![NodalPolynomials::linear(&mesh, &values)];
        for (order, size) in [(1, 6), (2, 9), (3, 20), (4, 30)] {
            fields.push(NodalPolynomials::fit(&surroundings, &nearest, StarParams::nearest(order, size), &values)?);
        }
        Ok((mesh, fields))
    }

    #[test]
    fn slopes_are_those_of_the_blend() -> Result<(), Box<dyn std::error::Error>> {
        let (mesh, fields) = fields_of_all_orders()?;
        for field in &fields {
            for t in mesh.triangles() {
                let [a, b, c] = mesh.corners(t);
                let p = [0, 1].map(|d| 0.5 * a[d] + 0.3 * b[d] + 0.2 * c[d]);
                let (blend, (value, gradient)) = (field.blend(&mesh, t, p), field.slope(&mesh, t, p));
                let close = |x: f64, y: f64| (x - y).abs() <= 1e-12 * (1.0 + x.abs()); // rounding
                assert!(close(blend.value, value), "order {}", field.order());
                assert!((0..2).all(|d| close(blend.gradient[d], gradient[d])), "order {}", field.order());
            }
        }
        Ok(())
    }
}
