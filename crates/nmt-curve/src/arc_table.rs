//! A curve parametrised by its own length.

use nmt_geom::Point;

use crate::bisection::{Sample, monotone_root};
use crate::chords::{ChordSums, End};
use crate::jump::find_jump;
use crate::subdivision::{Leaf, Subdivision};
use crate::{ArcLengthParams, Curve, CurveError};

/// Relative accuracy aimed at: far below the 1e-6 of a segment that a division needs, still above rounding.
const TABLE_REL_TOL: f64 = 1e-11;

/// Intervals for it; a curve of many waves gets less accuracy instead of more memory.
const TABLE_MAX_INTERVALS: usize = 1 << 15;

/// Residual of a position, as a fraction of the whole length: a tenth of a millionth of a segment with a million nodes.
const POSITION_REL_TOL: f64 = 1e-13;

/// Rounding of a sum of a few chords between coordinates of magnitude 1: no position is more certain.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// The points of a curve by arc length, accurate to about 1e-11 of the length; made once, asked many times.
///
/// ```
/// # use nmt_curve::{ArcTable, Curve};
/// let oval = Curve::Ellipse { centre: [0.0, 0.0], semi_axes: [2.0, 1.0], rotation: 0.0 };
/// let table = ArcTable::new(&oval)?;
/// let quarter = table.point_at(table.length() / 4.0);
/// assert!(quarter[0].abs() < 1e-10 && (quarter[1] - 1.0).abs() < 1e-10);
/// # Ok::<(), nmt_curve::CurveError>(())
/// ```
#[derive(Clone, Debug)]
pub struct ArcTable {
    curve: Curve,
    length: f64,
    /// Empty where the parameter is proportional to the length.
    leaves: Vec<Stretch>,
    /// Residual of a position that counts as none, a length.
    tolerance: f64,
}

/// An interval of the parameter with the arc length before it.
#[derive(Clone, Copy, Debug)]
struct Stretch {
    leaf: Leaf,
    before: f64,
}

impl ArcTable {
    /// Measures the curve.
    ///
    /// # Errors
    /// [`CurveError::LengthDoesNotConverge`] where 1e-6 of the length is not reached with 1000 intervals,
    /// [`CurveError::Jump`] for a curve that is not continuous, [`CurveError::NoLength`] for a point.
    pub fn new(curve: &Curve) -> Result<Self, CurveError> {
        if let Some(length) = curve.exact_length() {
            let table = Self { curve: curve.clone(), length, leaves: Vec::new(), tolerance: 0.0 };
            return if length.is_finite() { table.with_length() } else { Err(diverges(length, 1, f64::INFINITY)) };
        }
        let ArcLengthParams { rel_tol, max_intervals } = ArcLengthParams::default();
        let mut division = Subdivision::new(curve, max_intervals);
        let converged = division.refine(rel_tol, max_intervals);
        let jump = find_jump(curve, division.leaves(), division.length);
        if jump.is_none() && !converged {
            return Err(diverges(division.length, division.intervals(), division.error));
        }
        if jump.is_none() {
            // As far as rounding and the number of intervals allow: 1e-6, which is enough, is reached already.
            let _ = division.refine(TABLE_REL_TOL, TABLE_MAX_INTERVALS);
        }
        if let Some(jump) = jump.or_else(|| find_jump(curve, division.leaves(), division.length)) {
            let variable = curve.variable(jump.u);
            return Err(CurveError::Jump {
                variable: variable.name,
                at: variable.value,
                before: jump.before,
                after: jump.after,
            });
        }
        let mut before = 0.0;
        let stretch = |leaf: Leaf| {
            let stretch = Stretch { leaf, before };
            before += leaf.length;
            stretch
        };
        let leaves: Vec<Stretch> = division.into_leaves().into_iter().map(stretch).collect();
        let magnitude = leaves.iter().flat_map(|stretch| stretch.leaf.start).fold(0.0_f64, |most, c| most.max(c.abs()));
        let tolerance = (POSITION_REL_TOL * before).max(ROUNDING * magnitude);
        Self { curve: curve.clone(), length: before, leaves, tolerance }.with_length()
    }

    fn with_length(self) -> Result<Self, CurveError> {
        if self.length > 0.0 { Ok(self) } else { Err(CurveError::NoLength { point: self.curve.point(0.0) }) }
    }

    /// Length of the whole curve, in the user's unit; greater than 0.
    pub fn length(&self) -> f64 {
        self.length
    }

    /// The point at arc length `s` from the first point; the ends exactly, also for an `s` beyond them.
    pub fn point_at(&self, s: f64) -> Point {
        self.curve.point(self.parameter_at(s))
    }

