//! The directions in which a curve leaves its first and reaches its last point.

use std::f64::consts::TAU;

use nmt_geom::Point;
use nmt_geom::point::{cross, distance, dot, sub};

use super::{Curve, rotated};
use crate::error::CurveEnd;

/// A derivative is believed where it agrees with the secant to this angle, in radians.
///
/// The secants below are off by 1e-8 on an ordinary curve, and by 1e-5 on one far from the origin; at a kink or a
/// vertical tangent that the derivative does not see (`abs(x)`, `sqrt(max(0, x))` at 0) the two differ by a large
/// angle.
const AGREEMENT: f64 = 1e-3;

impl Curve {
    /// Unit vector in which the curve leaves its first point, `[0, 0]` for a curve without length.
    pub fn start_direction(&self) -> Point {
        self.direction(CurveEnd::Start)
    }

    /// Unit vector in which the curve reaches its last point, `[0, 0]` for a curve without length.
    pub fn end_direction(&self) -> Point {
        self.direction(CurveEnd::Finish)
    }

    /// Unit vector in which the curve passes its point at fraction `u` of the parameter; `[0, 0]` where it has no
    /// direction (a cusp, a curve without length). At the ends it is that of [`Self::start_direction`] and
    /// [`Self::end_direction`].
    pub fn direction_at(&self, u: f64) -> Point {
        if u <= 0.0 {
            return self.start_direction();
        }
        if u >= 1.0 {
            return self.end_direction();
        }
        unit(self.velocity(u))
    }

    fn direction(&self, end: CurveEnd) -> Point {
        let u = match end {
            CurveEnd::Start => 0.0,
            CurveEnd::Finish => 1.0,
        };
        let tangent = unit(self.velocity(u));
        if matches!(self, Self::Line { .. } | Self::Arc { .. } | Self::Ellipse { .. }) {
            return tangent;
        }
        let secant = self.secant(end);
        let agrees = cross(tangent, secant).abs() <= AGREEMENT && dot(tangent, secant) > 0.0;
        if agrees { tangent } else { secant }
    }

    /// The derivative by `u`, up to a positive factor; infinite at a vertical tangent.
    fn velocity(&self, u: f64) -> Point {
        match self {
            Self::Line { from, to } => sub(*to, *from),
            Self::Graph { y, from_x, to_x } => {
                let forward = (to_x - from_x).signum();
                let x = self.variable(u).value;
                [forward, forward * y.jet(x).d1]
            }
            Self::Arc { start, sweep, .. } => {
                let (sine, cosine) = (start + u * sweep).sin_cos();
                [-sweep.signum() * sine, sweep.signum() * cosine]
            }
            Self::Ellipse { semi_axes, rotation, .. } => {
                // Once around is exactly where it began.
                let (sine, cosine) = if u == 1.0 { (0.0, 1.0) } else { (TAU * u).sin_cos() };
                rotated([-semi_axes[0] * sine, semi_axes[1] * cosine], *rotation)
            }
            Self::Parametric { x, y, from_t, to_t } => {
                let forward = (to_t - from_t).signum();
                let t = self.variable(u).value;
                [forward * x.jet(t).d1, forward * y.jet(t).d1]
            }
        }
    }

    /// Direction of the chord from an end to a point near it.
    ///
    /// A chord of relative length c is off by c·curvature/2 and by the rounding of the coordinates over c: c is the
    /// root of their ratio. It is the distance that must be short: near a vertical tangent the step of the parameter is
    /// its square.
    fn secant(&self, end: CurveEnd) -> Point {
        const SAMPLES: u32 = 16;
        const SMALLEST_STEP: i32 = -52; // the resolution of the parameter near 1
        let at = |step: f64| match end {
            CurveEnd::Start => self.point(step),
            CurveEnd::Finish => self.point(1.0 - step),
        };
        let origin = at(0.0);
        let samples = (1..=SAMPLES).map(|i| at(f64::from(i) / f64::from(SAMPLES)));
        let (mut extent, mut magnitude) = (0.0_f64, origin[0].abs().max(origin[1].abs()));
        for p in samples {
            extent = extent.max(distance(p, origin));
            magnitude = magnitude.max(p[0].abs()).max(p[1].abs());
        }
        let shortest = (f64::EPSILON * magnitude * extent).sqrt();
        let chords = (SMALLEST_STEP..=0).map(|power| sub(at(2.0_f64.powi(power)), origin));
        let mut long_enough = chords.filter(|chord| chord[0].hypot(chord[1]) >= shortest);
        let chord = unit(long_enough.next().unwrap_or([0.0, 0.0]));
        match end {
            CurveEnd::Start => chord,
            CurveEnd::Finish => [-chord[0], -chord[1]],
        }
    }
}

