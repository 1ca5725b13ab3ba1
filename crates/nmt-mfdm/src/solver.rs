//! Linear solvers; every solution is checked by its true residual.

pub(crate) mod direct;
mod ordering;
