//! Speed and memory: growth of every stage, ratios to other programs, instruction counts of the kernels.

mod baseline;
mod growth;
mod kernels;
mod peers;
mod run;

use crate::root;
use anyhow::{Context as _, Result};
use growth::Growth;
use peers::Peers;
use run::{Case, Run};
use std::fs;

pub use kernels::{bless, check, kernel};

/// Sizes and how often each is run, the least time of all counting.
const SIZES: [(usize, usize); 3] = [(10_000, 5), (100_000, 3), (1_000_000, 2)];

/// The size that is run once when asked for.
const LARGE: (usize, usize) = (4_000_000, 1);

/// Systems up to this size are also solved directly.
const DIRECT: usize = 100_000;

/// Times everything, writes the tables of docs/performance.md and docs/figures/growth.png.
pub fn measure(with_large: bool) -> Result<()> {
    let program = run::build()?;
    let peers = Peers::from_environment();
    let mut growth = Growth::default();
    let mut ratios = Vec::new();
    for (nodes, rounds) in SIZES.into_iter().chain(with_large.then_some(LARGE)) {
        for _ in 0..rounds {
            // In turn, so that whatever disturbs the machine disturbs all alike.
            for case in Case::ALL {
                growth.add(nodes, case, 1, program.run(case, nodes, 1, &["--solver", "iterative"])?);
                if nodes <= DIRECT {
                    growth.add_direct(nodes, case, program.run(case, nodes, 1, &["--solver", "direct"])?);
                }
            }
            growth.add(nodes, Case::ALL[0], 2, program.run(Case::ALL[0], nodes, 2, &["--solver", "iterative"])?);
            if nodes <= SIZES[2].0 {
                peers.measure(nodes, &mut ratios)?;
            }
        }
        growth.add_files(nodes, program.run_with_files(Case::ALL[0], nodes)?);
        println!("{}", growth.last_line());
    }
    let tables = growth.tables() + &peers.table(&ratios, &growth);
    print!("{tables}");
    write_between(&tables)?;
    let picture = root().join("docs/figures/growth.png");
    fs::write(&picture, nmt::plot::png(&growth.picture())?)
        .with_context(|| format!("{} cannot be written", picture.display()))
}

const BEGIN: &str = "<!-- cargo xtask perf: from here -->\n";
const END: &str = "<!-- cargo xtask perf: to here -->";

/// Puts the tables in their place in docs/performance.md.
fn write_between(tables: &str) -> Result<()> {
    let page = root().join("docs/performance.md");
    let text = fs::read_to_string(&page).with_context(|| format!("{} cannot be read", page.display()))?;
    let written =
        between(&text, tables).with_context(|| format!("{} has no lines `{BEGIN}` and `{END}`", page.display()))?;
    fs::write(&page, written).with_context(|| format!("{} cannot be written", page.display()))
}

fn between(text: &str, tables: &str) -> Option<String> {
    let (before, rest) = text.split_once(BEGIN)?;
    let (_, after) = rest.split_once(END)?;
    Some(format!("{before}{BEGIN}\n{tables}\n{END}{after}"))
}

/// The least of each figure over runs of the same case.
fn least(runs: &[Run], of: impl Fn(&Run) -> f64) -> f64 {
    runs.iter().map(of).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_take_the_place_of_the_last_ones() {
        let page = format!("before\n{BEGIN}old\n{END}\nafter\n");
        let written = between(&page, "new").expect("both lines are there");
        assert_eq!(written, format!("before\n{BEGIN}\nnew\n{END}\nafter\n"));
        assert_eq!(between(&written, "new").as_ref(), Some(&written));
        assert_eq!(between("no lines", "new"), None);
    }
}
