//! Instructions of the hot kernels, which no other load on the machine disturbs, counted by valgrind.

use super::baseline::{Baseline, Verdict};
use super::run::target;
use crate::root;
use anyhow::{Context as _, Result, bail};
use nmt_cloud::{Cloud, CloudParams, Nearest, Scratch, Section, generate};
use nmt_curve::Outline;
use nmt_mfdm::kernels::Kernel;
use nmt_tri::Mesh;
use std::collections::BTreeMap;
use std::env;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Those of clouds and meshes; [`Kernel::ALL`] has the others.
const GEOMETRIC: [&str; 3] = ["cloud", "lattice mesh", "nine nearest"];

/// Counts every kernel and reports those that changed.
pub fn check() -> Result<()> {
    let recorded = Baseline::read(&file())?;
    let found = count_all()?;
    let mut failed = 0;
    for (name, verdict) in recorded.compare(&found) {
        println!("{name:22} {verdict}");
        failed += usize::from(verdict.is_failure());
    }
    if failed > 0 {
        bail!("{failed} kernels differ from xtask/kernels.toml: mend them, or record them by cargo xtask perf --bless");
    }
    Ok(())
}

/// Records the counts of today.
pub fn bless() -> Result<()> {
    let found = count_all()?;
    let verdicts = Baseline::read(&file()).unwrap_or_default().compare(&found);
    let changed = verdicts.iter().filter(|(_, verdict)| *verdict != Verdict::Same);
    changed.for_each(|(name, verdict)| println!("{name:22} {verdict}"));
    Baseline(found).write(&file())
}

fn file() -> PathBuf {
    root().join("xtask/kernels.toml")
}

/// Instructions of one run of each kernel: of two runs less those of one, so that what prepares them cancels.
fn count_all() -> Result<BTreeMap<String, u64>> {
    let cargo = env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let status = Command::new(cargo).args(["build", "--release", "-p", "xtask"]).current_dir(root()).status()?;
    if !status.success() {
        bail!("xtask does not build");
    }
    let program = target()?.join("release").join("xtask");
    let names = GEOMETRIC.into_iter().chain(Kernel::ALL.map(|(name, _)| name));
    let count = |name: &str| -> Result<(String, u64)> {
        let (once, twice) = (instructions(&program, name, "1")?, instructions(&program, name, "2")?);
        Ok((name.to_owned(), twice.checked_sub(once).context("twice the work took fewer instructions")?))
    };
    names.map(count).collect()
}

fn instructions(program: &Path, name: &str, times: &str) -> Result<u64> {
    let output = Command::new("valgrind")
        .args(["--tool=cachegrind", "--cache-sim=no", "--cachegrind-out-file=/dev/null"])
        .arg(program)
        .args(["perf", "--kernel", name, times])
        .output()
        .context("valgrind does not start: install it, for instance by apt-get install valgrind")?;
    let text = String::from_utf8_lossy(&output.stderr);
    if !output.status.success() {
        bail!("{name}: {text}");
    }
    refs(&text).with_context(|| format!("valgrind prints no line `I refs`: {text}"))
}

/// The number of valgrind's line `I refs: 1,234`.
fn refs(text: &str) -> Option<u64> {
    let line = text.lines().find(|line| line.contains('I') && line.contains("refs:"))?;
    line.rsplit(':').next()?.trim().replace(',', "").parse().ok()
}

/// Runs one kernel so many times; what valgrind counts.
pub fn kernel(name: &str, times: &str) -> Result<()> {
    let times: usize = times.parse().context("how many times?")?;
    let section =
        Section { contour: Outline::rectangle([0.0, 0.0], [4.0, 1.0]), holes: vec![Outline::circle([2.0, 0.5], 0.25)] };
    let params = CloudParams { nodes: [103, 26], irregularity: 0.25, ..CloudParams::default() };
    let cloud = generate(&section, &params)?;
    let done: f64 = match GEOMETRIC.iter().position(|known| *known == name) {
        Some(0) => (0..times).map(|_| Ok(generate(&section, &params)?.n_nodes() as f64)).sum::<Result<f64>>()?,
        Some(1) => {
            let triangles = |_| Ok(Mesh::constrained(cloud.clone())?.n_triangles() as f64);
            (0..times).map(triangles).sum::<Result<f64>>()?
        }
        Some(_) => (0..times).map(|_| nine_nearest(&cloud)).sum(),
        None => {
            let found = Kernel::ALL.iter().find(|(known, _)| *known == name);
            let (_, kernel) = found.with_context(|| format!("no kernel `{name}`"))?;
            kernel.run(&Mesh::constrained(cloud)?, times)?
        }
    };
    println!("{done}");
    Ok(())
}

fn nine_nearest(cloud: &Cloud) -> f64 {
    let nearest = Nearest::new(cloud.xy());
    let (mut scratch, mut found) = (Scratch::default(), Vec::new());
    let mut sum = 0.0;
    for p in cloud.xy() {
        nearest.nearest_of_all(*p, 9, &mut scratch, &mut found);
        sum += found.iter().map(|node| node.index() as f64).sum::<f64>();
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_count_is_read_from_what_valgrind_prints() {
        assert_eq!(refs("==7== Command: x\n12\n==7== I refs:        1,234,567\n"), Some(1_234_567));
        assert_eq!(refs("==7== I   refs:        12\n"), Some(12));
        assert_eq!(refs("nothing"), None);
    }

    #[test]
    fn every_kernel_does_something_and_an_unknown_one_is_an_error() {
        for name in GEOMETRIC.into_iter().chain(Kernel::ALL.map(|(name, _)| name)) {
            assert!(kernel(name, "1").is_ok(), "{name}");
        }
        assert!(kernel("no such", "1").is_err());
    }
}
