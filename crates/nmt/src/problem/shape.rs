//! `outline`, `circle`, `ellipse` or `rectangle` to a closed path of curves.

use super::formula::{self, Formula};
use super::limits::{self, quote};
use super::suggest;
use super::tree::{Reader, Table, Value};
use nmt_curve::{Curve, Expression, Outline, OutlineEdge, Turn};
use nmt_geom::Point;
use std::ops::Range;
use toml::de::DeValue;

/// The keys that give a shape; a contour or hole has exactly one of them.
const SHAPES: [&str; 4] = ["outline", "circle", "ellipse", "rectangle"];

/// A closed path with the places of its parts, for the checks that need all of them.
#[derive(Clone, Debug)]
pub(super) struct Shape {
    pub(super) outline: Outline,
    /// The contour or hole: `subdomain "arch", hole "bore"`.
    pub(super) item: String,
    /// The key that gives the shape.
    pub(super) place: Range<usize>,
    /// Each vertex, in order.
    pub(super) vertices: Vec<Mark>,
    /// Each edge, in order; a straight one that is not written out stands at the vertex before it.
    pub(super) edges: Vec<Mark>,
    /// ∂u/∂n on each edge of a Poisson problem, where it is given.
    pub(super) fluxes: Vec<Option<Formula>>,
}

/// Where a vertex or an edge stands.
#[derive(Clone, Debug)]
pub(super) struct Mark {
    pub(super) place: Range<usize>,
    /// Its item of the outline, counted from 1; `None` for a circle, ellipse or rectangle.
    number: Option<usize>,
    /// Where it is named, if it is.
    pub(super) name_place: Option<Range<usize>>,
}

impl Shape {
    /// The item of a vertex or an edge: `subdomain "arch", outline item 4`.
    pub(super) fn item_of(&self, mark: &Mark) -> String {
        match mark.number {
            Some(number) => item_number(&self.item, number),
            None => self.item.clone(),
        }
    }
}

fn item_number(item: &str, number: usize) -> String {
    format!("{item}, outline item {number}")
}

/// The shape that a contour or a hole gives; `None`, with its faults noted, where it gives none, two or a bad one.
///
/// `prefix` stands before the names of edges that the file does not name: `bore/` for those of a hole.
pub(super) fn read(reader: &mut Reader<'_>, table: &Table<'_, '_>, prefix: &str) -> Option<Shape> {
    let mut given: Vec<_> = SHAPES.iter().copied().filter(|key| table.get(key).is_some()).collect();
    given.sort_by_key(|key| table.key_place(key).start);
    let key = match given[..] {
        [key] => key,
        // A misspelt shape has been told already.
        [] if SHAPES.iter().any(|key| table.has_misspelt(key)) => return None,
        [] => {
            let list = suggest::list(&SHAPES, '`', "or");
            let remedy = format!("give {list}, for example circle = {{ centre = [0, 0], radius = 1 }}");
            reader.faults.push(table.place.clone(), table.item.as_str(), "it has no shape", remedy);
            return None;
        }
        [first, second, ..] => {
            let message = format!("it has two shapes, `{first}` and `{second}`");
            reader.faults.push(table.key_place(second), table.item.as_str(), message, "keep one of them");
            // Both are read for their own faults; neither can be taken.
            given.iter().for_each(|key| {
                read_one(reader, table, key, prefix);
            });
            return None;
        }
    };
    read_one(reader, table, key, prefix)
}

