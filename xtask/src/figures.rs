//! Pictures of the documentation, from the shipped problems.

use crate::golden::read_problem;
use crate::root;
use anyhow::{Context as _, Result};
use nmt::figures::{edges_svg, error_svg, nodes_svg, solution_svg, stages_svg, star_svg};
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

/// The problem of which the documentation shows where its error comes from: a fillet and a hole, both small.
const UNCERTAIN: &str = r#"
title = "An L with a fillet and a hole of 1/100 of its size"
[[subdomain]]
nodes = [21, 21]
outline = [[0, 0], [2, 0], [2, 1], [1.02, 1], { arc = { centre = [1.02, 1.02], ccw = false } }, [1, 1.02], [1, 2], [0, 2]]
[[subdomain.hole]]
circle = { centre = [0.4, 0.4], radius = 0.02 }
[solve]
tolerance = 1e-4
"#;

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
    let problem = Problem::parse("uncertain.toml", UNCERTAIN, &Overrides::default()).map_err(nmt::NmtError::Problem)?;
    write("error", &error_svg(&problem, &solve_problem(&problem)?).context("an estimate")?)?;
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
