//! Moving weighted least squares on one star: values to the polynomial that fits them, by QR with a rank test.

use crate::basis::{MAX_MONOMIALS, monomials, n_monomials};
use crate::slopes::Slopes;
use crate::weight::weight;
use nmt_geom::Point;
use nmt_geom::point::{distance_squared, sub};

/// A star whose system has a larger condition number carries no polynomial of that order.
///
/// The columns are scaled to length 1 first, so that the number measures the star's geometry alone. Sound stars of
/// orders 2 and 3 lie between 10 and 10³, one-sided ones at walls and corners reach 10⁴; the 15 nearest nodes of an edge
/// node of a regular grid, which do not determine a cubic, come to 10¹⁵. At 10⁶ ten correct digits are left.
pub const MAX_CONDITION: f64 = 1.0e6;

/// Nodes within this fraction of their extent of a line along an axis lie on it: rounding is 1e-15, the flattest useful
/// star 1e-2.
const ON_ONE_LINE_REL: f64 = 1.0e-6;

/// The least-squares system of one star, factorised; to be used again for the next star.
///
/// Where the centre is a node and g = 0, the polynomial meets its value exactly and minimises Σ w (P(x_i) − u_i)² over
/// the other nodes; otherwise, at a point that is none or with g > 0, over all nodes \[D11\].
#[derive(Clone, Debug, Default)]
pub struct Mwls {
    order: usize,
    radius: f64,
    first: usize,   // monomial of the first column: 1 where the centre's value is met, else 0
    slopes: Slopes, // known at the centre: their columns are left out
    n_columns: usize,
    n_rows: usize,                  // nodes without a centre that is met
    a: Vec<f64>,                    // Householder vectors below R, column by column, shape (n_columns, n_rows)
    diagonal: [f64; MAX_MONOMIALS], // of R
    tau: [f64; MAX_MONOMIALS],
    scale: [f64; MAX_MONOMIALS], // 1/length of each column
    root_weight: Vec<f64>,
    others: Vec<usize>, // positions in the star of all nodes but a centre that is met
    centre: usize,      // position in the star of a centre that is met
    condition: f64,
    work: Vec<f64>,
}

impl Mwls {
    /// Factorises the system of the star `star` (its points) about `centre_at` for `order`; its value is met exactly
    /// where it is the node at position `met`, and the weights smooth with `g`.
    ///
    /// Returns the condition number, ∞ where the star has too few nodes.
    pub fn factorise(
        &mut self,
        points: impl Iterator<Item = Point>,
        centre_at: Point,
        met: Option<usize>,
        order: usize,
        g: f64,
    ) -> f64 {
        self.factorise_meeting(points, centre_at, met, Slopes::Free, order, g)
    }

    /// As [`Self::factorise`], for values less the slope that is known: [`Self::fit`] and [`Self::rows`] then give what
    /// is free of the gradient.
    pub(crate) fn factorise_meeting(
        &mut self,
        points: impl Iterator<Item = Point>,
        centre_at: Point,
        met: Option<usize>,
        slopes: Slopes,
        order: usize,
        g: f64,
    ) -> f64 {
        self.order = order;
        self.slopes = slopes;
        self.centre = met.unwrap_or(usize::MAX);
        self.first = usize::from(met.is_some());
        self.n_columns = (n_monomials(order) - self.first).saturating_sub(2 - slopes.n_free());
        self.others.clear();
        self.root_weight.clear();
        self.work.clear();
        let mut radius_squared = 0.0f64;
        // `work` holds the offsets until the radius is known.
        for (position, p) in points.enumerate() {
            if Some(position) != met {
                let offset = sub(p, centre_at);
                radius_squared = radius_squared.max(distance_squared(p, centre_at));
                self.others.push(position);
                self.work.extend(offset);
            }
        }
        let (first, n_columns) = (self.first, self.n_columns);
        self.radius = radius_squared.sqrt();
        self.n_rows = self.others.len();
        self.condition = f64::INFINITY;
        if n_columns == 0
            || self.n_rows < n_columns
            || self.radius.partial_cmp(&0.0) != Some(std::cmp::Ordering::Greater)
        {
            return self.condition;
        }
        self.a.clear();
        self.a.resize(n_columns * self.n_rows, 0.0);
        let (mut basis, mut extent) = ([0.0; MAX_MONOMIALS], [0.0; 2]);
        for i in 0..self.n_rows {
            let scaled = [self.work[2 * i] / self.radius, self.work[2 * i + 1] / self.radius];
            let root = weight(scaled[0] * scaled[0] + scaled[1] * scaled[1], g, order).sqrt();
            self.root_weight.push(root);
            monomials(scaled, order, &mut basis);
            extent = [0, 1].map(|d| extent[d] + root * root * scaled[d] * scaled[d]);
            slopes.restrict(&mut basis);
            for m in 0..n_columns {
                self.a[m * self.n_rows + i] = root * basis[m + first];
            }
        }
        if order > 0 && is_on_one_line(extent) {
            return self.condition;
        }
        self.scale_columns(n_columns);
        self.householder(n_columns);
        self.condition = self.condition_of_r(n_columns);
        self.condition
    }

