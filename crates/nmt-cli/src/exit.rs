//! How a run ends: the error chain on stderr, and the exit code.

use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet};
use nmt::NmtError;
use nmt::problem::{ProblemError, Source};
use std::error::Error;
use std::io;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Exit code of a wrong command line.
pub const USAGE: u8 = 2;

/// Why a run ended early.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    /// The problem is wrong.
    #[error("the problem has {} {}", .errors.len(), if .errors.len() == 1 { "fault" } else { "faults" })]
    Problem {
        /// All its faults.
        errors: Vec<ProblemError>,
        /// The text they point into.
        source_text: Source,
    },
    /// The file is no text.
    #[error("{} is not UTF-8 text (byte {at}); save it as UTF-8", .file.display())]
    NotText {
        /// The file.
        file: PathBuf,
        /// Its first wrong byte.
        at: usize,
    },
    /// The numerics failed.
    #[error(transparent)]
    Numerics(NmtError),
    /// Methods of a comparison could not solve the problem; why stands in their rows.
    #[error("{failed} of {of} rows could not be solved; each says why")]
    Methods {
        /// How many.
        failed: usize,
        /// Of how many.
        of: usize,
    },
    /// A tolerance is not reached; the best solution has been written.
    #[error(
        "subdomain \"{subdomain}\": the tolerance {asked:e} is not reached: the best of its solutions, on {nodes} nodes, has an \
         estimated error of {reached:.1e}{why}"
    )]
    Tolerance {
        /// Its name.
        subdomain: String,
        /// The relative error of J asked for.
        asked: f64,
        /// What it has come to.
        reached: f64,
        /// Nodes of its cloud.
        nodes: usize,
        /// Why it went no further, and the remedy, after a semicolon.
        why: String,
    },
    /// An option does not suit the problem.
    #[error("{0}")]
    Option(String),
    /// A file cannot be read or written.
    #[error("{} cannot be {action}", .path.display())]
    Io {
        /// The file or directory.
        path: PathBuf,
        /// "read" or "written".
        action: &'static str,
        /// What the system says.
        source: io::Error,
    },
    /// A picture cannot be drawn.
    #[error("{name} cannot be drawn")]
    Picture {
        /// The file.
        name: String,
        /// Why.
        source: nmt::plot::PlotError,
    },
    /// The report cannot be written as JSON.
    #[error("the report holds a number that JSON cannot: {0}")]
    Json(String),
}

impl Failure {
    /// The pipeline's error with the text that its faults point into.
    pub fn of(error: NmtError, source: &Source) -> Self {
        match error {
            NmtError::Problem(errors) => Self::Problem { errors, source_text: source.clone() },
            other => Self::Numerics(other),
        }
    }

    /// A file that cannot be read or written.
    pub fn io(path: &Path, action: &'static str, source: io::Error) -> Self {
        Self::Io { path: path.into(), action, source }
    }

    fn code(&self) -> u8 {
        match self {
            Self::Problem { .. } | Self::NotText { .. } => 1,
            Self::Option(_) => USAGE,
            Self::Numerics(_) | Self::Methods { .. } | Self::Tolerance { .. } | Self::Json(_) => 3,
            Self::Io { .. } | Self::Picture { .. } => 4,
        }
    }

    /// Prints the failure with its causes, for a wrong problem each fault with its line; returns the exit code.
    pub fn report(&self) -> ExitCode {
        if let Self::Problem { errors, source_text } = self {
            errors.iter().for_each(|error| eprintln!("{}", annotated(error, source_text)));
        }
        eprint!("error: {self}");
        let mut cause = self.source();
        while let Some(error) = cause {
            eprint!(": {error}");
            cause = error.source();
        }
        eprintln!();
        ExitCode::from(self.code())
    }
}

/// A fault with the line it stands in.
fn annotated(error: &ProblemError, source: &Source) -> String {
    let span = error.span.start.min(source.text.len())..error.span.end.min(source.text.len());
    if error.is_of_an_option() || span.is_empty() {
        return format!("error: {error}");
    }
    let item = if error.item.is_empty() { String::new() } else { format!("{}: ", error.item) };
    let headline = format!("{item}{}", error.message);
    // The whole of a long table says nothing: point at its first line.
    let end = source.text[span.clone()].find('\n').map_or(span.end, |newline| span.start + newline);
    let snippet = Snippet::source(source.text.as_str())
        .path(error.file.as_str())
        .annotation(AnnotationKind::Primary.span(span.start..end).label(error.remedy.as_str()));
    let report = [Level::ERROR.primary_title(headline.as_str()).element(snippet)];
    Renderer::plain().render(&report)
}
