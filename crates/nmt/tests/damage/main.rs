//! What nmt says about damaged problem files.

mod case;
mod poisson;
mod problems;
