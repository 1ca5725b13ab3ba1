//! Smoothed clouds: nothing turned over, boundary and clearances kept, better triangles.

use crate::sections::{any_density, any_shape, mesh, params};
use nmt_cloud::CloudParams;
use nmt_tri::{Mesh, quality, smooth};
use proptest::prelude::*;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn boundary_and_clearances_are_kept_and_triangles_get_better(
        shape in any_shape(), nodes in any_density(), irregularity in 0.2..0.49f64, seed in any::<u64>(), sweeps in 1usize..6,
    ) {
        let section = shape.section(1.0);
        let before = mesh(&section, &CloudParams { seed, ..params(nodes, irregularity) });
        let cloud = smooth(&before, sweeps);
        prop_assert_eq!(cloud.check(), Ok(())); // inside, and clear of the boundary
        prop_assert_eq!(cloud.boundary(), before.cloud().boundary());
        prop_assert_eq!(cloud.n_nodes(), before.cloud().n_nodes());
        let after = Mesh::constrained(cloud).expect("a sound cloud");
        prop_assert_eq!(after.check(), Ok(()));
        let mean = |mesh: &Mesh| quality(mesh).map_or(0.0, |q| q.mean);
        prop_assert!(mean(&after) > mean(&before), "{} {}", mean(&after), mean(&before));
    }
}

#[test]
fn no_sweep_moves_nothing_and_a_regular_cloud_hardly_moves() {
    let section = nmt_cloud::Section::solid(nmt_curve::Outline::rectangle([0.0, 0.0], [1.0, 1.0]));
    let regular = mesh(&section, &params([21, 21], 0.0));
    assert_eq!(&smooth(&regular, 0), regular.cloud());
    // Each inner node of the grid is the middle of the triangles around it; the cuts of the corner cells are not symmetric.
    let moved = smooth(&regular, 1);
    let far = moved.xy().iter().zip(regular.xy()).filter(|(p, q)| nmt_geom::point::distance(**p, **q) > 0.01).count();
    assert!(far < 40, "{far}");
    assert!(moved.lattice().is_some());
}
