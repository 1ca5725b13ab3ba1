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

/// Diameter of an interior node relative to the spacing of nodes.
const SIZE_TO_SPACING: f64 = 0.36;
/// Bounds of that diameter, in page units: the lower still prints, the upper is that of a mark, not of a blot.
const SIZE_BOUNDS: [f64; 2] = [0.6, 6.0];
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

/// Places of the marks of each part, by kind in the order of [`KINDS`]; of crowded ones one in each place.
fn centres(parts: &[Part<'_>], points: &[Vec<Point>], is_crowded: bool) -> Vec<[Vec<Point>; 3]> {
    let of_part = |(part, points): (&Part<'_>, &Vec<Point>)| {
        let mut centres: [Vec<Point>; 3] = std::array::from_fn(|_| Vec::new());
        for (node, &p) in points.iter().enumerate().filter(|(_, p)| p.iter().all(|v| v.is_finite())) {
            let mark = mark_of(part, node);
            let kind = KINDS.iter().position(|(kind, _)| *kind == mark);
            kind.into_iter().for_each(|kind| centres[kind].push(p));
        }
        if is_crowded { centres.map(crowd::one_in_each_place) } else { centres }
    };
    parts.iter().zip(points).map(of_part).collect()
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
    let chosen = centres(parts, &at_origin, is_crowded);
    let n_drawn: usize = chosen.iter().flatten().map(Vec::len).sum();
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
        for (kind, (mark, _)) in KINDS.into_iter().enumerate().rev() {
            for (number, own) in chosen.iter().enumerate() {
                let centres = own[kind].iter().map(|p| [p[0] + upper_left[0], p[1] + upper_left[1]]).collect();
                let (form, size, colour, heart) = symbol(mark, size, of_subdomain(number));
                shapes.extend(marks(centres, form, size, colour, heart));
            }
        }
        vec![Shape::Group { id: "nodes", shapes }]
    })
}
