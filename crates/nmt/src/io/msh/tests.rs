use super::model::Model;
use super::{msh_of_meshes, msh_of_solutions};
use crate::io::NodeFields;
use crate::pipeline::{MeshPart, clouds, meshes, solve_problem};
use crate::problem::{Overrides, Problem};
use nmt_geom::point::cross;
use std::collections::{BTreeSet, HashMap};

/// A frame with a round and a rectangular hole, both filled, and a block that stands along a part of its side and above.
const FOUR_PARTS: &str = r#"
    [[subdomain]]
    name = "frame"
    nodes = [21, 21]
    rectangle = { from = [0, 0], to = [4, 4] }
    [[subdomain.hole]]
    name = "window"
    rectangle = { from = [1, 0.5], to = [3, 1.5] }
    [[subdomain.hole]]
    name = "bore"
    circle = { centre = [2, 2.75], radius = 0.75 }
    [[subdomain]]
    name = "core"
    nodes = [15, 15]
    circle = { centre = [2, 2.75], radius = 0.75 }
    [[subdomain]]
    name = "pane"
    nodes = [11, 9]
    rectangle = { from = [1, 0.5], to = [3, 1.5] }
    [[subdomain]]
    name = "block"
    nodes = [9, 17]
    irregularity = 0.2
    rectangle = { from = [4, 1], to = [6, 5] }
"#;

fn four_parts_that_conform() -> String {
    FOUR_PARTS.replace("nodes =", "conforming = true\nnodes =")
}

fn written(write: impl FnOnce(&mut Vec<u8>) -> std::io::Result<()>) -> String {
    let mut sink = Vec::new();
    write(&mut sink).expect("a sink that takes all");
    String::from_utf8(sink).expect("text")
}

fn problem(text: &str) -> Problem {
    Problem::parse("test.toml", text, &Overrides::default()).expect("a sound problem")
}

fn meshes_of(text: &str) -> Vec<MeshPart> {
    let problem = problem(text);
    let clouds = clouds(&problem, &mut |_, _| {}).expect("clouds");
    meshes(&problem, clouds, &mut |_, _| {}).expect("meshes")
}

fn model(parts: &[MeshPart]) -> Model {
    Model::new(&parts.iter().collect::<Vec<_>>())
}

/// Numbers of the curves that bear each name.
fn curves_by_name(model: &Model) -> HashMap<&str, Vec<usize>> {
    let mut curves: HashMap<&str, Vec<usize>> = HashMap::new();
    for (k, curve) in model.curves.iter().enumerate() {
        curve.groups.iter().for_each(|&group| curves.entry(&model.groups[group].name).or_default().push(k));
    }
    curves
}

/// Lines of a section, without its frame.
fn section<'a>(msh: &'a str, name: &str) -> Vec<&'a str> {
    let (start, end) = (format!("${name}\n"), format!("$End{name}\n"));
    let body = msh.split_once(&start).and_then(|(_, rest)| rest.split_once(&end)).expect("the section").0;
    body.lines().collect()
}

fn numbers(line: &str) -> Vec<usize> {
    line.split(' ').map(|word| word.parse().expect("a number")).collect()
}

/// Tags of nodes or elements: the header's counts are right, every block has the lines that it says.
fn tags(lines: &[&str], lines_an_item: usize) -> Vec<usize> {
    let head = numbers(lines[0]);
    let (mut tags, mut at) = (Vec::new(), 1);
    for _ in 0..head[0] {
        let n = numbers(lines[at])[3];
        tags.extend(lines[at + 1..=at + n].iter().map(|line| numbers(line)[0]));
        at += 1 + lines_an_item * n;
    }
    assert_eq!(at, lines.len());
    assert_eq!(head[1..], [tags.len(), 1, tags.len()]);
    tags
}

#[test]
fn a_square_of_eight_triangles() {
    let parts =
        meshes_of("[[subdomain]]\nname = \"plate\"\nnodes = [3, 3]\nrectangle = { from = [0, 0], to = [1, 1] }");
    insta::assert_snapshot!(written(|sink| msh_of_meshes(sink, &parts)));
}

#[test]
fn conforming_subdomains_share_the_nodes_and_curves_of_their_common_edges() {
    let parts = meshes_of(&four_parts_that_conform());
    let model = model(&parts);
    assert!(model.is_welded);
    let of_parts: usize = parts.iter().map(|part| part.mesh.cloud().n_nodes()).sum();
    let curves = curves_by_name(&model);
    let interfaces = ["frame|core", "frame|pane 1", "frame|pane 2", "frame|pane 3", "frame|pane 4", "frame|block"];
    let mut shared = BTreeSet::new();
    for name in interfaces {
        assert_eq!(curves[name].len(), 1, "{name}");
        let curve = &model.curves[curves[name][0]];
        assert_eq!(curve.groups.len(), 3, "{name}: the edge of either side, and the common edge");
        shared.extend(curve.nodes.iter().copied());
    }
    assert_eq!(model.xy.len(), of_parts - shared.len());
    for (k, curve) in model.curves.iter().enumerate() {
        let bounds = model.surfaces.iter().flat_map(|surface| &surface.bounds).filter(|bound| bound.curve == k);
        let reversed: Vec<bool> = bounds.map(|bound| bound.is_reversed).collect();
        assert_eq!(reversed, if curve.groups.len() == 3 { &[false, true][..] } else { &[false][..] });
    }
}

