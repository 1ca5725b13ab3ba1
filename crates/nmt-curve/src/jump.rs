//! Steps and poles: where a curve is not continuous.

use nmt_geom::Point;
use nmt_geom::point::distance;

use crate::Curve;
use crate::subdivision::Leaf;

/// Intervals looked into: the steepest ones, since chords at a jump stay long however short the interval.
const SUSPECTS: usize = 8;

/// Steepness, against the mean of the curve, below which an interval cannot hide a jump.
///
/// An interval with a jump of 1e-6 of the length is halved to a width of 1e-8 before its chords agree.
const STEEP: f64 = 30.0;

/// Widths between which the chord about a suspect is followed.
const WIDE: f64 = 1.0 / (1_u64 << 26) as f64;
const NARROW: f64 = 1.0 / (1_u64 << 50) as f64;

/// Of the chords not wider than this the longest is the jump, of those four times as wide and more the longest is
/// compared with it: one alone may span whole waves, or both sides of a pole.
const FINAL: f64 = 4.0 * NARROW;

/// A jump keeps more than this fraction of its chord from [`WIDE`] to [`NARROW`].
///
/// A curve like x^a keeps 2^(−24a): 0.004 for a cube root, 0.19 for a tenth root.
const KEPT: f64 = 0.5;

/// Shortest jump, as a fraction of the curve's length; shorter ones are rounding, or no one's concern.
const SHORTEST: f64 = 1e-9;

/// Rounding of the coordinates that two neighbouring points may differ by.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// Two neighbouring parameters with points that are not neighbours.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Jump {
    pub(crate) u: f64,
    pub(crate) before: Point,
    pub(crate) after: Point,
}

/// The first jump found among the steepest of the leaves; `length` is that of the whole curve.
pub(crate) fn find_jump(curve: &Curve, leaves: &[Leaf], length: f64) -> Option<Jump> {
    let steepness = |leaf: &Leaf| leaf.length / (leaf.to - leaf.from);
    let mut suspects: Vec<&Leaf> = leaves.iter().filter(|leaf| steepness(leaf) > STEEP * length).collect();
    suspects.sort_by(|a, b| steepness(b).total_cmp(&steepness(a)));
    suspects.into_iter().take(SUSPECTS).find_map(|leaf| look(curve, leaf, length))
}

/// Sum of a few chords: more than the one from end to end where a pole is between.
fn stretched(curve: &Curve, a: f64, b: f64) -> f64 {
    const CHORDS: u32 = 4;
    let point = |k: u32| curve.point(a + (b - a) * f64::from(k) / f64::from(CHORDS));
    (0..CHORDS).map(|k| distance(point(k), point(k + 1))).sum()
}

/// Halves the neighbourhood of a leaf, always keeping the half that is longer.
fn look(curve: &Curve, leaf: &Leaf, length: f64) -> Option<Jump> {
    let middle = 0.5 * (leaf.from + leaf.to);
    let margin = WIDE.max(0.5 * (leaf.to - leaf.from));
    let (mut a, mut b) = ((middle - margin).max(0.0), (middle + margin).min(1.0));
    let (mut p, mut q) = (curve.point(a), curve.point(b));
    let (mut wide, mut narrow) = (0.0_f64, 0.0_f64);
    while b - a > NARROW {
        let u = 0.5 * (a + b);
        let point = curve.point(u);
        if stretched(curve, a, u) >= stretched(curve, u, b) {
            (b, q) = (u, point);
        } else {
            (a, p) = (u, point);
        }
        if b - a <= FINAL {
            narrow = narrow.max(distance(p, q));
        } else if (4.0 * FINAL..=WIDE).contains(&(b - a)) {
            wide = wide.max(distance(p, q));
        }
    }
    let magnitude = p.iter().chain(&q).fold(0.0_f64, |most, c| most.max(c.abs()));
    let a_jump = narrow > KEPT * wide && narrow > SHORTEST * length + ROUNDING * magnitude;
    a_jump.then_some(Jump { u: 0.5 * (a + b), before: p, after: q })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curve::samples::graph;
    use crate::subdivision::Subdivision;

    fn jump(text: &str, from: f64, to: f64) -> Option<Jump> {
        let curve = graph(text, from, to);
        let mut division = Subdivision::new(&curve, 1000);
        division.refine(1e-6, 1000);
        find_jump(&curve, division.leaves(), division.length)
    }

    #[test]
    fn steps_and_poles_are_found() {
        for (text, from, to, at) in [
            ("floor(x)", 0.5, 1.7, 1.0),
            ("sign(x)", -1.0, 1.0, 0.0),
            ("sign(x-0.1)*0.001 + x", -1.0, 1.0, 0.1),
            ("tan(x)", 0.0, 2.0, std::f64::consts::FRAC_PI_2),
            ("1/(x-0.3)", 0.0, 1.0, 0.3),
            ("1/(x-0.3)^2", 0.0, 1.0, 0.3),
        ] {
            let found = jump(text, from, to).unwrap_or_else(|| panic!("{text} jumps"));
            let x = from + (to - from) * found.u;
            assert!((x - at).abs() < 1e-12, "{text}: {x}"); // the search ends at 2⁻⁵⁰ of the interval
        }
    }

    #[test]
    fn vertical_tangents_cusps_and_kinks_are_no_jumps() {
        for (text, from, to) in [
            ("sqrt(1-x^2)", -1.0, 1.0),
            ("cbrt(x)", -1.0, 2.0),
            ("abs(x-0.1)^(2/3)", -1.0, 1.0),
            ("abs(x-0.1)^0.1", -1.0, 1.0),
            ("abs(x-0.1)", -1.0, 1.0),
            ("tanh(1e6*(x-0.1))", -1.0, 1.0),
            ("1e-9*x + 1e6", 0.0, 1.0),
        ] {
            assert!(jump(text, from, to).is_none(), "{text}");
        }
    }
}
