//! What the figures share: title, legend, outlines, and the page around one frame.

use super::axes::{Axes, Extent, View};
use super::colour::Rgb;
use super::contour::Surface;
use super::scene::{Anchor, MarkForm, Point, Polyline, Scene, Shape, Stroke};
use super::simplify;
use super::text::{CAP_HEIGHT, Run, Style, plain, single_line, width, wrapped};
use super::topology::Topology;
use super::{Caption, Part, is_drawable};

/// Intended width of a page; 1000 page units are meant for 180 mm of paper.
pub(super) const PAGE_WIDTH: f64 = 1000.0;
/// Width of a page below which title and legend are not squeezed.
const LEAST_PAGE_WIDTH: f64 = 460.0;
/// Free border of the page.
pub(super) const MARGIN: f64 = 16.0;
/// Size of the title.
pub(super) const TITLE_SIZE: f64 = 19.0;
/// From line to line of a title.
const TITLE_LINE: f64 = 1.25 * TITLE_SIZE;
/// Between the title and what is below it.
const TITLE_GAP: f64 = 12.0;
/// Most lines of a title.
const TITLE_LINES: usize = 3;
/// Size of legend texts.
const LEGEND_SIZE: f64 = 14.0;
/// From line to line of the legend.
const LEGEND_LINE: f64 = 22.0;
/// Between the axes and the legend.
const LEGEND_GAP: f64 = 10.0;
/// Between entries of the legend.
const ENTRY_GAP: f64 = 26.0;
/// Between the symbol of an entry and its text.
const SYMBOL_GAP: f64 = 7.0;
/// Width kept for a mark in the legend.
const MARK_ROOM: f64 = 9.0;
/// Size of the rectangle that shows the colour of a subdomain.
const SWATCH: [f64; 2] = [18.0, 12.0];
/// Most subdomains that the legend names.
const MOST_NAMED: usize = 16;
/// Longest name in the legend, in page units.
const LONGEST_NAME: f64 = 260.0;
/// Room of a single frame in page units.
const FRAME_ROOM: [f64; 2] = [PAGE_WIDTH - 2.0 * MARGIN - 80.0, 720.0];

/// Stroke of outlines.
pub(super) const OUTLINE: Stroke = Stroke { colour: Rgb::BLACK, width: 1.3, opacity: 1.0 };
/// Outlines are thinned by this many page units: less than a printer shows.
const OUTLINE_TOLERANCE: f64 = 0.05;
/// Share of white in the tint of a subdomain.
const TINT: f64 = 0.9;

/// Tint in which the area of a subdomain is filled.
pub(super) fn tint(colour: Rgb) -> Rgb {
    colour.mixed(Rgb::WHITE, TINT)
}

/// What stands before the text of a legend entry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Symbol {
    /// A mark; with a `heart` it is a ring.
    Mark {
        form: MarkForm,
        size: f64,
        colour: Rgb,
        heart: Option<Rgb>,
    },
    /// The colour of a subdomain.
    Swatch {
        fill: Rgb,
        line: Rgb,
    },
    Nothing,
}

impl Symbol {
    fn width(self) -> f64 {
        match self {
            Self::Mark { .. } => MARK_ROOM + SYMBOL_GAP,
            Self::Swatch { .. } => SWATCH[0] + SYMBOL_GAP,
            Self::Nothing => 0.0,
        }
    }

    fn draw(self, left: f64, middle: f64) -> Vec<Shape> {
        match self {
            Self::Mark { form, size, colour, heart } => {
                marks(vec![[left + 0.5 * MARK_ROOM, middle]], form, size, colour, heart)
            }
            Self::Swatch { fill, line } => {
                let rectangle = vec![Polyline::rectangle([left, middle - 0.5 * SWATCH[1]], SWATCH)];
                vec![Shape::area(rectangle.clone(), fill), Shape::lines(rectangle, Stroke::new(line, 1.0))]
            }
            Self::Nothing => Vec::new(),
        }
    }
}

/// Marks of one look; with a `heart` they are rings with a heart of that colour.
pub(super) fn marks(centres: Vec<Point>, form: MarkForm, size: f64, colour: Rgb, heart: Option<Rgb>) -> Vec<Shape> {
    let Some(heart) = heart else { return vec![Shape::Marks { centres, form, size, colour }] };
    let inner = Shape::Marks { centres: centres.clone(), form, size: 0.5 * size, colour: heart };
    vec![Shape::Marks { centres, form, size, colour }, inner]
}

/// An entry of the legend.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Entry {
    pub symbol: Symbol,
    pub text: String,
}

impl Entry {
    fn width(&self) -> f64 {
        self.symbol.width() + width(&plain(&self.text), LEGEND_SIZE)
    }
}