fn read_one(reader: &mut Reader<'_>, table: &Table<'_, '_>, key: &str, prefix: &str) -> Option<Shape> {
    let value = table.get(key)?;
    let place = table.key_place(key);
    if key == "outline" {
        return outline(reader, table, value, place, prefix);
    }
    let example = match key {
        "circle" => "{ centre = [0, 0], radius = 1 }",
        "ellipse" => "{ centre = [0, 0], semi_axes = [2, 1], angle = 30 }",
        _ => "{ from = [0, 0], to = [2, 1] }",
    };
    let shape = reader.table(&table.item, key, value, example)?;
    let flux = flux(reader, &shape);
    let mut outline = match key {
        "circle" => circle(reader, &shape),
        "ellipse" => ellipse(reader, &shape),
        _ => rectangle(reader, &shape),
    }?;
    for (k, edge) in outline.edges.iter_mut().enumerate() {
        edge.name = format!("{prefix}e{}", k + 1);
    }
    let mark = Mark { place: value.span(), number: None, name_place: None };
    let (vertices, edges) = (vec![mark.clone(); outline.vertices.len()], vec![mark; outline.edges.len()]);
    let fluxes = vec![flux; outline.edges.len()];
    Some(Shape { outline, item: table.item.clone(), place, vertices, edges, fluxes })
}

/// `neumann` of an edge, or of all edges of a circle, ellipse, rectangle or hole.
pub(super) fn flux(reader: &mut Reader<'_>, table: &Table<'_, '_>) -> Option<Formula> {
    let value = table.get("neumann")?;
    formula::of_the_plane(reader, &table.item, "neumann", value, "\"0\"")
}

fn circle(reader: &mut Reader<'_>, table: &Table<'_, '_>) -> Option<Outline> {
    reader.known_keys(table, "a circle", &["centre", "radius", "neumann"]);
    let centre = required_point(reader, table, "centre");
    let radius = reader.required(table, "radius", "1.0");
    let radius = radius.and_then(|value| reader.number(&table.item, "radius", value, "1.0", limits::positive));
    Some(Outline::circle(centre?, radius?))
}

fn ellipse(reader: &mut Reader<'_>, table: &Table<'_, '_>) -> Option<Outline> {
    reader.known_keys(table, "an ellipse", &["centre", "semi_axes", "angle", "neumann"]);
    let centre = required_point(reader, table, "centre");
    let semi_axes = reader.required(table, "semi_axes", "[2.0, 1.0]").and_then(|value| {
        let names = ["semi_axes[0]", "semi_axes[1]"].map(str::to_owned);
        reader.reals(&table.item, "semi_axes", value, "two numbers, [a, b]", "[2.0, 1.0]", names, limits::positive)
    });
    let degrees = match table.get("angle") {
        Some(value) => reader.number(&table.item, "angle", value, "30", limits::real)?,
        None => 0.0,
    };
    Some(Outline::ellipse(centre?, semi_axes?, degrees.rem_euclid(360.0).to_radians()))
}

fn rectangle(reader: &mut Reader<'_>, table: &Table<'_, '_>) -> Option<Outline> {
    reader.known_keys(table, "a rectangle", &["from", "to", "neumann"]);
    let (from, to) = (required_point(reader, table, "from"), required_point(reader, table, "to"));
    let (from, to) = (from?, to?);
    for (d, axis) in ["x", "y"].into_iter().enumerate() {
        if from[d] == to[d] {
            let message = format!(
                "the rectangle has no extent along {axis}: `from` and `to` both have {axis} = {}",
                limits::show(from[d])
            );
            reader.faults.push(table.place.clone(), table.item.as_str(), message, "give two opposite corners");
            return None;
        }
    }
    Some(Outline::rectangle(from, to))
}

fn required_point(reader: &mut Reader<'_>, table: &Table<'_, '_>, key: &str) -> Option<Point> {
    let value = reader.required(table, key, "[0.0, 0.0]")?;
    reader.point(&table.item, key, value)
}

/// An item of an outline, as far as it could be read.
enum Item {
    Vertex(Option<Point>),
    Edge(Option<Box<EdgeItem>>),
    Neither,
}

struct EdgeItem {
    path: Path,
    nodes: Option<usize>,
    name: Option<String>,
    name_place: Option<Range<usize>>,
    flux: Option<Formula>,
}

/// How an edge leads from the vertex before it to the vertex after it.
enum Path {
    Line,
    Graph(Expression),
    Arc { centre: Point, turn: Turn },
    Parametric { x: Expression, y: Expression, t: [f64; 2] },
}

