//! The stages in a row, one call each: the file to read first.
//!
//! problem file → clouds → meshes → solutions. Each function takes what the one before gave; [`solve_problem`] calls
//! them all.

mod adapt;
mod estimate;
mod poisson;

pub use adapt::{Step, Stop, to_tolerance};
pub use estimate::Estimated;
pub use poisson::{PoissonData, PoissonErrors, PoissonPart, poisson_solutions};
pub(crate) use poisson::{poisson_on, solve_on};

use crate::error::NmtError;
use crate::problem::GradingSettings;
use crate::problem::{MeshMethod, MeshSettings, Problem, Subdomain};
use crate::report::place;
use nmt_cloud::{Cloud, CloudError, CloudParams, Grading, Refinement, Section, SpacingFunction, generate};
use nmt_geom::Bbox;
use nmt_merge::{EdgeNodes, Planned, conform};
use nmt_mfdm::{Formulation, MfdmError, SolveParams, TorsionProblem, TorsionSolution};
use nmt_tri::{Mesh, MeshCensus, Quality, quality, smooth};

/// A stage of the pipeline.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Boundary and interior nodes.
    Cloud,
    /// Triangulation.
    Mesh,
    /// Stars and rows.
    Stencils,
    /// The linear system.
    Assemble,
    /// Its solution.
    Solve,
    /// Recovery and results.
    Post,
    /// How far the results may be off.
    Estimate,
}

/// What an observer is told, so that whoever calls holds the clock and shows how far it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Event {
    /// A stage begins. In the variational form stars and equations take turns, some ten thousand nodes at a time.
    Begun(Stage),
    /// A stage has ended.
    Ended(Stage),
    /// Of the stage under way, so many nodes are done.
    Nodes {
        /// Nodes that are done.
        done: usize,
        /// Nodes in all.
        of: usize,
    },
    /// One more iteration of the linear solver; several right sides, one a hole, are solved two at a time, and the larger
    /// residual is told.
    Iteration {
        /// Iterations for this right side.
        iterations: usize,
        /// ‖b − Ax‖/‖b‖, from 1.
        residual: f64,
        /// The residual that it goes on to.
        target: f64,
    },
    /// One more solution on the way to a tolerance.
    Step(Step),
}

/// Told the subdomain (by its number) and what has happened there.
pub type Observer<'a> = dyn FnMut(usize, Event) + 'a;

/// One subdomain with its cloud.
#[derive(Clone, Debug)]
pub struct CloudPart {
    /// The subdomain's name.
    pub name: String,
    /// Name of every edge by [`nmt_geom::EdgeId`].
    pub edge_names: Vec<String>,
    /// Name of every hole.
    pub hole_names: Vec<String>,
    /// Its outlines.
    pub section: Section,
    /// Its nodes.
    pub cloud: Cloud,
}

/// One subdomain with its mesh.
#[derive(Clone, Debug)]
pub struct MeshPart {
    /// The subdomain's name.
    pub name: String,
    /// Name of every edge by [`nmt_geom::EdgeId`].
    pub edge_names: Vec<String>,
    /// Name of every hole.
    pub hole_names: Vec<String>,
    /// Its outlines.
    pub section: Section,
    /// Its triangles, and through them its cloud.
    pub mesh: Mesh,
    /// How it was triangulated.
    pub method: MeshMethod,
    /// Triangles by what became of them; the constrained way has none to drop or add.
    pub census: MeshCensus,
    /// What smoothing started from, where there was any.
    pub smoothing: Option<Smoothing>,
}

/// How a cloud was smoothed.
#[derive(Clone, Debug, PartialEq)]
pub struct Smoothing {
    /// Sweeps over the interior nodes.
    pub sweeps: usize,
    /// Quality of the mesh before.
    pub before: Quality,
}

/// One subdomain solved.
#[derive(Clone, Debug)]
pub struct SolvedPart {
    /// The subdomain with its mesh.
    pub part: MeshPart,
    /// How it was solved: formulation, order, stars.
    pub params: SolveParams,
    /// The solution.
    pub solution: TorsionSolution,
    /// How far it may be off.
    pub estimate: Estimated,
    /// The solutions on the way to a tolerance, this one the best of them; empty where the problem has no tolerance.
    pub history: Vec<Step>,
    /// Why the tolerance is not met; `None` where it is, or where there is none.
    pub stop: Option<Stop>,
}

