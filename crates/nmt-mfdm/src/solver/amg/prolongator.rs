//! From one level to the next: constants on aggregates, smoothed by one step of Jacobi with the strong part.

use super::aggregate::{Aggregates, NONE};
use super::strength::Strong;
use crate::parallel::map_pieces;
use crate::solver::csr::Csr;

/// Rows per piece.
const ROWS: usize = 1 << 15;

/// Damping of the Jacobi step: 4/3 over the largest eigenvalue of D⁻¹A, which is 2 where the diagonal dominates (Gershgorin).
const OMEGA: f64 = 2.0 / 3.0;

/// P = (I − ω D⁻¹A)·T of the strong part A with its diagonal D; T has a 1 for the aggregate of each unknown.
///
/// An equation of weak diagonal says little of its unknown: that is interpolated between its neighbours instead.
pub(crate) fn prolongator(strong: &Strong, aggregates: &Aggregates, is_weak: &[bool]) -> Csr {
    let pieces = map_pieces(0..strong.matrix.n_rows(), ROWS, |rows| {
        let mut piece = Csr::new(aggregates.n);
        let mut row: Vec<(u32, f64)> = Vec::new();
        for i in rows {
            smoothed_row(strong, aggregates, i, is_weak[i], &mut row);
            row.drain(..).for_each(|(aggregate, value)| piece.push(aggregate, value));
            piece.end_row();
        }
        piece
    });
    Csr::stacked(aggregates.n, &pieces)
}

/// Row `i`, columns ascending; empty where the unknown is in no aggregate.
fn smoothed_row(strong: &Strong, aggregates: &Aggregates, i: usize, is_weak: bool, row: &mut Vec<(u32, f64)>) {
    let own = aggregates.of[i];
    if own == NONE {
        return;
    }
    let entries = strong.matrix.row(i);
    if entries.columns.is_empty() {
        // An aggregate by itself: the sum of all that is weak, its own coefficient included, may be 0.
        return row.push((own, 1.0));
    }
    let sum: f64 = entries.values.iter().map(|v| v.abs()).sum();
    let diagonal = if is_weak { sum } else { strong.diagonal[i] };
    // A diagonal that its strong neighbours dwarf would throw the step far off.
    let step = OMEGA / diagonal.max(0.5 * sum);
    row.push((own, 1.0 - step * diagonal));
    for (k, value) in entries.entries().filter(|(k, _)| aggregates.of[*k] != NONE) {
        let (aggregate, value) = (aggregates.of[k], -step * if is_weak { -value.abs() } else { value });
        match row.iter_mut().find(|(other, _)| *other == aggregate) {
            Some((_, sum)) => *sum += value,
            None => row.push((aggregate, value)),
        }
    }
    row.sort_unstable_by_key(|(aggregate, _)| *aggregate);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::amg::aggregate::aggregate;
    use crate::solver::amg::strength::strong;
    use crate::solver::csr::Diagonal;
    use crate::solver::csr::tests::of_dense;

    #[test]
    fn constants_come_back_where_rows_sum_to_zero() {
        // A ring, with a weak long connection that is lumped.
        let n = 12;
        let entry = |i: usize, j: usize| match (i + n - j) % n {
            0 => 2.02,
            1 | 11 => -1.0,
            6 => -0.02,
            _ => 0.0,
        };
        let rows: Vec<Vec<f64>> = (0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect();
        let a = of_dense(&rows);
        let strong = strong(&a, &Diagonal::new(&a), 0.08, 0);
        assert!((0..n).all(|i| strong.matrix.row(i).columns.len() == 2));
        let aggregates = aggregate(&strong.matrix);
        let mut is_weak = vec![false; n];
        is_weak[4] = true;
        let ones = prolongator(&strong, &aggregates, &is_weak).apply(&vec![1.0; aggregates.n]);
        assert!(ones.iter().all(|one| (one - 1.0).abs() < 1e-14), "{ones:?}"); // rounding
    }
}
