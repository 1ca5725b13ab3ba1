//! Text to program: an operator-precedence (Pratt) parser that points at what it does not understand.

use super::compile::{Compiler, Op, Program};
use super::error::ExpressionError;
use super::names::{self, Callee};
use super::{MAX_FORMULA_BYTES, MAX_FORMULA_NESTING};

/// How tightly operators bind; a sign lies between a product and a power.
const SUM: u8 = 1;
const PRODUCT: u8 = 2;
const POWER: u8 = 3;

/// Longest piece of the text that a message repeats, in characters.
const EXCERPT: usize = 32;

type Parsed<T> = Result<T, ExpressionError>;

#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Number(f64),
    Name,
    Plus,
    Minus,
    Times,
    Over,
    Power,
    Open,
    Close,
    Comma,
    End,
}

#[derive(Clone, Copy, Debug)]
struct Token {
    kind: Kind,
    at: usize,
    end: usize,
}

/// Compiles `text`; see [`super::Expression::parse`].
pub(super) fn parse(text: &str, variables: &[&str]) -> Parsed<Program> {
    if text.len() > MAX_FORMULA_BYTES {
        let at = (0..=MAX_FORMULA_BYTES).rev().find(|at| text.is_char_boundary(*at)).unwrap_or(0);
        return Err(ExpressionError::TooLong { at, bytes: text.len(), most: MAX_FORMULA_BYTES });
    }
    if text.trim().is_empty() {
        return Err(ExpressionError::Empty { at: 0 });
    }
    let token = scan(text, 0)?;
    let mut parser =
        Parser { text, variables, token, value_at: 0, value_end: 0, nesting: 0, compiler: Compiler::default() };
    parser.formula(SUM)?;
    let at = parser.token.at;
    match parser.token.kind {
        Kind::End => Ok(parser.compiler.finish()),
        Kind::Comma => Err(ExpressionError::StrayComma { at }),
        _ => Err(ExpressionError::Unopened { at }),
    }
}

struct Parser<'a> {
    text: &'a str,
    variables: &'a [&'a str],
    token: Token,
    /// Where the value read last begins and ends, for the correction of a juxtaposition.
    value_at: usize,
    value_end: usize,
    nesting: usize,
    compiler: Compiler,
}

