//! Running a program on ranges of numbers: where its values lie while the variables lie within limits (interval arithmetic;
//! R. E. Moore, *Interval Analysis*, 1966).
//!
//! Rounding is not taken outwards: bounds hold to the last digits.

use super::compile::{Function, Op};
use super::eval::{Scalar, product};
use std::f64::consts::{FRAC_PI_2, LN_10, PI, TAU};

/// Arguments of sines farther out than this have no digits left to tell where they lie.
const FARTHEST_ANGLE: f64 = 1.0e9;

/// All numbers from `lo` to `hi`; NaN where there is none, because the formula is undefined for all arguments.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Range {
    pub lo: f64,
    pub hi: f64,
}

impl Range {
    const ALL: Self = Self { lo: f64::NEG_INFINITY, hi: f64::INFINITY };
    const UNDEFINED: Self = Self { lo: f64::NAN, hi: f64::NAN };
    const ZERO: Self = Self { lo: 0.0, hi: 0.0 };

    pub fn new([lo, hi]: [f64; 2]) -> Self {
        Self { lo, hi }
    }

    fn point(value: f64) -> Self {
        Self { lo: value, hi: value }
    }

    fn is_point(self) -> bool {
        self.lo == self.hi
    }

    /// The largest magnitude in it.
    pub fn steepest(self) -> f64 {
        self.lo.abs().max(self.hi.abs())
    }

    /// The part of it within limits.
    fn within(self, lo: f64, hi: f64) -> Self {
        // NaN is in no order.
        if self.lo <= hi && self.hi >= lo { Self { lo: self.lo.max(lo), hi: self.hi.min(hi) } } else { Self::UNDEFINED }
    }

    /// What a function that rises makes of it.
    fn rising(self, f: impl Fn(f64) -> f64) -> Self {
        Self { lo: f(self.lo), hi: f(self.hi) }
    }

    fn falling(self, f: impl Fn(f64) -> f64) -> Self {
        Self { lo: f(self.hi), hi: f(self.lo) }
    }

    /// What a function that falls up to 0 and rises from there makes of it.
    fn even(self, f: impl Fn(f64) -> f64) -> Self {
        let (a, b) = (self.lo.abs(), self.hi.abs());
        let least = if self.lo <= 0.0 && self.hi >= 0.0 { 0.0 } else { a.min(b) };
        Self { lo: f(least), hi: f(a.max(b)) }
    }

    fn hull(self, other: Self) -> Self {
        Self { lo: self.lo.min(other.lo), hi: self.hi.max(other.hi) }
    }

    fn negative(self) -> Self {
        self.falling(|v| -v)
    }

    fn plus(self, other: Self) -> Self {
        Self { lo: self.lo + other.lo, hi: self.hi + other.hi }
    }

    fn minus(self, other: Self) -> Self {
        self.plus(other.negative())
    }

    fn times(self, other: Self) -> Self {
        let ends = [(self.lo, other.lo), (self.lo, other.hi), (self.hi, other.lo), (self.hi, other.hi)];
        let products = ends.map(|(a, b)| product(a, b));
        if products.iter().any(|p| p.is_nan()) {
            return Self::UNDEFINED;
        }
        Self {
            lo: products.iter().copied().fold(f64::INFINITY, f64::min),
            hi: products.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        }
    }

    fn by(self, factor: f64) -> Self {
        self.times(Self::point(factor))
    }

    /// One over it.
    fn reciprocal(self) -> Self {
        if self.lo > 0.0 || self.hi < 0.0 {
            self.falling(|v| 1.0 / v)
        } else if self.lo == 0.0 && self.hi > 0.0 {
            Self { lo: 1.0 / self.hi, hi: f64::INFINITY }
        } else if self.hi == 0.0 && self.lo < 0.0 {
            Self { lo: f64::NEG_INFINITY, hi: 1.0 / self.lo }
        } else if self.lo <= 0.0 && self.hi >= 0.0 {
            Self::ALL
        } else {
            Self::UNDEFINED
        }
    }

    fn integer_power(self, n: i32) -> Self {
        let Some(magnitude) = n.checked_abs() else { return Self::ALL };
        let power = |v: f64| v.powi(magnitude);
        let positive = if magnitude % 2 == 0 { self.even(power) } else { self.rising(power) };
        if n < 0 { positive.reciprocal() } else { positive }
    }

