//! The flat postfix program a formula is compiled to.

use super::eval::Scalar;

/// Greatest integer exponent that is a chain of multiplications.
///
/// `x^n` by squaring is off by up to n/2 units in the last place: negligible to 16, and ten times faster than `powf`.
const MAX_CHAIN_EXPONENT: f64 = 16.0;

/// A function of one argument.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Function {
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Sinh,
    Cosh,
    Tanh,
    Exp,
    Ln,
    Log10,
    Sqrt,
    Cbrt,
    Abs,
    Sign,
    Floor,
    Ceil,
}

/// One step of a program: takes its operands from the top of the stack and leaves its value there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Op {
    Constant(f64),
    Variable(usize),
    Negate,
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
    IntegerPower(i32),
    Call(Function),
    Atan2,
    Min,
    Max,
}

impl Op {
    /// How many values it takes from the stack; all leave one.
    pub(super) fn operands(self) -> usize {
        match self {
            Self::Constant(_) | Self::Variable(_) => 0,
            Self::Negate | Self::IntegerPower(_) | Self::Call(_) => 1,
            Self::Add | Self::Subtract | Self::Multiply | Self::Divide | Self::Power => 2,
            Self::Atan2 | Self::Min | Self::Max => 2,
        }
    }
}

/// A formula in postfix order, with the height of the stack that its evaluation needs.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Program {
    pub(super) ops: Vec<Op>,
    pub(super) height: usize,
}

/// Takes the steps in postfix order and evaluates what is constant at once.
#[derive(Debug, Default)]
pub(super) struct Compiler {
    ops: Vec<Op>,
}

impl Compiler {
    /// Appends a step whose operands have been appended before.
    ///
    /// In postfix order, a step that follows a constant has that constant, alone, as its last operand.
    pub(super) fn push(&mut self, op: Op) {
        let constant = |op: Option<&Op>| match op {
            Some(Op::Constant(value)) => Some(*value),
            _ => None,
        };
        let n = self.ops.len();
        let last = constant(n.checked_sub(1).and_then(|i| self.ops.get(i)));
        let before = constant(n.checked_sub(2).and_then(|i| self.ops.get(i)));
        match (op.operands(), before, last) {
            (1, _, Some(value)) => {
                self.ops.truncate(n - 1);
                self.ops.push(Op::Constant(value.unary(op)));
            }
            (2, Some(left), Some(right)) => {
                self.ops.truncate(n - 2);
                let value = match chain_exponent(right) {
                    Some(exponent) if op == Op::Power => left.unary(Op::IntegerPower(exponent)),
                    _ => left.binary(right, op),
                };
                self.ops.push(Op::Constant(value));
            }
            (2, None, Some(right)) if op == Op::Power && chain_exponent(right).is_some() => {
                self.ops.truncate(n - 1);
                self.ops.extend(chain_exponent(right).map(Op::IntegerPower));
            }
            _ => self.ops.push(op),
        }
    }

    /// The finished program.
    pub(super) fn finish(self) -> Program {
        let (mut height, mut most) = (0_usize, 0_usize);
        for op in &self.ops {
            height = height.saturating_sub(op.operands()) + 1;
            most = most.max(height);
        }
        Program { ops: self.ops, height: most }
    }
}

/// The exponent as an integer, where it is one small enough for a chain of multiplications.
fn chain_exponent(exponent: f64) -> Option<i32> {
    (exponent.fract() == 0.0 && exponent.abs() <= MAX_CHAIN_EXPONENT).then_some(exponent as i32)
}

#[cfg(test)]
mod tests {
    use super::super::parse::parse;
    use super::*;

    #[test]
    fn constants_are_evaluated_once() {
        assert_eq!(parse("2*3^2 - -sqrt(4)", &[]).unwrap().ops, [Op::Constant(20.0)]);
        let program = parse("x*(1+1)", &["x"]).unwrap();
        assert_eq!(program.ops, [Op::Variable(0), Op::Constant(2.0), Op::Multiply]);
        assert_eq!(program.height, 2);
    }

    #[test]
    fn small_integer_powers_are_chains_of_multiplications() {
        assert_eq!(parse("x^-2", &["x"]).unwrap().ops, [Op::Variable(0), Op::IntegerPower(-2)]);
        assert_eq!(parse("x^0.5", &["x"]).unwrap().ops, [Op::Variable(0), Op::Constant(0.5), Op::Power]);
    }
}
