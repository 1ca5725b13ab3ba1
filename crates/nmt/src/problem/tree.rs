//! Typed access to a TOML tree: every value of the wrong kind or out of its range becomes a fault with its place.

use super::error::Faults;
use super::habits;
use super::limits::{self, Refusal, quote};
use super::suggest;
use nmt_geom::Point;
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeFloat, DeInteger, DeTable, DeValue};

/// A value with its place.
pub(super) type Value<'i> = Spanned<DeValue<'i>>;

/// A table of the file: its entries, where its header or its braces stand, and the item it describes.
#[derive(Clone, Debug)]
pub(super) struct Table<'t, 'i> {
    pub(super) entries: &'t DeTable<'i>,
    pub(super) place: Range<usize>,
    pub(super) item: String,
}

impl<'t, 'i> Table<'t, 'i> {
    /// The value of a key.
    pub(super) fn get(&self, key: &str) -> Option<&'t Value<'i>> {
        self.entries.get(key)
    }

    /// The place of a key, without its value.
    pub(super) fn key_place(&self, key: &str) -> Range<usize> {
        self.entries.get_key_value(key).map_or(self.place.clone(), |(key, _)| key.span())
    }
}

impl Table<'_, '_> {
    /// True where one of its keys is likely meant to be `key`.
    pub(super) fn has_misspelt(&self, key: &str) -> bool {
        self.entries.keys().any(|found| found.get_ref() != key && suggest::closest(found.get_ref(), &[key]).is_some())
    }
}

/// The keys at the top of the file.
pub(super) const TOP_KEYS: &[&str] = &["title", "units", "subdomain", "mesh", "solve"];
/// The keys of `[[subdomain]]`.
pub(super) const SUBDOMAIN_KEYS: &[&str] = &[
    "name",
    "nodes",
    "irregularity",
    "shear_modulus",
    "formulation",
    "division",
    "clearance",
    "edge_clearance",
    "node_clearance",
    "conforming",
    "density",
    "refine",
    "growth",
    "outline",
    "circle",
    "ellipse",
    "rectangle",
    "hole",
];
/// The keys of `[[subdomain.hole]]`.
pub(super) const HOLE_KEYS: &[&str] = &["name", "nodes", "outline", "circle", "ellipse", "rectangle", "neumann"];
/// The keys of an entry of `refine`.
pub(super) const REFINE_KEYS: &[&str] = &["point", "edge", "size", "growth"];
/// The keys of `[mesh]`.
pub(super) const MESH_KEYS: &[&str] = &["method", "elim", "smooth"];
/// The keys of `[solve]`.
pub(super) const SOLVE_KEYS: &[&str] = &[
    "formulation",
    "twist",
    "torque",
    "holes",
    "order",
    "star",
    "stars",
    "smoothing",
    "trial",
    "test",
    "gauss",
    "solver",
    "seed",
    "estimate",
    "tolerance",
    "max_nodes",
    "source",
    "boundary",
    "exact",
];

/// Where a key may belong that stands in the wrong table.
const TABLES: [(&str, &[&str]); 5] = [
    ("the top of the file", TOP_KEYS),
    ("[[subdomain]]", SUBDOMAIN_KEYS),
    ("[[subdomain.hole]]", HOLE_KEYS),
    ("[mesh]", MESH_KEYS),
    ("[solve]", SOLVE_KEYS),
];

/// Reads values and collects what is wrong with them.
#[derive(Debug)]
pub(super) struct Reader<'s> {
    /// The whole text, which places refer to.
    pub(super) text: &'s str,
    pub(super) faults: Faults,
}

