//! Faults of a problem: where they stand, what was found, what to do.

use std::fmt;
use std::ops::Range;

/// Most faults listed in one run; what lies beyond is counted only.
///
/// A file damaged throughout has thousands; nobody mends more than a screenful before trying again.
pub(super) const MOST_FAULTS: usize = 100;

/// The name and the text of a problem file: what turns a place into a line and a column.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Source {
    /// Name of the file, as the user gave it.
    pub file: String,
    /// Its text.
    pub text: String,
}

/// Where a value of the problem stands: in the file, or among the options of the command.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Place {
    /// Bytes of the file.
    File(Range<usize>),
    /// The option with its value, as on the command line: `--order 7`.
    Option(String),
}

impl From<Range<usize>> for Place {
    fn from(span: Range<usize>) -> Self {
        Self::File(span)
    }
}

/// One fault of a problem: its place in the user's terms, what was found, and the remedy.
///
/// Displayed as `file:line:column: item: message; remedy`, a fault of an option as `--option: item: message; remedy`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ProblemError {
    /// Name of the file; for a fault of an option, the option with its value (`--order 7`).
    pub file: String,
    /// Line, counted from 1; 0 for a fault of an option.
    pub line: usize,
    /// Character of the line, counted from 1; 0 for a fault of an option.
    pub column: usize,
    /// Bytes of the text that are at fault; empty for a fault of an option.
    pub span: Range<usize>,
    /// The item, such as `subdomain "arch", outline item 4`; may be empty.
    pub item: String,
    /// What is wrong.
    pub message: String,
    /// What to do.
    pub remedy: String,
}

impl ProblemError {
    /// True for a fault of an option of the command, which has no line.
    pub fn is_of_an_option(&self) -> bool {
        self.line == 0
    }
}

impl fmt::Display for ProblemError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { file, line, column, item, message, remedy, .. } = self;
        if self.is_of_an_option() {
            write!(f, "{file}: ")?;
        } else {
            write!(f, "{file}:{line}:{column}: ")?;
        }
        if !item.is_empty() {
            write!(f, "{item}: ")?;
        }
        write!(f, "{message}; {remedy}")
    }
}

impl std::error::Error for ProblemError {}

impl Source {
    /// The fault at `place`, its line and column looked up in the text.
    pub fn error(
        &self,
        place: &Place,
        item: impl Into<String>,
        message: impl Into<String>,
        remedy: impl Into<String>,
    ) -> ProblemError {
        let [item, message, remedy] = [item.into(), message.into(), remedy.into()].map(printable);
        match place {
            Place::File(span) => {
                let (line, column) = self.line_and_column(span.start);
                ProblemError { file: self.file.clone(), line, column, span: span.clone(), item, message, remedy }
            }
            Place::Option(option) => {
                ProblemError { file: printable(option.clone()), line: 0, column: 0, span: 0..0, item, message, remedy }
            }
        }
    }

    /// Line and character of a byte of the text, both counted from 1.
    fn line_and_column(&self, offset: usize) -> (usize, usize) {
        let bytes = self.text.as_bytes();
        let before = &bytes[..offset.min(bytes.len())];
        let start = before.iter().rposition(|&b| b == b'\n').map_or(0, |newline| newline + 1);
        // A continuation byte of UTF-8 starts no character, and neither does the byte order mark an editor put first.
        let starts_character = |&&b: &&u8| b & 0xC0 != 0x80;
        let mark = usize::from(start == 0 && before.starts_with("\u{feff}".as_bytes()));
        let line = 1 + before.iter().filter(|&&b| b == b'\n').count();
        (line, 1 + before[start..].iter().filter(starts_character).count() - mark)
    }
}

/// The text on one line: what a damaged file quotes back must not move the cursor of a terminal.
fn printable(text: String) -> String {
    if !text.contains(char::is_control) {
        return text;
    }
    text.chars().map(|c| if c.is_control() { c.escape_debug().to_string() } else { c.to_string() }).collect()
}

