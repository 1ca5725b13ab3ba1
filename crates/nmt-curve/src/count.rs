//! How many nodes an edge gets.

use crate::Curve;
use crate::curve::turning_values;

/// Nodes of a straight edge, at least: its vertices.
pub const STRAIGHT_NODES_LEAST: usize = 2;

/// Nodes of a curved edge, at least: fewer cannot show that it is curved.
pub const CURVED_NODES_LEAST: usize = 4;

/// Nodes around a closed edge, at least.
pub const CLOSED_NODES_LEAST: usize = 8;

/// An edge that needs a whole number of nodes gets this number, whatever the rounding of its formula.
const WHOLE_NUMBER: f64 = 1e-6;

/// Accuracy of the length to which the curve is sampled in search of turns: about a thousand points for a plain curve.
const SAMPLING_REL_TOL: f64 = 1e-9;

/// Number of nodes of an edge, both ends included, from the nodes per unit length along x and y, `rate = [N_x/W,
/// N_y/H]`.
///
/// Paper, (2), taken piece by piece along the edge \[D4\]: n = ⌈I − 1e-6⌉ with I = Σ max(rate_x·|Δx|, rate_y·|Δy|) over
/// chords so short that I is accurate to 1e-7. As max(|p|, |q|) = (|p + q| + |p − q|)/2, I is half the total variation
/// of rate_x·x + rate_y·y and of rate_x·x − rate_y·y along the edge: the sum of their changes from turn to turn, and
/// turns are found exactly. At least 2 for a straight edge, 4 for a curved one, 8 for a closed one. An edge that is not
/// finite gets the least.
///
/// ```
/// # use nmt_curve::{Curve, node_count};
/// let base = Curve::Line { from: [0.0, 0.0], to: [2.0, 0.5] };
/// assert_eq!(node_count(&base, [10.0, 20.0]), 20);
/// ```
pub fn node_count(curve: &Curve, rate: [f64; 2]) -> usize {
    let least = match curve {
        Curve::Line { .. } => STRAIGHT_NODES_LEAST,
        Curve::Ellipse { .. } => CLOSED_NODES_LEAST,
        _ => CURVED_NODES_LEAST,
    };
    let sum = match curve {
        Curve::Line { from, to } => (rate[0] * (to[0] - from[0]).abs()).max(rate[1] * (to[1] - from[1]).abs()),
        _ => {
            let samples = curve.samples(SAMPLING_REL_TOL);
            let variation = |side: f64| -> f64 {
                let turns = turning_values(curve, &samples, |p| rate[0] * p[0] + side * rate[1] * p[1]);
                turns.windows(2).map(|pair| (pair[1] - pair[0]).abs()).sum()
            };
            0.5 * (variation(1.0) + variation(-1.0))
        }
    };
    if sum.is_finite() { least.max((sum - WHOLE_NUMBER).ceil() as usize) } else { least }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Turn;
    use crate::curve::samples::{graph, parametric};

    #[test]
    fn straight_edges_have_the_count_of_the_paper() {
        let line = |x: f64, y: f64| Curve::Line { from: [0.0, 0.0], to: [x, y] };
        assert_eq!(node_count(&line(1.0, 0.0), [21.0, 11.0]), 21);
        assert_eq!(node_count(&line(0.0, 1.0), [21.0, 11.0]), 11);
        assert_eq!(node_count(&line(0.5, 1.0), [21.0, 11.0]), 11);
        assert_eq!(node_count(&line(0.55, 0.2), [21.0, 11.0]), 12);
        assert_eq!(node_count(&line(-0.01, 0.0), [21.0, 11.0]), 2);
        assert_eq!(node_count(&line(0.1 + 0.2, 0.0), [10.0, 10.0]), 3); // 3.0000000000000004
    }

    #[test]
    fn level_arches_and_waves_are_counted_piece_by_piece() {
        // Quarter circles where x and y change places at 45 degrees: 2·2·(2 − ... ) = 4·√2·r in all, half of it here.
        let arch = graph("sqrt(1-x^2)", -1.0, 1.0);
        assert_eq!(node_count(&arch, [100.0, 100.0]), (200.0 * 2.0_f64.sqrt()).ceil() as usize);
        // Rises and falls four times by 0.25.
        let wave = graph("0.25*sin(2*pi*x)", 0.0, 2.0);
        assert_eq!(node_count(&wave, [1e-3, 100.0]), 200);
        assert_eq!(node_count(&wave, [50.0, 1e-3]), 100);
    }

    #[test]
    fn the_sum_is_accurate_to_a_tenth_of_the_slack() {
        let circle = Curve::Ellipse { centre: [0.0, 0.0], semi_axes: [1.0, 1.0], rotation: 0.0 };
        // I = 4√2·rate: the rate makes it a whole number, so that an error of 1e-6 would add a node.
        for whole in [9_u32, 100, 12_345] {
            let rate = f64::from(whole) / 32.0_f64.sqrt();
            assert_eq!(node_count(&circle, [rate, rate]), whole as usize);
            let more = rate * (1.0 + 1.2e-6 / f64::from(whole));
            assert_eq!(node_count(&circle, [more, more]), whole as usize + 1);
        }
    }

    #[test]
    fn small_edges_have_the_least_number() {
        let arc = Curve::arc([0.0, 0.0], [1e-3, 0.0], [0.0, 1e-3], Turn::CounterClockwise);
        assert_eq!(node_count(&arc, [1.0, 1.0]), 4);
        assert_eq!(
            node_count(&Curve::Ellipse { centre: [0.0; 2], semi_axes: [1e-3; 2], rotation: 0.0 }, [1.0, 1.0]),
            8
        );
        assert_eq!(node_count(&parametric("t/0", "t", 0.0, 1.0), [1.0, 1.0]), 4);
        assert_eq!(node_count(&Curve::Line { from: [f64::NAN; 2], to: [0.0; 2] }, [1.0, 1.0]), 2);
    }

    #[test]
    fn kinks_and_vertical_tangents_are_counted_exactly() {
        let roof = graph("abs(x-0.1234567)", -1.0, 1.0);
        assert_eq!(node_count(&roof, [1.0, 10.0]), 20); // |y| falls by 1.1234567 and rises by 0.8765433
        assert_eq!(node_count(&graph("abs(x)^(2/3)", -1.0, 1.0), [1e-6, 10.0]), 20);
    }
}
