//! Stars, moving weighted least squares and the meshless finite difference method for Prandtl torsion.
//!
//! The torsion of a prismatic bar: ∇²F = −2Gθ in the section, F = 0 on its outer boundary, an unknown constant with a
//! condition on its circulation on each hole. Each node has a *star*, its nearest visible nodes; moving weighted least
//! squares (MWLS) turn a star into a polynomial of the nodal values. The *local* formulation collocates the equation
//! with these polynomials, the *variational* one blends them over the triangles and tests with hats. Results come from
//! the blend of polynomials of one order more.
//!
//! ```
//! use nmt_cloud::{CloudParams, Section, generate};
//! use nmt_curve::Outline;
//! use nmt_mfdm::{Formulation, SolveParams, TorsionProblem, exact, solve};
//! use nmt_tri::Mesh;
//!
//! // A tube of radii 1/2 and 1 in the local formulation.
//! let tube = Section { contour: Outline::circle([0.0, 0.0], 1.0), holes: vec![Outline::circle([0.0, 0.0], 0.5)] };
//! let cloud = generate(&tube, &CloudParams { nodes: [41, 41], irregularity: 0.2, ..CloudParams::default() })?;
//! let mesh = Mesh::constrained(cloud)?;
//! let params = SolveParams { formulation: Formulation::Local, ..SolveParams::default() };
//! let solution = solve(&TorsionProblem::default(), &mesh, &params)?;
//! assert!((solution.j / exact::ring(0.5, 1.0).j - 1.0).abs() < 1e-3);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod assembly;
mod basis;
mod batches;
mod blend;
mod boundary_value;
mod circulation;
mod diagnostics;
mod edge_stress;
mod element;
mod error;
mod estimate;
pub mod exact;
mod flux;
mod galerkin;
mod gauss;
mod hat;
mod hidden;
#[cfg(feature = "kernels")]
#[doc(hidden)]
pub mod kernels;
mod lanes;
mod local;
mod mend;
mod mwls;
mod one_star;
mod operator;
mod outflow;
mod overshoot;
mod parallel;
mod params;
mod patched;
mod poisson;
mod post;
mod problem;
mod quadrature;
mod quartet;
mod repair;
mod row_sum;
mod shapes;
mod slopes;
mod solution;
mod solve;
mod solver;
mod sound_stars;
mod source;
mod star;
mod steady;
mod stencils;
mod surroundings;
mod system;
mod system_maker;
mod true_edges;
mod variational;
mod vectors;
mod visibility;
mod warping;
mod weak;
mod weight;

pub use basis::{MAX_MONOMIALS, MAX_ORDER, monomials, n_monomials, row};
pub use blend::{FieldValue, NodalPolynomials, barycentric_gradients};
pub use diagnostics::{StarDiagnostics, UsedStars};
pub use edge_stress::{Circulation, EdgePoint, EdgeStress, circulations, edge_stresses};
pub use error::MfdmError;
pub use estimate::{ErrorEstimate, estimate, estimate_observed};
pub use gauss::{GAUSS_POINTS, Rule, six_points, three_points};
pub use hidden::{HiddenBends, hidden_bends};
pub use mwls::{MAX_CONDITION, Mwls};
pub use one_star::{NodeStar, StarMember};
pub use params::{SolveParams, default_gauss};
pub use poisson::{ErrorNorms, PoissonProblem, PoissonSolution, solve_poisson, solve_poisson_observed};
pub use post::{Extreme, Extremes, Stress, StressIntegral, extremes, residuals, stress_integrals};
pub use problem::{Formulation, HoleCondition, Load, Test, TorsionProblem, Trial};
pub use repair::StarOutcome;
pub use solution::{HoleResult, TorsionSolution};
pub use solve::{Estimate, Event, Stage, solve, solve_estimated, solve_observed};
pub use solver::{DIRECT_MAX_UNKNOWNS, Iteration, LinearSolve, Method, Solver};
pub use star::{StarChoice, StarFinder, default_star};
pub use stencils::{StarParams, StarReport, Stencil, Stencils};
pub use surroundings::{Metric, Surroundings};
pub use visibility::Visibility;
pub use weight::weight;
