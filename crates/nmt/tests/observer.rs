//! What the pipeline tells while it works.

use nmt::pipeline::{Event, Stage, clouds, meshes, solved};
use nmt::problem::{Overrides, Problem};

fn events(solve: &str) -> Vec<(usize, Event)> {
    let shapes = "[[subdomain]]\nnodes = [41, 41]\nrectangle = { from = [0, 0], to = [1, 1] }\n\
                  [[subdomain]]\nnodes = [21, 21]\nrectangle = { from = [2, 0], to = [3, 1] }\n";
    let text = format!("{shapes}[solve]\nsolver = \"iterative\"\n{solve}\n");
    let problem = Problem::parse("two.toml", &text, &Overrides::default()).expect("a sound problem");
    let mut told = Vec::new();
    let mut observer = |k: usize, event: Event| told.push((k, event));
    clouds(&problem, &mut observer)
        .and_then(|clouds| meshes(&problem, clouds, &mut observer))
        .and_then(|meshes| solved(&problem, meshes, &mut observer))
        .expect("solutions");
    told
}

#[test]
fn every_stage_begins_and_ends_and_tells_what_it_does_in_between() {
    for (solve, estimates) in [("", true), ("estimate = false", false), ("source = \"1\"", false)] {
        let told = events(solve);
        let bounds: Vec<(usize, Event)> =
            told.iter().copied().filter(|(_, event)| matches!(event, Event::Begun(_) | Event::Ended(_))).collect();
        let stages = |k: usize, stages: &[Stage]| {
            stages.iter().flat_map(|stage| [(k, Event::Begun(*stage)), (k, Event::Ended(*stage))]).collect::<Vec<_>>()
        };
        let mut solution = vec![Stage::Stencils, Stage::Assemble, Stage::Solve, Stage::Post];
        if estimates {
            // The warping function, and the bounds from the recovery of both.
            solution.insert(3, Stage::Estimate);
            solution.push(Stage::Estimate);
        }
        let expected = [
            stages(0, &[Stage::Cloud]),
            stages(1, &[Stage::Cloud]),
            stages(0, &[Stage::Mesh]),
            stages(1, &[Stage::Mesh]),
            stages(0, &solution),
            stages(1, &solution),
        ]
        .concat();
        assert_eq!(bounds, expected);

        // Stars, then recovery, each up to all nodes; the warping function takes the stars over, and is recovered along.
        let full = told.iter().filter(|(k, e)| *k == 0 && *e == Event::Nodes { done: 1681, of: 1681 }).count();
        assert_eq!(full, 2);
        let residuals: Vec<f64> = told
            .iter()
            .take_while(|(_, event)| *event != Event::Ended(Stage::Solve))
            .filter_map(|(k, event)| match event {
                Event::Iteration { residual, target, .. } if *k == 0 => Some(residual / target),
                _ => None,
            })
            .collect();
        // The iteration that reaches the target is the last.
        let reaching = residuals.iter().position(|residual| *residual <= 1.0);
        assert!(residuals.len() > 3 && reaching == Some(residuals.len() - 1), "{residuals:?}");
        assert!(residuals[residuals.len() - 1] < 1e-6 * residuals[0], "{residuals:?}");
    }
}
