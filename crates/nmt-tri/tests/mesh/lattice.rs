//! The way by the lattice against the general way: the same triangles, whatever the cloud; and it is really taken for
//! ordinary ones.

use crate::sections::{Shape, any_density, any_shape, cloud, narrow_slot, params};
use nmt_cloud::{Census, ClearanceUnit, Cloud, CloudParams, Section, generate, generate_with};
use nmt_curve::Outline;
use nmt_geom::{Point, RealBoundary};
use nmt_tri::Mesh;
use proptest::prelude::*;
use std::f64::consts::TAU;

/// Which way [`Mesh::constrained`] takes for a cloud.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Way {
    Lattice,
    General,
}

/// Asserts that both ways agree on the cloud and their mesh is sound; returns the way that is taken.
fn way(cloud: &Cloud) -> Way {
    let general = Mesh::constrained_general(cloud.clone()).expect("every generated cloud has a mesh");
    assert_eq!(general.check(), Ok(()));
    assert_eq!(Mesh::constrained(cloud.clone()).as_ref(), Ok(&general));
    match Mesh::constrained_on_lattice(cloud.clone()) {
        Some(by_lattice) => {
            assert!(by_lattice == general);
            Way::Lattice
        }
        None => Way::General,
    }
}

fn any_irregularity() -> impl Strategy<Value = f64> {
    prop_oneof![2 => Just(0.0), 1 => Just(0.49), 1 => prop::sample::select(vec![1e-13, 1e-9, 1e-8]), 6 => 0.0..0.49f64]
}

/// Gives every edge nodes of its own: `factor` times as many as the spacing asks for.
fn with_own_nodes(mut section: Section, nodes: [usize; 2], factor: f64) -> Section {
    let envelope = section.contour.envelope();
    let per_length = nodes[0] as f64 / envelope.width();
    for outline in std::iter::once(&mut section.contour).chain(&mut section.holes) {
        let corners = outline.flatten(1e-3 * envelope.size());
        let perimeter: f64 =
            corners.iter().zip(corners.iter().cycle().skip(1)).map(|(p, q)| nmt_geom::point::distance(*p, *q)).sum();
        let n_edges = outline.edges.len();
        for edge in &mut outline.edges {
            // Of the mean length; nine around a whole circle keep it within its chords.
            let least = if edge.curve.is_straight() { 2.0 } else { 9.0 };
            edge.nodes = Some((factor * per_length * perimeter / n_edges as f64).max(least) as usize);
        }
    }
    section
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    #[test]
    fn both_ways_agree_on_any_shape_and_the_lattice_is_taken(
        shape in any_shape(), nodes in any_density(), irregularity in any_irregularity(),
        seed in any::<u64>(), unit in prop::sample::select(vec![1.0, 1e-3, 1e3, 0.3048]),
    ) {
        let params = CloudParams { seed, ..params(nodes, irregularity) };
        prop_assert_eq!(way(&cloud(&shape.section(unit), &params)), Way::Lattice);
    }

    #[test]
    fn both_ways_agree_where_the_boundary_is_coarser_or_finer_than_the_lattice(
        shape in any_shape(), nodes in any_density(), irregularity in any_irregularity(), factor in 0.2..5.0f64,
    ) {
        let section = with_own_nodes(shape.section(1.0), nodes, factor);
        // Chords of a coarse boundary may cross.
        let Ok(cloud) = generate(&section, &params(nodes, irregularity)) else { return Ok(()) };
        prop_assert_eq!(way(&cloud), Way::Lattice);
    }

    #[test]
    fn both_ways_agree_on_unequal_spacings_and_odd_clearances(
        shape in any_shape(), n in 8usize..28, ratio in 1.0..5.0f64, is_tall in any::<bool>(),
        irregularity in any_irregularity(), clearance in prop::sample::select(ClearanceUnit::ALL.to_vec()),
        edge_clearance in prop::sample::select(vec![0.05, 0.33, 1.0, 2.0]),
        node_clearance in prop::sample::select(vec![0.05, 0.5, 1.0, 2.0]),
    ) {
        let more = (n as f64 * ratio) as usize;
        let nodes = if is_tall { [n, more] } else { [more, n] };
        let params = CloudParams { clearance, edge_clearance, node_clearance, ..params(nodes, irregularity) };
        // Where clearances leave nothing there is no cloud, where they leave little it is not worth its ghosts.
        let Ok(cloud) = generate(&shape.section(1.0), &params) else { return Ok(()) };
        way(&cloud);
    }

    #[test]
    fn both_ways_agree_between_many_holes(
        holes in prop::collection::vec((0.02..0.42f64, 0.0..TAU, 3usize..7), 1..10), n in 10usize..60,
        irregularity in any_irregularity(),
    ) {
        let hole = |(k, &(r, turn, n)): (usize, &(f64, f64, usize))| {
            let centre = [(k % 3) as f64 + 0.5, (k / 3) as f64 + 0.5];
            let corner = |m: usize| {
                let t = turn + TAU * m as f64 / n as f64;
                [centre[0] + r * t.cos(), centre[1] + r * t.sin()]
            };
            if n == 6 { Outline::circle(centre, r) } else { Outline::polygon((0..n).map(corner)) }
        };
        let section = Section {
            contour: Outline::rectangle([0.0, 0.0], [3.0, 3.0]),
            holes: holes.iter().enumerate().map(hole).collect(),
        };
        prop_assert_eq!(way(&cloud(&section, &params([n, n], irregularity))), Way::Lattice);
    }

    #[test]
    fn both_ways_agree_on_the_smallest_clouds(
        nodes in prop::array::uniform2(3usize..7), irregularity in any_irregularity(), seed in any::<u64>(),
        corners in prop::collection::vec(0.5..1.5f64, 3..7), clearance in prop::sample::select(vec![0.0, 0.1, 0.33]),
    ) {
        let corner = |(k, r): (usize, &f64)| {
            let t = TAU * k as f64 / corners.len() as f64;
            [r * t.cos(), r * t.sin()]
        };
        let section = Section::solid(Outline::polygon(corners.iter().enumerate().map(corner)));
        let params = CloudParams {
            seed, edge_clearance: 0.05, node_clearance: clearance, ..params(nodes, irregularity)
        };
        if let Ok(cloud) = generate(&section, &params) {
            way(&cloud);
        }
    }
}

