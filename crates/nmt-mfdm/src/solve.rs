//! The torsion problem from mesh to results: the discrete problem for Gθ = 1, scaled.

use crate::boundary_value::{Discrete, Solved, solve_discrete};
use crate::circulation::hole_area;
use crate::error::MfdmError;
use crate::flux::Fluxes;
use crate::params::SolveParams;
use crate::post::{extremes, torque};
use crate::problem::TorsionProblem;
use crate::solution::{HoleResult, TorsionSolution};
use crate::solver::TARGET;
use crate::source::Source;
use crate::system::Roles;
use nmt_tri::Mesh;

/// The stages that [`solve_observed`] tells the end of, in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Stars and rows.
    Stencils,
    /// The linear system.
    Assemble,
    /// Factorisation and solution.
    Solve,
    /// Recovery and results.
    Post,
}

/// What [`solve_observed`] tells while it works.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Event {
    /// A stage has ended.
    Ended(Stage),
    /// Of the stage under way, so many nodes are done.
    Nodes {
        /// Nodes with their stars.
        done: usize,
        /// Nodes in all.
        of: usize,
    },
    /// One more iteration of the linear solver, short of its target.
    Iteration {
        /// Iterations for this right side.
        iterations: usize,
        /// ‖b − Ax‖/‖b‖ as the recurrence has it.
        residual: f64,
        /// The residual that it goes on to.
        target: f64,
    },
}

/// Solves the Prandtl problem on a mesh; paper, eqs (16)–(18) \[D10\]–\[D14\].
///
/// # Errors
/// [`MfdmError`] where a constant or the star's size is out of range, a star cannot carry its polynomial, or the system
/// is singular; never a number that does not satisfy its equations.
///
/// ```
/// use nmt_cloud::{CloudParams, Section, generate};
/// use nmt_curve::Outline;
/// use nmt_mfdm::{SolveParams, TorsionProblem, exact, solve};
/// use nmt_tri::Mesh;
///
/// let square = Section::solid(Outline::rectangle([0.0, 0.0], [1.0, 1.0]));
/// let cloud = generate(&square, &CloudParams { nodes: [21, 21], ..CloudParams::default() })?;
/// let mesh = Mesh::constrained(cloud)?;
/// let solution = solve(&TorsionProblem::default(), &mesh, &SolveParams::default())?;
/// let reference = exact::rectangle(1.0, 1.0).j;
/// assert!((solution.j / reference - 1.0).abs() < 1e-4);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn solve(problem: &TorsionProblem, mesh: &Mesh, params: &SolveParams) -> Result<TorsionSolution, MfdmError> {
    solve_observed(problem, mesh, params, &mut |_| {})
}

/// [`solve`], telling `observer` the end of each stage, and within stages how far they are.
///
/// # Errors
/// As [`solve`].
pub fn solve_observed(
    problem: &TorsionProblem,
    mesh: &Mesh,
    params: &SolveParams,
    observer: &mut dyn FnMut(Event),
) -> Result<TorsionSolution, MfdmError> {
    problem.check()?;
    let discrete = Discrete {
        mesh,
        conditions: Roles::of_torsion(mesh, problem.holes),
        source: Source::Constant(2.0),
        fluxes: &Fluxes::default(),
        target: TARGET,
    };
    let solved = solve_discrete(discrete, params, observer)?;
    let unknowns = solved.unknowns;
    let solution = results(problem, mesh, solved);
    observer(Event::Ended(Stage::Post));
    // A number that is none is an error, not a result.
    let numbers = [solution.j, solution.torque, solution.w_t, solution.f_max.value, solution.tau_max.value];
    if numbers.iter().all(|v| v.is_finite()) { Ok(solution) } else { Err(MfdmError::Singular { n: unknowns }) }
}

/// Scales the solution for Gθ = 1 by Gθ and takes the results from the recovered field.
fn results(problem: &TorsionProblem, mesh: &Mesh, solved: Solved) -> TorsionSolution {
    let n_holes = mesh.cloud().boundary().n_loops() - 1;
    let areas: Vec<f64> = (0..n_holes).map(|hole| hole_area(mesh, hole)).collect();
    let j = torque(solved.field.volume(mesh), &solved.constants, &areas);
    let twist = problem.twist(j);
    let g_theta = problem.shear_modulus * twist;
    let field = solved.field.scaled(g_theta);
    let extremes = extremes(mesh, &field);
    let constant = |hole: usize| solved.constants.get(hole).map_or(0.0, |c| c * g_theta);
    let holes = areas.iter().enumerate();
    TorsionSolution {
        f: solved.values.iter().map(|v| v * g_theta).collect(),
        holes: holes.map(|(k, &area)| HoleResult { condition: problem.holes, f: constant(k), area }).collect(),
        j,
        torque: j * g_theta,
        twist,
        g_theta,
        w_t: (j * g_theta).abs() / extremes.tau_max.value,
        f_max: extremes.f_max,
        tau_max: extremes.tau_max,
        unknowns: solved.unknowns,
        linear: solved.linear,
        stars: solved.stars,
        recovery_stars: field.report(),
        used_stars: solved.used_stars,
        field,
    }
}
