//! Pictures of the documentation, from the shipped problems.

use crate::golden::read_problem;
use crate::root;
use anyhow::{Context as _, Result};
use nmt::figures::{edges_svg, nodes_svg, solution_svg, stages_svg, star_svg};
use nmt::pipeline::{clouds, meshes};
use nmt::prelude::*;
use nmt::star::StarView;
use std::fs;

/// The problems whose four panels the documentation shows.
const SHOWN: [&str; 1] = ["paper-3"];

/// The problem whose edges the documentation shows.
const EDGES: &str = "i-section";

/// The problem whose cloud the documentation shows.
const GRADED: &str = "graded-l";

/// The problem whose mesh the documentation shows in its four stages.
const STAGES: &str = "bare-segment";

/// The node of that problem whose star the documentation shows.
const STAR: usize = 27;

/// Redraws docs/figures.
pub fn draw() -> Result<()> {
    for name in SHOWN {
        let problem = shipped(name)?;
        write(name, &solution_svg(&problem, &solve_problem(&problem)?))?;
    }
    let problem = shipped(EDGES)?;
    write("edges", &edges_svg(&problem, &solve_problem(&problem)?))?;
    let problem = shipped(GRADED)?;
    let parts = clouds(&problem, &mut |_, _| {})?;
    write(GRADED, &nodes_svg(&problem, parts.iter().map(|part| (part.name.as_str(), &part.cloud))))?;
    let problem = shipped(STAGES)?;
    for part in clouds(&problem, &mut |_, _| {})? {
        let stages = nmt_tri::stages(&part.cloud, &nmt_tri::Elimination::default())?;
        for (picture, letter) in stages_svg(&problem.units, &part.name, &part.cloud, &stages).iter().zip('a'..) {
            write(&format!("{STAGES}-{letter}"), picture)?;
        }
    }
    let parts = meshes(&problem, clouds(&problem, &mut |_, _| {})?, &mut |_, _| {})?;
    write(&format!("star-{STAR}"), &star_svg(&problem, &StarView::new(&problem, &parts, None, STAR)?))
}

fn shipped(name: &str) -> Result<Problem> {
    read_problem(&root().join(format!("fixtures/problems/{name}.toml")), &Overrides::default())
}

/// Writes a picture as PNG.
fn write(name: &str, svg: &str) -> Result<()> {
    let target = root().join(format!("docs/figures/{name}.png"));
    fs::write(&target, nmt::plot::png(svg)?).with_context(|| format!("{} cannot be written", target.display()))?;
    println!("{name}.png");
    Ok(())
}
