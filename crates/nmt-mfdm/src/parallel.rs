//! One function over an index range, on all cores where the feature `parallel` is on; results in index order.

use std::ops::Range;

/// Points per piece of work: enough to hide the cost of handing it out.
const CHUNK: usize = 512;

/// `work` on consecutive pieces of `range`, results in order whatever the number of threads.
pub(crate) fn map_chunks<T: Send>(range: Range<usize>, work: impl Fn(Range<usize>) -> T + Sync + Send) -> Vec<T> {
    let pieces = range.len().div_ceil(CHUNK);
    let piece = |k: usize| range.start + k * CHUNK..(range.start + (k + 1) * CHUNK).min(range.end);
    #[cfg(feature = "parallel")]
    {
        use rayon::prelude::*;
        (0..pieces).into_par_iter().map(|k| work(piece(k))).collect()
    }
    #[cfg(not(feature = "parallel"))]
    {
        (0..pieces).map(|k| work(piece(k))).collect()
    }
}
