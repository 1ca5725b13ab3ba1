//! Clouds that have no mesh are refused with the place; nothing panics.

use nmt_cloud::{Census, Cloud};
use nmt_geom::{BoundaryLoop, EdgeId, NodeId, Point, RealBoundary};
use nmt_tri::{Mesh, MeshError};
use proptest::prelude::*;

fn cloud(contour: &[Point], interior: &[Point]) -> Cloud {
    let n = contour.len() as u32;
    let ring = BoundaryLoop { nodes: (0..n).map(NodeId).collect(), edges: (0..n).map(EdgeId).collect() };
    let boundary = RealBoundary::new(contour.to_vec(), vec![ring]).expect("a loop of finite nodes");
    Cloud::from_parts(boundary, contour.len(), interior.to_vec(), [1.0, 1.0], Census::default())
}

const SQUARE: [Point; 4] = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]];

#[test]
fn two_nodes_in_one_place_are_named() {
    let error = Mesh::constrained(cloud(&SQUARE, &[[1.0, 1.0], [0.5, 0.5], [1.0, 1.0]]));
    assert_eq!(error, Err(MeshError::SameNode { nodes: [4, 6], at: [1.0, 1.0] }));
}

#[test]
fn a_node_on_a_segment_is_an_error_that_names_the_segment() {
    let error = Mesh::constrained(cloud(&SQUARE, &[[1.0, 1.0], [1.0, 0.0]]));
    assert!(matches!(error, Err(MeshError::BareSegment { nodes: [0, 1], .. })), "{error:?}");
}

#[test]
fn segments_that_cross_are_an_error_that_names_one() {
    let bow_tie = [[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 2.5]];
    let error = Mesh::constrained(cloud(&bow_tie, &[]));
    assert!(matches!(error, Err(MeshError::BareSegment { .. })), "{error:?}");
}

#[test]
fn a_node_outside_the_contour_is_found_by_the_check() {
    let mesh = Mesh::constrained(cloud(&SQUARE, &[[1.0, 1.0], [5.0, 1.0]])).expect("its triangles fill the square");
    assert_eq!(mesh.check(), Err(MeshError::LostNode { node: 5, at: [5.0, 1.0] }));
}

proptest! {
    #[test]
    fn any_loop_and_any_nodes_give_a_sound_mesh_or_an_error(
        contour in prop::collection::vec(prop::array::uniform2(0i32..6), 3..9),
        interior in prop::collection::vec(prop::array::uniform2(0i32..6), 0..9),
        // Powers of two, so that nodes on one line stay on one line.
        exponent in prop::sample::select(vec![0, -330, 300]),
    ) {
        let unit = 2f64.powi(exponent);
        let points = |list: &[[i32; 2]]| -> Vec<Point> { list.iter().map(|p| p.map(|c| f64::from(c) * unit)).collect() };
        let cloud = cloud(&points(&contour), &points(&interior));
        let is_sound = cloud.check().is_ok();
        match Mesh::constrained(cloud) {
            Ok(mesh) if is_sound => prop_assert_eq!(mesh.check(), Ok(())),
            Ok(_) => {}
            // A sound cloud without a mesh has two nodes in one place.
            Err(MeshError::SameNode { .. }) => {}
            Err(error) => prop_assert!(!is_sound, "{}", error),
        }
    }
}
