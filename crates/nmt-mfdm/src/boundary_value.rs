//! A boundary value problem −∇²u = s on a mesh: stencils → system → nodal values → recovered field.

use crate::assembly::Frame;
use crate::batches::{self, Batched};
use crate::blend::NodalPolynomials;
use crate::circulation::{hole_equations, nodes_of_equations, of_elements};
use crate::diagnostics::UsedStars;
use crate::error::MfdmError;
use crate::flux::Fluxes;
use crate::gauss::Rule;
use crate::one_star::NodeStar;
use crate::operator::Operator;
use crate::params::SolveParams;
use crate::problem::{Formulation, Test, Trial};
use crate::repair::EVEN;
use crate::shapes::TrialSpace;
use crate::slopes::KnownSlopes;
use crate::solve::{Event, Stage};
use crate::solver::{self, Border, LinearSolve, RightSide, Solver, direct};
use crate::source::Source;
use crate::star::default_star;
use crate::steady::{Hold, steady};
use crate::stencils::{Kept, StarParams, StarReport, Stencils};
use crate::surroundings::Surroundings;
use crate::system::{Dirichlet, Equation, LinearSystem, NodeCondition, Role, Roles};
use crate::weak::WeakForm;
use crate::{galerkin, local, variational};
use nmt_cloud::Nearest;
use nmt_geom::{NodeId, Point};
use nmt_tri::{Mesh, NodeTris};

/// Gauss points that integrate a source that is not constant: exact to degree 4 for orders 1 and 2, to degree 6 above.
const SOURCE_POINTS: [usize; 2] = [6, 12];

/// What is solved.
pub(crate) struct Discrete<'a> {
    pub mesh: &'a Mesh,
    /// At each boundary node.
    pub conditions: Vec<NodeCondition>,
    pub source: Source<'a>,
    pub fluxes: &'a Fluxes,
    /// ‖b − Ax‖/‖b‖ of the linear system that an iteration goes on to.
    pub target: f64,
}

/// What came of it at the nodes.
pub(crate) struct NodalSolution {
    /// u at the nodes.
    pub values: Vec<f64>,
    /// Of each hole with a circulation.
    pub constants: Vec<f64>,
    pub linear: LinearSolve,
    pub unknowns: usize,
    pub stars: StarReport,
    pub used_stars: UsedStars,
}

/// A mesh with what surrounds its nodes.
#[derive(Clone, Copy)]
pub(crate) struct Around<'a> {
    pub mesh: &'a Mesh,
    pub surroundings: &'a Surroundings<'a>,
    pub nearest: &'a Nearest<'a>,
    pub node_tris: &'a NodeTris,
}

/// What `work` makes of a mesh with what surrounds its nodes.
pub(crate) fn with_surroundings<T>(mesh: &Mesh, work: impl FnOnce(Around) -> T) -> T {
    let surroundings = Surroundings::new(mesh.cloud());
    let nearest = surroundings.nearest();
    let node_tris = NodeTris::new(mesh.cloud().n_nodes(), mesh.tri_nodes());
    work(Around { mesh, surroundings: &surroundings, nearest: &nearest, node_tris: &node_tris })
}

/// Solves a problem and recovers the field.
///
/// # Errors
/// [`MfdmError`] where a parameter is out of range, a star cannot carry its polynomial, or the system is singular.
pub(crate) fn solve_discrete(
    discrete: Discrete,
    params: &SolveParams,
    observer: &mut dyn FnMut(Event),
) -> Result<(NodalSolution, NodalPolynomials), MfdmError> {
    let mesh = discrete.mesh;
    let (nodal, operator) = nodal_solution(discrete, params, None, observer)?;
    drop(operator);
    observer(Event::Begun(Stage::Post));
    let [field] = recover(mesh, params, [&nodal.values], observer)?;
    Ok((nodal, field))
}