    fn scale_columns(&mut self, n_columns: usize) {
        for m in 0..n_columns {
            let column = &mut self.a[m * self.n_rows..(m + 1) * self.n_rows];
            let length = dot(column, column).sqrt();
            self.scale[m] = if length > 0.0 { 1.0 / length } else { 0.0 };
            column.iter_mut().for_each(|v| *v *= self.scale[m]);
        }
    }

    /// A = QR, the reflections v vᵀτ left below R in `a`.
    fn householder(&mut self, n_columns: usize) {
        let n = self.n_rows;
        for m in 0..n_columns {
            let (done, rest) = self.a.split_at_mut((m + 1) * n);
            let column = &mut done[m * n..];
            let length = dot(&column[m..], &column[m..]).sqrt();
            let alpha = if column[m] > 0.0 { -length } else { length };
            self.diagonal[m] = alpha;
            let head = column[m] - alpha;
            if length == 0.0 || head == 0.0 {
                self.tau[m] = 0.0;
                continue;
            }
            column[m] = 1.0;
            column[m + 1..].iter_mut().for_each(|v| *v /= head);
            self.tau[m] = -head / alpha;
            for other in rest.chunks_exact_mut(n) {
                reflect(&column[m..], self.tau[m], &mut other[m..]);
            }
        }
    }

    fn r(&self, i: usize, j: usize) -> f64 {
        if i == j { self.diagonal[i] } else { self.a[j * self.n_rows + i] }
    }

    /// ‖R‖·‖R⁻¹‖ in the Frobenius norm.
    fn condition_of_r(&self, n: usize) -> f64 {
        let mut inverse = [[0.0; MAX_MONOMIALS]; MAX_MONOMIALS];
        let (mut norm, mut inverse_norm) = (0.0, 0.0);
        for j in 0..n {
            for i in (0..=j).rev() {
                norm += self.r(i, j) * self.r(i, j);
                let known: f64 = (i + 1..=j).map(|k| self.r(i, k) * inverse[k][j]).sum();
                let unit = if i == j { 1.0 } else { 0.0 };
                inverse[i][j] = (unit - known) / self.diagonal[i];
                inverse_norm += inverse[i][j] * inverse[i][j];
            }
        }
        let condition = (norm * inverse_norm).sqrt();
        if condition.is_finite() { condition } else { f64::INFINITY }
    }

    /// Condition number of the last system.
    pub fn condition(&self) -> f64 {
        self.condition
    }

    /// Radius of the last star: the distance of its farthest node, user's length unit.
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Coefficients of the polynomial through `values` (one a node of the star, in its order), into
    /// `out[..n_monomials(order)]`: the derivatives u, u_x, u_y, u_xx, … at the centre in scaled coordinates.
    pub fn fit(&mut self, values: impl Fn(usize) -> f64, out: &mut [f64]) {
        let (n_columns, first) = (self.n_columns, self.first);
        let centre = if first == 1 { values(self.centre) } else { 0.0 };
        self.work.clear();
        self.work.extend(self.others.iter().zip(&self.root_weight).map(|(&k, root)| root * (values(k) - centre)));
        for m in 0..n_columns {
            let column = &self.a[m * self.n_rows..(m + 1) * self.n_rows];
            reflect(&column[m..], self.tau[m], &mut self.work[m..]);
        }
        out[0] = centre;
        for i in (0..n_columns).rev() {
            // out[j + first] holds the scaled unknown until its own column's scale is taken back.
            let known: f64 = (i + 1..n_columns).map(|j| self.r(i, j) * out[j + first] / self.scale[j]).sum();
            out[i + first] = (self.work[i] - known) / self.diagonal[i] * self.scale[i];
        }
        self.slopes.spread(&mut out[..n_monomials(self.order)], 1, 1);
    }

    /// Monomial of the first of the [`Self::rows`]: 1 where the centre's value is met, since its own row says nothing
    /// new, otherwise 0.
    pub fn first_row(&self) -> usize {
        self.first
    }

