//! Sparse LU factorisation, and the small dense system of the holes: the only file that names faer.

use crate::error::MfdmError;
use crate::solver::MAX_RESIDUAL;
use crate::solver::csr::Csr;
use crate::solver::ordering::{ColumnRows, nested_dissection};
use crate::solver::vector::Sides;
use crate::system::LinearSystem;
use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::solvers::{DenseSolveCore as _, PartialPivLu, Solve as _};
use faer::perm::PermRef;
use faer::sparse::linalg::lu::supernodal::{
    SupernodalLu, factorize_supernodal_numeric_lu, factorize_supernodal_numeric_lu_scratch,
    factorize_supernodal_symbolic_lu, factorize_supernodal_symbolic_lu_scratch, solve_in_place_scratch,
};
use faer::sparse::linalg::{LuError, qr};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, Mat, MatMut, Par};
use nmt_geom::Point;

/// Solutions of one system and the largest relative residual among them.
#[derive(Clone, Debug)]
pub(crate) struct Solutions {
    /// One vector a right side.
    pub x: Vec<Vec<f64>>,
    /// max ‖b − Ax‖/‖b‖.
    pub residual: f64,
}

/// Solves A·x = b for every right side with one factorisation, each refined once and checked by its true residual.
///
/// `xy` are the places of the unknowns, shape (n, 2): they give the order of elimination.
///
/// # Errors
/// [`MfdmError::Singular`], [`MfdmError::Memory`], or [`MfdmError::Residual`] where a solution does not satisfy its
/// equations.
pub(crate) fn solve(system: &LinearSystem, xy: &[Point], right_sides: &[&[f64]]) -> Result<Solutions, MfdmError> {
    let n = system.n();
    let factors = Factors::new(system, xy)?;
    let solve_once = |b: &[f64]| factors.solve(b);
    let mut solutions = Solutions { x: Vec::with_capacity(right_sides.len()), residual: 0.0 };
    for b in right_sides {
        let mut x = solve_once(b);
        let correction = solve_once(&residual_vector(system, b, &x));
        let refined: Vec<f64> = x.iter().zip(&correction).map(|(x, d)| x + d).collect();
        let (before, after) = (relative_residual(system, b, &x), relative_residual(system, b, &refined));
        if after < before {
            x = refined;
        }
        let residual = if after < before { after } else { before };
        if residual.is_nan() {
            return Err(MfdmError::Singular { n });
        }
        if residual > MAX_RESIDUAL {
            return Err(MfdmError::Residual { n, residual, limit: MAX_RESIDUAL });
        }
        solutions.residual = solutions.residual.max(residual);
        solutions.x.push(x);
    }
    Ok(solutions)
}

fn residual_vector(system: &LinearSystem, b: &[f64], x: &[f64]) -> Vec<f64> {
    system.matrix.apply(x).iter().zip(b).map(|(ax, b)| b - ax).collect()
}

/// ‖b − Ax‖/‖b‖; 0 for b = 0, whose solution is 0.
fn relative_residual(system: &LinearSystem, b: &[f64], x: &[f64]) -> f64 {
    let norm = |v: &[f64]| v.iter().map(|v| v * v).sum::<f64>().sqrt();
    let right = norm(b);
    let left = norm(&residual_vector(system, b, x));
    if right == 0.0 && left == 0.0 { 0.0 } else { left / right }
}

/// P·A·Q = L·U with row pivoting.
struct Factors {
    lu: SupernodalLu<usize, f64>,
    row_order: Order,
    column_order: Order,
}

/// A permutation: `forward[k]` comes to place k, `inverse` is its inverse.
struct Order {
    forward: Vec<usize>,
    inverse: Vec<usize>,
}

impl Order {
    fn new(forward: Vec<usize>) -> Self {
        let mut inverse = vec![0; forward.len()];
        forward.iter().enumerate().for_each(|(place, &k)| inverse[k] = place);
        Self { forward, inverse }
    }

    fn as_ref(&self) -> PermRef<'_, usize> {
        PermRef::new_checked(&self.forward, &self.inverse, self.forward.len())
    }
}