/// All subdomains solved: what the problem file asks for.
#[derive(Clone, Debug)]
pub enum Solved {
    /// Torsion.
    Torsion(Vec<SolvedPart>),
    /// A Poisson problem.
    Poisson(Vec<PoissonPart>),
}

impl Solved {
    /// The subdomains with their meshes.
    pub fn parts(&self) -> Vec<&MeshPart> {
        match self {
            Self::Torsion(parts) => parts.iter().map(|solved| &solved.part).collect(),
            Self::Poisson(parts) => parts.iter().map(|solved| &solved.part).collect(),
        }
    }
}

/// Clouds of all subdomains, in the order of the file.
///
/// # Errors
/// Every subdomain's fault that shows only when nodes are placed, with its place in the file.
pub fn clouds(problem: &Problem, observer: &mut Observer) -> Result<Vec<CloudPart>, NmtError> {
    let finer = Finer::none(problem);
    clouds_of(problem, &finer, &vec![true; problem.subdomains.len()], observer)
}

/// Refinements beyond those of the file, by subdomain.
#[derive(Clone, Debug)]
pub(crate) struct Finer(pub Vec<Vec<Refinement>>);

impl Finer {
    fn none(problem: &Problem) -> Self {
        Self(vec![Vec::new(); problem.subdomains.len()])
    }
}

/// Clouds of the subdomains that are `wanted`, refined beyond the file.
fn clouds_of(
    problem: &Problem,
    finer: &Finer,
    wanted: &[bool],
    observer: &mut Observer,
) -> Result<Vec<CloudPart>, NmtError> {
    let mut parts = Vec::with_capacity(problem.subdomains.len());
    let mut faults = Vec::new();
    let shared = shared_nodes(problem, finer);
    for (k, subdomain) in problem.subdomains.iter().enumerate().filter(|(k, _)| wanted[*k]) {
        observer(k, Event::Begun(Stage::Cloud));
        let section = section(subdomain);
        let edge_nodes = shared.get(k).cloned().unwrap_or_default();
        match generate(&section, &CloudParams { edge_nodes, ..refined_params(problem, finer, k) }) {
            Ok(cloud) => parts.push(CloudPart {
                name: subdomain.name.clone(),
                edge_names: section.edge_names(),
                hole_names: subdomain.holes.iter().map(|hole| hole.name.clone()).collect(),
                section,
                cloud,
            }),
            Err(error) => faults.push(cloud_fault(problem, subdomain, error)),
        }
        observer(k, Event::Ended(Stage::Cloud));
    }
    faults.extend(problem.subdomains.iter().filter_map(|subdomain| star_fault(problem, subdomain, &parts)));
    if faults.is_empty() { Ok(parts) } else { Err(NmtError::Problem(faults)) }
}

/// How the cloud of subdomain `k` is made, refined beyond the file.
fn refined_params(problem: &Problem, finer: &Finer, k: usize) -> CloudParams {
    let mut params = cloud_params(problem, &problem.subdomains[k]);
    if !finer.0[k].is_empty() {
        params.grading.get_or_insert_default().refinements.extend(&finer.0[k]);
    }
    params
}

/// Nodes that both sides of the common edges of conforming subdomains have; empty where there are none.
fn shared_nodes(problem: &Problem, finer: &Finer) -> Vec<EdgeNodes> {
    if problem.subdomains.len() < 2 || !problem.subdomains.iter().any(|subdomain| subdomain.conforming) {
        return Vec::new();
    }
    let sections: Vec<Section> = problem.subdomains.iter().map(section).collect();
    let params: Vec<CloudParams> = (0..sections.len()).map(|k| refined_params(problem, finer, k)).collect();
    let planned = |(k, subdomain): (usize, &Subdomain)| Planned {
        section: &sections[k],
        params: &params[k],
        conforming: subdomain.conforming,
    };
    let planned: Vec<Planned> = problem.subdomains.iter().enumerate().map(planned).collect();
    // An edge that has no length is told, with its place, when its cloud is generated.
    conform(&planned).unwrap_or_default()
}

