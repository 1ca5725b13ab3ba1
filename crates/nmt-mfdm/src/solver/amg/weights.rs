//! How much each equation counts where several are summed to one of the next level.
//!
//! ∇²u collocated at the nodes is no weighted sum of itself: with 1 for every equation the sum over an aggregate is not
//! what flows out of it, since stars differ in size and overlap, and the coarser equations correct smooth errors by the
//! wrong amount, more so with every level. With w of Aᵀw = 0 inside, the columns sum to nothing there and what is summed
//! is conserved, as in the symmetric forms, whose w is 1. A few sweeps of Jacobi come near enough to it: the sums of columns fall
//! to a seventh.

use crate::solver::csr::{Csr, Diagonal};

/// Sweeps.
const SWEEPS: usize = 3;

/// Damping of a sweep.
const OMEGA: f64 = 0.7;

/// Weights stay within these: where signs are wrong sweeps go astray.
const RANGE: [f64; 2] = [0.2, 5.0];

/// The weight of every equation, about 1; shape (n,). Equations of weak diagonal do not count while it is found.
pub(crate) fn equation_weights(a: &Csr, diagonal: &Diagonal, is_weak: &[bool]) -> Vec<f64> {
    let n = a.n_rows();
    let mut weights: Vec<f64> = is_weak.iter().map(|&is_weak| if is_weak { 0.0 } else { 1.0 }).collect();
    let mut sums = vec![0.0; n];
    for _ in 0..SWEEPS {
        // Rows scatter into columns: one after the other, whatever the number of threads.
        sums.fill(0.0);
        for (i, weight) in weights.iter().enumerate().filter(|(i, _)| !is_weak[*i]) {
            a.row(i).entries().for_each(|(j, value)| sums[j] += weight * value);
        }
        for i in (0..n).filter(|i| !is_weak[*i]) {
            weights[i] -= OMEGA * sums[i] / diagonal.values[i];
        }
    }
    weights.iter_mut().for_each(|weight| *weight = weight.clamp(RANGE[0], RANGE[1]));
    weights
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::csr::tests::of_dense;

    #[test]
    fn rows_of_unequal_size_are_weighed_to_columns_that_sum_to_less() {
        // A ring of differences, every third row half as large as the others.
        let n = 30;
        let size = |i: usize| if i.is_multiple_of(3) { 0.5 } else { 1.0 };
        let entry = |i: usize, j: usize| match (i + n - j) % n {
            0 => 2.0 * size(i),
            1 | 29 => -size(i),
            _ => 0.0,
        };
        let a = of_dense(&(0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect::<Vec<Vec<f64>>>());
        let largest = |weights: &[f64]| a.transpose().apply(weights).iter().fold(0.0f64, |m, v| m.max(v.abs()));
        let weights = equation_weights(&a, &Diagonal::new(&a), &vec![false; n]);
        assert!(largest(&weights) < 0.4 * largest(&vec![1.0; n]), "{weights:?}");
        let mut is_weak = vec![false; n];
        is_weak[4] = true;
        assert_eq!(equation_weights(&a, &Diagonal::new(&a), &is_weak)[4], RANGE[0]);
    }
}
