//! The report as text: the paper's report of generated and deleted nodes, mesh, solver, results.

use crate::report::common::CommonEdgeReport;
use crate::report::edges;
use crate::report::model::{Report, SmoothingReport, SolutionReport, SubdomainReport};
use crate::report::points::{PointReport, PointValues};
use crate::report::poisson::{ErrorReport, PoissonReport};
use crate::report::solves::SolvesReport;
use crate::report::stars::{StarsReport, VariationalReport};
use crate::report::tolerance::{StepReport, ToleranceReport};
use nmt_mfdm::HoleCondition;
use std::fmt::Write as _;

/// Width of the left column.
const LABEL: usize = 24;

/// The report for a terminal; warnings are not in it, they belong to stderr.
pub fn text(report: &Report) -> String {
    let mut out = Text { out: String::new(), length: unit(&report.units) };
    if !report.title.is_empty() {
        out.heading(&report.title);
    }
    if let Some(solves) = &report.solves {
        out.solves(solves);
    }
    for subdomain in &report.subdomains {
        out.subdomain(subdomain);
    }
    if let Some(each) = report.each_alone {
        let _ = writeln!(out.out, "Subdomains: {each}.\n");
    }
    if let Some(common) = report.common_edges.as_ref().filter(|common| !common.is_empty()) {
        out.common_edges(common);
    }
    if let Some(points) = report.points.as_ref().filter(|points| !points.is_empty()) {
        out.points(points);
    }
    out.out
}

fn unit(units: &str) -> impl Fn(i32) -> String + use<> {
    let units = units.to_owned();
    move |power| match (units.as_str(), power) {
        ("", _) | (_, 0) => String::new(),
        (unit, 1) => format!(" {unit}"),
        (unit, 2) => format!(" {unit}²"),
        (unit, 3) => format!(" {unit}³"),
        (unit, 4) => format!(" {unit}⁴"),
        (unit, power) => format!(" {unit}^{power}"),
    }
}

struct Text<U: Fn(i32) -> String> {
    out: String,
    length: U,
}

impl<U: Fn(i32) -> String> Text<U> {
    fn heading(&mut self, title: &str) {
        let line = "─".repeat(title.chars().count());
        // Writing to a string cannot fail.
        let _ = writeln!(self.out, "{title}\n{line}");
    }

    fn row(&mut self, label: &str, value: impl std::fmt::Display) {
        let padding = " ".repeat(LABEL.saturating_sub(label.chars().count()));
        let _ = writeln!(self.out, "  {label}{padding}{value}");
    }

