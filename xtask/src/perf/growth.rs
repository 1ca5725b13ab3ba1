//! How time and memory grow with the cloud: tables, exponents, the picture.

use super::least;
use super::run::{Case, Run, STAGES};
use nmt::plot::{Caption, ErrorSeries, errors_figure};
use std::fmt::Write as _;

/// Runs by size, case and threads.
#[derive(Default)]
pub struct Growth {
    runs: Vec<(usize, Case, usize, Vec<Run>)>,
    direct: Vec<(usize, Case, usize, Vec<Run>)>,
    files: Vec<(usize, Run)>,
}

fn add(all: &mut Vec<(usize, Case, usize, Vec<Run>)>, nodes: usize, case: Case, threads: usize, run: Run) {
    match all.iter_mut().find(|(n, c, t, _)| (*n, *c, *t) == (nodes, case, threads)) {
        Some((.., runs)) => runs.push(run),
        None => all.push((nodes, case, threads, vec![run])),
    }
}

impl Growth {
    /// A run with the multigrid iteration.
    pub fn add(&mut self, nodes: usize, case: Case, threads: usize, run: Run) {
        add(&mut self.runs, nodes, case, threads, run);
    }

    /// A run with the direct solver.
    pub fn add_direct(&mut self, nodes: usize, case: Case, run: Run) {
        add(&mut self.direct, nodes, case, 1, run);
    }

    /// A run that wrote its files.
    pub fn add_files(&mut self, nodes: usize, run: Run) {
        self.files.push((nodes, run));
    }

    /// What was added last, in a line.
    pub fn last_line(&self) -> String {
        let Some((nodes, run)) = self.files.last() else { return String::new() };
        let whole = self.least(*nodes, Case::ALL[0], |run| run.whole).unwrap_or(f64::NAN);
        format!("{nodes} nodes: {whole:.2} s, {:.2} s with files", run.whole)
    }

    /// The least of a figure over the runs of a case on one thread.
    pub fn least(&self, nodes: usize, case: Case, of: impl Fn(&Run) -> f64) -> Option<f64> {
        let found = self.runs.iter().find(|(n, c, t, _)| (*n, *c, *t) == (nodes, case, 1));
        found.map(|(.., runs)| least(runs, of))
    }

    fn sizes(&self) -> Vec<usize> {
        self.files.iter().map(|(nodes, _)| *nodes).collect()
    }

    /// Nodes and seconds of a figure, by size.
    fn line(&self, case: Case, of: impl Fn(&Run) -> f64) -> Vec<[f64; 2]> {
        let at = |nodes: &usize| Some([self.least(*nodes, case, |run| run.nodes)?, self.least(*nodes, case, &of)?]);
        self.sizes().iter().filter_map(at).collect()
    }

    /// The tables, in Markdown.
    pub fn tables(&self) -> String {
        let sizes = self.sizes();
        let mut text = String::new();
        for case in Case::ALL {
            let _ = write!(
                text,
                "{} form, irregularity 0.{:02}, seconds:\n\n| nodes |",
                case.formulation, case.irregularity
            );
            sizes.iter().for_each(|n| text += &format!(" {} |", power(*n)));
            text += " exponent |\n|---|";
            text += &"---|".repeat(sizes.len() + 1);
            text += "\n";
            for (k, name) in STAGES.iter().enumerate() {
                self.row(&mut text, STAGE_NAMES[k], &self.line(case, |run| run.stages[k]));
                if *name == "solve" {
                    let direct = |nodes: &usize| {
                        let found = self.direct.iter().find(|(n, c, ..)| (n, *c) == (nodes, case))?;
                        Some([least(&found.3, |run| run.nodes), least(&found.3, |run| run.stages[k])])
                    };
                    self.row(&mut text, "solve, direct", &sizes.iter().filter_map(direct).collect::<Vec<_>>());
                }
            }
            self.row(&mut text, "whole, without files", &self.line(case, |run| run.whole));
            if case == Case::ALL[0] {
                let files = self.files.iter().map(|(_, run)| [run.nodes, run.whole]);
                self.row(&mut text, "whole, with files", &files.collect::<Vec<_>>());
            }
            let plain = |text: &mut String, name: &str, of: &dyn Fn(&Run) -> f64| {
                *text += &format!("| {name} |");
                self.line(case, of).iter().for_each(|[_, value]| *text += &format!(" {value:.0} |"));
                *text += " |\n";
            };
            plain(&mut text, "iterations", &|run| run.iterations);
            plain(&mut text, "bytes a node at the peak", &|run| run.bytes);
            text += "\n";
        }
        text + &self.threads()
    }

