//! `density`, `refine` and `growth` of a subdomain: how the spacing of its cloud varies.

use super::error::Place;
use super::formula::{self, Formula};
use super::limits::{self, Refusal, quote, rounded, show};
use super::shape::Shape;
use super::suggest;
use super::tree::{REFINE_KEYS, Reader, Table, Value};
use nmt_cloud::{ClearanceUnit, DEFAULT_GROWTH, MAX_GROWTH, MIN_SPACING_REL, Refinement, Target};
use nmt_curve::Division;
use nmt_geom::{Bbox, EdgeId};
use toml::de::DeValue;

/// How the spacing of a subdomain varies.
#[derive(Clone, Debug, PartialEq)]
pub struct GradingSettings {
    /// `density`: the spacing as a formula of x and y.
    pub density: Option<Formula>,
    /// `refine`: towards points and edges.
    pub refine: Vec<Refinement>,
    /// `growth`: of entries of `refine` without one of their own, beside steep parts of `density`, beside short edges, and beside what
    /// a tolerance refines. Alone it makes a cloud that is graded towards short edges.
    pub growth: f64,
    /// The first of `density`, `refine` and `growth`.
    pub place: Place,
}

/// Reads the keys; `shapes` are the contour and the holes, as far as they could be read.
pub(super) fn read(
    reader: &mut Reader<'_>,
    table: &Table<'_, '_>,
    shapes: &[Option<&Shape>],
    division: Division,
    clearance: ClearanceUnit,
) -> Option<GradingSettings> {
    let item = table.item.as_str();
    let (first, value) = ["density", "refine", "growth"].into_iter().find_map(|key| Some((key, table.get(key)?)))?;
    let place = value.span().into();
    let excluded = [
        ("division", division == Division::Chord, "division = \"chord\"", "divide its edges by \"arc\", the default"),
        (
            "clearance",
            clearance == ClearanceUnit::Scaled,
            "clearance = \"scaled\"",
            "its spacing is the same along x and y: use \"max\", the default",
        ),
    ];
    for (key, _, written, remedy) in excluded.into_iter().filter(|(_, given, ..)| *given) {
        let message = format!("{written} belongs to uniform clouds, and `{first}` makes this one graded");
        reader.faults.push(table.get(key).map_or(table.place.clone(), |value| value.span()), item, message, remedy);
    }
    let density = table.get("density");
    let density =
        density.and_then(|value| formula::of_the_plane(reader, item, "density", value, "\"0.01 + 0.1*abs(x - 1)\""));
    let growth = growth_of(reader, item, table).unwrap_or(DEFAULT_GROWTH);
    let refine = table.get("refine").map_or(Vec::new(), |value| refinements(reader, item, value, shapes, growth));
    Some(GradingSettings { density, refine, growth, place })
}

/// `growth` of a subdomain or of an entry of `refine`, where it is given; one that is refused counts as not given.
fn growth_of(reader: &mut Reader<'_>, item: &str, table: &Table<'_, '_>) -> Option<f64> {
    let value = table.get("growth")?;
    reader.number(item, "growth", value, "0.3", |_, value| growth(value))
}

/// Reads the entries of `refine`; those without a growth have `growth`.
fn refinements(
    reader: &mut Reader<'_>,
    item: &str,
    value: &Value<'_>,
    shapes: &[Option<&Shape>],
    growth: f64,
) -> Vec<Refinement> {
    let example = "refine = [{ point = [1, 1], size = 0.001, growth = 0.3 }]";
    let DeValue::Array(entries) = value.get_ref() else {
        return reader
            .wrong_kind_with(item, "refine", "an array of tables", value, &format!("write, for example, {example}"))
            .unwrap_or_default();
    };
    if entries.is_empty() {
        let remedy = format!("write, for example, {example}, or leave it out");
        reader.faults.push(value.span(), item, "`refine` is empty", remedy);
    }
    let entry = |(k, entry): (usize, &Value<'_>)| {
        refinement(reader, &format!("{item}, refine item {}", k + 1), entry, shapes, growth)
    };
    entries.iter().enumerate().filter_map(entry).collect()
}

