//! The range of every value, for the file and the options of the command alike.

use super::schema::MeshMethod;
use super::suggest;
use nmt_cloud::{BYTES_PER_GRID_POINT, ClearanceUnit, MAX_GRID_POINTS};
use nmt_curve::Division;
use nmt_mfdm::{Formulation, GAUSS_POINTS, HoleCondition, MAX_ORDER, Solver, StarChoice, Test, Trial, n_monomials};
use nmt_tri::Elimination;

/// Lengths, moduli, twists and torques are at most this, whatever their unit.
///
/// Then no later stage can overflow: J is a length to the fourth (1e±120), the torque GθJ at most 1e180, and the square
/// of a stress from a given torque at most 1e240 (f64 ends at 1e308).
pub(super) const LARGEST: f64 = 1.0e30;

/// And at least this, where they must not be 0.
pub(super) const SMALLEST: f64 = 1.0e-30;

/// Most nodes an edge may be given of its own: a cloud of 10⁸ grid points has 10⁴ along a side.
const MOST_EDGE_NODES: i128 = 1_000_000;

/// Most sweeps of smoothing: after some tens nothing moves any more.
const MOST_SWEEPS: i128 = 1000;

/// Least and most spacings of clearance.
///
/// Without clearance a cloud has every grid point strictly inside; beyond two spacings it has no use.
const CLEARANCE: [f64; 2] = [0.0, 2.0];

/// Least and most relative error of J to refine clouds down to.
///
/// Rounding leaves some 1e-13; beyond a tenth J is no number to build on.
const TOLERANCE: [f64; 2] = [1.0e-12, 0.1];

/// Why a value is refused, and what to give instead.
#[derive(Debug, PartialEq)]
pub(super) struct Refusal {
    pub(super) message: String,
    pub(super) remedy: String,
}

fn refuse<T>(message: impl Into<String>, remedy: impl Into<String>) -> Result<T, Refusal> {
    Err(Refusal { message: message.into(), remedy: remedy.into() })
}

/// A number for a message: in the shortest digits that say it exactly, with an exponent where it is long.
pub(super) fn show(value: f64) -> String {
    if value == 0.0 || (1e-5..1e16).contains(&value.abs()) || !value.is_finite() {
        format!("{value}")
    } else {
        format!("{value:e}")
    }
}

/// Six digits of it: enough to find a place, or to compare.
pub(super) fn rounded(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}

/// A number that later stages can take: finite and at most [`LARGEST`].
pub(super) fn real(name: &str, value: f64) -> Result<f64, Refusal> {
    if !value.is_finite() {
        return refuse(format!("`{name}` is {}", show(value)), "give a finite number");
    }
    if value.abs() > LARGEST {
        let message = format!("`{name}` is {}, beyond {LARGEST:e} in size", show(value));
        return refuse(message, "choose a unit in which it is smaller");
    }
    Ok(value)
}

/// A relative error of J.
pub(super) fn tolerance(value: f64) -> Result<f64, Refusal> {
    let [least, most] = TOLERANCE;
    if (least..=most).contains(&value) {
        return Ok(value);
    }
    let message = format!("`tolerance` is {}, outside [{least:e}, {most}]", show(value));
    refuse(message, "give the relative error of J that is good enough, such as 1e-4")
}

/// The most nodes on the way to a tolerance.
pub(super) fn max_nodes(value: i128) -> Result<usize, Refusal> {
    if (1..=MAX_GRID_POINTS as i128).contains(&value) {
        return Ok(value as usize);
    }
    let message = format!("`max_nodes` is {value}, outside 1 to {MAX_GRID_POINTS:e}");
    refuse(message, "give the most nodes that a subdomain may have, such as 100000")
}

/// A radius, semi-axis or modulus.
pub(super) fn positive(name: &str, value: f64) -> Result<f64, Refusal> {
    real(name, value)?;
    if value <= 0.0 {
        return refuse(format!("`{name}` is {}", show(value)), "give a number greater than 0");
    }
    at_least_smallest(name, value)
}

fn at_least_smallest(name: &str, value: f64) -> Result<f64, Refusal> {
    if value.abs() < SMALLEST {
        let message = format!("`{name}` is {}, below {SMALLEST:e} in size", show(value));
        return refuse(message, "choose a unit in which it is larger");
    }
    Ok(value)
}

