//! The tools that people use for the same work, timed in turn with nmt.

use super::growth::{Growth, power};
use super::run::{Case, Run};
use crate::root;
use anyhow::{Context as _, Result, bail};
use serde_json::Value;
use std::cell::RefCell;
use std::collections::BTreeSet;
use std::env;
use std::ffi::OsString;
use std::process::Command;

/// Names the Python that has the tools.
const VARIABLE: &str = "NMT_PEERS_PYTHON";

/// A task of scripts/peers.py and the same work of nmt.
struct Task {
    name: &'static str,
    case: Case,
    work: &'static str,
    of: fn(&Run) -> f64,
    /// nmt shall take at most this part of the peer's time.
    target: f64,
    aim: Option<f64>,
}

const TASKS: [Task; 7] = [
    Task { name: "cloud", case: VARIATIONAL, work: "cloud", of: |run| run.stages[0], target: 0.2, aim: None },
    Task { name: "mesh", case: VARIATIONAL, work: "mesh", of: |run| run.stages[1], target: 0.2, aim: None },
    Task {
        name: "stencils",
        case: LOCAL,
        work: "stars and rows",
        of: |run| run.stages[2],
        target: 0.25,
        aim: Some(0.125),
    },
    Task { name: "assembly", case: LOCAL, work: "assembly, local", of: |run| run.stages[3], target: 0.1, aim: None },
    Task {
        name: "assembly",
        case: VARIATIONAL,
        work: "assembly, variational",
        of: |run| run.stages[3],
        target: 0.1,
        aim: None,
    },
    Task { name: "solve", case: LOCAL, work: "solve, local", of: |run| run.stages[4], target: 1.0, aim: Some(0.25) },
    Task { name: "gmsh", case: VARIATIONAL, work: "whole, variational", of: |run| run.whole, target: 0.25, aim: None },
];

const VARIATIONAL: Case = Case::ALL[0];
const LOCAL: Case = Case::ALL[1];

/// One measurement of a peer.
pub struct Measured {
    size: usize,
    task: &'static str,
    tool: String,
    nodes: f64,
    seconds: f64,
    peak_mb: f64,
}

/// The peers that are there.
pub struct Peers {
    python: Option<OsString>,
    missing: RefCell<BTreeSet<&'static str>>,
}

impl Peers {
    /// By the environment; says what to do where there are none.
    pub fn from_environment() -> Self {
        let python = env::var_os(VARIABLE);
        if python.is_none() {
            println!(
                "no peers: set {VARIABLE} to a Python with shapely, triangle, scipy, scikit-fem, pypardiso and gmsh"
            );
        }
        Self { python, missing: RefCell::default() }
    }

    /// Times every peer once.
    pub fn measure(&self, size: usize, all: &mut Vec<Measured>) -> Result<()> {
        let Some(python) = &self.python else { return Ok(()) };
        let names: BTreeSet<&'static str> = TASKS.iter().map(|task| task.name).collect();
        for name in names {
            if self.missing.borrow().contains(name) {
                continue;
            }
            let mut command = Command::new(python);
            command.arg(root().join("scripts/peers.py")).args([name, &*size.to_string()]);
            for threads in ["OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS"] {
                command.env(threads, "1");
            }
            let output =
                command.output().with_context(|| format!("{VARIABLE}: {} does not start", python.display()))?;
            let errors = String::from_utf8_lossy(&output.stderr);
            match output.status.code() {
                Some(0) => all.push(
                    read(&serde_json::from_slice(&output.stdout)?, size, name)
                        .context("peers.py prints something else")?,
                ),
                Some(3) => {
                    println!("peer of `{name}` is missing: {}", errors.trim());
                    self.missing.borrow_mut().insert(name);
                }
                _ => bail!("peers.py {name} {size}: {errors}"),
            }
        }
        Ok(())
    }

    /// The ratios, in Markdown.
    pub fn table(&self, all: &[Measured], growth: &Growth) -> String {
        if all.is_empty() {
            return String::new();
        }
        let mut text = "Beside other programs, in turn with them on one core; per node, since clouds differ by a few per cent. The peak is what the task of the peer adds to\nits process, and the whole process of nmt.\n\n".to_owned();
        text += "| work | peer | nodes | peer, s | nmt, s | nmt / peer | target | peak, peer | peak, nmt |\n|---|---|---|---|---|---|---|---|---|\n";
        for Task { name, case, work, of, target, aim } in &TASKS {
            let sizes: BTreeSet<usize> = all.iter().filter(|m| m.task == *name).map(|m| m.size).collect();
            for size in sizes {
                let own = || all.iter().filter(|m| m.task == *name && m.size == size);
                let per_node = own().map(|m| m.seconds / m.nodes).fold(f64::INFINITY, f64::min);
                let peak = own().map(|m| m.peak_mb).fold(f64::INFINITY, f64::min);
                let (Some(first), Some(seconds), Some(nodes), Some(bytes)) = (
                    own().next(),
                    growth.least(size, *case, of),
                    growth.least(size, *case, |run| run.nodes),
                    growth.least(size, *case, |run| run.bytes),
                ) else {
                    continue;
                };
                let ratio = seconds / nodes / per_node;
                let aim = aim.map_or(String::new(), |aim| format!(", aim 1/{:.0}", 1.0 / aim));
                let met = if ratio <= *target { "" } else { " missed" };
                text += &format!(
                    "| {work} | {} | {} | {:.3} | {seconds:.3} | 1/{:.1} | 1/{:.0}{aim}{met} | {peak:.0} MB | {:.0} MB |\n",
                    first.tool,
                    power(size),
                    per_node * first.nodes,
                    1.0 / ratio,
                    1.0 / target,
                    bytes * nodes / 1e6,
                );
            }
        }
        for name in self.missing.borrow().iter() {
            text += &format!("\nNot measured, since the peer was not installed: {name}.\n");
        }
        text + "\n"
    }
}

fn read(value: &Value, size: usize, task: &'static str) -> Option<Measured> {
    Some(Measured {
        size,
        task,
        tool: value["tool"].as_str()?.to_owned(),
        nodes: value["nodes"].as_f64()?,
        seconds: value["seconds"].as_f64()?,
        peak_mb: value["peak_mb"].as_f64()?,
    })
}
