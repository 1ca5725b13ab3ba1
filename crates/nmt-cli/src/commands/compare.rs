//! `nmt compare`: every formulation on the same clouds.

use super::{out_dir, parse};
use crate::args::CompareArgs;
use crate::exit::Failure;
use crate::files::{print, read_problem};
use crate::progress::Progress;
use crate::timing::Stopwatch;
use nmt::compare::{Comparison, Method, compare as compare_rows, text, time_svg, unknowns_svg};
use nmt::pipeline::{clouds, meshes};
use nmt::problem::{Overrides, Problem};

/// Runs the command.
pub fn compare(args: &CompareArgs, progress: &Progress) -> Result<(), Failure> {
    let watch = Stopwatch::start();
    let source = read_problem(&args.file)?;
    let densities: Vec<Option<[usize; 2]>> =
        if args.nodes.is_empty() { vec![None] } else { args.nodes.iter().copied().map(Some).collect() };
    let problem = |nodes| parse(&source, &Overrides { nodes, seed: args.seed, ..Overrides::default() });
    let problems: Vec<Problem> = densities.into_iter().map(problem).collect::<Result<_, _>>()?;
    let Some(first) = problems.first() else { return Ok(()) };
    if args.exact_j.is_some() && first.solve.poisson.is_some() {
        let message = "--exact-J belongs to torsion; `source` makes this a Poisson problem: give its solution as `exact` in [solve]";
        return Err(Failure::Option(message.into()));
    }
    if args.exact_j.is_some() && first.subdomains.len() > 1 {
        return Err(Failure::Option(format!(
            "--exact-J is the J of one section, and the problem has {} subdomains; leave it out, or compare them one by one",
            first.subdomains.len()
        )));
    }
    let out = out_dir(args.out.as_deref(), progress)?;
    let mut comparison = Comparison::new(first, args.exact_j);
    for problem in &problems {
        let mut clock = |method: &Method| {
            progress.begin(&method.name());
            watch.seconds()
        };
        let rows = clouds(problem, &mut |_, _| {})
            .and_then(|clouds| meshes(problem, clouds, &mut |_, _| {}))
            .and_then(|meshes| compare_rows(problem, &meshes, args.exact_j, &mut clock))
            .map_err(|e| Failure::of(e, &problem.source))?;
        comparison.rows.extend(rows);
    }
    let as_json = comparison.json().map_err(|error| Failure::Json(error.to_string()))?;
    if let Some(mut out) = out {
        out.write("compare.json", &as_json)?;
        if comparison.has_errors() {
            out.write_picture("compare-unknowns", || unknowns_svg(&comparison))?;
            out.write_picture("compare-time", || time_svg(&comparison))?;
        }
        out.publish()?;
    }
    progress.clear();
    print(&if args.json { as_json } else { text(&comparison) })?;
    match comparison.n_failures() {
        0 => Ok(()),
        failed => Err(Failure::Methods { failed, of: comparison.rows.len() }),
    }
}
