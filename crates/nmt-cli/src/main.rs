//! The command `nmt`; everything is in the library target.

use std::process::ExitCode;

fn main() -> ExitCode {
    nmt_cli::run(std::env::args_os())
}