    fn subdomain(&mut self, s: &SubdomainReport) {
        let (u1, u2) = ((self.length)(1), (self.length)(2));
        let _ = writeln!(self.out, "Subdomain \"{}\"", s.name);
        let census = &s.census;
        let interior = s.nodes - s.boundary_nodes;
        self.row("nodes", format!("{} ({} on the boundary, {interior} inside)", s.nodes, s.boundary_nodes));
        match &s.local_spacing {
            None => self.row("spacing h_x, h_y", format!("{}, {}{u1}", number(s.spacing[0]), number(s.spacing[1]))),
            Some(local) => {
                self.row("spacing", format!("{} to {}{u1}, graded", number(local.min), number(local.max)));
                if let Some(a) = &local.achieved {
                    let ratios = format!("min {:.2}, median {:.2}, max {:.2}", a.min, a.median, a.max);
                    self.row("achieved / asked", ratios);
                }
            }
        }
        self.row(
            "grid points",
            format!(
                "{}: {} outside, {} in holes, {} too near to an edge, {} too near to a boundary node, {} kept",
                census.grid, census.outside, census.in_hole, census.near_edge, census.near_node, census.kept
            ),
        );
        for division in &s.divisions {
            self.row(
                &format!("edge \"{}\"", division.edge),
                format!(
                    "in chords of {}{u1}: {} left out, closing error {} ({:.1} %)",
                    number(division.chord),
                    counted(division.left_out, "node", "nodes"),
                    number(division.closing_error),
                    100.0 * division.closing_error / division.chord
                ),
            );
        }
        if let Some(q) = &s.cloud_quality {
            self.row(
                "spread of nodes",
                format!(
                    "separation {}{u1}, fill distance {}{u1}, ratio {:.2}, nearest-node distance varies by {:.1} %",
                    number(q.separation),
                    number(q.fill_distance),
                    q.ratio,
                    100.0 * q.nearest_variation
                ),
            );
        }
        if let Some(triangles) = s.triangles {
            let census = s.mesh.filter(|census| census.method != "constrained");
            let steps = census.map_or(String::new(), |c| {
                format!(
                    " ({}: {} Delaunay, {} outside, {} in holes, {} tiny, {} crossing dropped, {} added)",
                    c.method, c.delaunay, c.outside, c.in_hole, c.tiny, c.crossing, c.completed
                )
            });
            self.row("triangles", format!("{triangles}{steps}"));
        }
        self.row("area", format!("{}{u2}", number(s.area)));
        self.row("centroid", place(s.centroid));
        if let Some(SmoothingReport { sweeps, quality_before: q }) = &s.smoothing {
            let before = format!("min {:.3}, mean {:.3}, smallest angle {:.1}°", q.min, q.mean, q.min_angle_deg);
            self.row("quality before", format!("{before} ({} of smoothing)", counted(*sweeps, "sweep", "sweeps")));
        }
        if let Some(q) = &s.quality {
            self.row(
                "quality",
                format!("min {:.3}, mean {:.3}, smallest angle {:.1}°", q.min, q.mean, q.min_angle_deg),
            );
        }
        if let Some(solution) = &s.solution {
            self.solution(solution);
        }
        if let Some(poisson) = &s.poisson {
            self.poisson(poisson);
        }
        self.out.push('\n');
    }

    fn solution(&mut self, s: &SolutionReport) {
        let (u2, u3, u4) = ((self.length)(2), (self.length)(3), (self.length)(4));
        self.formulation(s.formulation, s.order, s.variational, s.unknowns);
        if let Some(stars) = &s.stars {
            self.stars(stars);
        }
        self.row("linear solver", s.linear_solver.line(s.linear_residual));
        for hole in &s.holes {
            let label = format!("hole \"{}\"", hole.name);
            self.row(&label, format!("{}, F = {}, area {}{u2}", hole.condition, number(hole.f), number(hole.area)));
        }
        let is_zero = s.holes.iter().any(|hole| hole.condition == HoleCondition::Zero.name());
        let meaning = if is_zero { "2∫F/(Gθ), for F = 0 on holes" } else { "torsion constant" };
        self.row("J = T/(Gθ)", format!("{}{u4}, {meaning}", number(s.j)));
        if let Some(estimate) = &s.error_estimate {
            self.row("J by bounds", estimate.bounds(&u4));
            self.row("estimated errors", estimate.errors());
        }
        if let Some(tolerance) = &s.tolerance {
            self.steps(tolerance);
        }
        self.row("torque T", number(s.torque));
        self.row("twist θ", number(s.twist));
        self.row("W_t = T/τ_max", format!("{}{u3}, torsional section modulus", number(s.w_t)));
        self.row("F_max", format!("{} at {}", number(s.f_max), place(s.f_max_at)));
        let grows =
            if s.tau_singular_at.is_empty() { "" } else { " (largest at nodes; infinite at re-entrant vertices)" };
        self.row("τ_max", format!("{} at {}{grows}", number(s.tau_max), place(s.tau_max_at)));
        for around in &s.loops {
            self.row(&format!("∮τ ds, {}", around.name), edges::circulation(around));
        }
        let rows = edges::rows(&s.edges, &(self.length)(1));
        let _ = writeln!(self.out, "  τ along edges");
        self.table("    ", &rows);
    }

