//! What of a case is held against the reference besides its clouds: `[stars]` and `[solutions]` of its `case.toml`.

use super::Entry;
use super::stars::StarsOf;
use anyhow::{Context as _, Result};
use nmt_cloud::{Cloud, Section};
use std::path::Path;
use toml::de::{DeTable, DeValue};

/// What `case.toml` says of stars and solutions.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Parts {
    stars: Option<Stars>,
    solutions: Option<Solutions>,
}

#[derive(Clone, Debug, PartialEq)]
struct Stars {
    of: StarsOf,
    tolerance: f64,
}

#[derive(Clone, Debug, PartialEq)]
struct Solutions {
    forms: Vec<String>,
    tolerance: f64,
}

/// Entries that one tolerance holds for.
pub struct Compared {
    /// What the file names: cloud, stars, solutions.
    pub name: &'static str,
    pub expected: Vec<Entry>,
    pub found: Vec<Entry>,
    pub tolerance: f64,
}

impl Parts {
    /// Reads the two tables, each with its reason.
    pub fn of(case: &DeTable) -> Result<Self> {
        let table = |name: &str| case.get(name).and_then(|value| value.get_ref().as_table());
        let stars = table("stars").map(|stars| -> Result<Stars> {
            word(stars, "reason")?;
            let [size, enlarged] = [whole(stars, "size")?, whole(stars, "enlarged_by_reference")?];
            let of = StarsOf { size, enlarged, left_out: left_out(stars)? };
            Ok(Stars { of, tolerance: number(stars, "tolerance")? })
        });
        let solutions = table("solutions").map(|solutions| -> Result<Solutions> {
            word(solutions, "reason")?;
            let forms = solutions.get("forms").and_then(|forms| forms.get_ref().as_array()).context("no forms")?;
            let form = |form: &toml::Spanned<DeValue>| form.get_ref().as_str().map(str::to_owned);
            let forms = forms.iter().map(|f| form(f).context("a form is a word")).collect::<Result<Vec<_>>>()?;
            Ok(Solutions { forms, tolerance: number(solutions, "tolerance")? })
        });
        Ok(Self {
            stars: stars.transpose().context("[stars]")?,
            solutions: solutions.transpose().context("[solutions]")?,
        })
    }

    /// Expected and found entries of what the case has.
    pub fn compared(&self, clouds: &[(Section, Cloud)], expected: &Path) -> Result<Vec<Compared>> {
        let mut compared = Vec::new();
        let Some(Stars { of, tolerance }) = &self.stars else {
            anyhow::ensure!(self.solutions.is_none(), "case.toml has [solutions] without [stars]");
            return Ok(compared);
        };
        let (of_reference, found) = super::stars::entries(clouds, expected, of)?;
        compared.push(Compared { name: "stars", expected: of_reference, found, tolerance: *tolerance });
        if let Some(Solutions { forms, tolerance }) = &self.solutions {
            let (of_reference, found) = super::solutions::entries(clouds, expected, of.size, forms)?;
            compared.push(Compared { name: "solutions", expected: of_reference, found, tolerance: *tolerance });
        }
        Ok(compared)
    }
}

fn word<'a>(table: &'a DeTable, key: &str) -> Result<&'a str> {
    table.get(key).and_then(|value| value.get_ref().as_str()).with_context(|| format!("no {key}"))
}

fn whole(table: &DeTable, key: &str) -> Result<usize> {
    integer(table.get(key).with_context(|| format!("no {key}"))?.get_ref()).with_context(|| key.to_owned())
}

fn integer(value: &DeValue) -> Result<usize> {
    Ok(value.as_integer().context("no whole number")?.as_str().parse()?)
}

/// The pairs of order and node, if there are any.
fn left_out(stars: &DeTable) -> Result<Vec<[usize; 2]>> {
    let Some(list) = stars.get("left_out") else { return Ok(Vec::new()) };
    let pair = |pair: &toml::Spanned<DeValue>| {
        let pair = pair.get_ref().as_array().context("left_out: [order, node]")?;
        let numbers = pair.iter().map(|n| integer(n.get_ref())).collect::<Result<Vec<_>>>()?;
        <[usize; 2]>::try_from(numbers).map_err(|_| anyhow::anyhow!("left_out: [order, node]"))
    };
    list.get_ref().as_array().context("left_out is no list")?.iter().map(pair).collect()
}

/// A number with a point or an exponent.
pub fn number(table: &DeTable, key: &str) -> Result<f64> {
    let value = table.get(key).and_then(|value| value.get_ref().as_float()).with_context(|| format!("no {key}"))?;
    Ok(value.as_str().replace('_', "").parse()?)
}

#[cfg(test)]
mod tests {
    use super::super::{Case, Scale, clouds, read_case, worst};
    use super::*;
    use crate::root;

    fn case(name: &str) -> (Case, Vec<Compared>) {
        let case = read_case(root().join("fixtures/golden").join(name)).expect("a case");
        let clouds = clouds::clouds(&case.problem).expect("clouds");
        let compared = case.parts.compared(&clouds, &case.directory.join("expected")).expect("stars and solutions");
        (case, compared)
    }

    #[test]
    fn one_changed_number_of_any_file_is_found() {
        let (_, compared) = case("cloud-chord-semicircle");
        let files = ["star.csv", "mwls.csv", "local.csv", "var.csv", "results.csv", "stars that nmt repaired"];
        let mut seen = 0;
        for Compared { expected, found, tolerance, .. } in &compared {
            assert!(worst(expected, found).expect("entries").difference <= *tolerance);
            for file in files {
                let n = expected.iter().filter(|e| e.id.starts_with(file)).count();
                seen += usize::from(n > 4);
                for k in [0, n / 2, n.saturating_sub(1)].into_iter().filter(|_| n > 0) {
                    let mut changed = expected.clone();
                    let Some(entry) = changed.iter_mut().filter(|e| e.id.starts_with(file)).nth(k) else {
                        panic!("{file} has {n} entries")
                    };
                    entry.value += match entry.scale {
                        Scale::Exact => 1.0,
                        Scale::Itself => 1e-8 * entry.value,
                        Scale::Length(largest) => 1e-8 * largest,
                    };
                    let id = entry.id.clone();
                    let worst = worst(&changed, found).expect("entries");
                    assert!(worst.difference > *tolerance && worst.expected.id == id, "{id}: {worst:?}");
                }
            }
        }
        assert_eq!(seen, files.len());
    }

    #[test]
    fn stars_are_left_out_for_a_reason_alone() {
        let (case, compared) = case("cloud-ties");
        let [Compared { expected, found, tolerance, .. }] = &compared[..] else { panic!("stars alone") };
        assert!(worst(expected, found).expect("entries").difference <= *tolerance);
        // One that agrees must not be left out.
        let mut parts = case.parts.clone();
        let stars = parts.stars.as_mut().expect("stars");
        assert_eq!((stars.of.left_out.len(), stars.of.enlarged), (17, 2));
        stars.of.left_out.push([2, 1]);
        let clouds = clouds::clouds(&case.problem).expect("clouds");
        let again = parts.compared(&clouds, &case.directory.join("expected")).expect("stars");
        let worst = worst(&again[0].expected, &again[0].found).expect("entries");
        assert!(worst.difference > 1.0 && worst.expected.id.contains("node 1, left out"), "{worst:?}");
    }
}
