//! The clock and the memory: the only place that reads them.

use nmt::pipeline::{Event, Stage};
use nmt::report::{Report, Seconds};
use std::time::Instant;

/// Measures the stages of a run.
pub struct Stopwatch {
    start: Instant,
    last: Instant,
    laps: Vec<(usize, Stage, f64)>,
    steps: Vec<(usize, usize)>, // subdomain, and how many laps there were at the end of its step
}

impl Stopwatch {
    /// Starts now.
    pub fn start() -> Self {
        let now = Instant::now();
        Self { start: now, last: now, laps: Vec::new(), steps: Vec::new() }
    }

    /// Seconds since the start.
    pub fn seconds(&self) -> f64 {
        self.start.elapsed().as_secs_f64()
    }

    /// What happens in a subdomain happens now.
    pub fn observe(&mut self, subdomain: usize, event: Event) {
        if let Event::Step(_) = event {
            self.steps.push((subdomain, self.laps.len()));
        }
        let Event::Ended(stage) = event else { return };
        let now = Instant::now();
        self.laps.push((subdomain, stage, (now - self.last).as_secs_f64()));
        self.last = now;
    }

    /// Fills in the seconds and the peak memory of a report.
    pub fn fill(&self, report: &mut Report) {
        for (k, subdomain) in report.subdomains.iter_mut().enumerate() {
            // On the way to a tolerance a stage has several laps.
            let own = |stage: Stage| self.laps.iter().filter(move |lap| lap.0 == k && lap.1 == stage);
            let of = |stage: Stage| own(stage).next().map(|_| own(stage).map(|lap| lap.2).sum::<f64>());
            subdomain.seconds = Seconds {
                cloud: of(Stage::Cloud).unwrap_or(0.0),
                mesh: of(Stage::Mesh),
                stencils: of(Stage::Stencils),
                assemble: of(Stage::Assemble),
                solve: of(Stage::Solve),
                post: of(Stage::Post),
                estimate: of(Stage::Estimate),
            };
            let steps = subdomain.solution.as_mut().and_then(|solution| solution.tolerance.as_mut());
            let ends = self.steps.iter().filter(|step| step.0 == k).map(|step| step.1);
            let begins = std::iter::once(0).chain(ends.clone());
            for ((step, begin), end) in steps.into_iter().flat_map(|t| &mut t.steps).zip(begins).zip(ends) {
                step.seconds = self.laps[begin..end].iter().filter(|lap| lap.0 == k).map(|lap| lap.2).sum();
            }
        }
        report.totals.seconds = self.start.elapsed().as_secs_f64();
        report.totals.peak_rss_mb = peak_rss_mb();
    }
}

/// Peak resident memory in 10⁶ bytes, where the system keeps /proc.
fn peak_rss_mb() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    let kibibytes: f64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kibibytes * 1024.0 / 1e6)
}