    /// The rows of coefficients: `out[(m − first)·n_star + k]` is what node k of the star contributes to derivative m at
    /// the centre, in scaled coordinates, for m = first … n_monomials − 1 (see [`Self::first_row`]).
    ///
    /// They reproduce every polynomial of degree ≤ order to rounding.
    pub fn rows(&mut self, out: &mut Vec<f64>) {
        let n_columns = self.n_columns;
        let (n, n_star) = (self.n_rows, self.n_rows + self.first);
        // Thin Q, column by column: reflections applied backwards to unit vectors.
        self.work.clear();
        self.work.resize(n_columns * n, 0.0);
        for m in (0..n_columns).rev() {
            self.work[m * n + m] = 1.0;
            for column in self.work[m * n..].chunks_exact_mut(n) {
                reflect(&self.a[m * n + m..(m + 1) * n], self.tau[m], &mut column[m..]);
            }
        }
        let start = out.len();
        out.resize(start + (n_monomials(self.order) - self.first) * n_star, 0.0);
        let out = &mut out[start..];
        for i in (0..n_columns).rev() {
            // Row i of R⁻¹Qᵀ in place of column i of Q.
            for j in i + 1..n_columns {
                let factor = self.r(i, j);
                let (upper, lower) = self.work.split_at_mut(j * n);
                let row = &mut upper[i * n..(i + 1) * n];
                row.iter_mut().zip(&lower[..n]).for_each(|(v, w)| *v -= factor * w);
            }
            let inverse = 1.0 / self.diagonal[i];
            self.work[i * n..(i + 1) * n].iter_mut().for_each(|v| *v *= inverse);
        }
        for m in 0..n_columns {
            let row = &mut out[m * n_star..(m + 1) * n_star];
            let mut sum = 0.0;
            for (k, &position) in self.others.iter().enumerate() {
                let coefficient = self.work[m * n + k] * self.root_weight[k] * self.scale[m];
                row[position] = coefficient;
                sum += coefficient;
            }
            if self.first == 1 {
                row[self.centre] = -sum;
            }
        }
        self.slopes.spread(out, (1 - self.first) * n_star, n_star);
    }
}

/// True where all nodes lie on one line along an axis, up to rounding, by the squares of their weighted coordinates:
/// scaling the columns would make a coordinate of that rounding.
pub(crate) fn is_on_one_line([h, k]: [f64; 2]) -> bool {
    h.min(k) <= ON_ONE_LINE_REL * ON_ONE_LINE_REL * h.max(k)
}

/// Scalar product in four partial sums, so that it vectorises; the same on every machine.
#[inline]
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let n = a.len().min(b.len());
    let (a, b) = (&a[..n], &b[..n]);
    let mut sums = [0.0; 4];
    let (a4, b4) = (a.chunks_exact(4), b.chunks_exact(4));
    let rest: f64 = a4.remainder().iter().zip(b4.remainder()).map(|(x, y)| x * y).sum();
    for (x, y) in a4.zip(b4) {
        for lane in 0..4 {
            sums[lane] += x[lane] * y[lane];
        }
    }
    (sums[0] + sums[2]) + (sums[1] + sums[3]) + rest
}

