//! Which grid points are kept: the clearances of (7)–(9) recomputed against every segment and every boundary node.

use crate::sections::{any_density, any_shape, cloud, params};
use nmt_cloud::{Cloud, CloudParams};
use nmt_geom::Point;
use nmt_geom::point::{cross, distance, dot, sub};
use proptest::prelude::*;
use std::f64::consts::PI;

/// Distances nearer to the limit than this fraction of the spacing may fall either way: the limit itself is only meant
/// to 1e-12 of the size, and coordinates of sites can be written in several ways that differ by 1e-15.
const UNDECIDED: f64 = 1e-9;

/// Distance from the boundary's segments and from its nodes, in units of max(h_x, h_y).
struct Distances {
    segment: f64,
    node: f64,
}

fn distances(cloud: &Cloud, p: Point) -> Distances {
    let to_segment = |[a, b]: [Point; 2]| {
        let (ab, ap) = (sub(b, a), sub(p, a));
        let t = (dot(ap, ab) / dot(ab, ab)).clamp(0.0, 1.0);
        distance(p, [a[0] + t * ab[0], a[1] + t * ab[1]])
    };
    let least = |values: &mut dyn Iterator<Item = f64>| values.fold(f64::INFINITY, f64::min) / cloud.max_spacing();
    let boundary = cloud.boundary();
    Distances {
        segment: least(&mut boundary.all_ends().map(to_segment)),
        node: least(&mut boundary.xy().iter().map(|q| distance(p, *q))),
    }
}

/// Turns of one loop about `p`: the sum of the angles that its segments are seen under.
fn turns(cloud: &Cloud, p: Point) -> i64 {
    let angle = |[a, b]: [Point; 2]| {
        let (u, v) = (sub(a, p), sub(b, p));
        cross(u, v).atan2(dot(u, v))
    };
    (cloud.boundary().all_ends().map(angle).sum::<f64>() / (2.0 * PI)).round() as i64
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn exactly_the_grid_points_that_are_inside_and_clear_are_kept(
        shape in any_shape(), nodes in any_density(),
        fractions in prop_oneof![2 => Just([1.0 / 3.0, 0.5]), 1 => prop::array::uniform2(0.05..1.0f64)],
    ) {
        let section = shape.section(1.0);
        let [edge_clearance, node_clearance] = fractions;
        let cloud = cloud(&section, &CloudParams { edge_clearance, node_clearance, ..params(nodes, 0.0) });
        let envelope = section.contour.envelope();
        let spacing = cloud.spacing();
        prop_assert!((spacing[0] * (nodes[0] - 1) as f64 / envelope.width() - 1.0).abs() < 1e-14); // rounding
        let interior = &cloud.xy()[cloud.n_boundary()..];
        let mut kept = 0;
        for j in 1..nodes[1] - 1 {
            for i in 1..nodes[0] - 1 {
                let site = [envelope.min[0] + i as f64 * spacing[0], envelope.min[1] + j as f64 * spacing[1]];
                let is_node = |p: &Point| distance(*p, site) < 1e-9 * cloud.max_spacing(); // far above rounding
                let is_kept = interior.iter().any(is_node);
                kept += usize::from(is_kept);
                let Distances { segment, node } = distances(&cloud, site);
                if (segment - edge_clearance).abs() < UNDECIDED || (node - node_clearance).abs() < UNDECIDED {
                    continue;
                }
                let clear = segment > edge_clearance && node > node_clearance;
                // A point clear of the boundary sees its loops turn once where it is inside, and not at all elsewhere.
                prop_assert_eq!(is_kept, clear && turns(&cloud, site) == 1, "site {:?}", site);
            }
        }
        prop_assert_eq!(kept, cloud.n_interior(), "every interior node is a site of the grid");
    }

    #[test]
    fn nodes_of_an_irregular_cloud_are_inside_clear_and_near_their_sites(
        shape in any_shape(), nodes in any_density(), irregularity in 0.01..0.49f64, seed in any::<u64>(),
    ) {
        let section = shape.section(1.0);
        let irregular = cloud(&section, &CloudParams { seed, ..params(nodes, irregularity) });
        let [h_x, h_y] = irregular.spacing();
        let envelope = section.contour.envelope();
        for &p in &irregular.xy()[irregular.n_boundary()..] {
            let Distances { segment, node } = distances(&irregular, p);
            prop_assert!(segment >= 1.0 / 3.0 - UNDECIDED && node >= 0.5 - UNDECIDED, "{:?}: {} {}", p, segment, node);
            prop_assert_eq!(turns(&irregular, p), 1);
            // Less than half a spacing from its site, so that the site is the nearest one.
            for (d, h) in [(0, h_x), (1, h_y)] {
                let column = (p[d] - envelope.min[d]) / h;
                let shift = (column - column.round()).abs();
                prop_assert!(shift <= irregularity + UNDECIDED, "{:?} moved by {} spacings", p, shift);
            }
        }
    }

    #[test]
    fn the_census_accounts_for_every_grid_point(
        shape in any_shape(), nodes in any_density(), irregularity in prop_oneof![Just(0.0), 0.01..0.49f64],
    ) {
        let cloud = cloud(&shape.section(1.0), &params(nodes, irregularity));
        let census = cloud.census();
        prop_assert_eq!(census.grid, (nodes[0] - 2) * (nodes[1] - 2));
        let deleted = census.outside + census.in_hole + census.near_edge + census.near_node;
        prop_assert_eq!(census.grid, deleted + census.kept);
        prop_assert_eq!(census.kept, cloud.n_interior());
    }
}

#[test]
fn every_cause_of_the_census_is_met_by_a_plate_with_a_hole() {
    // 4 × 4 less the corner above x + y = 6, with a square hole (0.5, 0.5)–(1.75, 1.75), at h = 0.5: counted by hand.
    let section = nmt_cloud::Section {
        contour: nmt_curve::Outline::polygon([[0.0, 0.0], [4.0, 0.0], [4.0, 2.0], [2.0, 4.0], [0.0, 4.0]]),
        holes: vec![nmt_curve::Outline::rectangle([0.5, 0.5], [1.75, 1.75])],
    };
    let census = cloud(&section, &params([9, 9], 0.0)).census();
    // Sites (i, j)/2, 1 ≤ i, j ≤ 7: on or above the skew side i + j ≥ 12: 6 of them. In the hole or on its boundary: 3 × 3.
    assert_eq!((census.grid, census.outside, census.in_hole), (49, 6, 9));
    // The next row i + j = 11 is 0.35 from the skew side: clear. None of the others is nearer than h/2 to the contour.
    // Beside the hole's right and upper side, x or y = 2: 0.25 away, clear of the segments (1/6) and of the nodes (1/4)
    // only just, as (9) keeps a node exactly at its limit.
    assert_eq!((census.near_edge, census.near_node, census.kept), (0, 0, 34));
}
