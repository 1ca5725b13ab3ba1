//! From a problem file to the torsion of a section: the facade of the nmt crates.
//!
//! A problem is a TOML text with a few vertices, curves as formulas, holes and densities. [`problem`] reads it and tells
//! all its faults at once, [`pipeline`] takes it through cloud, mesh and solution, [`report`], [`io`] and [`figures`]
//! write down what came out.
//!
//! ```
//! use nmt::prelude::*;
//!
//! let text = r#"
//!     [[subdomain]]
//!     nodes = [41, 41]
//!     rectangle = { from = [0, 0], to = [1, 1] }
//! "#;
//! let problem = Problem::parse("square.toml", text, &Overrides::default()).map_err(nmt::NmtError::Problem)?;
//! let solved = solve_problem(&problem)?;
//! assert!((solved[0].solution.j - 0.140577015).abs() < 1e-6);
//! # Ok::<(), nmt::NmtError>(())
//! ```
//!
//! The crates of the stages stand beside it: [`geom`], [`curve`], [`cloud`], [`tri`], [`merge`], [`mfdm`].
//!
//! Features: `png` (default) draws PNG beside SVG; `parallel` uses all cores, and changes no number.

pub mod compare;
pub mod edges;
mod error;
pub mod figures;
pub mod io;
pub mod pipeline;
pub mod plot;
pub mod prelude;
pub mod problem;
pub mod report;
pub mod star;

pub use error::NmtError;

pub use {
    nmt_cloud as cloud, nmt_curve as curve, nmt_geom as geom, nmt_merge as merge, nmt_mfdm as mfdm, nmt_tri as tri,
};

/// The README's example, so that it compiles and holds.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct Readme;
