//! What can be wrong with a formula, and where.

/// A formula that cannot be understood; every variant has the byte offset `at` of the offending place in the text.
///
/// The message says what is wrong and what to write instead; showing the place is left to whoever has the text.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ExpressionError {
    /// Nothing but blanks.
    #[error("the formula is empty; write a number or a formula such as `x^2`")]
    Empty {
        /// Byte offset, 0.
        at: usize,
    },
    /// More than [`MAX_FORMULA_BYTES`](crate::MAX_FORMULA_BYTES).
    #[error("the formula has {bytes} bytes, {most} are allowed; simplify it, or split the edge into several")]
    TooLong {
        /// Byte offset of the first byte that is too many.
        at: usize,
        /// Length of the formula.
        bytes: usize,
        /// Greatest length allowed.
        most: usize,
    },
    /// More than [`MAX_FORMULA_NESTING`](crate::MAX_FORMULA_NESTING) parentheses, calls and signs within one another.
    #[error("parentheses, functions and signs are nested more than {most} deep; remove some of them")]
    TooDeep {
        /// Byte offset of the first one too deep.
        at: usize,
        /// Greatest depth allowed.
        most: usize,
    },
    /// A character that no formula has.
    #[error("`{found}` has no meaning in a formula; {remedy}")]
    Foreign {
        /// Byte offset.
        at: usize,
        /// The character, or the few that belong together.
        found: String,
        /// What to write instead.
        remedy: &'static str,
    },
    /// A number that is malformed or beyond the range of a float.
    #[error("`{text}` is not a number that can be represented; write it as in `0.5`, `12` or `1e-3`, below 1.8e308")]
    Number {
        /// Byte offset of the number.
        at: usize,
        /// The number as written.
        text: String,
    },
    /// A name that is no variable, constant or function.
    #[error("`{name}` is not known here{hint}; known are {known}")]
    UnknownName {
        /// Byte offset of the name.
        at: usize,
        /// The name as written.
        name: String,
        /// `, did you mean …?`, or nothing where no known name is close.
        hint: String,
        /// All variables, constants and functions.
        known: String,
    },
    /// Two values side by side, as in `2x`.
    #[error("an operator is missing; write `{corrected}`")]
    Juxtaposition {
        /// Byte offset of the second value.
        at: usize,
        /// Both values with the operator between.
        corrected: String,
    },
    /// A function without the parentheses around its argument, as in `sin x`.
    #[error("`{function}` is a function; write its argument in parentheses: `{corrected}`")]
    MissingParentheses {
        /// Byte offset of the function's name.
        at: usize,
        /// The function.
        function: &'static str,
        /// The call as it should be.
        corrected: String,
    },
    /// A function with too few or too many arguments.
    #[error("`{function}` takes {expected}, here it has {found}; write `{example}`")]
    ArgumentCount {
        /// Byte offset of the function's name.
        at: usize,
        /// The function.
        function: &'static str,
        /// How many it takes.
        expected: &'static str,
        /// How many were given.
        found: usize,
        /// A call as it should be.
        example: String,
    },
    /// A comma that separates no arguments.
    #[error(
        "a comma only separates the arguments of a function; write a decimal point as in `0.5`, or remove the comma"
    )]
    StrayComma {
        /// Byte offset of the comma.
        at: usize,
    },
    /// An operator, a comma or an end where a value is expected.
    #[error("a value is missing before {found}; write a number, a variable or a formula in parentheses there")]
    MissingValue {
        /// Byte offset of what was found instead.
        at: usize,
        /// What was found instead.
        found: String,
    },
    /// An opening parenthesis without its partner.
    #[error("this parenthesis is never closed; add the missing `)`")]
    Unclosed {
        /// Byte offset of the opening parenthesis.
        at: usize,
    },
    /// A closing parenthesis without its partner.
    #[error("this parenthesis was never opened; remove it, or add the missing `(`")]
    Unopened {
        /// Byte offset of the closing parenthesis.
        at: usize,
    },
}

impl ExpressionError {
    /// Byte offset in the formula's text of the place to point at; the length of the text where it ends too early.
    pub fn at(&self) -> usize {
        match *self {
            Self::Empty { at }
            | Self::TooLong { at, .. }
            | Self::TooDeep { at, .. }
            | Self::Foreign { at, .. }
            | Self::Number { at, .. }
            | Self::UnknownName { at, .. }
            | Self::Juxtaposition { at, .. }
            | Self::MissingParentheses { at, .. }
            | Self::ArgumentCount { at, .. }
            | Self::StrayComma { at }
            | Self::MissingValue { at, .. }
            | Self::Unclosed { at }
            | Self::Unopened { at } => at,
        }
    }
}
