//! The least-squares systems of four stars at once, as [`crate::Mwls`] has them one by one: each meets its centre's value,
//! weights do not smooth, nothing is known of the gradient. What is out of the ordinary is left to [`crate::Mwls`].
//!
//! A = QR by reflections H_m = I − β v vᵀ. R⁻¹ gives the condition number; a functional c of the coefficients has the row
//! Q·R⁻ᵀc, so that what is not asked for is not computed.

use crate::basis::{INVERSE, MAX_MONOMIALS, n_monomials, row};
use crate::lanes::{Lanes, WIDTH};
use crate::mwls::is_on_one_line;
use crate::vectors::widest;
use nmt_geom::point::sub;
use nmt_geom::{NodeId, Point};

/// Columns of a system, at most: all monomials but the constant.
const MAX_COLUMNS: usize = MAX_MONOMIALS - 1;

/// A star by its nodes, ascending, and which of them is the centre.
#[derive(Clone, Copy)]
pub(crate) struct CentredStar<'a> {
    pub nodes: &'a [NodeId],
    pub centre: usize,
}

/// The systems of four stars, factorised; to be used again for the next four.
#[derive(Clone, Debug, Default)]
pub(crate) struct Quartet {
    order: usize,
    n: usize,                       // rows of the longest star; those of the others end in zeros
    offsets: Vec<[Lanes; 2]>,       // from the centres, shape (n,)
    a: Vec<Lanes>,                  // A, then R in its upper triangle, shape (n, columns)
    v: Vec<Lanes>,                  // of the reflections: the last n − m of row m, shape (columns, n)
    root_weight: Vec<Lanes>,        // shape (n,)
    beta: [Lanes; MAX_COLUMNS],     // of the reflections
    diagonal: [Lanes; MAX_COLUMNS], // of R
    inverse: Vec<Lanes>,            // R⁻¹, shape (columns, columns)
    radius: Lanes,
    condition: Lanes,
    rows: Vec<Lanes>, // what was asked for, a column for each row of coefficients; or the right side
    own: [Lanes; MAX_COLUMNS], // what the centre contributes to each row; or the coefficients of the polynomial
}

impl Quartet {
    /// Factorises the systems of four stars of `order` 1 to [`MAX_ORDER`]; `places` are those of the nodes.
    pub fn factorise(&mut self, places: &[Point], stars: [CentredStar; WIDTH], order: usize) {
        self.order = order;
        widest(
            #[inline(always)]
            || {
                self.load(places, stars);
                match order {
                    1 => self.factorise_columns::<2>(stars),
                    2 => self.factorise_columns::<5>(stars),
                    3 => self.factorise_columns::<9>(stars),
                    _ => self.factorise_columns::<MAX_COLUMNS>(stars),
                }
            },
        );
    }

    /// Condition number of the system in a lane, as [`crate::Mwls::condition`]; NaN or ∞ where it is singular.
    pub fn condition(&self, lane: usize) -> f64 {
        self.condition.0[lane]
    }

    /// Number of the unknowns: all monomials but the constant.
    fn n_columns(&self) -> usize {
        n_monomials(self.order) - 1
    }

    /// Distance of the farthest node from the centre.
    pub fn radius(&self, lane: usize) -> f64 {
        self.radius.0[lane]
    }

    /// Offsets from the centres; the largest of them are the radii.
    #[inline(always)]
    fn load(&mut self, places: &[Point], stars: [CentredStar; WIDTH]) {
        let n = stars.iter().map(|star| star.nodes.len()).max().map_or(0, |most| most.saturating_sub(1));
        self.n = n;
        self.offsets.clear();
        self.offsets.resize(n, [Lanes::default(); 2]);
        for (lane, CentredStar { nodes, centre }) in stars.into_iter().enumerate() {
            let at = places[nodes[centre].index()];
            let others = nodes[..centre].iter().chain(&nodes[centre + 1..]);
            self.offsets.iter_mut().zip(others).for_each(|(offset, other)| {
                [offset[0].0[lane], offset[1].0[lane]] = sub(places[other.index()], at);
            });
        }
        let squares = self.offsets.iter().map(|&[x, y]| x * x + y * y);
        self.radius = squares.fold(Lanes::default(), Lanes::larger).sqrt();
    }

