//! The envelope of a curve.

use std::f64::consts::{PI, TAU};

use nmt_geom::{Bbox, Point};

use super::Curve;
use super::extrema::turning_values;

/// Accuracy of the subdivision whose points the extrema are sought between.
const SAMPLING_REL_TOL: f64 = 1e-6;

impl Curve {
    /// The smallest axis-parallel rectangle around the curve.
    ///
    /// Exact for lines, arcs and ellipses; for formulas each extremum is sought between the points of the local
    /// subdivision that measures the length, and is accurate to 1e-12 of the size. Points that are not finite are left
    /// out.
    pub fn envelope(&self) -> Bbox {
        match self {
            Self::Line { from, to } => Bbox::of([*from, *to]),
            Self::Arc { centre, radius, start, sweep } => {
                let mut envelope = Bbox::of([self.point(0.0), self.point(1.0)]);
                let (low, high) = (start.min(start + sweep), start.max(start + sweep));
                let sides = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]];
                for (k, side) in sides.into_iter().enumerate() {
                    // The first angle from `low` on that looks to this side.
                    let angle = low + (k as f64 * 0.5 * PI - low).rem_euclid(TAU);
                    if angle <= high {
                        envelope.include([0, 1].map(|d| centre[d] + radius * side[d]));
                    }
                }
                envelope
            }
            Self::Ellipse { centre, semi_axes, rotation } => {
                let (sine, cosine) = rotation.sin_cos();
                let half = [
                    (semi_axes[0] * cosine).hypot(semi_axes[1] * sine),
                    (semi_axes[0] * sine).hypot(semi_axes[1] * cosine),
                ];
                Bbox::of([[0, 1].map(|d| centre[d] - half[d]), [0, 1].map(|d| centre[d] + half[d])])
            }
            Self::Graph { .. } | Self::Parametric { .. } => self.sampled_envelope(),
        }
    }

    fn sampled_envelope(&self) -> Bbox {
        let samples = self.samples(SAMPLING_REL_TOL);
        let mut envelope = Bbox::of(samples.iter().map(|sample| sample.point));
        for d in 0..2 {
            let coordinate = |p: Point| p[d];
            let turns = turning_values(self, &samples, coordinate);
            envelope.min[d] = turns.iter().copied().fold(envelope.min[d], f64::min);
            envelope.max[d] = turns.iter().copied().fold(envelope.max[d], f64::max);
        }
        envelope
    }
}

#[cfg(test)]
mod tests {
    use super::super::Turn;
    use super::super::samples::{graph, parametric};
    use super::*;

    #[track_caller]
    fn near(curve: &Curve, min: Point, max: Point) {
        let envelope = curve.envelope();
        let size = (max[0] - min[0]).hypot(max[1] - min[1]);
        for d in 0..2 {
            let off = (envelope.min[d] - min[d]).abs().max((envelope.max[d] - max[d]).abs());
            assert!(off <= 1e-12 * size, "{curve:?}: {envelope:?}, off by {off:e}"); // the promise
        }
    }

    #[test]
    fn extrema_of_formulas_are_found() {
        near(&graph("sin(x)", 0.0, 7.0), [0.0, -1.0], [7.0, 1.0]);
        near(&graph("x^2 - 0.3*x", 1.0, -1.0), [-1.0, -0.0225], [1.0, 1.3]);
        near(&graph("sqrt(1-x^2)", -1.0, 1.0), [-1.0, 0.0], [1.0, 1.0]);
        near(&graph("-abs(x-0.1234567)", -1.0, 1.0), [-1.0, -1.1234567], [1.0, 0.0]);
        near(&graph("sin(200*pi*x)", 0.0, 1.0), [0.0, -1.0], [1.0, 1.0]);
        near(&graph("2", 0.0, 1.0), [0.0, 2.0], [1.0, 2.0]);
        near(&parametric("3*cos(t)", "2*sin(t)", 0.1, 7.0), [-3.0, -2.0], [3.0, 2.0]);
    }

    #[test]
    fn a_cusp_reaches_as_far_as_floats_do() {
        let envelope = graph("-abs(x-0.1)^(2/3)", -1.0, 1.0).envelope();
        assert!(envelope.max[1] <= 0.0 && envelope.max[1] > -1e-10); // (1e-16)^(2/3) = 2e-11: x cannot be nearer
    }

    #[test]
    fn arcs_and_ellipses_are_exact() {
        let upper = Curve::arc([1.0, 1.0], [2.0, 1.0], [0.0, 1.0], Turn::CounterClockwise);
        near(&upper, [0.0, 1.0], [2.0, 2.0]);
        let lower = Curve::arc([1.0, 1.0], [2.0, 1.0], [0.0, 1.0], Turn::Clockwise);
        near(&lower, [0.0, 0.0], [2.0, 1.0]);
        let most = Curve::arc([0.0, 0.0], [0.6, 0.8], [0.8, 0.6], Turn::CounterClockwise);
        near(&most, [-1.0, -1.0], [1.0, 1.0]);
        let least = Curve::arc([0.0, 0.0], [0.6, 0.8], [0.8, 0.6], Turn::Clockwise);
        near(&least, [0.6, 0.6], [0.8, 0.8]);
        let turned = Curve::Ellipse { centre: [0.0, 0.0], semi_axes: [2.0, 1.0], rotation: PI / 4.0 };
        let half = 2.5_f64.sqrt();
        near(&turned, [-half, -half], [half, half]);
    }

    #[test]
    fn what_is_not_finite_is_left_out() {
        let envelope = graph("sqrt(x)", -1.0, 1.0).envelope();
        assert!(envelope.max == [1.0, 1.0] && envelope.min[0] >= 0.0);
        assert_eq!(graph("0/0", 0.0, 1.0).envelope(), Bbox::EMPTY);
    }
}
