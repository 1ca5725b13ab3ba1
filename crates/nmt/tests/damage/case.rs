//! Damages: each is one edit of a sound file, or options beside it.

use std::fmt::Write;

/// One damage: of each edit the first occurrence of `find` becomes `put`.
pub struct Case {
    pub title: &'static str,
    pub edits: &'static [(&'static str, &'static str)],
    pub options: &'static [(&'static str, &'static str)],
}

pub const fn case(title: &'static str, edits: &'static [(&'static str, &'static str)]) -> Case {
    Case { title, edits, options: &[] }
}

pub const fn option(title: &'static str, options: &'static [(&'static str, &'static str)]) -> Case {
    Case { title, edits: &[], options }
}

impl Case {
    /// The file that was `sound`, damaged.
    pub fn damaged(&self, sound: &str) -> String {
        self.edits.iter().fold(sound.to_owned(), |text, (find, put)| {
            assert!(text.contains(find), "{}: {find:?} is not in the file", self.title);
            text.replacen(find, put, 1)
        })
    }
}

/// Every case with its edits and options, and the faults that it has; each must have some.
pub struct Report {
    pub text: String,
    /// Titles of the cases without a fault.
    pub silent: Vec<&'static str>,
}

impl Report {
    pub fn of(cases: &[Case], sound: &str, faults: impl Fn(&Case) -> Vec<String>) -> Self {
        let (mut text, mut silent) = (String::new(), Vec::new());
        for case in cases {
            writeln!(text, "# {}", case.title).unwrap();
            for (find, put) in case.edits.iter().filter(|(find, _)| *find != sound) {
                writeln!(text, "- {}", find.trim_end().replace('\n', "\n- ")).unwrap();
                if !put.is_empty() {
                    writeln!(text, "+ {}", put.trim_end().replace('\n', "\n+ ")).unwrap();
                }
            }
            for (name, value) in case.options {
                writeln!(text, "+ --{name} {value}").unwrap();
            }
            let faults = faults(case);
            if faults.is_empty() {
                silent.push(case.title);
            }
            faults.iter().for_each(|fault| writeln!(text, "{fault}").unwrap());
            text.push('\n');
        }
        Self { text, silent }
    }
}
