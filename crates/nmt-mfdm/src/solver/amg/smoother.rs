//! Gauss–Seidel in blocks of fixed size: within a block every new value counts at once, between blocks the old ones do.
//!
//! Blocks do not depend on the number of threads, so neither does the result. Where the diagonal is weak or of wrong sign a
//! sweep would blow the error up, and one such place spoils the whole iteration: there a patch of unknowns about it is
//! solved for together. On a square of 10⁵ irregular nodes BiCGSTAB takes 13 iterations with patches; without, it fails.
//! One such place within another's patch needs none of its own, unless it lies in the last ring.

use crate::parallel::fill_pieces;
use crate::solver::csr::Csr;
use crate::solver::direct::dense_inverse;

/// Unknowns in a block: on a cloud of 10⁶ a strip of sixteen rows of nodes, whose edges matter little.
const BLOCK: usize = 1 << 14;

/// A diagonal below this part of the sum Σ|a_ij| of its row is weak.
///
/// Sound rows have 0.35 to 0.5. Of the 9-node stars of irregular clouds a hundredth have less than 0.27, a thousandth a
/// diagonal of wrong sign.
const WEAK_DIAGONAL: f64 = 0.3;

/// Rings of strong neighbours in a patch, at least and at most.
const RINGS: [usize; 2] = [2, 4];

/// A patch takes no further ring when the largest entry of its inverse, times its mean diagonal, is below this.
///
/// Where it is well determined that is 1 to 5; two adjacent equations of wrong sign come to hundreds with two rings.
const SOUND_GROWTH: f64 = 8.0;

/// Unknowns in a patch at most: a ring more in any graph of a plane mesh.
const MAX_PATCH: usize = 80;

/// The smoother of one level.
#[derive(Clone, Debug)]
pub(crate) struct Smoother {
    inverse_diagonal: Vec<f64>,
    patches: Vec<Patch>,
}

/// The unknowns about one of weak diagonal.
#[derive(Clone, Debug)]
struct Patch {
    unknowns: Vec<u32>, // ring after ring
    n_within: usize,    // before the last ring
    inverse: Vec<f64>,  // shape (n, n)
}

/// Σ_j |a_ij|.
fn row_sum(a: &Csr, i: usize) -> f64 {
    a.row(i).values.iter().map(|v| v.abs()).sum()
}

/// True at each unknown of weak diagonal.
pub(crate) fn weak(a: &Csr) -> Vec<bool> {
    (0..a.n_rows()).map(|i| a.diagonal(i) < WEAK_DIAGONAL * row_sum(a, i)).collect()
}

impl Smoother {
    pub fn new(a: &Csr, strong: &Csr, is_weak: &[bool]) -> Self {
        let mut is_taken = vec![false; a.n_rows()];
        let mut is_within = vec![false; a.n_rows()]; // a patch, and not in its last ring
        let mut patches = Vec::new();
        for i in (0..a.n_rows()).filter(|i| is_weak[*i]) {
            if !is_within[i]
                && let Some(patch) = Patch::new(a, strong, i, &mut is_taken)
            {
                patch.unknowns[..patch.n_within].iter().for_each(|&k| is_within[k as usize] = true);
                patches.push(patch);
            }
        }
        let inverse = |i: usize| {
            let divisor = if is_weak[i] { row_sum(a, i) } else { a.diagonal(i) };
            if divisor > 0.0 { divisor.recip() } else { 0.0 }
        };
        Self { inverse_diagonal: (0..a.n_rows()).map(inverse).collect(), patches }
    }

    /// One sweep in ascending order for A·x = b from x = 0, then the patches.
    pub fn ascend_from_zero(&self, a: &Csr, b: &[f64], x: &mut [f64]) {
        fill_pieces(x, BLOCK, |first, x| {
            for k in 0..x.len() {
                let i = first + k;
                let before = a.row(i).entries().take_while(|(j, _)| *j < i).filter(|(j, _)| *j >= first);
                let sum: f64 = before.map(|(j, value)| value * x[j - first]).sum();
                x[k] = (b[i] - sum) * self.inverse_diagonal[i];
            }
        });
        let mut room = Vec::with_capacity(MAX_PATCH);
        self.patches.iter().for_each(|patch| patch.relax(a, b, x, &mut room));
    }

    /// The patches, then one sweep in descending order for A·x = b; `old` is room for x.
    pub fn descend(&self, a: &Csr, b: &[f64], x: &mut [f64], old: &mut [f64]) {
        let mut room = Vec::with_capacity(MAX_PATCH);
        self.patches.iter().rev().for_each(|patch| patch.relax(a, b, x, &mut room));
        old.copy_from_slice(x);
        let old = &*old;
        fill_pieces(x, BLOCK, |first, x| {
            for k in (0..x.len()).rev() {
                let i = first + k;
                let mut sum = b[i];
                for (j, value) in a.row(i).entries() {
                    // Wraps to a number past the block where j comes before it.
                    let inside = j.wrapping_sub(first);
                    sum -= value * if inside < x.len() { x[inside] } else { old[j] };
                }
                x[k] += sum * self.inverse_diagonal[i];
            }
        });
    }
}

impl Patch {
    /// Rings of strong neighbours about the centre, until the equations of the patch determine it well, or else those that
    /// do it best; `None` where none do. `is_taken` is false everywhere, before and after.
    fn new(a: &Csr, strong: &Csr, centre: usize, is_taken: &mut [bool]) -> Option<Self> {
        let mut unknowns = vec![centre as u32];
        is_taken[centre] = true;
        let mut last_ring = 0;
        let mut best: Option<(f64, Self)> = None;
        for ring in 1..=RINGS[1] {
            let n = unknowns.len();
            for k in last_ring..n {
                for &j in strong.row(unknowns[k] as usize).columns {
                    if unknowns.len() < MAX_PATCH && !is_taken[j as usize] {
                        is_taken[j as usize] = true;
                        unknowns.push(j);
                    }
                }
            }
            last_ring = n;
            if ring < RINGS[0] {
                continue;
            }
            let n = unknowns.len();
            let Some(inverse) = dense_inverse(n, |i, j| a.entry(unknowns[i] as usize, unknowns[j])) else { continue };
            let mean = unknowns.iter().map(|&i| a.diagonal(i as usize).abs()).sum::<f64>() / n as f64;
            let growth = mean * inverse.iter().fold(0.0, |largest: f64, v| largest.max(v.abs()));
            if best.as_ref().is_none_or(|(least, _)| growth < *least) {
                best = Some((growth, Self { unknowns: unknowns.clone(), n_within: last_ring, inverse }));
            }
            if growth < SOUND_GROWTH {
                break;
            }
        }
        unknowns.iter().for_each(|&k| is_taken[k as usize] = false);
        best.map(|(_, patch)| patch)
    }

    /// Solves the equations of the patch for its unknowns.
    fn relax(&self, a: &Csr, b: &[f64], x: &mut [f64], room: &mut Vec<f64>) {
        room.clear();
        room.extend(self.unknowns.iter().map(|&i| b[i as usize] - a.row(i as usize).dot(x)));
        for (row, &i) in self.inverse.chunks_exact(room.len()).zip(&self.unknowns) {
            x[i as usize] += row.iter().zip(&*room).map(|(c, r)| c * r).sum::<f64>();
        }
    }
}
