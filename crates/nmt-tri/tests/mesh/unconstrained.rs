//! The paper's own way: Delaunay of all nodes, elimination, completion.

use crate::sections::{any_density, any_shape, narrow_slot, params};
use nmt_cloud::{Cloud, CloudParams, Section, generate};
use nmt_curve::Outline;
use nmt_tri::{Elimination, Mesh, MeshCensus, MeshError, edges, stages};
use proptest::prelude::*;

fn cloud(section: &Section, params: &CloudParams) -> Cloud {
    generate(section, params).expect("a sound section with room for interior nodes")
}

fn checked(cloud: Cloud) -> (Mesh, MeshCensus) {
    let (mesh, census) = Mesh::unconstrained(cloud, &Elimination::default()).expect("every gap is filled");
    assert_eq!(mesh.check(), Ok(()));
    // Completion puts in nothing that elimination would drop.
    let envelope = mesh.cloud().boundary().envelope();
    let least = mesh.triangles().map(|t| mesh.area(t)).fold(f64::INFINITY, f64::min);
    assert!(least >= 1e-12 * envelope.width() * envelope.height(), "{least}");
    let MeshCensus { delaunay, outside, in_hole, tiny, crossing, completed } = census;
    assert_eq!(mesh.n_triangles(), delaunay - outside - in_hole - tiny - crossing + completed, "{census:?}");
    (mesh, census)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    #[test]
    fn every_region_is_filled(
        shape in any_shape(), nodes in any_density(), irregularity in prop_oneof![Just(0.0), 0.01..0.49f64],
    ) {
        checked(cloud(&shape.section(1.0), &params(nodes, irregularity)));
    }

    #[test]
    fn where_nothing_is_missing_it_is_the_constrained_triangulation(
        shape in any_shape(), nodes in any_density(), irregularity in prop_oneof![Just(0.0), 0.01..0.49f64],
    ) {
        let cloud = cloud(&shape.section(1.0), &params(nodes, irregularity));
        let (mesh, census) = checked(cloud.clone());
        if census.completed == 0 {
            prop_assert_eq!(mesh, Mesh::constrained(cloud).expect("a sound cloud"));
        }
    }
}

#[test]
fn narrow_slots_at_coarse_density_are_completed() {
    let mut completed = 0;
    for nodes in [[9, 9], [9, 5], [7, 12], [17, 9], [33, 17]] {
        for (irregularity, seed) in [(0.0, 0), (0.2, 1), (0.2, 2), (0.45, 3), (0.45, 4)] {
            let params = CloudParams { seed, ..params(nodes, irregularity) };
            completed += checked(cloud(&narrow_slot(), &params)).1.completed;
        }
    }
    assert!(completed > 0, "the slot's sides are edges of the Delaunay triangulation after all");
}

#[test]
fn slits_of_a_millionth_are_completed() {
    for nodes in [[9, 9], [21, 11], [41, 41]] {
        for irregularity in [0.0, 0.3] {
            let section = crate::sections::Shape::Slotted { width: 1e-6 }.section(1.0);
            checked(cloud(&section, &params(nodes, irregularity)));
        }
    }
}

#[test]
fn completion_joins_no_three_nodes_of_a_skew_side() {
    // Nodes of a skew side are on one line but for rounding. The gap at its corner was begun with three of them: a triangle
    // with an area of 0 in floating point (25 nodes), or of 1e-16 (16 nodes).
    let sevenths =
        [[5.0, 10.0], [3.0, 2.0], [5.0, 6.0], [3.0, 1.0], [8.0, 3.0]].map(|p| p.map(|c: f64| c * (1.0 / 7.0)));
    let whole = [[16.0, 7.0], [9.0, 2.0], [4.0, 22.0], [21.0, 9.0], [13.0, 6.0]];
    for (corners, nodes, n_nodes) in [(sevenths, [9, 5], 25), (whole, [4, 8], 16)] {
        let cloud = cloud(&Section::solid(Outline::polygon(corners)), &params(nodes, 0.0));
        assert_eq!(cloud.n_nodes(), n_nodes);
        assert!(checked(cloud).1.completed > 0);
    }
}

#[test]
fn each_step_can_be_left_out_and_tells_its_count() {
    let section = Section {
        contour: Outline::polygon([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]]),
        holes: vec![Outline::circle([0.5, 0.5], 0.2)],
    };
    let cloud = cloud(&section, &params([17, 17], 0.2));
    let all = stages(&cloud, &Elimination::default()).expect("a sound cloud").census;
    assert!(all.outside > 0 && all.in_hole > 0);
    let none = Elimination { outside: false, in_hole: false, tiny: false, complete: false };
    let left = stages(&cloud, &none).expect("a sound cloud");
    assert_eq!(left.delaunay, left.completed);
    assert_eq!(left.census, MeshCensus { delaunay: all.delaunay, ..MeshCensus::default() });
    let (mesh, census) = Mesh::unconstrained(cloud.clone(), &Elimination { in_hole: false, ..Elimination::default() })
        .expect("triangles in the hole hinder nothing");
    assert_eq!((census.in_hole, census.outside), (0, all.outside));
    assert!(mesh.check().is_err(), "the hole is filled with triangles");
    let outside_alone = Elimination { outside: true, ..none };
    assert_eq!(stages(&cloud, &outside_alone).expect("a sound cloud").census.outside, all.outside);
}

#[test]
fn a_micrometre_section_keeps_its_triangles() {
    // The paper's bound on areas, 1e-12 in any unit, would delete every triangle of 1e-7 × 1e-7.
    for unit in [1e-6, 1.0, 1e6] {
        let section = crate::sections::Shape::Perforated.section(unit);
        let (mesh, census) = checked(cloud(&section, &params([21, 11], 0.2)));
        assert!(census.tiny < 20 && mesh.n_triangles() > 200, "{census:?}");
    }
}

#[test]
fn what_completion_does_not_touch_is_left_as_it_was() {
    let cloud = cloud(&narrow_slot(), &params([9, 9], 0.0));
    let stages = stages(&cloud, &Elimination::default()).expect("every gap is filled");
    let added = stages.completed.iter().filter(|t| !stages.eliminated.contains(t)).count();
    assert!(stages.census.completed > 0 && added <= stages.census.completed + 2);
    let bare = |triangles: &[[nmt_geom::NodeId; 3]]| {
        let edges: Vec<[u32; 2]> = edges(triangles).iter().map(|edge| edge.nodes).collect();
        let segments = cloud.boundary().segments();
        segments.iter().filter(|s| !edges.contains(&[s.from.0.min(s.to.0), s.from.0.max(s.to.0)])).count()
    };
    assert!(bare(&stages.eliminated) > 0);
    assert_eq!(bare(&stages.completed), 0);
}

#[test]
fn nodes_at_one_place_are_an_error() {
    let sound = cloud(&narrow_slot(), &params([9, 9], 0.0));
    let mut interior = sound.xy()[sound.n_boundary()..].to_vec();
    interior.push(interior[0]);
    let cloud = Cloud::from_parts(sound.boundary().clone(), 8, interior, [0.5, 0.25], sound.census());
    let error = Mesh::unconstrained(cloud, &Elimination::default()).map(|_| ());
    assert!(matches!(error, Err(MeshError::SameNode { .. })), "{error:?}");
}
