//! Kernels for the widest vector instructions of the processor at hand.
//!
//! Every number comes of the same operations in the same order whichever those are, products and sums rounded one by one: no
//! bit differs from one processor to the next.

use pulp::Arch;

/// What `kernel` returns, which is compiled for each kind of processor: itself and all that is inlined into it, so that it
/// has to be `#[inline(always)]`.
#[inline(always)]
pub(crate) fn widest<T>(kernel: impl FnOnce() -> T) -> T {
    Arch::new().dispatch(kernel)
}
