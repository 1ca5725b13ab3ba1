//! Sparse matrices by rows, and their products.

use crate::parallel::{fill_pieces, large_pieces, map_owned, take_pieces};
use crate::solver::vector::{Sides, add_multiple};
use prefetch_index::prefetch_index;
use std::collections::BTreeMap;
use std::ops::Range;

/// Rows per piece of a matrix × vector product.
const ROWS: usize = 4096;

/// Rows per piece of a product of matrices, at least.
const PRODUCT_ROWS: usize = 1 << 11;

/// Entries of a row that a product of three matrices has room for at first: twice as many as those of fine levels have.
const ROOM_IN_A_ROW: usize = 64;

/// Bytes in a line of the cache.
const LINE: usize = 64;

/// A sparse matrix by rows; columns ascend in a row.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Csr {
    starts: Vec<usize>, // first entry of each row, shape (n_rows + 1,)
    columns: Vec<u32>,
    values: Vec<f64>,
    n_columns: usize,
}

/// One row.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Row<'a> {
    pub columns: &'a [u32],
    pub values: &'a [f64],
}

impl<'a> Row<'a> {
    /// (column, value) in order.
    #[inline(always)]
    pub fn entries(self) -> impl Iterator<Item = (usize, f64)> + 'a {
        self.columns.iter().zip(self.values).map(|(column, value)| (*column as usize, *value))
    }

    /// Row · x.
    #[inline]
    pub fn dot<const K: usize>(self, x: &[Sides<K>]) -> Sides<K> {
        self.dot_by(|column| x[column])
    }

    /// Row · x, element by element of x.
    #[inline(always)]
    pub fn dot_by<const K: usize>(self, x: impl Fn(usize) -> Sides<K>) -> Sides<K> {
        let mut sum = [0.0; K];
        self.entries().for_each(|(column, value)| add_multiple(&mut sum, value, x(column)));
        sum
    }

    /// Entries before column `i`; counted in a row of some tens of entries sooner than sought.
    #[inline]
    fn n_before(self, i: usize) -> usize {
        self.columns.iter().filter(|column| (**column as usize) < i).count()
    }

    /// The row about column `i`, before which it has so many entries.
    #[inline(always)]
    pub fn parted(self, i: usize, before: u32) -> Parted<'a> {
        let (below, from) = self.columns.split_at(before as usize);
        let (values, rest) = self.values.split_at(before as usize);
        let below = Row { columns: below, values };
        match (from, rest) {
            ([column, columns @ ..], [own, values @ ..]) if *column as usize == i => {
                Parted { below, own: *own, above: Row { columns, values } }
            }
            _ => Parted { below, own: 0.0, above: Row { columns: from, values: rest } },
        }
    }

    /// The first and the last column; `None` for an empty row.
    #[inline(always)]
    pub fn reach(self) -> Option<[usize; 2]> {
        Some([*self.columns.first()? as usize, *self.columns.last()? as usize])
    }
}

/// The diagonal of a matrix, found once.
#[derive(Clone, Debug)]
pub(crate) struct Diagonal {
    /// Entries of each row before a_ii, shape (n,).
    pub before: Vec<u32>,
    /// a_ii, or 0, shape (n,).
    pub values: Vec<f64>,
}

impl Diagonal {
    pub fn new(a: &Csr) -> Self {
        let own = |i: usize| {
            let (row, before) = (a.row(i), a.row(i).n_before(i) as u32);
            (before, row.parted(i, before).own)
        };
        let (before, values) = (0..a.n_rows()).map(own).unzip();
        Self { before, values }
    }
}

/// A row before its diagonal, on it and after it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Parted<'a> {
    pub below: Row<'a>,
    pub own: f64,
    pub above: Row<'a>,
}

/// Finds a_ji beside a_ij while rows are read in ascending order: one pass over the matrix for all.
pub(crate) struct Mirror<'a> {
    matrix: &'a Csr,
    next: Vec<usize>, // entry of each row that is the first not yet passed
}

impl<'a> Mirror<'a> {
    pub fn new(matrix: &'a Csr) -> Self {
        Self { matrix, next: matrix.starts[..matrix.n_rows()].to_vec() }
    }

