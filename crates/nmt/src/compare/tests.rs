use super::*;
use crate::pipeline::{clouds, meshes};
use crate::problem::Overrides;

const EXACT: f64 = 0.140_577_014_955_153_7; // 30-digit evaluation of the series

fn unit_square(extra: &str) -> (Problem, Vec<MeshPart>) {
    let text = format!("[[subdomain]]\nnodes = [15, 15]\nrectangle = {{ from = [0, 0], to = [1, 1] }}\n{extra}\n");
    let problem = Problem::parse("square.toml", &text, &Overrides::default()).expect("a sound problem");
    let observer: &mut crate::pipeline::Observer = &mut |_, _| {};
    let parts = clouds(&problem, observer).and_then(|clouds| meshes(&problem, clouds, observer)).expect("meshes");
    (problem, parts)
}

fn comparison(extra: &str, exact_j: Option<f64>) -> Comparison {
    let (problem, parts) = unit_square(extra);
    let mut ticks = 0.0;
    let mut clock = |_: &Method| {
        ticks += 0.5;
        ticks
    };
    let rows = compare(&problem, &parts, exact_j, &mut clock).expect("rows");
    Comparison { rows, ..Comparison::new(&problem, exact_j) }
}

fn error(comparison: &Comparison, method: &str) -> f64 {
    let row = comparison.rows.iter().find(|row| row.method == method).expect("the method");
    row.figures().and_then(|figures| figures.j_difference).expect("a difference").abs()
}

#[test]
fn on_a_square_all_but_the_papers_form_beat_finite_elements_and_every_number_is_finite() {
    let comparison = comparison("", Some(EXACT));
    assert_eq!(comparison.rows.len(), 10);
    for row in &comparison.rows {
        let figures = row.figures().expect("every method solves a square");
        assert!([figures.j, figures.tau_max].iter().all(|v| v.is_finite() && *v > 0.0));
        assert_eq!((figures.unknowns, row.nodes, row.seconds), (169, 225, 0.5));
        if !["fem", "variational 2 mwls+trial"].contains(&&*row.method) {
            assert!(error(&comparison, &row.method) < 0.3 * error(&comparison, "fem"), "{}", row.method);
        }
    }
    assert!(error(&comparison, "variational 2 blended+hat") < 0.03 * error(&comparison, "fem")); // 0.012 measured
}

#[test]
fn on_an_irregular_cloud_the_default_beats_the_papers_form() {
    let comparison = comparison("irregularity = 0.25", Some(EXACT));
    assert!(error(&comparison, "variational 2 blended+hat") < 0.1 * error(&comparison, "variational 2 mwls+trial"));
}

#[test]
fn two_runs_agree_to_the_bit() {
    let [first, second] = [0, 1].map(|_| comparison("irregularity = 0.25", None));
    assert_eq!(first, second);
    assert_eq!(unknowns_svg(&first), unknowns_svg(&second));
}

#[test]
fn without_an_exact_j_the_best_is_the_reference() {
    let comparison = comparison("", None);
    assert_eq!(error(&comparison, "variational 4 blended+hat"), 0.0);
    assert!(error(&comparison, "fem") > 1e-3);
    assert!(text(&comparison).contains("held against the best, variational 4 blended+hat"));
}

#[test]
fn a_method_that_fails_says_why_and_the_others_go_on() {
    let (problem, mut rows) = (unit_square("").0, comparison("", None).rows);
    rows[3].outcome = Outcome::Failed { error: "too few nodes".into() };
    let comparison = Comparison { rows, ..Comparison::new(&problem, None) };
    assert_eq!(comparison.n_failures(), 1);
    assert!(text(&comparison).contains("failed: too few nodes"));
    assert!(comparison.json().expect("JSON").contains("\"error\": \"too few nodes\""));
    assert!(unknowns_svg(&comparison).starts_with("<?xml"));
}

#[test]
fn a_poisson_problem_is_held_against_its_exact_solution() {
    let solve =
        "irregularity = 0.25\n[solve]\nsource = \"-2*pi^2*sin(pi*x)*sin(pi*y)\"\nexact = \"sin(pi*x)*sin(pi*y)\"";
    let comparison = comparison(solve, None);
    assert_eq!((comparison.reference.as_str(), comparison.rows.len()), ("exact", 10));
    let errors = |method: &str| {
        let row = comparison.rows.iter().find(|row| row.method == method).and_then(Row::poisson).expect("numbers");
        assert_eq!((row.unknowns, row.integral_difference, row.max_difference), (169, None, None));
        [row.l2_error.expect("an error"), row.max_error.expect("an error")]
    };
    let [fem, best] = ["fem", "variational 4 blended+hat"].map(errors);
    assert!(fem.iter().all(|error| (1e-3..0.1).contains(error)), "{fem:?}"); // h² = 5e-3
    assert!(best.iter().all(|error| *error < 1e-2 * fem[0]), "{best:?}"); // 4e-3 measured
    let table = text(&comparison);
    assert!(table.contains("max error") && table.contains("held against the exact u = sin(pi*x)*sin(pi*y)"), "{table}");
    assert!(unknowns_svg(&comparison).contains("relative error of u in L²"));
}

#[test]
fn without_an_exact_solution_it_is_held_against_the_best() {
    let with_best = |source: &str| comparison(&format!("[solve]\nsource = \"{source}\""), None);
    let comparison = with_best("1");
    let of = |comparison: &Comparison, method: &str| {
        let row = comparison.rows.iter().find(|row| row.method == method).and_then(Row::poisson);
        *row.expect("numbers")
    };
    // ∇²u = 1 with u = 0 around is −F/2 of torsion, and J = 2∫F.
    let best = of(&comparison, "variational 4 blended+hat");
    assert!((best.integral / (-0.25 * EXACT) - 1.0).abs() < 1e-4); // 15 nodes a side
    assert_eq!((best.integral_difference, best.max_difference, best.l2_error), (Some(0.0), Some(0.0), None));
    let fem = of(&comparison, "fem");
    assert!(fem.integral_difference.is_some_and(|d| (1e-3..0.1).contains(&d.abs())), "{fem:?}");
    assert!(fem.max_difference.is_some_and(|d| (1e-4..0.1).contains(&d)), "{fem:?}");
    assert!(text(&comparison).contains("held against the best, variational 4 blended+hat"));
    // Where ∫u = 0 there is nothing to divide by.
    assert_eq!(of(&with_best("sin(2*pi*x)"), "fem").integral_difference, None);
}

#[test]
fn a_formula_that_is_not_finite_is_a_fault_of_the_problem() {
    let (problem, parts) = unit_square("[solve]\nsource = \"1/(x - x)\"");
    assert!(matches!(compare(&problem, &parts, None, &mut |_| 0.0), Err(NmtError::Problem(_))));
}