impl Parser<'_> {
    fn advance(&mut self) -> Parsed<()> {
        self.token = scan(self.text, self.token.end)?;
        Ok(())
    }

    /// One level deeper, at the current token.
    fn enter(&mut self) -> Parsed<()> {
        self.nesting += 1;
        if self.nesting > MAX_FORMULA_NESTING {
            return Err(ExpressionError::TooDeep { at: self.token.at, most: MAX_FORMULA_NESTING });
        }
        Ok(())
    }

    /// A value and all that follows it of operators that bind at least as tightly as `least`.
    fn formula(&mut self, least: u8) -> Parsed<()> {
        self.signed()?;
        loop {
            let (level, op) = match self.token.kind {
                Kind::Plus => (SUM, Op::Add),
                Kind::Minus => (SUM, Op::Subtract),
                Kind::Times => (PRODUCT, Op::Multiply),
                Kind::Over => (PRODUCT, Op::Divide),
                Kind::Power => (POWER, Op::Power),
                Kind::Number(_) | Kind::Name | Kind::Open => return Err(self.juxtaposition()),
                Kind::Close | Kind::Comma | Kind::End => return Ok(()),
            };
            if level < least {
                return Ok(());
            }
            self.advance()?;
            // A power takes one value with its signs, everything else what binds more tightly than itself: both from
            // left to right.
            if op == Op::Power {
                self.exponent()?
            } else {
                self.formula(level + 1)?
            }
            self.compiler.push(op);
        }
    }

    /// A value, or a sign and the powers it applies to: `-x^2` is `-(x^2)`.
    fn signed(&mut self) -> Parsed<()> {
        self.sign_then(|parser| parser.formula(POWER))
    }

    /// What follows `^`: signs and one value, so that `2^-1^2` is `(2^-1)^2`.
    fn exponent(&mut self) -> Parsed<()> {
        self.sign_then(Self::exponent)
    }

    fn sign_then(&mut self, operand: impl FnOnce(&mut Self) -> Parsed<()>) -> Parsed<()> {
        let negative = match self.token.kind {
            Kind::Minus => true,
            Kind::Plus => false,
            _ => return self.value(),
        };
        self.enter()?;
        self.advance()?;
        operand(self)?;
        self.nesting -= 1;
        if negative {
            self.compiler.push(Op::Negate);
        }
        Ok(())
    }

    /// A number, a name, a call, or a formula in parentheses.
    fn value(&mut self) -> Parsed<()> {
        let Token { kind, at, end } = self.token;
        match kind {
            Kind::Number(value) => {
                self.compiler.push(Op::Constant(value));
                self.value_end = end;
                self.advance()?;
            }
            Kind::Name => self.name()?,
            Kind::Open => {
                self.enter()?;
                self.advance()?;
                self.formula(SUM)?;
                self.close(at)?;
            }
            _ => {
                let found =
                    if kind == Kind::End { "the end".into() } else { format!("`{}`", excerpt(self.text, at, end)) };
                return Err(ExpressionError::MissingValue { at, found });
            }
        }
        self.value_at = at;
        Ok(())
    }

    /// The parenthesis that closes the one at `open`.
    fn close(&mut self, open: usize) -> Parsed<()> {
        match self.token.kind {
            Kind::Close => {
                self.nesting -= 1;
                self.value_end = self.token.end;
                self.advance()
            }
            Kind::Comma => Err(ExpressionError::StrayComma { at: self.token.at }),
            _ => Err(ExpressionError::Unclosed { at: open }),
        }
    }

    fn name(&mut self) -> Parsed<()> {
        let Token { at, end, .. } = self.token;
        let name = &self.text[at..end];
        let plain = match self.variables.iter().position(|variable| *variable == name) {
            Some(number) => Some(Op::Variable(number)),
            None => names::constant(name).map(Op::Constant),
        };
        if let Some(op) = plain {
            self.compiler.push(op);
            self.value_end = end;
            return self.advance();
        }
        let Some((function, callee)) = names::function(name) else {
            let hint = names::hint(name, self.variables);
            let known = names::known(self.variables);
            return Err(ExpressionError::UnknownName { at, name: excerpt(self.text, at, end), hint, known });
        };
        self.advance()?;
        if self.token.kind != Kind::Open {
            let argument = match self.token.kind {
                Kind::Number(_) | Kind::Name => excerpt(self.text, self.token.at, self.value_ahead()),
                _ => self.variables.first().unwrap_or(&"1").to_string(),
            };
            let corrected = format!("{function}({argument})");
            return Err(ExpressionError::MissingParentheses { at, function, corrected });
        }
        self.call(at, function, callee)
    }

    /// The arguments of a function, from the opening parenthesis to the closing one.
    fn call(&mut self, at: usize, function: &'static str, callee: Callee) -> Parsed<()> {
        let open = self.token.at;
        self.enter()?;
        self.advance()?;
        let mut found = 0;
        if self.token.kind != Kind::Close {
            loop {
                self.formula(SUM)?;
                found += 1;
                match callee {
                    Callee::Many(op) if found > 1 => self.compiler.push(op),
                    _ => {}
                }
                if self.token.kind != Kind::Comma {
                    break;
                }
                self.advance()?;
            }
        }
        self.close(open)?;
        let variable = self.variables.first().unwrap_or(&"1");
        let wrong = |expected: &'static str, example: String| ExpressionError::ArgumentCount {
            at,
            function,
            expected,
            found,
            example,
        };
        match callee {
            Callee::One(one) if found == 1 => self.compiler.push(Op::Call(one)),
            Callee::Two(op) if found == 2 => self.compiler.push(op),
            Callee::Many(_) if found >= 2 => {}
            Callee::One(_) => return Err(wrong("one argument", format!("{function}({variable})"))),
            Callee::Two(_) => return Err(wrong("two arguments", format!("{function}({variable}, 1)"))),
            Callee::Many(_) => return Err(wrong("two or more arguments", format!("{function}({variable}, 1)"))),
        }
        Ok(())
    }

    fn juxtaposition(&self) -> ExpressionError {
        let at = self.token.at;
        let left = excerpt(self.text, self.value_at, self.value_end);
        let right = excerpt(self.text, at, self.value_ahead());
        ExpressionError::Juxtaposition { at, corrected: format!("{left}*{right}") }
    }

    /// End of the value that begins at the current token: of a number or name, and of the parentheses after it.
    fn value_ahead(&self) -> usize {
        let Token { kind, at, end } = self.token;
        let rest = &self.text[end..];
        let blanks = rest.len() - rest.trim_start().len();
        let open = match kind {
            Kind::Open => at,
            Kind::Name if rest[blanks..].starts_with('(') => end + blanks,
            _ => return end,
        };
        let mut depth = 0_usize;
        for (offset, byte) in self.text.bytes().enumerate().skip(open) {
            match byte {
                b'(' => depth += 1,
                b')' => depth -= 1,
                _ => {}
            }
            if depth == 0 {
                return offset + 1;
            }
        }
        self.text.len()
    }
}

