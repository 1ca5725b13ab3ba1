//! Running a program on numbers, or on numbers with their first two derivatives.

use super::MAX_FORMULA_NESTING;
use super::compile::{Function, Op, Program};

/// Values a formula of ordinary size keeps at a time: its stack costs nothing to set up.
const SMALL_STACK: usize = 12;

/// Values that any formula keeps at a time.
///
/// Each level of nesting leaves at most four values waiting (as `atan2(a, b + c*d^(…` does), and the innermost one has
/// four of its own.
const FULL_STACK: usize = 4 * (MAX_FORMULA_NESTING + 2);

/// Value of a formula and its first and second derivative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jet {
    /// The value.
    pub value: f64,
    /// The first derivative.
    pub d1: f64,
    /// The second derivative.
    pub d2: f64,
}

impl Jet {
    /// The variable itself: slope 1.
    pub(super) fn variable(value: f64) -> Self {
        Self { value, d1: 1.0, d2: 0.0 }
    }

    /// Chain rule: `self` is the argument, `f` the function's value and its two derivatives there.
    fn chain(self, [value, f1, f2]: [f64; 3]) -> Self {
        let d1 = product(f1, self.d1);
        let d2 = product(f2, self.d1 * self.d1) + product(f1, self.d2);
        Self { value, d1, d2 }
    }

    /// `self^p` for a constant `p`.
    fn constant_power(self, value: f64, p: f64, power: impl Fn(f64, f64) -> f64) -> Self {
        let u = self.value;
        let f1 = if p == 0.0 { 0.0 } else { p * power(u, p - 1.0) };
        let f2 = if p == 0.0 || p == 1.0 { 0.0 } else { p * (p - 1.0) * power(u, p - 2.0) };
        self.chain([value, f1, f2])
    }
}

/// `a·b`, where a vanishing factor wins over an infinite one: the constant inside `sqrt(0*x)` has no slope.
pub(super) fn product(a: f64, b: f64) -> f64 {
    if a == 0.0 || b == 0.0 { 0.0 } else { a * b }
}

/// What a program can run on.
pub(super) trait Scalar: Copy {
    fn constant(value: f64) -> Self;
    fn unary(self, op: Op) -> Self;
    fn binary(self, right: Self, op: Op) -> Self;
}

impl Program {
    /// Runs the program; `variable` gives the values of the variables by number.
    #[inline]
    pub(super) fn run<S: Scalar>(&self, variable: impl Fn(usize) -> S) -> S {
        if self.height <= SMALL_STACK {
            self.run_on::<S, SMALL_STACK>(variable)
        } else {
            self.run_on::<S, FULL_STACK>(variable)
        }
    }

    #[inline]
    fn run_on<S: Scalar, const N: usize>(&self, variable: impl Fn(usize) -> S) -> S {
        let undefined = S::constant(f64::NAN);
        if self.height > N {
            return undefined;
        }
        let mut stack = [undefined; N];
        let mut top = 0; // number of values on the stack
        for &op in &self.ops {
            match op {
                Op::Constant(value) => {
                    stack[top] = S::constant(value);
                    top += 1;
                }
                Op::Variable(number) => {
                    stack[top] = variable(number);
                    top += 1;
                }
                Op::Negate | Op::IntegerPower(_) | Op::Call(_) => stack[top - 1] = stack[top - 1].unary(op),
                _ => {
                    top -= 1;
                    stack[top - 1] = stack[top - 1].binary(stack[top], op);
                }
            }
        }
        stack[0]
    }
}

impl Scalar for f64 {
    #[inline]
    fn constant(value: f64) -> Self {
        value
    }

    #[inline]
    fn unary(self, op: Op) -> Self {
        match op {
            Op::Negate => -self,
            Op::IntegerPower(exponent) => integer_power(self, exponent),
            Op::Call(function) => call(function, self),
            _ => f64::NAN,
        }
    }

    #[inline]
    fn binary(self, right: Self, op: Op) -> Self {
        match op {
            Op::Add => self + right,
            Op::Subtract => self - right,
            Op::Multiply => self * right,
            Op::Divide => self / right,
            Op::Power => self.powf(right),
            Op::Atan2 => self.atan2(right),
            Op::Min => picked(self, right, self <= right),
            Op::Max => picked(self, right, self >= right),
            _ => f64::NAN,
        }
    }
}

/// One of two values; NaN where either is, so that an undefined value is not hidden.
#[inline]
fn picked(left: f64, right: f64, left_it_is: bool) -> f64 {
    if left.is_nan() || right.is_nan() {
        f64::NAN
    } else if left_it_is {
        left
    } else {
        right
    }
}

#[inline]
fn call(function: Function, u: f64) -> f64 {
    match function {
        Function::Sin => u.sin(),
        Function::Cos => u.cos(),
        Function::Tan => u.tan(),
        Function::Asin => u.asin(),
        Function::Acos => u.acos(),
        Function::Atan => u.atan(),
        Function::Sinh => u.sinh(),
        Function::Cosh => u.cosh(),
        Function::Tanh => u.tanh(),
        Function::Exp => u.exp(),
        Function::Ln => u.ln(),
        Function::Log10 => u.log10(),
        Function::Sqrt => u.sqrt(),
        Function::Cbrt => u.cbrt(),
        Function::Abs => u.abs(),
        Function::Sign => sign(u),
        Function::Floor => u.floor(),
        Function::Ceil => u.ceil(),
    }
}

/// −1, 0 or 1; NaN of NaN.
fn sign(u: f64) -> f64 {
    if u == 0.0 { 0.0 } else { u.signum() }
}