/// x ← (I − τ v vᵀ) x.
#[inline]
fn reflect(v: &[f64], tau: f64, x: &mut [f64]) {
    let projection = tau * dot(v, x);
    x.iter_mut().zip(v).for_each(|(b, a)| *b -= projection * a);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::basis::row;
    use proptest::prelude::*;

    /// A polynomial of degree `order` with given Taylor coefficients at `centre`.
    fn polynomial(coefficients: &[f64], order: usize, centre: Point, p: Point) -> f64 {
        let mut basis = [0.0; MAX_MONOMIALS];
        monomials(sub(p, centre), order, &mut basis);
        coefficients.iter().zip(basis).map(|(c, b)| c * b).sum()
    }

    proptest! {
        #[test]
        fn rows_and_fit_reproduce_every_polynomial_of_their_order(
            order in 1usize..=4,
            jitter in prop::collection::vec(prop::array::uniform2(-0.3..0.3f64), 49),
            coefficients in prop::collection::vec(-1.0..1.0f64, MAX_MONOMIALS),
        ) {
            // A displaced 7 × 7 grid about its middle node.
            let star: Vec<Point> = (0..49).map(|k| [(k % 7) as f64 - 3.0 + jitter[k][0], (k / 7) as f64 - 3.0 + jitter[k][1]]).collect();
            let centre = star[24];
            let mut mwls = Mwls::default();
            let condition = mwls.factorise(star.iter().copied(), centre, Some(24), order, 0.0);
            prop_assert!(condition < MAX_CONDITION, "{}", condition);
            let values: Vec<f64> = star.iter().map(|&p| polynomial(&coefficients, order, centre, p)).collect();
            let mut fitted = [0.0; MAX_MONOMIALS];
            mwls.fit(|k| values[k], &mut fitted);
            let mut rows = Vec::new();
            mwls.rows(&mut rows);
            for a in 0..=order {
                for b in 0..=order - a {
                    let m = row(a, b);
                    let expected = coefficients[m] * mwls.radius().powi((a + b) as i32);
                    let tolerance = 1e-12 * condition * mwls.radius().powi(order as i32); // rounding times condition
                    prop_assert!((fitted[m] - expected).abs() < tolerance, "fit {} {}", fitted[m], expected);
                    if m > 0 {
                        let by_row: f64 = (0..49).map(|k| rows[(m - 1) * 49 + k] * values[k]).sum();
                        prop_assert!((by_row - expected).abs() < tolerance, "row {} {}", by_row, expected);
                        let sum: f64 = rows[(m - 1) * 49..m * 49].iter().sum();
                        prop_assert!(sum.abs() < 1e-9, "rows of derivatives sum to 0, not {}", sum);
                    }
                }
            }
        }
    }

    proptest! {
        #[test]
        fn smoothing_stars_and_stars_of_points_reproduce_polynomials_too(
            order in 0usize..=4,
            g in 0.0..0.6f64,
            at in prop::array::uniform2(0.2..0.8f64),
            coefficients in prop::collection::vec(-1.0..1.0f64, MAX_MONOMIALS),
        ) {
            let star: Vec<Point> = (0..49).map(|k| [f64::from(k % 7) - 3.0, f64::from(k / 7) - 3.0]).collect();
            let mut mwls = Mwls::default();
            let condition = mwls.factorise(star.iter().copied(), at, None, order, g);
            prop_assert!(condition < MAX_CONDITION, "{}", condition);
            let values: Vec<f64> = star.iter().map(|&p| polynomial(&coefficients, order, at, p)).collect();
            let mut fitted = [0.0; MAX_MONOMIALS];
            mwls.fit(|k| values[k], &mut fitted);
            let mut rows = Vec::new();
            mwls.rows(&mut rows);
            prop_assert_eq!(mwls.first_row(), 0);
            for a in 0..=order {
                for b in 0..=order - a {
                    let m = row(a, b);
                    let expected = coefficients[m] * mwls.radius().powi((a + b) as i32);
                    let tolerance = 1e-11 * condition * mwls.radius().powi(order as i32); // rounding times condition
                    let by_row: f64 = (0..49).map(|k| rows[m * 49 + k] * values[k]).sum();
                    prop_assert!((fitted[m] - expected).abs() < tolerance, "fit {} {}", fitted[m], expected);
                    prop_assert!((by_row - expected).abs() < tolerance, "row {} {}", by_row, expected);
                }
            }
        }
    }

    #[test]
    fn fifteen_nearest_nodes_of_an_edge_node_of_a_regular_grid_do_not_carry_a_cubic() {
        // They are three rows of five: nothing tells y³ from y and y².
        let star: Vec<Point> = (0..15).map(|k| [f64::from(k % 5) - 2.0, f64::from(k / 5)]).collect();
        let condition = Mwls::default().factorise(star.iter().copied(), [0.0, 0.0], Some(2), 3, 0.0);
        assert!(condition > MAX_CONDITION, "{condition}");
    }

    #[test]
    fn nodes_on_a_conic_do_not_carry_a_quadratic() {
        // Five nodes on one circle through the centre's own position determine nothing new.
        let mut star = vec![[0.0, 0.0]];
        star.extend((0..8).map(|k| {
            let t = 0.3 + 0.6 * f64::from(k);
            [t.cos() - 1.0, t.sin()]
        }));
        let condition = Mwls::default().factorise(star.iter().copied(), [0.0, 0.0], Some(0), 2, 0.0);
        assert!(condition > MAX_CONDITION, "{condition}");
    }

    #[test]
    fn the_five_point_star_gives_the_classical_laplacian_of_the_cross() {
        // Nine nodes of a square grid: interpolating weights favour the cross; the row must still be symmetric.
        let star: Vec<Point> = (0..9).map(|k| [f64::from(k % 3) - 1.0, f64::from(k / 3) - 1.0]).collect();
        let mut mwls = Mwls::default();
        mwls.factorise(star.iter().copied(), [0.0, 0.0], Some(4), 2, 0.0);
        let mut rows = Vec::new();
        mwls.rows(&mut rows);
        let laplacian: Vec<f64> =
            (0..9).map(|k| rows[(row(2, 0) - 1) * 9 + k] + rows[(row(0, 2) - 1) * 9 + k]).collect();
        for (k, other) in [(0, 8), (1, 7), (2, 6), (3, 5), (0, 2), (1, 3)] {
            assert!((laplacian[k] - laplacian[other]).abs() < 1e-12, "{laplacian:?}"); // rounding
        }
        assert!(laplacian[4] < 0.0 && laplacian[1] > 0.0);
    }
}