    fn power(self, exponent: Self) -> Self {
        if self.lo < 0.0 {
            // Defined for whole exponents alone: no narrower range is worth its case.
            return Self::ALL;
        }
        if exponent.is_point() {
            let of = |v: f64| v.powf(exponent.lo);
            return if exponent.lo >= 0.0 { self.rising(of) } else { self.falling(of) };
        }
        exponent.times(self.call(Function::Ln)).call(Function::Exp)
    }

    /// Cosines of a range of angles.
    fn cos(self) -> Self {
        if self.lo.is_nan() || self.hi.is_nan() {
            return Self::UNDEFINED;
        }
        if self.hi - self.lo >= TAU || self.lo.abs().max(self.hi.abs()) > FARTHEST_ANGLE {
            return Self { lo: -1.0, hi: 1.0 };
        }
        let ends = Self::point(self.lo.cos()).hull(Self::point(self.hi.cos()));
        let (lo, hi) =
            (if self.meets(PI, TAU) { -1.0 } else { ends.lo }, if self.meets(0.0, TAU) { 1.0 } else { ends.hi });
        Self { lo, hi }
    }

    /// Whether it holds `first` plus a multiple of `period`, or nearly so.
    fn meets(self, first: f64, period: f64) -> bool {
        let slack = 1e-9 * period;
        first + period * ((self.lo - slack - first) / period).ceil() <= self.hi + slack
    }

    /// What a function makes of it, where it is defined.
    fn call(self, function: Function) -> Self {
        match function {
            Function::Sin => self.plus(Self::point(-FRAC_PI_2)).cos(),
            Function::Cos => self.cos(),
            Function::Tan if self.hi - self.lo >= PI || self.meets(FRAC_PI_2, PI) => Self::ALL,
            Function::Tan => self.rising(f64::tan),
            Function::Asin => self.within(-1.0, 1.0).rising(f64::asin),
            Function::Acos => self.within(-1.0, 1.0).falling(f64::acos),
            Function::Atan => self.rising(f64::atan),
            Function::Sinh => self.rising(f64::sinh),
            Function::Cosh => self.even(f64::cosh),
            Function::Tanh => self.rising(f64::tanh),
            Function::Exp => self.rising(f64::exp),
            Function::Ln => self.within(0.0, f64::INFINITY).rising(f64::ln),
            Function::Log10 => self.within(0.0, f64::INFINITY).rising(f64::log10),
            Function::Sqrt => self.within(0.0, f64::INFINITY).rising(f64::sqrt),
            Function::Cbrt => self.rising(f64::cbrt),
            Function::Abs => self.even(f64::abs),
            Function::Sign | Function::Floor | Function::Ceil => self.rising(|v| f64::unary(v, Op::Call(function))),
        }
    }

    /// The slopes of a function over it; of one with a jump in it all.
    fn slopes(self, function: Function) -> Self {
        let one = Self::point(1.0);
        let square = |range: Self| range.integer_power(2);
        match function {
            Function::Sin => self.cos(),
            Function::Cos => self.call(Function::Sin).negative(),
            Function::Tan => one.plus(square(self.call(Function::Tan))),
            Function::Asin => one.minus(square(self.within(-1.0, 1.0))).call(Function::Sqrt).reciprocal(),
            Function::Acos => self.slopes(Function::Asin).negative(),
            Function::Atan => one.plus(square(self)).reciprocal(),
            Function::Sinh => self.call(Function::Cosh),
            Function::Cosh => self.call(Function::Sinh),
            Function::Tanh => one.minus(square(self.call(Function::Tanh))),
            Function::Exp => self.call(Function::Exp),
            Function::Ln => self.within(0.0, f64::INFINITY).reciprocal(),
            Function::Log10 => self.slopes(Function::Ln).by(1.0 / LN_10),
            Function::Sqrt => self.call(Function::Sqrt).by(2.0).reciprocal(),
            Function::Cbrt => square(self.call(Function::Cbrt)).by(3.0).reciprocal(),
            Function::Abs => self.call(Function::Sign),
            Function::Sign | Function::Floor | Function::Ceil => {
                if self.call(function).is_point() {
                    Self::ZERO
                } else {
                    Self::ALL
                }
            }
        }
    }
}

