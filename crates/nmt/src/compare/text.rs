//! The comparison as a table, one a subdomain and cloud.

use super::{Comparison, Method, Outcome, Row};
use std::fmt::Write as _;

/// Width of the methods' names.
const METHOD: usize = 30;
/// Stands after a method some of whose stars are of a lower order.
const LOWERED: &str = " *";
/// Widths of the columns of numbers but the last.
const COLUMNS: [usize; 4] = [8, 14, 14, 14];

/// The tables for a terminal; the times are the last column.
pub fn text(comparison: &Comparison) -> String {
    let mut out = String::new();
    // Writing to a string cannot fail.
    if !comparison.title.is_empty() {
        let _ = writeln!(out, "{}\n{}", comparison.title, "─".repeat(comparison.title.chars().count()));
    }
    for rows in comparison.clouds() {
        let Some(first) = rows.first() else { continue };
        let ([n_x, n_y], nodes) = (first.density, first.nodes);
        let _ = writeln!(out, "Subdomain \"{}\", {n_x} × {n_y}: {nodes} nodes", first.subdomain);
        line(&mut out, "method", heads(comparison).map(str::to_owned), "seconds");
        rows.iter().for_each(|row| table_row(&mut out, comparison, row));
        out.push('\n');
    }
    let best = Method::REFERENCE.name();
    let against = match (comparison.exact_j, &comparison.source, &comparison.exact) {
        (Some(j), ..) => format!("J is held against the exact {j}"),
        (None, None, _) => format!("J is held against the best, {best}, on the same cloud"),
        (None, Some(f), Some(u)) => format!(
            "∇²u = {f}, held against the exact u = {u}: largest error at nodes over the largest |u|, error in L² over (∫u²)^½"
        ),
        (None, Some(f), None) => format!(
            "∇²u = {f}, held against the best, {best}, on the same cloud: ∫u, and the largest difference at nodes over the largest |u|"
        ),
    };
    let _ = writeln!(out, "{against}; seconds from stencils to results.");
    if comparison.rows.iter().any(|row| row.order_lowered() > 0) {
        let _ = writeln!(out, "* some stars are of a lower order: the cloud has too few nodes for it.");
    }
    out
}

fn table_row(out: &mut String, comparison: &Comparison, row: &Row) {
    match &row.outcome {
        Outcome::Solved(figures) => {
            let is_reference = comparison.exact_j.is_none() && row.method == Method::REFERENCE.name();
            let difference = match figures.j_difference {
                _ if is_reference => "best".into(),
                Some(difference) => format!("{difference:+.1e}"),
                None => "–".into(),
            };
            let cells = [
                figures.unknowns.to_string(),
                format!("{:.9}", Significant(figures.j)),
                format!("{:.7}", Significant(figures.tau_max)),
                difference,
            ];
            line(out, &name(row), cells, &format!("{:.3}", row.seconds));
        }
        Outcome::Poisson(figures) => {
            let is_reference = comparison.exact.is_none() && row.method == Method::REFERENCE.name();
            let shown = |value: Option<f64>, digits: &dyn Fn(f64) -> String| match value {
                _ if is_reference => "best".into(),
                Some(value) => digits(value),
                None => "–".into(),
            };
            let [third, fourth] = if comparison.exact.is_some() {
                [figures.max_error, figures.l2_error].map(|error| shown(error, &|value| format!("{value:.2e}")))
            } else {
                let of_integral = shown(figures.integral_difference, &|value| format!("{value:+.1e}"));
                [of_integral, shown(figures.max_difference, &|value| format!("{value:.1e}"))]
            };
            let integral = format!("{:.9}", Significant(figures.integral));
            let cells = [figures.unknowns.to_string(), integral, third, fourth];
            line(out, &name(row), cells, &format!("{:.3}", row.seconds));
        }
        Outcome::Failed { error } => {
            let _ = writeln!(out, "  {:<METHOD$}  failed: {error}", row.method);
        }
    }
}

/// Heads of the columns of numbers but the last.
fn heads(comparison: &Comparison) -> [&'static str; 4] {
    match (&comparison.source, &comparison.exact, comparison.exact_j) {
        (Some(_), Some(_), _) => ["unknowns", "∫u", "max error", "L² error"],
        (Some(_), None, _) => ["unknowns", "∫u", "∫u/best − 1", "max |u − best|"],
        (None, _, Some(_)) => ["unknowns", "J", "τ_max", "J/exact − 1"],
        (None, _, None) => ["unknowns", "J", "τ_max", "J/best − 1"],
    }
}

/// The method, marked where some of its stars are of a lower order.
fn name(row: &Row) -> String {
    format!("{}{}", row.method, if row.order_lowered() > 0 { LOWERED } else { "" })
}

fn line(out: &mut String, method: &str, cells: [String; 4], seconds: &str) {
    let _ = write!(out, "  {method:<METHOD$}");
    for (cell, width) in cells.iter().zip(COLUMNS) {
        let _ = write!(out, "  {cell:>width$}");
    }
    let _ = writeln!(out, "  {seconds:>8}");
}

/// A number with as many significant digits as the precision asks for, zeros kept, so that columns line up.
struct Significant(f64);

impl std::fmt::Display for Significant {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let digits = f.precision().unwrap_or(7);
        let size = self.0.abs();
        if size == 0.0 || !(1e-4..1e7).contains(&size) {
            return write!(f, "{:.*e}", digits - 1, self.0);
        }
        let decimals = (digits as i32 - 1 - size.log10().floor() as i32).max(0) as usize;
        write!(f, "{:.decimals$}", self.0)
    }
}
