//! Two adjacent subdomains of different density: each is solved alone, as in the paper, and their common edge is found.

use nmt::prelude::*;
use nmt_merge::{Side, common_edges};

const PROBLEM: &str = r#"
title = "Square and triangle"
[[subdomain]]
name = "square"
nodes = [21, 21]
outline = [[0, 0], [2, 0], [2, 2], [0, 2]]
[[subdomain]]
name = "triangle"
nodes = [31, 31]
outline = [[2, 0], [4, 0], [2, 2]]
"#;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let problem = Problem::parse("two.toml", PROBLEM, &Overrides::default()).map_err(nmt::NmtError::Problem)?;
    let solved = solve_problem(&problem)?;
    // Series solutions of the square of side 2 and of the right isosceles triangle of leg 2.
    for (part, reference) in solved.iter().zip([2.249_232_239_28, 0.417_434_427_38]) {
        let j = part.solution.j;
        println!("{:9} J = {j:.6}, exact {reference:.6}", part.part.name);
        assert!((j / reference - 1.0).abs() < 1e-3);
    }
    let sides: Vec<Side> =
        solved.iter().map(|s| Side { section: &s.part.section, cloud: s.part.mesh.cloud() }).collect();
    for edge in common_edges(&sides) {
        println!("common edge from {:?} to {:?}", edge.from, edge.to);
    }
    let meshes = solved.iter().map(|s| (&*s.part.name, &s.part.mesh));
    std::fs::create_dir_all("target/examples-out")?;
    std::fs::write("target/examples-out/two-subdomains.svg", nmt::figures::mesh_svg(&problem, meshes))?;
    Ok(())
}
