//! Tables of numbers as the reference writes them: one header line, numbers separated by commas, all counts from 1.

use anyhow::{Context as _, Result, bail};
use std::fs;
use std::path::Path;

/// A table of numbers with named columns.
pub struct Table {
    columns: Vec<String>,
    /// Rows in the order of the file.
    pub rows: Vec<Vec<f64>>,
}

impl Table {
    /// Reads a table and checks that it has the columns.
    pub fn read(file: &Path, columns: &[&str]) -> Result<Self> {
        let text = fs::read_to_string(file).with_context(|| format!("{} cannot be read", file.display()))?;
        let mut lines = text.lines();
        let header: Vec<String> = lines.next().unwrap_or_default().split(',').map(|name| name.trim().into()).collect();
        if header != columns {
            bail!("{}: columns {header:?} where {columns:?} belong", file.display());
        }
        let rows = lines.enumerate().map(|(k, line)| {
            let row = numbers(line).with_context(|| format!("{}, line {}", file.display(), k + 2))?;
            if row.len() == columns.len() { Ok(row) } else { bail!("{}, line {}: wrong length", file.display(), k + 2) }
        });
        Ok(Self { rows: rows.collect::<Result<_>>()?, columns: header })
    }

    /// Names of the columns.
    pub fn columns(&self) -> &[String] {
        &self.columns
    }
}

/// The numbers of one line.
pub fn numbers(line: &str) -> Result<Vec<f64>> {
    line.split(',').map(|text| text.trim().parse().with_context(|| format!("`{text}` is no number"))).collect()
}
