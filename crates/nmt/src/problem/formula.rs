//! Formulas of the file and of the options: read with their places.

use super::error::{Faults, Place};
use super::limits::quote;
use super::shape::split;
use super::tree::{Reader, Value};
use nmt_curve::Expression;
use nmt_geom::Point;

/// The variables of a datum of the plane.
const PLANE: [&str; 2] = ["x", "y"];

/// A formula of x and y, and where it stands.
#[derive(Clone, Debug, PartialEq)]
pub struct Formula {
    /// As it was read.
    pub expression: Expression,
    /// Where it stands.
    pub place: Place,
}

impl Formula {
    /// Its value at a point; it need not be finite.
    pub fn at(&self, p: Point) -> f64 {
        self.expression.eval(&p)
    }

    /// Its gradient at a point, exact to rounding; it need not be finite.
    pub fn gradient(&self, p: Point) -> [f64; 2] {
        [0, 1].map(|variable| self.expression.jet_along(&p, variable).d1)
    }

    /// As it was written.
    pub fn text(&self) -> &str {
        self.expression.text()
    }
}

/// A formula of x and y in the file; `None`, with the fault noted, where it cannot be understood.
pub(super) fn of_the_plane(
    reader: &mut Reader<'_>,
    item: &str,
    key: &str,
    value: &Value<'_>,
    example: &str,
) -> Option<Formula> {
    let expression = read(reader, item, key, value, &PLANE, example)?;
    Some(Formula { expression, place: value.span().into() })
}

/// A formula of `variables` in the file; `None`, with the fault noted, where it cannot be understood.
pub(super) fn read(
    reader: &mut Reader<'_>,
    item: &str,
    key: &str,
    value: &Value<'_>,
    variables: &[&str],
    example: &str,
) -> Option<Expression> {
    let Some(text) = value.get_ref().as_str() else {
        return reader.wrong_kind(item, key, "a formula in quotes", value, example);
    };
    match Expression::parse(text, variables) {
        Ok(expression) => Some(expression),
        Err(error) => {
            let place = reader.place_in_text(value, error.at());
            let (message, remedy) = split(&error.to_string());
            let message = format!("in the formula {}, {message}", quote(text));
            reader.faults.push(place, item, message, remedy);
            None
        }
    }
}

/// A formula of x and y given by an option of the command.
pub(super) fn of_an_option(faults: &mut Faults, place: Place, text: &str) -> Option<Formula> {
    match Expression::parse(text, &PLANE) {
        Ok(expression) => Some(Formula { expression, place }),
        Err(error) => {
            let (message, remedy) = split(&error.to_string());
            // An option has no column, so the character is counted.
            let character = 1 + text.get(..error.at()).map_or(0, |before| before.chars().count());
            faults.push(place, "", format!("at character {character} of the formula, {message}"), remedy);
            None
        }
    }
}
