//! Tasks of the nmt workspace: `cargo xtask TASK`.

mod figures;
mod golden;
mod licences;
mod perf;
mod suite;

use anyhow::{Result, bail};

const TASKS: &str = "\
cargo xtask test                  every test: unit, property, doc and integration tests, golden results, files read by meshio
cargo xtask golden                nmt against fixtures/golden: clouds, meshes and common edges by GNU Octave, results of the shipped problems; the worst entry of each
cargo xtask golden --regenerate   rewrite fixtures/golden: by Octave, and from the present code (say in the commit why numbers moved)
cargo xtask figures               redraw docs/figures
cargo xtask perf                  seconds and memory of every stage at 1e4, 1e5, 1e6 nodes (--large: 4e6 too), beside the Python programs of NMT_PEERS_PYTHON; writes docs/performance.md
cargo xtask perf --check          instructions of the kernels, counted by valgrind, against xtask/kernels.toml; fails over 5 %
cargo xtask perf --bless          rewrite xtask/kernels.toml
cargo xtask licences              licences of all dependencies against the list of allowed ones";

fn main() -> Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match arguments[..] {
        ["test"] => suite::test(),
        ["golden"] => golden::compare(),
        ["golden", "--regenerate"] => golden::regenerate(),
        ["figures"] => figures::draw(),
        ["perf"] => perf::measure(false),
        ["perf", "--large"] => perf::measure(true),
        ["perf", "--check"] => perf::check(),
        ["perf", "--bless"] => perf::bless(),
        ["perf", "--kernel", name, times] => perf::kernel(name, times),
        ["licences"] => licences::check(),
        [] => {
            println!("{TASKS}");
            Ok(())
        }
        _ => bail!("unknown task; the tasks are\n{TASKS}"),
    }
}

/// The top of the workspace.
fn root() -> std::path::PathBuf {
    std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}