impl Factors {
    fn new(system: &LinearSystem, xy: &[Point]) -> Result<Self, MfdmError> {
        let n = system.n();
        let out_of_memory = |_| MfdmError::Memory { n };
        let by_rows = &system.matrix;
        let ByColumns { starts, rows, values } = by_columns(by_rows);
        let columns = by_rows.columns().iter().map(|&c| c as usize).collect::<Vec<_>>();
        let a = SparseColMatRef::new(SymbolicSparseColMatRef::new_checked(n, n, &starts, None, &rows), &values);
        // The rows of A are the columns of its transpose.
        let pattern = SymbolicSparseColMatRef::new_checked(n, n, by_rows.starts(), None, &columns);
        let transpose = SparseColMatRef::new(pattern, by_rows.values());

        let dissected = Order::new(nested_dissection(&ColumnRows { starts: &starts, rows: &rows }, xy));
        let workspace = StackReq::new::<usize>(8 * n)
            .or(factorize_supernodal_symbolic_lu_scratch::<usize>(n, n))
            .or(qr::column_counts_aat_scratch::<usize>(n, n));
        let mut memory = MemBuffer::try_new(workspace).map_err(out_of_memory)?;
        let stack = MemStack::new(&mut memory);
        let (mut etree, mut post) = (vec![0usize; n], vec![0usize; n]);
        let tree = qr::col_etree(a.symbolic(), Some(dissected.as_ref()), &mut etree, stack);
        qr::postorder(&mut post, tree, stack);
        // Supernodes are runs of columns: those of one branch must stand together.
        let column_order = Order::new(post.iter().map(|&place| dissected.forward[place]).collect());
        let (mut counts, mut least_column) = (vec![0usize; n], vec![0usize; n]);
        let tree = qr::col_etree(a.symbolic(), Some(column_order.as_ref()), &mut etree, stack);
        qr::postorder(&mut post, tree, stack);
        qr::column_counts_ata(
            &mut counts,
            &mut least_column,
            transpose.symbolic(),
            Some(column_order.as_ref()),
            tree,
            &post,
            stack,
        );
        let symbolic = factorize_supernodal_symbolic_lu(
            a.symbolic(),
            Some(column_order.as_ref()),
            &least_column,
            tree,
            &counts,
            stack,
            Default::default(),
        )
        .map_err(|_| MfdmError::Memory { n })?;

        let workspace = factorize_supernodal_numeric_lu_scratch::<usize, f64>(&symbolic, Default::default());
        let mut memory = MemBuffer::try_new(workspace).map_err(out_of_memory)?;
        let mut row_order = Order { forward: vec![0; n], inverse: vec![0; n] };
        let mut lu = SupernodalLu::new();
        factorize_supernodal_numeric_lu(
            &mut row_order.forward,
            &mut row_order.inverse,
            &mut lu,
            a,
            transpose,
            column_order.as_ref(),
            &symbolic,
            Par::Seq,
            MemStack::new(&mut memory),
            Default::default(),
        )
        .map_err(|error| match error {
            LuError::SymbolicSingular { .. } => MfdmError::Singular { n },
            LuError::Generic(_) => MfdmError::Memory { n },
        })?;
        Ok(Self { lu, row_order, column_order })
    }

    fn solve(&self, b: &[f64]) -> Vec<f64> {
        let n = b.len();
        let mut x = Mat::from_fn(n, 1, |i, _| b[i]);
        let mut memory = MemBuffer::new(solve_in_place_scratch::<usize, f64>(n, 1, Par::Seq));
        self.lu.solve_in_place_with_conj(
            self.row_order.as_ref(),
            self.column_order.as_ref(),
            Conj::No,
            x.as_mut(),
            Par::Seq,
            MemStack::new(&mut memory),
        );
        (0..n).map(|i| x[(i, 0)]).collect()
    }
}

/// The matrix by columns.
struct ByColumns {
    starts: Vec<usize>,
    rows: Vec<usize>,
    values: Vec<f64>,
}

/// Rows are taken in order, so that each column's rows ascend.
fn by_columns(matrix: &Csr) -> ByColumns {
    let n = matrix.n_rows();
    let mut starts = vec![0usize; n + 1];
    matrix.columns().iter().for_each(|&column| starts[column as usize + 1] += 1);
    (0..n).for_each(|column| starts[column + 1] += starts[column]);
    let mut next = starts.clone();
    let mut rows = vec![0usize; matrix.n_entries()];
    let mut values = vec![0.0; matrix.n_entries()];
    for row in 0..n {
        for (column, value) in matrix.row(row).entries() {
            let slot = &mut next[column];
            (rows[*slot], values[*slot]) = (row, value);
            *slot += 1;
        }
    }
    ByColumns { starts, rows, values }
}

/// A small matrix factorised densely: the coarsest level of the multigrid.
pub(crate) struct DenseFactors {
    n: usize,
    lu: PartialPivLu<f64>,
}

