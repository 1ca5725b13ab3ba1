//! Properties of formulas and divisions, on inputs nobody chose.

use nmt_curve::{ArcTable, Curve, Expression, ExpressionError, divide};
use proptest::prelude::*;

/// A formula as a tree, evaluated by its own rules and written with parentheses or without.
#[derive(Clone, Debug)]
enum Tree {
    Number(f64),
    X,
    Negative(Box<Tree>),
    Binary(char, Box<Tree>, Box<Tree>),
    Call(&'static str, fn(f64) -> f64, Box<Tree>),
}

impl Tree {
    fn value(&self, x: f64) -> f64 {
        match self {
            Self::Number(number) => *number,
            Self::X => x,
            Self::Negative(a) => -a.value(x),
            Self::Call(_, f, a) => f(a.value(x)),
            Self::Binary(operator, a, b) => {
                let exponent_is_constant = !b.has_x();
                let (a, b) = (a.value(x), b.value(x));
                match operator {
                    '+' => a + b,
                    '-' => a - b,
                    '*' => a * b,
                    '/' => a / b,
                    _ => power(a, b, exponent_is_constant),
                }
            }
        }
    }

    fn has_x(&self) -> bool {
        match self {
            Self::Number(_) => false,
            Self::X => true,
            Self::Negative(a) | Self::Call(_, _, a) => a.has_x(),
            Self::Binary(_, a, b) => a.has_x() || b.has_x(),
        }
    }

    /// How tightly the outermost operator binds.
    fn level(&self) -> u8 {
        match self {
            Self::Binary('+' | '-', ..) => 1,
            Self::Binary('*' | '/', ..) => 2,
            Self::Negative(_) => 3,
            Self::Binary(..) => 4,
            _ => 5,
        }
    }