/// `x^n` by repeated squaring: exact for `x^2`, and the same on every platform.
#[inline]
fn integer_power(x: f64, n: i32) -> f64 {
    let (mut power, mut square, mut rest) = (1.0, x, n.unsigned_abs());
    while rest > 0 {
        if rest & 1 == 1 {
            power *= square;
        }
        square *= square;
        rest >>= 1;
    }
    if n < 0 { 1.0 / power } else { power }
}

impl Scalar for Jet {
    fn constant(value: f64) -> Self {
        Self { value, d1: 0.0, d2: 0.0 }
    }

    fn unary(self, op: Op) -> Self {
        match op {
            Op::Negate => Self { value: -self.value, d1: -self.d1, d2: -self.d2 },
            Op::IntegerPower(n) => {
                self.constant_power(integer_power(self.value, n), f64::from(n), |u, p| integer_power(u, p as i32))
            }
            Op::Call(function) => self.chain(derivatives(function, self.value)),
            _ => Self::constant(f64::NAN),
        }
    }

    fn binary(self, right: Self, op: Op) -> Self {
        let (a, b) = (self, right);
        match op {
            Op::Add => Self { value: a.value + b.value, d1: a.d1 + b.d1, d2: a.d2 + b.d2 },
            Op::Subtract => Self { value: a.value - b.value, d1: a.d1 - b.d1, d2: a.d2 - b.d2 },
            Op::Multiply => times(a, b),
            Op::Divide => {
                let value = a.value / b.value;
                let d1 = (a.d1 - product(value, b.d1)) / b.value;
                let d2 = (a.d2 - 2.0 * product(d1, b.d1) - product(value, b.d2)) / b.value;
                Self { value, d1, d2 }
            }
            Op::Power if b.d1 == 0.0 && b.d2 == 0.0 => a.constant_power(a.value.powf(b.value), b.value, f64::powf),
            Op::Power => {
                // a^b = exp(b ln a)
                let exponent = times(b, a.unary(Op::Call(Function::Ln)));
                let value = a.value.powf(b.value);
                let d1 = product(value, exponent.d1);
                Self { value, d1, d2: product(d1, exponent.d1) + product(value, exponent.d2) }
            }
            Op::Atan2 => {
                let (y, x) = (a, b);
                let square = x.value * x.value + y.value * y.value;
                let d1 = (product(x.value, y.d1) - product(y.value, x.d1)) / square;
                let growth = 2.0 * (product(x.value, x.d1) + product(y.value, y.d1));
                let d2 = (product(x.value, y.d2) - product(y.value, x.d2) - product(d1, growth)) / square;
                Self { value: y.value.atan2(x.value), d1, d2 }
            }
            Op::Min | Op::Max => {
                let value = a.value.binary(b.value, op);
                let branch = if value == a.value { a } else { b };
                Self { value, ..branch }
            }
            _ => Self::constant(f64::NAN),
        }
    }
}

fn times(a: Jet, b: Jet) -> Jet {
    Jet {
        value: a.value * b.value,
        d1: product(a.d1, b.value) + product(a.value, b.d1),
        d2: product(a.d2, b.value) + 2.0 * product(a.d1, b.d1) + product(a.value, b.d2),
    }
}

/// Value, first and second derivative of a function at `u`.
fn derivatives(function: Function, u: f64) -> [f64; 3] {
    let value = call(function, u);
    let [d1, d2] = match function {
        Function::Sin => [u.cos(), -value],
        Function::Cos => [-u.sin(), -value],
        Function::Tan => [1.0 + value * value, 2.0 * value * (1.0 + value * value)],
        Function::Asin => arc_sine_slopes(u),
        Function::Acos => arc_sine_slopes(u).map(|slope| -slope),
        Function::Atan => {
            let slope = 1.0 / (1.0 + u * u);
            [slope, -2.0 * u * slope * slope]
        }
        Function::Sinh => [u.cosh(), value],
        Function::Cosh => [u.sinh(), value],
        Function::Tanh => [1.0 - value * value, -2.0 * value * (1.0 - value * value)],
        Function::Exp => [value, value],
        Function::Ln => [1.0 / u, -1.0 / (u * u)],
        Function::Log10 => [1.0, -1.0 / u].map(|slope| slope / (u * std::f64::consts::LN_10)),
        Function::Sqrt => [0.5 / value, -0.25 / (value * value * value)],
        Function::Cbrt => [1.0 / (3.0 * value * value), -2.0 / (9.0 * value.powi(5))],
        Function::Abs => [sign(u), 0.0],
        Function::Sign | Function::Floor | Function::Ceil => [0.0, 0.0],
    };
    [value, d1, d2]
}

fn arc_sine_slopes(u: f64) -> [f64; 2] {
    let square = (1.0 - u) * (1.0 + u);
    [1.0 / square.sqrt(), u / (square * square.sqrt())]
}

#[cfg(test)]
mod tests {
    use super::super::{Expression, MAX_FORMULA_NESTING};
    use super::*;

    #[test]
    fn the_deepest_formula_fits_on_the_stack() {
        let unit = "atan2(x, x+x*x^";
        let calls = MAX_FORMULA_NESTING;
        let text = format!("{}{}{}", unit.repeat(calls), "x", ")".repeat(calls));
        let deepest = Expression::parse(&text, &["x"]).unwrap();
        assert!(deepest.program.height > SMALL_STACK && deepest.program.height <= FULL_STACK);
        assert!(deepest.at(0.5).is_finite());
    }

    #[test]
    fn a_square_is_exact() {
        assert_eq!(Expression::parse("x^2", &["x"]).unwrap().at(0.1), 0.1 * 0.1);
        assert_eq!(integer_power(3.0, 0), 1.0);
        assert_eq!(integer_power(2.0, -3), 0.125);
        assert_eq!(integer_power(-3.0, 3), -27.0);
    }
}
