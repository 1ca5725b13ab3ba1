//! The tables of a problem file, key by key: kinds, ranges, names. How the shapes lie is not looked at here.

use super::error::{Faults, Place};
use super::grading::{self, GradingSettings};
use super::limits::{self, Refusal, quote};
use super::schema::{MeshMethod, MeshSettings, Overrides, SolveSettings};
use super::shape::{self, Shape};
use super::solve;
use super::tree::{HOLE_KEYS, MESH_KEYS, Reader, SUBDOMAIN_KEYS, TOP_KEYS, Table, Value};
use nmt_cloud::ClearanceUnit;
use nmt_curve::Division;
use nmt_mfdm::Formulation;
use std::collections::{HashMap, HashSet};
use std::ops::Range;
use toml::de::{DeTable, DeValue};

/// A problem as far as it could be read; complete where no fault was noted.
#[derive(Debug)]
pub(super) struct Draft {
    pub(super) title: String,
    pub(super) units: String,
    pub(super) subdomains: Vec<SubdomainDraft>,
    pub(super) mesh: MeshSettings,
    pub(super) solve: SolveSettings,
}

/// A subdomain as far as it could be read.
#[derive(Debug)]
pub(super) struct SubdomainDraft {
    pub(super) name: String,
    /// `subdomain "arch"`.
    pub(super) item: String,
    pub(super) nodes: Option<[usize; 2]>,
    pub(super) irregularity: f64,
    pub(super) shear_modulus: f64,
    /// Where it is given, if it is.
    pub(super) shear_modulus_place: Option<Range<usize>>,
    pub(super) formulation: Option<Formulation>,
    /// True where its formulation is given and could not be read.
    pub(super) formulation_unread: bool,
    pub(super) division: Division,
    pub(super) clearance: ClearanceUnit,
    pub(super) edge_clearance: f64,
    pub(super) node_clearance: f64,
    pub(super) conforming: bool,
    pub(super) grading: Option<GradingSettings>,
    pub(super) contour: Option<Shape>,
    pub(super) holes: Vec<HoleDraft>,
    pub(super) place: Range<usize>,
    pub(super) nodes_place: Place,
}

/// A hole as far as it could be read.
#[derive(Debug)]
pub(super) struct HoleDraft {
    pub(super) name: String,
    /// `subdomain "arch", hole "bore"`.
    pub(super) item: String,
    pub(super) nodes: Option<[usize; 2]>,
    pub(super) shape: Option<Shape>,
    pub(super) place: Range<usize>,
}

/// Reads the whole tree, and the options of the command over it.
pub(super) fn read(tree: &DeTable<'_>, options: &Overrides, reader: &mut Reader<'_>) -> Draft {
    let top = Table { entries: tree, place: 0..0, item: String::new() };
    reader.known_keys(&top, "the top of the file", TOP_KEYS);
    let [title, units] = [("title", "\"A bracket\""), ("units", "\"mm\"")].map(|(key, example)| {
        let value = top.get(key);
        value.and_then(|v| reader.text("", key, v, example, |text| limits::label(key, text))).unwrap_or_default()
    });
    let mut mesh = mesh(reader, &top);
    apply_to_mesh(options, &mut mesh, &mut reader.faults);
    let solve = solve::read(reader, &top, options);
    let mut subdomains = subdomains(reader, &top, options);
    if let Some(chosen) = options.nodes {
        let place = Place::Option(format!("--nodes {},{}", chosen[0], chosen[1]));
        // Nothing the command line can hold is larger than an i128.
        let nodes = option(&mut reader.faults, &place, limits::nodes(chosen.map(|n| n as i128)));
        for subdomain in &mut subdomains {
            (subdomain.nodes, subdomain.nodes_place) = (nodes, place.clone());
        }
    }
    let solve = solve.finish(&subdomains, &mut reader.faults);
    if options.formulation.is_some() {
        subdomains.iter_mut().for_each(|subdomain| subdomain.formulation = None);
    }
    Draft { title, units, subdomains, mesh, solve }
}