/// The items of an outline with their faults; then, where every one could be read, the closed path they make.
fn outline(
    reader: &mut Reader<'_>,
    table: &Table<'_, '_>,
    value: &Value<'_>,
    place: Range<usize>,
    prefix: &str,
) -> Option<Shape> {
    let DeValue::Array(values) = value.get_ref() else {
        return reader.wrong_kind(
            &table.item,
            "outline",
            "an array of vertices and edges",
            value,
            "[[0, 0], [1, 0], [0, 1]]",
        );
    };
    let items: Vec<_> = values.iter().enumerate().map(|(k, value)| item(reader, &table.item, value, k + 1)).collect();
    let places: Vec<_> = values.iter().map(|value| value.span()).collect();
    let before = reader.faults.len();
    misplaced_items(reader, &table.item, &items, &places);
    if reader.faults.len() == before {
        too_few_vertices(reader, &table.item, &items, &value.span());
    }
    if reader.faults.len() > before {
        return None;
    }
    closed_path(reader, &table.item, items, places, place, prefix)
}

/// Edges that do not stand between two vertices.
fn misplaced_items(reader: &mut Reader<'_>, item: &str, items: &[Item], places: &[Range<usize>]) {
    if let (Some(Item::Edge(_)), Some(place)) = (items.first(), places.first()) {
        let remedy =
            "put the vertex [x, y] where this edge begins before it; after the last item the outline closes by itself";
        reader.faults.push(place.clone(), item_number(item, 1), "the outline starts with an edge", remedy);
    }
    for (k, pair) in items.windows(2).enumerate() {
        if let [Item::Edge(_), Item::Edge(_)] = pair {
            let (first, second) = (k + 1, k + 2);
            let message = format!("two edges in a row, items {first} and {second}");
            let remedy = "put the vertex [x, y] where they meet between them";
            reader.faults.push(places[k + 1].clone(), item_number(item, second), message, remedy);
        }
    }
}

fn too_few_vertices(reader: &mut Reader<'_>, item: &str, items: &[Item], place: &Range<usize>) {
    let n_vertices = items.iter().filter(|item| matches!(item, Item::Vertex(_))).count();
    let straight = |item: &Item| match item {
        Item::Vertex(_) => true,
        Item::Edge(edge) => edge.as_ref().is_some_and(|edge| matches!(edge.path, Path::Line)),
        Item::Neither => false,
    };
    if n_vertices < 3 && items.iter().all(straight) {
        let message = match n_vertices {
            0 => "the outline is empty".to_owned(),
            1 => "1 vertex encloses nothing".to_owned(),
            n => format!("{n} vertices joined by straight edges enclose nothing"),
        };
        reader.faults.push(
            place.clone(),
            item,
            message,
            "give at least 3 vertices, or 2 with a curved edge between them",
        );
    }
}

fn item(reader: &mut Reader<'_>, shape: &str, value: &Value<'_>, number: usize) -> Item {
    let item = item_number(shape, number);
    match value.get_ref() {
        DeValue::Array(_) => Item::Vertex(reader.point(&item, "", value)),
        DeValue::Table(entries) => {
            let table = Table { entries, place: value.span(), item };
            Item::Edge(edge(reader, &table).map(Box::new))
        }
        DeValue::String(text) => {
            let message = format!("an item is a vertex [x, y] or an edge {{ … }}, found the text {}", quote(text));
            let remedy = format!("for a curve y = f(x) write {{ curve = {} }}", quote(text));
            reader.faults.push(value.span(), item, message, remedy);
            Item::Neither
        }
        _ => {
            reader.wrong_kind::<()>(&item, "", "a vertex [x, y] or an edge { … }", value, "[1.0, 0.5]");
            Item::Neither
        }
    }
}

/// The keys of each kind of edge.
const EDGE_KINDS: [(&str, &[&str]); 4] =
    [("curve", &["curve"]), ("arc", &["arc"]), ("x, y, t", &["x", "y", "t"]), ("line", &["line"])];