#[test]
fn other_subdomains_keep_their_nodes_and_both_sides_bear_the_name_of_the_common_edge() {
    let parts = meshes_of(FOUR_PARTS);
    let model = model(&parts);
    assert!(!model.is_welded);
    assert_eq!(model.xy.len(), parts.iter().map(|part| part.mesh.cloud().n_nodes()).sum::<usize>());
    let curves = curves_by_name(&model);
    for (name, edges) in
        [("frame|core", ["frame/bore/e1", "core/e1"]), ("frame|pane 1", ["frame/window/e1", "pane/e1"])]
    {
        assert_eq!(curves[name], edges.map(|edge| curves[edge][0]), "{name}");
    }
}

#[test]
fn an_edge_is_cut_where_a_common_edge_begins_and_keeps_its_name_on_all_parts() {
    for text in [FOUR_PARTS.to_owned(), four_parts_that_conform()] {
        let parts = meshes_of(&text);
        let model = model(&parts);
        let curves = curves_by_name(&model);
        // x = 4, from y = 0 to 1 alone, to 4 along the block.
        let side = &curves["frame/e2"];
        assert_eq!((side.len(), curves["frame|block"].contains(&side[1])), (2, true));
        let ends = side.iter().map(|&k| &model.curves[k].nodes).map(|nodes| [nodes[0], nodes[nodes.len() - 1]]);
        let ys: Vec<f64> = ends.flatten().map(|node| model.xy[node.index()][1]).collect();
        assert_eq!(ys, [0.0, 1.0, 1.0, 4.0]);
    }
}

#[test]
fn a_circle_is_one_curve_that_ends_where_it_begins() {
    let parts = meshes_of(FOUR_PARTS);
    let model = model(&parts);
    let circle = &model.curves[curves_by_name(&model)["core/e1"][0]];
    assert_eq!(circle.nodes.first(), circle.nodes.last());
    assert!(model.points.contains(&circle.nodes[0]));
    assert_eq!(model.xy[circle.nodes[0].index()], [2.75, 2.75]);
}

#[test]
fn curves_have_their_surface_on_the_left_unless_reversed() {
    for text in [FOUR_PARTS.to_owned(), four_parts_that_conform()] {
        let parts = meshes_of(&text);
        let model = model(&parts);
        for (part, surface) in parts.iter().zip(&model.surfaces) {
            let twice_area = |bound: &super::model::Bound| -> f64 {
                let nodes = &model.curves[bound.curve].nodes;
                let sum: f64 = nodes.windows(2).map(|p| cross(model.xy[p[0].index()], model.xy[p[1].index()])).sum();
                if bound.is_reversed { -sum } else { sum }
            };
            let area = surface.bounds.iter().map(twice_area).sum::<f64>() / 2.0;
            assert!((area / part.mesh.total_area() - 1.0).abs() < 1e-12, "{area}"); // rounding
        }
    }
}

#[test]
fn every_node_and_element_has_one_number_and_counts_are_right() {
    for text in [FOUR_PARTS.to_owned(), four_parts_that_conform()] {
        let parts = meshes_of(&text);
        let msh = written(|sink| msh_of_meshes(sink, &parts));
        for (name, lines_an_item) in [("Nodes", 2), ("Elements", 1)] {
            let mut tags = tags(&section(&msh, name), lines_an_item);
            tags.sort_unstable();
            assert!(tags.iter().copied().eq(1..=tags.len()), "{name}");
        }
    }
}

#[test]
fn the_solution_is_at_nodes_and_where_subdomains_share_them_at_nodes_of_triangles() {
    for (text, kind) in [(FOUR_PARTS.to_owned(), "NodeData"), (four_parts_that_conform(), "ElementNodeData")] {
        let solved = solve_problem(&problem(&text)).expect("a solution");
        let msh =
            written(|sink| msh_of_solutions(sink, &solved.iter().map(NodeFields::of_torsion).collect::<Vec<_>>()));
        let names: Vec<&str> =
            msh.split(&format!("${kind}\n")).skip(1).map(|view| view.lines().nth(1).expect("a name")).collect();
        assert_eq!(names, ["\"F\"", "\"tau_zx\"", "\"tau_zy\"", "\"tau\""]);
        let rows = section(&msh, kind);
        let n_rows = if kind == "NodeData" {
            section(&msh, "Nodes")[0].split(' ').nth(1).map(str::to_owned)
        } else {
            Some(solved.iter().map(|s| s.part.mesh.n_triangles()).sum::<usize>().to_string())
        };
        assert_eq!(Some(rows[7].to_owned()), n_rows);
        assert_eq!(rows[8..].len().to_string(), rows[7]);
    }
}

#[test]
fn names_that_meet_stay_apart() {
    let parts = meshes_of(
        "[[subdomain]]\nname = \"12\\\" web\"\nnodes = [3, 3]\noutline = [[0, 0], { name = \"12' web\", line = true }, [1, 0], [1, 1], [0, 1]]",
    );
    let msh = written(|sink| msh_of_meshes(sink, &parts));
    let names = section(&msh, "PhysicalNames");
    assert_eq!(names[..3], ["5", "2 1 \"12' web\"", "1 2 \"12' web (2)\""]);
}
