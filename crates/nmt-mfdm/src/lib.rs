//! Stars, moving weighted least squares and the meshless finite difference method for Prandtl torsion.

mod problem;

pub use problem::{Formulation, HoleCondition};
