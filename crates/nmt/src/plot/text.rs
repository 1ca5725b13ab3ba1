//! Runs of text and how wide they will be.
//!
//! A figure is laid out before any font is loaded (and without one where only SVG is wanted), so the advance widths of the
//! font stand here. Liberation Sans has the metrics of Arial and Helvetica: the layout holds with any of the three.

/// Families asked for, in order. They share one set of advance widths.
pub(super) const FONT_FAMILY: &str = "Liberation Sans, Arial, Helvetica, sans-serif";

/// Height of a capital or digit, in em.
pub(super) const CAP_HEIGHT: f64 = 0.69;

/// Size of a subscript or superscript relative to its line.
pub(super) const SCRIPT_SIZE: f64 = 0.72;

/// Advance widths of U+0020…U+007E, in 1/1000 em, upright and italic alike (table `hmtx` of the font).
#[rustfmt::skip]
const ASCII_WIDTHS: [u16; 95] = [
    278, 278, 355, 556, 556, 889, 667, 191, 333, 333, 389, 584, 278, 333, 278, 278, 556, 556, 556, 556, 556, 556, 556, 556,
    556, 556, 278, 278, 584, 584, 584, 556, 1015, 667, 667, 722, 722, 667, 611, 778, 722, 278, 500, 667, 556, 833, 722, 778,
    667, 778, 722, 667, 611, 722, 667, 944, 667, 667, 611, 278, 278, 278, 469, 556, 333, 556, 556, 500, 556, 556, 278, 556,
    556, 222, 222, 500, 222, 833, 556, 556, 556, 556, 333, 500, 278, 556, 500, 722, 500, 500, 500, 334, 260, 334, 584,
];

/// Look of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Style {
    Upright,
    Italic,
    /// Italic, as indices that are names of axes are.
    Subscript,
    Superscript,
}

/// Letters of one look within a line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Run {
    pub text: String,
    pub style: Style,
}

impl Run {
    pub fn new(text: impl Into<String>, style: Style) -> Self {
        let text = text.into();
        Self { text: if text.is_ascii() { text } else { drawable(&text) }, style }
    }

    pub fn upright(text: impl Into<String>) -> Self {
        Self::new(text, Style::Upright)
    }
}

/// What titles and names may well have and the font has not, in signs and words that it has: ∇² is the Laplacian Δ.
const WRITTEN: [(&str, &str); 9] = [
    ("∇²", "Δ"),
    ("∇^2", "Δ"),
    ("∇·", "div "),
    ("∇⋅", "div "),
    ("∇×", "curl "),
    ("∇", "grad "),
    ("∮", "∫"),
    ("⋅", "·"),
    ("∈", " in "),
];

/// The text with every sign of [`WRITTEN`] replaced.
fn drawable(text: &str) -> String {
    WRITTEN.iter().fold(text.to_owned(), |text, (sign, written)| text.replace(sign, written))
}

/// A line of upright text.
pub(super) fn plain(text: impl Into<String>) -> Vec<Run> {
    vec![Run::upright(text)]
}

/// Width of upright text, in em.
fn width_em(text: &str) -> f64 {
    text.chars().map(char_width_em).sum()
}

fn char_width_em(c: char) -> f64 {
    let ascii = (c as u32).checked_sub(0x20).and_then(|i| ASCII_WIDTHS.get(i as usize));
    match (ascii, c) {
        (Some(&width), _) => f64::from(width) / 1000.0,
        (None, '−' | '×') => 0.584,
        (None, '\u{2009}') => 0.2,
        (None, '–') => 0.556,
        (None, '…') => 1.0,
        (None, 'τ') => 0.395,
        // The widest Latin, Greek or Cyrillic letters but few are narrower than 0.7 em; CJK letters are one em wide.
        (None, c) if (c as u32) < 0x1100 => 0.7,
        (None, _) => 1.0,
    }
}

/// Width of runs written in `size`, in page units.
pub(super) fn width(runs: &[Run], size: f64) -> f64 {
    let em = |run: &Run| match run.style {
        Style::Upright | Style::Italic => width_em(&run.text),
        Style::Subscript | Style::Superscript => SCRIPT_SIZE * width_em(&run.text),
    };
    size * runs.iter().map(em).sum::<f64>()
}

/// `text` on one line, without control characters, each stretch of white space one space.
pub(super) fn single_line(text: &str) -> String {
    let spaced: String = text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    spaced.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// `text` cut after the last letter that leaves room for an ellipsis within `room` page units, or whole if it fits.
pub(super) fn clipped(text: &str, size: f64, room: f64) -> String {
    let text = single_line(text);
    if size * width_em(&text) <= room {
        return text;
    }
    let mut used = size * width_em("…");
    let kept: String = text
        .chars()
        .take_while(|&c| {
            used += size * char_width_em(c);
            used <= room
        })
        .collect();
    format!("{}…", kept.trim_end())
}

/// `text` broken between words into at most `most` lines of `room` page units; what is still too long ends in an ellipsis.
pub(super) fn wrapped(text: &str, size: f64, room: f64, most: usize) -> Vec<String> {
    let text = single_line(text);
    let mut lines: Vec<String> = Vec::new();
    for word in text.split(' ').filter(|word| !word.is_empty()) {
        match lines.last_mut() {
            Some(line) if lines_full(line, word, size, room) => lines.push(word.to_owned()),
            Some(line) => {
                line.push(' ');
                line.push_str(word);
            }
            None => lines.push(word.to_owned()),
        }
    }
    if lines.len() > most && most > 0 {
        let rest = lines.split_off(most - 1).join(" ");
        lines.push(rest);
    }
    lines.iter().map(|line| clipped(line, size, room)).collect()
}

fn lines_full(line: &str, word: &str, size: f64, room: f64) -> bool {
    size * (width_em(line) + width_em(" ") + width_em(word)) > room
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_title_breaks_between_words_and_ends_in_an_ellipsis() {
        let lines = wrapped(&"torsion ".repeat(40), 10.0, 200.0, 2);
        assert_eq!(lines.len(), 2);
        assert!(lines[0].ends_with("torsion"));
        assert!(lines[1].ends_with('…'));
        assert!(lines.iter().all(|line| 10.0 * width_em(line) <= 200.0));
    }

    #[test]
    fn one_endless_word_is_clipped() {
        let lines = wrapped(&"x".repeat(500), 10.0, 100.0, 3);
        assert_eq!(lines.len(), 1);
        assert!(10.0 * width_em(&lines[0]) <= 100.0);
    }

    #[test]
    fn white_space_and_control_characters_become_single_spaces() {
        assert_eq!(single_line(" a\n\tb\u{0}c  "), "a b c");
        assert!(wrapped("   ", 10.0, 100.0, 2).is_empty());
    }

    #[test]
    fn scripts_are_narrower_than_their_line() {
        let whole = width(&[Run::upright("zx")], 10.0);
        assert!((width(&[Run::new("zx", Style::Subscript)], 10.0) - SCRIPT_SIZE * whole).abs() < 1e-12); // rounding
    }

    #[test]
    fn signs_that_the_font_lacks_are_written_so_that_they_can_be_read() {
        let written = |text: &str| Run::upright(text).text;
        assert_eq!(written("∇²u = 1, |∇u|, ∇·σ, ∮τ ds"), "Δu = 1, |grad u|, div σ, ∫τ ds");
        assert_eq!(written("τ_max, x² ≤ ∞"), "τ_max, x² ≤ ∞");
    }
}
