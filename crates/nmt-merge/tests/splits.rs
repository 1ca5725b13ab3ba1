//! Sections cut in two at random, each part with a density of its own: what they share is found, conforms and welds.

use nmt_cloud::{Cloud, CloudParams, Grading, Section, generate};
use nmt_curve::{Curve, Expression, Outline, Turn};
use nmt_geom::Point;
use nmt_geom::point::{cross, distance, sub};
use nmt_merge::{MergeError, MeshSide, Planned, Side, common_edges, conform, weld};
use nmt_tri::Mesh;
use proptest::prelude::*;

/// A convex polygon of eight corners, its radii between 0.8 and 1.
fn octagon(radii: [f64; 8]) -> Vec<Point> {
    let corner = |(k, r): (usize, f64)| {
        let (sine, cosine) = (std::f64::consts::TAU * k as f64 / 8.0).sin_cos();
        [r * cosine, r * sine]
    };
    radii.into_iter().enumerate().map(corner).collect()
}

/// The curve of the cut from `p` to `q`, in one of its forms.
fn cut(p: Point, q: Point, bulge: f64, form: usize) -> Curve {
    let (chord, length) = (sub(q, p), distance(p, q));
    let half = 0.5 * length;
    if form == 0 || bulge == 0.0 {
        return Curve::Line { from: p, to: q };
    }
    // Circle through both ends, its sagitta `bulge` of the half chord.
    let sagitta = bulge * half;
    let radius = (half * half + sagitta * sagitta) / (2.0 * sagitta.abs());
    let normal = [-chord[1] / length, chord[0] / length];
    let to_centre = (radius - sagitta.abs()) * -sagitta.signum();
    let centre = [0, 1].map(|d| 0.5 * (p[d] + q[d]) + to_centre * normal[d]);
    let turn = if sagitta > 0.0 { Turn::Clockwise } else { Turn::CounterClockwise };
    let arc = Curve::arc(centre, p, q, turn);
    let Curve::Arc { radius, start, sweep, .. } = arc else { return arc };
    if form == 1 {
        return arc;
    }
    let formula =
        |f: &str, c: f64| Expression::parse(&format!("{c:e} + {radius:e}*{f}(t)"), &["t"]).expect("a formula");
    Curve::Parametric { x: formula("cos", centre[0]), y: formula("sin", centre[1]), from_t: start, to_t: start + sweep }
}

/// The polygon in two along a cut from corner 0 to corner `to`; each side gives the cut in a form of its own.
fn halves(corners: &[Point], to: usize, bulge: f64, forms: [usize; 2]) -> [Section; 2] {
    let with_cut = |mut path: Vec<Point>, form: usize| {
        // The cut leads from the last corner of the path back to the first.
        let (p, q, last) = (path[path.len() - 1], path[0], path.len() - 1);
        let backwards = p == corners[0];
        let curve = cut(p, q, if backwards { bulge } else { -bulge }, form);
        let mut outline = Outline::polygon(std::mem::take(&mut path));
        outline.edges[last].curve = curve;
        outline.edges[last].name = "cut".into();
        Section::solid(outline)
    };
    let first = corners[..=to].to_vec();
    let mut second = corners[to..].to_vec();
    second.push(corners[0]);
    [with_cut(first, forms[0]), with_cut(second, forms[1])]
}

fn clouds(sections: &[Section], params: &[CloudParams]) -> Option<Vec<Cloud>> {
    // Some densities are too coarse for a curve, and are refused.
    sections.iter().zip(params).map(|(section, params)| generate(section, params).ok()).collect()
}