impl Scalar for Range {
    fn constant(value: f64) -> Self {
        Self::point(value)
    }

    fn unary(self, op: Op) -> Self {
        match op {
            Op::Negate => self.negative(),
            Op::IntegerPower(exponent) => self.integer_power(exponent),
            Op::Call(function) => self.call(function),
            _ => Self::UNDEFINED,
        }
    }

    fn binary(self, right: Self, op: Op) -> Self {
        match op {
            Op::Add => self.plus(right),
            Op::Subtract => self.minus(right),
            Op::Multiply => self.times(right),
            Op::Divide => self.times(right.reciprocal()),
            Op::Power => self.power(right),
            Op::Atan2 if right.lo > 0.0 => self.times(right.reciprocal()).rising(f64::atan),
            Op::Atan2 => Self { lo: -PI, hi: PI },
            Op::Min => Self { lo: self.lo.min(right.lo), hi: self.hi.min(right.hi) },
            Op::Max => Self { lo: self.lo.max(right.lo), hi: self.hi.max(right.hi) },
            _ => Self::UNDEFINED,
        }
    }
}

/// Variables whose slopes are followed.
pub(super) const SLOPED: usize = 2;

/// A range of values and the ranges of their slopes along the first variables.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sloped {
    pub value: Range,
    pub slopes: [Range; SLOPED],
}

impl Sloped {
    /// A variable within limits.
    pub fn variable(number: usize, limits: Range) -> Self {
        let slopes = std::array::from_fn(|k| Range::point(f64::from(u8::from(k == number))));
        Self { value: limits, slopes }
    }

    /// Chain rule: a function of it with such values and slopes.
    fn chain(self, value: Range, slope: Range) -> Self {
        Self { value, slopes: self.slopes.map(|own| slope.times(own)) }
    }

    fn with(self, other: Self, value: Range, slope: impl Fn(Range, Range) -> Range) -> Self {
        Self { value, slopes: std::array::from_fn(|k| slope(self.slopes[k], other.slopes[k])) }
    }

    fn times(self, other: Self) -> Self {
        self.with(other, self.value.times(other.value), |a, b| a.times(other.value).plus(b.times(self.value)))
    }

    fn is_constant(self) -> bool {
        self.value.is_point() && self.slopes == [Range::ZERO; SLOPED]
    }
}

impl Scalar for Sloped {
    fn constant(value: f64) -> Self {
        Self { value: Range::point(value), slopes: [Range::ZERO; SLOPED] }
    }

    fn unary(self, op: Op) -> Self {
        let value = self.value.unary(op);
        match op {
            Op::Negate => self.chain(value, Range::point(-1.0)),
            Op::IntegerPower(0) => Self::constant(1.0),
            Op::IntegerPower(n) => self.chain(value, self.value.integer_power(n.saturating_sub(1)).by(f64::from(n))),
            Op::Call(function) => self.chain(value, self.value.slopes(function)),
            _ => Self::constant(f64::NAN),
        }
    }