fn subdomains(reader: &mut Reader<'_>, top: &Table<'_, '_>, options: &Overrides) -> Vec<SubdomainDraft> {
    let tables = tables(reader, top, "subdomain", "[[subdomain]]");
    if tables.is_empty() && top.get("subdomain").is_none_or(|value| value.get_ref().is_array()) {
        let remedy = "add a [[subdomain]] with `nodes` and a shape such as `outline` or `circle`";
        reader.faults.push(top.key_place("subdomain"), "", "the problem has no subdomain", remedy);
    }
    let subdomains: Vec<_> =
        tables.into_iter().enumerate().map(|(k, table)| subdomain(reader, table, k + 1, options)).collect();
    distinct(
        reader,
        subdomains.iter().map(|(subdomain, name_place)| Named {
            name: &subdomain.name,
            place: name_place.clone(),
            item: subdomain.item.clone(),
            other: "subdomain",
        }),
    );
    subdomains.into_iter().map(|(subdomain, _)| subdomain).collect()
}

/// The tables of an array of tables. A single table in its place is noted, and read as the one it holds.
fn tables<'t, 'i>(reader: &mut Reader<'_>, table: &Table<'t, 'i>, key: &str, header: &str) -> Vec<Table<'t, 'i>> {
    let Some(value) = table.get(key) else { return Vec::new() };
    let item = table.item.as_str();
    let remedy = format!("write {header} on a line of its own, with its keys below");
    match value.get_ref() {
        DeValue::Array(values) => {
            let mut read = |value: &'t Value<'i>| match value.get_ref() {
                DeValue::Table(entries) => Some(Table { entries, place: value.span(), item: item.to_owned() }),
                _ => reader.wrong_kind_with(item, key, "an array of tables", value, &remedy),
            };
            values.iter().filter_map(&mut read).collect()
        }
        DeValue::Table(entries) => {
            let message = format!("`{key}` is a single table");
            reader.faults.push(value.span(), item, message, format!("write {header}, with double brackets"));
            vec![Table { entries, place: value.span(), item: item.to_owned() }]
        }
        _ => {
            reader.wrong_kind_with::<()>(item, key, "an array of tables", value, &remedy);
            Vec::new()
        }
    }
}

/// The name of a table, or `default`, and where it stands.
fn name(reader: &mut Reader<'_>, table: &Table<'_, '_>, default: String, item: &str) -> (String, Range<usize>) {
    let Some(value) = table.get("name") else { return (default, table.place.clone()) };
    let item = format!("{item} {}", quote(&default));
    let name = reader.text(&item, "name", value, "\"arch\"", limits::name);
    (name.unwrap_or(default), value.span())
}

