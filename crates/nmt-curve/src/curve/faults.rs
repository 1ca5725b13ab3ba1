//! All that can be wrong with one edge of an outline.

use nmt_geom::Point;
use nmt_geom::point::distance;

use super::Curve;
use crate::error::CurveEnd;
use crate::{ArcTable, CurveError, Expression};

/// An end farther from its vertex than this fraction of the problem's size misses it; so does an arc whose radii differ
/// by it.
///
/// Rounding of a formula moves an end by 1e-15 to 1e-12 of the size, a mistake in it by far more.
const MISSES_REL: f64 = 1e-9;

/// Rounding of a variable and of the few operations on it, relative.
const ROUNDING_REL: f64 = 8.0 * f64::EPSILON;

/// The most an end may move by rounding of its variable, relative to the interval: √ROUNDING_REL and some more.
const SHAKEN_REL: f64 = 1e-6;

/// Intervals between the points at which a formula must be finite; the ends and the middle are among them.
const FINITE_INTERVALS: usize = 1024;

impl Curve {
    /// All the reasons why the curve cannot be an edge from one vertex to another; empty for a good one.
    ///
    /// `size` is the diagonal of the envelope of the whole problem: an end may miss its vertex by 1e-9 of it. Of
    /// several places where a formula is not finite the first is named.
    pub fn faults(&self, from: Point, to: Point, size: f64) -> Vec<CurveError> {
        let mut faults = self.malformed(from, to, size);
        if faults.is_empty() {
            faults.extend(self.not_finite());
        }
        if !faults.is_empty() {
            return faults;
        }
        // The radius of an arc is the mean of two distances that have been compared; its ends are off by their
        // difference.
        for (end, u, vertex) in [(CurveEnd::Start, 0.0, from), (CurveEnd::Finish, 1.0, to)] {
            let point = self.point(u);
            let gap = distance(point, vertex);
            if gap.is_nan() || gap > MISSES_REL * size + self.shaken(end) {
                faults.push(CurveError::MissesVertex { end, point, vertex, gap });
            }
        }
        faults.extend(ArcTable::new(self).err());
        faults
    }

    /// How far an end moves when its variable moves by rounding: nothing to speak of, but √ε where the tangent is
    /// vertical, as at the ends of `sqrt(0.25 - (x - 1.55)^2)`.
    fn shaken(&self, end: CurveEnd) -> f64 {
        let (low, high) = match self {
            Self::Graph { from_x, to_x, .. } => (*from_x, *to_x),
            Self::Parametric { from_t, to_t, .. } => (*from_t, *to_t),
            _ => return 0.0,
        };
        let rounding = ROUNDING_REL * low.abs().max(high.abs()) / (high - low).abs();
        let (u, inner) = if end == CurveEnd::Start { (0.0, rounding) } else { (1.0, 1.0 - rounding) };
        let moved = distance(self.point(u), self.point(inner));
        // More than √ε is no rounding of a square root: a jump or a pole at the end.
        if moved <= SHAKEN_REL * (high - low).abs() { moved } else { 0.0 }
    }

    /// Faults of the numbers that define the curve, without a look at its points.
    fn malformed(&self, from: Point, to: Point, size: f64) -> Vec<CurveError> {
        let finite = |what: &'static str, numbers: &[f64]| {
            let value = numbers.iter().copied().find(|number| !number.is_finite());
            value.map(|value| CurveError::NotANumber { what, value })
        };
        let positive =
            |what: &'static str, value: f64| (value <= 0.0).then_some(CurveError::NotPositive { what, value });
        let mut faults = Vec::new();
        match self {
            Self::Line { from, to } => faults.extend(finite("end of the line", &[from[0], from[1], to[0], to[1]])),
            Self::Graph { from_x, to_x, .. } => {
                faults.extend(finite("abscissa of an end", &[*from_x, *to_x]));
                if from_x == to_x {
                    faults.push(CurveError::Vertical { x: *from_x });
                }
            }
            Self::Arc { centre, radius, start, sweep } => {
                faults.extend(finite(
                    "centre, radius or angle of the arc",
                    &[centre[0], centre[1], *radius, *start, *sweep],
                ));
                faults.extend(positive("radius", *radius));
                let [from_start, from_finish] = [from, to].map(|vertex| distance(*centre, vertex));
                if (from_start - from_finish).abs() > MISSES_REL * size {
                    faults.push(CurveError::NotEquidistant { centre: *centre, from_start, from_finish });
                }
            }
            Self::Ellipse { centre, semi_axes: [a, b], rotation } => {
                let what = if a == b { "radius" } else { "semi-axis" };
                faults.extend(finite(
                    "centre, semi-axis or angle of the ellipse",
                    &[centre[0], centre[1], *a, *b, *rotation],
                ));
                faults.extend(positive(what, a.min(*b)));
            }
            Self::Parametric { from_t, to_t, .. } => {
                faults.extend(finite("end of the parameter's interval", &[*from_t, *to_t]));
                if from_t == to_t {
                    faults.push(CurveError::EmptyInterval { t: *from_t });
                }
            }
        }
        faults
    }

    /// The first of the equally spaced points at which a formula is NaN or infinite.
    fn not_finite(&self) -> Option<CurveError> {
        let formulas: Vec<&Expression> = match self {
            Self::Graph { y, .. } => vec![y],
            Self::Parametric { x, y, .. } => vec![x, y],
            _ => return None,
        };
        (0..=FINITE_INTERVALS).find_map(|k| {
            let variable = self.variable(k as f64 / FINITE_INTERVALS as f64);
            let formula = formulas.iter().find(|formula| !formula.at(variable.value).is_finite())?;
            let text = formula.text().to_string();
            let value = formula.at(variable.value);
            let remedy = remedy(formula, value, k == 0 || k == FINITE_INTERVALS);
            Some(CurveError::NotFinite { text, variable: variable.name, at: variable.value, value, remedy })
        })
    }
}

