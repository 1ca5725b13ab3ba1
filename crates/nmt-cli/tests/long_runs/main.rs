//! What a person meets in a run that takes long: its progress, and that it can be stopped.
#![cfg(unix)]

mod interrupted;
#[cfg(target_os = "linux")]
mod progress;

use std::path::{Path, PathBuf};

/// A fresh directory below the target directory, and in it a problem file of so many nodes a side.
fn square(name: &str, nodes: usize) -> (PathBuf, String) {
    let directory = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&directory);
    std::fs::create_dir_all(&directory).expect("a scratch directory");
    let path = directory.join("square.toml");
    let problem = format!(
        "[[subdomain]]\nnodes = [{nodes}, {nodes}]\nirregularity = 0.25\nrectangle = {{ from = [0, 0], to = [1, 1] }}\n"
    );
    std::fs::write(&path, problem).expect("a scratch file");
    (directory, path.display().to_string())
}
