//! Curves as polylines.

use nmt_geom::Point;
use nmt_geom::point::{cross, distance, dot, lerp, sub};

use super::Curve;
use crate::subdivision::first_end;

/// Most points of a polyline; a tolerance that needs more is widened until it does not.
const MAX_POINTS: usize = 1 << 17;

/// By how much it is widened at a time.
const WIDENED: f64 = 4.0;

/// Least tolerance, relative to the extent of the curve: [`MAX_POINTS`] on a circle leave a sagitta of 1.5e-10 of it.
const LEAST_REL_TOL: f64 = 1e-10;

/// Pieces that a curve is looked at in, of irregular widths: a wave cannot have its nodes at the ends of all of them.
const FIRST_PIECES: usize = 8;

/// Parts of a piece, at whose ends its distance from the chord is looked at.
const PARTS: usize = 8;

/// A piece is not halved below this width of the parameter: it is a jump.
const NARROWEST: f64 = 1e-12;

impl Curve {
    /// Points along the curve, the first and the last included, whose chords stay within `tolerance` (a length) of it.
    ///
    /// A line has two. A tolerance that would need more than 131 072 points is widened; points that are not finite are
    /// left out.
    pub fn flatten(&self, tolerance: f64) -> Vec<Point> {
        if let Self::Line { from, to } = self {
            return vec![*from, *to];
        }
        let origin = self.point(0.0);
        let along = (1..=16).map(|k| distance(self.point(f64::from(k) / 16.0), origin));
        let extent = along.filter(|d| d.is_finite()).fold(f64::MIN_POSITIVE, f64::max);
        // A tolerance that is no number is taken as the least: `max` passes over NaN.
        let mut tolerance = tolerance.max(LEAST_REL_TOL * extent);
        while tolerance.is_finite() {
            if let Some(points) = self.polyline(tolerance) {
                return points;
            }
            tolerance *= WIDENED;
        }
        [0.0, 1.0].map(|u| self.point(u)).into_iter().filter(finite).collect()
    }

    /// The polyline, or `None` where it has too many points.
    fn polyline(&self, tolerance: f64) -> Option<Vec<Point>> {
        let circular = match self {
            Self::Arc { radius, sweep, .. } => Some((*radius, *sweep)),
            Self::Ellipse { semi_axes: [a, b], .. } if a == b => Some((*a, std::f64::consts::TAU)),
            _ => None,
        };
        if let Some((radius, sweep)) = circular {
            // Sagitta of a chord over the angle 2a: r(1 − cos a) = 2r·sin²(a/2).
            let half = 2.0 * (tolerance / (2.0 * radius.abs())).sqrt().min(0.5).asin();
            let pieces = (sweep.abs() / (2.0 * half)).ceil().max(1.0);
            if pieces >= MAX_POINTS as f64 {
                return None;
            }
            let points = (0..=pieces as usize).map(|k| self.point(k as f64 / pieces));
            return Some(points.filter(finite).collect());
        }
        let mut points = vec![self.point(0.0)];
        // Pieces still to do, the next one last.
        let piece = |k: usize| [k, k + 1].map(|end| first_end(end, FIRST_PIECES));
        let mut rest: Vec<[f64; 2]> = (0..FIRST_PIECES).rev().map(piece).collect();
        while let Some([a, b]) = rest.pop() {
            let probes: [Point; PARTS + 1] =
                std::array::from_fn(|k| self.point(a + (b - a) * (k as f64 / PARTS as f64)));
            if b - a > NARROWEST && sagitta(&probes) > tolerance {
                let middle = 0.5 * (a + b);
                rest.extend([[middle, b], [a, middle]]);
            } else {
                points.push(self.point(b));
            }
            if points.len() + rest.len() > MAX_POINTS {
                return None;
            }
        }
        points.retain(finite);
        Some(points)
    }
}