    /// The way to a tolerance.
    fn steps(&mut self, tolerance: &ToleranceReport) {
        let verdict = if tolerance.reached { "reached" } else { "not reached" };
        self.row(
            "tolerance",
            format!("{:e} of J, {verdict} on {}", tolerance.asked, counted(tolerance.steps.len(), "cloud", "clouds")),
        );
        let heads = ["nodes", "J", "estimated error", "seconds"].map(str::to_owned);
        let row = |step: &StepReport| {
            let error = step.error.map_or("none, too coarse".to_owned(), |error| format!("{error:.1e}"));
            [step.nodes.to_string(), number(step.j), error, format!("{:.3}", step.seconds)]
        };
        let rows: Vec<[String; 4]> = std::iter::once(heads).chain(tolerance.steps.iter().map(row)).collect();
        self.table("    ", &rows);
        if let Some(stop) = &tolerance.stop {
            self.row("why no further", stop.clone());
        }
    }

    fn formulation(&mut self, name: &str, order: usize, variational: Option<VariationalReport>, unknowns: usize) {
        let functions = variational.map_or(String::new(), |v| {
            format!(", trial {}, test {}, {}", v.trial, v.test, counted(v.gauss, "Gauss point", "Gauss points"))
        });
        self.row("formulation", format!("{name}, order {order}{functions}, {unknowns} unknowns"));
    }

    fn poisson(&mut self, s: &PoissonReport) {
        self.row("Poisson problem", format!("∇²u = {}; u = {} on edges without a flux", s.source, s.boundary));
        self.formulation(s.formulation, s.order, s.variational, s.unknowns);
        if let Some(stars) = &s.stars {
            self.stars(stars);
        }
        self.row("linear solver", s.linear_solver.line(s.linear_residual));
        for flux in &s.fluxes {
            let integral = flux.integral.map_or(String::new(), |sum| format!(", ∫ ds = {}", number(sum)));
            self.row(&format!("flux on \"{}\"", flux.edge), format!("∂u/∂n = {}{integral}", flux.neumann));
        }
        self.row("u_min", format!("{} at {}", number(s.u_min), place(s.u_min_at)));
        self.row("u_max", format!("{} at {}", number(s.u_max), place(s.u_max_at)));
        if let (Some(exact), Some(errors)) = (&s.exact, &s.errors) {
            self.row("exact u", exact);
            self.errors(errors);
        }
    }

    fn errors(&mut self, e: &ErrorReport) {
        let relative = |error: Option<f64>| error.map_or(String::new(), |error| format!(", relative {error:.2e}"));
        self.row("error at nodes", format!("{:.2e}{}", e.max, relative(e.max_relative)));
        self.row("error in L²", format!("{:.2e}{}", e.l2, relative(e.l2_relative)));
        if let (Some(max), Some(h1)) = (e.gradient_max, e.h1) {
            let h1 = format!("{h1:.2e}{}", relative(e.h1_relative));
            self.row("error of ∇u", format!("{max:.2e} at nodes; in L² {h1}"));
        }
    }

    fn solves(&mut self, solves: &SolvesReport) {
        let line = match solves {
            SolvesReport::Torsion { twist, torque, holes } => {
                let load = twist.map(|twist| format!("twist θ = {}", number(twist)));
                let load = load.or(torque.map(|torque| format!("torque T = {}", number(torque)))).unwrap_or_default();
                format!("Torsion, ∇²F = −2Gθ, {load}, holes by {holes}")
            }
            SolvesReport::Poisson { source, boundary, fluxes, exact } => {
                let exact = exact.as_ref().map_or(String::new(), |u| format!("; exact u = {u}"));
                let fluxes = counted(*fluxes, "edge with a flux", "edges with a flux");
                format!("Poisson problem, ∇²u = {source}, {fluxes}, u = {boundary} on the others{exact}")
            }
        };
        let _ = writeln!(self.out, "{line}");
    }

    /// The paper's topological matrix.
    fn common_edges(&mut self, common: &[CommonEdgeReport]) {
        let heads = ["subdomains", "edges", "from", "to", "nodes", "conforming"].map(str::to_owned);
        let row = |edge: &CommonEdgeReport| {
            let nodes = edge.nodes.map(|n| n.to_string()).join(", ");
            let conforming = if edge.conforming { "yes" } else { "no" }.to_owned();
            [edge.between.join(", "), edge.edges.join(", "), place(edge.from), place(edge.to), nodes, conforming]
        };
        let rows: Vec<[String; 6]> = std::iter::once(heads).chain(common.iter().map(row)).collect();
        let _ = writeln!(self.out, "Common edges");
        self.table("  ", &rows);
        self.out.push('\n');
    }

