//! The clock and the memory: the only place that reads them.

use nmt::pipeline::{Event, Stage};
use nmt::report::{Report, Seconds};
use std::time::Instant;

/// Measures the stages of a run.
pub struct Stopwatch {
    start: Instant,
    last: Instant,
    laps: Vec<(usize, Stage, f64)>,
}

impl Stopwatch {
    /// Starts now.
    pub fn start() -> Self {
        let now = Instant::now();
        Self { start: now, last: now, laps: Vec::new() }
    }

    /// Seconds since the start.
    pub fn seconds(&self) -> f64 {
        self.start.elapsed().as_secs_f64()
    }

    /// What happens in a subdomain happens now.
    pub fn observe(&mut self, subdomain: usize, event: Event) {
        let Event::Ended(stage) = event else { return };
        let now = Instant::now();
        self.laps.push((subdomain, stage, (now - self.last).as_secs_f64()));
        self.last = now;
    }

    /// Fills in the seconds and the peak memory of a report.
    pub fn fill(&self, report: &mut Report) {
        for (k, subdomain) in report.subdomains.iter_mut().enumerate() {
            let of = |stage: Stage| self.laps.iter().find(|lap| lap.0 == k && lap.1 == stage).map(|lap| lap.2);
            subdomain.seconds = Seconds {
                cloud: of(Stage::Cloud).unwrap_or(0.0),
                mesh: of(Stage::Mesh),
                stencils: of(Stage::Stencils),
                assemble: of(Stage::Assemble),
                solve: of(Stage::Solve),
                post: of(Stage::Post),
            };
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