impl DenseFactors {
    pub fn new(matrix: &Csr) -> Self {
        let n = matrix.n_rows();
        let mut dense = Mat::<f64>::zeros(n, n);
        (0..n).for_each(|i| matrix.row(i).entries().for_each(|(j, value)| dense[(i, j)] = value));
        Self { n, lu: dense.partial_piv_lu() }
    }

    /// Number of unknowns.
    pub fn n(&self) -> usize {
        self.n
    }

    /// x = A⁻¹·b.
    pub fn solve<const K: usize>(&self, b: &[Sides<K>], x: &mut [Sides<K>]) {
        x.copy_from_slice(b);
        self.lu.solve_in_place(MatMut::from_row_major_slice_mut(x.as_flattened_mut(), self.n, K));
    }
}

/// The inverse of a small dense matrix by rows, shape (n, n); `None` where its condition is above
/// [`MAX_INVERSE_CONDITION`] (largest sums of rows).
pub(crate) fn dense_inverse(n: usize, entry: impl Fn(usize, usize) -> f64) -> Option<Vec<f64>> {
    let matrix = Mat::from_fn(n, n, entry);
    let inverse = matrix.partial_piv_lu().inverse();
    let largest_row = |m: &Mat<f64>| (0..n).map(|i| (0..n).map(|j| m[(i, j)].abs()).sum::<f64>()).fold(0.0, f64::max);
    let condition = largest_row(&matrix) * largest_row(&inverse);
    let by_rows = (0..n).flat_map(|i| (0..n).map(move |j| (i, j))).map(|at| inverse[at]);
    (condition <= MAX_INVERSE_CONDITION).then(|| by_rows.collect())
}

/// Beyond it an inverse serves no more: those of sound patches have 10 to 100.
const MAX_INVERSE_CONDITION: f64 = 1.0e4;

/// Solves a small dense system given by rows.
///
/// # Errors
/// [`MfdmError::Singular`] where the result is not finite.
pub(crate) fn solve_dense(rows: &[Vec<f64>], b: &[f64]) -> Result<Vec<f64>, MfdmError> {
    let n = b.len();
    let matrix = Mat::from_fn(n, n, |i, j| rows[i][j]);
    let mut x = Mat::from_fn(n, 1, |i, _| b[i]);
    matrix.partial_piv_lu().solve_in_place(x.as_mut());
    let x: Vec<f64> = (0..n).map(|i| x[(i, 0)]).collect();
    if x.iter().all(|v| v.is_finite()) { Ok(x) } else { Err(MfdmError::Singular { n }) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::system::{Equation, Role, SplitRow};

    fn tridiagonal(n: u32) -> LinearSystem {
        let mut system = LinearSystem::new(n as usize, 0);
        for i in 0..n {
            let mut row = SplitRow::default();
            if i > 0 {
                row.add(Role::Unknown(i - 1), -1.0);
            }
            row.add(Role::Unknown(i), 2.5);
            if i + 1 < n {
                row.add(Role::Unknown(i + 1), -1.2);
            }
            system.push(&Equation { row, rhs: f64::from(i) });
        }
        system
    }

    fn line(n: usize) -> Vec<Point> {
        (0..n).map(|k| [k as f64, 0.0]).collect()
    }

    #[test]
    fn several_right_sides_share_one_factorisation_and_satisfy_their_equations() -> Result<(), MfdmError> {
        let system = tridiagonal(200);
        let other: Vec<f64> = (0..200).map(|i| f64::from(i % 7) - 3.0).collect();
        let solutions = solve(&system, &line(200), &[&system.rhs, &other, &[0.0; 200]])?;
        for (x, b) in solutions.x.iter().zip([&system.rhs, &other]) {
            let worst = system.matrix.apply(x).iter().zip(b).map(|(ax, b)| (ax - b).abs()).fold(0.0, f64::max);
            assert!(worst < 1e-12); // rounding of numbers up to 200
        }
        assert!(solutions.x[2].iter().all(|v| *v == 0.0));
        assert!(solutions.residual < 1e-14);
        Ok(())
    }

    #[test]
    fn a_singular_matrix_is_an_error_not_a_number() {
        let mut system = LinearSystem::new(2, 0);
        for _ in 0..2 {
            let mut row = SplitRow::default();
            row.add(Role::Unknown(0), 1.0);
            row.add(Role::Unknown(1), 1.0);
            system.push(&Equation { row, rhs: 1.0 });
        }
        system.rhs[1] = 2.0;
        assert!(solve(&system, &line(2), &[&system.rhs]).is_err());
    }
}
