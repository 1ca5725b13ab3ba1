//! What the user should know before trusting a number.

use crate::pipeline::{CloudPart, MeshPart, PoissonPart, SolvedPart};
use crate::report::common::CommonEdgeReport;
use crate::report::points::PointReport;
use crate::report::singular::singular_vertices;
use crate::report::text::{counted, place};
use crate::report::thickness::{FEWEST_ACROSS, thinnest};
use nmt_cloud::{Cloud, Section};
use nmt_geom::tol::SAME_POINT_REL;
use nmt_mfdm::{
    Formulation, HiddenBends, HoleCondition, LinearSolve, Load, SolveParams, StarChoice, StarReport, Test, Trial,
    hidden_bends,
};

/// Spacings of a larger ratio than this are warned of: the clearances, which go by the larger one, then clear whole rows of
/// nodes beside the boundary.
const UNEQUAL_SPACINGS: f64 = 2.0;

/// A subdomain with its cloud.
#[derive(Clone, Copy)]
pub(super) struct CloudView<'a> {
    pub name: &'a str,
    pub edge_names: &'a [String],
    pub section: &'a Section,
    pub cloud: &'a Cloud,
}

impl<'a> From<&'a CloudPart> for CloudView<'a> {
    fn from(part: &'a CloudPart) -> Self {
        Self { name: &part.name, edge_names: &part.edge_names, section: &part.section, cloud: &part.cloud }
    }
}

impl<'a> From<&'a MeshPart> for CloudView<'a> {
    fn from(part: &'a MeshPart) -> Self {
        Self { name: &part.name, edge_names: &part.edge_names, section: &part.section, cloud: part.mesh.cloud() }
    }
}

/// Warnings of a cloud.
pub(super) fn of_cloud(part: CloudView) -> Vec<String> {
    let CloudView { name, cloud, .. } = part;
    let mut warnings = Vec::new();
    let [h_x, h_y] = cloud.spacing();
    let ratio = h_x.max(h_y) / h_x.min(h_y);
    let cleared_by_the_larger = cloud.clearance().stretch == [1.0; 2];
    if cleared_by_the_larger && ratio > UNEQUAL_SPACINGS * (1.0 + SAME_POINT_REL) {
        // The finer density for both directions.
        let extent = cloud.boundary().envelope();
        let h = h_x.min(h_y);
        let count = |length: f64| (length / h).round() as usize + 1;
        warnings.push(format!(
            "subdomain \"{name}\": the spacings h_x and h_y differ by a factor of {ratio:.1}, which clears rows of nodes \
             beside the boundary and costs digits; nodes = [{}, {}] would make them equal, and clearance = \"scaled\" measures \
             clearances along x in h_x and along y in h_y",
            count(extent.width()),
            count(extent.height())
        ));
    }
    if let Some(spot) = thinnest(cloud) {
        warnings.push(format!(
            "subdomain \"{name}\": only {} across its thinnest part, near {}; \
             choose densities that give at least {FEWEST_ACROSS}",
            counted(spot.nodes_across, "node", "nodes"),
            place(spot.at)
        ));
    }
    warnings.extend(of_hidden_bends(part));
    warnings
}

/// Edges that bend between neighbouring nodes.
fn of_hidden_bends(CloudView { name, edge_names, section, cloud }: CloudView) -> Vec<String> {
    // An edge that has no length is told where it matters: it has no cloud.
    let bends = hidden_bends(section, cloud).unwrap_or_default();
    let warning = |HiddenBends { edge, segments, of, at, .. }: HiddenBends| {
        let edge = edge_names.get(edge.index()).map_or("", String::as_str);
        format!(
            "subdomain \"{name}\": edge \"{edge}\" bends between boundary nodes more than they show, in {segments} of its {}, \
             most near {}: what is computed is another section there, and peaks may be missed; choose larger \
             densities, nodes on that edge, refine = [{{ edge = \"{edge}\", size = … }}], or solve to a tolerance",
            counted(of, "segment", "segments"),
            place(at)
        )
    };
    bends.into_iter().map(warning).collect()
}