/// Solves a problem for the values at the nodes, its equations made anew, or from the operator of another problem with
/// these parameters on this mesh; hands over its own, of interpolating polynomials tested by hats with all values on the
/// boundary given.
///
/// # Errors
/// As [`solve_discrete`].
pub(crate) fn nodal_solution(
    discrete: Discrete,
    params: &SolveParams,
    from: Option<Operator>,
    observer: &mut dyn FnMut(Event),
) -> Result<(NodalSolution, Option<Operator>), MfdmError> {
    params.check()?;
    let Discrete { mesh, conditions, source, fluxes, target } = discrete;
    let roles = roles(conditions, mesh, params);
    // What surrounds the nodes is made again for the recovery: the linear solver needs its room.
    let assembled = with_surroundings(mesh, |around| {
        let (rule, source_rule) = (params.rule()?, source_rule(params));
        let frame =
            Frame { mesh, node_tris: around.node_tris, roles: &roles, source, fluxes, source_rule: &source_rule };
        let assembled = match from {
            Some(operator) => {
                observer(Event::Begun(Stage::Assemble));
                let stars = stars_of_equations(params, around, &roles)?;
                operator.equations(frame, (around.surroundings, around.nearest), stars, &rule).map(Assembled::of)
            }
            None => Assembly { frame, around, params, rule: &rule }.assemble(observer),
        };
        Ok((assembled?, of_elements(&frame)))
    });
    let (Assembled { mut system, equations, stars, used_stars, smoothing, holds }, of_elements) = assembled?;
    observer(Event::Ended(Stage::Assemble));

    observer(Event::Begun(Stage::Solve));
    let border = Border { equations: &equations, of_elements: &of_elements };
    let Nodal { values, constants, linear } =
        solve_system(&mut system, mesh.xy(), border, &roles, (params.solver, target), observer)?;
    let is_whole = is_mended(params) && roles.n_unknowns == mesh.cloud().n_interior();
    let LinearSystem { matrix, is_beside, .. } = system;
    let operator = is_whole.then(|| Operator { matrix, is_beside, holds, larger: used_stars.larger().clone() });
    let values = match smoothing {
        Some(stencils) => smoothed(&stencils, mesh.xy(), values),
        None => values,
    };
    observer(Event::Ended(Stage::Solve));
    let unknowns = roles.n_unknowns + roles.n_holes;
    Ok((NodalSolution { values, constants, linear, unknowns, stars, used_stars }, operator))
}

/// The fields through values at the nodes, of one order more than the equations with `params` \[D14\].
///
/// # Errors
/// [`MfdmError::PoorStar`] where a node sees too few others for a plane.
pub(crate) fn recover<const N: usize>(
    mesh: &Mesh,
    params: &SolveParams,
    values: [&[f64]; N],
    observer: &mut dyn FnMut(Event),
) -> Result<[NodalPolynomials; N], MfdmError> {
    if params.formulation == Formulation::Fem {
        return Ok(values.map(|values| NodalPolynomials::linear(mesh, values)));
    }
    let order = params.recovery_order();
    with_surroundings(mesh, |Around { surroundings, nearest, .. }| {
        let recovery = StarParams {
            choice: params.stars.unwrap_or_default(),
            ..StarParams::nearest(order, surroundings.metric().star_size(default_star(order)))
        };
        NodalPolynomials::fit_fields((surroundings, nearest), recovery, values, observer)
    })
}

/// What the linear solver and the results take.
struct Assembled {
    system: LinearSystem,
    /// Of the holes' constants.
    equations: Vec<Equation>,
    stars: StarReport,
    used_stars: UsedStars,
    /// Of polynomials that smooth: they make the nodal values from the solution.
    smoothing: Option<Stencils>,
    /// What holds loose nodes.
    holds: Vec<Hold>,
}

impl Assembled {
    /// A system whose stars nobody reports.
    fn of(system: LinearSystem) -> Self {
        let (stars, used_stars) = (StarReport::default(), UsedStars::default());
        Self { system, equations: Vec::new(), stars, used_stars, smoothing: None, holds: Vec::new() }
    }
}

/// A problem with what its equations are made from.
struct Assembly<'a> {
    frame: Frame<'a>,
    around: Around<'a>,
    params: &'a SolveParams,
    rule: &'a Rule,
}

