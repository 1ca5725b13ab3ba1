//! The length of a curve.

use crate::Curve;
use crate::jump::find_jump;
use crate::subdivision::Subdivision;

/// How accurately a length is measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArcLengthParams {
    /// Relative error allowed; 1e-6 by default, the paper's.
    pub rel_tol: f64,
    /// Greatest number of intervals, the paper's p_max; 1000 by default. The chords of an interval are extrapolated.
    pub max_intervals: usize,
}

impl Default for ArcLengthParams {
    fn default() -> Self {
        Self { rel_tol: 1e-6, max_intervals: 1000 }
    }
}

/// A length and how it was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArcLength {
    /// The length, in the user's unit; NaN or infinite where the curve is.
    pub length: f64,
    /// Intervals of the parameter that it took; 1 for a closed form.
    pub intervals: usize,
    /// True where the tolerance was met, and the curve has no jump.
    pub converged: bool,
}

/// Length of a curve by chords on a local subdivision of its parameter; paper, (3)–(4) \[D2\].
///
/// The interval whose own chords are the least certain is halved first, so that vertical tangents, cusps and kinks take
/// tens of intervals, not thousands. Lines, arcs and circles have closed forms.
///
/// ```
/// # use nmt_curve::{ArcLengthParams, Curve, Expression, arc_length};
/// let y = Expression::parse("abs(x)", &["x"])?;
/// let kink = Curve::Graph { y, from_x: -1.0, to_x: 1.0 };
/// let measured = arc_length(&kink, &ArcLengthParams::default());
/// assert!(measured.converged);
/// assert!((measured.length - 8.0_f64.sqrt()).abs() < 1e-6);
/// # Ok::<(), nmt_curve::ExpressionError>(())
/// ```
pub fn arc_length(curve: &Curve, params: &ArcLengthParams) -> ArcLength {
    if let Some(length) = curve.exact_length() {
        return ArcLength { length, intervals: 1, converged: length.is_finite() };
    }
    let mut division = Subdivision::new(curve, params.max_intervals);
    let met = division.refine(params.rel_tol, params.max_intervals);
    let (length, intervals) = (division.length, division.intervals());
    let converged = met && find_jump(curve, division.leaves(), length).is_none();
    ArcLength { length, intervals, converged }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curve::samples::{graph, parametric};
    use std::f64::consts::{PI, TAU};

    fn measured(curve: &Curve) -> ArcLength {
        arc_length(curve, &ArcLengthParams::default())
    }

    #[test]
    fn lengths_agree_with_closed_forms() {
        // E(m) is the complete elliptic integral of the second kind; its values to 18 digits.
        let astroid = parametric("cos(t)^3", "sin(t)^3", 0.0, TAU);
        let cycloid = parametric("t - sin(t)", "1 - cos(t)", 0.0, 2.0 * TAU);
        let cases = [
            (graph("sin(x)", 0.0, TAU), 7.640_395_578_055_424), // 4√2·E(1/2)
            (graph("0.25*sin(2*pi*x)", 0.0, 2.0), 2.927_390_944_827_072_5), // (4/π)√(1+π²/4)·E(m), m = (π²/4)/(1+π²/4)
            (graph("sqrt(1-x^2)", -1.0, 1.0), PI),              // half a circle
            (graph("x^2", 0.0, 1.0), 5.0_f64.sqrt() / 2.0 + 2.0_f64.asinh() / 4.0),
            (graph("cosh(x)", -1.0, 1.0), 2.0 * 1.0_f64.sinh()),
            (graph("1/(1+25*x^2)", -1.0, 1.0), 3.083_851_888_784_128_6), // quadrature with 30 digits
            (graph("abs(x)", -1.0, 1.0), 8.0_f64.sqrt()),
            (graph("abs(x-0.1234567)", -1.0, 1.0), 8.0_f64.sqrt()),
            (graph("abs(x)^(2/3)", -1.0, 1.0), (13.0_f64.powf(1.5) - 8.0) * 2.0 / 27.0),
            (graph("x^(3/2)", 0.0, 1.0), (13.0_f64.powf(1.5) - 8.0) / 27.0),
            (graph("x^0.1", 0.0, 1.0), 1.754_409_376_494_96), // quadrature of the inverse function x = y¹⁰
            (graph("sqrt(x)", 1.0, 0.0), 5.0_f64.sqrt() / 2.0 + 2.0_f64.asinh() / 4.0),
            (astroid, 6.0),
            (cycloid, 16.0),
        ];
        for (curve, exact) in cases {
            let found = measured(&curve);
            assert!(found.converged && found.intervals <= 1000, "{curve:?}: {found:?}");
            assert!((found.length / exact - 1.0).abs() < 1e-6, "{curve:?}: {found:?}, exactly {exact}"); // the promise
            let fine = arc_length(&curve, &ArcLengthParams { rel_tol: 1e-10, max_intervals: 1000 });
            assert!((fine.length / exact - 1.0).abs() < 1e-9, "{curve:?}: {fine:?}, exactly {exact}"); // ten times the tolerance
        }
    }

    #[test]
    fn lengths_of_lines_arcs_and_ellipses_are_those_of_geometry() {
        let exact = [
            (Curve::Line { from: [1.0, 1.0], to: [4.0, 5.0] }, 5.0),
            (Curve::Arc { centre: [7.0, 0.0], radius: 2.0, start: 1.0, sweep: -PI }, TAU),
            (Curve::Ellipse { centre: [0.0, 0.0], semi_axes: [1.5, 1.5], rotation: 0.2 }, 1.5 * TAU),
            // 4a·E(1 − b²/a²) = 8·E(3/4)
            (Curve::Ellipse { centre: [9.0, 9.0], semi_axes: [2.0, 1.0], rotation: 0.7 }, 9.688_448_220_547_675),
        ];
        for (curve, length) in exact {
            assert!((measured(&curve).length / length - 1.0).abs() < 1e-9, "{curve:?}"); // far below the tolerance: order 8
        }
    }

    #[test]
    fn what_has_no_length_does_not_converge() {
        for (text, from, to) in [
            ("tan(x)", 0.0, 2.0),
            ("1/(x-0.3)", 0.0, 1.0),
            ("1/(x-0.3)^2", 0.0, 1.0),
            ("floor(x)", 0.0, 3.5),
            ("sign(x)", -1.0, 1.0),
            ("sin(1/(x+1e-7))", 0.0, 1.0),
            ("1/x", 0.0, 1.0),
            ("sqrt(x)", -1.0, 1.0),
        ] {
            assert!(!measured(&graph(text, from, to)).converged, "{text}");
        }
    }

    #[test]
    fn the_limit_of_intervals_is_kept_and_told() {
        let wave = graph("sin(1000*x)", 0.0, 10.0);
        for most in [0, 1, 10, 1000] {
            let found = arc_length(&wave, &ArcLengthParams { rel_tol: 1e-12, max_intervals: most });
            assert!(!found.converged && found.intervals <= most.max(1), "{found:?}");
        }
    }

    #[test]
    fn lengths_scale_with_the_unit() {
        for scale in [1e-6, 1e3, 1e120] {
            let y = format!("{scale:e}*0.25*sin(2*pi*x/{scale:e})");
            let found = measured(&graph(&y, 0.0, 2.0 * scale));
            let one = measured(&graph("0.25*sin(2*pi*x)", 0.0, 2.0));
            assert_eq!(found.intervals, one.intervals);
            assert!((found.length / scale / one.length - 1.0).abs() < 1e-13); // rounding of some hundred chords
        }
    }

    #[test]
    fn a_curve_far_from_the_origin_is_limited_by_its_coordinates_alone() {
        let far = graph("1e6 + sqrt(1-(x-1e6)^2)", 1e6 - 1.0, 1e6 + 1.0);
        let found = arc_length(&far, &ArcLengthParams { rel_tol: 1e-11, max_intervals: 1000 });
        assert!((found.length / PI - 1.0).abs() < 1e-8, "{found:?}"); // coordinates are rounded to 1e-10 of the length
    }

    #[test]
    fn kinks_and_cusps_anywhere_converge() {
        // ∫√(1 + y′²) of |x|^(2/3) and of √|x| from 0 to h, in closed form.
        let two_thirds = |h: f64| (4.0 / 9.0 + h.powf(2.0 / 3.0)).powf(1.5) - (4.0_f64 / 9.0).powf(1.5);
        let root = |h: f64| 0.5 * (h * (1.0 + 4.0 * h)).sqrt() + 0.25 * (2.0 * h.sqrt()).asinh();
        for k in 0..500 {
            // Spread over the interval without a period.
            let p = 2.0 * (f64::from(k) * 0.618_033_988_749_894_9 + 0.123).fract() - 1.0;
            let (left, right) = (1.0 + p, 1.0 - p);
            let cases = [
                (format!("abs(x-({p:e}))"), 8.0_f64.sqrt()),
                (format!("5*max(0, x-({p:e}))"), left + right * 26.0_f64.sqrt()),
                (format!("abs(x-({p:e}))^(2/3)"), two_thirds(left) + two_thirds(right)),
                (format!("sqrt(abs(x-({p:e})))"), root(left) + root(right)),
            ];
            for (text, exact) in cases {
                let found = measured(&graph(&text, -1.0, 1.0));
                assert!(found.converged && found.intervals < 200, "{text}: {found:?}"); // 129 measured
                assert!((found.length / exact - 1.0).abs() < 1e-6, "{text}: {found:?}, exactly {exact}"); // the promise
            }
        }
    }

    #[test]
    fn a_hundred_waves_converge() {
        // √(1 + 4cos²) over 100 waves: (4·100/100)·√5·E(4/5), E(4/5) to 18 digits.
        let wave = graph("0.02*sin(100*x)", 0.0, TAU);
        let found = arc_length(&wave, &ArcLengthParams { max_intervals: 1200, ..ArcLengthParams::default() });
        let exact = 4.0 * 5.0_f64.sqrt() * 1.178_489_924_327_838_5;
        assert!(found.converged && (found.length / exact - 1.0).abs() < 1e-6, "{found:?}, exactly {exact}"); // the promise
    }
}