/// A mesh that is not sound, as one is without all steps of elimination.
pub(super) fn of_mesh(part: &MeshPart) -> Option<String> {
    let error = part.mesh.check().err()?;
    Some(format!("subdomain \"{}\": the mesh is not sound, for steps of `elim` are left out: {error}", part.name))
}

/// Warnings that need no solution: of the section, and of the condition on its holes.
pub(super) fn of_section(name: &str, section: &Section, holes: HoleCondition) -> Vec<String> {
    let mut warnings = Vec::new();
    if !section.holes.is_empty() && holes == HoleCondition::Zero {
        warnings.push(format!(
            "subdomain \"{name}\": F = 0 on its holes (holes = \"zero\", the paper's condition): 2∫F is not the torsion \
             constant of the hollow section; use holes = \"circulation\" for that"
        ));
    }
    let singular = singular_vertices(section);
    if let Some(&first) = singular.first() {
        warnings.push(format!(
            "subdomain \"{name}\": the exact τ is infinite at {}, such as {}; \
             tau_max is merely the largest at nodes there and has no limit under refinement; give the corner its fillet",
            counted(singular.len(), "re-entrant vertex", "re-entrant vertices"),
            place(first)
        ));
    }
    warnings
}

/// A warning of the section of a Poisson problem: what its corners do to u.
pub(super) fn of_corners(name: &str, section: &Section) -> Option<String> {
    let singular = singular_vertices(section);
    let first = *singular.first()?;
    Some(format!(
        "subdomain \"{name}\": the gradient of u is infinite, but for special data, at {}, such as {}: u converges slowly \
         there whatever the order; give the corner a fillet",
        counted(singular.len(), "re-entrant vertex", "re-entrant vertices"),
        place(first)
    ))
}

/// Warnings of a solution of torsion, beyond those of its section.
pub(super) fn of_solution(solved: &SolvedPart) -> Vec<String> {
    let SolvedPart { part, params, solution, estimate, .. } = solved;
    let stars = [&solution.stars, &solution.recovery_stars];
    let mut warnings = of_equations(&part.name, params, stars, ["J stays", "stresses"]);
    warnings.extend(of_linear_solve(&part.name, &solution.linear));
    warnings.extend(estimate.refused().map(|why| format!("subdomain \"{}\": no error is estimated: {why}", part.name)));
    warnings
}

/// Warnings of a solution of a Poisson problem, beyond those of its section.
pub(super) fn of_poisson(solved: &PoissonPart) -> Vec<String> {
    let PoissonPart { part, params, solution, data, .. } = solved;
    let recovery = solution.field.report();
    let mut warnings = of_equations(&part.name, params, [&solution.stars, &recovery], ["u stays", "gradients"]);
    warnings.extend(of_linear_solve(&part.name, &solution.linear));
    warnings.extend(of_boundary(solved, data.settings.boundary.is_none()));
    warnings
}

/// Boundary values that are not those of the exact solution: the errors then say nothing of the method.
fn of_boundary(solved: &PoissonPart, is_default: bool) -> Option<String> {
    let (mesh, errors) = (&solved.part.mesh, solved.errors.as_ref()?);
    let boundary = mesh.cloud().boundary();
    let flux = |segment: &nmt_geom::Segment| solved.data.fluxes.get(segment.edge.index()).is_some_and(Option::is_some);
    let with_value = boundary.segments().iter().filter(|segment| !flux(segment));
    let off = |node: usize| (solved.solution.u[node] - errors.exact[node]).abs();
    let node = with_value.map(|s| s.from.index()).max_by(|a, b| off(*a).total_cmp(&off(*b)))?;
    // With smoothing the values are not met to rounding.
    let is_met = off(node) <= SAME_POINT_REL * errors.value.scale || solved.params.smoothing > 0.0;
    let remedy = if is_default { "give `boundary` = `exact`: it is 0 by default" } else { "correct one of the two" };
    (!is_met).then(|| {
        format!(
            "subdomain \"{}\": u on the boundary differs from `exact` by {:.1e}, for example at {}; {remedy}",
            solved.part.name,
            off(node),
            place(mesh.xy()[node])
        )
    })
}

