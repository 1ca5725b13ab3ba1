//! The Delaunay property by brute force, the tie rule, and its independence of the unit of length.

use crate::sections::{Shape, any_shape, mesh, params};
use nmt_cloud::{CloudParams, Section};
use nmt_curve::Outline;
use nmt_geom::point::{cross, distance_squared, dot, sub};
use nmt_geom::{NodeId, Point, segment};
use nmt_tri::Mesh;
use proptest::prelude::*;
use std::collections::HashMap;

/// Power of `d` with respect to the circle through `a`, `b`, `c`, in units of the square of the longest distance:
/// negative inside.
fn relative_power([a, b, c]: [Point; 3], d: Point) -> f64 {
    let [u, v, w] = [sub(a, d), sub(b, d), sub(c, d)];
    let lift = |p: Point| dot(p, p);
    let incircle = lift(u) * cross(v, w) + lift(v) * cross(w, u) + lift(w) * cross(u, v);
    let longest = [(a, b), (b, c), (c, a), (a, d), (b, d), (c, d)]
        .iter()
        .fold(0.0f64, |l, (p, q)| l.max(distance_squared(*p, *q)));
    -incircle / (cross(sub(b, a), sub(c, a)) * longest)
}

/// A node this little inside a circle counts as on it: ties are settled within 1e-9, and a chain of tied neighbours can
/// add a few of them up.
const ON_CIRCLE: f64 = 1e-8;

fn is_hidden(mesh: &Mesh, p: Point, q: Point) -> bool {
    let margin = 1e-12 * mesh.cloud().size(); // rounding of the centroid
    mesh.cloud().boundary().all_ends().any(|[a, b]| segment::cross_properly(p, q, a, b, margin))
}

/// Asserts that no circle about a triangle holds a node that the triangle's centroid sees.
fn assert_delaunay(mesh: &Mesh) {
    for t in mesh.triangles() {
        let corners = mesh.corners(t);
        let centroid = [0, 1].map(|d| corners.iter().map(|p| p[d]).sum::<f64>() / 3.0);
        for (node, &d) in mesh.xy().iter().enumerate() {
            if mesh.tri_nodes()[t.index()].contains(&NodeId::of(node)) {
                continue;
            }
            let power = relative_power(corners, d);
            assert!(
                power > -ON_CIRCLE || is_hidden(mesh, centroid, d),
                "node {node} is in the circle of {:?} by {power:e}",
                mesh.tri_nodes()[t.index()]
            );
        }
    }
}

/// Asserts that of four nodes on one circle the diagonal holds the smallest number; returns how many ties there were.
fn assert_ties_are_settled(mesh: &Mesh) -> usize {
    let mut opposite: HashMap<[NodeId; 2], NodeId> = HashMap::new();
    for nodes in mesh.tri_nodes() {
        (0..3).for_each(|k| {
            opposite.insert([nodes[k], nodes[(k + 1) % 3]], nodes[(k + 2) % 3]);
        });
    }
    let at = |node: NodeId| mesh.xy()[node.index()];
    let mut ties = 0;
    for (&[a, b], &c) in &opposite {
        let Some(&d) = opposite.get(&[b, a]) else { continue };
        let on_circle = relative_power([a, b, c].map(at), at(d)).abs() < 1e-10; // a tenth of what counts as a tie
        // The other diagonal must cut the quadrilateral into two triangles that are no slivers.
        let area = |p: NodeId, q: NodeId, r: NodeId| cross(sub(at(q), at(p)), sub(at(r), at(p)));
        let longest = distance_squared(at(a), at(b)).max(distance_squared(at(c), at(d)));
        let convex = area(c, a, d) > 1e-5 * longest && area(d, b, c) > 1e-5 * longest;
        if on_circle && convex {
            ties += 1;
            assert!(a.min(b) < c.min(d), "the diagonal {a:?} {b:?} should be {c:?} {d:?}");
        }
    }
    ties / 2
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn no_circle_about_a_triangle_holds_a_visible_node(
        shape in any_shape(), nodes in prop::array::uniform2(10usize..18),
        irregularity in prop_oneof![Just(0.0), 0.01..0.49f64],
    ) {
        let section = shape.section(1.0);
        // Coarse clouds of thin shapes may have no interior node at all.
        let params = CloudParams { edge_clearance: 0.2, node_clearance: 0.3, ..params(nodes, irregularity) };
        let mesh = mesh(&section, &params);
        assert_delaunay(&mesh);
        assert_ties_are_settled(&mesh);
    }

    #[test]
    fn a_section_has_the_same_triangles_in_every_unit(
        shape in any_shape(), nodes in prop::array::uniform2(14usize..40),
        irregularity in prop_oneof![Just(0.0), 0.01..0.49f64],
        unit in prop::sample::select(vec![1e-3, 1e3, 1e6, 1e-6, 0.3048]),
    ) {
        let params = params(nodes, irregularity);
        let (one, other) = (mesh(&shape.section(1.0), &params), mesh(&shape.section(unit), &params));
        prop_assert_eq!(one.tri_nodes(), other.tri_nodes());
    }
}

#[test]
fn every_cell_of_a_regular_cloud_is_a_tie_and_settled_by_number() {
    let rectangle = Section::solid(Outline::rectangle([0.0, 0.0], [2.0, 1.0]));
    let regular = mesh(&rectangle, &params([21, 11], 0.0));
    assert_eq!(assert_ties_are_settled(&regular), 20 * 10);
    assert_delaunay(&regular);
    let disc = mesh(&Section::solid(Outline::circle([0.0, 0.0], 1.0)), &params([21, 21], 0.0));
    assert!(assert_ties_are_settled(&disc) > 200);
    assert_delaunay(&disc);
}

#[test]
fn a_slot_hides_nodes_from_the_triangles_beside_it() {
    let slotted = mesh(&Shape::Slotted { width: 0.02 }.section(1.0), &params([21, 11], 0.2));
    assert_delaunay(&slotted);
    // The test tests something: without the walls some circle would hold a node.
    let across = slotted.triangles().any(|t| {
        let corners = slotted.corners(t);
        let is_corner = |n: usize| slotted.tri_nodes()[t.index()].contains(&NodeId::of(n));
        slotted.xy().iter().enumerate().any(|(n, p)| !is_corner(n) && relative_power(corners, *p) < -ON_CIRCLE)
    });
    assert!(across);
}
