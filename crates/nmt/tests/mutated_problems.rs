//! Damaged problems through the whole pipeline: an answer or an error, never a panic, and soon.

use nmt::prelude::*;
use nmt::report::Report;
use proptest::prelude::*;
use std::time::{Duration, Instant};

const SOUND: [&str; 4] = [
    r#"
[[subdomain]]
nodes = [15, 11]
irregularity = 0.3
outline = [[0, 0], [2, 0], [2, 1], { curve = "1 + 0.2*sin(pi*x)^2" }, [0, 1]]
[[subdomain.hole]]
circle = { centre = [1, 0.5], radius = 0.2 }
[solve]
formulation = "local"
"#,
    r#"
[[subdomain]]
nodes = [13, 13]
outline = [[0, 0], [3, 0], [3, 1], [1, 1], { arc = { centre = [1, 2], ccw = false } }, [0, 2], [0, 3]]
[solve]
torque = 2.5
star = 8
"#,
    r#"
[[subdomain]]
nodes = [9, 9]
ellipse = { centre = [0, 0], semi_axes = [2, 1], angle = 30 }
[[subdomain]]
nodes = [9, 17]
edge_clearance = 0.2
rectangle = { from = [3, 0], to = [4, 2] }
[[subdomain.hole]]
ellipse = { centre = [3.5, 1], semi_axes = [0.1, 0.6] }
[solve]
holes = "zero"
seed = 3
"#,
    r#"
[[subdomain]]
nodes = [9, 9]
outline = [[0, 0], [1, 0], { line = true, neumann = "1/(x - 0.3)" }, [1, 1], [0, 1]]
[[subdomain.hole]]
circle = { centre = [0.5, 0.5], radius = 0.2, neumann = "3*y" }
[solve]
source = "1/(x + 2)"
exact = "log(x + 0.7)"
"#,
];

/// Numbers that hit limits, ties and degenerate shapes.
const NUMBERS: [&str; 14] =
    ["0", "1", "-1", "2", "3", "0.5", "1e-9", "1e9", "0.499999", "0.1", "4", "1.0000000001", "7", "-0.0"];

/// Replaces the `which`-th number of the text.
fn with_number(text: &str, which: usize, number: &str) -> String {
    let is_number = |c: char| c.is_ascii_digit() || c == '.';
    let mut spans = Vec::new();
    let mut start = None;
    for (k, c) in text.char_indices().chain([(text.len(), ' ')]) {
        match (is_number(c), start) {
            (true, None) => start = Some(k),
            (false, Some(s)) => {
                spans.push(s..k);
                start = None;
            }
            _ => {}
        }
    }
    let span = spans[which % spans.len()].clone();
    format!("{}{number}{}", &text[..span.start], &text[span.end..])
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn a_problem_with_other_numbers_is_solved_or_refused(
        which in 0..SOUND.len(),
        changes in prop::collection::vec((0usize..60, prop::sample::select(&NUMBERS[..])), 1..4),
    ) {
        let mut text = SOUND[which].to_owned();
        for (place, number) in changes {
            text = with_number(&text, place, number);
        }
        let start = Instant::now();
        if let Ok(problem) = Problem::parse("mutated.toml", &text, &Overrides::default()) {
            // Keep the work of a sound answer small: it is the answer that is tested.
            let points: usize = problem.subdomains.iter().map(|s| s.nodes[0] * s.nodes[1]).sum();
            prop_assume!(points < 4000);
            match solve_any(&problem) {
                Ok(solved) => {
                    for part in solved.parts() {
                        prop_assert_eq!(part.mesh.check(), Ok(()), "{}", text);
                    }
                    let report = Report::of_solved(&problem, &solved, &[[0.4, 0.3]]);
                    prop_assert!(report.json().is_ok(), "{}", text);
                    let is_finite = match &solved {
                        Solved::Torsion(parts) => parts
                            .iter()
                            .all(|s| s.solution.j.is_finite() && s.solution.tau_max.value.is_finite()),
                        Solved::Poisson(parts) => parts.iter().all(|s| s.solution.u.iter().all(|u| u.is_finite())),
                    };
                    prop_assert!(is_finite, "{}", text);
                }
                Err(error) => prop_assert!(!error.to_string().is_empty()),
            }
        }
        prop_assert!(start.elapsed() < Duration::from_secs(5), "{}", text);
    }
}
