//! nmt's own results: the shipped problems in both formulations.
//!
//! `expected.csv` holds formulation, subdomain, quantity, value. They show what a change moves, not what is right; that is
//! what the verification tests are for.

use super::{Entry, Scale, read_problem};
use anyhow::{Context as _, Result};
use nmt::prelude::*;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

/// Rewrites the expected results of a problem.
pub fn write_expected(problem: &Path, file: &Path) -> Result<()> {
    let mut text = String::from("formulation,subdomain,quantity,value\n");
    for entry in results(problem)? {
        writeln!(text, "{},{:.16e}", entry.id, entry.value)?;
    }
    fs::write(file, text)?;
    Ok(())
}

/// The results of a problem, in both formulations.
pub fn results(file: &Path) -> Result<Vec<Entry>> {
    let mut entries = Vec::new();
    for formulation in Formulation::ALL {
        let overrides = Overrides { formulation: Some(formulation.name().into()), ..Overrides::default() };
        let problem = read_problem(file, &overrides)?;
        let solved = solve_any(&problem)?;
        for (k, part) in solved.parts().into_iter().enumerate() {
            let mesh = &part.mesh;
            let mut add = |quantity: &str, value: f64| {
                let id = format!("{},{},{quantity}", formulation.name(), part.name);
                entries.push(Entry { id, value, scale: Scale::Itself });
            };
            add("nodes", mesh.cloud().n_nodes() as f64);
            add("triangles", mesh.n_triangles() as f64);
            add("area", mesh.total_area());
            match &solved {
                Solved::Torsion(parts) => {
                    let solution = &parts[k].solution;
                    add("J", solution.j);
                    add("F_max", solution.f_max.value);
                    add("tau_max", solution.tau_max.value);
                    for (name, hole) in part.hole_names.iter().zip(&solution.holes) {
                        add(&format!("F on {name}"), hole.f);
                    }
                }
                Solved::Poisson(parts) => {
                    let magnitude = |[x, y]: [f64; 2]| x.hypot(y);
                    add("integral of u", parts[k].solution.field.volume(mesh));
                    add("largest gradient", parts[k].gradients().into_iter().map(magnitude).fold(0.0, f64::max));
                }
            }
        }
    }
    Ok(entries)
}

/// The committed results of a problem.
pub fn read_expected(file: &Path) -> Result<Vec<Entry>> {
    let text = fs::read_to_string(file).with_context(|| format!("{} cannot be read", file.display()))?;
    let entry = |line: &str| {
        let (id, value) = line.rsplit_once(',').context("a line without a comma")?;
        Ok(Entry { id: id.into(), value: value.trim().parse()?, scale: Scale::Itself })
    };
    text.lines().skip(1).map(entry).collect()
}
