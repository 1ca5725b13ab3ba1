//! The constants of holes as further unknowns of a system: one solution for all holes, where one for each would have to be put
//! together.
//!
//! Their equations are the last rows. What the multigrid takes in their place are those of linear elements: the own coefficient
//! of a hole's equation may be next to nothing, or of wrong sign, where its test function is 1 beyond the hole's edge.

use crate::solver::csr::Csr;
use crate::solver::vector::{Sides, add_multiple, norm};
use crate::system::{Equation, LinearSystem, SplitRow};

/// Entries of a row by column, ascending.
type Entries = Vec<(u32, f64)>;

/// The equations of further unknowns, of which the system has the columns.
#[derive(Clone, Copy)]
pub(crate) struct Border<'a> {
    /// One for each.
    pub equations: &'a [Equation],
    /// Those of linear elements, without their right sides.
    pub of_elements: &'a [SplitRow],
}

/// A system with a border, to be taken off again.
pub(crate) struct Bordered<'a> {
    system: &'a mut LinearSystem,
    rows: Vec<Entries>,
}

impl<'a> Bordered<'a> {
    /// Borders a system; `None` where linear elements do not hold the further unknowns.
    pub fn new(system: &'a mut LinearSystem, border: Border) -> Option<Self> {
        let (n, n_more) = (system.n(), border.equations.len());
        let of_more =
            |row: &SplitRow, k: usize| row.holes.iter().find(|(hole, _)| *hole as usize == k).map_or(0.0, |(_, c)| *c);
        let is_held = |k: usize| border.of_elements.get(k).is_some_and(|row| of_more(row, k) > 0.0);
        if n_more == 0 || n_more != system.hole_columns.len() || !(0..n_more).all(is_held) {
            return None;
        }
        // Right sides of holes are large beside those of nodes, whose residuals would be lost among theirs.
        let [norm] = norm(system.rhs.as_chunks::<1>().0);
        let scale = |equation: &Equation| {
            let scale = norm / (equation.rhs - equation.row.known).abs();
            if scale.is_normal() { scale } else { 1.0 }
        };
        let scales: Vec<f64> = border.equations.iter().map(scale).collect();
        let entries = |row: &SplitRow, scale: f64| -> Entries {
            let mut more = row.holes.clone();
            more.sort_unstable_by_key(|(hole, _)| *hole);
            let more = more.into_iter().map(|(hole, c)| (n as u32 + hole, c));
            row.unknowns.iter().copied().chain(more).map(|(column, c)| (column, scale * c)).collect()
        };
        let of_elements: Vec<Entries> =
            border.of_elements.iter().zip(&scales).map(|(row, s)| entries(row, *s)).collect();
        system.matrix.border(&system.hole_columns, &of_elements);
        let rows = border.equations.iter().zip(&scales).map(|(equation, s)| entries(&equation.row, *s)).collect();
        let right = border.equations.iter().zip(&scales).map(|(equation, s)| s * (equation.rhs - equation.row.known));
        system.rhs.extend(right);
        Some(Self { system, rows })
    }

    /// Number of further unknowns, the last ones.
    pub fn n_more(&self) -> usize {
        self.rows.len()
    }

    /// The matrix of the multigrid.
    pub fn matrix(&self) -> &Csr {
        &self.system.matrix
    }

    /// The matrix of the equations.
    pub fn operator(&self) -> Operator<'_> {
        Operator { matrix: &self.system.matrix, last_rows: &self.rows }
    }

    /// Their right side.
    pub fn rhs(&self) -> &[f64] {
        &self.system.rhs
    }
}

impl Drop for Bordered<'_> {
    fn drop(&mut self) {
        let n = self.system.rhs.len() - self.rows.len();
        self.system.rhs.truncate(n);
        self.system.matrix.unborder(n);
    }
}

/// A matrix whose last rows may be others.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Operator<'a> {
    matrix: &'a Csr,
    last_rows: &'a [Entries],
}

impl<'a> From<&'a Csr> for Operator<'a> {
    fn from(matrix: &'a Csr) -> Self {
        Self { matrix, last_rows: &[] }
    }
}

