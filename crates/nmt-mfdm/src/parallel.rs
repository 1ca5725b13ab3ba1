//! One function over an index range, on all cores where the feature `parallel` is on; results in index order.
//!
//! Pieces have a size of their own, whatever the number of threads, and sums are taken over them in order: the same bits
//! on one core and on sixty-four.

use std::ops::Range;
use std::sync::{Mutex, PoisonError};

/// Points per piece of work: enough to hide the cost of handing it out.
pub(crate) const CHUNK: usize = 512;

/// `work` on consecutive pieces of `range`, results in order whatever the number of threads.
pub(crate) fn map_chunks<T: Send>(range: Range<usize>, work: impl Fn(Range<usize>) -> T + Sync + Send) -> Vec<T> {
    map_pieces(range, CHUNK, work)
}

/// [`map_chunks`] on pieces of `size`.
pub(crate) fn map_pieces<T: Send>(
    range: Range<usize>,
    size: usize,
    work: impl Fn(Range<usize>) -> T + Sync + Send,
) -> Vec<T> {
    let pieces = range.len().div_ceil(size);
    let piece = |k: usize| range.start + k * size..(range.start + (k + 1) * size).min(range.end);
    #[cfg(feature = "parallel")]
    if pieces > 1 {
        use rayon::prelude::*;
        return (0..pieces).into_par_iter().map(|k| work(piece(k))).collect();
    }
    (0..pieces).map(|k| work(piece(k))).collect()
}

/// Pieces that are held at a time by [`take_pieces`].
const BATCH: usize = 16;

/// [`map_pieces`] whose results are taken in order, a few at a time: for results as large as memory allows.
pub(crate) fn take_pieces<T: Send>(
    range: Range<usize>,
    size: usize,
    work: impl Fn(Range<usize>) -> T + Sync + Send,
    mut take: impl FnMut(T),
) {
    for first in range.clone().step_by(BATCH * size) {
        let batch = first..(first + BATCH * size).min(range.end);
        map_pieces(batch, size, &work).into_iter().for_each(&mut take);
    }
}

/// What pieces of work need and leave as they found it, such as large rooms: as many as are at work at once.
#[derive(Debug)]
pub(crate) struct Pool<W> {
    idle: Mutex<Vec<W>>,
}

impl<W> Default for Pool<W> {
    fn default() -> Self {
        Self { idle: Mutex::default() }
    }
}

impl<W> Pool<W> {
    /// `work` with one of them, which must not change the result, or with one that is made.
    pub fn with<T>(&self, make: impl FnOnce() -> W, work: impl FnOnce(&mut W) -> T) -> T {
        let idle = || self.idle.lock().unwrap_or_else(PoisonError::into_inner);
        let found = idle().pop();
        let mut worker = found.unwrap_or_else(make);
        let result = work(&mut worker);
        idle().push(worker);
        result
    }
}

/// `work` on each of `pieces`, results in their order.
pub(crate) fn map_owned<P: Send, T: Send>(pieces: Vec<P>, work: impl Fn(P) -> T + Sync + Send) -> Vec<T> {
    #[cfg(feature = "parallel")]
    if pieces.len() > 1 {
        use rayon::prelude::*;
        return pieces.into_par_iter().map(work).collect();
    }
    pieces.into_iter().map(work).collect()
}

/// A size of pieces for work whose every piece costs as much as the whole range has elements: the sum stays O(n).
pub(crate) fn large_pieces(n: usize) -> usize {
    CHUNK.max(n.div_ceil(8 * BATCH))
}

/// `work` on consecutive pieces of `out`, of `size`, each with the index of its first element.
pub(crate) fn fill_pieces<T: Send>(out: &mut [T], size: usize, work: impl Fn(usize, &mut [T]) + Sync + Send) {
    #[cfg(feature = "parallel")]
    if out.len() > size {
        use rayon::prelude::*;
        return out.par_chunks_mut(size).enumerate().for_each(|(k, piece)| work(k * size, piece));
    }
    out.chunks_mut(size).enumerate().for_each(|(k, piece)| work(k * size, piece));
}

/// [`fill_pieces`] of two arrays of one length at once.
pub(crate) fn fill_pairs<A: Send, B: Send>(
    (one, other): (&mut [A], &mut [B]),
    size: usize,
    work: impl Fn(usize, &mut [A], &mut [B]) + Sync + Send,
) {
    #[cfg(feature = "parallel")]
    if one.len() > size {
        use rayon::prelude::*;
        let pieces = one.par_chunks_mut(size).zip(other.par_chunks_mut(size)).enumerate();
        return pieces.for_each(|(k, (one, other))| work(k * size, one, other));
    }
    let pieces = one.chunks_mut(size).zip(other.chunks_mut(size)).enumerate();
    pieces.for_each(|(k, (one, other))| work(k * size, one, other));
}