/// A subdomain, and the place of its name.
fn subdomain(
    reader: &mut Reader<'_>,
    mut table: Table<'_, '_>,
    number: usize,
    options: &Overrides,
) -> (SubdomainDraft, Range<usize>) {
    let (name, name_place) = name(reader, &table, format!("s{number}"), "subdomain");
    table.item = format!("subdomain {}", quote(&name));
    let item = table.item.clone();
    reader.known_keys(&table, "[[subdomain]]", SUBDOMAIN_KEYS);
    let nodes = match (table.get("nodes"), options.nodes) {
        (None, Some(_)) => None,
        _ => reader.required(&table, "nodes", "[41, 21]"),
    };
    let nodes_place = nodes.map_or(table.place.clone(), |value| value.span()).into();
    let nodes = nodes.and_then(|value| reader.nodes(&item, value));
    let mut number = |key: &str, default: f64, example: &str, check: fn(&str, f64) -> Result<f64, Refusal>| {
        let value = table.get(key);
        value.and_then(|value| reader.number(&item, key, value, example, check)).unwrap_or(default)
    };
    let irregularity = number("irregularity", 0.0, "0.25", |_, value| limits::irregularity(value));
    let shear_modulus = number("shear_modulus", 1.0, "1.0", limits::positive);
    let edge_clearance = number("edge_clearance", 1.0 / 3.0, "0.3333", limits::clearance);
    let node_clearance = number("node_clearance", 0.5, "0.5", limits::clearance);
    let formulation = table.get("formulation");
    let formulation =
        formulation.and_then(|value| reader.text(&item, "formulation", value, "\"variational\"", limits::formulation));
    let formulation_unread = formulation.is_none() && table.get("formulation").is_some();
    let division = table.get("division");
    let division = division.and_then(|value| reader.text(&item, "division", value, "\"arc\"", limits::division));
    let clearance = table.get("clearance");
    let clearance =
        clearance.and_then(|value| reader.text(&item, "clearance", value, "\"scaled\"", limits::clearance_unit));
    let conforming = table.get("conforming").and_then(|value| reader.boolean(&item, "conforming", value));
    let contour = shape::read(reader, &table, "");
    let tables = tables(reader, &table, "hole", "[[subdomain.hole]]");
    let holes: Vec<_> = tables.into_iter().enumerate().map(|(k, table)| hole(reader, table, k + 1)).collect();
    distinct(
        reader,
        holes.iter().map(|(hole, name_place)| Named {
            name: &hole.name,
            place: name_place.clone(),
            item: hole.item.clone(),
            other: "hole",
        }),
    );
    let holes: Vec<_> = holes.into_iter().map(|(hole, _)| hole).collect();
    // A hole whose name is taken has been told so; its edges bear the same name.
    let mut names = HashSet::new();
    let named = holes.iter().filter(|hole| names.insert(hole.name.as_str())).filter_map(|hole| hole.shape.as_ref());
    distinct_edges(reader, contour.iter().chain(named));
    let (division, clearance) = (division.unwrap_or_default(), clearance.unwrap_or_default());
    let shapes: Vec<Option<&Shape>> =
        std::iter::once(contour.as_ref()).chain(holes.iter().map(|hole| hole.shape.as_ref())).collect();
    let grading = grading::read(reader, &table, &shapes, division, clearance);
    let subdomain = SubdomainDraft {
        name,
        item,
        nodes,
        irregularity,
        shear_modulus,
        shear_modulus_place: table.get("shear_modulus").map(|value| value.span()),
        formulation,
        formulation_unread,
        division,
        clearance,
        edge_clearance,
        node_clearance,
        conforming: conforming.unwrap_or_default(),
        grading,
        contour,
        holes,
        place: table.place,
        nodes_place,
    };
    (subdomain, name_place)
}

/// A hole, and the place of its name.
fn hole(reader: &mut Reader<'_>, mut table: Table<'_, '_>, number: usize) -> (HoleDraft, Range<usize>) {
    let of = table.item.clone();
    let (name, name_place) = name(reader, &table, format!("h{number}"), &format!("{of}, hole"));
    table.item = format!("{of}, hole {}", quote(&name));
    reader.known_keys(&table, "[[subdomain.hole]]", HOLE_KEYS);
    let nodes = table.get("nodes").and_then(|value| reader.nodes(&table.item, value));
    let flux = shape::flux(reader, &table);
    let mut shape = shape::read(reader, &table, &format!("{name}/"));
    // An edge with a flux of its own keeps it.
    let fluxes = shape.iter_mut().flat_map(|shape| &mut shape.fluxes);
    fluxes.filter(|own| own.is_none()).for_each(|own| own.clone_from(&flux));
    (HoleDraft { name, item: table.item, nodes, shape, place: table.place }, name_place)
}

/// Something with a name, for the check that no two have the same.
struct Named<'n> {
    name: &'n str,
    place: Range<usize>,
    item: String,
    other: &'static str,
}

fn distinct<'n>(reader: &mut Reader<'_>, all: impl Iterator<Item = Named<'n>>) {
    let mut seen: HashMap<&str, usize> = HashMap::new();
    for (k, Named { name, place, item, other }) in all.enumerate() {
        if let Some(first) = seen.get(name) {
            let message = format!("{other} {first} has the name {} already", quote(name));
            reader.faults.push(place, item, message, format!("give each {other} a name of its own"));
        } else {
            seen.insert(name, k + 1);
        }
    }
}

/// Edge names are unique within a subdomain, those of its holes included.
fn distinct_edges<'s>(reader: &mut Reader<'_>, shapes: impl Iterator<Item = &'s Shape>) {
    let mut seen: HashMap<&str, String> = HashMap::new();
    for shape in shapes {
        for (edge, mark) in shape.outline.edges.iter().zip(&shape.edges) {
            let item = shape.item_of(mark);
            if let Some(first) = seen.get(edge.name.as_str()) {
                let message = format!("the name {} is that of another edge already ({first})", quote(&edge.name));
                let place = mark.name_place.clone().unwrap_or(mark.place.clone());
                reader.faults.push(place, item, message, "give each edge of a subdomain a name of its own");
            } else {
                seen.insert(&edge.name, item);
            }
        }
    }
}

