//! Golden tests: what nmt computes against what is committed under `fixtures/golden`.
//!
//! Each case is a directory with `case.toml` (what it is for, where its numbers come from, the tolerance and its reason)
//! and `expected/`. Two kinds, told apart by `reference`:
//!
//! * `"octave"`: made by the scripts of `fixtures/octave`, an independent implementation in the MATLAB language;
//! * `"nmt"`: nmt's own numbers, which show what a change moves, not what is right.

mod checksum;
mod clouds;
mod common;
mod fixture;
mod meshes;
mod parts;
mod results;
mod solutions;
mod stars;

use crate::root;
use anyhow::{Context as _, Result, bail};
use parts::{Compared, Parts};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// One number of a result.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// What names it in the file.
    pub id: String,
    /// The number.
    pub value: f64,
    /// What a difference is divided by: a size, the number itself, or nothing for a number that must be equal.
    pub scale: Scale,
}

/// What the difference of an entry is measured in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Scale {
    /// The expected number itself.
    Itself,
    /// A length.
    Length(f64),
    /// It must be equal: a count, a number of a node or an edge.
    Exact,
}

impl Entry {
    /// How far `found` is from this expected entry.
    fn difference(&self, found: &Self) -> f64 {
        let off = (found.value - self.value).abs();
        match self.scale {
            _ if off == 0.0 => 0.0,
            Scale::Exact => f64::INFINITY,
            Scale::Itself => off / self.value.abs().max(f64::MIN_POSITIVE),
            // NaN is no agreement.
            Scale::Length(length) => {
                if off.is_nan() {
                    f64::INFINITY
                } else {
                    off / length
                }
            }
        }
    }
}

/// Where the expected numbers of a case come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Reference {
    Octave,
    Own,
}

struct Case {
    name: String,
    directory: PathBuf,
    reference: Reference,
    problem: PathBuf,
    tolerance: f64,
    parts: Parts,
}

/// The worst of a comparison.
#[derive(Debug)]
struct Worst {
    expected: Entry,
    found: Entry,
    difference: f64,
}

/// Compares every case and prints the worst entry of each of its parts, or why there is none.
pub fn compare() -> Result<()> {
    let mut failed = Vec::new();
    for case in cases()? {
        let compared = match compared(&case) {
            Ok(compared) => compared,
            Err(error) => {
                println!("{:26} {error:#}", case.name);
                failed.push(case.name);
                continue;
            }
        };
        for Compared { name, expected, found, tolerance } in compared {
            let title = if name == "cloud" { case.name.clone() } else { format!("  {name}") };
            match worst(&expected, &found) {
                Ok(Worst { expected, found, difference }) => {
                    println!(
                        "{title:26} worst entry {}: expected {:e}, found {:e}, off by {difference:.1e}",
                        expected.id, expected.value, found.value
                    );
                    if difference > tolerance {
                        failed.push(format!("{} ({}, tolerance {tolerance:.0e})", case.name, expected.id));
                    }
                }
                Err(error) => {
                    println!("{title:26} {error:#}");
                    failed.push(case.name.clone());
                }
            }
        }
    }
    if failed.is_empty() { Ok(()) } else { bail!("golden results differ: {}", failed.join(", ")) }
}

/// The parts of a case, the first of them its clouds or our own results.
fn compared(case: &Case) -> Result<Vec<Compared>> {
    let of_first = |(expected, found)| Compared { name: "cloud", expected, found, tolerance: case.tolerance };
    if case.reference == Reference::Own {
        let expected = results::read_expected(&case.directory.join("expected.csv"))?;
        return Ok(vec![of_first((expected, results::results(&case.problem)?))]);
    }
    checksum::verify(&case.directory)?;
    let directory = case.directory.join("expected");
    let mut compared = vec![of_first(clouds::entries(&case.problem, &directory)?)];
    compared.extend(case.parts.compared(&clouds::clouds(&case.problem)?, &directory)?);
    Ok(compared)
}

/// Rewrites the expected results: those of Octave by its scripts, our own from the present code.
pub fn regenerate() -> Result<()> {
    for script in ["write_all", "write_all_solutions"] {
        octave(&format!("{script}('{}')", root().join("fixtures/golden").display()))?;
    }
    for case in cases()? {
        match case.reference {
            Reference::Octave => checksum::write(&case.directory)?,
            Reference::Own => results::write_expected(&case.problem, &case.directory.join("expected.csv"))?,
        }
        println!("{:26} rewritten", case.name);
    }
    Ok(())
}

/// Runs a command of the reference's scripts.
fn octave(text: &str) -> Result<()> {
    let mut command = Command::new("octave-cli");
    command.args(["--quiet", "--norc", "--path"]).arg(root().join("fixtures/octave"));
    command.arg("--eval").arg(text).current_dir(root().join("fixtures/octave"));
    let status =
        command.status().context("octave-cli cannot be started; install GNU Octave (Debian package octave)")?;
    if !status.success() {
        bail!("octave-cli failed on {text}");
    }
    Ok(())
}

