//! The picture of a cloud.

use super::axes::View;
use super::colour::{Rgb, of_subdomain};
use super::crowd;
use super::page::{
    Entry, Symbol, counted, enclosed_area, marks, note, outlines, page_points, single_view, subdomain_entries, tint,
    with_one_frame,
};
use super::scene::{MarkForm, Point, Scene, Shape, Stroke};
use super::{Caption, NodeMark, Part};
use std::collections::BTreeMap;

/// Diameter of an interior node relative to the spacing of nodes.
const SIZE_TO_SPACING: f64 = 0.36;
/// Bounds of that diameter, in page units: the lower still prints, the upper is that of a mark, not of a blot.
const SIZE_BOUNDS: [f64; 2] = [0.6, 6.0];
/// Sizes of marks of a graded cloud, each √½ of the one before: down to the least bound.
const MOST_CLASSES: u32 = 8;
/// Edge nodes relative to interior ones.
const EDGE_SIZE: f64 = 1.2;
/// Vertices relative to interior nodes, and their least size.
const VERTEX_SIZE: f64 = 1.35;
const LEAST_VERTEX: f64 = 3.0;
/// Edge nodes at least this large are rings.
const LEAST_RING: f64 = 3.6;
/// Size of marks in the legend.
const LEGEND_MARK: f64 = 7.0;
/// Share of black in the colour of edge nodes.
const EDGE_SHADE: f64 = 0.25;

const KINDS: [(NodeMark, [&str; 2]); 3] = [
    (NodeMark::Vertex, ["vertex", "vertices"]),
    (NodeMark::Edge, ["edge node", "edge nodes"]),
    (NodeMark::Interior, ["interior node", "interior nodes"]),
];

/// Look of one kind of nodes.
fn symbol(mark: NodeMark, size: f64, colour: Rgb) -> (MarkForm, f64, Rgb, Option<Rgb>) {
    let dark = colour.mixed(Rgb::BLACK, EDGE_SHADE);
    match mark {
        NodeMark::Vertex => (MarkForm::Square, (VERTEX_SIZE * size).max(LEAST_VERTEX), Rgb::BLACK, None),
        NodeMark::Edge => {
            let size = EDGE_SIZE * size;
            (MarkForm::Disc, size, dark, (size >= LEAST_RING).then_some(Rgb::WHITE))
        }
        NodeMark::Interior => (MarkForm::Disc, size, colour, None),
    }
}

fn mark_of(part: &Part<'_>, node: usize) -> NodeMark {
    part.marks.get(node).copied().unwrap_or(NodeMark::Interior)
}

