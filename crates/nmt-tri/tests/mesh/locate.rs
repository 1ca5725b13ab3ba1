//! The look-up of triangles against a search through all of them.

use crate::sections::{Shape, any_shape, mesh, params};
use nmt_geom::{Point, TriId, segment};
use nmt_tri::{Mesh, TriangleIndex, barycentric};
use proptest::prelude::*;

fn holds(mesh: &Mesh, t: TriId, p: Point) -> bool {
    barycentric(mesh.corners(t), p).iter().all(|l| *l >= 0.0)
}

fn distance(mesh: &Mesh, t: TriId, p: Point) -> f64 {
    if holds(mesh, t, p) {
        return 0.0;
    }
    let [a, b, c] = mesh.corners(t);
    [(a, b), (b, c), (c, a)].iter().fold(f64::INFINITY, |d, (q, r)| d.min(segment::distance_to(p, *q, *r)))
}

fn by_brute_force(mesh: &Mesh, p: Point, tolerance: f64) -> Option<TriId> {
    if let Some(t) = mesh.triangles().find(|&t| holds(mesh, t, p)) {
        return Some(t);
    }
    let near = mesh.triangles().map(|t| (distance(mesh, t, p), t)).filter(|(d, _)| *d <= tolerance);
    near.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))).map(|(_, t)| t)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn the_index_finds_what_a_search_through_all_triangles_finds(
        shape in any_shape(), irregularity in prop_oneof![Just(0.0), 0.01..0.49f64],
        points in prop::collection::vec(prop::array::uniform2(-0.2..1.2f64), 40), pick in any::<prop::sample::Index>(),
        tolerance in prop::sample::select(vec![0.0, 1e-9, 0.02, 0.3]),
    ) {
        let mesh = mesh(&shape.section(1.0), &params([15, 15], irregularity));
        let index = TriangleIndex::new(&mesh);
        let envelope = mesh.cloud().boundary().envelope();
        let scattered = points.iter().map(|p| {
            [envelope.min[0] + p[0] * envelope.width(), envelope.min[1] + p[1] * envelope.height()]
        });
        // Nodes, centroids, and middles of sides, which lie on the border of two triangles but for rounding.
        let [a, b, c] = mesh.corners(TriId::of(pick.index(mesh.n_triangles())));
        let middle = |p: Point, q: Point| [(p[0] + q[0]) / 2.0, (p[1] + q[1]) / 2.0];
        let centroid = [(a[0] + b[0] + c[0]) / 3.0, (a[1] + b[1] + c[1]) / 3.0];
        let special = [a, b, c, middle(a, b), middle(b, c), middle(c, a), centroid];
        for p in scattered.chain(special) {
            prop_assert_eq!(index.locate(p, tolerance), by_brute_force(&mesh, p, tolerance), "{:?}", p);
        }
    }
}

#[test]
fn points_without_a_triangle_are_not_located() {
    let mesh = mesh(&Shape::Perforated.section(1.0), &params([21, 11], 0.0));
    let index = TriangleIndex::new(&mesh);
    for p in [[0.8, 1.1], [2.1, 1.0], [-1.0, 1.0], [1e300, 0.0], [f64::NAN, 0.5], [f64::INFINITY, f64::NEG_INFINITY]] {
        assert_eq!(index.locate(p, 1e-9), None, "{p:?}");
    }
    // Beside the contour by less than the tolerance: the nearest triangle, which has its edge there.
    let beside = index.locate([2.0, -1e-10], 1e-9).expect("within the tolerance");
    assert!(mesh.corners(beside).iter().any(|p| p[1] == 0.0));
    assert_eq!(index.locate([2.0, -1e-10], 1e-11), None);
}