/// The twist or the torque.
pub(super) fn load(name: &str, value: f64) -> Result<f64, Refusal> {
    real(name, value)?;
    if value == 0.0 {
        let message = format!("`{name}` is 0: nothing is twisted, and J = T/(Gθ) has no value");
        return refuse(message, format!("give another {name}, or leave it out for twist = 1"));
    }
    at_least_smallest(name, value)
}

/// Amp of (10).
pub(super) fn irregularity(value: f64) -> Result<f64, Refusal> {
    if (0.0..0.5).contains(&value) {
        return Ok(value);
    }
    let message = format!("`irregularity` is {}, outside [0, 0.5)", show(value));
    refuse(message, "give 0 for a regular cloud, up to less than half a spacing, such as 0.25")
}

/// A clearance in spacings.
pub(super) fn clearance(name: &str, value: f64) -> Result<f64, Refusal> {
    let [least, most] = CLEARANCE;
    if (least..=most).contains(&value) {
        return Ok(value);
    }
    let message = format!("`{name}` is {}, outside [{least}, {most}]", show(value));
    refuse(message, "give it in spacings, or leave it out for the default")
}

/// N_x and N_y.
pub(super) fn nodes([n_x, n_y]: [i128; 2]) -> Result<[usize; 2], Refusal> {
    let few: Vec<_> = [("N_x", n_x), ("N_y", n_y)].into_iter().filter(|(_, n)| *n < 2).collect();
    if !few.is_empty() {
        let found: Vec<_> = few.iter().map(|(name, n)| format!("{name} = {n}")).collect();
        return refuse(
            format!("`nodes` has {}", found.join(" and ")),
            "give at least 2 grid lines each way, for example nodes = [41, 21]",
        );
    }
    let points = n_x as f64 * n_y as f64;
    if points > MAX_GRID_POINTS {
        let shrink = (MAX_GRID_POINTS / points).sqrt();
        // Each side keeps at least 2 lines, and leaves 2 to the other.
        let [most_x, most_y] = [n_x, n_y].map(|n| (n as f64 * shrink).floor().clamp(2.0, MAX_GRID_POINTS / 2.0));
        return refuse(
            format!(
                "`nodes` asks for {} grid points, more than {MAX_GRID_POINTS:e}: solving them takes about {} of memory",
                show(rounded(points)),
                memory(points * BYTES_PER_GRID_POINT)
            ),
            format!("give fewer, at most nodes = [{}, {}] in this proportion", most_x, most_y),
        );
    }
    Ok([n_x as usize, n_y as usize])
}

fn memory(bytes: f64) -> String {
    if bytes < 1e12 { format!("{:.0} GB", bytes / 1e9) } else { format!("{:.0} TB", bytes / 1e12) }
}

/// The own count of an edge, its ends included.
pub(super) fn edge_nodes(n: i128) -> Result<usize, Refusal> {
    if n < 2 {
        return refuse(format!("`nodes` of the edge is {n}"), "give at least 2: both its ends count");
    }
    if n > MOST_EDGE_NODES {
        return refuse(
            format!("`nodes` of the edge is {n}, more than {MOST_EDGE_NODES}"),
            "give fewer, or leave it out: then the edge follows the density of its contour",
        );
    }
    Ok(n as usize)
}

/// p; that 1 is for the variational formulation alone is known only with the subdomains.
pub(super) fn order(n: i128) -> Result<usize, Refusal> {
    if (1..=MAX_ORDER as i128).contains(&n) {
        return Ok(n as usize);
    }
    let remedy = "give order = 2, 3 or 4, or 1 in the variational formulation; or leave it out for 2";
    refuse(format!("`order` is {n}, outside 1 … {MAX_ORDER}"), remedy)
}

/// Nodes in a star of polynomials of order `order`, as far as the cloud need not be known.
pub(super) fn star(n: i128, order: usize) -> Result<usize, Refusal> {
    let monomials = n_monomials(order);
    if n < monomials as i128 {
        let message = format!("`star` is {n}, fewer nodes than the {monomials} monomials of order {order}");
        return refuse(message, format!("give at least {monomials}, or leave it out for the default"));
    }
    if n as f64 > MAX_GRID_POINTS {
        return refuse(format!("`star` is {n}, larger than any cloud"), "leave it out for the default");
    }
    Ok(n as usize)
}

