//! How far a solution may be off, as far as the problem asks for it.

use super::{Event, MeshPart, Observer, Stage, torsion};
use crate::problem::Problem;
use nmt_mfdm::{ErrorEstimate, HoleCondition, MfdmError, SolveParams, TorsionSolution, estimate_observed};

/// How far a solution may be off.
#[derive(Clone, Debug, PartialEq)]
pub enum Estimated {
    /// By so much.
    By(Box<ErrorEstimate>),
    /// Nobody asked: `estimate = false`.
    NotAsked,
    /// F = 0 on a hole: 2∫F is no torsion constant there, and has no bounds.
    NoTorsionConstant,
    /// The stars of the cloud carry F, but not the warping function.
    Failed(MfdmError),
}

impl Estimated {
    /// The estimate, where there is one.
    pub fn made(&self) -> Option<&ErrorEstimate> {
        match self {
            Self::By(estimate) => Some(estimate),
            Self::NotAsked | Self::NoTorsionConstant | Self::Failed(_) => None,
        }
    }

    /// Why there is none, though it was asked for.
    pub fn refused(&self) -> Option<String> {
        match self {
            Self::By(_) | Self::NotAsked => None,
            Self::NoTorsionConstant => {
                let condition = HoleCondition::Zero.name();
                Some(format!(
                    "with F = 0 on holes (holes = \"{condition}\") 2∫F is no torsion constant, and has no bounds"
                ))
            }
            Self::Failed(error) => Some(format!("the warping function cannot be found on this cloud: {error}")),
        }
    }
}

/// The estimate for subdomain `k`; that there is none is no fault of the solution.
pub(super) fn of_solution(
    (k, problem): (usize, &Problem),
    (part, params): (&MeshPart, &SolveParams),
    solution: &TorsionSolution,
    observer: &mut Observer,
) -> Estimated {
    if !problem.solve.estimate {
        return Estimated::NotAsked;
    }
    observer(k, Event::Begun(Stage::Estimate));
    let mut inner = |event| match event {
        // The stages of the warping function are one stage of the estimate.
        nmt_mfdm::Event::Ended(_) => {}
        nmt_mfdm::Event::Nodes { done, of } => observer(k, Event::Nodes { done, of }),
        nmt_mfdm::Event::Iteration { iterations, residual, target } => {
            observer(k, Event::Iteration { iterations, residual, target });
        }
    };
    let torsion = torsion(problem, &problem.subdomains[k]);
    let estimated = estimate_observed(&torsion, &part.mesh, &part.section, params, solution, &mut inner);
    observer(k, Event::Ended(Stage::Estimate));
    match estimated {
        Ok(Some(estimate)) => Estimated::By(Box::new(estimate)),
        Ok(None) => Estimated::NoTorsionConstant,
        Err(error) => Estimated::Failed(error),
    }
}