fn refinement(
    reader: &mut Reader<'_>,
    item: &str,
    value: &Value<'_>,
    shapes: &[Option<&Shape>],
    growth: f64,
) -> Option<Refinement> {
    let table = reader.table(item, "", value, "{ point = [1, 1], size = 0.001, growth = 0.3 }")?;
    reader.known_keys(&table, "refine", REFINE_KEYS);
    let target = match (table.get("point"), table.get("edge")) {
        (Some(point), None) => reader.point(item, "point", point).map(Target::Point),
        (None, Some(edge)) => named_edge(reader, item, edge, shapes).map(Target::Edge),
        (Some(_), Some(edge)) => {
            let remedy = "keep one of them; another entry can have the other";
            reader.faults.push(edge.span(), item, "it has both `point` and `edge`", remedy);
            None
        }
        (None, None) if table.has_misspelt("point") || table.has_misspelt("edge") => None,
        (None, None) => {
            let remedy = "add the one that it is about, for example point = [1, 1] or edge = \"e1\"";
            reader.faults.push(value.span(), item, "it has neither `point` nor `edge`", remedy);
            None
        }
    };
    let size = reader.required(&table, "size", "0.001");
    let size = size.and_then(|value| {
        let size = reader.number(item, "size", value, "0.001", limits::positive)?;
        // The least spacing follows from the contour, where that could be read.
        let contour = shapes.first().copied().flatten();
        let envelope = contour.map(|shape| shape.outline.envelope()).filter(|b: &Bbox| b.size().is_finite());
        let least = envelope.map_or(0.0, |envelope| MIN_SPACING_REL * envelope.size());
        reader.accept(item, value, at_least(size, least))
    });
    let growth = growth_of(reader, item, &table).unwrap_or(growth);
    Some(Refinement { target: target?, size: size?, growth })
}

fn at_least(size: f64, least: f64) -> Result<f64, Refusal> {
    if size >= least {
        return Ok(size);
    }
    Err(Refusal {
        message: format!("`size` is {}, less than {MIN_SPACING_REL:e} of the subdomain's size", show(size)),
        remedy: format!("give at least {}", show(rounded(least * 1.00001))),
    })
}

fn growth(value: f64) -> Result<f64, Refusal> {
    if value > 0.0 && value <= MAX_GROWTH {
        return Ok(value);
    }
    Err(Refusal {
        message: format!("`growth` is {}, outside (0, {MAX_GROWTH}]", show(value)),
        remedy: "give by how much the spacing grows on a unit of length, such as 0.3, the default".to_owned(),
    })
}

/// An edge by its name, among those of the contour and then of each hole.
fn named_edge(reader: &mut Reader<'_>, item: &str, value: &Value<'_>, shapes: &[Option<&Shape>]) -> Option<EdgeId> {
    let Some(name) = value.get_ref().as_str() else {
        return reader.wrong_kind(item, "edge", "the name of an edge", value, "\"e1\"");
    };
    // Where a shape could not be read, neither its names nor the numbers after them are known.
    let known: Vec<&Shape> = shapes.iter().map_while(|shape| *shape).collect();
    let names: Vec<&str> = known.iter().flat_map(|shape| &shape.outline.edges).map(|edge| edge.name.as_str()).collect();
    if let Some(number) = names.iter().position(|known| *known == name) {
        return Some(EdgeId::of(number));
    }
    if known.len() == shapes.len() {
        const MOST_LISTED: usize = 12;
        let some = &names[..names.len().min(MOST_LISTED)];
        let more = if names.len() > some.len() { " …" } else { "" };
        let list = format!("its edges are {}{more}", suggest::list(some, '"', "and"));
        let remedy = match suggest::closest(name, &names) {
            Some(meant) => format!("did you mean \"{meant}\"? ({list})"),
            None => list,
        };
        reader.faults.push(value.span(), item, format!("there is no edge {}", quote(name)), remedy);
    }
    None
}