    /// a_ji, or 0; `i` must not descend from one call to the next.
    #[inline]
    pub fn of(&mut self, i: usize, j: usize) -> f64 {
        let Csr { starts, columns, values, .. } = self.matrix;
        let (next, end) = (&mut self.next[j], starts[j + 1]);
        while *next < end && (columns[*next] as usize) < i {
            *next += 1;
        }
        if *next < end && columns[*next] as usize == i { values[*next] } else { 0.0 }
    }
}

impl Csr {
    /// No row yet.
    pub fn new(n_columns: usize) -> Self {
        Self { starts: vec![0], columns: Vec::new(), values: Vec::new(), n_columns }
    }

    /// No row yet, and room for so many entries.
    pub fn with_room(n_columns: usize, n_rows: usize, n_entries: usize) -> Self {
        let mut starts = Vec::with_capacity(n_rows + 1);
        starts.push(0);
        let (columns, values) = (Vec::with_capacity(n_entries), Vec::with_capacity(n_entries));
        Self { starts, columns, values, n_columns }
    }

    /// The matrix after `n` empty rows and as many columns.
    pub fn after(mut self, n: usize) -> Self {
        self.starts.splice(0..0, std::iter::repeat_n(0, n));
        self.columns.iter_mut().for_each(|column| *column += n as u32);
        Self { n_columns: self.n_columns + n, ..self }
    }

    /// Appends an entry to the row begun.
    #[inline]
    pub fn push(&mut self, column: u32, value: f64) {
        self.columns.push(column);
        self.values.push(value);
    }

    /// Appends `n` entries to the row begun: their columns and values, to be filled in.
    #[inline]
    pub fn room(&mut self, n: usize) -> (&mut [u32], &mut [f64]) {
        let first = self.columns.len();
        self.columns.resize(first + n, 0);
        self.values.resize(first + n, 0.0);
        (&mut self.columns[first..], &mut self.values[first..])
    }

    /// Has a row brought into the cache, before it is asked for.
    #[inline(always)]
    pub fn fetch(&self, i: usize) {
        if let Some(&[from, end]) = self.starts.get(i..i.wrapping_add(2)).and_then(<[usize]>::first_chunk) {
            (from..end).step_by(LINE / 4).for_each(|entry| prefetch_index(&self.columns, entry));
            (from..end).step_by(LINE / 8).for_each(|entry| prefetch_index(&self.values, entry));
        }
    }

    /// Ends a row.
    #[inline]
    pub fn end_row(&mut self) {
        self.starts.push(self.columns.len());
    }

    /// Makes it empty, with the room it has.
    pub fn clear(&mut self) {
        self.starts.truncate(1);
        self.columns.clear();
        self.values.clear();
    }

    /// Pieces under one another, in order.
    pub fn stacked(n_columns: usize, pieces: &[Self]) -> Self {
        let n_rows: usize = pieces.iter().map(Self::n_rows).sum();
        let n_entries = pieces.iter().map(Self::n_entries).sum();
        let mut stacked = Self::with_room(n_columns, n_rows, n_entries);
        pieces.iter().for_each(|piece| stacked.append(piece));
        stacked
    }

    /// Puts another matrix of as many columns under this one.
    pub fn append(&mut self, other: &Self) {
        let first = self.columns.len();
        self.starts.extend(other.starts[1..].iter().map(|start| first + start));
        self.columns.extend_from_slice(&other.columns);
        self.values.extend_from_slice(&other.values);
    }

    pub fn n_rows(&self) -> usize {
        self.starts.len() - 1
    }

    pub fn n_columns(&self) -> usize {
        self.n_columns
    }

    pub fn n_entries(&self) -> usize {
        self.columns.len()
    }

    /// First entry of each row, shape (n_rows + 1,).
    pub fn starts(&self) -> &[usize] {
        &self.starts
    }

    /// Column of each entry.
    pub fn columns(&self) -> &[u32] {
        &self.columns
    }