    /// Rows in columns as wide as their widest cell.
    fn table(&mut self, indent: &str, rows: &[impl AsRef<[String]>]) {
        let width = |column: usize| {
            let cells = rows.iter().filter_map(|row| row.as_ref().get(column));
            cells.map(|cell| cell.chars().count()).max().unwrap_or(0)
        };
        for row in rows {
            let cells = row.as_ref().iter().enumerate().map(|(column, cell)| format!("{cell:w$}", w = width(column)));
            let line = cells.collect::<Vec<_>>().join("   ");
            let _ = writeln!(self.out, "{indent}{}", line.trim_end());
        }
    }

    fn stars(&mut self, s: &StarsReport) {
        let smoothing = s.smoothing.map_or(String::new(), |g| format!(", smoothing {}", number(g)));
        let graded = if s.for_graded_cloud { ", for the cloud is graded" } else { "" };
        let sign = if s.wrong_sign > 0 { format!(", {} of wrong sign", s.wrong_sign) } else { String::new() };
        self.row(
            "stars",
            format!(
                "of {} nodes, {}{graded}{smoothing}: {} enlarged, {} of lower order{sign}, {} hidden nodes skipped, worst condition {:.1}",
                s.size, s.choice, s.enlarged, s.order_lowered, s.hidden_nodes_skipped, s.worst_condition
            ),
        );
    }

    fn points(&mut self, points: &[PointReport]) {
        let _ = writeln!(self.out, "Points");
        for point in points {
            let label = place(point.at);
            let values = match point.values {
                PointValues::Torsion { f: Some(f), tau_zx: Some(zx), tau_zy: Some(zy), tau: Some(tau) } => {
                    let [f, zx, zy, tau] = [f, zx, zy, tau].map(number);
                    Some(format!("F = {f}, τ_zx = {zx}, τ_zy = {zy}, τ = {tau}"))
                }
                PointValues::Poisson { u: Some(u), u_x: Some(x), u_y: Some(y) } => {
                    let [u, x, y] = [u, x, y].map(number);
                    Some(format!("u = {u}, ∂u/∂x = {x}, ∂u/∂y = {y}"))
                }
                _ => None,
            };
            match (values, &point.subdomain) {
                (Some(values), Some(name)) => self.row(&label, format!("{values}   in \"{name}\"")),
                _ => self.row(&label, "outside"),
            }
        }
        self.out.push('\n');
    }
}

/// A count with its noun.
pub(super) fn counted(n: usize, one: &str, many: &str) -> String {
    format!("{n} {}", if n == 1 { one } else { many })
}

/// A point as text, each coordinate with seven significant digits.
pub fn place([x, y]: [f64; 2]) -> String {
    format!("({}, {})", number(x), number(y))
}

/// Seven significant digits, with an exponent where zeros would hide them.
pub(super) fn number(v: f64) -> String {
    significant(v, 7)
}

/// A number of so many significant digits, without trailing zeros where it is written out; very large and very small ones have
/// an exponent.
pub fn significant(v: f64, digits: usize) -> String {
    let (size, last) = (v.abs(), digits.saturating_sub(1));
    if size == 0.0 {
        "0".into()
    } else if (1e-4..1e7).contains(&size) {
        let decimals = (last as i32 - size.log10().floor() as i32).max(0) as usize;
        let text = format!("{v:.decimals$}");
        if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').into() } else { text }
    } else {
        format!("{v:.last$e}")
    }
}

#[cfg(test)]
mod tests {
    use super::number;

    #[test]
    fn numbers_have_seven_significant_digits_and_no_trailing_zeros() {
        let shown = [0.0, 1.0, -0.25, 0.140_577_014_9, 123_456.789, 1.5e-9, 2.0e12].map(number);
        assert_eq!(shown, ["0", "1", "-0.25", "0.140577", "123456.8", "1.500000e-9", "2.000000e12"]);
    }
}
