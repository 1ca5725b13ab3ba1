//! The picture of a solution, of torsion or of a Poisson problem: four panels of filled contours, each with its colour bar;
//! and that of its error, one such panel.

use super::axes::{Axes, Extent, LEAST_FRAME, Margins, View};
use super::colour::{Map, Rgb};
use super::contour::{Loop, Surface};
use super::page::{
    MARGIN, OUTLINE, PAGE_WIDTH, TITLE_SIZE, description, note, outlines, page_points, page_width, title,
};
use super::scale::{POWER_GAP, Scale, Weighed};
use super::scene::{Anchor, Point, Polyline, Precision, Scene, Shape, Stroke};
use super::simplify;
use super::text::{Run, Style, width};
use super::topology::Topology;
use super::{Caption, Part, is_drawable};

/// Contours are thinned by this many page units.
const TOLERANCE: f64 = 0.1;
/// Contour lines: seen, but behind the colours.
const CONTOUR_STROKE: Stroke = Stroke { colour: Rgb::BLACK, width: 0.5, opacity: 0.45 };
/// Size of panel titles.
const PANEL_TITLE_SIZE: f64 = 15.0;
/// From the top of a cell to the frame: the panel title stands there.
const HEAD: f64 = 26.0;
/// Between frame and colour bar.
const BAR_GAP: f64 = 12.0;
/// Between cells.
const CELL_GAP: [f64; 2] = [28.0, 18.0];
/// Width that labels and colour bar take besides a frame, for choosing the arrangement before they are known.
const USUAL_SIDES: f64 = 140.0;
/// Height that title and labels take besides a frame, likewise.
const USUAL_ENDS: f64 = 75.0;
/// Largest height of the page: with its width it is as an A4 page.
const PAGE_HEIGHT: f64 = 1300.0;
/// Two by two panels are kept unless another arrangement draws the section larger by this factor.
const WORTH_REARRANGING: f64 = 1.2;
/// A component of the stress smaller than this share of the largest stress is rounding, hence zero.
const NOISE_REL: f64 = 1.0e-9;

/// One of the four fields: how it is drawn.
#[derive(Clone, Copy, PartialEq)]
pub(super) struct Panel {
    name: &'static str,
    symbol: &'static str,
    subscript: &'static str,
    map: Map,
    id: &'static str,
}

/// The letter of each panel.
const LETTERS: [char; 4] = ['a', 'b', 'c', 'd'];

/// Torsion: F, τ_zx, τ_zy, τ.
pub(super) const TORSION: [Panel; 4] = [
    Panel { name: "Prandtl function", symbol: "F", subscript: "", map: Map::Sequential, id: "F" },
    Panel { name: "Shear stress", symbol: "τ", subscript: "zx", map: Map::Diverging, id: "tau-zx" },
    Panel { name: "Shear stress", symbol: "τ", subscript: "zy", map: Map::Diverging, id: "tau-zy" },
    Panel { name: "Resultant shear stress", symbol: "τ", subscript: "", map: Map::Sequential, id: "tau" },
];

/// A Poisson problem: u, its derivatives, the magnitude of its gradient.
pub(super) const POISSON: [Panel; 4] = [
    Panel { name: "Solution", symbol: "u", subscript: "", map: Map::Sequential, id: "u" },
    Panel { name: "Derivative", symbol: "u", subscript: ",x", map: Map::Diverging, id: "u-x" },
    Panel { name: "Derivative", symbol: "u", subscript: ",y", map: Map::Diverging, id: "u-y" },
    Panel { name: "Size of the gradient", symbol: "|grad u|", subscript: "", map: Map::Sequential, id: "gradient" },
];

/// Where the error of J comes from.
pub(super) const INDICATOR: [Panel; 1] = [Panel {
    name: "Density e of the error of J:",
    symbol: "log₁₀ e",
    subscript: "",
    map: Map::Sequential,
    id: "indicator",
}];

/// The last panel of a Poisson problem whose exact solution is known.
pub(super) const ERROR: Panel =
    Panel { name: "Error", symbol: "u − u", subscript: "exact", map: Map::Diverging, id: "error" };

