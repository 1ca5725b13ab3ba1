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
    let mut clock = || {
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
    assert!(!comparison.is_failure());
    assert!(text(&comparison).contains("failed: too few nodes"));
    assert!(comparison.json().expect("JSON").contains("\"error\": \"too few nodes\""));
    assert!(unknowns_svg(&comparison).starts_with("<?xml"));
}