    #[inline(always)]
    fn factorise_columns<const C: usize>(&mut self, stars: [CentredStar; WIDTH]) {
        self.fill::<C>(stars);
        self.reflect_columns::<C>();
        self.invert::<C>();
    }

    /// Weighted monomials in coordinates scaled by the radius.
    #[inline(always)]
    fn fill<const C: usize>(&mut self, stars: [CentredStar; WIDTH]) {
        // All of it is overwritten.
        self.a.resize(C * self.n, Lanes::default());
        self.root_weight.clear();
        let per_length = Lanes::all(1.0) / self.radius;
        let shortest = stars.iter().map(|star| star.nodes.len()).min().unwrap_or(0);
        let order = const { order_of(C) };
        let (rows, _) = self.a.as_chunks_mut::<C>();
        for (i, (row, &[x, y])) in rows.iter_mut().zip(&self.offsets).enumerate() {
            let (h, k) = (x * per_length, y * per_length);
            let mut root = root_weight(h * h + k * k, order);
            if i + 1 >= shortest {
                // Rows beyond a star's end weigh nothing.
                let ended = (0..WIDTH).filter(|&lane| i + 1 >= stars[lane].nodes.len());
                ended.for_each(|lane| root.0[lane] = 0.0);
            }
            self.root_weight.push(root);
            row[0] = root * h;
            row[1] = root * k;
            for degree in 2..=order {
                let (first, below) = (degree * (degree + 1) / 2 - 1, degree * (degree - 1) / 2 - 1);
                for b in 0..degree {
                    row[first + b] = row[below + b] * h * INVERSE[degree - b];
                }
                row[first + degree] = row[below + degree - 1] * k * INVERSE[degree];
            }
        }
    }

    /// A = QR.
    #[inline(always)]
    fn reflect_columns<const C: usize>(&mut self) {
        let n = self.n;
        self.v.resize(C * n, Lanes::default());
        let (rows, _) = self.a.as_chunks_mut::<C>();
        for (m, all) in self.v.chunks_exact_mut(n).take(C).enumerate() {
            let (rows, v) = (&mut rows[m..], &mut all[m..]);
            let mut square = Lanes::default();
            for (v, row) in v.iter_mut().zip(rows.iter()) {
                *v = row[m];
                square += *v * *v;
            }
            let length = square.sqrt();
            let top = v[0];
            v[0] = top + length.with_sign_of(top);
            self.beta[m] = Lanes::all(1.0) / (square + length * top.map(f64::abs));
            self.diagonal[m] = -length.with_sign_of(top);
            reflect(v, self.beta[m], rows, m + 1);
        }
    }

    /// R⁻¹ and the condition number: ‖R‖·‖R⁻¹‖ in the Frobenius norm, with columns of length 1.
    #[inline(always)]
    fn invert<const C: usize>(&mut self) {
        self.inverse.resize(C * C, Lanes::default());
        let (r, _) = self.a.as_chunks::<C>();
        let (inverse, _) = self.inverse.as_chunks_mut::<C>();
        let mut squares = [Lanes::default(); C]; // of the lengths of the columns of R
        let mut over_diagonal = [Lanes::default(); C];
        for j in 0..C {
            over_diagonal[j] = Lanes::all(1.0) / self.diagonal[j];
            squares[j] = r[..j].iter().fold(self.diagonal[j] * self.diagonal[j], |sum, row| sum + row[j] * row[j]);
        }
        let mut norm = Lanes::default();
        for i in 0..C {
            let row = &mut inverse[i];
            row[i] = over_diagonal[i];
            let mut square = row[i] * row[i];
            for j in i + 1..C {
                let known = (i..j).fold(Lanes::default(), |sum, k| sum + row[k] * r[k][j]);
                row[j] = -known * over_diagonal[j];
                square += row[j] * row[j];
            }
            norm += squares[i] * square;
        }
        self.condition = (norm * C as f64).sqrt();
        // The columns of h and k alone have the lengths that tell a line.
        for lane in 0..WIDTH {
            if is_on_one_line([squares[0].0[lane], squares[1].0[lane]]) {
                self.condition.0[lane] = f64::INFINITY;
            }
        }
    }