    fn binary(self, right: Self, op: Op) -> Self {
        let value = self.value.binary(right.value, op);
        match op {
            Op::Add => self.with(right, value, Range::plus),
            Op::Subtract => self.with(right, value, Range::minus),
            Op::Multiply => self.times(right),
            Op::Divide => {
                let inverse = right.value.reciprocal();
                self.with(right, value, |a, b| a.minus(value.times(b)).times(inverse))
            }
            Op::Power if right.is_constant() => {
                let p = right.value.lo;
                let slope = if p == 0.0 { Range::ZERO } else { self.value.power(Range::point(p - 1.0)).by(p) };
                self.chain(value, slope)
            }
            Op::Power => {
                // a^b = exp(b ln a)
                let exponent = right.times(self.unary(Op::Call(Function::Ln)));
                exponent.chain(value, value)
            }
            Op::Atan2 => {
                let (y, x) = (self.value, right.value);
                if x.lo <= 0.0 && y.lo <= 0.0 && y.hi >= 0.0 {
                    // It jumps where y changes its sign.
                    return Self { value, slopes: [Range::ALL; SLOPED] };
                }
                let inverse = x.integer_power(2).plus(y.integer_power(2)).reciprocal();
                self.with(right, value, |of_y, of_x| x.times(of_y).minus(y.times(of_x)).times(inverse))
            }
            Op::Min | Op::Max => {
                let [less, more] = if op == Op::Min { [self, right] } else { [right, self] };
                if less.value.hi <= more.value.lo {
                    return self; // of the minimum the left one, of the maximum too
                }
                if more.value.hi <= less.value.lo {
                    return right;
                }
                self.with(right, value, Range::hull)
            }
            _ => Self::constant(f64::NAN),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::Expression;
    use proptest::prelude::*;

    /// Every operation and function, with arguments that lie out of their domains in part.
    const FORMULAS: [&str; 22] = [
        "x + y - x*y",
        "-x/(y + 0.3)",
        "x^2 - 2*x*y + y^3",
        "1/x^2 + 2/y^-3",
        "(x - y)^-1",
        "abs(x)^1.7 + abs(y)^-0.3",
        "abs(x)^y",
        "(x^2 + 1)^(x*y)",
        "sin(3*x)*cos(2*y)",
        "sin(40*x + y^2)",
        "tan(x + y)",
        "asin(x) + acos(y/2)",
        "atan(x*y) + atan2(x, y)",
        "atan2(y, x^2 + 0.1)",
        "sinh(x) - cosh(y) + tanh(x*y)",
        "exp(-(x^2 + y^2)/0.01)",
        "ln(x) + log10(y + 1)",
        "sqrt(x - y) + cbrt(x)",
        "abs(x - 0.2)*sign(y)",
        "floor(3*x) - ceil(y)",
        "min(x, y^2) + max(x, y, 0.3)",
        "0.02 + 0.1*sqrt((x - 0.3)^2 + (y + 0.1)^2)",
    ];

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]
        #[test]
        fn no_value_is_below_the_bound(
            formula in 0..FORMULAS.len(),
            from in prop::array::uniform2(-2.0..2.0f64),
            width in prop::array::uniform2((-4.0..0.5f64).prop_map(|e| 10f64.powf(e))),
            places in prop::collection::vec(prop::array::uniform2(0.0..=1.0f64), 30),
        ) {
            let f = Expression::parse(FORMULAS[formula], &["x", "y"]).expect("a formula");
            let limits = [0, 1].map(|d| [from[d], from[d] + width[d]]);
            let (plain, sharp) = (f.lower_bound(&limits, f64::NEG_INFINITY), f.lower_bound(&limits, f64::INFINITY));
            prop_assert!(sharp >= plain || plain.is_nan(), "{} {}", plain, sharp);
            for place in places {
                let value = f.eval(&[0, 1].map(|d| from[d] + place[d] * width[d]));
                let slack = 1e-9 * (1.0 + value.abs()); // rounding, in sums of larger terms
                prop_assert!(value.is_nan() || sharp <= value + slack, "{}: {} below {}", FORMULAS[formula], value, sharp);
            }
        }
    }

    #[test]
    fn bounds_tend_to_the_least_value_with_the_square_of_the_width() {
        let f =
            Expression::parse("exp(sin(x*y) - x) + x^2*y - atan2(y, x)/sqrt(1 + x)", &["x", "y"]).expect("a formula");
        let excess = |width: f64| {
            let limits = [[0.7, 0.7 + width], [0.4, 0.4 + width]];
            let places = (0..=100).flat_map(|i| (0..=100).map(move |j| [i, j].map(|k| f64::from(k) / 100.0)));
            let least = places.map(|[s, t]| f.eval(&[0.7 + s * width, 0.4 + t * width])).fold(f64::INFINITY, f64::min);
            least - f.lower_bound(&limits, f64::INFINITY)
        };
        let [coarse, fine] = [0.1, 0.01].map(excess);
        assert!(fine >= 0.0 && fine < 0.02 * coarse, "{coarse} {fine}"); // 1/100 but for higher orders
    }

    #[test]
    fn what_is_not_defined_has_no_bound() {
        let bound = |text: &str| {
            Expression::parse(text, &["x", "y"]).expect("a formula").lower_bound(&[[1.0, 2.0], [-1.0, 1.0]], 0.0)
        };
        assert!(bound("sqrt(-x)").is_nan());
        assert_eq!(bound("1/y"), f64::NEG_INFINITY);
        assert_eq!(bound("sqrt(y)"), 0.0);
        assert!(bound("x/0*0").is_nan() || bound("x/0*0") <= 0.0);
    }
}