/// The outlines of a subdomain, as its cloud is made from them.
pub fn section(subdomain: &Subdomain) -> Section {
    Section {
        contour: subdomain.contour.clone(),
        holes: subdomain.holes.iter().map(|hole| hole.outline.clone()).collect(),
    }
}

/// Density, irregularity and clearances of a subdomain, as its cloud is made with them.
pub fn cloud_params(problem: &Problem, subdomain: &Subdomain) -> CloudParams {
    CloudParams {
        nodes: subdomain.nodes,
        hole_nodes: subdomain.holes.iter().map(|hole| hole.nodes).collect(),
        edge_nodes: Vec::new(),
        grading: subdomain.grading.as_ref().map(grading),
        division: subdomain.division,
        irregularity: subdomain.irregularity,
        seed: problem.solve.seed,
        clearance: subdomain.clearance,
        edge_clearance: subdomain.edge_clearance,
        node_clearance: subdomain.node_clearance,
    }
}

/// How the spacing varies, as the cloud takes it.
fn grading(settings: &GradingSettings) -> Grading {
    let function = settings.density.as_ref().map(|density| {
        let (formula, same) = (density.expression.clone(), density.expression.clone());
        let bound = move |Bbox { min, max }, enough| same.lower_bound(&[[min[0], max[0]], [min[1], max[1]]], enough);
        SpacingFunction::new(move |p| formula.eval(&p)).with_lower_bound(bound)
    });
    Grading { function, growth: settings.growth, refinements: settings.refine.clone() }
}

/// A fault of the cloud in the terms of the file.
fn cloud_fault(problem: &Problem, subdomain: &Subdomain, error: CloudError) -> crate::problem::ProblemError {
    let item = format!("subdomain \"{}\"", subdomain.name);
    let grading_place = subdomain.grading.as_ref().map_or(&subdomain.nodes_place, |grading| &grading.place);
    let at = |place, message: String, remedy: String| problem.source.error(place, &item, message, remedy);
    match error {
        CloudError::NoInterior { remedy } => at(grading_place, "the cloud has no interior node".into(), remedy),
        CloudError::BoundaryCrosses { at: p, remedy } => at(
            grading_place,
            format!(
                "the polygon through the boundary nodes crosses itself near {}: too few nodes for the curves",
                place(p)
            ),
            remedy,
        ),
        CloudError::Edge { edge, source } => {
            let places = subdomain.edge_places.iter().chain(subdomain.holes.iter().flat_map(|h| &h.edge_places));
            let place = places.clone().nth(edge).unwrap_or(&subdomain.place);
            at(place, source.to_string(), "correct this edge".into())
        }
        CloudError::NotASpacing { at: p, value } => {
            let density = subdomain.grading.as_ref().and_then(|grading| grading.density.as_ref());
            let message = format!("`density` is {value} at {}, where a spacing must be a positive number", place(p));
            let remedy = match value <= 0.0 {
                true => "give it a least value, for example max(…, 0.001)",
                false => "correct the formula, so that it is finite everywhere in the subdomain",
            };
            at(density.map_or(grading_place, |density| &density.place), message, remedy.into())
        }
        CloudError::TooFine { spacing, limit, place } => {
            let message =
                format!("with spacings down to {spacing:.1e} there would be more than {limit:.0e} nodes{place}");
            at(grading_place, message, "ask for larger ones, or let them grow faster".into())
        }
        other => at(&subdomain.nodes_place, other.to_string(), "choose other densities".into()),
    }
}