    /// Computes the rows of all derivatives.
    pub fn rows(&mut self) {
        widest(
            #[inline(always)]
            || match self.order {
                1 => self.all_rows::<2>(),
                2 => self.all_rows::<5>(),
                3 => self.all_rows::<9>(),
                _ => self.all_rows::<MAX_COLUMNS>(),
            },
        );
    }

    /// Computes the row of s_x²·∂²/∂x² + s_y²·∂²/∂y² alone, with the squares of the stretches given; the order is at least 2.
    pub fn laplacian(&mut self, [x, y]: [f64; 2]) {
        widest(
            #[inline(always)]
            || match self.order {
                1 => {}
                2 => self.laplacian_row::<5>(x, y),
                3 => self.laplacian_row::<9>(x, y),
                _ => self.laplacian_row::<MAX_COLUMNS>(x, y),
            },
        );
    }

    /// Computes the coefficients of the polynomials through `values`, one a node of the cloud.
    pub fn fit(&mut self, values: &[f64], stars: [CentredStar; WIDTH]) {
        widest(
            #[inline(always)]
            || match self.order {
                1 => self.fit_columns::<2>(values, stars),
                2 => self.fit_columns::<5>(values, stars),
                3 => self.fit_columns::<9>(values, stars),
                _ => self.fit_columns::<MAX_COLUMNS>(values, stars),
            },
        );
    }

    #[inline(always)]
    fn all_rows<const C: usize>(&mut self) {
        self.start::<C>();
        let (inverse, _) = self.inverse.as_chunks::<C>();
        let (rows, _) = self.rows.as_chunks_mut::<C>();
        for (j, row) in rows[..C].iter_mut().enumerate() {
            for (own, above) in row.iter_mut().zip(&inverse[..=j]) {
                *own = above[j];
            }
        }
        self.finish::<C, C>();
    }

    #[inline(always)]
    fn laplacian_row<const C: usize>(&mut self, x: f64, y: f64) {
        self.start::<1>();
        let (inverse, _) = self.inverse.as_chunks::<C>();
        for j in XX..C {
            self.rows[j] = inverse[XX][j] * x;
        }
        for j in YY..C {
            self.rows[j] += inverse[YY][j] * y;
        }
        self.finish::<C, 1>();
    }

    /// Room for `M` rows of coefficients, all 0.
    #[inline(always)]
    fn start<const M: usize>(&mut self) {
        self.rows.clear();
        self.rows.resize(M * self.n, Lanes::default());
    }

    /// From the R⁻ᵀc in `rows` the rows of the functionals c.
    #[inline(always)]
    fn finish<const C: usize, const M: usize>(&mut self) {
        let n = self.n;
        let (rows, _) = self.rows.as_chunks_mut::<M>();
        for m in (0..C).rev() {
            reflect(&self.v[m * n + m..(m + 1) * n], self.beta[m], &mut rows[m..], 0);
        }
        let mut sums = [Lanes::default(); M];
        for (row, &root) in rows.iter_mut().zip(&self.root_weight) {
            for m in 0..M {
                row[m] *= root;
                sums[m] += row[m];
            }
        }
        self.own[..M].iter_mut().zip(sums).for_each(|(own, sum)| *own = -sum);
    }