/// A warning of a fall-back to the direct solver.
fn of_linear_solve(name: &str, how: &LinearSolve) -> Option<String> {
    how.fell_back.then(|| {
        format!(
            "subdomain \"{name}\": the iterative solver did not converge, and the direct one took over, which takes more \
             time and memory; solver = \"direct\" spares the attempt"
        )
    })
}

/// Warnings of the equations: `results` is how a result is off that stays off, and what is recovered.
fn of_equations(
    name: &str,
    params: &SolveParams,
    [stars, recovery_stars]: [&StarReport; 2],
    [stays, recovered]: [&str; 2],
) -> Vec<String> {
    let mut warnings = Vec::new();
    let lowered = |n: usize| counted(n, "node", "nodes");
    if (params.formulation, params.trial, params.test) == (Formulation::Variational, Trial::Mwls, Test::Trial) {
        warnings.push(format!(
            "subdomain \"{name}\": trial = \"mwls\" with test = \"trial\", the paper's form, does not converge on irregular \
             clouds: {stays} 5 to 20 % off however many nodes there are; choose test = \"hat\", or trial = \"blended\""
        ));
    }
    if stars.wrong_sign > 0 {
        let remedy = match stars.choice {
            StarChoice::Nearest => "choose stars = \"balanced\", or more nodes there",
            StarChoice::Balanced => "choose larger stars, or more nodes there",
        };
        warnings.push(format!(
            "subdomain \"{name}\": the ∇² rows of {} have a coefficient of the wrong sign at the node itself (star_diagonal \
             in mesh.vtu shows where); {remedy}",
            lowered(stars.wrong_sign)
        ));
    }
    if stars.order_lowered > 0 {
        warnings.push(format!(
            "subdomain \"{name}\": the stars of {} carry only a polynomial of lower order; \
             choose more nodes across thin parts",
            lowered(stars.order_lowered)
        ));
    }
    if recovery_stars.order_lowered > 0 {
        warnings.push(format!(
            "subdomain \"{name}\": {recovered} at {} are recovered with a lower order; choose more nodes across thin parts",
            lowered(recovery_stars.order_lowered)
        ));
    }
    warnings
}

/// How several subdomains are solved, whether they touch or not: bars under torsion.
pub(super) const EACH_BAR: &str = "each subdomain is solved alone, with F = 0 on its whole outline; the torques of bars that are apart add up under one twist";
/// The same of a Poisson problem.
pub(super) const EACH_PROBLEM: &str =
    "each subdomain is solved alone, with its own values and fluxes; nothing joins u of one to u of another";

/// What it means that subdomains with common edges are solved each alone: in torsion, the paper's way.
pub(super) const TORSION_ALONE: &str =
    "with F = 0 on its whole outline, common edges included: their J do not add up to that of one bar";
/// The same in a Poisson problem.
pub(super) const POISSON_ALONE: &str =
    "with its own values and fluxes on common edges too: nothing makes u and its flux continue from one to the other";

/// Subdomains that share edges are solved each alone; of those that are apart, that is the solution.
pub(super) fn of_common_edges<'a>(
    names: impl Iterator<Item = &'a str>,
    common: &[CommonEdgeReport],
    alone: &str,
) -> Option<String> {
    let is_shared = |name: &&str| common.iter().any(|edge| edge.between.iter().any(|side| side == name));
    let names: Vec<String> = names.filter(is_shared).map(|name| format!("\"{name}\"")).collect();
    let (last, others) = names.split_last()?;
    Some(format!("subdomains {} and {last} have common edges, and are solved each alone, {alone}", others.join(", ")))
}

/// A torque for several subdomains.
pub(super) fn of_torque(n_subdomains: usize, load: Load) -> Option<String> {
    (n_subdomains > 1 && matches!(load, Load::Torque(_))).then(|| {
        format!(
            "each of the {n_subdomains} subdomains carries the torque, as if it were the only one; where they turn \
             together give the twist, and see what torque each carries"
        )
    })
}

/// A point outside.
pub(super) fn of_point(point: &PointReport) -> Option<String> {
    let at = place(point.at);
    point.subdomain.is_none().then(|| format!("point {at} lies outside every subdomain; its values are null"))
}