    /// Fraction of the parameter, for [`Curve::point`], at arc length `s` from the first point; between 0 and 1.
    pub fn parameter_at(&self, s: f64) -> f64 {
        if s <= 0.0 || s.is_nan() {
            return 0.0;
        }
        if s >= self.length {
            return 1.0;
        }
        let number = self.leaves.partition_point(|stretch| stretch.before <= s);
        let Some(stretch) = number.checked_sub(1).and_then(|i| self.leaves.get(i)) else { return s / self.length };
        let Stretch { leaf, before } = *stretch;
        let from = End { u: leaf.from, point: leaf.start };
        let excess = |u: f64| {
            let to = End { u, point: self.curve.point(u) };
            before + ChordSums::new(&self.curve, from, to).length() - s
        };
        let low = Sample { at: leaf.from, value: before - s };
        let high = Sample { at: leaf.to, value: before + leaf.length - s };
        monotone_root(excess, low, high, self.tolerance).at
    }

    /// Arc length from the first point to fraction `u` of the parameter: the inverse of [`Self::parameter_at`].
    pub fn length_to(&self, u: f64) -> f64 {
        if u <= 0.0 || u.is_nan() {
            return 0.0;
        }
        if u >= 1.0 {
            return self.length;
        }
        let number = self.leaves.partition_point(|stretch| stretch.leaf.from <= u);
        let Some(stretch) = number.checked_sub(1).and_then(|i| self.leaves.get(i)) else { return u * self.length };
        let from = End { u: stretch.leaf.from, point: stretch.leaf.start };
        let to = End { u, point: self.curve.point(u) };
        stretch.before + ChordSums::new(&self.curve, from, to).length()
    }
}

fn diverges(length: f64, intervals: usize, error: f64) -> CurveError {
    CurveError::LengthDoesNotConverge { length, intervals, error }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curve::samples::{graph, parametric};
    use nmt_geom::point::distance;

    #[test]
    fn points_of_half_a_circle_are_at_their_angles() {
        let table = ArcTable::new(&graph("sqrt(1-x^2)", 1.0, -1.0)).unwrap();
        assert!((table.length() - std::f64::consts::PI).abs() < 1e-10); // ten times the table's tolerance
        for k in 0..=1000 {
            let angle = table.length() * f64::from(k) / 1000.0;
            let expected = [angle.cos(), angle.sin()];
            assert!(distance(table.point_at(angle), expected) < 1e-10, "{angle}"); // as above
        }
    }

    #[test]
    fn positions_beyond_the_ends_are_the_ends() {
        let table = ArcTable::new(&graph("x^2", 0.0, 1.0)).unwrap();
        assert_eq!((table.parameter_at(-1.0), table.parameter_at(9.0)), (0.0, 1.0));
        assert_eq!((table.parameter_at(f64::NAN), table.point_at(table.length())), (0.0, [1.0, 1.0]));
    }

    #[test]
    fn lengths_and_parameters_are_inverse() {
        for curve in [graph("sqrt(1-x^2)", 1.0, -1.0), graph("sin(5*x)", 0.0, 2.0), graph("2*x", 0.0, 1.0)] {
            let table = ArcTable::new(&curve).unwrap();
            for k in 0..=200 {
                let s = table.length() * f64::from(k) / 200.0;
                assert!((table.length_to(table.parameter_at(s)) - s).abs() < 1e-10 * table.length()); // as above
            }
            assert_eq!((table.length_to(-1.0), table.length_to(2.0)), (0.0, table.length()));
        }
    }

    #[test]
    fn positions_rise_with_the_length() {
        let table = ArcTable::new(&graph("abs(x)^(2/3)", -1.0, 2.0)).unwrap();
        let u: Vec<f64> = (0..=5000).map(|k| table.parameter_at(table.length() * f64::from(k) / 5000.0)).collect();
        assert!(u.windows(2).all(|pair| pair[0] < pair[1]));
    }

    #[test]
    fn curves_without_a_length_are_rejected() {
        let error = |curve: &Curve| ArcTable::new(curve).unwrap_err();
        assert!(matches!(error(&graph("floor(x)", 0.0, 1.5)), CurveError::Jump { variable: "x", .. }));
        assert!(matches!(error(&graph("sin(1/(x+1e-7))", 0.0, 1.0)), CurveError::LengthDoesNotConverge { .. }));
        assert!(matches!(error(&graph("1/x", 0.0, 1.0)), CurveError::LengthDoesNotConverge { .. }));
        assert!(matches!(error(&parametric("1", "2", 0.0, 1.0)), CurveError::NoLength { point: [1.0, 2.0] }));
        assert!(matches!(error(&Curve::Line { from: [1.0, 2.0], to: [1.0, 2.0] }), CurveError::NoLength { .. }));
        assert!(ArcTable::new(&Curve::Line { from: [f64::NAN, 2.0], to: [1.0, 2.0] }).is_err());
    }

    #[test]
    fn a_small_step_is_found_as_well() {
        let text = "sin(x) + 1e-5*sign(x-1.2345)";
        assert!(matches!(ArcTable::new(&graph(text, 0.0, 3.0)), Err(CurveError::Jump { .. })));
    }
}
