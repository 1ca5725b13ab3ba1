//! The comparison as pictures: the error of J against what it costs.

use super::{Comparison, Row, methods};
use crate::plot::{Caption, ErrorSeries, errors_figure};

/// SVG text: the relative error of J, or of u in L², against the number of unknowns, both logarithmic.
pub fn unknowns_svg(comparison: &Comparison) -> String {
    svg(comparison, "number of unknowns", |_, unknowns| unknowns as f64)
}

/// SVG text: the same error against the seconds it took, both logarithmic. The one picture that differs from run
/// to run.
pub fn time_svg(comparison: &Comparison) -> String {
    svg(comparison, "time, stencils to results [s]", |row, _| row.seconds)
}

fn svg(comparison: &Comparison, cost_label: &str, cost: impl Fn(&Row, usize) -> f64) -> String {
    let points: Vec<Vec<[f64; 2]>> = methods()
        .iter()
        .map(|method| {
            let name = method.name();
            let of_method = comparison.rows.iter().filter(|row| row.method == name);
            let mut points: Vec<[f64; 2]> = of_method
                .filter_map(|row| {
                    let (unknowns, error) = match (row.figures(), row.poisson()) {
                        (Some(figures), _) => (figures.unknowns, figures.j_difference?.abs()),
                        (None, Some(figures)) => (figures.unknowns, figures.l2_error?),
                        (None, None) => return None,
                    };
                    Some([cost(row, unknowns), error])
                })
                .collect();
            points.sort_by(|a, b| a[0].total_cmp(&b[0]));
            points
        })
        .collect();
    let names = methods().map(|method| method.name());
    // Colours by formulation, marks by order.
    let families = [0, 1, 1, 1, 2, 2, 2, 3, 4, 5];
    let series: Vec<ErrorSeries> = methods()
        .iter()
        .zip(&names)
        .zip(&points)
        .zip(families)
        .map(|(((method, name), points), family)| ErrorSeries { name, points, family, order: method.order })
        .collect();
    let caption = Caption { title: &comparison.title, units: &comparison.units };
    let error = if comparison.source.is_some() { "relative error of u in L²" } else { "relative error of J" };
    errors_figure(&caption, cost_label, error, &series)
}
