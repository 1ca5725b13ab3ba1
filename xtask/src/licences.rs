//! Licences of all dependencies: nmt stays free of copyleft.

use crate::root;
use anyhow::{Context as _, Result, bail};
use std::process::Command;

/// What a dependency may be licensed under; of alternatives, one must be here.
const ALLOWED: [&str; 10] = [
    "MIT",
    "Apache-2.0",
    "Apache-2.0 WITH LLVM-exception",
    "BSD-2-Clause",
    "BSD-3-Clause",
    "BSL-1.0",
    "ISC",
    "Unicode-3.0",
    "Zlib",
    "0BSD",
];

/// Checks every package that cargo knows of.
pub fn check() -> Result<()> {
    let output = Command::new("cargo")
        .args(["metadata", "--format-version", "1", "--locked"])
        .current_dir(root())
        .output()
        .context("cargo metadata cannot be started")?;
    let metadata: serde_json::Value = serde_json::from_slice(&output.stdout).context("cargo metadata is no JSON")?;
    let packages = metadata["packages"].as_array().context("cargo metadata lists no packages")?;
    let licence = |package: &serde_json::Value| package["license"].as_str().unwrap_or("none").to_owned();
    let refused: Vec<String> = packages
        .iter()
        .filter(|package| !is_allowed(&licence(package)))
        .map(|package| format!("{}: {}", package["name"].as_str().unwrap_or("?"), licence(package)))
        .collect();
    if !refused.is_empty() {
        bail!("licences that are not allowed:\n{}", refused.join("\n"));
    }
    println!("licences of {} packages are allowed", packages.len());
    Ok(())
}

/// An SPDX expression of alternatives, each a conjunction; parentheses only group alternatives within a conjunction.
fn is_allowed(expression: &str) -> bool {
    let expression = expression.replace('/', " OR ");
    let conjuncts: Vec<String> = split_outside_parentheses(&expression, " AND ");
    conjuncts.iter().all(|conjunct| {
        let inner = conjunct.trim().trim_start_matches('(').trim_end_matches(')');
        inner.split(" OR ").any(|licence| ALLOWED.contains(&licence.trim()))
    })
}

fn split_outside_parentheses(text: &str, separator: &str) -> Vec<String> {
    let mut parts = vec![String::new()];
    let mut depth = 0;
    let mut rest = text;
    while let Some(c) = rest.chars().next() {
        if depth == 0 && rest.starts_with(separator) {
            parts.push(String::new());
            rest = &rest[separator.len()..];
            continue;
        }
        depth += i32::from(c == '(') - i32::from(c == ')');
        if let Some(part) = parts.last_mut() {
            part.push(c);
        }
        rest = &rest[c.len_utf8()..];
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::is_allowed;

    #[test]
    fn one_of_the_alternatives_must_be_allowed_and_all_of_a_conjunction() {
        assert!(is_allowed("MIT OR Apache-2.0 OR LGPL-2.1-or-later"));
        assert!(is_allowed("(MIT OR Apache-2.0) AND Unicode-3.0"));
        assert!(is_allowed("MIT/Apache-2.0"));
        assert!(!is_allowed("AGPL-3.0"));
        assert!(!is_allowed("MIT AND GPL-3.0"));
        assert!(!is_allowed("none"));
    }
}