#[test]
fn both_ways_agree_on_narrow_slots_and_slits() {
    for (section, densities) in [
        (narrow_slot(), vec![[9, 9], [9, 5], [7, 12], [17, 9], [33, 17], [160, 80]]),
        (Shape::Slotted { width: 1e-6 }.section(1.0), vec![[9, 9], [21, 11], [41, 41], [150, 75]]),
    ] {
        for nodes in densities {
            for (irregularity, seed) in [(0.0, 0), (0.2, 1), (0.2, 2), (0.49, 3), (0.49, 4)] {
                let cloud = cloud(&section, &CloudParams { seed, ..params(nodes, irregularity) });
                assert_eq!(way(&cloud), Way::Lattice, "{nodes:?} {irregularity} {seed}");
            }
        }
    }
}

#[test]
fn both_ways_agree_on_round_and_skew_sections() {
    let rotated = |angle: f64| {
        let (s, c) = angle.sin_cos();
        let corner = |[x, y]: Point| [10.0 + c * x - s * y, s * x + c * y];
        Section::solid(Outline::polygon([[0.0, 0.0], [3.0, 0.0], [3.0, 2.0], [0.0, 2.0]].map(corner)))
    };
    let disc = |r: f64| Outline::circle([0.0, 0.0], r);
    for section in [
        Section::solid(disc(1.0)),
        Section { contour: disc(1.0), holes: vec![disc(0.5)] },
        Section::solid(Outline::ellipse([1.0, 2.0], [3.0, 1.0], 0.5)),
        rotated(0.3),
        rotated(TAU / 8.0), // nodes along diagonals of the cells
    ] {
        for n in [9, 20, 41, 120] {
            for irregularity in [0.0, 0.1, 0.3, 0.49] {
                assert_eq!(way(&cloud(&section, &params([n, n], irregularity))), Way::Lattice);
            }
        }
    }
}

#[test]
fn a_boundary_parallel_to_the_lattice_with_more_nodes_than_it_is_met_on_its_edges() {
    // Nodes without a box lie exactly on sides between those that have one.
    let plate = || Section {
        contour: Outline::rectangle([0.0, 0.0], [2.0, 1.0]),
        holes: vec![Outline::rectangle([0.5, 0.25], [1.0, 0.75])],
    };
    for factor in [0.25, 2.0, 4.0, 16.0] {
        for irregularity in [0.0, 0.3] {
            let section = with_own_nodes(plate(), [17, 9], factor);
            assert_eq!(way(&cloud(&section, &params([17, 9], irregularity))), Way::Lattice);
        }
    }
}

#[test]
fn a_cloud_without_lattice_goes_the_general_way() {
    let with = cloud(&Shape::Perforated.section(1.0), &params([21, 11], 0.2));
    let interior = with.xy()[with.n_boundary()..].to_vec();
    let boundary: RealBoundary = with.boundary().clone();
    let without = Cloud::from_parts(boundary, with.n_vertices(), interior, with.spacing(), Census::default());
    assert_eq!((way(&with), way(&without)), (Way::Lattice, Way::General));
    let triangles = |cloud: &Cloud| Mesh::constrained(cloud.clone()).map(|mesh| mesh.tri_nodes().to_vec());
    assert_eq!(triangles(&with), triangles(&without));
}

#[test]
fn nodes_that_have_left_their_boxes_go_the_general_way() {
    let plate = Section::solid(Outline::rectangle([0.0, 0.0], [1.0, 1.0]));
    // Numbers of the caller's that are none of [−1, 1): a node moves by 0.9 of the spacing.
    let random = |node: usize, _: usize| if node == 60 { [3.0, 0.0] } else { [0.0, 0.0] };
    let cloud = generate_with(&plate, &params([11, 11], 0.3), random).expect("a cloud");
    assert_eq!(way(&cloud), Way::General);
}

#[test]
fn sizes_whose_fourth_powers_overflow_go_the_general_way() {
    for (unit, expected) in [(1e-50, Way::Lattice), (1e50, Way::Lattice), (1e-70, Way::General), (1e70, Way::General)] {
        let plate = Section::solid(Outline::rectangle([0.0, 0.0], [2.0 * unit, unit]));
        let cloud = generate(&plate, &params([21, 11], 0.3)).expect("a cloud of any size");
        assert_eq!(Mesh::constrained_on_lattice(cloud).is_some(), expected == Way::Lattice, "{unit:e}");
    }
}