    /// Value of each entry.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    #[inline]
    pub fn row(&self, i: usize) -> Row<'_> {
        let entries = self.starts[i]..self.starts[i + 1];
        Row { columns: &self.columns[entries.clone()], values: &self.values[entries] }
    }

    /// A·x.
    pub fn apply(&self, x: &[f64]) -> Vec<f64> {
        let mut y = vec![0.0; self.n_rows()];
        self.apply_to(x.as_chunks::<1>().0, y.as_chunks_mut::<1>().0);
        y
    }

    /// y = A·x.
    pub fn apply_to<const K: usize>(&self, x: &[Sides<K>], y: &mut [Sides<K>]) {
        fill_pieces(y, ROWS, |first, y| y.iter_mut().enumerate().for_each(|(k, y)| *y = self.row(first + k).dot(x)));
    }

    /// Aᵀ.
    pub fn transpose(&self) -> Self {
        let mut starts = vec![0usize; self.n_columns + 1];
        self.columns.iter().for_each(|&column| starts[column as usize + 1] += 1);
        (0..self.n_columns).for_each(|column| starts[column + 1] += starts[column]);
        let mut next = starts.clone();
        let (mut columns, mut values) = (vec![0u32; self.n_entries()], vec![0.0; self.n_entries()]);
        // Rows are taken in order, so that the columns of the transpose ascend.
        for i in 0..self.n_rows() {
            for (column, value) in self.row(i).entries() {
                let slot = &mut next[column];
                (columns[*slot], values[*slot]) = (i as u32, value);
                *slot += 1;
            }
        }
        Self { starts, columns, values, n_columns: self.n_rows() }
    }

    /// |a_ij − a_ji| ≤ `tolerance`·(|a_ii| + |a_jj|) everywhere, an entry that is not there being 0. O(entries).
    pub fn is_symmetric(&self, diagonal: &Diagonal, tolerance: f64) -> bool {
        let size = |i: usize| diagonal.values[i].abs();
        let mut mirror = Mirror::new(self);
        (0..self.n_rows()).all(|i| {
            self.row(i).entries().all(|(j, value)| (value - mirror.of(i, j)).abs() <= tolerance * (size(i) + size(j)))
        })
    }

    /// a_ij, or 0.
    pub fn entry(&self, i: usize, j: u32) -> f64 {
        let row = self.row(i);
        row.columns.binary_search(&j).map_or(0.0, |k| row.values[k])
    }

    /// a_ii, or 0.
    pub fn diagonal(&self, i: usize) -> f64 {
        let row = self.row(i);
        row.parted(i, row.n_before(i) as u32).own
    }

    /// Multiplies every column by its factor.
    pub fn scale_columns(&mut self, factors: &[f64]) {
        self.columns.iter().zip(&mut self.values).for_each(|(column, value)| *value *= factors[*column as usize]);
    }

    /// Puts `rows` in the place of those that have their numbers, which ascend; within the matrix, since two of it would be
    /// the most that a solution holds at a time.
    pub fn replace_rows(&mut self, numbers: &[usize], rows: &[&[(u32, f64)]]) {
        let n_entries = self.n_entries();
        let mut runs = Vec::with_capacity(numbers.len() + 1); // of entries that stay
        let mut places = Vec::with_capacity(numbers.len() + 1); // where they go
        let (mut first, mut place) = (0, 0);
        for (&number, row) in numbers.iter().zip(rows) {
            runs.push(self.starts[first]..self.starts[number]);
            places.push(place);
            place += self.starts[number] - self.starts[first] + row.len();
            first = number + 1;
        }
        runs.push(self.starts[first]..n_entries);
        places.push(place);
        let end = place + n_entries - self.starts[first];
        self.columns.resize(end.max(n_entries), 0);
        self.values.resize(end.max(n_entries), 0.0);
        // Runs keep their order, so that what moves to the front, the first of them first, only covers what has moved, and
        // what moves to the back, the last first, too.
        let moves = || runs.iter().cloned().zip(places.iter().copied());
        moves().filter(|(run, place)| *place < run.start).for_each(|(run, place)| self.move_entries(run, place));
        moves().rev().filter(|(run, place)| *place > run.start).for_each(|(run, place)| self.move_entries(run, place));
        for ((run, place), row) in moves().zip(rows) {
            for (slot, &(column, value)) in (place + run.len()..).zip(*row) {
                (self.columns[slot], self.values[slot]) = (column, value);
            }
        }
        self.columns.truncate(end);
        self.values.truncate(end);
        let mut anew = numbers.iter().zip(rows).peekable();
        let mut old_start = 0;
        for i in 0..self.n_rows() {
            let old_length = self.starts[i + 1] - old_start;
            old_start = self.starts[i + 1];
            let length = anew.next_if(|(number, _)| **number == i).map_or(old_length, |(_, row)| row.len());
            self.starts[i + 1] = self.starts[i] + length;
        }
    }

    /// Borders it by columns, given by their entries (row, value) by ascending row, and by as many rows of the bordered matrix.
    pub fn border(&mut self, columns: &[Vec<(u32, f64)>], rows: &[Vec<(u32, f64)>]) {
        let mut beside: BTreeMap<usize, Vec<(u32, f64)>> = BTreeMap::new(); // rows that the columns enter
        for (k, column) in (self.n_columns as u32..).zip(columns) {
            for &(row, value) in column {
                let entries = || self.row(row as usize).entries().map(|(j, value)| (j as u32, value)).collect();
                beside.entry(row as usize).or_insert_with(entries).push((k, value));
            }
        }
        let numbers: Vec<usize> = beside.keys().copied().collect();
        let longer: Vec<&[(u32, f64)]> = beside.values().map(Vec::as_slice).collect();
        self.replace_rows(&numbers, &longer);
        self.n_columns += columns.len();
        for row in rows {
            row.iter().for_each(|&(column, value)| self.push(column, value));
            self.end_row();
        }
    }

    /// Leaves the first `n` rows and columns.
    pub fn unborder(&mut self, n: usize) {
        self.starts.truncate(n + 1);
        let (mut from, mut to) = (0, 0);
        for i in 0..n {
            let end = self.starts[i + 1];
            let inside = self.columns[from..end].partition_point(|column| (*column as usize) < n);
            if from != to {
                self.move_entries(from..from + inside, to);
            }
            (from, to) = (end, to + inside);
            self.starts[i + 1] = to;
        }
        self.columns.truncate(to);
        self.values.truncate(to);
        self.n_columns = n;
    }

    fn move_entries(&mut self, from: Range<usize>, to: usize) {
        self.columns.copy_within(from.clone(), to);
        self.values.copy_within(from, to);
    }

    /// R·A·P, this matrix being A.
    ///
    /// The rows of A·P are made where a row of R first asks for them, and dropped with the piece of the result: all of them would
    /// be as large as A. Rows of R that are near each other ask for the same ones.
    pub fn between(&self, restrictor: &Self, prolongator: &Self) -> Self {
        let n = prolongator.n_columns;
        let piece = |rows: Range<usize>| {
            let mut piece = Self::new(n);
            let columns = || restrictor.columns[restrictor.starts[rows.start]..restrictor.starts[rows.end]].iter();
            let first = columns().min().map_or(0, |column| *column as usize);
            let end = columns().max().map_or(0, |column| *column as usize + 1);
            let mut numbers = vec![NONE; end - first]; // of the row of A·P for each of A
            let mut products = Self::new(n);
            let (mut inner, mut outer) = (RowUnderWay::new(n), RowUnderWay::new(n));
            for i in rows.clone() {
                for (k, r) in restrictor.row(i).entries() {
                    let number = &mut numbers[k - first];
                    if *number == NONE {
                        *number = products.n_rows() as u32;
                        self.row(k).entries().for_each(|(l, a)| inner.add(a, prolongator.row(l)));
                        inner.end(&mut products);
                    }
                    outer.add(r, products.row(*number as usize));
                }
                outer.end_sorted(&mut piece);
            }
            piece
        };
        let n_rows = restrictor.n_rows();
        // Room for more than it will have, so that nothing is moved; what is not written to costs no memory.
        let mut all = Self::with_room(n, n_rows, self.n_entries().min(ROOM_IN_A_ROW * n_rows));
        take_pieces(0..n_rows, large_pieces(n_rows).max(PRODUCT_ROWS), piece, |piece| all.append(&piece));
        all.columns.shrink_to_fit();
        all.values.shrink_to_fit();
        all
    }
}

