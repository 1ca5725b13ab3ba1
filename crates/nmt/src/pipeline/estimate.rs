//! How far a solution may be off, as far as the problem asks for it.

use super::{MeshPart, Observer, of_solution, torsion};
use crate::problem::Problem;
use nmt_mfdm::{ErrorEstimate, MfdmError, SolveParams, TorsionSolution, solve_estimated, solve_observed};

/// How far a solution may be off.
#[derive(Clone, Debug, PartialEq)]
pub enum Estimated {
    /// By so much.
    By(Box<ErrorEstimate>),
    /// Nobody asked: `estimate = false`.
    NotAsked,
    /// The stars of the cloud carry F, but not the warping function.
    Failed(MfdmError),
}

impl Estimated {
    /// The estimate, where there is one.
    pub fn made(&self) -> Option<&ErrorEstimate> {
        match self {
            Self::By(estimate) => Some(estimate),
            Self::NotAsked | Self::Failed(_) => None,
        }
    }

    /// Why there is none, though it was asked for.
    pub fn refused(&self) -> Option<String> {
        match self {
            Self::By(_) | Self::NotAsked => None,
            Self::Failed(error) => Some(format!("the warping function cannot be found on this cloud: {error}")),
        }
    }
}

/// Solves torsion in subdomain `k`, with the estimate that the problem asks for.
///
/// # Errors
/// As [`nmt_mfdm::solve`].
pub(super) fn solve_part(
    (k, problem): (usize, &Problem),
    (part, params): (&MeshPart, &SolveParams),
    observer: &mut Observer,
) -> Result<(TorsionSolution, Estimated), MfdmError> {
    let torsion = torsion(problem, &problem.subdomains[k]);
    if !problem.solve.estimate {
        let solution = solve_observed(&torsion, &part.mesh, params, &mut of_solution(k, observer))?;
        return Ok((solution, Estimated::NotAsked));
    }
    let observer = &mut of_solution(k, observer);
    let (solution, estimate) = solve_estimated(&torsion, &part.mesh, &part.section, params, observer)?;
    let estimated = match estimate {
        Ok(estimate) => Estimated::By(Box::new(estimate)),
        Err(error) => Estimated::Failed(error),
    };
    Ok((solution, estimated))
}