/// The faults found so far.
#[derive(Debug, Default)]
pub(super) struct Faults(Vec<Fault>);

#[derive(Debug)]
struct Fault {
    place: Place,
    item: String,
    message: String,
    remedy: String,
}

impl Faults {
    /// Notes a fault; its line is looked up only when the list is complete.
    pub(super) fn push(
        &mut self,
        place: impl Into<Place>,
        item: impl Into<String>,
        message: impl Into<String>,
        remedy: impl Into<String>,
    ) {
        self.0.push(Fault { place: place.into(), item: item.into(), message: message.into(), remedy: remedy.into() });
    }

    /// Number of faults noted so far.
    pub(super) fn len(&self) -> usize {
        self.0.len()
    }

    /// The list to show: options first, then in the order of the file, at most [`MOST_FAULTS`] and a line that counts
    /// the others.
    pub(super) fn into_errors(mut self, source: &Source) -> Vec<ProblemError> {
        // Stable: faults at one place stay in the order in which they were found.
        self.0.sort_by_key(|fault| match &fault.place {
            Place::Option(_) => (0, 0),
            Place::File(span) => (1, span.start),
        });
        let beyond = self.0.len().saturating_sub(MOST_FAULTS);
        let next = self.0.get(MOST_FAULTS).map(|fault| fault.place.clone());
        let listed = self.0.into_iter().take(MOST_FAULTS);
        let mut errors: Vec<_> =
            listed.map(|Fault { place, item, message, remedy }| source.error(&place, item, message, remedy)).collect();
        if let Some(place) = next {
            let more = if beyond == 1 { "and 1 more fault".to_owned() } else { format!("and {beyond} more faults") };
            errors.push(source.error(&place, "", more, "mend the ones above, then try again"));
        }
        errors
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn source(text: &str) -> Source {
        Source { file: "a.toml".into(), text: text.into() }
    }

    #[test]
    fn columns_count_characters_from_one() {
        let source = source("a = 1\nüß = \"é\" x");
        let x = source.text.len() - 1;
        assert_eq!(source.line_and_column(x), (2, 10));
        assert_eq!(source.line_and_column(0), (1, 1));
        assert_eq!(source.line_and_column(5), (1, 6));
        assert_eq!(source.line_and_column(6), (2, 1));
        assert_eq!(source.line_and_column(1000), (2, 11));
    }

    #[test]
    fn a_byte_order_mark_is_no_character() {
        assert_eq!(source("\u{feff}a = 1").line_and_column(3), (1, 1));
        assert_eq!(source("\u{feff}a = 1\nb").line_and_column(9), (2, 1));
    }

    #[test]
    fn an_error_reads_file_line_column_item_message_remedy() {
        let error = source("a\nbc").error(&Place::File(3..4), "hole \"h1\"", "it leaks", "plug it");
        assert_eq!(error.to_string(), "a.toml:2:2: hole \"h1\": it leaks; plug it");
        let error = source("a\nbc").error(&Place::Option("--order 7".into()), "", "it leaks", "plug it");
        assert_eq!(error.to_string(), "--order 7: it leaks; plug it");
    }

    #[test]
    fn the_list_is_in_the_order_of_the_file_and_capped() {
        let mut faults = Faults::default();
        for at in (0..MOST_FAULTS + 3).rev() {
            faults.push(at..at, "", "m", "r");
        }
        faults.push(Place::Option("--seed -1".into()), "", "m", "r");
        let errors = faults.into_errors(&source(&"x".repeat(200)));
        assert_eq!(errors.len(), MOST_FAULTS + 1);
        assert!(errors[0].is_of_an_option());
        assert_eq!((errors[1].column, errors[99].column), (1, 99));
        assert_eq!(errors[100].to_string(), "a.toml:1:100: and 4 more faults; mend the ones above, then try again");
    }
}