    /// With only the parentheses that the rules ask for.
    fn text(&self) -> String {
        let wrapped =
            |tree: &Tree, least: u8| if tree.level() < least { format!("({})", tree.text()) } else { tree.text() };
        match self {
            Self::Number(number) => format!("{number:?}"),
            Self::X => "x".into(),
            Self::Negative(a) => format!("-{}", wrapped(a, 3)),
            Self::Call(name, _, a) => format!("{name}({})", a.text()),
            Self::Binary('^', a, b) => format!("{}.^{}", wrapped(a, 4), wrapped(b, 5)),
            Self::Binary(operator, a, b) => {
                format!("{} {operator} {}", wrapped(a, self.level()), wrapped(b, self.level() + 1))
            }
        }
    }
}

/// A small whole exponent, where it is constant, is a chain of multiplications: squares from the lowest bit on.
fn power(a: f64, b: f64, exponent_is_constant: bool) -> f64 {
    if !exponent_is_constant || b.fract() != 0.0 || b.abs() > 16.0 {
        return a.powf(b);
    }
    let squares = (0..5).scan(a, |square, _| Some(std::mem::replace(square, *square * *square)));
    let n = b.abs() as u32;
    let chain = squares.enumerate().filter(|(bit, _)| n >> bit & 1 == 1).map(|(_, square)| square).product::<f64>();
    if b < 0.0 { 1.0 / chain } else { chain }
}

/// The functions that trees are made of.
const FUNCTIONS: [Function; 6] = [
    ("sin", f64::sin),
    ("cos", f64::cos),
    ("exp", f64::exp),
    ("sqrt", f64::sqrt),
    ("abs", f64::abs),
    ("atan", f64::atan),
];

/// A name and what it computes.
type Function = (&'static str, fn(f64) -> f64);

fn tree() -> impl Strategy<Value = Tree> {
    let leaf = prop_oneof![Just(Tree::X), (0_u32..100).prop_map(|n| Tree::Number(f64::from(n) / 8.0))];
    leaf.prop_recursive(6, 40, 2, |inner| {
        let operator = prop_oneof![Just('+'), Just('-'), Just('*'), Just('/'), Just('^')];
        prop_oneof![
            3 => (operator, inner.clone(), inner.clone()).prop_map(|(o, a, b)| Tree::Binary(o, Box::new(a), Box::new(b))),
            1 => inner.clone().prop_map(|a| Tree::Negative(Box::new(a))),
            1 => (prop::sample::select(FUNCTIONS.to_vec()), inner).prop_map(|((name, f), a)| Tree::Call(name, f, Box::new(a))),
        ]
    })
}

/// An error must point into the text, at a character's beginning, and say something.
fn points_at_a_character(text: &str, error: &ExpressionError) -> bool {
    error.at() <= text.len() && text.is_char_boundary(error.at()) && error.to_string().len() < 1000
}

proptest! {
    #[test]
    fn any_text_parses_or_points_at_a_character(text in any::<String>()) {
        if let Err(error) = Expression::parse(&text, &["x"]) {
            prop_assert!(points_at_a_character(&text, &error), "{error:?}");
        }
    }

    #[test]
    fn formula_like_text_parses_or_points_at_a_character(text in "(([0-9]{1,2}|x|pi|e|sin|min|atan2|foo)?[-+*/^.,() ]?){0,40}") {
        match Expression::parse(&text, &["x"]) {
            Ok(formula) => {
                // A derivative exists wherever there is a value; neither panics.
                let jet = formula.jet(0.7);
                let value = formula.at(0.7);
                prop_assert!(jet.value == value || (jet.value.is_nan() && value.is_nan()), "{} and {value}", jet.value);
            }
            Err(error) => prop_assert!(points_at_a_character(&text, &error), "{error:?}"),
        }
    }

    #[test]
    fn values_agree_with_the_tree(tree in tree(), x in -3.0..3.0) {
        let text = tree.text();
        let value = Expression::parse(&text, &["x"]).map_err(|error| TestCaseError::fail(format!("{text}: {error}")))?.at(x);
        let expected = tree.value(x);
        prop_assert!(value == expected || (value.is_nan() && expected.is_nan()), "{text} = {value}, expected {expected}");
    }

    #[test]
    fn powers_agree_with_the_tree(base in -9.0..9.0, exponents in prop::collection::vec(-4..5, 1..4)) {
        let text = exponents.iter().fold(String::from("x"), |text, n| format!("{text}^{n}"));
        let value = Expression::parse(&text, &["x"]).map_err(|error| TestCaseError::fail(error.to_string()))?.at(base);
        let expected = exponents.iter().fold(base, |value: f64, n| value.powi(*n));
        prop_assert!((value / expected - 1.0).abs() < 1e-13, "{text} = {value}, expected {expected}"); // 64 roundings
    }

    #[test]
    fn nodes_are_at_equal_arc_lengths(a in -2.0..2.0, b in 0.1..9.0, c in -2.0..2.0, n in 2_usize..60) {
        let text = format!("{a}*sin({b}*x) + {c}*abs(x-0.3)");
        let y = Expression::parse(&text, &["x"]).map_err(|error| TestCaseError::fail(error.to_string()))?;
        let curve = Curve::Graph { y: y.clone(), from_x: -1.0, to_x: 1.0 };
        let nodes = divide(&curve, n).map_err(|error| TestCaseError::fail(error.to_string()))?;
        prop_assert_eq!((nodes[0], nodes[n - 1]), (curve.point(0.0), curve.point(1.0)));
        let whole = ArcTable::new(&curve).map_err(|error| TestCaseError::fail(error.to_string()))?.length();
        for pair in nodes.windows(2) {
            let piece = Curve::Graph { y: y.clone(), from_x: pair[0][0], to_x: pair[1][0] };
            let length = ArcTable::new(&piece).map_err(|error| TestCaseError::fail(error.to_string()))?.length();
            let segment = whole / (n - 1) as f64;
            prop_assert!((length / segment - 1.0).abs() < 1e-7, "{text}: {length}, expected {segment}"); // 1e-6 is promised
        }
    }
}

#[test]
fn hostile_formulas_are_answered() {
    let texts = [
        "(".repeat(10_000),
        "-".repeat(4096),
        "1".repeat(4096),
        "1e308^9".into(),
        "0/0".into(),
        format!("{}x", "x^".repeat(2047)),
        format!("{}x{}", "(".repeat(64), ")".repeat(64)),
        format!("{}x{}", "sin(".repeat(64), ")".repeat(64)),
        "min(".repeat(1024),
        "x,".repeat(2048),
        "e".repeat(4096),
        "2 ".repeat(2048),
        "\u{0}".into(),
        "é".repeat(2048),
        format!("x{}", "é".repeat(4096)),
    ];
    for text in texts {
        match Expression::parse(&text, &["x"]) {
            Ok(formula) => {
                let _ = formula.at(0.5);
                let _ = formula.jet(0.5);
            }
            Err(error) => assert!(points_at_a_character(&text, &error), "{error:?}"),
        }
    }
}
