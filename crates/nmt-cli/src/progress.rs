//! A bar on stderr for what takes longer than a second: the stage under way and how far it is.
//!
//! It is drawn where stderr is a terminal, and is gone before anything else is printed.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use nmt::pipeline::{Event, Stage};
use std::io::IsTerminal as _;
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{JoinHandle, spawn};
use std::time::Duration;

/// What ends sooner has no bar.
const PATIENCE: Duration = Duration::from_secs(1);
/// From one drawing to the next where nothing is told.
const TICK: Duration = Duration::from_millis(200);
/// Steps of a bar whose measure is no count.
const STEPS: u64 = 1000;

/// Progress of one run; clones share one bar, which goes with the last of them.
#[derive(Clone, Debug)]
pub struct Progress(Option<Arc<Shown>>);

#[derive(Debug)]
struct Shown {
    bar: ProgressBar,
    /// What makes the bar appear when the patience is over, unless told before.
    appearance: Mutex<Option<(Sender<()>, JoinHandle<()>)>>,
}

impl Progress {
    /// Nothing is ever drawn where it is not `wanted`, or where stderr is no terminal.
    pub fn new(wanted: bool) -> Self {
        if !wanted || !std::io::stderr().is_terminal() {
            return Self(None);
        }
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::hidden());
        let (sender, receiver) = channel();
        let shown = bar.clone();
        let thread = spawn(move || {
            if receiver.recv_timeout(PATIENCE) == Err(RecvTimeoutError::Timeout) {
                shown.set_draw_target(ProgressDrawTarget::stderr_with_hz(10));
                shown.enable_steady_tick(TICK);
            }
        });
        Self(Some(Arc::new(Shown { bar, appearance: Mutex::new(Some((sender, thread))) })))
    }

    /// What the pipeline tells; `name` is the subdomain's, where there are several.
    pub fn observe(&self, name: Option<&str>, event: Event) {
        let Some(shown) = &self.0 else { return };
        match event {
            Event::Begun(stage) => shown.stage(&match name {
                Some(name) => format!("{} of \"{name}\"", words(stage)),
                None => words(stage).into(),
            }),
            Event::Ended(_) | Event::Step(_) => {}
            Event::Nodes { done, of } => shown.measure(done as u64, of as u64, format!("{done} of {of} nodes")),
            Event::Iteration { iterations, residual, target } => {
                // Residuals fall by a factor each time.
                let share = (residual.ln() / target.ln()).clamp(0.0, 1.0);
                let message = format!("iteration {iterations}, residual {residual:.1e}");
                shown.measure((share * STEPS as f64) as u64, STEPS, message);
            }
        }
    }

    /// A line on stderr, above the bar where there is one.
    pub fn note(&self, line: &str) {
        match &self.0 {
            Some(shown) => shown.bar.suspend(|| eprintln!("{line}")),
            None => eprintln!("{line}"),
        }
    }

    /// Something else begins.
    pub fn begin(&self, what: &str) {
        if let Some(shown) = &self.0 {
            shown.stage(what);
        }
    }

    /// The bar goes, for good.
    pub fn clear(&self) {
        if let Some(shown) = &self.0 {
            shown.clear();
        }
    }
}

impl Shown {
    fn stage(&self, what: &str) {
        if self.bar.prefix() == what {
            return;
        }
        self.style("{spinner} [{elapsed}] {prefix}");
        self.bar.set_prefix(what.to_owned());
    }

    fn measure(&self, done: u64, of: u64, message: String) {
        if self.bar.length() != Some(of) || self.bar.message().is_empty() {
            self.style("{spinner} [{elapsed}] {prefix} {bar:24} {msg}");
            self.bar.set_length(of);
        }
        self.bar.set_position(done);
        self.bar.set_message(message);
    }

    fn style(&self, template: &str) {
        self.bar.set_message("");
        // The templates are ours, and sound.
        if let Ok(style) = ProgressStyle::with_template(template) {
            self.bar.set_style(style);
        }
    }

    fn clear(&self) {
        let appearance = self.appearance.lock().unwrap_or_else(PoisonError::into_inner).take();
        if let Some((sender, thread)) = appearance {
            drop(sender);
            // It cannot panic; and if it did, there would merely be no bar.
            let _ = thread.join();
        }
        self.bar.finish_and_clear();
    }
}

impl Drop for Shown {
    fn drop(&mut self) {
        self.clear();
    }
}

/// A stage as a reader knows it.
fn words(stage: Stage) -> &'static str {
    match stage {
        Stage::Cloud => "cloud",
        Stage::Mesh => "mesh",
        // They take turns.
        Stage::Stencils | Stage::Assemble => "stars and equations",
        Stage::Solve => "linear solver",
        Stage::Post => "recovery and results",
        Stage::Estimate => "error estimate",
    }
}
