//! One report model, rendered as JSON or text.

mod common;
mod edges;
mod estimate;
mod linear;
mod model;
mod points;
mod poisson;
mod singular;
mod solves;
mod stars;
mod text;
mod thickness;
mod tolerance;
mod warnings;
mod wishes;

pub use common::CommonEdgeReport;
pub use edges::{EdgeReport, LoopReport};
pub use estimate::ErrorEstimateReport;
pub use linear::LinearSolverReport;
pub use model::{CensusReport, HoleReport, QualityReport, Report, Seconds, SolutionReport, SubdomainReport, Totals};
pub use points::{PointReport, PointValues};
pub use poisson::{ErrorReport, FluxReport, PoissonReport};
pub use singular::singular_vertices;
pub(crate) use singular::vertex_angles;
pub use solves::SolvesReport;
pub use stars::{StarsReport, VariationalReport};
pub use text::{place, significant, text};
pub use thickness::{FEWEST_ACROSS, ThinSpot, thinnest};
pub use tolerance::{StepReport, ToleranceReport};
