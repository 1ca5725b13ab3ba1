//! Formulas of one or more variables: text to a flat program, to a value and its derivatives.

mod compile;
mod error;
mod eval;
mod names;
mod parse;
mod range;

use std::fmt;
use std::sync::Arc;

pub use error::ExpressionError;
pub use eval::Jet;

use compile::Program;
use eval::Scalar;
use range::{Range, SLOPED, Sloped};

/// Longest formula accepted, in bytes.
///
/// A formula that a person writes has at most a few hundred; the limit keeps time and memory of a hostile one small.
pub const MAX_FORMULA_BYTES: usize = 4096;

/// Deepest nesting accepted: parentheses, calls and signs within one another.
///
/// It bounds the recursion of the parser (a few kilobytes of stack) and the value stack of the evaluation.
pub const MAX_FORMULA_NESTING: usize = 64;

/// A formula such as `1 + 0.2*sin(pi*x)^2`, ready to be evaluated.
///
/// The grammar is that of engineers: `+ - * / ^`, signs, parentheses, the variables given to [`Expression::parse`],
/// `pi`, `e`, and the functions `sin cos tan asin acos atan atan2 sinh cosh tanh exp ln log log10 sqrt cbrt abs sign
/// min max floor ceil` (`log` is natural, `min` and `max` take two or more arguments). MATLAB's `.^ .* ./` are `^ * /`.
///
/// Every number is a float, so that `1/2*x` is `0.5*x` \[D1\]. As in MATLAB, `-x^2` is `-(x^2)`, `2^3^2` is `(2^3)^2`,
/// and `2^-1` is 0.5. `sign(0)` is 0; `min` and `max` of NaN are NaN, so that an undefined value is never hidden.
///
/// ```
/// # use nmt_curve::Expression;
/// let arch = Expression::parse("-x^2 + 1/2*x", &["x"])?;
/// assert_eq!(arch.at(2.0), -3.0);
/// let jet = arch.jet(2.0);
/// assert_eq!((jet.value, jet.d1, jet.d2), (-3.0, -3.5, -2.0));
/// let error = Expression::parse("2x", &["x"]).unwrap_err();
/// assert_eq!(error.to_string(), "an operator is missing; write `2*x`");
/// assert_eq!(error.at(), 1);
/// # Ok::<(), nmt_curve::ExpressionError>(())
/// ```
#[derive(Clone, PartialEq)]
pub struct Expression {
    text: Arc<str>,
    program: Arc<Program>,
}

impl Expression {
    /// The formula `text` in the named `variables`.
    ///
    /// # Errors
    /// An [`ExpressionError`] that points at the first character that cannot be understood and says what to write
    /// instead. A value that is not finite (`1/0`) is not an error here: whoever evaluates knows where it matters.
    pub fn parse(text: &str, variables: &[&str]) -> Result<Self, ExpressionError> {
        let program = parse::parse(text, variables)?;
        Ok(Self { text: text.into(), program: Arc::new(program) })
    }

    /// The formula as it was written.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The value, where the variables have `values`, in the order in which they were named; NaN where one is not given.
    pub fn eval(&self, values: &[f64]) -> f64 {
        self.program.run(|variable| values.get(variable).copied().unwrap_or(f64::NAN))
    }

