//! What the user should know before trusting a number.

use crate::pipeline::SolvedPart;
use crate::report::model::PointReport;
use crate::report::singular::singular_vertices;
use crate::report::thickness::{FEWEST_ACROSS, thinnest};
use nmt_cloud::Cloud;
use nmt_mfdm::HoleCondition;

/// Warnings of a cloud.
pub(super) fn of_cloud(name: &str, cloud: &Cloud) -> Option<String> {
    thinnest(cloud).map(|spot| {
        let [x, y] = spot.at;
        let nodes = spot.nodes_across;
        format!(
            "subdomain \"{name}\": only {nodes} nodes across its thinnest part, near ({x:.6}, {y:.6}); \
             choose densities that give at least {FEWEST_ACROSS}"
        )
    })
}

/// Warnings of a solution.
pub(super) fn of_solution(solved: &SolvedPart) -> Vec<String> {
    let (name, solution) = (&solved.part.name, &solved.solution);
    let mut warnings = Vec::new();
    if solution.holes.iter().any(|hole| hole.condition == HoleCondition::Zero) {
        warnings.push(format!(
            "subdomain \"{name}\": F = 0 on its holes (holes = \"zero\", the paper's condition): 2∫F is not the torsion \
             constant of the hollow section; use holes = \"circulation\" for that"
        ));
    }
    let singular = singular_vertices(&solved.part.section);
    if let Some([x, y]) = singular.first() {
        warnings.push(format!(
            "subdomain \"{name}\": the exact τ is infinite at {} re-entrant {}, such as ({x:.6}, {y:.6}); \
             tau_max is the largest at nodes and grows under refinement",
            singular.len(),
            if singular.len() == 1 { "vertex" } else { "vertices" },
        ));
    }
    if solution.stars.order_lowered > 0 {
        warnings.push(format!(
            "subdomain \"{name}\": {} stars carry only a polynomial of lower order; choose more nodes across thin parts",
            solution.stars.order_lowered
        ));
    }
    if solution.recovery_stars.order_lowered > 0 {
        warnings.push(format!(
            "subdomain \"{name}\": stresses at {} nodes are recovered with a lower order; \
             choose more nodes across thin parts",
            solution.recovery_stars.order_lowered
        ));
    }
    warnings
}

/// The paper solves each subdomain alone.
pub(super) fn several_subdomains(n: usize) -> String {
    format!(
        "the {n} subdomains are solved each alone, with F = 0 on its whole outline, common edges included: \
         their J do not add up to that of one bar"
    )
}

/// A point outside.
pub(super) fn of_point(point: &PointReport) -> Option<String> {
    let [x, y] = point.at;
    point.subdomain.is_none().then(|| format!("point ({x}, {y}) lies outside every subdomain; its values are null"))
}
