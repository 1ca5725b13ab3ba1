//! The picture of a mesh.

use super::colour::{Rgb, of_subdomain};
use super::page::{
    Entry, OUTLINE, Symbol, counted, note, outlines, page_points, subdomain_entries, tint, with_one_frame,
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

fn legend(parts: &[Part<'_>]) -> Vec<Entry> {
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

/// Mean length of edges in page units; infinite where there is none.
fn mean_length(points: &[Point], edges: &[[u32; 2]]) -> f64 {
    let length = |&[a, b]: &[u32; 2]| {
        let (p, q) = (points[a as usize], points[b as usize]);
        (q[0] - p[0]).hypot(q[1] - p[1])
    };
    if edges.is_empty() { f64::INFINITY } else { edges.iter().map(length).sum::<f64>() / edges.len() as f64 }
}

/// The figure of the meshes of all parts.
pub(super) fn scene(caption: &Caption<'_>, parts: &[Part<'_>]) -> Scene {
    with_one_frame(caption, parts, "mesh", &legend(parts), |view, to_page| {
        if parts.iter().all(|part| part.triangles.is_empty() && part.loops.is_empty()) {
            let upper_left = to_page([view.corner[0], view.corner[1] + view.size[1] / view.scale]);
            return vec![note(view, upper_left, "no triangles")];
        }
        let (mut areas, mut webs, mut rims) = (Vec::new(), Vec::new(), Vec::new());
        for (number, part) in parts.iter().enumerate() {
            let points = page_points(part, to_page);
            let edges = Topology::new(&points, part.triangles, |_| true).edges;
            let width = (WIDTH_TO_LENGTH * mean_length(&points, &edges)).clamp(WIDTH_BOUNDS[0], WIDTH_BOUNDS[1]);
            let precision = if edges.len() > LARGE_MESH { Precision::Tenth } else { Precision::Hundredth };
            let thinned = |line: Vec<u32>| {
                let line: Vec<Point> = line.into_iter().map(|node| points[node as usize]).collect();
                // Less than what rounding moves a point by: only collinear points go.
                Polyline::open(simplify::open(&line, 0.005))
            };
            let lines = long_lines(&points, &edges).into_iter().map(thinned).collect();
            let colour = of_subdomain(number);
            let stroke = Some(Stroke::new(colour.mixed(Rgb::BLACK, EDGE_SHADE), width));
            let outline = outlines(part, &points);
            areas.push(Shape::area(outline.clone(), tint(colour)));
            webs.push(Shape::Path { lines, fill: None, stroke, precision });
            rims.push(Shape::lines(outline, OUTLINE));
        }
        let shapes = [areas, webs, rims].concat();
        vec![Shape::Group { id: "mesh", shapes }]
    })
}
