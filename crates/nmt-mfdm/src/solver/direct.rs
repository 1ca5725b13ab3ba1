//! Sparse LU factorisation, and the small dense system of the holes: the only file that names faer.

use crate::error::MfdmError;
use crate::system::LinearSystem;
use faer::Mat;
use faer::linalg::solvers::Solve as _;
use faer::sparse::linalg::LuError;
use faer::sparse::{SparseColMat, SymbolicSparseColMat};

/// Largest relative residual ‖b − Ax‖/‖b‖ that is accepted.
///
/// LU with one step of refinement leaves 1e-15 times the growth of the pivots; sound systems of 10⁵ unknowns came to
/// 1e-13. Discretisation errors are 1e-7 at best.
const MAX_RESIDUAL: f64 = 1.0e-9;

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
/// # Errors
/// [`MfdmError::Singular`], [`MfdmError::Memory`], or [`MfdmError::Residual`] where a solution does not satisfy its
/// equations.
pub(crate) fn solve(system: &LinearSystem, right_sides: &[Vec<f64>]) -> Result<Solutions, MfdmError> {
    let n = system.n();
    let matrix = by_columns(system).ok_or(MfdmError::Memory { n })?;
    let factors = matrix.sp_lu().map_err(|error| match error {
        LuError::SymbolicSingular { .. } => MfdmError::Singular { n },
        LuError::Generic(_) => MfdmError::Memory { n },
    })?;
    let solve_once = |b: &[f64]| -> Vec<f64> {
        let mut x = Mat::from_fn(n, 1, |i, _| b[i]);
        factors.solve_in_place(x.as_mut());
        (0..n).map(|i| x[(i, 0)]).collect()
    };
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
    system.apply(x).iter().zip(b).map(|(ax, b)| b - ax).collect()
}

/// ‖b − Ax‖/‖b‖; 0 for b = 0, whose solution is 0.
fn relative_residual(system: &LinearSystem, b: &[f64], x: &[f64]) -> f64 {
    let norm = |v: &[f64]| v.iter().map(|v| v * v).sum::<f64>().sqrt();
    let right = norm(b);
    let left = norm(&residual_vector(system, b, x));
    if right == 0.0 && left == 0.0 { 0.0 } else { left / right }
}

/// The matrix by columns: rows are taken in order, so that each column's rows ascend.
fn by_columns(system: &LinearSystem) -> Option<SparseColMat<usize, f64>> {
    let n = system.n();
    let mut starts = vec![0usize; n + 1];
    system.columns.iter().for_each(|&column| starts[column as usize + 1] += 1);
    (0..n).for_each(|column| starts[column + 1] += starts[column]);
    let mut next = starts.clone();
    let mut rows = vec![0usize; system.columns.len()];
    let mut values = vec![0.0; system.columns.len()];
    for row in 0..n {
        for entry in system.row_starts[row]..system.row_starts[row + 1] {
            let slot = &mut next[system.columns[entry] as usize];
            rows[*slot] = row;
            values[*slot] = system.values[entry];
            *slot += 1;
        }
    }
    (rows.len() < isize::MAX as usize / 16)
        .then(|| SparseColMat::new(SymbolicSparseColMat::new_checked(n, n, starts, None, rows), values))
}

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
    use crate::system::{Role, SplitRow};

    fn tridiagonal(n: u32) -> LinearSystem {
        let mut system = LinearSystem::new(0);
        for i in 0..n {
            let mut row = SplitRow::default();
            if i > 0 {
                row.add(Role::Unknown(i - 1), -1.0);
            }
            row.add(Role::Unknown(i), 2.5);
            if i + 1 < n {
                row.add(Role::Unknown(i + 1), -1.2);
            }
            system.push(&row, f64::from(i));
        }
        system
    }

    #[test]
    fn several_right_sides_share_one_factorisation_and_satisfy_their_equations() -> Result<(), MfdmError> {
        let system = tridiagonal(200);
        let other: Vec<f64> = (0..200).map(|i| f64::from(i % 7) - 3.0).collect();
        let solutions = solve(&system, &[system.rhs.clone(), other.clone(), vec![0.0; 200]])?;
        for (x, b) in solutions.x.iter().zip([&system.rhs, &other]) {
            let worst = system.apply(x).iter().zip(b).map(|(ax, b)| (ax - b).abs()).fold(0.0, f64::max);
            assert!(worst < 1e-12); // rounding of numbers up to 200
        }
        assert!(solutions.x[2].iter().all(|v| *v == 0.0));
        assert!(solutions.residual < 1e-14);
        Ok(())
    }

    #[test]
    fn a_singular_matrix_is_an_error_not_a_number() {
        let mut system = LinearSystem::new(0);
        for _ in 0..2 {
            let mut row = SplitRow::default();
            row.add(Role::Unknown(0), 1.0);
            row.add(Role::Unknown(1), 1.0);
            system.push(&row, 1.0);
        }
        system.rhs[1] = 2.0;
        assert!(solve(&system, &[system.rhs.clone()]).is_err());
    }
}