fn edge(reader: &mut Reader<'_>, table: &Table<'_, '_>) -> Option<EdgeItem> {
    let before = reader.faults.len();
    reader.known_keys(table, "an edge", &["curve", "arc", "x", "y", "t", "line", "nodes", "name", "neumann"]);
    let nodes = table.get("nodes");
    let nodes = nodes.and_then(|value| reader.whole(&table.item, "nodes", value, "12", limits::edge_nodes));
    let name = table.get("name");
    let name_place = name.map(|value| value.span());
    let name = name.and_then(|value| reader.text(&table.item, "name", value, "\"crown\"", limits::name));
    let flux = flux(reader, table);
    let given: Vec<_> = EDGE_KINDS.iter().filter(|(_, keys)| keys.iter().any(|key| table.get(key).is_some())).collect();
    let path = match given[..] {
        [(kind, _)] => match *kind {
            "curve" => {
                table.get("curve").and_then(|value| formula(reader, table, "curve", value, "x")).map(Path::Graph)
            }
            "arc" => table.get("arc").and_then(|value| arc(reader, table, value)),
            "line" => table.get("line").and_then(|value| line(reader, table, value)),
            _ => parametric(reader, table),
        },
        // An unknown key, already noted, is likely the kind misspelt.
        [] if reader.faults.len() > before => None,
        [] => {
            let remedy = "give one of curve = \"f(x)\", arc = { centre = [x, y] }, x, y and t, or line = true";
            reader.faults.push(table.place.clone(), table.item.as_str(), "the edge has no path", remedy);
            None
        }
        [(first, _), (second, _), ..] => {
            let message = format!("the edge has two paths, `{first}` and `{second}`");
            reader.faults.push(table.place.clone(), table.item.as_str(), message, "keep one of them");
            None
        }
    };
    if reader.faults.len() > before { None } else { path.map(|path| EdgeItem { path, nodes, name, name_place, flux }) }
}

fn line(reader: &mut Reader<'_>, table: &Table<'_, '_>, value: &Value<'_>) -> Option<Path> {
    if reader.boolean(&table.item, "line", value)? {
        return Some(Path::Line);
    }
    let remedy = "write line = true for a straight edge, or give its curve instead";
    reader.faults.push(value.span(), table.item.as_str(), "`line` is false", remedy);
    None
}

fn arc(reader: &mut Reader<'_>, table: &Table<'_, '_>, value: &Value<'_>) -> Option<Path> {
    let arc = reader.table(&table.item, "arc", value, "{ centre = [0, 0], ccw = true }")?;
    reader.known_keys(&arc, "an arc", &["centre", "ccw"]);
    let centre = required_point(reader, &arc, "centre");
    let ccw = match arc.get("ccw") {
        Some(value) => reader.boolean(&arc.item, "ccw", value)?,
        None => true,
    };
    Some(Path::Arc { centre: centre?, turn: if ccw { Turn::CounterClockwise } else { Turn::Clockwise } })
}

fn parametric(reader: &mut Reader<'_>, table: &Table<'_, '_>) -> Option<Path> {
    if let (None, Some(graph), None) = (table.get("x"), table.get("y"), table.get("t")) {
        let of_x = graph.get_ref().as_str().filter(|text| Expression::parse(text, &["x"]).is_ok());
        let written = quote(of_x.unwrap_or("f(x)"));
        let message = "it has `y` without `x` and `t`";
        let remedy = format!("write {{ curve = {written} }} for y = f(x), or add `x` and `t` of a parametric curve");
        reader.faults.push(table.place.clone(), table.item.as_str(), message, remedy);
        return None;
    }
    let [x, y] = [("x", "\"cos(t)\""), ("y", "\"sin(t)\"")].map(|(key, example)| {
        let value = reader.required(table, key, example)?;
        formula(reader, table, key, value, "t")
    });
    let t = reader.required(table, "t", "[0, 3.14159]").and_then(|value| {
        let names = ["t0", "t1"].map(str::to_owned);
        let ends = reader.reals(&table.item, "t", value, "two numbers, [t0, t1]", "[0, 1]", names, limits::real)?;
        if ends[0] == ends[1] {
            let message = format!("`t` begins and ends at {}", limits::show(ends[0]));
            reader.faults.push(value.span(), table.item.as_str(), message, "give two different ends");
            return None;
        }
        Some(ends)
    });
    Some(Path::Parametric { x: x?, y: y?, t: t? })
}