/// A star that the user chose larger than the cloud; finite elements have none.
fn star_fault(problem: &Problem, subdomain: &Subdomain, parts: &[CloudPart]) -> Option<crate::problem::ProblemError> {
    let (star, place) = (problem.solve.star?, problem.solve.star_place.as_ref()?);
    let part = parts.iter().find(|part| part.name == subdomain.name)?;
    if problem.solve.params(subdomain.formulation).formulation == Formulation::Fem {
        return None;
    }
    let n_nodes = part.cloud.n_nodes();
    (star > n_nodes).then(|| {
        let message = format!("star = {star} is larger than the cloud of subdomain \"{}\", {n_nodes} nodes", part.name);
        problem.source.error(place, "[solve]", message, format!("choose at most {n_nodes}, or more nodes"))
    })
}

/// Meshes of all subdomains.
///
/// # Errors
/// [`NmtError::Mesh`] where a cloud cannot be triangulated.
pub fn meshes(problem: &Problem, clouds: Vec<CloudPart>, observer: &mut Observer) -> Result<Vec<MeshPart>, NmtError> {
    clouds.into_iter().enumerate().map(|(k, part)| mesh_of(problem, k, part, observer)).collect()
}

/// The mesh of subdomain `k`.
fn mesh_of(problem: &Problem, k: usize, part: CloudPart, observer: &mut Observer) -> Result<MeshPart, NmtError> {
    let MeshSettings { method, elimination, smooth: sweeps, .. } = &problem.mesh;
    let CloudPart { name, edge_names, hole_names, section, cloud } = part;
    let failed = |source| NmtError::Mesh { subdomain: name.clone(), source };
    let triangulate = |cloud: Cloud| match method {
        MeshMethod::Constrained => Mesh::constrained(cloud).map(|mesh| {
            let census = MeshCensus { delaunay: mesh.n_triangles(), ..MeshCensus::default() };
            (mesh, census)
        }),
        MeshMethod::Unconstrained => Mesh::unconstrained(cloud, elimination),
    };
    observer(k, Event::Begun(Stage::Mesh));
    let (mut mesh, mut census) = triangulate(cloud).map_err(failed)?;
    let before = (*sweeps > 0).then(|| quality(&mesh)).flatten();
    if before.is_some() {
        (mesh, census) = triangulate(smooth(&mesh, *sweeps)).map_err(failed)?;
    }
    let smoothing = before.map(|before| Smoothing { sweeps: *sweeps, before });
    observer(k, Event::Ended(Stage::Mesh));
    Ok(MeshPart { name, edge_names, hole_names, section, mesh, method: *method, census, smoothing })
}

/// Solutions of all subdomains, of torsion or of a Poisson problem, as the file has it.
///
/// # Errors
/// As [`solutions`] and [`poisson_solutions`].
pub fn solved(problem: &Problem, meshes: Vec<MeshPart>, observer: &mut Observer) -> Result<Solved, NmtError> {
    match problem.solve.poisson {
        None => solutions(problem, meshes, observer).map(Solved::Torsion),
        Some(_) => poisson_solutions(problem, meshes, observer).map(Solved::Poisson),
    }
}

/// Solutions of torsion in all subdomains, each alone with F = 0 on its whole outline.
///
/// # Errors
/// [`NmtError::Solve`] where the numerics fail; [`NmtError::Problem`] where steps of elimination are left out and the mesh
/// is not sound without them, or where it is a Poisson problem.
pub fn solutions(
    problem: &Problem,
    meshes: Vec<MeshPart>,
    observer: &mut Observer,
) -> Result<Vec<SolvedPart>, NmtError> {
    if let Some(fault) = torsion_fault(problem, "has no torsion", "leave it out, or call solve_any") {
        return Err(NmtError::Problem(vec![fault]));
    }
    if let Some(fault) = meshes.iter().find_map(|part| elimination_fault(problem, part)) {
        return Err(NmtError::Problem(vec![fault]));
    }
    meshes.into_iter().enumerate().map(|(k, part)| solution_of(problem, k, part, observer)).collect()
}

/// The solution of torsion in subdomain `k`.
fn solution_of(problem: &Problem, k: usize, part: MeshPart, observer: &mut Observer) -> Result<SolvedPart, NmtError> {
    let subdomain = &problem.subdomains[k];
    let params = problem.solve.params(subdomain.formulation);
    let (solution, estimate) = estimate::solve_part((k, problem), (&part, &params), observer)
        .map_err(|source: MfdmError| NmtError::Solve { subdomain: part.name.clone(), source })?;
    Ok(SolvedPart { part, params, solution, estimate, history: Vec::new(), stop: None })
}