    fn row(&self, text: &mut String, name: &str, line: &[[f64; 2]]) {
        *text += &format!("| {name} |");
        line.iter().for_each(|[_, seconds]| *text += &format!(" {} |", digits(*seconds)));
        *text += &" |".repeat(self.sizes().len() - line.len());
        *text += &exponent(line).map_or(" |\n".into(), |e| format!(" {e:.2} |\n"));
    }

    /// How much faster two threads are than one, by the clock.
    fn threads(&self) -> String {
        let mut text =
            "Two threads, times as fast as one, by the clock (variational, irregularity 0.25):\n\n".to_owned();
        text += "| nodes | stars and rows | assembly | solve | post-processing | whole |\n|---|---|---|---|---|---|\n";
        for nodes in self.sizes() {
            let of = |threads: usize, of: &dyn Fn(&Run) -> f64| {
                let found = self.runs.iter().find(|(n, c, t, _)| (*n, *c, *t) == (nodes, Case::ALL[0], threads));
                found.map_or(f64::NAN, |(.., runs)| least(runs, of))
            };
            text += &format!("| {} |", power(nodes));
            for k in 2..6 {
                text += &format!(" {:.2} |", of(1, &|run| run.stages[k]) / of(2, &|run| run.stages[k]));
            }
            text += &format!(" {:.2} |\n", of(1, &|run| run.whole) / of(2, &|run| run.whole));
        }
        text + "\n"
    }

    /// Seconds of every stage against nodes, both axes logarithmic.
    pub fn picture(&self) -> String {
        let case = Case::ALL[0];
        let stages = STAGE_NAMES.iter().enumerate().map(|(k, name)| (*name, self.line(case, move |run| run.stages[k])));
        let lines: Vec<(&str, Vec<[f64; 2]>)> =
            std::iter::once(("whole", self.line(case, |run| run.whole))).chain(stages).collect();
        let series = lines.iter().enumerate().map(|(k, (name, points))| ErrorSeries {
            name,
            points,
            family: if k == 0 { 0 } else { 1 + k % 3 },
            order: 1 + k / 2,
        });
        let caption = Caption { title: "Seconds of each stage, variational form", units: "" };
        errors_figure(&caption, "nodes", "seconds", &series.collect::<Vec<_>>())
    }
}

/// Stages as the tables name them.
const STAGE_NAMES: [&str; 6] =
    ["boundary and cloud", "mesh", "stars and rows", "assembly", "solve, multigrid", "post-processing"];

/// Slope of log y over log x by least squares; `None` for fewer than two points.
fn exponent(line: &[[f64; 2]]) -> Option<f64> {
    let n = line.len() as f64;
    let logs: Vec<[f64; 2]> = line.iter().map(|point| point.map(f64::ln)).collect();
    let mean = [0, 1].map(|d| logs.iter().map(|p| p[d]).sum::<f64>() / n);
    let sum = |of: &dyn Fn(&[f64; 2]) -> f64| logs.iter().map(of).sum::<f64>();
    let (xy, xx) = (sum(&|p| (p[0] - mean[0]) * (p[1] - mean[1])), sum(&|p| (p[0] - mean[0]).powi(2)));
    (line.len() > 1).then_some(xy / xx)
}

/// Two significant digits.
fn digits(seconds: f64) -> String {
    let decimals = (1.0 - seconds.log10().floor()).clamp(0.0, 6.0);
    format!("{seconds:.*}", decimals as usize)
}

/// 4·10⁶ and the like.
pub fn power(n: usize) -> String {
    let zeros = n.to_string().bytes().rev().take_while(|digit| *digit == b'0').count();
    let leading = n / 10usize.pow(zeros as u32);
    if leading == 1 { format!("1e{zeros}") } else { format!("{leading}e{zeros}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exponents_are_those_of_powers_and_figures_are_short() {
        let line: Vec<[f64; 2]> = [1e4, 1e5, 1e6].map(|n: f64| [n, 3.0 * n.powf(1.1)]).into();
        assert!(exponent(&line).is_some_and(|e| (e - 1.1).abs() < 1e-12)); // rounding
        assert_eq!(exponent(&line[..1]), None);
        assert_eq!([0.00123, 0.123, 1.23, 12.3].map(digits), ["0.0012", "0.12", "1.2", "12"]);
        assert_eq!([10_000, 4_000_000].map(power), ["1e4", "4e6"]);
    }
}
