//! The names of the README's example.

pub use crate::pipeline::{Solved, SolvedPart, solve_any, solve_problem};
pub use crate::problem::{Overrides, Problem};
pub use nmt_cloud::{CloudParams, Section, generate};
pub use nmt_curve::Outline;
pub use nmt_mfdm::{Formulation, SolveParams, TorsionProblem, solve};
pub use nmt_tri::Mesh;
