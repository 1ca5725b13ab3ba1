//! `nmt check`: every fault, the census a solve would have, and warnings.

use super::{finish, load, observer};
use crate::args::{CheckArgs, MeshKeys};
use crate::exit::Failure;
use crate::progress::Progress;
use crate::timing::Stopwatch;
use nmt::pipeline::clouds;
use nmt::report::Report;

/// Runs the command.
pub fn check(args: &CheckArgs, progress: &Progress) -> Result<(), Failure> {
    let mut watch = Stopwatch::start();
    let problem = load(&args.problem, &args.problem.overrides_with(&args.keys, &MeshKeys::default()))?;
    let parts =
        clouds(&problem, &mut observer(&problem, &mut watch, progress)).map_err(|e| Failure::of(e, &problem.source))?;
    finish(Report::of_check(&problem, &parts), (&watch, progress), args.problem.json, None)
}
