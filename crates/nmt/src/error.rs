//! What can go wrong between a problem file and its results.

use crate::problem::ProblemError;
use nmt_mfdm::MfdmError;
use nmt_tri::MeshError;

/// What can go wrong between a problem file and its results.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NmtError {
    /// The problem file is wrong: every fault found.
    #[error("{}", .0.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))]
    Problem(Vec<ProblemError>),
    /// A cloud cannot be triangulated.
    #[error("subdomain \"{subdomain}\": the mesh failed")]
    Mesh {
        /// Its name.
        subdomain: String,
        /// Why.
        source: MeshError,
    },
    /// The numerics failed.
    #[error("subdomain \"{subdomain}\": the solution failed")]
    Solve {
        /// Its name.
        subdomain: String,
        /// Why.
        source: MfdmError,
    },
}
