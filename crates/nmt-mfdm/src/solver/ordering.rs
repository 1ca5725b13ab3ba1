//! The order of elimination: nested dissection of the unknowns by their places.
//!
//! Rows of the variational form have 25 entries, and LU with pivoting fills what AᵀA would. A minimum-degree ordering of
//! such columns takes as long as the factorisation; cutting the cloud in halves takes a tenth of that and fills less.

use nmt_geom::{Bbox, Point};

/// Parts of at most this many unknowns are not cut any more.
const LEAF: usize = 48;

/// Columns by row and rows by column, as far as they matter here: the rows of each column.
pub(crate) struct ColumnRows<'a> {
    /// First entry of each column, shape (n + 1,).
    pub starts: &'a [usize],
    /// Row of each entry.
    pub rows: &'a [usize],
}

/// The columns in order of elimination.
///
/// Each part is cut in the middle across its longer side; the columns of the first half that share a row with the second
/// half come after both, so that the halves do not meet in AᵀA. `xy` are the places of the unknowns, shape (n, 2).
pub(crate) fn nested_dissection(columns: &ColumnRows, xy: &[Point]) -> Vec<usize> {
    let n = xy.len();
    let mut order: Vec<usize> = (0..n).collect();
    let mut reached = vec![0u32; n]; // by row: the number of the cut whose second half it reaches
    let mut cut = 0;
    let mut parts: Vec<std::ops::Range<usize>> = std::iter::once(0..n).collect();
    while let Some(range) = parts.pop() {
        if range.len() <= LEAF {
            continue;
        }
        let part = &mut order[range.clone()];
        let envelope = Bbox::of(part.iter().map(|&k| xy[k]));
        let axis = usize::from(envelope.height() > envelope.width());
        let middle = part.len() / 2;
        part.select_nth_unstable_by(middle, |&i, &j| xy[i][axis].total_cmp(&xy[j][axis]).then(i.cmp(&j)));
        cut += 1;
        let rows_of = |k: usize| &columns.rows[columns.starts[k]..columns.starts[k + 1]];
        part[middle..].iter().for_each(|&k| rows_of(k).iter().for_each(|&row| reached[row] = cut));
        let (first, second) = part.split_at(middle);
        let (separator, kept): (Vec<usize>, Vec<usize>) =
            first.iter().partition(|&&k| rows_of(k).iter().any(|&row| reached[row] == cut));
        let second = second.to_vec();
        let (kept_end, second_end) = (kept.len(), kept.len() + second.len());
        part[..kept_end].copy_from_slice(&kept);
        part[kept_end..second_end].copy_from_slice(&second);
        part[second_end..].copy_from_slice(&separator);
        parts.push(range.start..range.start + kept_end);
        parts.push(range.start + kept_end..range.start + second_end);
    }
    order
}