impl Assembly<'_> {
    fn assemble(&self, observer: &mut dyn FnMut(Event)) -> Result<Assembled, MfdmError> {
        if is_mended(self.params) {
            self.mended_in_batches(observer)
        } else if is_collocated(self.params) {
            self.collocated_in_batches(observer)
        } else {
            self.at_once(observer)
        }
    }

    fn star_params(&self) -> Result<StarParams, MfdmError> {
        stars_of_equations(self.params, self.around, self.frame.roles)
    }

    fn places(&self) -> (&Surroundings<'_>, &Nearest<'_>) {
        (self.around.surroundings, self.around.nearest)
    }

    /// Those of hats on blends, from stars that are made and dropped batch by batch; soft nodes are mended, loose ones held.
    fn mended_in_batches(&self, observer: &mut dyn FnMut(Event)) -> Result<Assembled, MfdmError> {
        let batched = batches::assemble(self.frame, self.places(), self.star_params()?, self.rule, observer)?;
        let Batched { mut system, anew, firmness, equations, stars, used_stars } = batched;
        let holds = steady(self.frame, self.places(), self.params.order, &mut system, anew, &firmness);
        Ok(Assembled { system, equations, stars, used_stars, smoothing: None, holds })
    }

    /// The local ones with interpolating polynomials, from stars that are made and dropped batch by batch.
    fn collocated_in_batches(&self, observer: &mut dyn FnMut(Event)) -> Result<Assembled, MfdmError> {
        let (fluxes, stars) = (self.frame.fluxes, self.star_params()?);
        let known = |node: NodeId| known_slopes(fluxes, self.around.surroundings, node);
        let batched = local::assemble_in_batches(self.frame, self.places(), stars, known, observer)?;
        let local::Batched { system, stars: report, used_stars } = batched;
        // The holes' equations are weak ones, with stencils of their own.
        let of_holes = nodes_of_equations(&self.frame, Formulation::Local);
        let stencils = Stencils::of_some(self.places(), stars, of_holes, known);
        let weak = WeakForm::blended(&stencils, fluxes, self.rule);
        let equations = hole_equations(&self.frame, &weak, Formulation::Local);
        Ok(Assembled { system, equations, stars: report, used_stars, smoothing: None, holds: Vec::new() })
    }

    /// All others, from all stencils.
    fn at_once(&self, observer: &mut dyn FnMut(Event)) -> Result<Assembled, MfdmError> {
        let Self { frame, around, params, rule } = *self;
        let Frame { mesh, fluxes, .. } = frame;
        observer(Event::Begun(Stage::Stencils));
        let stencils = stencils_of_equations(around, fluxes, params, observer)?;
        observer(Event::Ended(Stage::Stencils));
        observer(Event::Begun(Stage::Assemble));
        let (stars, used_stars) = (stencils.report(), stencils.used());
        let setting = frame.with(&stencils);
        let space = TrialSpace {
            kind: params.trial,
            mesh,
            stencils: &stencils,
            surroundings: around.surroundings,
            nearest: around.nearest,
            params: StarParams {
                choice: params.star_choice(mesh.cloud()),
                smoothing: params.smoothing,
                ..StarParams::nearest(params.order, stars.size)
            },
        };
        let weak = match params.formulation {
            Formulation::Variational => WeakForm::new(space, fluxes, rule)?,
            Formulation::Local | Formulation::Fem => WeakForm::blended(&stencils, fluxes, rule),
        };
        let system = match (params.formulation, params.test) {
            (Formulation::Local, _) => local::assemble(&setting)?,
            (Formulation::Variational, Test::Trial) => galerkin::assemble(&setting, space, rule)?,
            (Formulation::Variational, Test::Hat) | (Formulation::Fem, _) => variational::assemble(&setting, &weak)?,
        };
        let equations = hole_equations(&frame, &weak, params.formulation);
        drop(weak);
        // Rows are the larger part of what is held; only smoothing needs them again.
        let stencils = (!interpolates(params)).then_some(stencils);
        Ok(Assembled { system, equations, stars, used_stars, smoothing: stencils, holds: Vec::new() })
    }
}

