//! Every test of the workspace, in one command.

use crate::{golden, root};
use anyhow::{Context as _, Result, bail};
use std::process::Command;

/// Runs cargo's tests, the golden comparison, and the script that reads our files with other tools.
pub fn test() -> Result<()> {
    run(Command::new("cargo").args(["test", "--workspace"]))?;
    // Crates stand alone: the numerics without threads, the facade without PNG.
    run(Command::new("cargo").args(["check", "--package", "nmt-mfdm"]))?;
    run(Command::new("cargo").args(["check", "--package", "nmt", "--no-default-features"]))?;
    golden::compare()?;
    // The tests of the command have built it.
    run(&mut Command::new("scripts/check_files.sh"))
}

fn run(command: &mut Command) -> Result<()> {
    let shown = format!("{command:?}");
    let status = command.current_dir(root()).status().with_context(|| format!("{shown} cannot be started"))?;
    if !status.success() {
        bail!("{shown} failed");
    }
    Ok(())
}