    #[inline(always)]
    fn fit_columns<const C: usize>(&mut self, values: &[f64], stars: [CentredStar; WIDTH]) {
        let n = self.n;
        self.start::<1>();
        for (lane, CentredStar { nodes, centre }) in stars.into_iter().enumerate() {
            let own = values[nodes[centre].index()];
            let others = nodes[..centre].iter().chain(&nodes[centre + 1..]);
            self.rows.iter_mut().zip(others).for_each(|(b, other)| b.0[lane] = values[other.index()] - own);
        }
        self.rows.iter_mut().zip(&self.root_weight).for_each(|(b, &root)| *b *= root);
        let (right, _) = self.rows.as_chunks_mut::<1>();
        for m in 0..C {
            reflect(&self.v[m * n + m..(m + 1) * n], self.beta[m], &mut right[m..], 0);
        }
        let (inverse, _) = self.inverse.as_chunks::<C>();
        for m in 0..C {
            self.own[m] = (m..C).fold(Lanes::default(), |sum, j| sum + inverse[m][j] * right[j][0]);
        }
    }

    /// What the centre of the star in a lane contributes to row `m` of those computed.
    pub fn own(&self, lane: usize, m: usize) -> f64 {
        self.own[m].0[lane]
    }

    /// Copies the rows of the star in a lane that [`Self::rows`] made, or the one of [`Self::laplacian`], into `out`: row
    /// after row, a coefficient for each of its nodes.
    pub fn copy_rows(&self, lane: usize, star: CentredStar, out: &mut Vec<f64>) {
        let n_star = star.nodes.len();
        let n_rows = self.rows.len().checked_div(self.n).unwrap_or(0);
        out.resize(n_rows * n_star, 0.0);
        for (m, row) in out.chunks_exact_mut(n_star).enumerate() {
            let (before, rest) = row.split_at_mut(star.centre);
            let mut coefficients = self.rows.iter().skip(m).step_by(n_rows);
            for (own, coefficient) in before.iter_mut().zip(coefficients.by_ref()) {
                *own = coefficient.0[lane];
            }
            rest[0] = self.own[m].0[lane];
            for (own, coefficient) in rest[1..].iter_mut().zip(coefficients) {
                *own = coefficient.0[lane];
            }
        }
    }

    /// Appends the derivatives but the value of the polynomial fitted in a lane, in scaled coordinates.
    pub fn fitted(&self, lane: usize, out: &mut Vec<f64>) {
        out.extend(self.own[..self.n_columns()].iter().map(|own| own.0[lane]));
    }
}

/// Columns of ∂²/∂x² and ∂²/∂y².
const XX: usize = row(2, 0) - 1;
const YY: usize = row(0, 2) - 1;

/// The order whose monomials but the constant are `columns`.
const fn order_of(columns: usize) -> usize {
    let mut order = 1;
    while n_monomials(order) < columns + 1 {
        order += 1;
    }
    order
}

/// √w at ρ²: 1/ρ^(p+1).
#[inline(always)]
fn root_weight(square: Lanes, order: usize) -> Lanes {
    let power = match order {
        1 => square,
        2 => square * square.sqrt(),
        3 => square * square,
        _ => square * square * square.sqrt(),
    };
    Lanes::all(1.0) / power
}

/// X ← (I − β v vᵀ)·X in the columns from number `first` on.
#[inline(always)]
fn reflect<const C: usize>(v: &[Lanes], beta: Lanes, x: &mut [[Lanes; C]], first: usize) {
    let mut column = first;
    while column + 5 <= C {
        reflect_some::<C, 5>(v, beta, x, column);
        column += 5;
    }
    match C - column {
        1 => reflect_some::<C, 1>(v, beta, x, column),
        2 => reflect_some::<C, 2>(v, beta, x, column),
        3 => reflect_some::<C, 3>(v, beta, x, column),
        4 => reflect_some::<C, 4>(v, beta, x, column),
        _ => {}
    }
}

