//! Sums and updates of long vectors, of several right sides at once: in pieces of fixed size, so that the number of threads
//! changes no bit.

use crate::parallel::{fill_pieces, map_pieces};
use std::array::from_fn;

/// What belongs to each of K right sides, such as their values at one unknown.
///
/// A pass over a matrix is mostly the reading of it, so that two right sides take little more time than one. None looks at
/// another: each comes out as it would alone.
pub(crate) type Sides<const K: usize> = [f64; K];

/// Numbers per piece: small enough to stay in the cache, large enough to hide the cost of handing it out.
const PIECE: usize = 1 << 14;

/// Partial sums of one piece, so that additions do not wait for one another.
const LANES: usize = 8;

/// sum += factor·x.
#[inline(always)]
pub(crate) fn add_multiple<const K: usize>(sum: &mut Sides<K>, factor: f64, x: Sides<K>) {
    (0..K).for_each(|k| sum[k] += factor * x[k]);
}

/// One of several that stand beside each other, shape (n,).
pub(crate) fn one_of<const K: usize>(all: &[Sides<K>], k: usize) -> Vec<f64> {
    all.iter().map(|sides| sides[k]).collect()
}

/// x·y; the rounding error grows with the square root of the length at most a piece, then with the number of pieces.
pub(crate) fn dot<const K: usize>(x: &[Sides<K>], y: &[Sides<K>]) -> Sides<K> {
    sum(x.len(), |i| from_fn(|k| x[i][k] * y[i][k]))
}

/// [`dot`] of a vector by itself with one of several.
pub(crate) fn dot_side<const K: usize>(x: &[f64], all: &[Sides<K>], k: usize) -> f64 {
    let [sum] = sum(x.len(), |i| [x[i] * all[i][k]]);
    sum
}

fn sum<const K: usize>(n: usize, of: impl Fn(usize) -> Sides<K> + Sync + Send) -> Sides<K> {
    let piece = |range: std::ops::Range<usize>| {
        let mut lanes = [[0.0; K]; LANES];
        for first in range.clone().step_by(LANES) {
            let group = first..(first + LANES).min(range.end);
            group.zip(&mut lanes).for_each(|(i, lane)| add_multiple(lane, 1.0, of(i)));
        }
        from_fn(|k| lanes.iter().map(|lane| lane[k]).sum())
    };
    let pieces: Vec<Sides<K>> = map_pieces(0..n, PIECE, piece);
    from_fn(|k| pieces.iter().map(|piece| piece[k]).sum())
}

/// ‖x‖.
pub(crate) fn norm<const K: usize>(x: &[Sides<K>]) -> Sides<K> {
    dot(x, x).map(f64::sqrt)
}

/// Each element of `out` from its index, its right side and itself.
pub(crate) fn update<const K: usize>(out: &mut [Sides<K>], new: impl Fn(usize, usize, f64) -> f64 + Sync + Send) {
    fill_pieces(out, PIECE, |first, piece| {
        for (i, values) in piece.iter_mut().enumerate() {
            *values = from_fn(|k| new(first + i, k, values[k]));
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_product_of_integers_is_exact_for_each_right_side() {
        let n = 3 * PIECE + 5;
        let x: Vec<f64> = (0..n).map(|i| (i % 10) as f64).collect();
        let (squares, sum): (usize, usize) = (0..n).fold((0, 0), |(s, t), i| (s + (i % 10) * (i % 10), t + i % 10));
        let both: Vec<Sides<2>> = x.iter().map(|x| [*x, 1.0]).collect();
        let twice: Vec<Sides<2>> = x.iter().map(|x| [*x, *x]).collect();
        assert_eq!(dot(&both, &twice), [squares as f64, sum as f64]);
        assert_eq!((dot_side(&x, &both, 0), dot_side(&x, &both, 1)), (squares as f64, sum as f64));
        assert_eq!(norm(&[[3.0, 0.0], [4.0, 2.0]]), [5.0, 2.0]);
        assert_eq!((one_of(&both, 0), one_of(&both, 1)), (x, vec![1.0; n]));
    }
}