/// g of the weight.
pub(super) fn smoothing(value: f64) -> Result<f64, Refusal> {
    if (0.0..=1.0).contains(&value) {
        return Ok(value);
    }
    let message = format!("`smoothing` is {}, outside [0, 1]", show(value));
    refuse(message, "give 0, the default, which interpolates, or a little more, such as 0.1")
}

/// Gauss points a triangle.
pub(super) fn gauss(n: i128) -> Result<usize, Refusal> {
    if let Some(&points) = GAUSS_POINTS.iter().find(|&&points| points as i128 == n) {
        return Ok(points);
    }
    let message = format!("`gauss` is {n}, and there is no rule of so many points");
    refuse(message, "give 1, 3, 4, 6, 7 or 12, or leave it out for the order's own")
}

/// The seed of the randomisation.
pub(super) fn seed(n: i128) -> Result<u64, Refusal> {
    u64::try_from(n)
        .or_else(|_| refuse(format!("`seed` is {n}"), format!("give a whole number from 0 to {}", i64::MAX)))
}

/// A formulation by its word.
pub(super) fn formulation(word: &str) -> Result<Formulation, Refusal> {
    choice("formulation", word, &Formulation::ALL.map(|f| (f.name(), f)))
}

/// The choice of stars by its word.
pub(super) fn stars(word: &str) -> Result<StarChoice, Refusal> {
    choice("choice of stars", word, &StarChoice::ALL.map(|c| (c.name(), c)))
}

/// Trial functions by their word.
pub(super) fn trial(word: &str) -> Result<Trial, Refusal> {
    choice("trial", word, &Trial::ALL.map(|t| (t.name(), t)))
}

/// Test functions by their word.
pub(super) fn test(word: &str) -> Result<Test, Refusal> {
    choice("test", word, &Test::ALL.map(|t| (t.name(), t)))
}

/// A linear solver by its word.
pub(super) fn solver(word: &str) -> Result<Solver, Refusal> {
    choice("solver", word, &Solver::ALL.map(|s| (s.name(), s)))
}

/// A condition on holes by its word.
pub(super) fn hole_condition(word: &str) -> Result<HoleCondition, Refusal> {
    choice("condition on holes", word, &HoleCondition::ALL.map(|c| (c.name(), c)))
}

/// The division of curved edges by its word.
pub(super) fn division(word: &str) -> Result<Division, Refusal> {
    choice("division", word, &Division::ALL.map(|d| (d.name(), d)))
}

/// The way to triangulate by its word.
pub(super) fn mesh_method(word: &str) -> Result<MeshMethod, Refusal> {
    choice("method", word, &MeshMethod::ALL.map(|m| (m.name(), m)))
}

/// The steps of the unconstrained way: names of those to take, or a flag 1 or 0 for each of the four, as in the paper.
pub(super) fn elimination(words: &[&str]) -> Result<Elimination, Refusal> {
    let steps = Elimination::STEPS;
    let of = |taken: [bool; 4]| {
        let [outside, in_hole, tiny, complete] = taken;
        Elimination { outside, in_hole, tiny, complete }
    };
    if words.len() == steps.len() && words.iter().all(|word| matches!(*word, "0" | "1")) {
        return Ok(of(std::array::from_fn(|k| words[k] == "1")));
    }
    let mut taken = [false; 4];
    for word in words {
        taken[choice("step of elimination", word, &std::array::from_fn::<_, 4, _>(|k| (steps[k], k)))?] = true;
    }
    Ok(of(taken))
}

/// Sweeps of smoothing.
pub(super) fn smooth(n: i128) -> Result<usize, Refusal> {
    if (0..=MOST_SWEEPS).contains(&n) {
        return Ok(n as usize);
    }
    refuse(format!("`smooth` is {n}, outside 0 … {MOST_SWEEPS}"), "give a number of sweeps; 3 to 10 are enough")
}

/// The unit of clearances by its word.
pub(super) fn clearance_unit(word: &str) -> Result<ClearanceUnit, Refusal> {
    choice("clearance", word, &ClearanceUnit::ALL.map(|c| (c.name(), c)))
}

