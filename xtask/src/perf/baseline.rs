//! Recorded instruction counts, and what has become of them.

use anyhow::{Context as _, Result};
use std::collections::BTreeMap;
use std::path::Path;
use std::{fmt, fs};

/// Counts that differ by more than this part are reported.
const TOLERANCE: f64 = 0.05;

/// Instructions by kernel.
#[derive(Debug, Default, PartialEq)]
pub struct Baseline(pub BTreeMap<String, u64>);

/// What became of a count.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Verdict {
    /// Within [`TOLERANCE`].
    Same,
    /// Fewer by this part.
    Better(f64),
    /// More by this part.
    Worse(f64),
    /// Not recorded yet.
    New,
    /// Recorded, but no longer counted.
    Gone,
}

impl Verdict {
    /// Whether the check fails for it.
    pub fn is_failure(self) -> bool {
        matches!(self, Self::Worse(_) | Self::New | Self::Gone)
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Same => write!(f, "as recorded"),
            Self::Better(part) => write!(f, "{:.1} % fewer instructions than recorded", 100.0 * part),
            Self::Worse(part) => write!(f, "{:.1} % MORE instructions than recorded", 100.0 * part),
            Self::New => write!(f, "not recorded"),
            Self::Gone => write!(f, "recorded, but not counted"),
        }
    }
}

impl Baseline {
    /// Reads the recorded counts.
    pub fn read(file: &Path) -> Result<Self> {
        let text = fs::read_to_string(file)
            .with_context(|| format!("{} cannot be read; cargo xtask perf --bless writes it", file.display()))?;
        Self::of(&text).with_context(|| format!("{} is damaged", file.display()))
    }

    fn of(text: &str) -> Option<Self> {
        let entry = |line: &str| {
            let (name, count) = line.split_once('=')?;
            Some((name.trim().trim_matches('"').to_owned(), count.trim().parse().ok()?))
        };
        let lines = text.lines().filter(|line| !line.starts_with('#') && !line.is_empty());
        lines.map(entry).collect::<Option<_>>().map(Self)
    }

    /// Records the counts.
    pub fn write(&self, file: &Path) -> Result<()> {
        fs::write(file, self.text()).with_context(|| format!("{} cannot be written", file.display()))
    }

    fn text(&self) -> String {
        let mut text =
            "# Instructions of each kernel on some 2 500 nodes; cargo xtask perf --bless writes them.\n".to_owned();
        self.0.iter().for_each(|(name, count)| text += &format!("\"{name}\" = {count}\n"));
        text
    }

    /// What became of every kernel.
    pub fn compare(&self, found: &BTreeMap<String, u64>) -> Vec<(String, Verdict)> {
        let verdict = |name: &String, count: u64| match self.0.get(name) {
            None => Verdict::New,
            Some(recorded) => match count as f64 / *recorded as f64 - 1.0 {
                change if change > TOLERANCE => Verdict::Worse(change),
                change if change < -TOLERANCE => Verdict::Better(-change),
                _ => Verdict::Same,
            },
        };
        let counted = found.iter().map(|(name, count)| (name.clone(), verdict(name, *count)));
        let gone = self.0.keys().filter(|name| !found.contains_key(*name)).map(|name| (name.clone(), Verdict::Gone));
        counted.chain(gone).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counts(of: &[(&str, u64)]) -> BTreeMap<String, u64> {
        of.iter().map(|(name, count)| ((*name).to_owned(), *count)).collect()
    }

    #[test]
    fn a_kernel_that_takes_more_fails_and_one_that_takes_less_does_not() {
        let recorded = Baseline(counts(&[("a", 1000), ("b", 1000), ("c", 1000), ("d", 1000)]));
        let verdicts = recorded.compare(&counts(&[("a", 1049), ("b", 1060), ("c", 900), ("e", 5)]));
        let failed: Vec<&str> = verdicts.iter().filter(|(_, v)| v.is_failure()).map(|(name, _)| &**name).collect();
        assert_eq!(failed, ["b", "e", "d"]);
        assert!(matches!(verdicts[2].1, Verdict::Better(part) if (part - 0.1).abs() < 1e-12)); // rounding
        assert_eq!(verdicts[0].1, Verdict::Same);
    }

    #[test]
    fn what_is_written_is_read_again_and_damage_is_seen() {
        let recorded = Baseline(counts(&[("matrix × vector", 12), ("rows", 34)]));
        assert_eq!(Baseline::of(&recorded.text()), Some(recorded));
        assert_eq!(Baseline::of("rows = many\n"), None);
    }
}