    /// A number that no value is less than while each variable lies within its `limits`, in the order in which they were named;
    /// −∞ where none is known, NaN where the formula has no value there at all.
    ///
    /// Rounding is not taken into account. Where the bound is less than `enough`, a sharper one is sought, by the slopes along the
    /// first two variables (mean value form): its distance from the least value falls with the square of the limits' width.
    ///
    /// ```
    /// # use nmt_curve::Expression;
    /// let f = Expression::parse("x^2 - 2*x + y", &["x", "y"])?;
    /// let limits = [[1.0, 1.1], [0.0, 0.1]]; // the least value is −1, at (1, 0)
    /// assert!((f.lower_bound(&limits, -2.0) + 1.2).abs() < 1e-12);
    /// assert!((f.lower_bound(&limits, -1.0) + 1.0075).abs() < 1e-12);
    /// # Ok::<(), nmt_curve::ExpressionError>(())
    /// ```
    pub fn lower_bound(&self, limits: &[[f64; 2]], enough: f64) -> f64 {
        let range = |variable: usize| limits.get(variable).map_or(Range::new([f64::NAN; 2]), |of| Range::new(*of));
        let plain = self.program.run(range).lo;
        if plain >= enough || limits.len() > SLOPED {
            return plain;
        }
        let Sloped { value, slopes } = self.program.run(|variable| Sloped::variable(variable, range(variable)));
        let middle = |[lo, hi]: [f64; 2]| lo + 0.5 * (hi - lo);
        let at_middle = self.program.run(|variable| limits.get(variable).map_or(f64::NAN, |of| middle(*of)));
        let ways = limits.iter().zip(slopes).map(|([lo, hi], slope)| 0.5 * (hi - lo) * slope.steepest());
        let by_slopes = at_middle - ways.sum::<f64>();
        // NaN, where the formula is undefined somewhere, is no bound.
        value.lo.max(by_slopes)
    }

    /// The value of a formula of one variable at `x`.
    #[inline]
    pub fn at(&self, x: f64) -> f64 {
        self.eval(&[x])
    }

    /// Value, first and second derivative of a formula of one variable at `x`.
    ///
    /// Exact to rounding (forward differentiation). At a vertical tangent the first derivative is infinite; at a kink
    /// it is that of one branch (`min`, `max`) or 0 (`abs`, `sign`), at a step 0.
    pub fn jet(&self, x: f64) -> Jet {
        self.jet_along(&[x], 0)
    }

    /// Value, first and second partial derivative with respect to the variable of number `along`, where the variables have
    /// `values`; as [`Expression::jet`].
    ///
    /// ```
    /// # use nmt_curve::Expression;
    /// let u = Expression::parse("x^2*y", &["x", "y"])?;
    /// assert_eq!(u.jet_along(&[3.0, 2.0], 0).d1, 12.0);
    /// assert_eq!(u.jet_along(&[3.0, 2.0], 1).d1, 9.0);
    /// # Ok::<(), nmt_curve::ExpressionError>(())
    /// ```
    pub fn jet_along(&self, values: &[f64], along: usize) -> Jet {
        self.program.run(|variable| {
            let value = values.get(variable).copied().unwrap_or(f64::NAN);
            if variable == along { Jet::variable(value) } else { Jet::constant(value) }
        })
    }
}