/// A matrix that grows by many rows at a time, copied on all cores.
///
/// What it will hold is estimated from the first rows. Room that is not written to yet costs no memory where the system gives
/// out pages when they are first used, which then happens on all cores too.
pub(crate) struct CsrMaker {
    starts: Vec<usize>,
    columns: Vec<u32>, // zeros from the last start on
    values: Vec<f64>,  // as long
    n_rows: usize,
    n_columns: usize,
}

/// Room beyond what the first rows let expect, as a part of it.
const SPARE: f64 = 0.25;

impl CsrMaker {
    /// No row yet, of all that there will be.
    pub fn new(n_rows: usize, n_columns: usize) -> Self {
        let mut starts = Vec::with_capacity(n_rows + 1);
        starts.push(0);
        Self { starts, columns: Vec::new(), values: Vec::new(), n_rows, n_columns }
    }

    /// Puts matrices of as many columns under the rows so far, in order.
    pub fn append(&mut self, pieces: Vec<&Csr>) {
        for piece in &pieces {
            let first = self.n_entries();
            self.starts.extend(piece.starts[1..].iter().map(|start| first + start));
        }
        let n_new: usize = pieces.iter().map(|piece| piece.n_entries()).sum();
        let (end, first) = (self.n_entries(), self.n_entries() - n_new);
        if end > self.columns.len() {
            self.make_room(first, end);
        }
        let (mut columns, mut values) = (&mut self.columns[first..end], &mut self.values[first..end]);
        let mut copies = Vec::with_capacity(pieces.len());
        for piece in pieces {
            let (own_columns, other_columns) = columns.split_at_mut(piece.n_entries());
            let (own_values, other_values) = values.split_at_mut(piece.n_entries());
            copies.push((own_columns, own_values, piece));
            (columns, values) = (other_columns, other_values);
        }
        map_owned(copies, |(columns, values, piece)| {
            columns.copy_from_slice(&piece.columns);
            values.copy_from_slice(&piece.values);
        });
    }

