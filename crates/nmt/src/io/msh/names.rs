//! Names that Gmsh and the readers of its files take, each once.

use std::collections::{HashMap, HashSet};

/// Longest name, in bytes.
///
/// Gmsh promises to read 127 characters, and a reader with a buffer of 128 bytes a line has the quotes, a blank and the
/// end of the line to put there too.
const LONGEST: usize = 120;

/// Names given out so far, of surfaces and curves alike: meshio keeps both in one dictionary.
#[derive(Default)]
pub(super) struct Names {
    taken: HashSet<String>,
    /// How often a name was wanted.
    wanted: HashMap<String, usize>,
}

impl Names {
    /// The name wanted if it can be had: without `"` and `\`, which readers end or escape names with, at most
    /// 120 bytes long, and followed by ` (2)`, ` (3)` … where others have it already.
    pub(super) fn give(&mut self, wanted: &str) -> String {
        let plain: String = wanted.chars().map(readable).collect();
        let times = self.wanted.entry(plain.clone()).or_default();
        loop {
            *times += 1;
            let end = if *times == 1 { String::new() } else { format!(" ({times})") };
            let name = format!("{}{end}", beginning(&plain, LONGEST - end.len()));
            if self.taken.insert(name.clone()) {
                return name;
            }
        }
    }
}

fn readable(c: char) -> char {
    match c {
        '"' => '\'',
        '\\' => '/',
        c if c.is_control() => ' ',
        c => c,
    }
}

/// As many whole characters of a text as fit.
fn beginning(text: &str, n_bytes: usize) -> &str {
    let fits = |(at, c): (usize, char)| Some(at + c.len_utf8()).filter(|&end| end <= n_bytes);
    &text[..text.char_indices().map_while(fits).last().unwrap_or(0)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_that_can_be_had_is_given_as_it_is() {
        let mut names = Names::default();
        for name in ["web", "arch/bore/e1", "it's ünï ∫ #1 $End", "arch|head 1"] {
            assert_eq!(names.give(name), name);
        }
    }

    #[test]
    fn what_would_end_or_break_a_name_is_replaced() {
        let mut names = Names::default();
        assert_eq!(names.give("12\" pipe"), "12' pipe");
        assert_eq!(names.give("a\\b\nc"), "a/b c");
    }

    #[test]
    fn a_name_that_is_taken_gets_a_number_of_its_own() {
        let mut names = Names::default();
        let given = ["a", "a (2)", "a", "a", "\"", "'"].map(|name| names.give(name));
        assert_eq!(given, ["a", "a (2)", "a (3)", "a (4)", "'", "' (2)"]);
    }

    #[test]
    fn long_names_are_cut_between_characters_and_stay_apart() {
        let mut names = Names::default();
        let long = "é".repeat(200);
        let given = [&long, &format!("{long}e"), &format!("a{long}")].map(|name| names.give(name));
        assert_eq!(given.each_ref().map(String::len), [120, 120, 119]);
        assert!(given[1].ends_with("é (2)"));
    }
}
