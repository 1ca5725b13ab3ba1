//! Wishes for the spacing that change nothing, told instead of passed over.

use crate::problem::GradingSettings;
use crate::report::text::{number, place};
use nmt_cloud::{Cloud, Refinement, Target};
use nmt_geom::segment::distance_to;
use nmt_geom::{Location, NodeId, Point};

/// Warnings of `density` and of each item of `refine` that nowhere ask for less than the uniform spacing, and of a `growth` alone
/// where nothing grows; `to_a_tolerance` tells that more may be refined.
pub(super) fn without_effect(name: &str, asked: &GradingSettings, cloud: &Cloud, to_a_tolerance: bool) -> Vec<String> {
    let Some(lattice) = cloud.nested_lattice() else { return Vec::new() };
    let most = lattice.max_spacing();
    let mut warnings = Vec::new();
    let uniform = number(most);
    let is_alone = asked.density.is_none() && asked.refine.is_empty();
    let is_even = || (0..cloud.n_nodes()).all(|node| cloud.local_spacing(NodeId::of(node)) >= most);
    if is_alone && !to_a_tolerance && is_even() {
        warnings.push(format!(
            "subdomain \"{name}\": `growth` does nothing: no edge is shorter than the uniform spacing of `nodes`, {uniform}, from which \
             the spacing could grow; add `density`, `refine` or a tolerance, or leave it out"
        ));
    }
    if let Some(density) = &asked.density {
        let nodes = cloud.xy().iter();
        let least = nodes.map(|p| density.expression.eval(p)).fold(f64::INFINITY, f64::min);
        if cloud.may_miss_dips() {
            warnings.push(format!(
                "subdomain \"{name}\": `density` varies too much on too small a scale to be looked into everywhere: places where it is \
                 much smaller than around may have been passed over; smooth it, or add `refine` where they are"
            ));
        } else if least >= most && (!asked.refine.is_empty() || is_even()) {
            // A narrow dip has effects beside it, though no node need lie in it.
            warnings.push(format!(
                "subdomain \"{name}\": `density` does nothing: it is {} or more, and the uniform spacing of `nodes` is {uniform} \
                 already; let it ask for less somewhere, or leave it out",
                number(least)
            ));
        }
    }
    for (k, Refinement { target, size, growth }) in asked.refine.iter().enumerate() {
        let item = k + 1;
        if *size >= most {
            warnings.push(format!(
                "subdomain \"{name}\": `refine` item {item} does nothing: its size is {}, and the uniform spacing of `nodes` is \
                 {uniform} already; give a smaller size, or leave it out",
                number(*size)
            ));
            continue;
        }
        let Target::Point(p) = target else { continue };
        let away = distance_from(cloud, *p);
        if size + growth * away >= most {
            warnings.push(format!(
                "subdomain \"{name}\": `refine` item {item} does nothing: its point {} lies {} outside the section, where the \
                 spacing has grown back to the uniform one, {uniform}; correct the point, or let it grow more slowly",
                place(*p),
                number(away)
            ));
        }
    }
    warnings
}

/// How far `p` is from the section, 0 inside.
fn distance_from(cloud: &Cloud, p: Point) -> f64 {
    let boundary = cloud.boundary();
    match boundary.index().locate(p) {
        Location::Inside | Location::OnBoundary => 0.0,
        Location::Outside => boundary.all_ends().map(|[a, b]| distance_to(p, a, b)).fold(f64::INFINITY, f64::min),
    }
}