impl Operator<'_> {
    pub fn n_rows(&self) -> usize {
        self.matrix.n_rows()
    }

    /// y = A·x.
    pub fn apply_to<const K: usize>(&self, x: &[Sides<K>], y: &mut [Sides<K>]) {
        self.matrix.apply_to(x, y);
        self.correct(x, y);
    }

    /// Makes of the matrix's product with x that of the operator.
    pub fn correct<const K: usize>(&self, x: &[Sides<K>], product: &mut [Sides<K>]) {
        let first = product.len() - self.last_rows.len();
        for (own, row) in product[first..].iter_mut().zip(self.last_rows) {
            *own = [0.0; K];
            row.iter().for_each(|&(column, value)| add_multiple(own, value, x[column as usize]));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::{RightSide, Solver, TARGET, solve, solve_bordered};
    use crate::system::Role;

    const N: u32 = 60;

    /// Five-point differences on a square of `N` by `N`, in which two blocks of 9 by 9 unknowns are held by no more than
    /// their hole: u = c there. The sums of the differences around them are the holes' equations.
    struct WithHoles {
        system: LinearSystem,
        equations: Vec<Equation>,
    }

    fn with_holes() -> WithHoles {
        let hole_at = |i: u32, j: u32| {
            let within = |from: u32, k: u32| (from..from + 9).contains(&k);
            [(10, 12), (34, 40)].iter().position(|&(x, y)| within(x, i) && within(y, j))
        };
        let places = || (0..N).flat_map(|j| (0..N).map(move |i| (i, j)));
        let number = |i: u32, j: u32| places().filter(|&(i, j)| hole_at(i, j).is_none()).position(|at| at == (i, j));
        let numbers: Vec<Option<usize>> = places().map(|(i, j)| number(i, j)).collect();
        let n = numbers.iter().flatten().count();
        let mut system = LinearSystem::new(n, 2);
        let mut equations =
            vec![Equation { rhs: 3.0, ..Equation::default() }, Equation { rhs: 90.0, ..Equation::default() }];
        let mut sums = vec![std::collections::BTreeMap::<u32, f64>::new(); 2];
        for (i, j) in places() {
            let around = [(0, u32::MAX), (u32::MAX, 0), (0, 0), (1, 0), (0, 1)]
                .map(|(x, y)| (i.wrapping_add(x), j.wrapping_add(y)));
            let role = |(x, y): (u32, u32)| match (x < N && y < N).then(|| hole_at(x, y)) {
                None => Role::Known(0.0),
                Some(Some(hole)) => Role::Hole(hole as u32),
                Some(None) => Role::Unknown(numbers[(y * N + x) as usize].unwrap_or_default() as u32),
            };
            let mut row = SplitRow::default();
            around.iter().for_each(|&at| row.add(role(at), if at == (i, j) { 4.0 } else { -1.0 }));
            match hole_at(i, j) {
                None => system.push(&Equation { row, rhs: 1.0 }),
                Some(hole) => {
                    row.unknowns.iter().for_each(|&(k, value)| *sums[hole].entry(k).or_insert(0.0) += value);
                    row.holes.iter().for_each(|&(k, value)| equations[hole].row.add(Role::Hole(k), value));
                }
            }
        }
        equations.iter_mut().zip(sums).for_each(|(equation, sums)| equation.row.unknowns = sums.into_iter().collect());
        WithHoles { system, equations }
    }

    #[test]
    fn a_border_is_put_on_and_taken_off() {
        let WithHoles { mut system, equations } = with_holes();
        let before = system.clone();
        let rows: Vec<SplitRow> = equations.iter().map(|equation| equation.row.clone()).collect();
        let n = system.n();
        let x: Vec<Sides<1>> = (0..n + 2).map(|k| [((k * 7) % 11) as f64 - 4.0]).collect();
        {
            let of_elements: Vec<SplitRow> = rows.iter().map(|row| row.times(2.0)).collect();
            let border = Border { equations: &equations, of_elements: &of_elements };
            let bordered = Bordered::new(&mut system, border).expect("a border");
            assert_eq!((bordered.n_more(), bordered.rhs().len(), bordered.matrix().n_rows()), (2, n + 2, n + 2));
            let mut product = vec![[0.0]; n + 2];
            bordered.operator().apply_to(&x, &mut product);
            for k in 0..n {
                let of_holes = before.hole_columns.iter().zip(&x[n..]).map(|(column, [c])| {
                    column.iter().filter(|(row, _)| *row as usize == k).map(|(_, value)| value * c).sum::<f64>()
                });
                let [expected] = before.matrix.row(k).dot(&x[..n]);
                assert_eq!(product[k][0], expected + of_holes.sum::<f64>(), "equation {k}");
            }
            for (k, row) in rows.iter().enumerate() {
                let scale = bordered.rhs()[n + k] / equations[k].rhs;
                let unknowns = row.unknowns.iter().map(|(j, value)| value * x[*j as usize][0]).sum::<f64>();
                let holes = row.holes.iter().map(|(hole, value)| value * x[n + *hole as usize][0]).sum::<f64>();
                assert!((product[n + k][0] - scale * (unknowns + holes)).abs() < 1e-12 * scale * 100.0); // rounding
            }
        }
        assert_eq!((system.matrix, system.rhs), (before.matrix, before.rhs));
    }

    #[test]
    fn unknowns_and_constants_come_out_together_as_put_together() {
        let WithHoles { mut system, mut equations } = with_holes();
        let of_elements: Vec<SplitRow> = equations.iter().map(|equation| equation.row.clone()).collect();
        // The first hole's equation and those of all unknowns around it: its own coefficient is 0 then.
        let own = equations[0].row.holes[0].1;
        let beside: Vec<(u32, f64)> = system.hole_columns[0].clone();
        assert_eq!(beside.iter().map(|(_, value)| value).sum::<f64>(), -own);
        let mut sums: std::collections::BTreeMap<u32, f64> = equations[0].row.unknowns.iter().copied().collect();
        for (k, _) in &beside {
            let row = system.matrix.row(*k as usize);
            row.entries().for_each(|(j, value)| *sums.entry(j as u32).or_insert(0.0) += value);
            equations[0].rhs += system.rhs[*k as usize];
        }
        equations[0].row.unknowns = sums.into_iter().collect();
        equations[0].row.holes[0].1 = 0.0;
        let border = Border { equations: &equations, of_elements: &of_elements };
        let (x, how) = solve_bordered(&mut system, border, Solver::Iterative, TARGET, &mut |_| {}).expect("a solution");
        let iterations = how.iteration.unwrap_or_default().iterations;
        assert!(how.residual <= 1e-10 && (3..25).contains(&iterations), "{how:?}"); // 8 measured
        let n = system.n();
        let (constants, x) = (x[n..].to_vec(), &x[..n]);
        let right: Vec<f64> = (0..n)
            .map(|k| {
                let of_holes = system.hole_columns.iter().zip(&constants);
                let entries = of_holes.flat_map(|(column, c)| column.iter().map(move |(row, value)| (*row, value * c)));
                system.rhs[k] - entries.filter(|(row, _)| *row as usize == k).map(|(_, value)| value).sum::<f64>()
            })
            .collect();
        let places = || (0..n).map(|k| [k as f64, 0.0]).collect();
        let alone = solve(&system, &places, &[RightSide::All(&right)], Solver::Direct, TARGET, &mut |_| {});
        let alone = alone.expect("a solution").x.swap_remove(0);
        let scale = alone.iter().fold(0.0, |largest: f64, v| largest.max(v.abs()));
        assert!(x.iter().zip(&alone).all(|(a, b)| (a - b).abs() < 1e-8 * scale)); // residual 1e-10
        for equation in &equations {
            let unknowns = equation.row.unknowns.iter().map(|(k, value)| value * x[*k as usize]).sum::<f64>();
            let holes = equation.row.holes.iter().map(|(hole, value)| value * constants[*hole as usize]).sum::<f64>();
            assert!((unknowns + holes - equation.rhs).abs() < 1e-8 * equation.rhs, "{unknowns} {holes}"); // residual 1e-10
        }
    }

    #[test]
    fn what_linear_elements_do_not_hold_has_no_border() {
        let WithHoles { mut system, equations } = with_holes();
        let mut of_elements: Vec<SplitRow> = equations.iter().map(|equation| equation.row.clone()).collect();
        of_elements[1] = of_elements[1].times(-1.0);
        let before = system.clone();
        assert!(Bordered::new(&mut system, Border { equations: &equations, of_elements: &of_elements }).is_none());
        assert_eq!((system.matrix, system.rhs), (before.matrix, before.rhs));
    }
}