/// `[mesh]` of the file.
fn mesh(reader: &mut Reader<'_>, top: &Table<'_, '_>) -> MeshSettings {
    let mut settings = MeshSettings::default();
    let Some(value) = top.get("mesh") else { return settings };
    let item = "[mesh]";
    let DeValue::Table(entries) = value.get_ref() else {
        let remedy = "write [mesh] on a line of its own, with its keys below";
        reader.wrong_kind_with::<()>("", "mesh", "a table", value, remedy);
        return settings;
    };
    let table = Table { entries, place: value.span(), item: item.to_owned() };
    reader.known_keys(&table, item, MESH_KEYS);
    let method = table.get("method");
    let method = method.and_then(|v| reader.text(item, "method", v, "\"constrained\"", limits::mesh_method));
    settings.method = method.unwrap_or_default();
    let smooth = table.get("smooth").and_then(|value| reader.whole(item, "smooth", value, "3", limits::smooth));
    settings.smooth = smooth.unwrap_or_default();
    if let Some(value) = table.get("elim") {
        let remedy = "write the names of the steps to take, elim = [\"outside\", \"in_hole\", \"tiny\", \"complete\"], \
                      or a flag 1 or 0 for each";
        let words: Option<Vec<String>> = match value.get_ref() {
            DeValue::Array(steps) => steps.iter().map(|step| step_word(step.get_ref())).collect(),
            _ => None,
        };
        match words {
            None => reader.wrong_kind_with(item, "elim", "an array of steps", value, remedy).unwrap_or_default(),
            Some(words) => {
                let words: Vec<&str> = words.iter().map(String::as_str).collect();
                match limits::elimination(&words) {
                    Ok(elimination) => settings.elimination = elimination,
                    Err(Refusal { message, remedy }) => reader.faults.push(value.span(), item, message, remedy),
                }
            }
        }
        settings.elimination_place = Some(value.span().into());
    }
    settings
}

/// A step of elimination as a word: its name, or a flag.
fn step_word(value: &DeValue<'_>) -> Option<String> {
    match value {
        DeValue::String(word) => Some(word.clone().into_owned()),
        DeValue::Integer(flag) => Some(flag.as_str().to_owned()),
        DeValue::Boolean(flag) => Some(u8::from(*flag).to_string()),
        _ => None,
    }
}

/// Puts the options of the command over `[mesh]`.
fn apply_to_mesh(options: &Overrides, settings: &mut MeshSettings, faults: &mut Faults) {
    if let Some(word) = &options.method {
        let place = Place::Option(format!("--method {word}"));
        settings.method = option(faults, &place, limits::mesh_method(word)).unwrap_or_default();
    }
    if let Some(sweeps) = options.smooth {
        let place = Place::Option(format!("--smooth {sweeps}"));
        settings.smooth = option(faults, &place, limits::smooth(sweeps.into())).unwrap_or_default();
    }
    if let Some(words) = &options.elim {
        let place = Place::Option(format!("--elim {}", words.join(",")));
        let words: Vec<&str> = words.iter().map(String::as_str).filter(|word| *word != "none").collect();
        settings.elimination = option(faults, &place, limits::elimination(&words)).unwrap_or_default();
        settings.elimination_place = Some(place);
    }
    if let (MeshMethod::Constrained, Some(place)) = (settings.method, &settings.elimination_place) {
        let message = "`elim` is given, and the constrained way has nothing to eliminate";
        faults.push(place.clone(), "[mesh]", message, "give method = \"unconstrained\" too, or leave `elim` out");
    }
}

/// The value of an option, its refusal noted.
pub(super) fn option<T>(faults: &mut Faults, place: &Place, checked: Result<T, Refusal>) -> Option<T> {
    checked.map_err(|Refusal { message, remedy }| faults.push(place.clone(), "", message, remedy)).ok()
}
