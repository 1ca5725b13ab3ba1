//! The torsion problem from mesh to results: the discrete problem for Gθ = 1, scaled.

use crate::blend::NodalPolynomials;
use crate::boundary_value::{Discrete, NodalSolution, nodal_solution, recover, solve_discrete};
use crate::circulation::hole_area;
use crate::error::MfdmError;
use crate::estimate::{Case, ErrorEstimate, estimate_observed};
use crate::flux::Fluxes;
use crate::params::SolveParams;
use crate::post::{extremes, torque};
use crate::problem::TorsionProblem;
use crate::solution::{HoleResult, TorsionSolution};
use crate::solver::TARGET;
use crate::source::Source;
use crate::system::Roles;
use crate::warping::{NodalWarping, StressFrame, warping_params};
use nmt_cloud::Section;
use nmt_tri::Mesh;

/// The stages that [`solve_observed`] and [`solve_estimated`] tell the beginning and the end of, in order; the first two of the
/// variational form take turns, batch by batch.
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
    /// How far the results may be off: [`solve_estimated`] finds the warping function before [`Self::Post`], and the
    /// bounds after it.
    Estimate,
}

/// What [`solve_observed`] tells while it works.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Event {
    /// A stage begins.
    Begun(Stage),
    /// A stage has ended.
    Ended(Stage),
    /// Of the stage under way, so many nodes are done.
    Nodes {
        /// Nodes with their stars.
        done: usize,
        /// Nodes in all.
        of: usize,
    },
    /// One more iteration of the linear solver; the last one may have reached its target.
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

/// [`solve`], telling `observer` the beginning and the end of each stage, and within stages how far they are.
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
    let (nodal, field) = solve_discrete(discrete(problem, mesh), params, observer)?;
    let solution = results(problem, mesh, nodal, field);
    observer(Event::Ended(Stage::Post));
    solution
}

/// [`solve_observed`] with the estimate of its errors ([`crate::estimate`]), which takes over stars and equations and so costs half
/// of what it costs by itself. That there is no estimate is no fault of the solution. `section` is what the mesh's cloud was
/// generated from.
///
/// # Errors
/// As [`solve`].
pub fn solve_estimated(
    problem: &TorsionProblem,
    mesh: &Mesh,
    section: &Section,
    params: &SolveParams,
    observer: &mut dyn FnMut(Event),
) -> Result<(TorsionSolution, Estimate), MfdmError> {
    problem.check()?;
    if !problem.has_torsion_constant(mesh.cloud().boundary().n_loops() - 1) {
        // What flows out of the holes must be known before the warping function is found.
        let solution = solve_observed(problem, mesh, params, observer)?;
        observer(Event::Begun(Stage::Estimate));
        let estimate = estimate_observed(problem, mesh, section, params, &solution, &mut within(observer));
        observer(Event::Ended(Stage::Estimate));
        return Ok((solution, estimate));
    }
    let of_warping = warping_params(params);
    let is_same = of_warping == *params;
    let (nodal, operator) = nodal_solution(discrete(problem, mesh), params, None, observer)?;
    let operator = operator.filter(|_| is_same);
    observer(Event::Begun(Stage::Estimate));
    let warping = NodalWarping::solve(
        mesh,
        section,
        StressFrame::of_circulation(mesh),
        &of_warping,
        operator,
        &mut within(observer),
    );
    observer(Event::Ended(Stage::Estimate));
    observer(Event::Begun(Stage::Post));
    let (field, warping) = match warping {
        Ok(warping) if is_same => {
            let [field, w] = recover(mesh, params, [&nodal.values, &warping.values], observer)?;
            (field, Ok(warping.with_field(w)))
        }
        warping => {
            let [field] = recover(mesh, params, [&nodal.values], observer)?;
            let recovered = warping.and_then(|warping| {
                let [w] = recover(mesh, &of_warping, [&warping.values], observer)?;
                Ok(warping.with_field(w))
            });
            (field, recovered)
        }
    };
    let solution = results(problem, mesh, nodal, field)?;
    observer(Event::Ended(Stage::Post));
    observer(Event::Begun(Stage::Estimate));
    let case = Case { problem, mesh, section, params, solution: &solution };
    let estimate = warping.and_then(|warping| case.estimate(warping, &mut within(observer)));
    observer(Event::Ended(Stage::Estimate));
    Ok((solution, estimate))
}

/// What becomes of an estimate: an error where the warping function cannot be found.
pub type Estimate = Result<ErrorEstimate, MfdmError>;

/// The Prandtl problem for Gθ = 1.
fn discrete<'a>(problem: &TorsionProblem, mesh: &'a Mesh) -> Discrete<'a> {
    static NONE: Fluxes = Fluxes::NONE;
    Discrete {
        mesh,
        conditions: Roles::of_torsion(mesh, problem.holes),
        source: Source::Constant(2.0),
        fluxes: &NONE,
        target: TARGET,
    }
}

/// How far a part of a stage is, without its own stages.
fn within(observer: &mut dyn FnMut(Event)) -> impl FnMut(Event) {
    |event| {
        if !matches!(event, Event::Begun(_) | Event::Ended(_)) {
            observer(event)
        }
    }
}

/// Scales the solution for Gθ = 1 by Gθ and takes the results from the recovered field.
///
/// # Errors
/// [`MfdmError::Singular`] where a number is none: that is no result.
fn results(
    problem: &TorsionProblem,
    mesh: &Mesh,
    solved: NodalSolution,
    field: NodalPolynomials,
) -> Result<TorsionSolution, MfdmError> {
    let n_holes = mesh.cloud().boundary().n_loops() - 1;
    let areas: Vec<f64> = (0..n_holes).map(|hole| hole_area(mesh, hole)).collect();
    let j = torque(field.volume(mesh), &solved.constants, &areas);
    let twist = problem.twist(j);
    let g_theta = problem.shear_modulus * twist;
    let field = field.scaled(g_theta);
    let extremes = extremes(mesh, &field);
    let constant = |hole: usize| solved.constants.get(hole).map_or(0.0, |c| c * g_theta);
    let holes = areas.iter().enumerate();
    let solution = TorsionSolution {
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
    };
    let numbers = [solution.j, solution.torque, solution.w_t, solution.f_max.value, solution.tau_max.value];
    let is_sound = numbers.iter().all(|v| v.is_finite());
    if is_sound { Ok(solution) } else { Err(MfdmError::Singular { n: solution.unknowns }) }
}
