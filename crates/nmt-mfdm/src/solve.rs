//! The stages of a solution in a row: stencils → system → solution → recovered field → results.

use crate::basis::n_monomials;
use crate::blend::NodalPolynomials;
use crate::circulation::{HoleEquation, hole_area, hole_equations};
use crate::error::MfdmError;
use crate::post::{extremes, torque};
use crate::problem::{Formulation, HoleCondition, TorsionProblem};
use crate::solution::{HoleResult, TorsionSolution};
use crate::solver::direct;
use crate::star::default_star;
use crate::stencils::{StarParams, StarReport, Stencils};
use crate::surroundings::{Metric, Surroundings};
use crate::system::{FreeHoles, LinearSystem, Role, Roles};
use crate::{local, variational};
use nmt_geom::{NodeId, Point};
use nmt_tri::{Mesh, NodeTris};

/// The order of the MWLS polynomials that the equations are made with.
pub const ORDER: usize = 2;

/// The order of the polynomials that the results are recovered with \[D14\].
pub const RECOVERY_ORDER: usize = ORDER + 1;

/// How a problem is solved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SolveParams {
    /// Variational by default.
    pub formulation: Formulation,
    /// Nodes in a star, the centre included; at least 6. By default 9, and up to four times as many where the spacings
    /// are in a ratio above 2.
    pub star: Option<usize>,
}

impl Default for SolveParams {
    fn default() -> Self {
        Self { formulation: Formulation::Variational, star: None }
    }
}

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

/// [`solve`], calling `ended` at the end of each stage.
///
/// # Errors
/// As [`solve`].
pub fn solve_observed(
    problem: &TorsionProblem,
    mesh: &Mesh,
    params: &SolveParams,
    ended: &mut dyn FnMut(Stage),
) -> Result<TorsionSolution, MfdmError> {
    problem.check()?;
    let surroundings = Surroundings::new(mesh.cloud());
    let metric = surroundings.metric();
    let stars = star_params(mesh, params, &metric)?;
    let nearest = surroundings.nearest();
    let free_holes = if problem.holes == HoleCondition::Circulation { FreeHoles::Yes } else { FreeHoles::No };
    let roles = Roles::new(mesh, free_holes);

    let n_nodes = mesh.cloud().n_nodes();
    // The local equations need the interior nodes' stars alone; the weak forms need every polynomial.
    let range = match params.formulation {
        Formulation::Local if roles.n_holes == 0 => mesh.cloud().n_boundary()..n_nodes,
        Formulation::Local | Formulation::Variational => 0..n_nodes,
    };
    let stencils = Stencils::new(&surroundings, &nearest, stars, range.clone());
    stencils.require(range, mesh.xy(), 1)?;
    if params.formulation == Formulation::Local {
        stencils.require(mesh.cloud().n_boundary()..n_nodes, mesh.xy(), ORDER)?;
    }
    let star_report = stencils.report();
    ended(Stage::Stencils);

    let node_tris = NodeTris::new(n_nodes, mesh.tri_nodes());
    let system = match params.formulation {
        Formulation::Local => local::assemble(mesh, &stencils, &roles),
        Formulation::Variational => variational::assemble(mesh, &stencils, &node_tris, &roles),
    };
    let equations = hole_equations(mesh, &stencils, &node_tris, &roles, params.formulation);
    drop(stencils);
    drop(node_tris);
    ended(Stage::Assemble);

    let Nodal { values, constants, residual } =
        solve_system(&system, &mesh.xy()[mesh.cloud().n_boundary()..], &equations, &roles, n_nodes)?;
    drop(system);
    ended(Stage::Solve);

    let recovery = StarParams { order: RECOVERY_ORDER, size: metric.star_size(default_star(RECOVERY_ORDER)) };
    let field = NodalPolynomials::fit(&surroundings, &nearest, recovery, &values)?;
    let unknowns = roles.n_unknowns + roles.n_holes;
    let solution = results(problem, mesh, Solved { values, constants, field, residual, unknowns, stars: star_report });
    ended(Stage::Post);
    // A number that is none is an error, not a result.
    let numbers = [solution.j, solution.torque, solution.w_t, solution.f_max.value, solution.tau_max.value];
    if numbers.iter().all(|v| v.is_finite()) { Ok(solution) } else { Err(MfdmError::Singular { n: unknowns }) }
}

fn star_params(mesh: &Mesh, params: &SolveParams, metric: &Metric) -> Result<StarParams, MfdmError> {
    let (n_nodes, least) = (mesh.cloud().n_nodes(), n_monomials(ORDER));
    let size = match params.star {
        Some(star) if star < least || star > n_nodes => {
            return Err(MfdmError::StarSize { star, order: ORDER, least, n_nodes });
        }
        Some(star) => star,
        None => metric.star_size(default_star(ORDER)).min(n_nodes),
    };
    Ok(StarParams { order: ORDER, size })
}

/// Nodal values for Gθ = 1.
struct Nodal {
    values: Vec<f64>,
    constants: Vec<f64>,
    residual: f64,
}

/// F = F_0 + Σ c_k F_k with one factorisation; the holes' equations give the c_k.
fn solve_system(
    system: &LinearSystem,
    xy: &[Point],
    equations: &[HoleEquation],
    roles: &Roles,
    n_nodes: usize,
) -> Result<Nodal, MfdmError> {
    let mut right_sides = vec![system.rhs.clone()];
    for column in &system.hole_columns {
        let mut b = vec![0.0; system.n()];
        column.iter().for_each(|&(row, coefficient)| b[row as usize] = -coefficient);
        right_sides.push(b);
    }
    let direct::Solutions { x, residual } = direct::solve(system, xy, &right_sides)?;
    let along = |equation: &HoleEquation, x: &[f64]| -> f64 {
        equation.row.unknowns.iter().map(|&(k, coefficient)| coefficient * x[k as usize]).sum()
    };
    let mut matrix = Vec::with_capacity(equations.len());
    let mut b = Vec::with_capacity(equations.len());
    for equation in equations {
        let mut row: Vec<f64> = x[1..].iter().map(|x| along(equation, x)).collect();
        equation.row.holes.iter().for_each(|&(hole, coefficient)| row[hole as usize] += coefficient);
        matrix.push(row);
        b.push(equation.rhs - along(equation, &x[0]));
    }
    let constants = if equations.is_empty() { Vec::new() } else { direct::solve_dense(&matrix, &b)? };
    let value = |node: usize| match roles.of(NodeId::of(node)) {
        Role::Zero => 0.0,
        Role::Hole(hole) => constants[hole as usize],
        Role::Unknown(k) => {
            let parts = constants.iter().zip(&x[1..]).map(|(c, x)| c * x[k as usize]);
            x[0][k as usize] + parts.sum::<f64>()
        }
    };
    Ok(Nodal { values: (0..n_nodes).map(value).collect(), constants, residual })
}

/// Everything known for Gθ = 1.
struct Solved {
    values: Vec<f64>,
    constants: Vec<f64>,
    field: NodalPolynomials,
    residual: f64,
    unknowns: usize,
    stars: StarReport,
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
        linear_residual: solved.residual,
        stars: solved.stars,
        recovery_stars: field.report(),
        field,
    }
}
