//! The directory that results go to: all files of a run come into it together, or none does.
//!
//! They are written into a directory of its own inside, `.nmt-N.part`, and renamed into place when all are complete. An
//! error, a full disk or Ctrl-C before that leaves the directory as it was, and removes it where the run had created it.

use crate::exit::Failure;
use crate::interrupt::{Traces, uninterrupted};
use crate::progress::Progress;
use std::fs::{self, File};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};

/// Bytes that are handed to the system at a time.
const BUFFER: usize = 1 << 18;

/// Unfinished runs that may have left their directory, for want of a chance to remove it, before no name is free.
const MOST_NAMES: u32 = 100;

/// The directory of one run's results.
#[derive(Debug)]
pub struct OutDir {
    path: PathBuf,
    traces: Traces,
    names: Vec<String>,
    progress: Progress,
}

impl OutDir {
    /// Creates it if need be; that nothing can be written there is found out before there is anything to write.
    pub fn create(path: &Path, progress: &Progress) -> Result<Self, Failure> {
        let failed = |source| Failure::io(path, "written", source);
        let mut held = uninterrupted();
        let is_missing = |ancestor: &&Path| !ancestor.as_os_str().is_empty() && !ancestor.exists();
        let mut created: Vec<PathBuf> = path.ancestors().take_while(is_missing).map(PathBuf::from).collect();
        created.reverse();
        let mut traces = Traces { unfinished: PathBuf::new(), created };
        match fs::create_dir_all(path).and_then(|()| unfinished(path)) {
            Ok(unfinished) => traces.unfinished = unfinished,
            Err(source) => {
                traces.remove();
                return Err(failed(source));
            }
        }
        held.begin(traces.clone());
        Ok(Self { path: path.into(), traces, names: Vec::new(), progress: progress.clone() })
    }

    /// Writes a file, which is not seen before [`OutDir::publish`].
    pub fn write(&mut self, name: &str, bytes: impl AsRef<[u8]>) -> Result<(), Failure> {
        self.write_with(name, |out| out.write_all(bytes.as_ref()))
    }

    /// The same, piece by piece.
    pub fn write_with(
        &mut self,
        name: &str,
        write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> Result<(), Failure> {
        self.tell(name);
        let begun = {
            let _held = uninterrupted();
            File::create(self.traces.unfinished.join(name))
        };
        let written = begun.and_then(|file| {
            let mut out = BufWriter::with_capacity(BUFFER, file);
            write(&mut out)?;
            out.flush()
        });
        written.map_err(|source| Failure::io(&self.path.join(name), "written", source))?;
        self.names.push(name.into());
        Ok(())
    }

    /// Writes a picture as NAME.svg and NAME.png.
    pub fn write_picture(&mut self, name: &str, svg: impl FnOnce() -> String) -> Result<(), Failure> {
        let [svg_name, png_name] = ["svg", "png"].map(|kind| format!("{name}.{kind}"));
        self.tell(&svg_name);
        let svg = svg();
        self.write(&svg_name, &svg)?;
        self.tell(&png_name);
        let png = nmt::plot::png(&svg).map_err(|source| Failure::Picture { name: png_name.clone(), source })?;
        self.write(&png_name, png)
    }

    fn tell(&self, name: &str) {
        let n = self.names.len();
        self.progress.begin(&format!("{name}, after {n} file{}", if n == 1 { "" } else { "s" }));
    }

    /// Puts all files in place, instead of those of the same names.
    pub fn publish(self) -> Result<(), Failure> {
        let mut held = uninterrupted();
        let failed = |name: &String, source| Failure::io(&self.path.join(name), "written", source);
        // The one obstacle that can be known: better none of the files than half of them.
        if let Some(name) = self.names.iter().find(|name| self.path.join(name).is_dir()) {
            return Err(failed(name, io::Error::new(ErrorKind::IsADirectory, "there is a directory of that name")));
        }
        for name in &self.names {
            fs::rename(self.traces.unfinished.join(name), self.path.join(name)).map_err(|e| failed(name, e))?;
        }
        held.end(&self.traces);
        Ok(())
    }
}

impl Drop for OutDir {
    fn drop(&mut self) {
        uninterrupted().end(&self.traces);
    }
}

/// A new directory for unfinished files.
fn unfinished(path: &Path) -> io::Result<PathBuf> {
    let id = u64::from(std::process::id());
    for k in 0..MOST_NAMES {
        let name = path.join(if k == 0 { format!(".nmt-{id}.part") } else { format!(".nmt-{id}-{k}.part") });
        match fs::create_dir(&name) {
            Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
            created => return created.map(|()| name),
        }
    }
    Err(io::Error::new(ErrorKind::AlreadyExists, "remove the directories .nmt-….part that killed runs left there"))
}
