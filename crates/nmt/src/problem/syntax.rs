//! Text to a TOML tree with places; its syntax errors in our words. Only the files beside this one name toml.

use super::error::Faults;
use super::habits;
use super::tree::cut;
use toml::de::{DeTable, Error};

/// The part of toml's message that says a key stands twice.
const DUPLICATE_KEY: &str = "duplicate key";

/// What toml says of a word that is no number, and of no word at all.
const UNQUOTED: &str = "string values must be quoted";

/// How the messages of faults begin that end where they stand, so that the text after them is read as it was meant.
const LOCAL: [&str; 6] = [DUPLICATE_KEY, UNQUOTED, "invalid", "unexpected leading zero", "missing value", "redundant"];

/// The tree of `text`; `None` where its syntax is so broken that what it means cannot be known.
///
/// A key that stands twice is the one fault after which the rest can still be read: the first of the two counts.
pub(super) fn parse<'t>(text: &'t str, faults: &mut Faults) -> Option<DeTable<'t>> {
    let (tree, errors) = DeTable::parse_recoverable(text);
    let mut told_to = 0; // the end of the last line with a fault
    for error in &errors {
        let span = error.span().unwrap_or(text.len()..text.len());
        // The first fault of a line explains it; what the parser met while it recovered does not.
        if span.start < told_to {
            continue;
        }
        told_to = text.get(span.start..).and_then(|rest| rest.find('\n')).map_or(usize::MAX, |n| span.start + n + 1);
        // Of a key that stands twice there is nothing else to say.
        let is_twice = error.message().starts_with(DUPLICATE_KEY);
        if let Some(meant) = habits::explained(text, span.start).filter(|_| !is_twice) {
            faults.push(meant.place, "", format!("this is not TOML: {}", meant.message), meant.remedy);
        } else {
            let (message, remedy) = in_our_words(error, text.get(span.clone()).unwrap_or_default());
            faults.push(span, "", message, remedy);
        }
        // After a bracket that does not close, nothing that follows is what it seems.
        if !LOCAL.iter().any(|start| error.message().starts_with(start)) {
            break;
        }
    }
    errors.iter().all(|error| error.message().starts_with(DUPLICATE_KEY)).then(|| tree.into_inner())
}

fn in_our_words(error: &Error, found: &str) -> (String, String) {
    /// What to do about the beginning of a message.
    const REMEDIES: [(&str, &str); 11] = [
        ("invalid unquoted key", "put the key in quotes, or correct it"),
        ("missing comma", "put a comma before it, or close what is open above"),
        ("extra comma", "remove one comma"),
        ("missing value", "write the value after the key and `=`"),
        ("key with no value", "write `=` and the value after the key"),
        ("missing assignment", "put `=` between key and value"),
        ("unclosed array", "close it with `]`"),
        ("unclosed inline table", "close it with `}`"),
        ("unclosed table", "close it with `]`"),
        ("invalid basic string", "close the text with `\"`, and write a backslash as `\\\\`"),
        ("carriage return must", "end the lines with a newline, alone or after the carriage return"),
    ];
    if error.message().starts_with(DUPLICATE_KEY) {
        return (format!("the key `{}` stands twice in one table", found.trim()), "keep one of the two".into());
    }
    if error.message().starts_with(UNQUOTED) {
        return if found.trim().is_empty() {
            ("this is not TOML: a value is missing".into(), "write it after the `=`".into())
        } else {
            let message = format!("this is not TOML: `{}` is neither a number nor a text in quotes", cut(found));
            (message, "write a text in quotes, and a comma between two values".into())
        };
    }
    let remedy = REMEDIES
        .iter()
        .find(|(start, _)| error.message().starts_with(start))
        .map_or("correct it here; the rest of the file can be checked only then", |(_, remedy)| remedy);
    (format!("this is not TOML: {}", error.message().trim_end_matches(", expected nothing")), remedy.into())
}
