//! The command `nmt`: clouds, meshes and torsion of 2D sections from a problem file.
//!
//! ```text
//! nmt check FILE    is the file sound? the census a solve would have
//! nmt nodes FILE    the cloud
//! nmt mesh FILE     the cloud and its triangles
//! nmt solve FILE    torsion: F, τ, J
//! nmt compare FILE  torsion by every formulation, side by side
//! nmt plot star FILE --node N   the star of one node with its weights
//! ```
//!
//! Exit codes: 0 done, 1 the problem is wrong, 2 usage, 3 the numerics failed, 4 input or output failed, 130 interrupted.
//! Results go to stdout, errors and warnings to stderr.
//!
//! ```
//! use std::process::ExitCode;
//! // A file that does not exist is a failure of input: exit code 4.
//! assert_eq!(nmt_cli::run(["nmt", "check", "no such file"]), ExitCode::from(4));
//! ```

mod args;
mod commands;
mod exit;
mod files;
mod interrupt;
mod out_dir;
mod progress;
mod timing;

use args::{Args, Command, Picture};
use clap::Parser as _;
use std::ffi::OsString;
use std::process::ExitCode;

/// Runs the command line `arguments` (the program's name first) and returns the exit code.
pub fn run<T: Into<OsString> + Clone>(arguments: impl IntoIterator<Item = T>) -> ExitCode {
    let args = match Args::try_parse_from(arguments) {
        Ok(args) => args,
        Err(error) => {
            // Help and version are no errors: clap knows where they go and what they exit with.
            let _ = error.print();
            return ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(exit::USAGE));
        }
    };
    interrupt::handle();
    let progress = progress::Progress::new(!args.no_progress);
    let outcome = match &args.command {
        Command::Check(options) => commands::check(options, &progress),
        Command::Nodes(options) => commands::nodes(options, &progress),
        Command::Mesh(options) => commands::mesh(options, &progress),
        Command::Solve(options) => commands::solve(options, &progress),
        Command::Compare(options) => commands::compare(options, &progress),
        Command::Plot(Picture::Star(options)) => commands::star(options, &progress),
    };
    progress.clear();
    // Where an interruption is under way it ends the run, and an error that it caused is not told.
    drop(interrupt::uninterrupted());
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => failure.report(),
    }
}
