//! The way between two levels in half the memory: a preconditioner need not be exact to the last bit.

use crate::parallel::fill_pieces;
use crate::solver::csr::Csr;
use crate::solver::vector::{Sides, add_multiple};

/// Rows per piece.
const ROWS: usize = 1 << 13;

/// A prolongator or a restrictor with values of single precision.
#[derive(Clone, Debug)]
pub(crate) struct Transfer {
    starts: Vec<u32>, // first entry of each row, shape (n_rows + 1,)
    columns: Vec<u32>,
    values: Vec<f32>,
}

impl Transfer {
    /// Of a matrix of fewer than 2³² entries.
    pub fn new(matrix: &Csr) -> Self {
        Self {
            starts: matrix.starts().iter().map(|&start| start as u32).collect(),
            columns: matrix.columns().to_vec(),
            values: matrix.values().iter().map(|&value| value as f32).collect(),
        }
    }

    /// y = T·x.
    pub fn apply_to<const K: usize>(&self, x: &[Sides<K>], y: &mut [Sides<K>]) {
        fill_pieces(y, ROWS, |first, y| {
            y.iter_mut().enumerate().for_each(|(k, y)| {
                *y = [0.0; K];
                self.add_row(first + k, x, y);
            });
        });
    }

    /// y += T·x.
    pub fn add_to<const K: usize>(&self, x: &[Sides<K>], y: &mut [Sides<K>]) {
        fill_pieces(y, ROWS, |first, y| y.iter_mut().enumerate().for_each(|(k, y)| self.add_row(first + k, x, y)));
    }

    #[inline(always)]
    fn add_row<const K: usize>(&self, i: usize, x: &[Sides<K>], y: &mut Sides<K>) {
        let entries = self.starts[i] as usize..self.starts[i + 1] as usize;
        for (&column, &value) in self.columns[entries.clone()].iter().zip(&self.values[entries]) {
            add_multiple(y, f64::from(value), x[column as usize]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::csr::tests::of_dense;

    #[test]
    fn products_are_those_of_the_matrix_to_single_precision() {
        let entry = |i: usize, j: usize| if (i + 2 * j).is_multiple_of(3) { 0.1 + (i * j) as f64 } else { 0.0 };
        let matrix = of_dense(&(0..7).map(|i| (0..5).map(|j| entry(i, j)).collect()).collect::<Vec<Vec<f64>>>());
        let transfer = Transfer::new(&matrix);
        let x = [1.0, -2.0, 0.3, 4.0, 5.0];
        let both: Vec<Sides<2>> = x.iter().map(|x| [*x, 2.0 * x]).collect();
        let mut y = vec![[7.0; 2]; 7];
        transfer.apply_to(&both, &mut y);
        for (y, expected) in y.iter().zip(matrix.apply(&x)) {
            assert!((y[0] - expected).abs() < 1e-5 && y[1] == 2.0 * y[0]); // 24 entries, of up to 24, at 6e-8
        }
        let before = y.clone();
        transfer.add_to(&both, &mut y);
        assert!(y.iter().zip(&before).all(|(y, before)| (y[0] - 2.0 * before[0]).abs() < 1e-12));
    }
}