fn sides<'a>(sections: &'a [Section], clouds: &'a [Cloud]) -> Vec<Side<'a>> {
    sections.iter().zip(clouds).map(|(section, cloud)| Side { section, cloud }).collect()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, ..ProptestConfig::default() })]

    #[test]
    fn a_section_cut_in_two_is_welded_along_the_cut(
        radii in prop::array::uniform8(0.8..1.0f64),
        to in 3usize..=5,
        bulge in prop_oneof![1 => Just(0.0), 3 => 0.05..0.35f64, 3 => -0.35..-0.05f64],
        forms in [0usize..3, 0usize..3],
        nodes in [7usize..24, 7usize..24],
        irregularity in [prop_oneof![Just(0.0), 0.0..0.4f64], prop_oneof![Just(0.0), 0.0..0.4f64]],
        graded in prop::array::uniform2(prop::bool::weighted(0.3)),
        scale in prop_oneof![Just(1.0), Just(1e-6), Just(1e3)],
    ) {
        let forms = if bulge == 0.0 { [0, 0] } else { forms.map(|form| form.max(1)) };
        let corners: Vec<Point> = octagon(radii).iter().map(|p| p.map(|c| c * scale)).collect();
        let sections = halves(&corners, to, bulge, forms);
        let params = |k: usize| CloudParams {
            nodes: [nodes[k]; 2],
            irregularity: irregularity[k],
            // Towards either end of the cut.
            grading: graded[k].then(|| Grading::default().near(corners[[0, to][k]], 0.01 * scale, 0.25)),
            ..CloudParams::default()
        };
        let mut params = [params(0), params(1)];
        let separate = clouds(&sections, &params);
        prop_assume!(separate.is_some());
        let separate = separate.unwrap_or_default();
        let found = common_edges(&sides(&sections, &separate));
        prop_assert_eq!(found.len(), 1);
        prop_assert_eq!(found[0].names.each_ref().map(String::as_str), ["cut", "cut"]);
        prop_assert_eq!([found[0].from, found[0].to], [corners[to], corners[0]]);
        for side in 0..2 {
            let cut = sections[side].contour.edges.len() - 1;
            let on_cut = |s: &&nmt_geom::Segment| s.edge.index() == cut;
            let n_segments = separate[side].boundary().segments().iter().filter(on_cut).count();
            let at: Vec<Point> = found[0].nodes[side].iter().map(|n| separate[side].xy()[n.index()]).collect();
            prop_assert_eq!(at.len(), n_segments + 1);
            prop_assert_eq!([at[0], at[n_segments]], [found[0].from, found[0].to]);
        }

        let planned = [0, 1].map(|k| Planned { section: &sections[k], params: &params[k], conforming: k == 1 });
        let given = conform(&planned).expect("both have a length");
        params.iter_mut().zip(given).for_each(|(params, given)| params.edge_nodes = given);
        let conforming = clouds(&sections, &params);
        prop_assume!(conforming.is_some());
        let conforming = conforming.unwrap_or_default();
        let sides = sides(&sections, &conforming);
        let found = common_edges(&sides);
        prop_assert!(found[0].is_conforming(&sides));
        let at = |side: usize| found[0].nodes[side].iter().map(|n| sides[side].cloud.xy()[n.index()]).collect::<Vec<_>>();
        prop_assert_eq!(at(0), at(1)); // to the bit
        for cloud in &conforming {
            prop_assert_eq!(cloud.check(), Ok(()));
        }
        let meshes: Vec<Mesh> = conforming.into_iter().map(|c| Mesh::constrained(c).expect("a mesh")).collect();
        let parts = [0, 1].map(|k| MeshSide { name: ["a", "b"][k], section: &sections[k], mesh: &meshes[k] });
        let welded = weld(&parts).expect("both sides have the same nodes");
        prop_assert_eq!(welded.check(), Ok(()));
        let n_shared = welded.interfaces()[0].nodes.len();
        let n_nodes: usize = meshes.iter().map(|mesh| mesh.cloud().n_nodes()).sum();
        prop_assert_eq!(welded.xy().len() + n_shared, n_nodes);
        // One outer loop, of the polygon's own area.
        let outer: f64 = welded.outer().iter().map(|s| {
            let [p, q] = [s.from, s.to].map(|node| welded.xy()[node.index()]);
            cross(p, q) / 2.0
        }).sum();
        let area: f64 = meshes.iter().map(Mesh::total_area).sum();
        prop_assert!((outer - area).abs() < 1e-9 * area);
        prop_assert_eq!(welded.tri_region().iter().filter(|region| region.0 == 1).count(), meshes[1].n_triangles());
    }
}

fn mesh(section: &Section, params: &CloudParams) -> Mesh {
    Mesh::constrained(generate(section, params).expect("a cloud")).expect("a mesh")
}