/// The entry that is farthest off; both lists must name the same things in the same order.
fn worst(expected: &[Entry], found: &[Entry]) -> Result<Worst> {
    if let Some((e, f)) = expected.iter().zip(found).find(|(e, f)| e.id != f.id) {
        bail!("expected lists {}, the results {}", e.id, f.id);
    }
    if expected.len() != found.len() {
        bail!("expected lists {} entries, the results {}", expected.len(), found.len());
    }
    let differences = expected.iter().zip(found).map(|(e, f)| (e, f, e.difference(f)));
    let worst = differences.max_by(|a, b| a.2.total_cmp(&b.2)).context("nothing is expected")?;
    Ok(Worst { expected: worst.0.clone(), found: worst.1.clone(), difference: worst.2 })
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
    let word = |key: &str| value(key).and_then(|v| v.as_str()).with_context(|| format!("{}: no {key}", file.display()));
    let reference = match word("reference")? {
        "octave" => Reference::Octave,
        "nmt" => Reference::Own,
        other => bail!("{}: reference = \"{other}\" is neither \"octave\" nor \"nmt\"", file.display()),
    };
    word("reason")?;
    let problem = match reference {
        Reference::Octave => directory.join("problem.toml"),
        Reference::Own => root().join("fixtures/problems").join(word("problem")?),
    };
    let tolerance = parts::number(table.get_ref(), "tolerance").with_context(|| file.display().to_string())?;
    let parts = Parts::of(table.get_ref()).with_context(|| file.display().to_string())?;
    Ok(Case {
        name: directory.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default(),
        reference,
        problem,
        tolerance,
        parts,
        directory,
    })
}

/// A problem file as the command reads it.
pub fn read_problem(file: &Path, overrides: &nmt::problem::Overrides) -> Result<nmt::problem::Problem> {
    let text = fs::read_to_string(file).with_context(|| format!("{} cannot be read", file.display()))?;
    let problem = nmt::problem::Problem::parse(&file.display().to_string(), &text, overrides);
    Ok(problem.map_err(nmt::NmtError::Problem)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn case(name: &str) -> Case {
        read_case(root().join("fixtures/golden").join(name)).expect("a case")
    }

    fn entries(name: &str) -> (Case, Vec<Entry>, Vec<Entry>) {
        let case = case(name);
        let (expected, found) = clouds::entries(&case.problem, &case.directory.join("expected")).expect("a cloud");
        (case, expected, found)
    }

    #[test]
    fn one_changed_number_of_any_file_is_found() {
        assert_changes_are_found("cloud-holes", &["nodes", "segments", "census", "edges", "mesh"]);
        assert_changes_are_found("cloud-meeting", &["common_edges", "common_nodes"]);
    }

    /// The first and the last number of each file, changed by what a digit can be.
    fn assert_changes_are_found(name: &str, files: &[&str]) {
        let (case, expected, found) = entries(name);
        assert!(worst(&expected, &found).expect("entries").difference <= case.tolerance);
        for &file in files {
            let of_file = |e: &&mut Entry| e.id.starts_with(file);
            let n = expected.iter().filter(|e| e.id.starts_with(file)).count();
            assert!(n > 5, "{file}: {n}");
            for k in [0, n - 1] {
                let mut changed = expected.clone();
                let Some(entry) = changed.iter_mut().filter(of_file).nth(k) else { panic!("{file} has {n} entries") };
                entry.value += if entry.scale == Scale::Exact { 1.0 } else { 1e-6 };
                let id = entry.id.clone();
                let worst = worst(&changed, &found).expect("entries");
                assert!(worst.difference > case.tolerance && worst.expected.id == id, "{id}: {worst:?}");
            }
        }
    }

    #[test]
    fn a_common_edge_that_ends_elsewhere_lists_its_nodes_backwards_or_is_missing_is_found() {
        let (case, expected, found) = entries("cloud-meeting");
        let is_of = |e: &Entry, column: &str| e.id.starts_with("common_edges") && e.id.ends_with(column);
        let mut moved = expected.clone();
        for entry in moved.iter_mut().filter(|e| is_of(e, "to_y")) {
            entry.value += 1e-9;
        }
        assert!(worst(&moved, &found).expect("entries").difference > case.tolerance);
        let mut backwards = expected.clone();
        let is_first = |e: &Entry| e.id.starts_with("common_nodes.csv, common_edge 1, side 2");
        let nodes: Vec<f64> = expected.iter().filter(|e| is_first(e)).map(|e| e.value).collect();
        backwards.iter_mut().filter(|e| is_first(e)).zip(nodes.iter().rev()).for_each(|(e, &node)| e.value = node);
        assert_eq!(nodes.len(), 12);
        assert!(worst(&backwards, &found).expect("entries").difference > case.tolerance);
        let without: Vec<Entry> = expected.into_iter().filter(|e| !e.id.contains("edge1 3, edge2 1")).collect();
        assert!(worst(&without, &found).is_err());
    }

    #[test]
    fn a_missing_node_is_an_error() {
        let (_, mut expected, found) = entries("cloud-skew");
        expected.pop();
        assert!(worst(&expected, &found).is_err());
        expected.remove(0);
        assert!(worst(&expected, &found).is_err());
    }

    #[test]
    fn files_that_were_edited_by_hand_are_found() {
        let directory = root().join("fixtures/golden/cloud-skew");
        let sound = checksum::of_case(&directory).expect("a case");
        assert_eq!(checksum::verify(&directory).ok(), Some(()));
        let elsewhere = checksum::of_case(&root().join("fixtures/golden/cloud-holes")).expect("a case");
        assert_ne!(sound, elsewhere);
    }

    #[test]
    fn a_case_with_solutions_is_made_by_more_scripts() {
        let scripts = |name: &str| {
            let text = checksum::of_case(&root().join("fixtures/golden").join(name)).expect("a case");
            text.lines().next().map(str::to_owned)
        };
        assert_eq!(scripts("cloud-skew"), scripts("cloud-narrow"));
        assert_eq!(scripts("cloud-holes"), scripts("cloud-level-arch"));
        let distinct = std::collections::BTreeSet::from(["cloud-skew", "cloud-ties", "cloud-holes"].map(scripts));
        assert_eq!(distinct.len(), 3); // clouds alone, stars too, solutions too
    }
}