/// The stars of equations: where boundary nodes are unknowns, nothing holds the values on a small hole.
fn stars_of_equations(params: &SolveParams, around: Around, roles: &Roles) -> Result<StarParams, MfdmError> {
    let cloud = around.mesh.cloud();
    let stars = params.star_params(cloud, &around.surroundings.metric())?;
    let is_held = roles.n_unknowns == cloud.n_interior();
    Ok(if is_held { stars } else { StarParams { evening: EVEN, ..stars } })
}

/// What a flux at a node makes known of the gradient there, in stretched coordinates.
fn known_slopes(fluxes: &Fluxes, surroundings: &Surroundings, node: NodeId) -> Option<KnownSlopes> {
    fluxes.of_node(node).map(|flux| flux.known(surroundings.metric().stretch()))
}

/// The star of `node` as the equations of a problem have it in the end, mended where it left its node soft; `None` for
/// finite elements, which have none.
///
/// # Errors
/// As [`solve_discrete`], but for what the linear system and the recovery may say.
pub(crate) fn star_of_equations(
    discrete: Discrete,
    params: &SolveParams,
    node: NodeId,
) -> Result<Option<NodeStar>, MfdmError> {
    params.check()?;
    let Discrete { mesh, conditions, source, fluxes, .. } = discrete;
    if params.formulation == Formulation::Fem || node.index() >= mesh.cloud().n_nodes() {
        return Ok(None);
    }
    if !is_mended(params) && fluxes.of_node(node).is_none() {
        return NodeStar::of(mesh.cloud(), params, node);
    }
    with_surroundings(mesh, |around| {
        let roles = roles(conditions, mesh, params);
        let stencils = if is_mended(params) {
            let (rule, source_rule) = (params.rule()?, source_rule(params));
            let frame =
                Frame { mesh, node_tris: around.node_tris, roles: &roles, source, fluxes, source_rule: &source_rule };
            let assembly = Assembly { frame, around, params, rule: &rule };
            let assembled = assembly.mended_in_batches(&mut |_| {})?;
            let mut own = Stencils::of_some(assembly.places(), assembly.star_params()?, vec![node], |_| None);
            let larger = assembled.used_stars.larger().get(&node).map(|size| (node, *size));
            own.replace(around.surroundings, around.nearest, larger.as_slice());
            own
        } else {
            stencils_of_equations(around, fluxes, params, &mut |_| {})?
        };
        Ok(Some(NodeStar::in_stencils(mesh.cloud(), around.surroundings, &stencils, node)))
    })
}

/// Whether polynomials meet their nodes' values exactly.
fn interpolates(params: &SolveParams) -> bool {
    params.smoothing == 0.0 || params.formulation == Formulation::Fem
}

/// Whether soft nodes are mended: hats on interpolating blends.
fn is_mended(params: &SolveParams) -> bool {
    let form = (params.formulation, params.trial, params.test);
    form == (Formulation::Variational, Trial::Blended, Test::Hat) && interpolates(params)
}

/// Whether the equations are local ones of interpolating polynomials: rows of ∇² are all that they need of a star.
fn is_collocated(params: &SolveParams) -> bool {
    params.formulation == Formulation::Local && interpolates(params)
}

fn roles(conditions: Vec<NodeCondition>, mesh: &Mesh, params: &SolveParams) -> Roles {
    let dirichlet = if interpolates(params) { Dirichlet::Eliminated } else { Dirichlet::Rows };
    Roles::new(conditions, mesh.cloud().n_interior(), dirichlet)
}

fn source_rule(params: &SolveParams) -> Rule {
    Rule::of(SOURCE_POINTS[usize::from(params.order > 2)]).unwrap_or_else(crate::gauss::six_points)
}

/// Stars and rows as they are chosen, before any is mended.
fn stencils_of_equations(
    around: Around,
    fluxes: &Fluxes,
    params: &SolveParams,
    observer: &mut dyn FnMut(Event),
) -> Result<Stencils, MfdmError> {
    let Around { mesh, surroundings, nearest, .. } = around;
    let (n_nodes, n_boundary) = (mesh.cloud().n_nodes(), mesh.cloud().n_boundary());
    if params.formulation == Formulation::Fem {
        return Ok(Stencils::constants(n_nodes));
    }
    let stars = params.star_params(mesh.cloud(), &surroundings.metric())?;
    // The local equation of a node with a flux is ∇²u = −s there too, its polynomial meeting the flux.
    let known = |node: NodeId| match params.formulation {
        Formulation::Local => known_slopes(fluxes, surroundings, node),
        Formulation::Variational | Formulation::Fem => None,
    };
    let around = (surroundings, nearest);
    let stencils = Stencils::meeting(around, stars, Kept::Derivatives, 0..n_nodes, known, observer);
    stencils.require(0..n_nodes, mesh.xy(), 1)?;
    if params.formulation == Formulation::Local {
        stencils.require(n_boundary..n_nodes, mesh.xy(), 2)?;
    }
    Ok(stencils)
}

