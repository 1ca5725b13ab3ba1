//! What can be wrong with a curve.

use std::fmt;

use nmt_geom::Point;

/// One of the two ends of a curve, in the direction of travel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CurveEnd {
    /// Where it begins.
    Start,
    /// Where it ends.
    Finish,
}

impl fmt::Display for CurveEnd {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Start => "begins",
            Self::Finish => "ends",
        })
    }
}

/// A curve that cannot be an edge of an outline, or cannot be divided.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CurveError {
    /// A formula that is NaN or infinite somewhere on its interval.
    #[error("`{text}` is {value} at {variable} = {at}; {remedy}")]
    NotFinite {
        /// The formula.
        text: String,
        /// The name of its variable, `x` or `t`.
        variable: &'static str,
        /// Where.
        at: f64,
        /// NaN or an infinity.
        value: f64,
        /// What to do about it.
        remedy: &'static str,
    },
    /// A coordinate, radius, angle or interval that is NaN or infinite.
    #[error("the {what} is {value}; write a finite number")]
    NotANumber {
        /// Which one.
        what: &'static str,
        /// NaN or an infinity.
        value: f64,
    },
    /// A curve that does not begin or end at its vertex.
    #[error(
        "the curve {end} at ({}, {}), {} away from its vertex ({}, {}); move the vertex there, or correct the curve \
         (angles are in radians)",
        .point[0], .point[1], shown(*.gap), .vertex[0], .vertex[1]
    )]
    MissesVertex {
        /// Which end.
        end: CurveEnd,
        /// The end of the curve.
        point: Point,
        /// The vertex it should lead to.
        vertex: Point,
        /// Their distance.
        gap: f64,
    },
    /// A graph `y = f(x)` between two vertices one above the other.
    #[error("both vertices have x = {x}, where y = f(x) has only one value; use a line, an arc, or x(t), y(t)")]
    Vertical {
        /// The abscissa of both vertices.
        x: f64,
    },
    /// A parametric curve over an interval without length.
    #[error("the parameter runs from {t} to {t}; give two different values, as in t = [0, 1]")]
    EmptyInterval {
        /// Both ends of the interval.
        t: f64,
    },
    /// An arc whose centre is nearer to one vertex than to the other.
    #[error(
        "the centre ({}, {}) is {from_start} away from the arc's first vertex and {from_finish} from its last; \
         move it {:.1e} to make both distances equal",
        .centre[0], .centre[1], (from_start - from_finish).abs() / 2.0
    )]
    NotEquidistant {
        /// The centre.
        centre: Point,
        /// Distance to the first vertex.
        from_start: f64,
        /// Distance to the last vertex.
        from_finish: f64,
    },
    /// An arc, a circle or an ellipse without extent.
    #[error("the {what} is {value}; it must be greater than zero")]
    NotPositive {
        /// `radius` or `semi-axis`.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// A step or a pole: a curve that is not continuous.
    #[error(
        "the curve jumps from ({}, {}) to ({}, {}) at {variable} = {at}; split the edge there, with a vertex on each side and a line between",
        .before[0], .before[1], .after[0], .after[1]
    )]
    Jump {
        /// The name of the variable, `x` or `t`.
        variable: &'static str,
        /// Where.
        at: f64,
        /// The last point before it.
        before: Point,
        /// The first point after it.
        after: Point,
    },
    /// Chords that do not settle on a length.
    #[error(
        "the length of the curve does not converge: {length} with {intervals} intervals, uncertain by {error:.1e}; \
         restrict the edge to where the curve is smooth, or split it"
    )]
    LengthDoesNotConverge {
        /// The length found.
        length: f64,
        /// Intervals of the subdivision.
        intervals: usize,
        /// Its estimated error.
        error: f64,
    },
    /// A curve that stays in one point.
    #[error("the edge has no length, all of it is at ({}, {}); remove it, or move one of its vertices", .point[0], .point[1])]
    NoLength {
        /// The point.
        point: Point,
    },
    /// A number of nodes that an edge cannot have.
    #[error("{n} nodes on one edge; give between {least} and {most}")]
    NodeCount {
        /// The number asked for.
        n: usize,
        /// The least number possible.
        least: usize,
        /// The greatest number allowed.
        most: usize,
    },
}

/// A length as a reader wants it: 0.3 rather than 3.0e-1, 2.0e-9 rather than zeros.
fn shown(length: f64) -> String {
    let digits = format!("{length:.2e}").parse().unwrap_or(length);
    if (1e-3..1e6).contains(&length) { format!("{digits}") } else { format!("{length:.1e}") }
}