impl Reader<'_> {
    /// Notes why a value is refused.
    pub(super) fn accept<T>(&mut self, item: &str, value: &Value<'_>, checked: Result<T, Refusal>) -> Option<T> {
        match checked {
            Ok(accepted) => Some(accepted),
            Err(Refusal { message, remedy }) => {
                self.faults.push(value.span(), item, message, remedy);
                None
            }
        }
    }

    /// Notes every key of `table` that is not `known`; `title` is the table as it is written.
    pub(super) fn known_keys(&mut self, table: &Table<'_, '_>, title: &str, known: &[&str]) {
        for key in table.entries.keys().filter(|key| !known.contains(&key.get_ref().as_ref())) {
            let word: &str = key.get_ref();
            let list = format!("the keys of {title} are {}", suggest::list(known, '`', "and"));
            let elsewhere =
                TABLES.iter().find(|(other, keys)| *other != title && keys.contains(&word)).map(|(other, _)| other);
            let remedy = match (suggest::closest(word, known), elsewhere) {
                (Some(meant), _) => format!("did you mean `{meant}`? ({list})"),
                (None, Some(_)) if word == "hole" => {
                    format!("write [[subdomain.hole]], below its [[subdomain]] ({list})")
                }
                (None, _) if word == "neumann" => {
                    "write it at its edge: in an item of `outline`, { line = true, neumann = \"0\" }, or among the keys of a \
                     circle, ellipse or rectangle, or of a hole for all its edges"
                        .to_owned()
                }
                (None, Some(other)) => format!("`{word}` belongs in {other} ({list})"),
                (None, None) => format!("remove it; {list}"),
            };
            let message = format!("unknown key {}", code(word));
            self.faults.push(key.span(), table.item.as_str(), message, remedy);
        }
    }

    /// A table that must have one of the forms of `example`.
    pub(super) fn table<'t, 'i>(
        &mut self,
        item: &str,
        name: &str,
        value: &'t Value<'i>,
        example: &str,
    ) -> Option<Table<'t, 'i>> {
        match value.get_ref() {
            DeValue::Table(entries) => Some(Table { entries, place: value.span(), item: item.to_owned() }),
            _ => self.wrong_kind(item, name, "a table", value, example),
        }
    }

    /// A key of `table` that must be there.
    pub(super) fn required<'t, 'i>(
        &mut self,
        table: &Table<'t, 'i>,
        key: &str,
        example: &str,
    ) -> Option<&'t Value<'i>> {
        let found = table.get(key);
        if found.is_none() && !table.has_misspelt(key) {
            let remedy = format!("add it, for example {key} = {example}");
            self.faults.push(table.place.clone(), table.item.as_str(), format!("`{key}` is missing"), remedy);
        }
        found
    }

    /// A number within the range that `check` knows.
    pub(super) fn number(
        &mut self,
        item: &str,
        name: &str,
        value: &Value<'_>,
        example: &str,
        check: impl Fn(&str, f64) -> Result<f64, Refusal>,
    ) -> Option<f64> {
        let Some(number) = as_number(value.get_ref()) else {
            return self.wrong_kind(item, name, "a number", value, example);
        };
        if number.is_infinite() && value.get_ref().as_float().is_none_or(|float| !float.as_str().contains("inf")) {
            let written = self.text.get(value.span()).unwrap_or_default();
            let message = format!("{} is {}, beyond {:e} in size", subject(name), cut(written), limits::LARGEST);
            self.faults.push(value.span(), item, message, "choose a unit in which it is smaller");
            return None;
        }
        self.accept(item, value, check(name, number))
    }

    /// A whole number within the range that `check` knows.
    pub(super) fn whole<T>(
        &mut self,
        item: &str,
        name: &str,
        value: &Value<'_>,
        example: &str,
        check: impl Fn(i128) -> Result<T, Refusal>,
    ) -> Option<T> {
        let Some(number) = as_whole(value.get_ref()) else {
            return self.wrong_kind(item, name, "a whole number", value, example);
        };
        self.accept(item, value, check(number))
    }

    /// A text within the limits that `check` knows.
    pub(super) fn text<T>(
        &mut self,
        item: &str,
        name: &str,
        value: &Value<'_>,
        example: &str,
        check: impl Fn(&str) -> Result<T, Refusal>,
    ) -> Option<T> {
        let Some(text) = value.get_ref().as_str() else {
            return self.wrong_kind(item, name, "a text", value, example);
        };
        self.accept(item, value, check(text))
    }

    /// `true` or `false`.
    pub(super) fn boolean(&mut self, item: &str, name: &str, value: &Value<'_>) -> Option<bool> {
        match value.get_ref() {
            DeValue::Boolean(truth) => Some(*truth),
            _ => self.wrong_kind(item, name, "true or false", value, "true"),
        }
    }

    /// Two whole numbers: N_x and N_y.
    pub(super) fn nodes(&mut self, item: &str, value: &Value<'_>) -> Option<[usize; 2]> {
        let (kind, example) = ("two whole numbers, [N_x, N_y]", "[41, 21]");
        let pair = self.pair(item, "nodes", value, kind, example)?;
        let [Some(n_x), Some(n_y)] = [0, 1].map(|k| {
            let number = as_whole(pair[k].get_ref());
            number.or_else(|| self.wrong_kind(item, "nodes", "whole numbers", &pair[k], example))
        }) else {
            return None;
        };
        self.accept(item, value, limits::nodes([n_x, n_y]))
    }

    /// A point `[x, y]`; `name` is empty for a vertex.
    pub(super) fn point(&mut self, item: &str, name: &str, value: &Value<'_>) -> Option<Point> {
        let axes =
            if name.is_empty() { ["x", "y"].map(str::to_owned) } else { ["x", "y"].map(|a| format!("{name}.{a}")) };
        let kind = if name.is_empty() { "a vertex, [x, y]" } else { "a point, [x, y]" };
        self.reals(item, name, value, kind, "[1.0, 0.5]", axes, limits::real)
    }

    /// Two numbers, each named and within the range that `check` knows.
    #[expect(clippy::too_many_arguments, reason = "all are words of its messages")]
    pub(super) fn reals(
        &mut self,
        item: &str,
        name: &str,
        value: &Value<'_>,
        kind: &str,
        example: &str,
        names: [String; 2],
        check: impl Fn(&str, f64) -> Result<f64, Refusal>,
    ) -> Option<[f64; 2]> {
        let pair = self.pair(item, name, value, kind, example)?;
        let [first, second] = [0, 1].map(|k| self.number(item, &names[k], &pair[k], "1.0", &check));
        Some([first?, second?])
    }

    fn pair<'t, 'i>(
        &mut self,
        item: &str,
        name: &str,
        value: &'t Value<'i>,
        kind: &str,
        example: &str,
    ) -> Option<&'t [Value<'i>]> {
        match value.get_ref() {
            DeValue::Array(items) if items.len() == 2 => Some(items),
            DeValue::Array(items) => {
                let n = items.len();
                let message =
                    format!("{} must be {kind}, found {n} value{}", subject(name), if n == 1 { "" } else { "s" });
                let are_numbers = (3..=4).contains(&n) && items.iter().all(|item| as_number(item.get_ref()).is_some());
                let comma = if are_numbers { "; decimals have a point, 1.5, and no comma" } else { "" };
                self.faults.push(
                    value.span(),
                    item,
                    message,
                    format!("give 2, for example {}{comma}", assign(name, example)),
                );
                None
            }
            _ => self.wrong_kind(item, name, kind, value, example),
        }
    }

    /// Notes a value of the wrong kind.
    pub(super) fn wrong_kind<T>(
        &mut self,
        item: &str,
        name: &str,
        kind: &str,
        value: &Value<'_>,
        example: &str,
    ) -> Option<T> {
        // A number in quotes is the commonest of all.
        let unquoted = value.get_ref().as_str().filter(|text| kind.contains("number") && text.parse::<f64>().is_ok());
        let formula = value.get_ref().as_str().filter(|_| kind.contains("number")).and_then(habits::value_of);
        let remedy = match unquoted.or(formula.as_deref()) {
            Some(number) if unquoted.is_none() => {
                format!("formulas stand in curves and data alone; write its value, {number}")
            }
            Some(number) if !name.is_empty() => format!("write it without quotes: {}", assign(name, number)),
            Some(number) => format!("write it without quotes: {number}"),
            None => format!("write, for example, {}", assign(name, example)),
        };
        self.wrong_kind_with(item, name, kind, value, &remedy)
    }

    /// Notes a value of the wrong kind with a remedy of its own.
    pub(super) fn wrong_kind_with<T>(
        &mut self,
        item: &str,
        name: &str,
        kind: &str,
        value: &Value<'_>,
        remedy: &str,
    ) -> Option<T> {
        let message = format!("{} must be {kind}, found {}", subject(name), describe(value.get_ref()));
        self.faults.push(value.span(), item, message, remedy);
        None
    }

    /// The place of the character at byte `at` of a text of the file; of the whole text where it is written with
    /// escapes or over several lines, so that its bytes are not those of the file.
    pub(super) fn place_in_text(&self, value: &Value<'_>, at: usize) -> Range<usize> {
        let span = value.span();
        let written = self.text.get(span.clone()).unwrap_or_default();
        let Some(text) = value.get_ref().as_str() else { return span };
        let plain = written.get(1..written.len().saturating_sub(1)) == Some(text);
        if !plain || !text.is_char_boundary(at) {
            return span;
        }
        let start = span.start + 1 + at;
        start..start + text[at..].chars().next().map_or(1, char::len_utf8)
    }
}