/// The values of smoothing polynomials at their nodes, from the parameters.
fn smoothed(stencils: &Stencils, xy: &[Point], parameters: Vec<f64>) -> Vec<f64> {
    let value = |node: usize| {
        let stencil = stencils.of(NodeId::of(node));
        let coefficients = || stencil.nodes.iter().copied().zip(stencil.row(0).iter().copied());
        let sum: f64 = coefficients().map(|(other, c)| c * parameters[other.index()]).sum();
        sum - stencils.known_share(NodeId::of(node), coefficients(), xy)
    };
    (0..parameters.len()).map(value).collect()
}

/// Nodal values.
struct Nodal {
    values: Vec<f64>,
    constants: Vec<f64>,
    linear: LinearSolve,
}

/// The unknowns and the constants of the holes: found together, or where that is not done, F = F_0 + Σ c_k F_k with one
/// set-up, and the holes' equations give the c_k.
fn solve_system(
    system: &mut LinearSystem,
    xy: &[Point],
    border: Border,
    roles: &Roles,
    (choice, target): (Solver, f64),
    observer: &mut dyn FnMut(Event),
) -> Result<Nodal, MfdmError> {
    let (x, constants, linear) = match solver::solve_bordered(system, border, choice, target, observer) {
        Some((mut x, how)) => {
            let constants = x.split_off(system.n());
            (x, constants, how)
        }
        None => put_together(system, xy, border.equations, roles, (choice, target), observer)?,
    };
    let value = |node: usize| match roles.of(NodeId::of(node)) {
        Role::Known(value) => value,
        Role::Hole(hole) => constants[hole as usize],
        Role::Unknown(k) => x[k as usize],
    };
    Ok(Nodal { values: (0..xy.len()).map(value).collect(), constants, linear })
}

/// F = F_0 + Σ c_k F_k.
fn put_together(
    system: &LinearSystem,
    xy: &[Point],
    equations: &[Equation],
    roles: &Roles,
    (choice, target): (Solver, f64),
    observer: &mut dyn FnMut(Event),
) -> Result<(Vec<f64>, Vec<f64>, LinearSolve), MfdmError> {
    let of_holes = system.hole_columns.iter().map(|column| RightSide::Column(column));
    let right_sides: Vec<RightSide> = std::iter::once(RightSide::All(&system.rhs)).chain(of_holes).collect();
    let solver::Solutions { mut x, how } =
        solver::solve(system, &|| roles.places(xy), &right_sides, choice, target, observer)?;
    let along = |equation: &Equation, x: &[f64]| -> f64 {
        equation.row.unknowns.iter().map(|&(k, coefficient)| coefficient * x[k as usize]).sum()
    };
    let mut matrix = Vec::with_capacity(equations.len());
    let mut b = Vec::with_capacity(equations.len());
    for equation in equations {
        let mut row: Vec<f64> = x[1..].iter().map(|x| along(equation, x)).collect();
        equation.row.holes.iter().for_each(|&(hole, coefficient)| row[hole as usize] += coefficient);
        matrix.push(row);
        b.push(equation.rhs - equation.row.known - along(equation, &x[0]));
    }
    let constants = if equations.is_empty() { Vec::new() } else { direct::solve_dense(&matrix, &b)? };
    let of_holes = x.split_off(1);
    let mut sum = x.swap_remove(0);
    for (k, value) in sum.iter_mut().enumerate() {
        *value += constants.iter().zip(&of_holes).map(|(c, x)| c * x[k]).sum::<f64>();
    }
    Ok((sum, constants, how))
}