/// What to do about a formula that is not finite.
fn remedy(formula: &Expression, value: f64, at_an_end: bool) -> &'static str {
    let has = |name: &str| formula.text().contains(name);
    if value.is_nan() && at_an_end && has("sqrt") {
        "where rounding makes the radicand negative at the end, write sqrt(max(0, ...)); else restrict the edge to where it is defined"
    } else if value.is_nan() && at_an_end && (has("asin") || has("acos")) {
        "where rounding takes the argument beyond 1 at the end, write asin(min(1, ...)); else restrict the edge to where it is defined"
    } else if value.is_nan() && has("^") && !has("sqrt") && !has("ln") && !has("log") {
        "a negative number has no fractional power: write cbrt(...) or abs(...)^p, or restrict the edge to where it is defined"
    } else {
        "restrict the edge to where it is finite, or give it as x(t), y(t)"
    }
}

#[cfg(test)]
mod tests {
    use super::super::Turn;
    use super::super::samples::{graph, parametric};
    use super::*;

    fn of_graph(text: &str, from_x: f64, to_x: f64, vertices: [Point; 2]) -> Vec<CurveError> {
        graph(text, from_x, to_x).faults(vertices[0], vertices[1], 2.0)
    }

    #[test]
    fn a_semicircle_with_decimal_centre_meets_its_vertices_in_spite_of_rounding() {
        // 2.05 − 1.55 is not 0.5 in binary: the square root makes 1.5e-8 of that.
        let y = Expression::parse("sqrt(max(0, 0.25 - (x - 1.55)^2))", &["x"]).expect("a formula");
        let curve = Curve::Graph { y, from_x: 1.05, to_x: 2.05 };
        assert_eq!(curve.faults([1.05, 0.0], [2.05, 0.0], 3.0), vec![]);
        assert!(!curve.faults([1.05, 0.0], [2.05, 1e-6], 3.0).is_empty());
    }

    #[test]
    fn good_curves_have_no_fault() {
        assert_eq!(of_graph("sqrt(1-x^2)", -1.0, 1.0, [[-1.0, 0.0], [1.0, 0.0]]), []);
        assert_eq!(of_graph("abs(x)^(2/3)", 1.0, -1.0, [[1.0, 1.0], [-1.0, 1.0]]), []);
        assert_eq!(of_graph("sin(pi*x)", 0.0, 1.0, [[0.0, 0.0], [1.0, 0.0]]), []);
        assert_eq!(
            parametric("cos(t)", "sin(t)", 0.0, 1.0).faults([1.0, 0.0], [1.0_f64.cos(), 1.0_f64.sin()], 1.0),
            []
        );
        let arc = Curve::arc([0.5, 0.0], [1.0, 0.0], [0.0, 0.0], Turn::Clockwise);
        assert_eq!(arc.faults([1.0, 0.0], [0.0, 0.0], 1.0), []);
    }

    #[test]
    fn a_missed_vertex_is_told_with_its_distance() {
        let faults = of_graph("x^2", 0.0, 1.0, [[0.0, 0.0], [1.0, 1.25]]);
        let expected =
            CurveError::MissesVertex { end: CurveEnd::Finish, point: [1.0, 1.0], vertex: [1.0, 1.25], gap: 0.25 };
        assert_eq!(faults, [expected]);
        assert_eq!(
            faults[0].to_string(),
            "the curve ends at (1, 1), 0.25 away from its vertex (1, 1.25); move the vertex there, or correct the curve (angles are in radians)"
        );
        assert_eq!(of_graph("x^2 + 1e-8", 0.0, 1.0, [[0.0, 0.0], [1.0, 1.0]]).len(), 2);
        assert_eq!(of_graph("x^2 + 1e-9", 0.0, 1.0, [[0.0, 0.0], [1.0, 1.0]]), []);
    }

