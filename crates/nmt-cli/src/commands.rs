//! One function a command: stages of the pipeline, then its files, then its report.

mod check;
mod compare;
mod mesh;
mod nodes;
mod solve;
mod star;

pub use check::check;
pub use compare::compare;
pub use mesh::mesh;
pub use nodes::nodes;
pub use solve::solve;
pub use star::star;

use crate::args::ProblemArgs;
use crate::exit::Failure;
use crate::files::{print, read_problem};
use crate::out_dir::OutDir;
use crate::progress::Progress;
use crate::timing::Stopwatch;
use nmt::pipeline::{Event, Step};
use nmt::problem::{Overrides, Problem, Source};
use nmt::report::{Report, significant, text};
use std::path::Path;

/// The directory for results, where one is asked for.
fn out_dir(path: Option<&Path>, progress: &Progress) -> Result<Option<OutDir>, Failure> {
    path.map(|path| OutDir::create(path, progress)).transpose()
}

/// Tells the clock and the bar what the pipeline tells.
fn observer<'a>(
    problem: &'a Problem,
    watch: &'a mut Stopwatch,
    progress: &'a Progress,
) -> impl FnMut(usize, Event) + 'a {
    let several = problem.subdomains.len() > 1;
    move |k, event| {
        watch.observe(k, event);
        let name = problem.subdomains.get(k).filter(|_| several);
        progress.observe(name.map(|subdomain| subdomain.name.as_str()), event);
        if let Event::Step(Step { nodes, j, error }) = event {
            let of = name.map_or(String::new(), |subdomain| format!("\"{}\": ", subdomain.name));
            let j = significant(j, 10);
            progress.note(&format!("{of}{nodes} nodes, J = {j}, estimated error {error:.1e}"));
        }
    }
}

/// Reads and checks the problem.
fn load(args: &ProblemArgs, overrides: &Overrides) -> Result<Problem, Failure> {
    parse(&read_problem(&args.file)?, overrides)
}

/// Checks the problem of a text.
fn parse(source: &Source, overrides: &Overrides) -> Result<Problem, Failure> {
    Problem::parse(&source.file, &source.text, overrides)
        .map_err(|errors| Failure::Problem { errors, source_text: source.clone() })
}

/// Completes the report with its times, puts it and all other files in place where there is a directory, and prints it.
fn finish(
    mut report: Report,
    (watch, progress): (&Stopwatch, &Progress),
    json: bool,
    out: Option<OutDir>,
) -> Result<(), Failure> {
    watch.fill(&mut report);
    progress.clear();
    report.warnings.iter().for_each(|warning| eprintln!("warning: {warning}"));
    let as_json = report.json().map_err(|error| Failure::Json(error.to_string()))?;
    if let Some(mut out) = out {
        out.write("report.json", &as_json)?;
        out.publish()?;
    }
    print(&if json { as_json } else { text(&report) })
}
