//! Orders of convergence and last errors against exact solutions, both formulations, regular and irregular clouds.

use crate::sections::{
    Case, circle, ellipse, error_of_f, keyway, mesh, params, rectangle, ring, rounded_square, semicircle, solved,
    square, triangle,
};
use nmt_cloud::Section;
use nmt_mfdm::Formulation::{Local, Variational};
use nmt_mfdm::{Formulation, exact};
use std::f64::consts::PI;

const SEEDS: u64 = 3;
const IRREGULARITY: f64 = 0.25;

fn root_mean_square(values: &[f64]) -> f64 {
    (values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64).sqrt()
}

/// Slope of log error on log spacing, by least squares, and the error of the last level.
struct Observed {
    order: f64,
    last: f64,
}

fn observe(levels: &[usize], errors: &[f64]) -> Observed {
    let logs: Vec<[f64; 2]> = levels.iter().zip(errors).map(|(n, e)| [-((n - 1) as f64).ln(), e.ln()]).collect();
    let mean = |d: usize| logs.iter().map(|p| p[d]).sum::<f64>() / logs.len() as f64;
    let (x, y) = (mean(0), mean(1));
    let along = |p: &[f64; 2]| (p[0] - x) * (p[1] - y);
    let order = logs.iter().map(along).sum::<f64>() / logs.iter().map(|p| (p[0] - x).powi(2)).sum::<f64>();
    Observed { order, last: errors.last().copied().unwrap_or(f64::NAN) }
}

/// Largest error of F at the nodes, in units of the largest F, by formulation (variational, local): of a regular cloud,
/// or the root mean square over seeds.
fn relative_errors(case: &Case, across: usize, irregularity: f64) -> [f64; 2] {
    let seeds = if irregularity > 0.0 { SEEDS } else { 1 };
    let mut errors = [vec![], vec![]];
    for seed in 0..seeds {
        let mesh = mesh(&case.section, &params(case.nodes(across), irregularity, seed));
        let exact: Vec<f64> = mesh.xy().iter().map(|p| (case.f)(*p)).collect();
        let f_max = exact.iter().copied().fold(0.0, f64::max);
        for (formulation, errors) in [Variational, Local].into_iter().zip(&mut errors) {
            let found = solved(&mesh, formulation).f;
            errors.push(found.iter().zip(&exact).map(|(f, e)| (f - e).abs()).fold(0.0, f64::max) / f_max);
        }
    }
    errors.map(|errors| root_mean_square(&errors))
}

/// Asserts order ≥ 1.8 of the largest error at nodes on regular and irregular clouds, and the last errors
/// `[[variational, local] regular, [variational, local] irregular]`.
fn assert_second_order(case: &Case, levels: &[usize], last: [[f64; 2]; 2]) {
    for (irregularity, limits) in [0.0, IRREGULARITY].into_iter().zip(last) {
        let errors: Vec<[f64; 2]> = levels.iter().map(|n| relative_errors(case, *n, irregularity)).collect();
        for (k, formulation) in [Variational, Local].into_iter().enumerate() {
            let seen = observe(levels, &errors.iter().map(|e| e[k]).collect::<Vec<f64>>());
            let what = format!("{} {} {irregularity}", case.name, formulation.name());
            println!("{what}: order {:.2}, last {:.1e}", seen.order, seen.last);
            assert!(seen.order >= 1.8, "{what}: order {}", seen.order);
            assert!(seen.last <= limits[k], "{what}: last error {:e}", seen.last);
        }
    }
}

// Last errors: about one and a half times what was measured, so that a change of the method shows; our own, 0.1.0.

#[test]
fn f_converges_with_order_two_on_a_section_without_corners() {
    assert_second_order(&rounded_square(), &[21, 41, 81], [[3e-6, 5e-6], [1.2e-5, 2.7e-5]]);
}

#[test]
fn f_converges_with_order_two_on_a_shaft_with_a_groove() {
    assert_second_order(&keyway(), &[21, 41, 81], [[1e-4, 2e-4], [2.5e-4, 3.5e-4]]);
}

#[test]
fn f_converges_with_order_two_on_an_equilateral_triangle() {
    assert_second_order(&triangle(), &[16, 31, 61], [[3e-5, 2e-5], [1e-4, 1.6e-4]]);
}

#[test]
fn f_converges_with_order_two_on_the_square() {
    assert_second_order(&square(), &[11, 21, 41], [[4e-4, 2e-5], [4e-4, 3.5e-4]]);
}

#[test]
fn quadratic_stress_functions_are_met_to_rounding() {
    for case in [circle(), ellipse(), ring()] {
        for formulation in Formulation::MESHLESS {
            for irregularity in [0.0, 0.4] {
                let mesh = mesh(&case.section, &params(case.nodes(31), irregularity, 1));
                let solution = solved(&mesh, formulation);
                // Stars of order 2 carry F itself; rounding (1e-16) times the condition of a system of 700 (1e3).
                let error = error_of_f(&mesh, &solution, case.f);
                assert!(error < 1e-12, "{} {}: {error:e}", case.name, formulation.name());
                let tau = exact_gradient_error(&case, &mesh, &solution);
                assert!(tau < 1e-9, "{}: gradient off by {tau:e}", case.name); // rounding over the spacing, squared
            }
        }
    }
}