impl Panel {
    /// `(a) Prandtl function F`, without the words where there is no room for them; a panel alone has no letter.
    fn title(&self, letter: Option<char>, room: f64) -> Vec<Run> {
        let letter = letter.map_or(String::new(), |letter| format!("({letter}) "));
        let build = |words: String| {
            let mut runs = vec![Run::upright(words), Run::new(self.symbol, Style::Italic)];
            if !self.subscript.is_empty() {
                runs.push(Run::new(self.subscript, Style::Subscript));
            }
            runs
        };
        let long = build(format!("{letter}{} ", self.name));
        if width(&long, PANEL_TITLE_SIZE) <= room { long } else { build(letter) }
    }
}

/// Columns and rows of panels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Arrangement {
    columns: usize,
    rows: usize,
}

impl Arrangement {
    /// Room for one frame.
    fn room(self) -> [f64; 2] {
        let share = |whole: f64, n: usize, gap: f64, beside: f64| (whole - gap * (n - 1) as f64) / n as f64 - beside;
        let room = [
            share(PAGE_WIDTH - 2.0 * MARGIN, self.columns, CELL_GAP[0], USUAL_SIDES),
            share(PAGE_HEIGHT - 2.0 * MARGIN - 2.0 * TITLE_SIZE, self.rows, CELL_GAP[1], USUAL_ENDS),
        ];
        room.map(|r| r.max(LEAST_FRAME))
    }

    /// Two by two, or one column or one row where a slender section is drawn larger so; of one panel there is one.
    fn best(extent: &Extent, panels: usize) -> Self {
        if panels == 1 {
            return Self { columns: 1, rows: 1 };
        }
        let scale = |a: Self| View::fit(extent, a.room()).scale;
        let square = Self { columns: 2, rows: 2 };
        [Self { columns: 1, rows: 4 }, Self { columns: 4, rows: 1 }].into_iter().fold(square, |best, other| {
            let factor = if best == square { WORTH_REARRANGING } else { 1.0 };
            if scale(other) > factor * scale(best) { other } else { best }
        })
    }
}

