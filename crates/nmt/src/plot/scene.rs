//! A figure as data: shapes in page units, `x` to the right, `y` down.

use super::colour::Rgb;
use super::text::Run;

/// A point of the page.
pub(super) type Point = [f64; 2];

/// Straight segments from point to point.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Polyline {
    pub points: Vec<Point>,
    pub closed: bool,
}

impl Polyline {
    pub fn open(points: Vec<Point>) -> Self {
        Self { points, closed: false }
    }

    pub fn closed(points: Vec<Point>) -> Self {
        Self { points, closed: true }
    }

    /// Rectangle with its corner of least coordinates at `at`.
    pub fn rectangle(at: Point, size: Point) -> Self {
        let [x, y] = at;
        Self::closed(vec![at, [x + size[0], y], [x + size[0], y + size[1]], [x, y + size[1]]])
    }
}

/// How a line is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stroke {
    pub colour: Rgb,
    pub width: f64,
    /// 1 is opaque.
    pub opacity: f64,
}

impl Stroke {
    pub fn new(colour: Rgb, width: f64) -> Self {
        Self { colour, width, opacity: 1.0 }
    }
}

/// How exactly a path is written: to this fraction of a page unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Precision {
    /// 0.01: below what any printer shows.
    Hundredth,
    /// 0.1: for meshes so large that the bytes count.
    Tenth,
}

/// Form of a mark.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum MarkForm {
    Disc,
    Square,
}

/// Which end of a text its position names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

/// Which way a text runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Direction {
    Rightwards,
    Upwards,
}

/// A line of text; `at` lies on its baseline.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Text {
    pub at: Point,
    pub size: f64,
    pub anchor: Anchor,
    pub direction: Direction,
    pub runs: Vec<Run>,
}

/// One thing to draw.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Shape {
    /// Polygons and lines of one look; where closed ones overlap, the even-odd rule says what is inside.
    Path { lines: Vec<Polyline>, fill: Option<Rgb>, stroke: Option<Stroke>, precision: Precision },
    /// Marks of one look.
    Marks { centres: Vec<Point>, form: MarkForm, size: f64, colour: Rgb },
    /// A line of text.
    Text(Text),
    /// Shapes, seen within closed lines only (even-odd); `id` is their number among such shapes.
    Clipped { id: usize, within: Vec<Polyline>, shapes: Vec<Shape> },
    /// Shapes under one name, for those who edit the picture.
    Group { id: &'static str, shapes: Vec<Shape> },
}

impl Shape {
    /// Lines without filling.
    pub fn lines(lines: Vec<Polyline>, stroke: Stroke) -> Self {
        Self::Path { lines, fill: None, stroke: Some(stroke), precision: Precision::Hundredth }
    }

    /// Areas without an outline.
    pub fn area(lines: Vec<Polyline>, fill: Rgb) -> Self {
        Self::Path { lines, fill: Some(fill), stroke: None, precision: Precision::Hundredth }
    }

    /// A rightward text.
    pub fn text(at: Point, size: f64, anchor: Anchor, runs: Vec<Run>) -> Self {
        Self::Text(Text { at, size, anchor, direction: Direction::Rightwards, runs })
    }
}

/// A page and all that is on it, in the order of drawing.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Scene {
    pub width: f64,
    pub height: f64,
    /// For readers who hear the picture; not drawn.
    pub description: String,
    pub shapes: Vec<Shape>,
}
