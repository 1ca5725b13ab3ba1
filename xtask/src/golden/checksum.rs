//! Which scripts made a case, and that nobody has edited what they wrote.

use crate::root;
use anyhow::{Context as _, Result, bail};
use sha2::{Digest as _, Sha256};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

/// The scripts that make the cases, each with a file that it writes: a case without that file is made without the script.
const SCRIPTS: [(&str, &str); 3] =
    [("write_case", "nodes.csv"), ("write_stars", "star.csv"), ("write_solutions", "local.csv")];

/// The file that holds the checksums of a case.
const FILE: &str = "checksums.txt";

/// Writes the checksums of a case that has just been made.
pub fn write(case: &Path) -> Result<()> {
    fs::write(case.join(FILE), of_case(case)?)?;
    Ok(())
}

/// # Errors
/// Where the scripts, the problem or the expected numbers are not those of the last regeneration.
pub fn verify(case: &Path) -> Result<()> {
    let file = case.join(FILE);
    let recorded = fs::read_to_string(&file)
        .with_context(|| format!("{} cannot be read; run cargo xtask golden --regenerate", file.display()))?;
    let found = of_case(case)?;
    if let Some((old, new)) = recorded.lines().zip(found.lines()).find(|(old, new)| old != new) {
        bail!(
            "{}: recorded {old}, found {new}; these files have changed since the reference was made: run cargo xtask \
             golden --regenerate",
            file.display()
        );
    }
    if recorded.lines().count() != found.lines().count() {
        bail!("{} is incomplete; run cargo xtask golden --regenerate", file.display());
    }
    Ok(())
}

/// Checksums of the scripts that the case is made by, the random numbers, the problem, and the expected numbers, a line each.
pub fn of_case(case: &Path) -> Result<String> {
    let mut scripts = BTreeSet::new();
    for (script, file) in SCRIPTS {
        if script == "write_case" || case.join("expected").join(file).is_file() {
            scripts.extend(called_from(script, files_with(&root().join("fixtures/octave"), "m")?)?);
        }
    }
    let scripts = scripts.into_iter().collect();
    let random = vec![root().join("fixtures/golden/random.csv")];
    let expected = files_with(&case.join("expected"), "csv")?;
    let mut lines = String::new();
    for (what, files) in
        [("scripts", scripts), ("random", random), ("problem", vec![case.join("problem.toml")]), ("expected", expected)]
    {
        writeln!(lines, "{what} sha256 {}", of_files(&files)?)?;
    }
    Ok(lines)
}

/// A script and all that it calls, directly or not: those whose name is a word of one that is called.
fn called_from(script: &str, all: Vec<PathBuf>) -> Result<Vec<PathBuf>> {
    let name_of = |file: &PathBuf| file.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    let mut texts = BTreeMap::new();
    for file in all {
        texts.insert(name_of(&file), (fs::read_to_string(&file)?, file));
    }
    let mut called = BTreeSet::new();
    let mut pending = vec![script.to_owned()];
    while let Some(name) = pending.pop() {
        let Some((text, _)) = texts.get(&name) else { continue };
        if called.insert(name) {
            let is_part = |c: char| c.is_ascii_alphanumeric() || c == '_';
            let words = text.split(|c: char| !is_part(c));
            pending.extend(words.filter(|word| texts.contains_key(*word)).map(str::to_owned));
        }
    }
    if called.is_empty() {
        bail!("fixtures/octave has no {script}.m");
    }
    Ok(called.into_iter().filter_map(|name| texts.get(&name).map(|(_, file)| file.clone())).collect())
}

/// Files of a directory with this ending, by name.
fn files_with(directory: &Path, ending: &str) -> Result<Vec<PathBuf>> {
    let entries = fs::read_dir(directory).with_context(|| format!("{} cannot be read", directory.display()))?;
    let mut files: Vec<PathBuf> = entries.filter_map(|entry| entry.ok().map(|entry| entry.path())).collect();
    files.retain(|file| file.extension().is_some_and(|found| found == ending));
    files.sort();
    Ok(files)
}

/// One checksum of names and contents; line ends as git may write them do not count.
fn of_files(files: &[PathBuf]) -> Result<String> {
    let mut hash = Sha256::new();
    for file in files {
        let text = fs::read_to_string(file).with_context(|| format!("{} cannot be read", file.display()))?;
        let name = file.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        hash.update(format!("{name}\n{}\n", text.replace("\r\n", "\n")));
    }
    let mut hex = String::new();
    for byte in hash.finalize() {
        write!(hex, "{byte:02x}")?;
    }
    Ok(hex)
}
