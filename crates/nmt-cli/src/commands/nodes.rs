//! `nmt nodes`: the cloud.

use super::{finish, load, observer, out_dir};
use crate::args::CloudArgs;
use crate::exit::Failure;
use crate::progress::Progress;
use crate::timing::Stopwatch;
use nmt::figures::nodes_svg;
use nmt::io::csv_of_clouds;
use nmt::pipeline::clouds;
use nmt::report::Report;

/// Runs the command.
pub fn nodes(args: &CloudArgs, progress: &Progress) -> Result<(), Failure> {
    let mut watch = Stopwatch::start();
    let problem = load(&args.problem, &args.problem.overrides())?;
    let mut out = out_dir(args.out.as_deref(), progress)?;
    let parts =
        clouds(&problem, &mut observer(&problem, &mut watch, progress)).map_err(|e| Failure::of(e, &problem.source))?;
    if let Some(out) = &mut out {
        out.write_with("nodes.csv", |sink| {
            csv_of_clouds(sink, parts.iter().map(|p| (&*p.name, &*p.edge_names, &p.cloud)))
        })?;
        out.write_picture("nodes", || nodes_svg(&problem, parts.iter().map(|p| (&*p.name, &p.cloud))))?;
    }
    finish(Report::of_clouds(&problem, &parts), (&watch, progress), args.problem.json, out)
}