    fn n_entries(&self) -> usize {
        self.starts[self.starts.len() - 1]
    }

    /// Room for all entries, by those `end` of the rows so far, the first `n_kept` of which are kept.
    fn make_room(&mut self, n_kept: usize, end: usize) {
        let a_row = end as f64 / (self.starts.len() - 1) as f64;
        let n = end.max((self.n_rows as f64 * a_row * (1.0 + SPARE)) as usize);
        let (mut columns, mut values) = (vec![0; n], vec![0.0; n]);
        columns[..n_kept].copy_from_slice(&self.columns[..n_kept]);
        values[..n_kept].copy_from_slice(&self.values[..n_kept]);
        (self.columns, self.values) = (columns, values);
    }

    /// The matrix of the rows so far.
    pub fn matrix(mut self) -> Csr {
        let n = self.n_entries();
        self.columns.truncate(n);
        self.values.truncate(n);
        Csr { starts: self.starts, columns: self.columns, values: self.values, n_columns: self.n_columns }
    }
}

/// No number.
const NONE: u32 = u32::MAX;

/// A row that is summed up.
struct RowUnderWay {
    slots: Vec<u32>,   // of each column
    columns: Vec<u32>, // of the first `n` slots
    sums: Vec<f64>,    // as long; 0 from slot `n` on
    n: usize,
    sorted: Vec<(u32, f64)>, // room
}

impl RowUnderWay {
    fn new(n_columns: usize) -> Self {
        let slots = vec![NONE; n_columns];
        Self { slots, columns: Vec::new(), sums: Vec::new(), n: 0, sorted: Vec::new() }
    }

    /// Adds a multiple of a row.
    #[inline]
    fn add(&mut self, factor: f64, row: Row) {
        let most = self.n + row.columns.len();
        if self.sums.len() < most {
            self.columns.resize(2 * most, 0);
            self.sums.resize(2 * most, 0.0);
        }
        // Without a branch for columns that are new: one in ten is, and none can tell which.
        for (column, value) in row.entries() {
            let slot = &mut self.slots[column];
            let is_new = *slot == NONE;
            *slot = if is_new { self.n as u32 } else { *slot };
            let own = *slot as usize;
            self.columns[own] = column as u32;
            self.sums[own] += factor * value;
            self.n += usize::from(is_new);
        }
    }

    /// Appends it to a matrix; begins the next.
    fn end(&mut self, to: &mut Csr) {
        for (column, sum) in self.columns.iter().zip(&mut self.sums).take(self.n) {
            self.slots[*column as usize] = NONE;
            to.push(*column, std::mem::take(sum));
        }
        to.end_row();
        self.n = 0;
    }