/// A number, whole ones included.
fn as_number(value: &DeValue<'_>) -> Option<f64> {
    match value {
        DeValue::Float(number) => float(number),
        DeValue::Integer(number) if number.radix() == 10 => number.as_str().parse().ok(),
        DeValue::Integer(number) => Some(integer(number) as f64),
        _ => None,
    }
}

fn as_whole(value: &DeValue<'_>) -> Option<i128> {
    match value {
        DeValue::Integer(number) => Some(integer(number)),
        _ => None,
    }
}

fn float(number: &DeFloat<'_>) -> Option<f64> {
    number.as_str().parse().ok()
}

/// The number, or the end of the range where it has more than 38 digits: every check refuses both ends.
fn integer(number: &DeInteger<'_>) -> i128 {
    let digits = number.as_str();
    let end = if digits.starts_with('-') { i128::MIN } else { i128::MAX };
    i128::from_str_radix(digits, number.radix()).unwrap_or(end)
}

/// What a value is, for a message.
fn describe(value: &DeValue<'_>) -> String {
    match value {
        DeValue::String(text) => format!("the text {}", quote(text)),
        DeValue::Integer(number) => format!("the number {}", cut(&number.to_string())),
        DeValue::Float(number) => format!("the number {}", cut(number.as_str())),
        DeValue::Boolean(truth) => truth.to_string(),
        DeValue::Datetime(_) => "a date or time".to_owned(),
        DeValue::Array(items) if items.is_empty() => "an empty array".to_owned(),
        DeValue::Array(_) => "an array".to_owned(),
        DeValue::Table(_) => "a table".to_owned(),
    }
}

/// A word of the file as it is written, cut where it is very long.
pub(super) fn cut(written: &str) -> String {
    const LONGEST: usize = 40;
    if written.len() <= LONGEST {
        written.to_owned()
    } else {
        format!("{}…", written.chars().take(LONGEST).collect::<String>())
    }
}

fn subject(name: &str) -> String {
    if name.is_empty() { "it".to_owned() } else { format!("`{name}`") }
}

fn assign(name: &str, example: &str) -> String {
    // A part of a value (`centre.x`, `semi_axes[0]`, `t0`) is no key of its own.
    let is_key = name.len() > 2 && name.chars().all(|c| c.is_ascii_lowercase() || c == '_');
    if is_key { format!("{name} = {example}") } else { example.to_owned() }
}

fn code(word: &str) -> String {
    let plain = word.len() <= 40 && word.chars().all(|c| c.is_alphanumeric() || matches!(c, '_' | '-' | '.'));
    if plain && !word.is_empty() { format!("`{word}`") } else { quote(word) }
}
