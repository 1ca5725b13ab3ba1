//! One report model, rendered as JSON or text.

mod common;
mod edges;
mod linear;
mod model;
mod points;
mod poisson;
mod singular;
mod solves;
mod stars;
mod text;
mod thickness;
mod warnings;
mod wishes;

pub use common::CommonEdgeReport;
pub use edges::{EdgeReport, LoopReport};
pub use linear::LinearSolverReport;
pub use model::{CensusReport, HoleReport, QualityReport, Report, Seconds, SolutionReport, SubdomainReport, Totals};
pub use points::{PointReport, PointValues};
pub use poisson::{ErrorReport, FluxReport, PoissonReport};
pub use singular::singular_vertices;
pub use solves::SolvesReport;
pub use stars::{StarsReport, VariationalReport};
pub use text::{place, text};
pub use thickness::{FEWEST_ACROSS, ThinSpot, thinnest};
