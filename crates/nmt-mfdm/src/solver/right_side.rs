//! Right sides of a linear system: numbers of all equations, or of the few that a hole's constant enters.

use crate::solver::vector::{Sides, dot_side};
use std::borrow::Cow;

/// A right side b.
#[derive(Clone, Copy, Debug)]
pub(crate) enum RightSide<'a> {
    /// A number of every equation, shape (n,).
    All(&'a [f64]),
    /// −a of an unknown that is 1, from its column a: (equation, a_i), each equation at most once.
    Column(&'a [(u32, f64)]),
}

impl<'a> RightSide<'a> {
    /// Shape (n,).
    pub fn dense(self, n: usize) -> Cow<'a, [f64]> {
        match self {
            Self::All(b) => Cow::Borrowed(b),
            Self::Column(column) => {
                let mut b = vec![0.0; n];
                column.iter().for_each(|&(row, a)| b[row as usize] -= a);
                Cow::Owned(b)
            }
        }
    }

    /// r += b for right side `k`.
    pub fn add_to<const K: usize>(self, k: usize, r: &mut [Sides<K>]) {
        match self {
            Self::All(b) => r.iter_mut().zip(b).for_each(|(r, b)| r[k] += b),
            Self::Column(column) => column.iter().for_each(|&(row, a)| r[row as usize][k] -= a),
        }
    }

    /// b·x of right side `k`.
    pub fn dot<const K: usize>(self, k: usize, x: &[Sides<K>]) -> f64 {
        match self {
            Self::All(b) => dot_side(b, x, k),
            Self::Column(column) => -column.iter().map(|&(row, a)| a * x[row as usize][k]).sum::<f64>(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_column_is_what_its_dense_form_is() {
        let column = RightSide::Column(&[(3, 2.0), (1, -0.5)]);
        let dense = column.dense(5);
        assert_eq!(*dense, [0.0, 0.5, 0.0, -2.0, 0.0]);
        let x: Vec<Sides<2>> = (0..5).map(|i| [7.0, f64::from(i * i)]).collect();
        assert_eq!((column.dot(1, &x), RightSide::All(&dense).dot(1, &x)), (-17.5, -17.5));
        for b in [column, RightSide::All(&dense)] {
            let mut r = vec![[1.0; 2]; 5];
            b.add_to(1, &mut r);
            assert_eq!(r.as_flattened(), [1.0, 1.0, 1.0, 1.5, 1.0, 1.0, 1.0, -1.0, 1.0, 1.0]);
        }
    }
}
