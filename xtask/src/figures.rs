//! Pictures of the documentation, from the shipped problems.

use crate::root;
use anyhow::{Context as _, Result};
use nmt::figures::solution_svg;
use nmt::prelude::*;
use std::fs;

/// The problems whose four panels the documentation shows.
const SHOWN: [&str; 1] = ["paper-3"];

/// Redraws docs/figures.
pub fn draw() -> Result<()> {
    for name in SHOWN {
        let file = root().join(format!("fixtures/problems/{name}.toml"));
        let text = fs::read_to_string(&file).with_context(|| format!("{} cannot be read", file.display()))?;
        let problem = Problem::parse(name, &text, &Overrides::default()).map_err(nmt::NmtError::Problem)?;
        let picture = nmt::plot::png(&solution_svg(&problem, &solve_problem(&problem)?))?;
        let target = root().join(format!("docs/figures/{name}.png"));
        fs::write(&target, picture).with_context(|| format!("{} cannot be written", target.display()))?;
        println!("{name}.png");
    }
    Ok(())
}
