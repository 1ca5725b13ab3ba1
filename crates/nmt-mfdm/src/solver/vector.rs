//! Sums and updates of long vectors: in pieces of fixed size, so that the number of threads changes no bit.

use crate::parallel::{fill_pieces, map_pieces};

/// Numbers per piece: small enough to stay in the cache, large enough to hide the cost of handing it out.
const PIECE: usize = 1 << 14;

/// Partial sums of one piece, so that additions do not wait for one another.
const LANES: usize = 8;

/// x·y; the rounding error grows with the square root of the length at most a piece, then with the number of pieces.
pub(crate) fn dot(x: &[f64], y: &[f64]) -> f64 {
    let piece = |range: std::ops::Range<usize>| {
        let (x, y) = (&x[range.clone()], &y[range]);
        let (x, y) = (x.chunks_exact(LANES), y.chunks_exact(LANES));
        let rest: f64 = x.remainder().iter().zip(y.remainder()).map(|(x, y)| x * y).sum();
        let mut lanes = [0.0; LANES];
        for (x, y) in x.zip(y) {
            (0..LANES).for_each(|lane| lanes[lane] += x[lane] * y[lane]);
        }
        lanes.iter().sum::<f64>() + rest
    };
    map_pieces(0..x.len(), PIECE, piece).into_iter().sum()
}

/// ‖x‖.
pub(crate) fn norm(x: &[f64]) -> f64 {
    dot(x, x).sqrt()
}

/// Each element of `out` from its index and itself.
pub(crate) fn update(out: &mut [f64], new: impl Fn(usize, f64) -> f64 + Sync + Send) {
    fill_pieces(out, PIECE, |first, piece| {
        piece.iter_mut().enumerate().for_each(|(k, value)| *value = new(first + k, *value));
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_product_of_integers_is_exact() {
        let n = 3 * PIECE + 5;
        let x: Vec<f64> = (0..n).map(|i| (i % 10) as f64).collect();
        let expected: usize = (0..n).map(|i| (i % 10) * (i % 10)).sum();
        assert_eq!(dot(&x, &x), expected as f64);
        assert_eq!(norm(&[3.0, 4.0]), 5.0);
    }
}
