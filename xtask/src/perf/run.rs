//! One run of `nmt solve` in a process of its own: seconds by stage, peak memory, iterations.

use crate::root;
use anyhow::{Context as _, Result, bail};
use serde_json::Value;
use std::fmt::Write as _;
use std::path::PathBuf;
use std::process::Command;
use std::time::Instant;
use std::{env, fs};

/// What is timed: the U with a round hole.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Case {
    /// The word of the option.
    pub formulation: &'static str,
    /// In hundredths.
    pub irregularity: u32,
}

impl Case {
    /// Both formulations on both clouds, the default first.
    pub const ALL: [Self; 4] = [
        Self { formulation: "variational", irregularity: 25 },
        Self { formulation: "local", irregularity: 25 },
        Self { formulation: "variational", irregularity: 40 },
        Self { formulation: "local", irregularity: 40 },
    ];

    /// The problem file for about `nodes` nodes.
    fn problem(self, nodes: usize) -> String {
        let area = 8.0 - std::f64::consts::PI / 16.0;
        let h = (area / nodes as f64).sqrt();
        let [across, up] = [4.0, 3.0].map(|length| (length / h).round() as usize + 1);
        let mut text = format!("[[subdomain]]\nnodes = [{across}, {up}]\nirregularity = 0.{:02}\n", self.irregularity);
        let _ = writeln!(text, "outline = [[0, 0], [4, 0], [4, 3], [3, 3], [3, 1], [1, 1], [1, 3], [0, 3]]");
        let _ = writeln!(text, "[[subdomain.hole]]\ncircle = {{ centre = [2, 0.5], radius = 0.25 }}");
        let _ = writeln!(text, "[solve]\nformulation = \"{}\"", self.formulation);
        text
    }
}

/// Stages in the order of the report.
pub const STAGES: [&str; 6] = ["cloud", "mesh", "stencils", "assemble", "solve", "post"];

/// What one run took.
#[derive(Clone, Debug)]
pub struct Run {
    /// Nodes of the cloud.
    pub nodes: f64,
    /// Seconds by stage.
    pub stages: [f64; 6],
    /// Seconds of the whole process, by the clock.
    pub whole: f64,
    /// Bytes a node at the peak, by the operating system's account of the process.
    pub bytes: f64,
    /// Iterations; NaN where there were none.
    pub iterations: f64,
}

/// The command, built for release.
pub struct Program(PathBuf);

/// Builds it.
pub fn build() -> Result<Program> {
    let cargo = env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let status = Command::new(cargo).args(["build", "--release", "-p", "nmt-cli"]).current_dir(root()).status()?;
    if !status.success() {
        bail!("nmt does not build");
    }
    Ok(Program(target()?.join("release").join("nmt")))
}

/// The target directory, where this program lies too.
pub fn target() -> Result<PathBuf> {
    let own = env::current_exe()?;
    Ok(own.ancestors().nth(2).context("this program does not lie in a target directory")?.to_path_buf())
}

impl Program {
    /// Solves a case without files.
    pub fn run(&self, case: Case, nodes: usize, threads: usize, options: &[&str]) -> Result<Run> {
        let directory = target()?.join("perf");
        fs::create_dir_all(&directory)?;
        let file = directory.join("problem.toml");
        fs::write(&file, case.problem(nodes))?;
        let start = Instant::now();
        let output = Command::new(&self.0)
            .arg("solve")
            .arg(&file)
            .args(["--json", "--no-estimate"])
            .args(options)
            .env("RAYON_NUM_THREADS", threads.to_string())
            .output()
            .with_context(|| format!("{} does not start", self.0.display()))?;
        let whole = start.elapsed().as_secs_f64();
        if !output.status.success() {
            bail!("{case:?}, {nodes} nodes: {}", String::from_utf8_lossy(&output.stderr));
        }
        read(&serde_json::from_slice(&output.stdout)?, whole).context("report.json has another form")
    }

    /// Solves a case and writes all its files.
    pub fn run_with_files(&self, case: Case, nodes: usize) -> Result<Run> {
        let out = target()?.join("perf").join("out");
        let run = self.run(case, nodes, 1, &["--solver", "iterative", "--out", &out.display().to_string()]);
        // Some 500 MB at 10⁶ nodes.
        if out.exists() {
            fs::remove_dir_all(&out)?;
        }
        run
    }
}

fn read(report: &Value, whole: f64) -> Option<Run> {
    let subdomain = &report["subdomains"][0];
    let nodes = subdomain["nodes"].as_f64()?;
    let mut stages = [0.0; 6];
    for (seconds, name) in stages.iter_mut().zip(STAGES) {
        *seconds = subdomain["seconds"][name].as_f64()?;
    }
    let bytes = report["totals"]["peak_rss_mb"].as_f64()? * 1e6 / nodes;
    let iterations = iterations(subdomain).unwrap_or(f64::NAN);
    Some(Run { nodes, stages, whole, bytes, iterations })
}

/// The number under the first key `iterations` of the subdomain or of an object in it.
fn iterations(value: &Value) -> Option<f64> {
    let object = value.as_object()?;
    object.get("iterations").and_then(Value::as_f64).or_else(|| object.values().find_map(iterations))
}