/// Largest error of ∇F at the nodes, the exact one by central differences of a quadratic: exact but for rounding.
fn exact_gradient_error(case: &Case, mesh: &nmt_tri::Mesh, solution: &nmt_mfdm::TorsionSolution) -> f64 {
    let error = |node: usize| {
        let [x, y] = mesh.xy()[node];
        let half = |p: [f64; 2], q: [f64; 2]| ((case.f)(p) - (case.f)(q)) / 2.0;
        let exact = [half([x + 1.0, y], [x - 1.0, y]), half([x, y + 1.0], [x, y - 1.0])];
        let found = solution.field.at_node(nmt_geom::NodeId::of(node)).gradient;
        (found[0] - exact[0]).hypot(found[1] - exact[1])
    };
    (0..mesh.cloud().n_nodes()).map(error).fold(0.0, f64::max)
}

/// Relative errors of J, one a seed.
fn errors_of_j(
    section: &Section,
    nodes: [usize; 2],
    formulation: Formulation,
    irregularity: f64,
    seeds: u64,
    j: f64,
) -> Vec<f64> {
    let error = |seed| solved(&mesh(section, &params(nodes, irregularity, seed)), formulation).j / j - 1.0;
    (0..seeds).map(error).collect()
}

#[test]
fn j_of_the_unit_square_is_as_good_as_promised() {
    let Case { section, j, .. } = square();
    let errors =
        |formulation, irregularity, seeds| errors_of_j(&section, [41, 41], formulation, irregularity, seeds, j);
    for formulation in Formulation::MESHLESS {
        assert!(errors(formulation, 0.0, 1)[0].abs() < 1e-5); // the promise; 6e-7 and 2e-6 measured
    }
    // The promise for irregular clouds: root mean square over seeds, and any seed.
    for (formulation, mean, any) in [(Local, 6e-5, 2e-4), (Variational, 2e-5, 6e-5)] {
        let errors = errors(formulation, IRREGULARITY, 8);
        assert!(root_mean_square(&errors) < mean, "{}: {errors:?}", formulation.name());
        assert!(errors.iter().all(|e| e.abs() < any), "{}: {errors:?}", formulation.name());
    }
}

#[test]
fn j_of_round_sections_the_triangle_and_the_rectangle_is_as_good_as_promised() {
    let semicircle = Case {
        name: "semicircle",
        section: semicircle(),
        aspect: [1.0, 0.5],
        f: |_| f64::NAN, // not compared
        j: PI / 2.0 - 4.0 / PI,
    };
    for case in [circle(), ellipse(), semicircle, triangle(), rounded_square(), rectangle()] {
        for (formulation, irregular) in [(Local, 1e-4), (Variational, 1e-5)] {
            for (irregularity, limit) in [(0.0, 1e-5), (IRREGULARITY, irregular)] {
                for error in errors_of_j(&case.section, case.nodes(81), formulation, irregularity, 1, case.j) {
                    // The promise at 81 across.
                    assert!(error.abs() < limit, "{} {} {irregularity}: {error:e}", case.name, formulation.name());
                }
            }
        }
    }
}

#[test]
fn j_of_the_ring_is_as_good_as_promised() {
    let case = ring();
    for formulation in Formulation::MESHLESS {
        for irregularity in [0.0, IRREGULARITY] {
            let errors = errors_of_j(&case.section, case.nodes(41), formulation, irregularity, 2, case.j);
            // 1e-4 is promised at 81 across; F is quadratic, so that only the geometry is left: 4e-8 measured at 41.
            assert!(errors.iter().all(|e| e.abs() < 1e-6), "{errors:?}");
        }
    }
}

#[test]
fn the_largest_stress_and_the_largest_f_of_convex_sections_are_as_good_as_promised() {
    for (case, known) in [
        (square(), exact::rectangle(1.0, 1.0)),
        (ellipse(), exact::ellipse(2.0, 1.0)),
        (triangle(), exact::equilateral_triangle(1.0)),
    ] {
        for formulation in Formulation::MESHLESS {
            for irregularity in [0.0, IRREGULARITY] {
                let mesh = mesh(&case.section, &params(case.nodes(61), irregularity, 5));
                let solution = solved(&mesh, formulation);
                let tau = solution.tau_max.value / known.tau_max - 1.0;
                let what = format!("{} {} {irregularity}", case.name, formulation.name());
                assert!(tau.abs() < 3e-3, "{what}: tau_max off by {tau:e}"); // the promise at 81; met at 61 across
                // F at the maximum: h² at nodes, 1e-4 of F_max; and the Newton step from the nearest node.
                let f = solution.f_max.value / known.f_max - 1.0;
                assert!(f.abs() < 1e-4, "{what}: F_max off by {f:e}");
                assert!((solution.w_t * solution.tau_max.value / solution.torque - 1.0).abs() < 1e-14); // rounding
            }
        }
    }
}