/// The figure of fields on all parts: for each the values of the `panels`, four or one; `size`, the largest magnitude of the
/// vector whose components are those of the signed panels, tells what is rounding in them.
pub(super) fn scene<const N: usize>(
    caption: &Caption<'_>,
    panels: &[Panel; N],
    parts: &[(Part<'_>, [&[f64]; N])],
    size: impl Fn(&Panel) -> f64,
) -> Scene {
    let extent = Extent::of(parts.iter().map(|(part, _)| part));
    let arrangement = Arrangement::best(&extent, N);
    let axes = Axes::new(View::fit(&extent, arrangement.room()), caption.units);
    let Margins { left, right, top, bottom } = axes.margins();
    let head = HEAD.max(top);
    let [frame_width, frame_height] = axes.view.size;

    let values = |k: usize| {
        parts.iter().flat_map(move |(part, fields)| fields[k][..fields[k].len().min(part.xy.len())].iter().copied())
    };
    let noise: [f64; N] = std::array::from_fn(|k| {
        let own = if panels[k].is_signed() { largest(values(k)) } else { 0.0 };
        NOISE_REL * size(&panels[k]).max(own)
    });
    let areas = parts
        .iter()
        .any(|(part, _)| !part.spacings.is_empty())
        .then(|| parts.iter().map(|(part, _)| node_areas(part)).collect::<Vec<_>>());
    let topologies: Vec<Option<Topology>> = parts.iter().map(|(part, fields)| common_topology(part, fields)).collect();
    let scales: [Option<Scale>; N] = std::array::from_fn(|k| match &areas {
        None => Scale::new(values(k), panels[k].map, noise[k]),
        Some(areas) => {
            let of_part = |((part, fields), areas): (&(Part<'_>, [&[f64]; N]), &Vec<f64>)| {
                let values = fields[k].iter().take(part.xy.len()).zip(areas);
                values.map(|(&value, &weight)| Weighed { value, weight }).collect::<Vec<_>>()
            };
            Scale::weighed(parts.iter().zip(areas).flat_map(of_part), panels[k].map, noise[k])
        }
    });
    let bars = scales.iter().flatten().map(|scale| scale.bar_width(frame_height)).fold(0.0, f64::max);
    let cell = [left + frame_width + right.max(BAR_GAP + bars), head + frame_height + bottom];
    let total = |k: usize, n: usize| cell[k] * n as f64 + CELL_GAP[k] * (n - 1) as f64;

    let content = total(0, arrangement.columns);
    let page_width = page_width(caption, content);
    let (mut shapes, title_height) = title(caption, page_width);
    let corner = [0.5 * (page_width - content), MARGIN + title_height];
    for (number, (panel, scale)) in panels.iter().zip(&scales).enumerate() {
        let (column, row) = (number % arrangement.columns, number / arrangement.columns);
        let x = corner[0] + column as f64 * (cell[0] + CELL_GAP[0]) + left;
        let y = corner[1] + row as f64 * (cell[1] + CELL_GAP[1]) + head;
        let fields: Vec<Field> = parts
            .iter()
            .zip(&topologies)
            .map(|((part, fields), topology)| Field { part, values: fields[number], topology: topology.as_ref() })
            .collect();
        let title = panel.title(LETTERS.get(number).copied().filter(|_| N > 1), frame_width);
        let drawn = panel_shapes(scale.as_ref(), &fields, noise[number], &axes, [x, y], title);
        shapes.push(Shape::Group { id: panel.id, shapes: drawn });
    }
    let height = corner[1] + total(1, arrangement.rows) + MARGIN;
    Scene { width: page_width, height: height.ceil(), description: description(caption, "solution"), shapes }
}

/// One field on one part.
struct Field<'a> {
    part: &'a Part<'a>,
    values: &'a [f64],
    /// Where it is that of all fields.
    topology: Option<&'a Topology>,
}

/// The triangulation of all fields at once, where every node has a value of each.
fn common_topology(part: &Part<'_>, fields: &[&[f64]]) -> Option<Topology> {
    let is_whole = |values: &&[f64]| values.get(..part.xy.len()).is_some_and(|v| v.iter().all(|&v| is_drawable(v)));
    // Orientation and area do not depend on where on the page it stands, but for the direction of y.
    let points = || page_points(part, &|p| [p[0], -p[1]]);
    fields.iter().all(is_whole).then(|| Topology::new(&points(), part.triangles, |_| true))
}

fn panel_shapes(
    scale: Option<&Scale>,
    parts: &[Field<'_>],
    noise: f64,
    axes: &Axes,
    origin: Point,
    title: Vec<Run>,
) -> Vec<Shape> {
    let [frame_width, frame_height] = axes.view.size;
    let mut shapes = Vec::new();
    let mut rims = Vec::new();
    for Field { part, values, topology } in parts {
        let points = page_points(part, &|p| axes.view.to_page(origin, p));
        rims.extend(outlines(part, &points));
        if let Some(scale) = scale {
            // Rounding about zero would draw its own islands: below the noise, zero is zero.
            let denoised: Vec<f64> = values.iter().map(|&v| if v.abs() < noise { 0.0 } else { v }).collect();
            let has_value = |node: usize| denoised.get(node).is_some_and(|&v| is_drawable(v));
            let own = topology.is_none().then(|| Topology::new(&points, part.triangles, has_value));
            let surface = topology.or(own.as_ref()).map(|topology| Surface::new(&points, &denoised, topology));
            shapes.extend(surface.iter().flat_map(|surface| filled_contours(part, surface, &denoised, scale, noise)));
        }
    }
    shapes.push(Shape::lines(rims, OUTLINE));
    match scale {
        Some(scale) => shapes.push(scale.draw_bar([origin[0] + frame_width + BAR_GAP, origin[1]], frame_height)),
        None => shapes.push(note(&axes.view, origin, "no values")),
    }
    shapes.push(axes.draw(origin));
    let title_at = [origin[0] + 0.5 * frame_width, origin[1] - POWER_GAP];
    shapes.push(Shape::text(title_at, PANEL_TITLE_SIZE, Anchor::Middle, title));
    shapes
}

/// Largest magnitude of the drawable of `values`.
pub(super) fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.filter(|&v| is_drawable(v)).fold(0.0, |most: f64, v| most.max(v.abs()))
}

impl Panel {
    /// True for a field with a sign.
    pub(super) fn is_signed(&self) -> bool {
        self.map == Map::Diverging
    }
}

/// Bands of colour from the lowest, each painted over the one below, and the lines between them.
fn filled_contours(part: &Part<'_>, surface: &Surface<'_>, values: &[f64], scale: &Scale, noise: f64) -> Vec<Shape> {
    let (mut shapes, mut contours) = (Vec::new(), Vec::new());
    // Where the field is zero over whole triangles, its level 0 is an area, and a line around that means nothing.
    let is_zero = |node: &u32| values.get(*node as usize) == Some(&0.0);
    let zero_is_an_area = part.triangles.iter().any(|triangle| triangle.iter().all(is_zero));
    for band in if zero_is_an_area { scale.bands_about_zero(noise) } else { scale.bands() } {
        let mut areas = Vec::new();
        for ring in surface.at_least(band.from) {
            let (area, lines) = thinned(&ring);
            areas.extend(area);
            if !(zero_is_an_area && band.from.abs() <= noise) {
                contours.extend(lines);
            }
        }
        shapes.push(Shape::area(areas, band.colour));
    }
    let stroke = Some(CONTOUR_STROKE);
    shapes.push(Shape::Path { lines: contours, fill: None, stroke, precision: Precision::Hundredth });
    shapes
}

/// A loop as the polygon to fill and the contour lines on it, both through the same points.
fn thinned(ring: &Loop) -> (Option<Polyline>, Vec<Polyline>) {
    let (mut area, mut lines) = (Vec::new(), Vec::new());
    if let [piece] = ring.as_slice() {
        area = simplify::closed(&piece.points[..piece.points.len() - 1], TOLERANCE);
        if piece.on_level {
            lines.push(Polyline::closed(area.clone()));
        }
    } else {
        for piece in ring {
            let line = simplify::open(&piece.points, TOLERANCE);
            area.extend_from_slice(&line[1..]);
            if piece.on_level {
                lines.push(Polyline::open(line));
            }
        }
    }
    let is_area = area.len() > 2;
    (is_area.then(|| Polyline::closed(area)), if is_area { lines } else { Vec::new() })
}

/// What each node of a part stands for: a third of the triangles around it.
fn node_areas(part: &Part<'_>) -> Vec<f64> {
    let mut areas = vec![0.0; part.xy.len()];
    for triangle in part.triangles {
        let corners = triangle.map(|node| part.xy.get(node as usize).copied());
        let [Some(a), Some(b), Some(c)] = corners else { continue };
        let area = 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])).abs();
        triangle.iter().for_each(|&node| areas[node as usize] += area / 3.0);
    }
    areas
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slender_sections_are_stacked_along_their_length() {
        let best = |w: f64, h: f64| {
            let a = Arrangement::best(&Extent { min: [0.0; 2], max: [w, h] }, 4);
            (a.columns, a.rows)
        };
        assert_eq!(best(1.0, 1.0), (2, 2));
        assert_eq!(best(1e6, 0.7e6), (2, 2));
        assert_eq!(best(20.0, 1.0), (1, 4));
        assert_eq!(best(1.0, 20.0), (4, 1));
    }

    #[test]
    fn a_panel_without_room_keeps_its_symbol() {
        let text = |room: f64| TORSION[1].title(Some('b'), room).into_iter().map(|r| r.text).collect::<String>();
        assert_eq!(text(300.0), "(b) Shear stress τzx");
        assert_eq!(text(100.0), "(b) τzx");
    }
}
