//! Which unknowns hang together strongly: the graph that aggregates are made from, and the matrix that smooths them.

use crate::solver::csr::{Csr, Diagonal, Mirror};

/// The strong part of a matrix.
pub(crate) struct Strong {
    /// Strong entries beside the diagonal, by row.
    pub matrix: Csr,
    /// The diagonal with everything weak added to it: the sums of rows stay what they were.
    pub diagonal: Vec<f64>,
}

/// Entry (i, j) is strong where ½(|a_ij| + |a_ji|) ≥ `threshold`·(|a_ii·a_jj|)^½, but for those of the last `n_borders` rows and
/// columns. O(entries).
///
/// The matrices are not symmetric, and their small entries are of either sign; the graph is symmetric all the same.
pub(crate) fn strong(a: &Csr, diagonal: &Diagonal, threshold: f64, n_borders: usize) -> Strong {
    let n = a.n_rows();
    let n_inside = n - n_borders;
    let scale: Vec<f64> = diagonal.values.iter().map(|own| own.abs().sqrt()).collect();
    // Room for all: what is not written to costs no memory, and growing would leave holes as large as the solver's vectors.
    let mut strong = Strong { matrix: Csr::with_room(n, n, a.n_entries()), diagonal: Vec::with_capacity(n) };
    let mut mirror = Mirror::new(a);
    for i in 0..n {
        let mut lumped = 0.0;
        for (j, value) in a.row(i).entries() {
            let least = threshold * scale[i] * scale[j];
            // The mirror is sought where the entry alone is not enough.
            if j != i
                && i.max(j) < n_inside
                && (0.5 * value.abs() >= least || 0.5 * (value.abs() + mirror.of(i, j).abs()) >= least)
            {
                strong.matrix.push(j as u32, value);
            } else {
                lumped += value;
            }
        }
        strong.matrix.end_row();
        strong.diagonal.push(lumped);
    }
    strong
}