fn legend(parts: &[Part<'_>], drawn_size: f64, n_drawn: Option<usize>) -> Vec<Entry> {
    let colour = if parts.len() > 1 { Rgb(0x6b6b6b) } else { of_subdomain(0) };
    let mut entries = Vec::new();
    for (mark, [one, many]) in KINDS {
        let count = parts.iter().map(|p| (0..p.xy.len()).filter(|&i| mark_of(p, i) == mark).count()).sum();
        if count > 0 {
            // Marks too small for rings are discs in the legend too.
            let (form, _, colour, heart) = symbol(mark, drawn_size, colour);
            let size = if mark == NodeMark::Interior { LEGEND_MARK - 1.0 } else { LEGEND_MARK };
            let symbol = Symbol::Mark { form, size, colour, heart };
            entries.push(Entry { symbol, text: counted(count, one, many) });
        }
    }
    if let Some(n_drawn) = n_drawn {
        let text =
            format!("{} drawn: one where many lie too close to be told apart", counted(n_drawn, "node", "nodes"));
        entries.push(Entry { symbol: Symbol::Nothing, text });
    }
    if parts.len() > 1 {
        let swatch = |k| Symbol::Swatch { fill: of_subdomain(k), line: of_subdomain(k).mixed(Rgb::BLACK, EDGE_SHADE) };
        entries.extend(subdomain_entries(parts, swatch, |part| counted(part.xy.len(), "node", "nodes")));
    }
    entries
}

/// Diameter of an interior node, from the room each node has on the page.
fn mark_size(view: &View, parts: &[Part<'_>]) -> f64 {
    let area_of = |part: &Part<'_>| enclosed_area(&outlines(part, &page_points(part, &|p| view.to_page([0.0; 2], p))));
    let area: f64 = parts.iter().map(area_of).sum();
    // Without an outline, the frame has to do.
    let area = if area > 0.0 { area } else { view.size[0] * view.size[1] };
    let n_nodes: usize = parts.iter().map(|part| part.xy.len()).sum();
    (SIZE_TO_SPACING * (area / n_nodes.max(1) as f64).sqrt()).clamp(SIZE_BOUNDS[0], SIZE_BOUNDS[1])
}

/// How many times √½ a node of a graded cloud is smaller than the largest mark, so that marks do not run into each other
/// where nodes are dense; 0 for all of a uniform one.
fn class_of(part: &Part<'_>, node: usize, largest: f64, scale: f64) -> u32 {
    let Some(spacing) = part.spacings.get(node) else { return 0 };
    let room = SIZE_TO_SPACING * spacing * scale / largest;
    (0..MOST_CLASSES).find(|&class| room >= class_factor(class + 1)).unwrap_or(MOST_CLASSES)
}

fn class_factor(class: u32) -> f64 {
    std::f64::consts::FRAC_1_SQRT_2.powi(class as i32)
}

/// Marks of one part of one size.
struct MarksOfOneSize {
    part: usize,
    /// Of [`KINDS`].
    kind: usize,
    class: u32,
    centres: Vec<Point>,
}

/// Places of the marks, from the last kind to the first, part by part; of crowded ones one in each place.
fn chosen(parts: &[Part<'_>], points: &[Vec<Point>], size: f64, scale: f64, is_crowded: bool) -> Vec<MarksOfOneSize> {
    let mut all = Vec::new();
    for (kind, (mark, _)) in KINDS.into_iter().enumerate().rev() {
        for (number, (part, points)) in parts.iter().zip(points).enumerate() {
            let of_this_kind = |&(i, p): &(usize, &Point)| mark_of(part, i) == mark && p.iter().all(|v| v.is_finite());
            let mut by_size: BTreeMap<u32, Vec<Point>> = BTreeMap::new();
            for (i, &p) in points.iter().enumerate().filter(of_this_kind) {
                by_size.entry(class_of(part, i, size, scale)).or_default().push(p);
            }
            all.extend(by_size.into_iter().map(|(class, centres)| {
                let centres = if is_crowded { crowd::one_in_each_place(centres) } else { centres };
                MarksOfOneSize { part: number, kind, class, centres }
            }));
        }
    }
    all
}

/// The figure of the nodes of all parts.
pub(super) fn scene(caption: &Caption<'_>, parts: &[Part<'_>]) -> Scene {
    let view = single_view(parts);
    let size = mark_size(&view, parts);
    let n_nodes: usize = parts.iter().map(|part| part.xy.len()).sum();
    let is_crowded = n_nodes > crowd::ALL_DRAWN;
    // Chosen where the frame stands at the origin: the legend, which tells how many, comes before its place is known.
    let at_origin: Vec<Vec<Point>> =
        parts.iter().map(|part| page_points(part, &|p| view.to_page([0.0; 2], p))).collect();
    let chosen = chosen(parts, &at_origin, size, view.scale, is_crowded);
    let n_drawn: usize = chosen.iter().map(|marks| marks.centres.len()).sum();
    let told = (is_crowded && n_drawn < n_nodes).then_some(n_drawn);
    with_one_frame(caption, parts, "nodes", &legend(parts, size, told), |view, to_page| {
        let upper_left = to_page([view.corner[0], view.corner[1] + view.size[1] / view.scale]);
        if parts.iter().all(|part| part.xy.is_empty()) {
            return vec![note(view, upper_left, "no nodes")];
        }
        let lines: Vec<_> = parts.iter().map(|part| outlines(part, &page_points(part, to_page))).collect();
        let mut shapes = Vec::new();
        for (number, lines) in lines.iter().enumerate() {
            shapes.push(Shape::area(lines.clone(), tint(of_subdomain(number))));
        }
        let line = Stroke::new(Rgb(0x808080), (0.25 * size).clamp(0.5, 1.0));
        shapes.extend(lines.into_iter().map(|lines| Shape::lines(lines, line)));
        for MarksOfOneSize { part, kind, class, centres } in &chosen {
            let centres = centres.iter().map(|p| [p[0] + upper_left[0], p[1] + upper_left[1]]).collect();
            let size = (size * class_factor(*class)).max(SIZE_BOUNDS[0]);
            let (form, size, colour, heart) = symbol(KINDS[*kind].0, size, of_subdomain(*part));
            shapes.extend(marks(centres, form, size, colour, heart));
        }
        vec![Shape::Group { id: "nodes", shapes }]
    })
}
