//! Reading the problem, writing results: a file is complete or not there.

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

/// The directory that results go to.
pub struct OutDir<'a>(&'a Path);

impl<'a> OutDir<'a> {
    /// Creates it if need be.
    pub fn create(path: &'a Path) -> Result<Self, Failure> {
        fs::create_dir_all(path).map_err(|source| Failure::io(path, "written", source))?;
        Ok(Self(path))
    }

    /// Writes a file under another name first, so that an interrupted run leaves no half of it.
    pub fn write(&self, name: &str, bytes: impl AsRef<[u8]>) -> Result<(), Failure> {
        let (part, path) = (self.0.join(format!(".{name}.part")), self.0.join(name));
        fs::write(&part, bytes).map_err(|source| Failure::io(&part, "written", source))?;
        fs::rename(&part, &path).map_err(|source| Failure::io(&path, "written", source))
    }

    /// Writes a picture as NAME.svg and NAME.png.
    pub fn write_picture(&self, name: &str, svg: &str) -> Result<(), Failure> {
        self.write(&format!("{name}.svg"), svg)?;
        let png = nmt::plot::png(svg).map_err(|source| Failure::Picture { name: format!("{name}.png"), source })?;
        self.write(&format!("{name}.png"), png)
    }
}

/// Writes to stdout; a reader that has gone away is a failure of output, not a panic.
pub fn print(text: &str) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    out.write_all(text.as_bytes())
        .and_then(|()| out.flush())
        .map_err(|e| Failure::io(Path::new("stdout"), "written", e))
}