fn choice<T: Copy>(what: &str, word: &str, known: &[(&str, T)]) -> Result<T, Refusal> {
    if let Some((_, value)) = known.iter().find(|(name, _)| *name == word) {
        return Ok(*value);
    }
    let names: Vec<_> = known.iter().map(|(name, _)| *name).collect();
    let use_one = format!("use {}", suggest::list(&names, '"', "or"));
    let remedy = match suggest::closest(word, &names) {
        Some(meant) => format!("did you mean \"{meant}\"? ({use_one})"),
        None => use_one,
    };
    refuse(format!("unknown {what} {}", quote(word)), remedy)
}

/// A text of the file for a message: in quotes, escaped, and cut where it is long.
pub(super) fn quote(text: &str) -> String {
    const LONGEST: usize = 40;
    if text.chars().count() <= LONGEST {
        return format!("{text:?}");
    }
    let start: String = text.chars().take(LONGEST).collect();
    format!("{start:?}…")
}

/// A text that stands in reports, files and pictures.
pub(super) fn label(name: &str, text: &str) -> Result<String, Refusal> {
    // XML, which the pictures and the mesh files are, can hold neither even when escaped.
    let unprintable = |c: &char| c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}');
    match text.chars().find(unprintable) {
        Some(found) => refuse(
            format!("`{name}` holds the character {found:?}, which no label can hold"),
            "write it on one line, without control characters",
        ),
        None => Ok(text.to_owned()),
    }
}

/// The name of a subdomain, hole or edge.
pub(super) fn name(text: &str) -> Result<String, Refusal> {
    if text.trim().is_empty() {
        return refuse(format!("`name` is {}", quote(text)), "give it a word, or leave it out for the default");
    }
    if text.contains(';') {
        let message = format!("`name` is {}, and `;` separates the names of edges in nodes.csv", quote(text));
        return refuse(message, "choose a name without `;`");
    }
    label("name", text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_grid_that_is_too_large_is_told_its_memory_and_the_largest_of_its_proportion() {
        let Refusal { message, remedy } = nodes([40_000, 10_000]).unwrap_err();
        assert_eq!(
            message,
            "`nodes` asks for 400000000 grid points, more than 1e8: solving them takes about 4 TB of memory"
        );
        assert_eq!(remedy, "give fewer, at most nodes = [20000, 5000] in this proportion");
        assert_eq!(nodes([10_000, 10_000]), Ok([10_000, 10_000]));
        assert!(nodes([i128::MAX, i128::MAX]).is_err());
    }

    #[test]
    fn the_largest_grid_of_a_proportion_is_itself_allowed() {
        for n in [[i128::MAX, 2], [10_001, 10_000], [3, 1 << 40], [1 << 80, 1 << 79]] {
            let Refusal { remedy, .. } = nodes(n).unwrap_err();
            let inside = remedy.split(['[', ']']).nth(1).unwrap();
            let offered: Vec<i128> = inside.split(", ").map(|n| n.parse().unwrap()).collect();
            assert!(nodes([offered[0], offered[1]]).is_ok(), "{n:?}: {remedy}");
        }
    }

    #[test]
    fn numbers_are_shown_exactly_and_short() {
        assert_eq!(show(0.1), "0.1");
        assert_eq!(show(-1.0), "-1");
        assert_eq!(show(1e300), "1e300");
        assert_eq!(show(f64::NEG_INFINITY), "-inf");
    }

    #[test]
    fn every_range_refuses_what_is_not_a_number() {
        for value in [f64::NAN, f64::INFINITY, -f64::INFINITY, 1e31, -1e31] {
            assert!(real("x", value).is_err() && positive("x", value).is_err() && load("x", value).is_err());
            assert!(irregularity(value).is_err() && clearance("x", value).is_err() && smoothing(value).is_err());
        }
        assert!(positive("x", 1e-31).is_err() && load("x", -1e-31).is_err());
        assert!(load("x", -1.0).is_ok() && real("x", 1e-31).is_ok());
    }

    #[test]
    fn long_texts_are_cut_in_messages() {
        assert_eq!(quote("a\"b"), "\"a\\\"b\"");
        assert!(quote(&"x".repeat(1_000_000)).len() < 60);
    }
}