impl fmt::Debug for Expression {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Expression").field(&self.text).finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(text: &str) -> f64 {
        Expression::parse(text, &["x"]).unwrap_or_else(|error| panic!("{text}: {error}")).at(3.0)
    }

    #[test]
    fn every_number_is_a_float() {
        assert_eq!(value("1/2*x"), 1.5);
        assert_eq!(value("7/2"), 3.5);
        assert_eq!(value(".5 + 2. + 1e-3 + 2E+1 + 1.5e1"), 0.5 + 2.0 + 1e-3 + 20.0 + 15.0);
    }

    #[test]
    fn signs_and_powers_bind_as_in_matlab() {
        assert_eq!(value("-x^2"), -9.0);
        assert_eq!(value("2^3^2"), 64.0);
        assert_eq!(value("2^-1"), 0.5);
        assert_eq!(value("2^-1^2"), 0.25);
        assert_eq!(value("2^--1"), 2.0);
        assert_eq!(value("-2^-2"), -0.25);
        assert_eq!(value("+x"), 3.0);
        assert_eq!(value("--x"), 3.0);
        assert_eq!(value("2*-x"), -6.0);
        assert_eq!(value("2--x"), 5.0);
        assert_eq!(value("2-3-4"), -5.0);
        assert_eq!(value("2/4/2"), 0.25);
        assert_eq!(value("-x*2+1"), -5.0);
    }

    #[test]
    fn elementwise_operators_are_ordinary_ones() {
        assert_eq!(value("2.^x"), 8.0);
        assert_eq!(value("2.*x"), 6.0);
        assert_eq!(value("2./x"), 2.0 / 3.0);
        assert_eq!(value("x.^2 + 2..*x"), 15.0);
    }

    #[test]
    fn functions_and_constants_have_their_usual_values() {
        assert_eq!(value("log(e)"), 1.0);
        assert_eq!(value("ln(e^2)"), 2.0);
        assert_eq!(value("log10(1000)"), 3.0);
        assert_eq!(value("atan2(1, -1)"), 0.75 * std::f64::consts::PI);
        assert_eq!(value("min(x, 2, 5) + max(x, 2, 5)"), 7.0);
        assert_eq!(value("sign(0) + sign(-2) + sign(7)"), 0.0);
        assert_eq!(value("floor(2.5) + ceil(2.5)"), 5.0);
        assert_eq!(value("cbrt(-27) + abs(-3) + sqrt(9)"), 3.0);
        assert_eq!(value("cosh(0) + sinh(0) + tanh(0) + exp(0)"), 2.0);
        assert_eq!(value("sin(pi/2) + cos(0) + tan(0) + asin(0) + acos(1) + atan(0)"), 2.0);
        assert!(value("max(0/0, 1)").is_nan());
    }

    #[test]
    fn two_variables_are_taken_in_the_order_named() {
        let product = Expression::parse("x - 2*y", &["x", "y"]).unwrap();
        assert_eq!(product.eval(&[1.0, 3.0]), -5.0);
        assert!(product.eval(&[1.0]).is_nan());
    }

    #[test]
    fn derivatives_agree_with_differences() {
        let formulas = [
            "x^3 - 2*x",
            "sin(x)*cos(2*x)",
            "exp(-x^2)/(1+x)",
            "tan(x/4)",
            "asin(x/4) + acos(x/5) + atan(x)",
            "sinh(x) - cosh(x/2)*tanh(x)",
            "ln(x) + log10(x+1)",
            "sqrt(x) + cbrt(x)",
            "x^x",
            "x^1.7 + x^-3 + 2^x",
            "atan2(x^2, 1+x)",
            "abs(x-1)^(2/3) * min(x, 7) / max(x, 1)",
        ];
        for text in formulas {
            let f = Expression::parse(text, &["x"]).unwrap();
            for x in [0.3, 0.8, 1.7, 2.4] {
                let h = 1e-4;
                let (low, middle, high) = (f.at(x - h), f.at(x), f.at(x + h));
                let jet = f.jet(x);
                let scale = 1.0 + middle.abs() + jet.d1.abs() + jet.d2.abs();
                assert!((jet.value - middle).abs() <= 1e-14 * scale, "{text} at {x}");
                // Central differences: truncation h²f'''/6 ~ 1e-8·f''' and rounding 1e-16/h² ~ 1e-8; derivatives grow
                // here to 1e2.
                assert!((jet.d1 - (high - low) / (2.0 * h)).abs() < 1e-5 * scale, "{text} at {x}: d1 = {}", jet.d1);
                assert!(
                    (jet.d2 - (high - 2.0 * middle + low) / (h * h)).abs() < 1e-5 * scale,
                    "{text} at {x}: d2 = {}",
                    jet.d2
                );
            }
        }
    }

    #[test]
    fn derivatives_at_kinks_and_vertical_tangents_do_not_panic() {
        let jet = |text: &str, x: f64| Expression::parse(text, &["x"]).unwrap().jet(x);
        assert_eq!(jet("sqrt(x)", 0.0).d1, f64::INFINITY);
        assert_eq!(jet("sqrt(1-x^2)", 1.0).d1, f64::NEG_INFINITY);
        assert_eq!(jet("sqrt(0*x)", 1.0).d1, 0.0);
        assert_eq!(jet("abs(x)", 0.0).d1, 0.0);
        assert_eq!(jet("abs(x)", -2.0).d1, -1.0);
        assert_eq!(jet("sign(x) + floor(x) + ceil(x)", 0.5).d1, 0.0);
        assert_eq!(jet("min(x, 2*x)", -1.0).d1, 2.0);
    }
}