/// `v` at length 1; an infinite component leaves no weight to a finite one. `[0, 0]` where there is no direction.
fn unit(v: Point) -> Point {
    let v = match v.map(f64::is_infinite) {
        [false, false] => v,
        infinite => [0, 1].map(|d| if infinite[d] { v[d].signum() } else { 0.0 }),
    };
    let length = v[0].hypot(v[1]);
    if length > 0.0 && length.is_finite() { v.map(|component| component / length) } else { [0.0, 0.0] }
}

#[cfg(test)]
mod tests {
    use super::super::Turn;
    use super::super::samples::{graph, parametric};
    use super::*;

    #[track_caller]
    fn near(found: Point, expected: Point, radians: f64) {
        assert!(distance(found, expected) < radians, "{found:?}, expected {expected:?}");
    }

    #[test]
    fn directions_between_the_ends_are_those_of_short_chords() {
        let curves = [
            graph("x^2", 0.0, 0.5),
            graph("x^2", 0.5, 0.0),
            parametric("cos(t)", "2*sin(t)", 1.0, -2.0),
            Curve::arc([0.0, 0.0], [1.0, 0.0], [0.0, 1.0], Turn::Clockwise),
            Curve::Ellipse { centre: [1.0, 1.0], semi_axes: [2.0, 1.0], rotation: 0.3 },
            Curve::Line { from: [0.0, 0.0], to: [3.0, 4.0] },
        ];
        for curve in curves {
            for u in [0.2, 0.5, 0.77] {
                let chord = unit(sub(curve.point(u + 1e-5), curve.point(u - 1e-5)));
                near(curve.direction_at(u), chord, 1e-8); // the chord's own error
            }
        }
    }

    #[test]
    fn smooth_curves_have_the_direction_of_their_derivative() {
        let r = 0.5_f64.sqrt();
        near(graph("x^2", 0.0, 0.5).end_direction(), [r, r], 1e-15); // rounding
        near(graph("x^2", 0.5, 0.0).start_direction(), [-r, -r], 1e-15);
        near(graph("sin(pi*x)", 0.0, 2.0).start_direction(), unit([1.0, std::f64::consts::PI]), 1e-15);
        near(parametric("cos(t)", "sin(t)", 0.0, 1.0).start_direction(), [0.0, 1.0], 1e-15);
        near(parametric("cos(t)", "sin(t)", 1.0, 0.0).end_direction(), [0.0, -1.0], 1e-15);
        near(Curve::arc([0.0, 0.0], [1.0, 0.0], [0.0, 1.0], Turn::Clockwise).start_direction(), [0.0, -1.0], 1e-15);
        near(Curve::Line { from: [0.0, 0.0], to: [3.0, 4.0] }.end_direction(), [0.6, 0.8], 1e-15);
        near(
            Curve::Ellipse { centre: [1.0, 1.0], semi_axes: [2.0, 1.0], rotation: 0.0 }.end_direction(),
            [0.0, 1.0],
            1e-15,
        );
    }

    #[test]
    fn vertical_tangents_are_vertical() {
        for text in ["sqrt(1-x^2)", "sqrt(max(0, 1-x^2))", "sqrt(abs(1-x^2))"] {
            let half = graph(text, -1.0, 1.0);
            near(half.start_direction(), [0.0, 1.0], 1e-7); // exact, or a secant of relative length 1.5e-8
            near(half.end_direction(), [0.0, -1.0], 1e-7);
        }
        near(graph("sqrt(1-x^2)", 1.0, -1.0).end_direction(), [0.0, -1.0], 1e-7);
        // Near the cusp y = x^(2/3) leans from the vertical by x/y = √y, 1.2e-4 at the secant's length.
        near(graph("abs(x)^(2/3)", 0.0, 1.0).start_direction(), [0.0, 1.0], 2e-4);
    }

    #[test]
    fn kinks_at_an_end_are_seen_from_inside() {
        let r = 0.5_f64.sqrt();
        near(graph("abs(x)", 0.0, 1.0).start_direction(), [r, r], 1e-7); // rounding of a secant of relative length 1.5e-8
        near(graph("abs(x)", -1.0, 0.0).end_direction(), [r, -r], 1e-7);
        near(parametric("t^2", "t^3", 0.0, 1.0).start_direction(), [1.0, 0.0], 4e-4); // y/x = √x at a secant of up to 3e-8, twice
    }

    #[test]
    fn directions_do_not_depend_on_the_unit() {
        for unit in ["1e-6", "1e3", "1e150"] {
            let half = graph(&format!("{unit}*sqrt(1-(x/{unit})^2)"), 0.0, unit.parse().unwrap());
            near(half.end_direction(), [0.0, -1.0], 1e-7);
        }
    }

    #[test]
    fn a_point_has_no_direction() {
        assert_eq!(Curve::Line { from: [1.0, 1.0], to: [1.0, 1.0] }.start_direction(), [0.0, 0.0]);
        assert_eq!(parametric("1", "2", 0.0, 1.0).start_direction(), [0.0, 0.0]);
        assert_eq!(parametric("t/0", "0/0", 0.0, 1.0).start_direction(), [0.0, 0.0]);
    }
}
