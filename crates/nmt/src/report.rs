//! One report model, rendered as JSON or text.

mod common;
mod linear;
mod model;
mod singular;
mod stars;
mod text;
mod thickness;
mod warnings;

pub use common::CommonEdgeReport;
pub use linear::LinearSolverReport;
pub use model::{
    CensusReport, HoleReport, PointReport, QualityReport, Report, Seconds, SolutionReport, SubdomainReport, Totals,
};
pub use singular::singular_vertices;
pub use stars::{StarsReport, VariationalReport};
pub use text::{place, text};
pub use thickness::{FEWEST_ACROSS, ThinSpot, thinnest};