/// The torsion problem of a subdomain.
pub(crate) fn torsion(problem: &Problem, subdomain: &Subdomain) -> TorsionProblem {
    TorsionProblem { shear_modulus: subdomain.shear_modulus, load: problem.solve.load, holes: problem.solve.holes }
}

/// A Poisson problem where torsion is asked for: what it `does` instead of that, and the remedy.
pub(crate) fn torsion_fault(problem: &Problem, does: &str, remedy: &str) -> Option<crate::problem::ProblemError> {
    let source = &problem.solve.poisson.as_ref()?.source;
    let message = format!("`source` makes this a Poisson problem, which {does}");
    Some(problem.source.error(&source.place, "", message, remedy))
}

/// A mesh that is not sound since steps were left out.
pub(crate) fn elimination_fault(problem: &Problem, part: &MeshPart) -> Option<crate::problem::ProblemError> {
    let place = problem.mesh.elimination_place.as_ref().filter(|_| !problem.mesh.elimination.is_whole())?;
    let error = part.mesh.check().err()?;
    let message =
        format!("without all steps of `elim` the mesh of subdomain \"{}\" cannot be solved on: {error}", part.name);
    Some(problem.source.error(place, "[mesh]", message, "leave `elim` out"))
}

/// Tells what nmt-mfdm tells of a solution of subdomain `k`.
pub(crate) fn of_solution<'a>(k: usize, observer: &'a mut Observer) -> impl FnMut(nmt_mfdm::Event) + 'a {
    move |event| {
        let event = match event {
            nmt_mfdm::Event::Begun(stage) => Event::Begun(stage.into()),
            nmt_mfdm::Event::Ended(stage) => Event::Ended(stage.into()),
            nmt_mfdm::Event::Nodes { done, of } => Event::Nodes { done, of },
            nmt_mfdm::Event::Iteration { iterations, residual, target } => {
                Event::Iteration { iterations, residual, target }
            }
        };
        observer(k, event);
    }
}

impl From<nmt_mfdm::Stage> for Stage {
    fn from(stage: nmt_mfdm::Stage) -> Self {
        match stage {
            nmt_mfdm::Stage::Stencils => Self::Stencils,
            nmt_mfdm::Stage::Assemble => Self::Assemble,
            nmt_mfdm::Stage::Solve => Self::Solve,
            nmt_mfdm::Stage::Post => Self::Post,
            nmt_mfdm::Stage::Estimate => Self::Estimate,
        }
    }
}

/// From a checked problem of torsion to the solutions of its subdomains; where it has a tolerance, by [`to_tolerance`].
///
/// # Errors
/// [`NmtError`] of the first stage that fails.
pub fn solve_problem(problem: &Problem) -> Result<Vec<SolvedPart>, NmtError> {
    let observer: &mut Observer = &mut |_, _| {};
    if let Some(tolerance) = problem.solve.tolerance {
        return to_tolerance(problem, tolerance, observer);
    }
    let clouds = clouds(problem, observer)?;
    let meshes = meshes(problem, clouds, observer)?;
    solutions(problem, meshes, observer)
}

/// From a checked problem, of torsion or of Poisson, to what it asks for.
///
/// # Errors
/// [`NmtError`] of the first stage that fails.
pub fn solve_any(problem: &Problem) -> Result<Solved, NmtError> {
    solve_any_observed(problem, &mut |_, _| {})
}

/// [`solve_any`], telling `observer` how far it is.
///
/// # Errors
/// As [`solve_any`].
pub fn solve_any_observed(problem: &Problem, observer: &mut Observer) -> Result<Solved, NmtError> {
    if let Some(tolerance) = problem.solve.tolerance {
        return to_tolerance(problem, tolerance, observer).map(Solved::Torsion);
    }
    let clouds = clouds(problem, observer)?;
    let meshes = meshes(problem, clouds, observer)?;
    solved(problem, meshes, observer)
}
