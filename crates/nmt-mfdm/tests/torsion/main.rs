//! Sections solved from outline to result: against exact solutions, against themselves in other units and places, and
//! star by star.

mod convergence;
mod edges;
mod estimate;
mod graded;
mod holes;
mod invariance;
mod poisson;
mod problem;
mod sections;
mod solvers;
mod stars;