#[test]
fn the_first_node_that_does_not_coincide_is_named_with_the_remedy() {
    let sections = [0.0, 2.0].map(|x| Section::solid(Outline::rectangle([x, 0.0], [x + 2.0, 2.0])));
    let meshes = [5, 9].map(|n| CloudParams { nodes: [n, n], ..CloudParams::default() });
    let meshes = [mesh(&sections[0], &meshes[0]), mesh(&sections[1], &meshes[1])];
    let parts = [0, 1].map(|k| MeshSide { name: ["left", "right"][k], section: &sections[k], mesh: &meshes[k] });
    let error = weld(&parts).expect_err("five nodes against nine");
    assert!(matches!(&error, MergeError::Apart { subdomain, at: [2.0, 0.25], .. } if subdomain == "right"));
    assert_eq!(
        error.to_string(),
        "node 31 of subdomain \"right\" at (2, 0.25), on its common edge with subdomain \"left\", has no node of that at \
         its place; give one of the two `conforming = true`"
    );
}

/// Plate with a round hole that two half-discs fill, of three densities, the middle one irregular.
#[test]
fn a_hole_filled_by_two_half_discs_welds_to_a_plate_without_a_hole() {
    let mut hole = Outline::circle([0.0, 0.0], 1.0);
    hole.edges[0].name = "h1/e1".into();
    let half = |from: Point, to: Point| {
        let mut outline = Outline::polygon([to, from]);
        outline.edges[1].curve = Curve::arc([0.0, 0.0], from, to, Turn::CounterClockwise);
        Section::solid(outline)
    };
    let (low, high) = ([0.6, -0.8], [-0.6, 0.8]);
    let plate = Section { contour: Outline::rectangle([-2.0, -2.0], [2.0, 2.0]), holes: vec![hole] };
    let sections = [plate, half(low, high), half(high, low)];
    let mut params: Vec<CloudParams> = [17, 23, 11]
        .map(|n| CloudParams { nodes: [n, n], irregularity: if n == 23 { 0.3 } else { 0.0 }, ..CloudParams::default() })
        .to_vec();
    let planned: Vec<Planned> =
        sections.iter().zip(&params).map(|(section, params)| Planned { section, params, conforming: true }).collect();
    let given = conform(&planned).expect("all have a length");
    params.iter_mut().zip(given).for_each(|(params, given)| params.edge_nodes = given);
    let meshes: Vec<Mesh> = sections.iter().zip(&params).map(|(section, params)| mesh(section, params)).collect();
    let parts = [0, 1, 2].map(|k| MeshSide { name: ["plate", "a", "b"][k], section: &sections[k], mesh: &meshes[k] });
    let welded = weld(&parts).expect("conforming");
    assert_eq!(welded.interfaces().len(), 4); // three parts of the circle, cut at its seam and two corners, and the cut
    assert!(welded.outer().iter().all(|segment| segment.region.0 == 0 && segment.edge.0 < 4));
    let area: f64 = meshes.iter().map(Mesh::total_area).sum();
    assert!((area - 16.0).abs() < 1e-12); // both sides have the same polygon in place of the circle
}

#[test]
fn what_is_left_of_an_edge_beside_its_neighbour_keeps_its_own_density() {
    let table = Section::solid(Outline::rectangle([0.0, 0.0], [4.0, 1.0]));
    let block = Section::solid(Outline::rectangle([1.3, 1.0], [2.0, 2.0]));
    let params = [
        CloudParams { nodes: [9, 9], ..CloudParams::default() },
        CloudParams { nodes: [15, 15], ..CloudParams::default() },
    ];
    let planned = [
        Planned { section: &table, params: &params[0], conforming: false },
        Planned { section: &block, params: &params[1], conforming: true },
    ];
    let given = conform(&planned).expect("all have a length");
    // The table's upper side leads to the left: 2 of 4, then 14 segments of the block, then 1.3 of 4 at 8 segments each.
    let nodes = given[0][2].as_ref().expect("a common edge");
    let fixed = nodes.iter().filter(|node| node.at.is_some()).count();
    assert_eq!((fixed, nodes.len() - fixed), (15, 3 + 2));
    assert!(given[0][0].is_none() && given[1][0].as_ref().is_some_and(|nodes| nodes.len() == 13));
    let none = [Planned { conforming: false, ..planned[0] }, Planned { conforming: false, ..planned[1] }];
    assert!(conform(&none).expect("nothing to do").iter().flatten().all(Option::is_none));
}
