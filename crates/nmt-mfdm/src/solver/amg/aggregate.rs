//! Aggregates: small neighbourhoods in the graph of strong connections, each one unknown of the next level.

use crate::solver::csr::Csr;

/// No aggregate.
pub(crate) const NONE: u32 = u32::MAX;

/// The aggregate of every unknown.
pub(crate) struct Aggregates {
    /// Shape (n,); [`NONE`] where an unknown has no strong connection: smoothing alone settles it.
    pub of: Vec<u32>,
    /// Number of aggregates.
    pub n: usize,
}

/// Aggregates in the order of the unknowns (Vaněk, Mandel, Brezina 1996): whole free neighbourhoods first, then every
/// unknown left joins the neighbour it hangs on most, then what is left makes aggregates of its own. O(entries).
pub(crate) fn aggregate(strong: &Csr) -> Aggregates {
    let n = strong.n_rows();
    let mut of = vec![NONE; n];
    let mut count = 0u32;
    for i in 0..n {
        let neighbours = strong.row(i).columns;
        let is_free = |k: usize| of[k] == NONE;
        if !neighbours.is_empty() && is_free(i) && neighbours.iter().all(|&k| is_free(k as usize)) {
            of[i] = count;
            neighbours.iter().for_each(|&k| of[k as usize] = count);
            count += 1;
        }
    }
    let first = of.clone();
    for i in (0..n).filter(|i| first[*i] == NONE) {
        let row = strong.row(i).entries().filter(|(k, _)| first[*k] != NONE);
        // The first of equals, so that the order of the unknowns alone decides.
        let most =
            row.fold((NONE, 0.0), |best, (k, value)| if value.abs() > best.1 { (first[k], value.abs()) } else { best });
        of[i] = most.0;
    }
    for i in 0..n {
        let neighbours = strong.row(i).columns;
        if of[i] == NONE && !neighbours.is_empty() {
            of[i] = count;
            for &k in neighbours {
                if of[k as usize] == NONE {
                    of[k as usize] = count;
                }
            }
            count += 1;
        }
    }
    Aggregates { of, n: count as usize }
}

impl Aggregates {
    /// Makes each unknown from `first` on an aggregate of its own, the last ones in the same order.
    pub fn add_single(&mut self, first: usize) {
        for of in &mut self.of[first..] {
            *of = self.n as u32;
            self.n += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::csr::tests::of_dense;

    #[test]
    fn every_connected_unknown_is_in_an_aggregate_and_a_single_one_is_not() {
        // A path of seven and one alone.
        let entry = |i: usize, j: usize| f64::from(u8::from(i.abs_diff(j) == 1 && i != 7 && j != 7));
        let rows: Vec<Vec<f64>> = (0..8).map(|i| (0..8).map(|j| entry(i, j)).collect()).collect();
        let Aggregates { of, n } = aggregate(&of_dense(&rows));
        assert_eq!((of, n), (vec![0, 0, 1, 1, 1, 2, 2, NONE], 3));
    }

    #[test]
    fn what_no_free_neighbourhood_takes_joins_the_neighbour_it_hangs_on_most() {
        // Two stars about 0 and 4; 3 hangs on a leaf of each, more on that of the second.
        let mut rows = vec![vec![0.0; 6]; 6];
        for (i, j, value) in [(0, 1, 1.0), (1, 2, 0.2), (2, 3, 0.5), (3, 4, 1.0), (4, 5, 1.0)] {
            (rows[i][j], rows[j][i]) = (value, value);
        }
        let Aggregates { of, n } = aggregate(&of_dense(&rows));
        assert_eq!((of, n), (vec![0, 0, 1, 1, 1, 1], 2));
    }
}
