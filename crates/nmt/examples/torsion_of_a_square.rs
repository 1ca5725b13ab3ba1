//! The torsion constant of the unit square against its series, in both meshless formulations, and its four panels.

use nmt::prelude::*;
use nmt_mfdm::exact;

const PROBLEM: &str = r#"
title = "Unit square"
units = "m"
[[subdomain]]
name = "square"
nodes = [41, 41]
irregularity = 0.25
rectangle = { from = [0, 0], to = [1, 1] }
"#;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let reference = exact::rectangle(1.0, 1.0).j;
    for formulation in Formulation::MESHLESS {
        let overrides = Overrides { formulation: Some(formulation.name().into()), ..Overrides::default() };
        let problem = Problem::parse("square.toml", PROBLEM, &overrides).map_err(nmt::NmtError::Problem)?;
        let solved = solve_problem(&problem)?;
        let j = solved[0].solution.j;
        let error = j / reference - 1.0;
        println!("{:11}  J = {j:.9} m⁴, exact {reference:.9} m⁴, relative error {error:+.1e}", formulation.name());
        assert!(error.abs() < 2e-4, "an irregular cloud of 41 × 41 gives J to 2e-4");
        let directory = std::path::Path::new("target/examples-out");
        std::fs::create_dir_all(directory)?;
        let file = directory.join(format!("square-{}.svg", formulation.name()));
        std::fs::write(file, nmt::figures::solution_svg(&problem, &solved))?;
    }
    Ok(())
}
