//! Every refusal says what was found; a remedy that is followed works.

use crate::sections::params;
use nmt_cloud::{CloudError, CloudParams, Section, generate};
use nmt_curve::{Curve, Expression, Outline};
use proptest::prelude::*;

/// The densities that a remedy such as "nodes = [12, 8] would do" names.
fn advised(remedy: &str) -> Option<[usize; 2]> {
    let list = remedy.split_once('[')?.1.split_once(']')?.0;
    let (n_x, n_y) = list.split_once(", ")?;
    Some([n_x.parse().ok()?, n_y.parse().ok()?])
}

fn square() -> Section {
    Section::solid(Outline::rectangle([0.0, 0.0], [1.0, 1.0]))
}

#[test]
fn a_parameter_out_of_range_is_named_with_its_value() {
    let default = CloudParams::default;
    let wrong = [
        ("nodes", CloudParams { nodes: [1, 5], ..default() }),
        ("nodes", CloudParams { nodes: [5, 0], ..default() }),
        ("nodes", CloudParams { hole_nodes: vec![None, Some([9, 1])], ..default() }),
        ("irregularity", CloudParams { irregularity: 0.5, ..default() }),
        ("irregularity", CloudParams { irregularity: -0.1, ..default() }),
        ("irregularity", CloudParams { irregularity: f64::NAN, ..default() }),
        ("edge_clearance", CloudParams { edge_clearance: -1.0, ..default() }),
        ("node_clearance", CloudParams { node_clearance: f64::INFINITY, ..default() }),
    ];
    for (name, params) in wrong {
        let error = generate(&square(), &params);
        assert!(matches!(&error, Err(CloudError::Parameter { parameter, .. }) if *parameter == name), "{error:?}");
    }
}

#[test]
fn more_grid_points_than_memory_bears_are_refused_at_once() {
    for nodes in [[100_000, 100_000], [usize::MAX, 2], [usize::MAX, usize::MAX]] {
        let error = generate(&square(), &params(nodes, 0.0));
        assert!(matches!(error, Err(CloudError::TooManyNodes { .. })), "{error:?}");
    }
}

#[test]
fn a_contour_without_extent_is_refused() {
    for corners in [[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]], [[0.0, 0.0], [0.0, 1.0], [0.0, 3.0]], [[f64::NAN; 2]; 3]] {
        let error = generate(&Section::solid(Outline::polygon(corners)), &CloudParams::default());
        assert!(matches!(error, Err(CloudError::NoExtent { .. } | CloudError::Boundary(_))), "{error:?}");
    }
    let error = generate(&Section::solid(Outline::polygon([])), &CloudParams::default());
    assert!(matches!(error, Err(CloudError::NoExtent { .. })), "{error:?}");
}

#[test]
fn an_edge_that_cannot_be_divided_is_named_by_its_number() {
    let mut contour = Outline::rectangle([0.0, 0.0], [1.0, 1.0]);
    let y = Expression::parse("1 + 0/(x-0.5)*0", &["x"]).expect("a formula");
    contour.edges[2].curve = Curve::Graph { y, from_x: 1.0, to_x: 0.0 };
    let error = generate(&Section::solid(contour), &CloudParams::default());
    assert!(matches!(error, Err(CloudError::Edge { edge: 2, .. })), "{error:?}");
}

#[test]
fn two_nodes_across_leave_no_interior_node_and_the_remedy_gives_some() {
    for nodes in [[2, 2], [2, 40], [3, 2]] {
        match generate(&square(), &params(nodes, 0.2)) {
            Err(CloudError::NoInterior { remedy }) => {
                let advised = advised(&remedy).expect("a square has a density that does");
                let cloud = generate(&square(), &params(advised, 0.2)).expect("the remedy works");
                assert!(cloud.n_interior() > 0);
            }
            other => panic!("{nodes:?}: {other:?}"),
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn the_density_advised_for_a_thin_wall_gives_interior_nodes(
        wall in 0.03..0.3f64, aspect in 1.0..3.0f64, nodes in prop::array::uniform2(4usize..9), irregularity in 0.0..0.49f64,
    ) {
        let box_section = Section {
            contour: Outline::rectangle([0.0, 0.0], [2.0 * aspect, 2.0]),
            holes: vec![Outline::rectangle([wall, wall], [2.0 * aspect - wall, 2.0 - wall])],
        };
        match generate(&box_section, &params(nodes, irregularity)) {
            Err(CloudError::NoInterior { remedy }) => {
                let advised = advised(&remedy);
                prop_assert!(advised.is_some(), "{}", remedy);
                let cloud = generate(&box_section, &params(advised.unwrap_or(nodes), irregularity));
                prop_assert!(cloud.as_ref().is_ok_and(|cloud| cloud.n_interior() > 0), "{:?}: {:?}", remedy, cloud.err());
            }
            Err(other) => prop_assert!(false, "{:?}", other),
            Ok(cloud) => prop_assert!(cloud.n_interior() > 0),
        }
    }

    #[test]
    fn the_density_advised_for_curves_too_close_for_their_polygons_keeps_them_apart(
        gap in 0.01..0.1f64, nodes in prop::array::uniform2(3usize..12),
    ) {
        // A disc and a round hole turned by 0.3: the corners of one polygon cut through the sides of the other.
        let disc = Section {
            contour: Outline::circle([0.0, 0.0], 1.0),
            holes: vec![Outline::ellipse([0.0, 0.0], [1.0 - gap, 1.0 - gap], 0.3)],
        };
        match generate(&disc, &params(nodes, 0.0)) {
            Err(CloudError::BoundaryCrosses { remedy, at }) => {
                prop_assert!(at[0].hypot(at[1]) < 1.0 + 1e-9, "the crossing is on the disc: {:?}", at);
                let advised = advised(&remedy);
                prop_assert!(advised.is_some(), "{}", remedy);
                // The advice ends this fault; the wall may still be too thin for interior nodes.
                let again = generate(&disc, &params(advised.unwrap_or(nodes), 0.0));
                prop_assert!(!matches!(again, Err(CloudError::BoundaryCrosses { .. })), "{:?}", again);
            }
            Err(CloudError::NoInterior { .. }) => {}
            other => prop_assert!(other.is_ok_and(|cloud| cloud.check().is_ok())),
        }
    }
}
