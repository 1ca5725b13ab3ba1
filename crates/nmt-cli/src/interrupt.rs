//! Ctrl-C: what an unfinished run would leave behind is removed, then the process ends with 128 plus the signal's number
//! (130 for Ctrl-C).
//!
//! The traces of runs under way stand in one list. Its lock orders everything: files are begun and put in place under it,
//! and the handler of the signal takes it for good, so that nothing comes after the cleaning up.

use std::path::PathBuf;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// What a run would leave behind.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Traces {
    /// The directory with its unfinished files.
    pub unfinished: PathBuf,
    /// Directories that it created, the outermost first; they go where they are empty.
    pub created: Vec<PathBuf>,
}

impl Traces {
    /// Removes them; what cannot be removed stays.
    pub fn remove(&self) {
        let _ = std::fs::remove_dir_all(&self.unfinished);
        self.created.iter().rev().for_each(|directory| {
            let _ = std::fs::remove_dir(directory);
        });
    }
}

static UNDER_WAY: Mutex<Vec<Traces>> = Mutex::new(Vec::new());

/// The list, for as long as nothing may be interrupted.
pub struct Uninterrupted(MutexGuard<'static, Vec<Traces>>);

/// Keeps an interruption waiting while the result lives; never returns once one has begun.
pub fn uninterrupted() -> Uninterrupted {
    Uninterrupted(UNDER_WAY.lock().unwrap_or_else(PoisonError::into_inner))
}

impl Uninterrupted {
    /// From now on an interruption removes `traces`.
    pub fn begin(&mut self, traces: Traces) {
        self.0.push(traces);
    }

    /// Removes what is left of `traces`, and forgets them.
    pub fn end(&mut self, traces: &Traces) {
        traces.remove();
        self.0.retain(|other| other != traces);
    }
}

/// Sets up the handling of Ctrl-C and of SIGTERM, once a process.
#[cfg(unix)]
pub fn handle() {
    use signal_hook::consts::{SIGINT, SIGTERM};
    use signal_hook::iterator::Signals;
    static ONCE: std::sync::Once = std::sync::Once::new();
    ONCE.call_once(|| {
        // Where the system refuses, signals do what they do by default.
        let Ok(mut signals) = Signals::new([SIGINT, SIGTERM]) else { return };
        std::thread::spawn(move || {
            if let Some(signal) = signals.forever().next() {
                leave(signal);
            }
        });
    });
}

/// Elsewhere signals do what they do by default.
#[cfg(not(unix))]
pub fn handle() {}

#[cfg(unix)]
fn leave(signal: i32) -> ! {
    let under_way = uninterrupted();
    under_way.0.iter().for_each(Traces::remove);
    let kept = if under_way.0.is_empty() { "" } else { "; no file was written" };
    // Nobody may be there to read it.
    let _ = std::io::Write::write_all(&mut std::io::stderr(), format!("\ninterrupted{kept}\n").as_bytes());
    std::process::exit(128 + signal)
}
