//! "Did you mean …?": the known word nearest to a misspelt one.

/// The candidate within a third of the word's length of it, the nearest first; `None` where all are farther.
///
/// An inserted, dropped, replaced or swapped letter counts 1; upper and lower case are the same.
pub(super) fn closest<'c>(word: &str, candidates: &[&'c str]) -> Option<&'c str> {
    // A word of a megabyte is not a misspelt key, and comparing it would take as long as reading the file.
    const LONGEST: usize = 64;
    if word.len() > LONGEST {
        return None;
    }
    let word: Vec<char> = word.to_lowercase().chars().collect();
    let limit = (word.len() / 3).max(1);
    let scored = candidates.iter().map(|c| (distance(&word, &c.to_lowercase().chars().collect::<Vec<_>>()), *c));
    scored.filter(|(d, c)| *d <= limit && *d < c.len()).min_by_key(|(d, _)| *d).map(|(_, c)| c)
}

/// The candidates as a list for a message: "`a`, `b` and `c`", each within `quote`.
pub(super) fn list(words: &[&str], quote: char, last: &str) -> String {
    let quoted: Vec<_> = words.iter().map(|word| format!("{quote}{word}{quote}")).collect();
    match quoted.split_last() {
        Some((end, [])) => end.clone(),
        Some((end, start)) => format!("{} {last} {end}", start.join(", ")),
        None => String::new(),
    }
}

/// Letters to insert, drop, replace or swap with a neighbour to turn one word into the other.
fn distance(a: &[char], b: &[char]) -> usize {
    let mut before: Vec<usize> = Vec::new();
    let mut above: Vec<usize> = (0..=b.len()).collect();
    for i in 1..=a.len() {
        let mut row = vec![i; b.len() + 1];
        for j in 1..=b.len() {
            let replaced = above[j - 1] + usize::from(a[i - 1] != b[j - 1]);
            row[j] = replaced.min(above[j] + 1).min(row[j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                row[j] = row[j].min(before[j - 2] + 1);
            }
        }
        before = std::mem::replace(&mut above, row);
    }
    above[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_misspelt_key_finds_the_nearest_known_one() {
        let keys = ["name", "nodes", "irregularity", "circle", "hole"];
        assert_eq!(closest("ndoes", &keys), Some("nodes"));
        assert_eq!(closest("Nodes", &keys), Some("nodes"));
        assert_eq!(closest("iregularity", &keys), Some("irregularity"));
        assert_eq!(closest("mesh", &keys), None);
        assert_eq!(closest("", &keys), None);
        assert_eq!(closest(&"n".repeat(100_000), &keys), None);
    }

    #[test]
    fn a_list_joins_its_last_word_with_and() {
        assert_eq!(list(&["a", "b", "c"], '`', "and"), "`a`, `b` and `c`");
        assert_eq!(list(&["a"], '"', "or"), "\"a\"");
        assert_eq!(list(&[], '"', "or"), "");
    }
}
