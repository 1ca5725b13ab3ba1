//! Golden results: the shipped problems in both formulations against `fixtures/golden`.
//!
//! Each case is a directory with `case.toml` (the problem, its origin, the tolerance and its reason) and `expected.csv`
//! (formulation, subdomain, quantity, value). They are our own numbers: they show what a change moves, not what is right;
//! that is what the verification tests are for.

use crate::root;
use anyhow::{Context as _, Result, bail};
use nmt::prelude::*;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

/// One number of a result.
#[derive(Clone, Debug, PartialEq)]
struct Entry {
    /// formulation, subdomain, quantity: what names it in the file.
    id: String,
    value: f64,
}

struct Case {
    name: String,
    directory: PathBuf,
    problem: PathBuf,
    tolerance: f64,
}

/// Compares every case and prints its worst entry.
pub fn compare() -> Result<()> {
    let mut failed = Vec::new();
    for case in cases()? {
        let expected = read_expected(&case.directory.join("expected.csv"))?;
        let found = results(&case.problem)?;
        let ids = |entries: &[Entry]| entries.iter().map(|e| e.id.clone()).collect::<Vec<_>>();
        if ids(&expected) != ids(&found) {
            bail!(
                "{}: expected.csv lists other entries than the results; run cargo xtask golden --regenerate",
                case.name
            );
        }
        let difference = |(e, f): (&Entry, &Entry)| (f.value - e.value).abs() / e.value.abs().max(f64::MIN_POSITIVE);
        let worst = expected.iter().zip(&found).max_by(|a, b| difference(*a).total_cmp(&difference(*b)));
        let Some((e, f)) = worst else { bail!("{}: expected.csv is empty", case.name) };
        let off = if e.value == f.value { 0.0 } else { difference((e, f)) };
        println!(
            "{:12} worst entry {}: expected {:e}, found {:e}, relative {off:.1e}",
            case.name, e.id, e.value, f.value
        );
        if off > case.tolerance {
            failed.push(format!("{} ({}, tolerance {:.0e})", case.name, e.id, case.tolerance));
        }
    }
    if failed.is_empty() { Ok(()) } else { bail!("golden results differ: {}", failed.join(", ")) }
}

/// Rewrites the expected results of every case.
pub fn regenerate() -> Result<()> {
    for case in cases()? {
        let mut text = String::from("formulation,subdomain,quantity,value\n");
        for entry in results(&case.problem)? {
            writeln!(text, "{},{:.16e}", entry.id, entry.value)?;
        }
        fs::write(case.directory.join("expected.csv"), text)?;
        println!("{:12} rewritten", case.name);
    }
    Ok(())
}

fn cases() -> Result<Vec<Case>> {
    let directory = root().join("fixtures/golden");
    let mut directories: Vec<PathBuf> = fs::read_dir(&directory)
        .with_context(|| format!("{} cannot be read", directory.display()))?
        .filter_map(|entry| entry.ok().map(|entry| entry.path()))
        .filter(|path| path.join("case.toml").is_file())
        .collect();
    directories.sort();
    if directories.is_empty() {
        bail!("no golden case in {}", directory.display());
    }
    directories.into_iter().map(read_case).collect()
}

fn read_case(directory: PathBuf) -> Result<Case> {
    let file = directory.join("case.toml");
    let text = fs::read_to_string(&file)?;
    let table = toml::de::DeTable::parse(&text).map_err(|error| anyhow::anyhow!("{}: {error}", file.display()))?;
    let value = |key: &str| table.get_ref().get(key).map(|value| value.get_ref());
    let problem = value("problem").and_then(|v| v.as_str()).context("case.toml: no problem")?;
    let tolerance = value("tolerance").and_then(|v| v.as_float()).context("case.toml: no tolerance")?;
    Ok(Case {
        name: directory.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default(),
        problem: root().join("fixtures/problems").join(problem),
        tolerance: tolerance.as_str().replace('_', "").parse()?,
        directory,
    })
}

fn results(file: &Path) -> Result<Vec<Entry>> {
    let text = fs::read_to_string(file).with_context(|| format!("{} cannot be read", file.display()))?;
    let mut entries = Vec::new();
    for formulation in Formulation::ALL {
        let overrides = Overrides { formulation: Some(formulation.name().into()), ..Overrides::default() };
        let problem = Problem::parse(&file.display().to_string(), &text, &overrides).map_err(nmt::NmtError::Problem)?;
        for solved in solve_problem(&problem)? {
            let (mesh, solution) = (&solved.part.mesh, &solved.solution);
            let mut add = |quantity: &str, value: f64| {
                entries.push(Entry { id: format!("{},{},{quantity}", formulation.name(), solved.part.name), value });
            };
            add("nodes", mesh.cloud().n_nodes() as f64);
            add("triangles", mesh.n_triangles() as f64);
            add("area", mesh.total_area());
            add("J", solution.j);
            add("F_max", solution.f_max.value);
            add("tau_max", solution.tau_max.value);
            for (name, hole) in solved.part.hole_names.iter().zip(&solution.holes) {
                add(&format!("F on {name}"), hole.f);
            }
        }
    }
    Ok(entries)
}

fn read_expected(file: &Path) -> Result<Vec<Entry>> {
    let text = fs::read_to_string(file).with_context(|| format!("{} cannot be read", file.display()))?;
    let entry = |line: &str| {
        let (id, value) = line.rsplit_once(',').context("a line without a comma")?;
        Ok(Entry { id: id.into(), value: value.trim().parse()? })
    };
    text.lines().skip(1).map(entry).collect()
}
