//! `nmt check`: every fault, the census a solve would have, and warnings.

use super::{finish, load};
use crate::args::{CheckArgs, MeshKeys};
use crate::exit::Failure;
use crate::timing::Stopwatch;
use nmt::pipeline::clouds;
use nmt::report::Report;

/// Runs the command.
pub fn check(args: &CheckArgs) -> Result<(), Failure> {
    let mut watch = Stopwatch::start();
    let problem = load(&args.problem, &args.problem.overrides_with(&args.keys, &MeshKeys::default()))?;
    let parts = clouds(&problem, &mut |k, stage| watch.lap(k, stage)).map_err(|e| Failure::of(e, &problem.source))?;
    finish(Report::of_check(&problem, &parts), &watch, args.problem.json, None)
}