/// `text[from..to]`, shortened in the middle where it is long.
fn excerpt(text: &str, from: usize, to: usize) -> String {
    let piece = text.get(from..to).unwrap_or_default();
    let length = piece.chars().count();
    if length <= EXCERPT {
        return piece.to_string();
    }
    let head = piece.chars().take(EXCERPT / 2);
    let tail = piece.chars().skip(length - EXCERPT / 2);
    head.chain(['…']).chain(tail).collect()
}

/// The token at or after `from`, blanks skipped.
fn scan(text: &str, from: usize) -> Parsed<Token> {
    let bytes = text.as_bytes();
    let byte = |i: usize| bytes.get(i).copied().unwrap_or(0);
    let mut at = from;
    while byte(at).is_ascii_whitespace() {
        at += 1;
    }
    let first = byte(at);
    let one = |kind: Kind| Ok(Token { kind, at, end: at + 1 });
    if at >= bytes.len() {
        // Point behind the last character that is not blank.
        let end = text.trim_end().len();
        return Ok(Token { kind: Kind::End, at: end, end: bytes.len() });
    }
    if first == b'.' && matches!(byte(at + 1), b'*' | b'/' | b'^') {
        let operator = scan(text, at + 1)?;
        return Ok(Token { at, ..operator });
    }
    if first.is_ascii_digit() || (first == b'.' && byte(at + 1).is_ascii_digit()) {
        return number(text, at);
    }
    if first.is_ascii_alphabetic() || first == b'_' {
        let length = bytes[at..].iter().take_while(|b| b.is_ascii_alphanumeric() || **b == b'_').count();
        return Ok(Token { kind: Kind::Name, at, end: at + length });
    }
    match first {
        b'*' if byte(at + 1) == b'*' => {
            Err(ExpressionError::Foreign { at, found: "**".into(), remedy: "write a power with `^`" })
        }
        b'+' => one(Kind::Plus),
        b'-' => one(Kind::Minus),
        b'*' => one(Kind::Times),
        b'/' => one(Kind::Over),
        b'^' => one(Kind::Power),
        b'(' => one(Kind::Open),
        b')' => one(Kind::Close),
        b',' => one(Kind::Comma),
        _ => Err(foreign(text, at)),
    }
}

/// The number at `at`: digits, perhaps a point and digits, perhaps an exponent.
fn number(text: &str, at: usize) -> Parsed<Token> {
    let bytes = text.as_bytes();
    let byte = |i: usize| bytes.get(i).copied().unwrap_or(0);
    let digits = |mut i: usize| {
        while byte(i).is_ascii_digit() {
            i += 1;
        }
        i
    };
    let mut end = digits(at);
    // In `2.*x` and `2.^x` the point belongs to the operator.
    if byte(end) == b'.' && !matches!(byte(end + 1), b'*' | b'/' | b'^') {
        end = digits(end + 1);
    }
    // Without digits behind it, the `e` of `2e` is the constant, not an exponent.
    if matches!(byte(end), b'e' | b'E') {
        let first = if matches!(byte(end + 1), b'+' | b'-') { end + 2 } else { end + 1 };
        if byte(first).is_ascii_digit() {
            end = digits(first);
        }
    }
    let malformed = byte(end) == b'.' && byte(end + 1).is_ascii_digit();
    match text[at..end].parse::<f64>() {
        Ok(value) if value.is_finite() && !malformed => Ok(Token { kind: Kind::Number(value), at, end }),
        _ => {
            let end = if malformed { digits(end + 1) } else { end };
            Err(ExpressionError::Number { at, text: excerpt(text, at, end) })
        }
    }
}