fn formula(
    reader: &mut Reader<'_>,
    table: &Table<'_, '_>,
    key: &str,
    value: &Value<'_>,
    variable: &str,
) -> Option<Expression> {
    let example = if variable == "x" { "\"1 + 0.2*sin(pi*x)\"" } else { "\"cos(t)\"" };
    formula::read(reader, &table.item, key, value, &[variable], example)
}

/// The message and the remedy of an error of another crate: they are joined by a semicolon.
pub(super) fn split(error: &str) -> (String, String) {
    let (message, remedy) = error.split_once("; ").unwrap_or((error, "correct it"));
    (message.to_owned(), remedy.to_owned())
}

/// Fewest nodes of an edge that returns to its vertex, both its ends counted: a triangle.
const CLOSED_PATH_NODES: usize = 4;

/// The path through items that alternate as they should; `None`, with the fault noted, where an edge cannot be.
fn closed_path(
    reader: &mut Reader<'_>,
    item: &str,
    items: Vec<Item>,
    places: Vec<Range<usize>>,
    place: Range<usize>,
    prefix: &str,
) -> Option<Shape> {
    let (mut points, mut vertices, mut given) = (Vec::new(), Vec::new(), Vec::new());
    for (k, (found, place)) in items.into_iter().zip(places).enumerate() {
        let mark = |name_place| Mark { place, number: Some(k + 1), name_place };
        match found {
            Item::Vertex(point) => {
                points.push(point?);
                vertices.push(mark(None));
                given.push(None);
            }
            Item::Edge(edge) => {
                let edge = *edge?;
                // The item before an edge is a vertex, whose own edge this is.
                *given.last_mut()? = Some((mark(edge.name_place.clone()), edge));
            }
            Item::Neither => return None,
        }
    }
    let n = points.len();
    let mut outline = Outline { vertices: Vec::new(), edges: Vec::new() };
    let (mut edges, mut fluxes) = (Vec::new(), Vec::new());
    for (k, given) in given.into_iter().enumerate() {
        let (from, to) = (points[k], points[(k + 1) % n]);
        let default_name = format!("{prefix}e{}", k + 1);
        let (mark, curve, nodes, name, flux) = match given {
            None => (vertices[k].clone(), Curve::Line { from, to }, None, default_name, None),
            Some((mark, EdgeItem { path, nodes, name, flux, .. })) => {
                let curve = curve(path, from, to);
                (mark, curve, nodes, name.unwrap_or(default_name), flux)
            }
        };
        if n == 1 && !matches!(curve, Curve::Parametric { .. }) {
            let message = "this edge cannot lead from a vertex back to itself";
            let remedy = "split it at a second vertex, or give circle = { centre, radius } for a full circle";
            reader.faults.push(mark.place, item_number(item, mark.number.unwrap_or(1)), message, remedy);
            return None;
        }
        if let Some(count) = nodes.filter(|&count| n == 1 && count < CLOSED_PATH_NODES) {
            let message = format!("`nodes` of this closed edge is {count}: its first and last node are one");
            let remedy = format!("give at least {CLOSED_PATH_NODES}, or leave it out");
            reader.faults.push(mark.place, item_number(item, mark.number.unwrap_or(1)), message, remedy);
            return None;
        }
        outline.edges.push(OutlineEdge { name, curve, nodes });
        edges.push(mark);
        fluxes.push(flux);
    }
    outline.vertices = points;
    Some(Shape { outline, item: item.to_owned(), place, vertices, edges, fluxes })
}

fn curve(path: Path, from: Point, to: Point) -> Curve {
    match path {
        Path::Line => Curve::Line { from, to },
        Path::Graph(y) => Curve::Graph { y, from_x: from[0], to_x: to[0] },
        Path::Arc { centre, turn } => Curve::arc(centre, from, to, turn),
        Path::Parametric { x, y, t: [from_t, to_t] } => Curve::Parametric { x, y, from_t, to_t },
    }
}
