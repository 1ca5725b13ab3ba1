//! What writers of other notations write, recognised where TOML gives up: `.5`, `0,25`, `(0, 0)`, `2*pi`.

use super::tree::cut;
use nmt_curve::Expression;
use std::ops::Range;

/// A fault explained.
pub(super) struct Explained {
    /// The bytes it is about.
    pub(super) place: Range<usize>,
    pub(super) message: String,
    pub(super) remedy: String,
}

/// What is meant where the parser found a fault at `at`; `None` where nothing is recognised.
pub(super) fn explained(text: &str, at: usize) -> Option<Explained> {
    let start = text.get(..at)?.rfind('\n').map_or(0, |newline| newline + 1);
    let end = text.get(at..)?.find('\n').map_or(text.len(), |newline| at + newline);
    let line = Line { text, start, end, at };
    line.decimal_comma().or_else(|| line.parentheses()).or_else(|| line.bare_point()).or_else(|| line.formula())
}

/// The value of a formula without variables, `2*pi`, written out; `None` where it is none.
pub(super) fn value_of(formula: &str) -> Option<String> {
    let is_short = formula.len() <= 200;
    let value = is_short.then(|| Expression::parse(formula, &[]).ok()).flatten()?.eval(&[]);
    value.is_finite().then(|| super::limits::show(value))
}

/// The line of a fault.
struct Line<'t> {
    text: &'t str,
    start: usize,
    end: usize,
    at: usize,
}

impl<'t> Line<'t> {
    /// `irregularity = 0,25`, `{ radius = 0,5 }`.
    fn decimal_comma(&self) -> Option<Explained> {
        let equals = self.start + self.text.get(self.start..self.at)?.rfind('=')?;
        let rest = self.text.get(equals + 1..self.end)?;
        let from = equals + 1 + (rest.len() - rest.trim_start().len());
        let rest = rest.trim_start();
        let written = &rest[..rest.find(|c: char| !(c.is_ascii_digit() || "+-,".contains(c))).unwrap_or(rest.len())];
        let (whole, decimals) = written.split_once(',')?;
        let digits = |part: &str| !part.is_empty() && part.bytes().all(|b| b.is_ascii_digit());
        let is_number = digits(whole.trim_start_matches(['+', '-'])) && digits(decimals);
        is_number.then(|| Explained {
            place: from..from + written.len(),
            message: format!("`{}` has a decimal comma", cut(written)),
            remedy: format!("write {whole}.{decimals}; a comma parts two values"),
        })
    }

    /// `(0, 0)`: the fault is at its first parenthesis, or in it.
    fn parentheses(&self) -> Option<Explained> {
        let before = self.text.get(self.start..self.at)?;
        let here = self.text.get(self.at..self.end)?;
        let opening = if here.starts_with('(') { self.at } else { self.start + before.rfind('(')? };
        // A value begins here, and not the argument of a function.
        self.text.get(self.start..opening)?.trim_end().ends_with(['=', '[', ',']).then_some(())?;
        let inside = self.text.get(opening + 1..self.end)?;
        let inside = &inside[..inside.find(')')?];
        let is_list = inside.contains(',') && !inside.contains(['(', '[', '{', '"', '=']);
        is_list.then(|| Explained {
            place: opening..opening + inside.len() + 2,
            message: format!("`({})` is no array: those have square brackets", cut(inside)),
            remedy: format!("write [{}]", cut(inside)),
        })
    }

    /// The word around the fault.
    fn word(&self) -> Option<(Range<usize>, &'t str)> {
        let parts = |c: char| c.is_whitespace() || ",[]{}=#\"'".contains(c);
        let from = self.text.get(self.start..self.at)?.rfind(parts).map_or(self.start, |k| self.start + k + 1);
        let rest = self.text.get(from..self.end)?;
        let word = &rest[..rest.find(parts).unwrap_or(rest.len())];
        (!word.is_empty()).then(|| (from..from + word.len(), word))
    }

    /// `.5`, `-.5`, `5.`, `5.e3`.
    fn bare_point(&self) -> Option<Explained> {
        let (place, word) = self.word()?;
        word.parse::<f64>().ok().filter(|value| value.is_finite())?;
        let point = word.find('.')?;
        let is_digit = |k: Option<usize>| k.and_then(|k| word.as_bytes().get(k)).is_some_and(u8::is_ascii_digit);
        let (before, after) = (is_digit(point.checked_sub(1)), is_digit(Some(point + 1)));
        let zero = |is_there: bool| if is_there { "" } else { "0" };
        (!before || !after).then(|| Explained {
            place,
            message: format!("`{}` has no digit on one side of the point", cut(word)),
            remedy: format!("write {}{}.{}{}", &word[..point], zero(before), zero(after), &word[point + 1..]),
        })
    }

    /// `2*pi` where a number is meant, `x^2` where a formula is.
    fn formula(&self) -> Option<Explained> {
        let (place, word) = self.word()?;
        let is_formula = word.contains(['+', '-', '*', '/', '^', '(']) || word == "pi";
        if let Some(value) = value_of(word).filter(|_| is_formula) {
            let message = format!("`{}` is a formula, and this is no place for one without quotes", cut(word));
            return Some(Explained { place, message, remedy: format!("write its value, {value}") });
        }
        let of_variables = Expression::parse(word, &[]).is_err() && Expression::parse(word, &["x", "y", "t"]).is_ok();
        (is_formula && of_variables).then(|| Explained {
            place,
            message: format!("`{}` is a formula without quotes", cut(word)),
            remedy: format!("write \"{}\"", cut(word)),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The remedy for a fault at the first `|` of the text, which is taken out.
    fn remedy(text: &str) -> Option<String> {
        let at = text.find('|').expect("a mark");
        explained(&text.replacen('|', "", 1), at).map(|explained| explained.remedy)
    }

    #[test]
    fn numbers_get_their_digits() {
        for (text, expected) in [
            ("a = |.5", "write 0.5"),
            ("a = [0, -|.25]", "write -0.25"),
            ("a = 5.|", "write 5.0"),
            ("a = 5.|e3 # many", "write 5.0e3"),
            ("a = 0|,25", "write 0.25; a comma parts two values"),
            ("c = { radius = 1,5|}", "write 1.5; a comma parts two values"),
        ] {
            assert_eq!(remedy(text).as_deref(), Some(expected), "{text}");
        }
        for text in ["a = |5", "a = |5.5.5", "nodes = [0,2|5", "a = 1,x|", "|", "a = .|"] {
            assert_eq!(remedy(text), None, "{text}");
        }
    }

    #[test]
    fn pairs_get_their_brackets_and_formulas_their_value_or_quotes() {
        for (text, expected) in [
            ("outline = [|(0, 0), (1, 0)]", "write [0, 0]"),
            ("nodes = |(41, 21)\nb = 1", "write [41, 21]"),
            ("nodes = (41|, 21)", "write [41, 21]"),
            ("t = [0, |2*pi]", "write its value, 6.283185307179586"),
            ("t = [0, |pi]", "write its value, 3.141592653589793"),
            ("curve = |x^2", "write \"x^2\""),
        ] {
            assert_eq!(remedy(text).as_deref(), Some(expected), "{text}");
        }
        for text in ["name = |web", "name = |(web)", "a = |2*q", "a = |1/0"] {
            assert_eq!(remedy(text), None, "{text}");
        }
    }
}
