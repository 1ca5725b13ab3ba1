//! Reading the problem, writing to stdout.

use crate::exit::Failure;
use nmt::problem::Source;
use std::fs;
use std::io::Write as _;
use std::path::Path;

/// The problem file's text.
pub fn read_problem(file: &Path) -> Result<Source, Failure> {
    let bytes = fs::read(file).map_err(|source| Failure::io(file, "read", source))?;
    match String::from_utf8(bytes) {
        Ok(text) => Ok(Source { file: file.display().to_string(), text }),
        Err(error) => Err(Failure::NotText { file: file.into(), at: error.utf8_error().valid_up_to() }),
    }
}

/// Writes to stdout; a reader that has gone away is a failure of output, not a panic.
pub fn print(text: &str) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    out.write_all(text.as_bytes())
        .and_then(|()| out.flush())
        .map_err(|e| Failure::io(Path::new("stdout"), "written", e))
}
