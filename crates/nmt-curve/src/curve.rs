//! The curves an outline is made of.

mod direction;
mod envelope;
mod extrema;
mod faults;
mod flatten;

use std::f64::consts::TAU;

use nmt_geom::Point;
use nmt_geom::point::{distance, lerp, sub};

use crate::Expression;

pub(crate) use extrema::turning_values;

/// Which way an arc turns about its centre.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Turn {
    /// To the left.
    CounterClockwise,
    /// To the right.
    Clockwise,
}

/// A piece of an outline, travelled from its first to its last point; lengths in the user's unit, angles in radians.
#[derive(Clone, Debug, PartialEq)]
pub enum Curve {
    /// The straight line between two points.
    Line {
        /// First point.
        from: Point,
        /// Last point.
        to: Point,
    },
    /// The graph `y = f(x)`, in either direction.
    Graph {
        /// The formula, of one variable.
        y: Expression,
        /// Abscissa of the first point.
        from_x: f64,
        /// Abscissa of the last point.
        to_x: f64,
    },
    /// A piece of a circle; see [`Curve::arc`] for one between two points.
    Arc {
        /// Centre of the circle.
        centre: Point,
        /// Its radius.
        radius: f64,
        /// Polar angle of the first point.
        start: f64,
        /// Angle from the first to the last point: positive counter-clockwise, negative clockwise.
        sweep: f64,
    },
    /// A whole ellipse, counter-clockwise from angle 0 and back; a circle has equal semi-axes.
    Ellipse {
        /// Centre.
        centre: Point,
        /// Half the extent along its own first and second axis.
        semi_axes: [f64; 2],
        /// Angle from the x-axis to the first axis, counter-clockwise.
        rotation: f64,
    },
    /// The points `(x(t), y(t))`.
    Parametric {
        /// Formula of the abscissa, of one variable.
        x: Expression,
        /// Formula of the ordinate, of one variable.
        y: Expression,
        /// Parameter of the first point.
        from_t: f64,
        /// Parameter of the last point.
        to_t: f64,
    },
}

impl Curve {
    /// The arc about `centre` from one point to another, the radius being the mean of their distances from the centre.
    ///
    /// It is a whole circle where the two points are one. [`Curve::faults`] tells when the distances differ.
    pub fn arc(centre: Point, from: Point, to: Point, turn: Turn) -> Self {
        let (first, last) = (sub(from, centre), sub(to, centre));
        let start = first[1].atan2(first[0]);
        let turned = last[1].atan2(last[0]) - start;
        let sweep = match turn {
            Turn::CounterClockwise if turned <= 0.0 => turned + TAU,
            Turn::Clockwise if turned >= 0.0 => turned - TAU,
            _ => turned,
        };
        Self::Arc { centre, radius: 0.5 * (distance(centre, from) + distance(centre, to)), start, sweep }
    }

    /// The point at fraction `u` of the parameter, 0 at the first and 1 at the last point.
    ///
    /// The fraction is of the abscissa, the angle or `t`, not of the length; see [`ArcTable`](crate::ArcTable) for
    /// that.
    pub fn point(&self, u: f64) -> Point {
        match self {
            Self::Line { from, to } => lerp(*from, *to, u),
            Self::Graph { y, from_x, to_x } => {
                let x = mix(*from_x, *to_x, u);
                [x, y.at(x)]
            }
            Self::Arc { centre, radius, start, sweep } => {
                let (sine, cosine) = (start + u * sweep).sin_cos();
                [centre[0] + radius * cosine, centre[1] + radius * sine]
            }
            Self::Ellipse { centre, semi_axes, rotation } => {
                // Once around is exactly where it began.
                let (sine, cosine) = if u == 1.0 { (0.0, 1.0) } else { (TAU * u).sin_cos() };
                let [x, y] = rotated([semi_axes[0] * cosine, semi_axes[1] * sine], *rotation);
                [centre[0] + x, centre[1] + y]
            }
            Self::Parametric { x, y, from_t, to_t } => {
                let t = mix(*from_t, *to_t, u);
                [x.at(t), y.at(t)]
            }
        }
    }

    /// True for a line.
    pub fn is_straight(&self) -> bool {
        matches!(self, Self::Line { .. })
    }

