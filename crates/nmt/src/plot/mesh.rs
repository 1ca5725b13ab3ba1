//! The picture of a mesh.

use super::axes::View;
use super::colour::{Rgb, of_subdomain};
use super::crowd::{self, Apart};
use super::page::{
    Entry, OUTLINE, Symbol, counted, note, outlines, page_points, single_view, subdomain_entries, tint, with_one_frame,
};
use super::scene::{Point, Polyline, Precision, Scene, Shape, Stroke};
use super::simplify;
use super::topology::{Topology, long_lines};
use super::{Caption, Part};

/// Width of an edge's line relative to the mean length of edges.
const WIDTH_TO_LENGTH: f64 = 0.05;
/// Bounds of that width, in page units.
const WIDTH_BOUNDS: [f64; 2] = [0.12, 0.9];
/// Above this number of edges, coordinates are written to a tenth of a page unit: the bytes count, the difference is unseen.
const LARGE_MESH: usize = 30_000;
/// Share of black in the colour of edges.
const EDGE_SHADE: f64 = 0.35;

/// What the legend says of shaded parts.
const SHADED: &str = "shaded where edges are too short to be drawn: the darker, the shorter";

fn legend(parts: &[Part<'_>], is_shaded: bool) -> Vec<Entry> {
    let mut entries = entries(parts);
    if is_shaded {
        entries.push(Entry { symbol: Symbol::Nothing, text: SHADED.into() });
    }
    entries
}

fn entries(parts: &[Part<'_>]) -> Vec<Entry> {
    let about = |part: &Part<'_>| {
        let nodes = counted(part.xy.len(), "node", "nodes");
        format!("{nodes}, {}", counted(part.triangles.len(), "triangle", "triangles"))
    };
    if let [part] = parts {
        return vec![Entry { symbol: Symbol::Nothing, text: about(part) }];
    }
    let swatch =
        |k| Symbol::Swatch { fill: tint(of_subdomain(k)), line: of_subdomain(k).mixed(Rgb::BLACK, EDGE_SHADE) };
    subdomain_entries(parts, swatch, about)
}

/// A point where the frame stands at `origin`.
fn moved(p: Point, origin: Point) -> Point {
    [p[0] + origin[0], p[1] + origin[1]]
}

/// Mean length of edges in page units; infinite where there is none.
fn mean_length(points: &[Point], edges: &[[u32; 2]]) -> f64 {
    let length = |&[a, b]: &[u32; 2]| {
        let (p, q) = (points[a as usize], points[b as usize]);
        (q[0] - p[0]).hypot(q[1] - p[1])
    };
    if edges.is_empty() { f64::INFINITY } else { edges.iter().map(length).sum::<f64>() / edges.len() as f64 }
}

/// One part where the frame stands at the origin: the legend, which tells of shades, comes before its place is known.
struct Drawn {
    points: Vec<Point>,
    edges: Vec<[u32; 2]>,
    width: f64,
    crowd: Option<Apart>,
}

impl Drawn {
    fn of(part: &Part<'_>, is_crowded: bool, view: &View) -> Self {
        let points = page_points(part, &|p| view.to_page([0.0; 2], p));
        let edges = Topology::new(&points, part.triangles, |_| true).edges;
        let width = (WIDTH_TO_LENGTH * mean_length(&points, &edges)).clamp(WIDTH_BOUNDS[0], WIDTH_BOUNDS[1]);
        let crowd = if is_crowded { crowd::apart(&points, &edges, width) } else { None };
        Self { points, edges, width, crowd }
    }

    /// Its edges as lines, the frame at `origin`.
    fn web(&self, colour: Rgb, origin: Point) -> Shape {
        let edges = self.crowd.as_ref().map_or(&self.edges, |crowd| &crowd.drawn);
        let precision = if edges.len() > LARGE_MESH { Precision::Tenth } else { Precision::Hundredth };
        let thinned = |line: Vec<u32>| {
            let line: Vec<Point> = line.into_iter().map(|node| moved(self.points[node as usize], origin)).collect();
            // Less than what rounding moves a point by: only collinear points go.
            Polyline::open(simplify::open(&line, 0.005))
        };
        let lines = long_lines(&self.points, edges).into_iter().map(thinned).collect();
        Shape::Path { lines, fill: None, stroke: Some(Stroke::new(colour, self.width)), precision }
    }
}

/// The figure of the meshes of all parts.
pub(super) fn scene(caption: &Caption<'_>, parts: &[Part<'_>]) -> Scene {
    // Three edges to two triangles.
    let n_edges = parts.iter().map(|part| part.triangles.len()).sum::<usize>() * 3 / 2;
    let is_crowded = n_edges > crowd::ALL_DRAWN;
    let view = single_view(parts);
    let drawn: Vec<Drawn> = parts.iter().map(|part| Drawn::of(part, is_crowded, &view)).collect();
    let is_shaded = drawn.iter().any(|drawn| drawn.crowd.is_some());
    with_one_frame(caption, parts, "mesh", &legend(parts, is_shaded), |view, to_page| {
        let upper_left = to_page([view.corner[0], view.corner[1] + view.size[1] / view.scale]);
        if parts.iter().all(|part| part.triangles.is_empty() && part.loops.is_empty()) {
            return vec![note(view, upper_left, "no triangles")];
        }
        let (mut areas, mut webs, mut rims) = (Vec::new(), Vec::new(), Vec::new());
        for (number, (part, drawn)) in parts.iter().zip(&drawn).enumerate() {
            let (light, dark) = (tint(of_subdomain(number)), of_subdomain(number).mixed(Rgb::BLACK, EDGE_SHADE));
            let outline = outlines(part, &page_points(part, to_page));
            areas.push(Shape::area(outline.clone(), light));
            if let Some(crowd) = &drawn.crowd {
                let shapes = crowd.shades(light, dark, upper_left);
                areas.push(Shape::Clipped { id: number, within: outline.clone(), shapes });
            }
            webs.push(drawn.web(dark, upper_left));
            rims.push(Shape::lines(outline, OUTLINE));
        }
        let shapes = [areas, webs, rims].concat();
        vec![Shape::Group { id: "mesh", shapes }]
    })
}