/// [`reflect`] in `S` columns at a time, whose products stay in registers.
#[inline(always)]
fn reflect_some<const C: usize, const S: usize>(v: &[Lanes], beta: Lanes, x: &mut [[Lanes; C]], first: usize) {
    let mut products = [Lanes::default(); S];
    for (row, &v) in x.iter().zip(v) {
        if let Some(row) = row[first..].first_chunk::<S>() {
            // Closures might be left out of what is compiled for wide vectors; loops are not.
            for (product, &x) in products.iter_mut().zip(row) {
                *product += v * x;
            }
        }
    }
    for product in &mut products {
        *product *= beta;
    }
    for (row, &v) in x.iter_mut().zip(v) {
        if let Some(row) = row[first..].first_chunk_mut::<S>() {
            for (x, &product) in row.iter_mut().zip(&products) {
                *x -= v * product;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::basis::row as row_of;
    use crate::mwls::{MAX_CONDITION, Mwls};
    use crate::star::default_star;
    use proptest::prelude::*;

    /// Which of 81 nodes a star may take, and its centre.
    fn star() -> impl Strategy<Value = (Vec<bool>, usize)> {
        (prop::collection::vec(prop::bool::weighted(0.7), 81), 0usize..81)
    }

    /// What [`Mwls`] has of one star: condition, radius, rows, coefficients of the fit.
    fn alone(
        places: &[Point],
        nodes: &[NodeId],
        centre: usize,
        order: usize,
        values: &[f64],
    ) -> (Mwls, Vec<f64>, Vec<f64>) {
        let mut mwls = Mwls::default();
        let points = nodes.iter().map(|node| places[node.index()]);
        mwls.factorise(points, places[nodes[centre].index()], Some(centre), order, 0.0);
        let (mut rows, mut fitted) = (Vec::new(), vec![0.0; n_monomials(order)]);
        if mwls.condition() <= MAX_CONDITION {
            mwls.rows(&mut rows);
            mwls.fit(|k| values[nodes[k].index()], &mut fitted);
        }
        (mwls, rows, fitted)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(128))]
        /// Stars of any size, one-sided or flat, beside each other: what each has by itself.
        #[test]
        fn four_systems_at_once_are_those_of_each_star_alone(
            order in 1usize..=4,
            jitter in prop::collection::vec(prop::array::uniform2(-0.3..0.3f64), 81),
            chosen in prop::array::uniform4(star()),
            flat in 0.01..1.0f64,
            values in prop::collection::vec(-1.0..1.0f64, 81),
        ) {
            let places: Vec<Point> =
                (0..81).map(|k| [(k % 9) as f64 + jitter[k][0], flat * ((k / 9) as f64 + jitter[k][1])]).collect();
            let stars = chosen.map(|(is_in, centre)| {
                let most = default_star(order) + centre % 9;
                let mut nodes: Vec<usize> = (0..81).filter(|&k| is_in[k] && k != centre).take(most).collect();
                nodes.push(centre);
                nodes.sort_unstable();
                (nodes.iter().position(|&k| k == centre).expect("just put in"), nodes.into_iter().map(NodeId::of).collect::<Vec<_>>())
            });
            let four = [0, 1, 2, 3].map(|k| CentredStar { nodes: &stars[k].1, centre: stars[k].0 });
            let mut quartet = Quartet::default();
            quartet.factorise(&places, four, order);
            quartet.rows();
            let mut rows = [(); WIDTH].map(|()| Vec::new());
            (0..WIDTH).for_each(|lane| quartet.copy_rows(lane, four[lane], &mut rows[lane]));
            let stretch = [2.0, 3.0];
            let mut laplacians = [(); WIDTH].map(|()| Vec::new());
            quartet.laplacian(stretch);
            (0..WIDTH).for_each(|lane| quartet.copy_rows(lane, four[lane], &mut laplacians[lane]));
            quartet.fit(&values, four);
            for (lane, (centre, nodes)) in stars.iter().enumerate() {
                let (mwls, expected, fit) = alone(&places, nodes, *centre, order, &values);
                let condition = mwls.condition();
                if condition > MAX_CONDITION {
                    prop_assert!(quartet.condition(lane).is_nan() || quartet.condition(lane) > 0.9 * MAX_CONDITION);
                    continue;
                }
                // Rounding, times the condition.
                prop_assert!((quartet.condition(lane) / condition - 1.0).abs() < 1e-13 * condition);
                prop_assert!((quartet.radius(lane) / mwls.radius() - 1.0).abs() < 1e-15);
                let largest = expected.iter().fold(0.0f64, |most, v| most.max(v.abs()));
                let tolerance = 1e-14 * condition * largest;
                prop_assert_eq!(rows[lane].len(), expected.len());
                for (found, expected) in rows[lane].iter().zip(&expected) {
                    prop_assert!((found - expected).abs() <= tolerance, "{} {} {}", found, expected, condition);
                }
                let n = nodes.len();
                if order > 1 {
                    for k in 0..n {
                        let row = |m: usize| expected[(m - 1) * n + k];
                        let expected = stretch[0] * row(row_of(2, 0)) + stretch[1] * row(row_of(0, 2));
                        prop_assert!((laplacians[lane][k] - expected).abs() <= 5.0 * tolerance);
                    }
                }
                let mut found = Vec::new();
                quartet.fitted(lane, &mut found);
                prop_assert_eq!(found.len(), fit.len() - 1);
                for (found, expected) in found.iter().zip(&fit[1..]) {
                    prop_assert!((found - expected).abs() <= n as f64 * tolerance, "{} {}", found, expected);
                }
            }
        }
    }

    #[test]
    fn what_comes_out_of_a_lane_does_not_depend_on_the_others() {
        let places: Vec<Point> =
            (0..49).map(|k| [f64::from(k % 7) + 0.01 * f64::from(k * k % 13), f64::from(k / 7)]).collect();
        let ids = |numbers: &[usize]| numbers.iter().map(|&k| NodeId::of(k)).collect::<Vec<_>>();
        let own = ids(&[16, 17, 18, 23, 24, 25, 30, 31, 32]);
        let long = ids(&(0..21).collect::<Vec<_>>());
        let on_a_line = ids(&[0, 1, 2, 3, 4, 5, 6]);
        let one = CentredStar { nodes: &own, centre: 4 };
        let rows_in = |stars: [CentredStar; WIDTH], lane: usize| {
            let (mut quartet, mut rows) = (Quartet::default(), Vec::new());
            quartet.factorise(&places, stars, 2);
            quartet.rows();
            quartet.copy_rows(lane, one, &mut rows);
            rows
        };
        let alone = rows_in([one; WIDTH], 0);
        let (long, on_a_line) =
            (CentredStar { nodes: &long, centre: 10 }, CentredStar { nodes: &on_a_line, centre: 3 });
        assert_eq!(rows_in([long, on_a_line, one, long], 2), alone);
        assert_eq!(rows_in([long, on_a_line, on_a_line, one], 3), alone);
    }

    #[test]
    fn stars_on_a_line_or_of_coincident_nodes_are_not_sound() {
        let places: Vec<Point> =
            (0..12).map(|k| [f64::from(k), 0.0]).chain([[5.0, 0.0], [4.0, 2.0], [6.0, 1.0]]).collect();
        let line: Vec<NodeId> = (0..9).map(NodeId::of).collect();
        let twice: Vec<NodeId> = [3, 4, 5, 6, 12, 13, 14].map(NodeId::of).to_vec();
        let stars = [CentredStar { nodes: &line, centre: 4 }, CentredStar { nodes: &twice, centre: 2 }];
        for order in 1..=2 {
            let mut quartet = Quartet::default();
            quartet.factorise(&places, [stars[0], stars[1], stars[0], stars[1]], order);
            for lane in 0..WIDTH {
                let condition = quartet.condition(lane);
                assert!(condition.is_nan() || condition > MAX_CONDITION, "{condition}");
            }
        }
    }
}
