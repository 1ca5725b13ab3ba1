//! Every node in a triangle, every segment an edge, the areas those of the section.

use crate::sections::{Shape, any_density, any_shape, mesh, narrow_slot, params};
use nmt_cloud::{CloudParams, Section};
use nmt_curve::Outline;
use nmt_geom::Point;
use nmt_tri::{Mesh, quality};
use proptest::prelude::*;

/// Area of a section whose edges are all straight, from its vertices alone.
fn polygon_area(section: &Section) -> f64 {
    let ring_area = |outline: &Outline| {
        let v = &outline.vertices;
        let about = v[0];
        let twice = |k: usize| {
            let (p, q) = (v[k], v[(k + 1) % v.len()]);
            (p[0] - about[0]) * (q[1] - about[1]) - (q[0] - about[0]) * (p[1] - about[1])
        };
        (0..v.len()).map(twice).sum::<f64>().abs() / 2.0
    };
    ring_area(&section.contour) - section.holes.iter().map(ring_area).sum::<f64>()
}

fn assert_fills(mesh: &Mesh, section: &Section) {
    let (found, exact) = (mesh.total_area(), polygon_area(section));
    // Nodes of skew edges are off the edge by rounding: 1e-16 of the size times the perimeter, 1e-14 of the area.
    assert!((found / exact - 1.0).abs() < 1e-11, "{found} {exact}");
}

fn rotated(corners: &[Point], angle: f64, centre: Point) -> Vec<Point> {
    let (s, c) = angle.sin_cos();
    corners.iter().map(|p| [centre[0] + c * p[0] - s * p[1], centre[1] + s * p[0] + c * p[1]]).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn a_mesh_of_any_section_fills_it_and_uses_every_node(
        shape in any_shape(), nodes in any_density(), irregularity in prop_oneof![Just(0.0), 0.01..0.49f64],
    ) {
        let section = shape.section(1.0);
        let mesh = mesh(&section, &params(nodes, irregularity));
        if section.loops().all(|outline| outline.edges.iter().all(|edge| edge.curve.is_straight())) {
            assert_fills(&mesh, &section);
        }
        let quality = quality(&mesh).expect("a mesh with triangles");
        prop_assert_eq!(quality.histogram.iter().sum::<usize>(), mesh.n_triangles());
        prop_assert!(quality.min > 0.0 && quality.min <= quality.mean && quality.mean <= 1.0);
    }

    #[test]
    fn rounding_noise_along_skew_sides_makes_no_sliver_and_loses_no_node(
        angle in 0.0..6.3f64, centre in prop::array::uniform2(-50.0..50.0f64), nodes in prop::array::uniform2(9usize..60),
        irregularity in prop_oneof![Just(0.0), 0.01..0.49f64],
    ) {
        let outer = rotated(&[[0.0, 0.0], [3.0, 0.0], [3.0, 2.0], [0.0, 2.0]], angle, centre);
        let inner = rotated(&[[1.0, 0.7], [2.0, 0.7], [2.0, 1.3], [1.0, 1.3]], angle, centre);
        let section = Section { contour: Outline::polygon(outer), holes: vec![Outline::polygon(inner)] };
        assert_fills(&mesh(&section, &params(nodes, irregularity)), &section);
    }
}

#[test]
fn a_slot_narrower_than_the_spacing_stays_open() {
    let section = narrow_slot();
    for nodes in [[9, 9], [9, 5], [7, 12], [17, 9], [33, 17]] {
        for (irregularity, seed) in [(0.0, 0), (0.2, 1), (0.2, 2), (0.45, 3), (0.45, 4)] {
            let mesh = mesh(&section, &CloudParams { seed, ..params(nodes, irregularity) });
            assert_fills(&mesh, &section);
        }
    }
}

#[test]
fn a_slit_of_a_millionth_of_the_plate_stays_open() {
    let section = Shape::Slotted { width: 1e-6 }.section(1.0);
    for nodes in [[9, 9], [21, 11], [41, 41]] {
        for irregularity in [0.0, 0.3] {
            assert_fills(&mesh(&section, &params(nodes, irregularity)), &section);
        }
    }
}

#[test]
fn nodes_on_common_circles_are_triangulated_without_gap() {
    let disc = |r: f64| Outline::circle([0.0, 0.0], r);
    let solid = Section::solid(disc(1.0));
    // Clearances so large that the interior is nearly empty: the boundary's nodes see each other across it.
    let sparse = CloudParams { edge_clearance: 2.0, node_clearance: 2.0, ..params([7, 7], 0.0) };
    for (section, params) in [
        (solid.clone(), params([41, 41], 0.0)),
        (solid, sparse),
        (Section { contour: disc(1.0), holes: vec![disc(0.5)] }, params([31, 31], 0.0)),
        (Section { contour: disc(1.0), holes: vec![disc(0.9)] }, params([61, 61], 0.0)),
    ] {
        let mesh = mesh(&section, &params);
        // A polygon of n corners on a circle of radius r has the area n/2·r²·sin(2π/n).
        let polygon = |ring: u32, r: f64| {
            let n = mesh.cloud().boundary().loop_segments(nmt_geom::LoopId(ring)).len() as f64;
            n / 2.0 * r * r * (std::f64::consts::TAU / n).sin()
        };
        let hole = section.holes.first().map_or(0.0, |hole| polygon(1, hole.vertices[0][0]));
        let exact = polygon(0, 1.0) - hole;
        assert!((mesh.total_area() / exact - 1.0).abs() < 1e-11); // nodes on the circle to 1e-14, a thin ring to 1e-13
    }
}

#[test]
fn a_regular_rectangle_is_cut_into_halves_of_its_cells() {
    let section = Section::solid(Outline::rectangle([0.0, 0.0], [2.0, 1.0]));
    let mesh = mesh(&section, &params([21, 11], 0.0));
    assert_eq!(mesh.n_triangles(), 2 * 20 * 10);
    let quality = quality(&mesh).expect("a mesh with triangles");
    // Right isosceles triangles: 4√3·½/(1 + 1 + 2) = √3/2. Nodes are where they should be to 1e-16, cells 0.1 wide.
    assert!((quality.min - 0.75f64.sqrt()).abs() < 1e-13 && (quality.mean - 0.75f64.sqrt()).abs() < 1e-13);
    assert!((quality.min_angle_deg - 45.0).abs() < 1e-11);
    let centroid = mesh.centroid();
    assert!((centroid[0] - 1.0).abs() < 1e-14 && (centroid[1] - 0.5).abs() < 1e-14); // rounding
}

#[test]
fn the_mesh_is_a_function_of_the_cloud() {
    let section = Shape::Perforated.section(1.0);
    let params = params([33, 21], 0.3);
    assert_eq!(mesh(&section, &params), mesh(&section, &params));
}