/// How far a curve through the probes is from the chord between the first and the last.
///
/// Between two probes it may be a little farther off: at a kink or cusp by up to half the second difference of the
/// probes there. NaN is no distance, since there is nothing to come nearer to.
fn sagitta(probes: &[Point; PARTS + 1]) -> f64 {
    let [first, last] = [probes[0], probes[PARTS]];
    let off = probes.iter().map(|p| distance_to_chord(*p, first, last)).fold(0.0, f64::max);
    let bend = |three: &[Point]| distance(lerp(three[0], three[2], 0.5), three[1]);
    off + probes.windows(3).map(bend).fold(0.0, f64::max)
}

fn finite(p: &Point) -> bool {
    p[0].is_finite() && p[1].is_finite()
}

/// Distance of `r` from the segment between `p` and `q`.
fn distance_to_chord(r: Point, p: Point, q: Point) -> f64 {
    let (chord, offset) = (sub(q, p), sub(r, p));
    let along = dot(offset, chord);
    if along <= 0.0 {
        distance(r, p)
    } else if along >= dot(chord, chord) {
        distance(r, q)
    } else {
        cross(chord, offset).abs() / chord[0].hypot(chord[1])
    }
}

#[cfg(test)]
mod tests {
    use super::super::Turn;
    use super::super::samples::{graph, parametric};
    use super::*;

    #[test]
    fn chords_stay_within_the_tolerance() {
        let curves = [
            graph("0.25*sin(2*pi*x)", 0.0, 2.0),
            graph("sqrt(1-x^2)", -1.0, 1.0),
            graph("abs(x)^(2/3)", -1.0, 2.0),
            graph("abs(x-0.123)", -1.0, 1.0),
            graph("1/(1+25*x^2)", -1.0, 1.0),
            parametric("t*cos(t)", "t*sin(t)", 0.0, 12.0),
            Curve::arc([0.0, 0.0], [1.0, 0.0], [0.0, -1.0], Turn::CounterClockwise),
            Curve::Ellipse { centre: [0.0, 0.0], semi_axes: [3.0, 0.1], rotation: 0.3 },
        ];
        for curve in curves {
            for tolerance in [1e-2, 1e-4, 1e-6] {
                let line = curve.flatten(tolerance);
                assert_eq!((line[0], line[line.len() - 1]), (curve.point(0.0), curve.point(1.0)));
                let nearest =
                    |p: Point| line.windows(2).map(|c| distance_to_chord(p, c[0], c[1])).fold(f64::INFINITY, f64::min);
                let worst = (0..=300).map(|k| nearest(curve.point(f64::from(k) / 300.0))).fold(0.0, f64::max);
                assert!(worst <= tolerance, "{curve:?}: {worst:e} with {} points", line.len());
                assert!(line.len() < 20_000, "{curve:?}: {} points for {tolerance}", line.len());
            }
        }
    }

    #[test]
    fn no_more_points_than_needed() {
        assert_eq!(Curve::Line { from: [0.0, 0.0], to: [1.0, 1.0] }.flatten(1e-9).len(), 2);
        // Sagitta (2π/n)²/8 of a circle of radius 1: n = 2π/√(8·1e-4) = 222.
        let circle = Curve::Ellipse { centre: [0.0, 0.0], semi_axes: [1.0, 1.0], rotation: 0.0 };
        assert!(circle.flatten(1e-4).len() < 500); // halving overshoots by up to 2
    }

    #[test]
    fn impossible_tolerances_end_in_a_polyline() {
        for tolerance in [0.0, -1.0, f64::NAN, 1e-300] {
            for curve in
                [graph("sin(100*x)", 0.0, 10.0), Curve::Arc { centre: [0.0; 2], radius: 1.0, start: 0.0, sweep: 6.0 }]
            {
                let points = curve.flatten(tolerance);
                assert!(points.len() > 1000 && points.len() <= MAX_POINTS);
            }
        }
        assert_eq!(graph("0/0", 0.0, 1.0).flatten(1e-3), Vec::<Point>::new());
        assert!(graph("1/(x-0.3)", 0.0, 1.0).flatten(1e-3).len() > 10);
        assert!(Curve::Arc { centre: [0.0; 2], radius: 0.0, start: 0.0, sweep: 6.0 }.flatten(1e-3).len() >= 2);
    }
}