/// An entry for each subdomain, `about` it after its name; those beyond a limit are counted only.
pub(super) fn subdomain_entries(
    parts: &[Part<'_>],
    symbol: impl Fn(usize) -> Symbol,
    about: impl Fn(&Part<'_>) -> String,
) -> Vec<Entry> {
    let entry = |(number, part): (usize, &Part<'_>)| {
        let name = super::text::clipped(part.name, LEGEND_SIZE, LONGEST_NAME);
        let text = if name.is_empty() { about(part) } else { format!("{name}: {}", about(part)) };
        Entry { symbol: symbol(number), text }
    };
    let mut entries: Vec<Entry> = parts.iter().enumerate().take(MOST_NAMED).map(entry).collect();
    if parts.len() > MOST_NAMED {
        entries.push(Entry { symbol: Symbol::Nothing, text: format!("and {} more", parts.len() - MOST_NAMED) });
    }
    entries
}

/// `1 node`, `2 nodes`, `12 345 nodes`.
pub(super) fn counted(count: usize, one: &str, many: &str) -> String {
    let digits = count.to_string();
    let mut grouped = String::new();
    for (k, digit) in digits.chars().enumerate() {
        if digits.len() > 4 && k > 0 && (digits.len() - k).is_multiple_of(3) {
            grouped.push('\u{2009}');
        }
        grouped.push(digit);
    }
    format!("{grouped} {}", if count == 1 { one } else { many })
}

/// Entries broken into rows of at most `room`.
fn legend_rows(entries: &[Entry], room: f64) -> Vec<&[Entry]> {
    let (mut rows, mut first, mut used) = (Vec::new(), 0, 0.0);
    for (k, entry) in entries.iter().enumerate() {
        let grown = used + ENTRY_GAP + entry.width();
        if k > first && grown > room {
            rows.push(&entries[first..k]);
            (first, used) = (k, entry.width());
        } else {
            used = if k == first { entry.width() } else { grown };
        }
    }
    if first < entries.len() {
        rows.push(&entries[first..]);
    }
    rows
}

fn row_width(row: &[Entry]) -> f64 {
    row.iter().map(Entry::width).sum::<f64>() + ENTRY_GAP * row.len().saturating_sub(1) as f64
}

/// The title on a page of this width: its shapes and the height they take from the top margin.
pub(super) fn title(caption: &Caption<'_>, page_width: f64) -> (Vec<Shape>, f64) {
    let lines = wrapped(caption.title, TITLE_SIZE, page_width - 2.0 * MARGIN, TITLE_LINES);
    let baseline = |k: usize| MARGIN + CAP_HEIGHT * TITLE_SIZE + k as f64 * TITLE_LINE;
    let line = |(k, text)| Shape::text([0.5 * page_width, baseline(k)], TITLE_SIZE, Anchor::Middle, plain(text));
    let height = if lines.is_empty() { 0.0 } else { baseline(lines.len() - 1) - MARGIN + 0.2 * TITLE_SIZE + TITLE_GAP };
    (lines.into_iter().enumerate().map(line).collect(), height)
}

/// Width that title and content want, at least [`LEAST_PAGE_WIDTH`].
pub(super) fn page_width(caption: &Caption<'_>, content: f64) -> f64 {
    let title = width(&plain(single_line(caption.title)), TITLE_SIZE).min(600.0);
    (content.max(title) + 2.0 * MARGIN).max(LEAST_PAGE_WIDTH).ceil()
}

/// The view of all parts on a page with one frame.
pub(super) fn single_view(parts: &[Part<'_>]) -> View {
    View::fit(&Extent::of(parts.iter()), FRAME_ROOM)
}

/// A page with one frame: title, axes, what `draw` puts into them (given the map from the plane to the page), legend.
pub(super) fn with_one_frame(
    caption: &Caption<'_>,
    parts: &[Part<'_>],
    kind: &str,
    legend: &[Entry],
    draw: impl FnOnce(&View, &dyn Fn([f64; 2]) -> Point) -> Vec<Shape>,
) -> Scene {
    let axes = Axes::new(single_view(parts), caption.units);
    let margins = axes.margins();
    let [frame_width, frame_height] = axes.view.size;
    let content = margins.left + frame_width + margins.right;
    let widest_entry = legend.iter().map(Entry::width).fold(0.0, f64::max);
    let page_width = page_width(caption, content.max(widest_entry));
    let (mut shapes, title_height) = title(caption, page_width);
    // Where there is room, the frame itself stands in the middle, under the title; otherwise frame and labels do.
    let centred = 0.5 * (page_width - frame_width);
    let left = if centred >= margins.left.max(margins.right) + MARGIN {
        centred
    } else {
        0.5 * (page_width - content) + margins.left
    };
    let origin = [left, MARGIN + title_height + margins.top];
    shapes.extend(draw(&axes.view, &|p| axes.view.to_page(origin, p)));
    shapes.push(axes.draw(origin));

    let mut y = origin[1] + frame_height + margins.bottom;
    let rows = legend_rows(legend, page_width - 2.0 * MARGIN);
    if !rows.is_empty() {
        y += LEGEND_GAP;
    }
    let mut legend_shapes = Vec::new();
    for row in rows {
        let mut x = 0.5 * (page_width - row_width(row));
        let middle = y + 0.5 * LEGEND_LINE;
        for entry in row {
            legend_shapes.extend(entry.symbol.draw(x, middle));
            let at = [x + entry.symbol.width(), super::axes::centred_baseline(middle, LEGEND_SIZE)];
            legend_shapes.push(Shape::text(at, LEGEND_SIZE, Anchor::Start, plain(&entry.text)));
            x += entry.width() + ENTRY_GAP;
        }
        y += LEGEND_LINE;
    }
    shapes.push(Shape::Group { id: "legend", shapes: legend_shapes });
    Scene { width: page_width, height: (y + MARGIN).ceil(), description: description(caption, kind), shapes }
}

/// `Title: kind`, for readers who hear the picture.
pub(super) fn description(caption: &Caption<'_>, kind: &str) -> String {
    let title = single_line(caption.title);
    if title.is_empty() { kind.to_owned() } else { format!("{title}: {kind}") }
}

/// A note in the middle of a frame that has nothing to show.
pub(super) fn note(view: &View, origin: Point, text: &str) -> Shape {
    let at = [origin[0] + 0.5 * view.size[0], origin[1] + 0.5 * view.size[1]];
    Shape::text(at, LEGEND_SIZE, Anchor::Middle, vec![Run::new(text, Style::Italic)])
}

/// All nodes of a part on the page; NaN stays NaN.
pub(super) fn page_points(part: &Part<'_>, to_page: &dyn Fn([f64; 2]) -> Point) -> Vec<Point> {
    let page_point = |&p: &[f64; 2]| if p.iter().all(|&v| is_drawable(v)) { to_page(p) } else { [f64::NAN; 2] };
    part.xy.iter().map(page_point).collect()
}

/// Closed outlines of a part: its loops or, where it has none, the rim of its mesh.
pub(super) fn outlines(part: &Part<'_>, points: &[Point]) -> Vec<Polyline> {
    let rings: Vec<Vec<Point>> = if part.loops.is_empty() && !part.triangles.is_empty() {
        let topology = Topology::new(points, part.triangles, |_| true);
        let nothing = vec![0.0; points.len()];
        let whole = Surface::new(points, &nothing, &topology).at_least(f64::NEG_INFINITY);
        whole.into_iter().map(|ring| ring.into_iter().flat_map(|piece| piece.points).collect()).collect()
    } else {
        let point = |&node: &u32| points.get(node as usize).copied().filter(|p| p.iter().all(|v| v.is_finite()));
        part.loops.iter().map(|ring| ring.iter().filter_map(point).collect()).collect()
    };
    rings
        .into_iter()
        .map(|ring| simplify::closed(&ring, OUTLINE_TOLERANCE))
        .filter(|ring| ring.len() > 1)
        .map(Polyline::closed)
        .collect()
}

/// Area enclosed by closed lines in square page units: that of the largest less that of all others, which are its holes.
pub(super) fn enclosed_area(lines: &[Polyline]) -> f64 {
    let area = |line: &Polyline| {
        let around = line.points.iter().zip(line.points.iter().cycle().skip(1));
        around.map(|(p, q)| 0.5 * (p[0] * q[1] - p[1] * q[0])).sum::<f64>().abs()
    };
    let areas: Vec<f64> = lines.iter().map(area).collect();
    let largest = areas.iter().copied().fold(0.0, f64::max);
    (2.0 * largest - areas.iter().sum::<f64>()).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn legend_rows_keep_within_the_page_and_lose_no_entry() {
        let entry = |n: usize| Entry { symbol: Symbol::Nothing, text: "x".repeat(n) };
        let entries: Vec<Entry> = [10, 30, 5, 5, 60, 20, 1].map(entry).into();
        let rows = legend_rows(&entries, 400.0);
        assert_eq!(rows.concat(), entries);
        assert!(rows.iter().all(|row| row.len() == 1 || row_width(row) <= 400.0));
        assert!(legend_rows(&[], 400.0).is_empty());
    }

    #[test]
    fn long_counts_are_grouped() {
        assert_eq!(counted(1, "node", "nodes"), "1 node");
        assert_eq!(counted(9999, "node", "nodes"), "9999 nodes");
        assert_eq!(counted(1_234_567, "node", "nodes"), "1\u{2009}234\u{2009}567 nodes");
    }

    #[test]
    fn holes_are_taken_from_the_area() {
        let square = |size: f64| Polyline::rectangle([0.0, 0.0], [size, size]);
        assert_eq!(enclosed_area(&[square(1.0), square(4.0), square(2.0)]), 11.0);
        assert_eq!(enclosed_area(&[]), 0.0);
    }

    #[test]
    fn without_loops_the_rim_of_the_mesh_is_the_outline() {
        let xy = [[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]];
        let part =
            Part { name: "", xy: &xy, marks: &[], spacings: &[], loops: &[], triangles: &[[0, 1, 2], [0, 2, 3]] };
        assert_eq!(enclosed_area(&outlines(&part, &xy)), 100.0);
    }
}
