//! What a solve will solve, for `nmt check`.

use crate::problem::Problem;
use nmt_mfdm::Load;
use serde::Serialize;

/// The problem that a file asks for.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "problem", rename_all = "lowercase")]
pub enum SolvesReport {
    /// ∇²F = −2Gθ.
    Torsion {
        /// θ, where it is given.
        #[serde(skip_serializing_if = "Option::is_none")]
        twist: Option<f64>,
        /// T, where that is given instead.
        #[serde(skip_serializing_if = "Option::is_none")]
        torque: Option<f64>,
        /// The condition on holes.
        holes: &'static str,
    },
    /// ∇²u = f.
    Poisson {
        /// f.
        source: String,
        /// g on the edges without a flux.
        boundary: String,
        /// Edges with a flux, of all subdomains.
        fluxes: usize,
        /// The exact u, where it is given.
        #[serde(skip_serializing_if = "Option::is_none")]
        exact: Option<String>,
    },
}

impl SolvesReport {
    pub(super) fn of(problem: &Problem) -> Self {
        let Some(poisson) = &problem.solve.poisson else {
            let (twist, torque) = match problem.solve.load {
                Load::Twist(twist) => (Some(twist), None),
                Load::Torque(torque) => (None, Some(torque)),
            };
            return Self::Torsion { twist, torque, holes: problem.solve.holes.name() };
        };
        Self::Poisson {
            source: poisson.source.text().into(),
            boundary: poisson.boundary.as_ref().map_or("0", |g| g.text()).into(),
            fluxes: problem.subdomains.iter().flat_map(|subdomain| &subdomain.fluxes).flatten().count(),
            exact: poisson.exact.as_ref().map(|u| u.text().into()),
        }
    }
}
