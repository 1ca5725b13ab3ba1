//! Pictures of the documentation, from the shipped problems.

use crate::root;
use anyhow::{Context as _, Result};
use nmt::figures::{mesh_svg, nodes_svg, solution_svg};
use nmt::prelude::*;
use std::fs;

/// Problem, density and the pictures wanted: coarser than the files', so that nodes can be told apart.
const FIGURES: [(&str, [usize; 2], &[&str]); 2] =
    [("paper-3", [61, 46], &["nodes", "mesh", "solution"]), ("paper-2", [41, 31], &["solution"])];

/// Redraws docs/figures.
pub fn draw() -> Result<()> {
    let directory = root().join("docs/figures");
    fs::create_dir_all(&directory)?;
    for (name, nodes, wanted) in FIGURES {
        let file = root().join(format!("fixtures/problems/{name}.toml"));
        let text = fs::read_to_string(&file).with_context(|| format!("{} cannot be read", file.display()))?;
        let overrides = Overrides { nodes: Some(nodes), ..Overrides::default() };
        let problem = Problem::parse(name, &text, &overrides).map_err(nmt::NmtError::Problem)?;
        let solved = solve_problem(&problem)?;
        let meshes = || solved.iter().map(|s| (&*s.part.name, &s.part.mesh));
        for picture in wanted {
            let svg = match *picture {
                "nodes" => nodes_svg(&problem, meshes().map(|(name, mesh)| (name, mesh.cloud()))),
                "mesh" => mesh_svg(&problem, meshes()),
                _ => solution_svg(&problem, &solved),
            };
            fs::write(directory.join(format!("{name}-{picture}.png")), nmt::plot::png(&svg)?)?;
            println!("{name}-{picture}.png");
        }
    }
    Ok(())
}
