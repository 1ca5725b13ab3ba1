//! The names a formula may use, and the nearest one to a name it may not.

use super::compile::{Function, Op};

/// What a name before a parenthesis calls.
#[derive(Clone, Copy, Debug)]
pub(super) enum Callee {
    /// One argument.
    One(Function),
    /// Exactly two arguments.
    Two(Op),
    /// Two or more arguments, taken together pair by pair.
    Many(Op),
}

/// All functions, by name.
const FUNCTIONS: [(&str, Callee); 22] = [
    ("sin", Callee::One(Function::Sin)),
    ("cos", Callee::One(Function::Cos)),
    ("tan", Callee::One(Function::Tan)),
    ("asin", Callee::One(Function::Asin)),
    ("acos", Callee::One(Function::Acos)),
    ("atan", Callee::One(Function::Atan)),
    ("atan2", Callee::Two(Op::Atan2)),
    ("sinh", Callee::One(Function::Sinh)),
    ("cosh", Callee::One(Function::Cosh)),
    ("tanh", Callee::One(Function::Tanh)),
    ("exp", Callee::One(Function::Exp)),
    ("ln", Callee::One(Function::Ln)),
    ("log", Callee::One(Function::Ln)),
    ("log10", Callee::One(Function::Log10)),
    ("sqrt", Callee::One(Function::Sqrt)),
    ("cbrt", Callee::One(Function::Cbrt)),
    ("abs", Callee::One(Function::Abs)),
    ("sign", Callee::One(Function::Sign)),
    ("min", Callee::Many(Op::Min)),
    ("max", Callee::Many(Op::Max)),
    ("floor", Callee::One(Function::Floor)),
    ("ceil", Callee::One(Function::Ceil)),
];

/// What other languages call things that a formula can say.
const ELSEWHERE: [(&str, &str); 14] = [
    ("arcsin", "asin"),
    ("arccos", "acos"),
    ("arctan", "atan"),
    ("arctan2", "atan2"),
    ("tg", "tan"),
    ("ctg", "1/tan(x)"),
    ("cot", "1/tan(x)"),
    ("sec", "1/cos(x)"),
    ("csc", "1/sin(x)"),
    ("sgn", "sign"),
    ("signum", "sign"),
    ("pow", "x^2"),
    ("power", "x^2"),
    ("fabs", "abs"),
];

/// The value of a named constant.
pub(super) fn constant(name: &str) -> Option<f64> {
    match name {
        "pi" => Some(std::f64::consts::PI),
        "e" => Some(std::f64::consts::E),
        _ => None,
    }
}

/// The function of that name.
pub(super) fn function(name: &str) -> Option<(&'static str, Callee)> {
    FUNCTIONS.iter().copied().find(|(known, _)| *known == name)
}

/// All names that are known beside `variables`, for a message.
pub(super) fn known(variables: &[&str]) -> String {
    let mut list = variables.join(", ");
    if !list.is_empty() {
        list.push_str(", ");
    }
    list.push_str("pi, e");
    for (name, _) in FUNCTIONS {
        list.push_str(", ");
        list.push_str(name);
    }
    list
}

/// `, did you mean …?` for a name that is not known; empty where nothing is close.
pub(super) fn hint(name: &str, variables: &[&str]) -> String {
    let suggestion = suggestion(name, variables);
    suggestion.map_or_else(String::new, |s| format!(", did you mean `{s}`?"))
}

fn suggestion(name: &str, variables: &[&str]) -> Option<String> {
    // Longer names are no misspelling of ours, and the comparison below is quadratic in the length.
    const LONGEST_MISSPELLING: usize = 16;
    if name.len() > LONGEST_MISSPELLING {
        return None;
    }
    let lower = name.to_lowercase();
    if let Some((_, ours)) = ELSEWHERE.iter().find(|(theirs, _)| *theirs == lower) {
        return Some((*ours).to_string());
    }
    let plain = || variables.iter().copied().chain(["pi", "e"]);
    let names = || plain().chain(FUNCTIONS.iter().map(|(known, _)| *known));
    if let Some(same) = names().find(|known| known.to_lowercase() == lower) {
        return Some(same.to_string());
    }
    // `xy`, `pix` or `xsin`: a product without its operator.
    for split in 1..name.len() {
        let (Some(head), Some(tail)) = (name.get(..split), name.get(split..)) else { continue };
        if plain().any(|known| known == head) {
            if names().any(|known| known == tail) {
                return Some(format!("{head}*{tail}"));
            }
            if tail.bytes().all(|b| b.is_ascii_digit()) {
                return Some(format!("{head}^{tail}` or `{head}*{tail}"));
            }
        }
    }
    let allowed = if name.len() < 4 { 1 } else { 2 };
    let functions = FUNCTIONS.iter().map(|(known, _)| (distance(&lower, known), *known));
    let (edits, nearest) = functions.min_by_key(|(edits, _)| *edits)?;
    (edits <= allowed && edits < name.len()).then(|| nearest.to_string())
}

/// How many letters must be added, removed or replaced to turn `a` into `b`.
fn distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, letter) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, other) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(letter != *other);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn misspelt_names_are_recognised() {
        for (wrong, right) in [
            ("sine", "sin"),
            ("sqr", "sqrt"),
            ("Sin", "sin"),
            ("PI", "pi"),
            ("X", "x"),
            ("arctan", "atan"),
            ("xy", "x*y"),
            ("pix", "pi*x"),
            ("flor", "floor"),
        ] {
            assert_eq!(suggestion(wrong, &["x", "y"]).as_deref(), Some(right), "{wrong}");
        }
        assert_eq!(suggestion("x2", &["x"]).as_deref(), Some("x^2` or `x*2"));
        assert_eq!(suggestion("zzzzzz", &["x"]), None);
    }

    #[test]
    fn the_list_of_known_names_is_complete() {
        let known = known(&["x", "y"]);
        assert!(known.starts_with("x, y, pi, e, sin, cos"));
        assert!(known.ends_with("min, max, floor, ceil"));
    }
}