    /// True for a circle or an ellipse, which lead from their only vertex back to it.
    pub fn is_closed(&self) -> bool {
        matches!(self, Self::Ellipse { .. })
    }

    /// The variable of a formula at fraction `u`, or the fraction itself, with the name to call it by.
    pub(crate) fn variable(&self, u: f64) -> Variable {
        match self {
            Self::Graph { from_x, to_x, .. } => Variable { name: "x", value: mix(*from_x, *to_x, u) },
            Self::Parametric { from_t, to_t, .. } => Variable { name: "t", value: mix(*from_t, *to_t, u) },
            _ => Variable { name: "fraction", value: u },
        }
    }

    /// The length, where a closed form has it and the parameter is proportional to it.
    pub(crate) fn exact_length(&self) -> Option<f64> {
        match self {
            Self::Line { from, to } => Some(distance(*from, *to)),
            Self::Arc { radius, sweep, .. } => Some((radius * sweep).abs()),
            Self::Ellipse { semi_axes, .. } if semi_axes[0] == semi_axes[1] => Some(TAU * semi_axes[0].abs()),
            _ => None,
        }
    }
}

/// A variable's name and value, for a message.
pub(crate) struct Variable {
    pub(crate) name: &'static str,
    pub(crate) value: f64,
}

/// The number at fraction `u` of the way from `a` to `b`; exactly `a` at 0 and `b` at 1.
fn mix(a: f64, b: f64, u: f64) -> f64 {
    a * (1.0 - u) + b * u
}

fn rotated(v: Point, angle: f64) -> Point {
    let (sine, cosine) = angle.sin_cos();
    [cosine * v[0] - sine * v[1], sine * v[0] + cosine * v[1]]
}

#[cfg(test)]
pub(crate) mod samples {
    //! Curves that several tests use.
    use super::*;

    pub(crate) fn graph(text: &str, from_x: f64, to_x: f64) -> Curve {
        Curve::Graph { y: Expression::parse(text, &["x"]).unwrap(), from_x, to_x }
    }

    pub(crate) fn parametric(x: &str, y: &str, from_t: f64, to_t: f64) -> Curve {
        let [x, y] = [x, y].map(|text| Expression::parse(text, &["t"]).unwrap());
        Curve::Parametric { x, y, from_t, to_t }
    }
}

#[cfg(test)]
mod tests {
    use super::samples::{graph, parametric};
    use super::*;

    #[test]
    fn ends_are_where_they_were_given() {
        let half = graph("sqrt(1-x^2)", -1.0, 1.0);
        assert_eq!((half.point(0.0), half.point(1.0)), ([-1.0, 0.0], [1.0, 0.0]));
        let back = graph("x^2", 0.3, -0.1);
        assert_eq!((back.point(0.0), back.point(1.0)), ([0.3, 0.3 * 0.3], [-0.1, 0.1 * 0.1]));
        let swing = parametric("cos(t)", "sin(t)", 0.1, 2.3);
        assert_eq!(swing.point(1.0), [2.3_f64.cos(), 2.3_f64.sin()]);
        let oval = Curve::Ellipse { centre: [1.0, 2.0], semi_axes: [3.0, 1.0], rotation: 0.3 };
        assert_eq!(oval.point(0.0), oval.point(1.0));
    }

    #[test]
    fn an_arc_turns_the_way_it_is_told() {
        let quarter = Curve::arc([0.0, 0.0], [1.0, 0.0], [0.0, 1.0], Turn::CounterClockwise);
        let rest = Curve::arc([0.0, 0.0], [1.0, 0.0], [0.0, 1.0], Turn::Clockwise);
        let r = 0.5_f64.sqrt();
        assert!(distance(quarter.point(0.5), [r, r]) < 1e-15); // rounding
        assert!(distance(rest.point(0.5), [-r, -r]) < 1e-15);
        assert!(distance(rest.point(1.0), [0.0, 1.0]) < 1e-15);
        let Curve::Arc { sweep, .. } = Curve::arc([0.0, 0.0], [0.0, -2.0], [0.0, -2.0], Turn::Clockwise) else {
            panic!("an arc");
        };
        assert_eq!(sweep, -TAU);
    }
}
