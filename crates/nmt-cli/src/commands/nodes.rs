//! `nmt nodes`: the cloud.

use super::{finish, load, out_dir};
use crate::args::CloudArgs;
use crate::exit::Failure;
use crate::timing::Stopwatch;
use nmt::figures::nodes_svg;
use nmt::io::csv_of_clouds;
use nmt::pipeline::clouds;
use nmt::report::Report;

/// Runs the command.
pub fn nodes(args: &CloudArgs) -> Result<(), Failure> {
    let mut watch = Stopwatch::start();
    let problem = load(&args.problem, &args.problem.overrides())?;
    let mut out = out_dir(args.out.as_deref())?;
    let parts = clouds(&problem, &mut |k, stage| watch.lap(k, stage)).map_err(|e| Failure::of(e, &problem.source))?;
    if let Some(out) = &mut out {
        out.write("nodes.csv", csv_of_clouds(parts.iter().map(|p| (&*p.name, &*p.edge_names, &p.cloud))))?;
        out.write_picture("nodes", &nodes_svg(&problem, parts.iter().map(|p| (&*p.name, &p.cloud))))?;
    }
    finish(Report::of_clouds(&problem, &parts), &watch, args.problem.json, out)
}