    #[test]
    fn a_formula_that_is_not_finite_is_told_with_its_place() {
        for (text, x) in [("1/x", 0.0), ("sqrt(0.5-x)", 513.0 / 1024.0), ("ln(1-x)", 1.0), ("1/(x-0.5)", 0.5)] {
            match of_graph(text, 0.0, 1.0, [[0.0, 0.0], [1.0, 0.0]]).as_slice() {
                [CurveError::NotFinite { at, variable: "x", text: told, .. }] => {
                    assert_eq!((*at, told.as_str()), (x, text))
                }
                other => panic!("{text}: {other:?}"),
            }
        }
        let beyond = of_graph("sqrt(1-x^2)", -1.0, 1.0 + 1e-12, [[-1.0, 0.0], [1.0, 0.0]]);
        assert!(beyond[0].to_string().contains("sqrt(max(0, ...))"), "{}", beyond[0]);
        let negative = of_graph("x^(1/3)", -1.0, 1.0, [[-1.0, -1.0], [1.0, 1.0]]);
        assert!(negative[0].to_string().contains("cbrt"), "{}", negative[0]);
        let parametric = parametric("t", "1/t", 0.0, 1.0).faults([0.0, 0.0], [1.0, 1.0], 1.0);
        assert!(matches!(&parametric[..], [CurveError::NotFinite { variable: "t", text, .. }] if text == "1/t"));
    }

    #[test]
    fn curves_without_extent_are_told() {
        assert_eq!(of_graph("x", 1.0, 1.0, [[1.0, 0.0], [1.0, 2.0]]), [CurveError::Vertical { x: 1.0 }]);
        let still = parametric("t", "t", 2.0, 2.0).faults([2.0, 2.0], [2.0, 2.0], 1.0);
        assert_eq!(still, [CurveError::EmptyInterval { t: 2.0 }]);
        let point = Curve::arc([0.0, 0.0], [0.0, 0.0], [0.0, 0.0], Turn::Clockwise).faults([0.0, 0.0], [0.0, 0.0], 1.0);
        assert_eq!(point, [CurveError::NotPositive { what: "radius", value: 0.0 }]);
        let line = Curve::Line { from: [1.0, 2.0], to: [1.0, 2.0] }.faults([1.0, 2.0], [1.0, 2.0], 1.0);
        assert_eq!(line, [CurveError::NoLength { point: [1.0, 2.0] }]);
        let flat = Curve::Ellipse { centre: [0.0, 0.0], semi_axes: [1.0, -2.0], rotation: 0.0 };
        assert_eq!(
            flat.faults([1.0, 0.0], [1.0, 0.0], 1.0),
            [CurveError::NotPositive { what: "semi-axis", value: -2.0 }]
        );
    }

    #[test]
    fn an_arc_needs_a_centre_at_equal_distances() {
        let (from, to) = ([1.0, 0.0], [0.0, 1.1]);
        let arc = Curve::arc([0.0, 0.0], from, to, Turn::CounterClockwise);
        let faults = arc.faults(from, to, 1.0);
        assert_eq!(faults, [CurveError::NotEquidistant { centre: [0.0, 0.0], from_start: 1.0, from_finish: 1.1 }]);
        assert!(faults[0].to_string().contains("1.1 from its last"));
    }

    #[test]
    fn steps_and_endless_waves_are_told() {
        let step = of_graph("floor(x)", 0.5, 1.5, [[0.5, 0.0], [1.5, 1.0]]);
        assert!(matches!(&step[..], [CurveError::Jump { at, .. }] if (at - 1.0).abs() < 1e-12), "{step:?}");
        let tangent = of_graph("tan(x)", 0.0, 3.0, [[0.0, 0.0], [3.0, 3.0_f64.tan()]]);
        assert!(matches!(&tangent[..], [CurveError::Jump { .. }]), "{tangent:?}");
        let wild = of_graph("x*sin(1/(x+1e-9))", 0.0, 1.0, [[0.0, 0.0], [1.0, (1.0_f64 / (1.0 + 1e-9)).sin()]]);
        assert!(matches!(&wild[..], [CurveError::LengthDoesNotConverge { .. }]), "{wild:?}");
    }

    #[test]
    fn numbers_that_are_not_finite_are_told() {
        for value in [f64::NAN, f64::INFINITY] {
            let line = Curve::Line { from: [0.0, value], to: [1.0, 1.0] };
            assert!(matches!(&line.faults([0.0, 0.0], [1.0, 1.0], 1.0)[..], [CurveError::NotANumber { .. }]));
            assert!(!graph("x", 0.0, value).faults([0.0, 0.0], [1.0, 1.0], 1.0).is_empty());
            assert!(!graph("x", 0.0, 1.0).faults([0.0, value], [1.0, 1.0], 1.0).is_empty());
            assert!(
                !Curve::arc([value, 0.0], [0.0, 0.0], [1.0, 1.0], Turn::Clockwise)
                    .faults([0.0; 2], [1.0; 2], 1.0)
                    .is_empty()
            );
        }
    }
}