    /// [`Self::end`], its columns ascending.
    fn end_sorted(&mut self, to: &mut Csr) {
        let entries = self.columns.iter().zip(&self.sums).take(self.n);
        self.sorted.clear();
        self.sorted.extend(entries.map(|(column, sum)| (*column, *sum)));
        self.sorted.sort_unstable_by_key(|(column, _)| *column);
        self.sorted.iter().enumerate().for_each(|(k, entry)| (self.columns[k], self.sums[k]) = *entry);
        self.end(to);
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// By dense rows; zeros are left out.
    pub(crate) fn of_dense(rows: &[Vec<f64>]) -> Csr {
        let mut matrix = Csr::new(rows.first().map_or(0, Vec::len));
        for row in rows {
            let entries = row.iter().enumerate().filter(|(_, value)| **value != 0.0);
            entries.for_each(|(column, value)| matrix.push(column as u32, *value));
            matrix.end_row();
        }
        matrix
    }

    /// Deterministic, about a third of the entries 0.
    fn scattered(n_rows: usize, n_columns: usize) -> Vec<Vec<f64>> {
        let entry = |i: usize, j: usize| ((i * 31 + j * 17 + i * j) % 13).saturating_sub(4) as f64;
        (0..n_rows).map(|i| (0..n_columns).map(|j| entry(i, j)).collect()).collect()
    }

    #[test]
    fn products_and_transposes_are_those_of_dense_matrices() {
        let (r, a, p) = (scattered(6, 7), scattered(7, 11), scattered(11, 5));
        let along = |i: usize, k: usize, j: usize| (0..11).map(|l| r[i][k] * a[k][l] * p[l][j]).sum::<f64>();
        let entry = |i: usize, j: usize| (0..7).map(|k| along(i, k, j)).sum::<f64>();
        let dense: Vec<Vec<f64>> = (0..6).map(|i| (0..5).map(|j| entry(i, j)).collect()).collect();
        assert_eq!(of_dense(&a).between(&of_dense(&r), &of_dense(&p)), of_dense(&dense)); // integers: no rounding
        let transposed: Vec<Vec<f64>> = (0..11).map(|j| (0..7).map(|i| a[i][j]).collect()).collect();
        assert_eq!(of_dense(&a).transpose(), of_dense(&transposed));
        let x: Vec<f64> = (0..11).map(f64::from).collect();
        let expected: Vec<f64> = a.iter().map(|row| row.iter().zip(&x).map(|(a, x)| a * x).sum()).collect();
        assert_eq!(of_dense(&a).apply(&x), expected);
    }

    #[test]
    fn longer_and_shorter_rows_take_the_places_of_others() {
        let mut dense = scattered(9, 6);
        let mut matrix = of_dense(&dense);
        dense[0] = vec![1.0; 6];
        dense[3] = vec![0.0; 6];
        dense[4] = vec![0.0, 2.0, 0.0, 0.0, 0.0, 7.0];
        dense[8] = vec![3.0; 6];
        let numbers = [0, 3, 4, 8];
        let row = |i: &usize| (0u32..).zip(dense[*i].iter().copied()).filter(|(_, v)| *v != 0.0).collect::<Vec<_>>();
        let rows: Vec<Vec<(u32, f64)>> = numbers.iter().map(row).collect();
        matrix.replace_rows(&numbers, &rows.iter().map(Vec::as_slice).collect::<Vec<_>>());
        assert_eq!(matrix, of_dense(&dense));
        let before = matrix.clone();
        matrix.replace_rows(&[], &[]);
        assert_eq!(matrix, before);
    }

    #[test]
    fn symmetry_is_seen_also_where_an_entry_has_no_mirror() {
        let is_symmetric = |rows: &[Vec<f64>]| {
            let a = of_dense(rows);
            a.is_symmetric(&Diagonal::new(&a), 1e-12)
        };
        let symmetric = [vec![2.0, -1.0, 0.0], vec![-1.0, 2.0, -1.0], vec![0.0, -1.0, 2.0]];
        assert!(is_symmetric(&symmetric));
        for (i, j) in [(0, 2), (2, 0), (1, 2)] {
            let mut other = symmetric.to_vec();
            other[i][j] += 1e-6;
            assert!(!is_symmetric(&other));
        }
    }
}