/// The error for a character that has no meaning, with what its author may have meant.
fn foreign(text: &str, at: usize) -> ExpressionError {
    let found = text[at..].chars().next().unwrap_or(char::REPLACEMENT_CHARACTER);
    let remedy = match found {
        '×' | '·' | '⋅' | '∗' => "write a product with `*`",
        '÷' | '∕' | ':' => "write a quotient with `/`",
        '−' | '–' | '—' => "write minus as `-`",
        '²' => "write `^2`",
        '³' => "write `^3`",
        'π' => "write `pi`",
        '√' => "write a root as `sqrt(x)`",
        '[' | ']' | '{' | '}' => "group with parentheses `( )`",
        '|' => "write an absolute value as `abs(x)`",
        '=' | '<' | '>' => "write only the formula, without a comparison or a left-hand side",
        '.' => "a decimal point needs a digit, as in `0.5`",
        ';' => "remove it",
        _ => "use numbers, variables, functions, parentheses and + - * / ^",
    };
    ExpressionError::Foreign { at, found: found.to_string(), remedy }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fault(text: &str) -> ExpressionError {
        match parse(text, &["x"]) {
            Ok(program) => panic!("{text} parsed as {program:?}"),
            Err(error) => error,
        }
    }

    #[test]
    fn a_juxtaposition_shows_the_corrected_form() {
        for (text, at, corrected) in [
            ("2x", 1, "2*x"),
            ("1 + 2 x", 6, "2*x"),
            ("2(x+1)", 1, "2*(x+1)"),
            ("(x+1)(x - 1)", 5, "(x+1)*(x - 1)"),
            ("x sin(x)^2", 2, "x*sin(x)"),
            ("sin(x)cos(x)", 6, "sin(x)*cos(x)"),
            ("2e", 1, "2*e"),
            ("1e+x", 1, "1*e"),
            ("2pi", 1, "2*pi"),
            ("x 2", 2, "x*2"),
            ("x(2)", 1, "x*(2)"),
            ("2 (x", 2, "2*(x"),
        ] {
            let expected = ExpressionError::Juxtaposition { at, corrected: corrected.into() };
            assert_eq!(fault(text), expected, "{text}");
        }
    }

    #[test]
    fn a_function_without_parentheses_shows_the_corrected_form() {
        for (text, corrected) in [
            ("sin x", "sin(x)"),
            ("sin", "sin(x)"),
            ("sin^2", "sin(x)"),
            ("sin 2", "sin(2)"),
            ("sqrt cos(x)", "sqrt(cos(x))"),
        ] {
            match fault(text) {
                ExpressionError::MissingParentheses { at: 0, corrected: found, .. } => assert_eq!(found, corrected),
                other => panic!("{text}: {other:?}"),
            }
        }
    }

    #[test]
    fn every_fault_points_at_its_character() {
        for (text, at, part) in [
            ("", 0, "empty"),
            (" \t\n", 0, "empty"),
            ("1 + flor(x)", 4, "did you mean `floor`"),
            ("1 + zeta", 4, "known are x, pi, e, sin"),
            ("1 +", 3, "before the end"),
            ("1 + ", 3, "before the end"),
            ("* x", 0, "before `*`"),
            ("x .* .^ 2", 5, "before `.^`"),
            ("x + ()", 5, "before `)`"),
            ("(x + 1", 0, "never closed"),
            ("sin(x + 1", 3, "never closed"),
            ("x + 1)", 5, "never opened"),
            ("0,5*x", 1, "comma"),
            ("(1, 2)", 2, "comma"),
            ("sin(x, 1)", 0, "takes one argument, here it has 2"),
            ("2 + sin()", 4, "takes one argument, here it has 0"),
            ("atan2(x)", 0, "write `atan2(x, 1)`"),
            ("min(x)", 0, "two or more arguments"),
            ("min(x,)", 6, "before `)`"),
            ("x**2", 1, "`^`"),
            ("x × 2", 2, "`*`"),
            ("x²", 1, "`^2`"),
            ("2 − x", 2, "`-`"),
            ("y = x", 0, "known are"),
            ("x = 2", 2, "left-hand side"),
            ("1.2.3", 0, "`1.2.3`"),
            ("1e999", 0, "1.8e308"),
            ("x + .", 4, "digit"),
        ] {
            let error = fault(text);
            assert_eq!(error.at(), at, "{text}: {error}");
            assert!(error.to_string().contains(part), "{text}: {error}");
        }
    }

    #[test]
    fn hostile_formulas_end_quickly_in_an_error() {
        assert!(matches!(fault(&"(".repeat(10_000)), ExpressionError::TooLong { at: 4096, .. }));
        assert!(matches!(fault(&"(".repeat(4096)), ExpressionError::TooDeep { at: 64, .. }));
        assert!(matches!(fault(&"-".repeat(4096)), ExpressionError::TooDeep { at: 64, .. }));
        assert!(matches!(fault(&format!("2{}", "^-".repeat(2047))), ExpressionError::MissingValue { .. }));
        assert!(matches!(fault(&format!("2^{}", "-".repeat(4000))), ExpressionError::TooDeep { .. }));
        assert!(matches!(fault(&"sin(".repeat(1000)), ExpressionError::TooDeep { at: 259, .. }));
        assert!(matches!(fault(&"a".repeat(4096)), ExpressionError::UnknownName { .. }));
        assert!(matches!(fault(&format!("2({}", "x".repeat(4000))), ExpressionError::Juxtaposition { .. }));
    }

    #[test]
    fn nesting_up_to_the_limit_is_accepted() {
        assert!(parse(&format!("{}x{}", "(".repeat(64), ")".repeat(64)), &["x"]).is_ok());
        assert!(parse(&format!("{}x", "-".repeat(64)), &["x"]).is_ok());
        assert!(parse(&format!("x{}", "^x".repeat(2000)), &["x"]).is_ok());
        assert!(parse(&format!("x{}", "+(-x)".repeat(800)), &["x"]).is_ok());
    }
}
