//! Where a function of the points of a curve turns from rising to falling.

use nmt_geom::Point;

use super::Curve;
use crate::subdivision::Subdivision;

/// Intervals of the subdivision that gives the samples, at most.
const MAX_INTERVALS: usize = 4096;

/// Steps of a golden-section search: 0.618⁸⁰ = 2e-17 of the interval, the last bit.
const GOLDEN_STEPS: usize = 80;

/// A turn that can reach no farther than this beyond its sample, relative to the function's values, is rounding.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// A point of a curve with its parameter.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CurveSample {
    pub(crate) u: f64,
    pub(crate) point: Point,
}

impl Curve {
    /// Points along the curve, close where it is not straight: those of the subdivision that measures its length to
    /// `rel_tol`.
    ///
    /// Points that are not finite are left out.
    pub(crate) fn samples(&self, rel_tol: f64) -> Vec<CurveSample> {
        let mut division = Subdivision::new(self, MAX_INTERVALS);
        // Where it does not converge, its points are as good as any.
        let _ = division.refine(rel_tol, MAX_INTERVALS);
        let points = division.into_leaves().into_iter().flat_map(|leaf| leaf.points(self));
        let mut samples: Vec<CurveSample> = points.map(|(u, point)| CurveSample { u, point }).collect();
        samples.retain(|sample| sample.point[0].is_finite() && sample.point[1].is_finite());
        samples.dedup_by(|later, earlier| later.u == earlier.u);
        samples
    }
}

/// The values of `f` at the first sample, at each of its extrema along the curve in order, and at the last sample.
///
/// An extremum is sought between the neighbours of the sample that shows it, to the last bit. Two extrema between the
/// same two samples go unseen.
pub(crate) fn turning_values(curve: &Curve, samples: &[CurveSample], f: impl Fn(Point) -> f64) -> Vec<f64> {
    let value = |sample: &CurveSample| f(sample.point);
    let [Some(first), Some(last)] = [samples.first(), samples.last()] else { return Vec::new() };
    let magnitude = samples.iter().map(|sample| value(sample).abs()).fold(0.0, f64::max);
    let mut turns = vec![value(first)];
    for (k, sample) in samples.iter().enumerate() {
        // At an end of the curve, the extremum may lie between it and its only neighbour.
        let (left, right) = (&samples[k.saturating_sub(1)], samples.get(k + 1).unwrap_or(last));
        let [before, here, after] = [left, sample, right].map(value);
        let sign = if here >= before && here >= after {
            1.0
        } else if here <= before && here <= after {
            -1.0
        } else {
            continue;
        };
        let bend = (2.0 * here - before - after).abs();
        let turn = if bend <= ROUNDING * magnitude {
            here
        } else {
            let height = |u: f64| sign * f(curve.point(u));
            sign * highest(height, left.u, right.u).max(sign * here)
        };
        turns.push(turn);
    }
    turns.push(value(last));
    turns
}

/// The greatest value met by a golden-section search in an interval; minus infinity where there is none.
fn highest(height: impl Fn(f64) -> f64, mut a: f64, mut b: f64) -> f64 {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let (mut c, mut d) = (b - GOLDEN * (b - a), a + GOLDEN * (b - a));
    let (mut at_c, mut at_d) = (height(c), height(d));
    let mut best = f64::NEG_INFINITY.max(at_c).max(at_d);
    for _ in 0..GOLDEN_STEPS {
        if at_c >= at_d {
            (b, d, at_d) = (d, c, at_c);
            c = b - GOLDEN * (b - a);
            at_c = height(c);
        } else {
            (a, c, at_c) = (c, d, at_d);
            d = a + GOLDEN * (b - a);
            at_d = height(d);
        }
        if !(a < c && c < d && d < b) {
            break;
        }
        best = best.max(at_c).max(at_d);
    }
    best
}

#[cfg(test)]
mod tests {
    use super::super::samples::graph;
    use super::*;

    #[test]
    fn a_wave_turns_at_its_crests_and_troughs() {
        let wave = graph("sin(x) + 1", 0.0, 11.0);
        let mut turns = turning_values(&wave, &wave.samples(1e-6), |p| p[1]);
        let expected = [1.0, 2.0, 0.0, 2.0, 0.0, 1.0 + 11.0_f64.sin()];
        turns.dedup_by(|a, b| (*a - *b).abs() < 1e-15); // the ends come twice
        assert_eq!(turns.len(), expected.len(), "{turns:?}");
        assert!(turns.iter().zip(expected).all(|(turn, e)| (turn - e).abs() < 1e-15), "{turns:?}"); // rounding
    }

    #[test]
    fn a_step_that_stays_level_does_not_turn() {
        let flat = graph("2", 0.0, 1.0);
        assert!(turning_values(&flat, &flat.samples(1e-6), |p| p[1]).iter().all(|turn| *turn == 2.0));
    }
}
