//! The same section in millimetres, metres and kilometres has the same nodes.

use crate::sections::{any_density, any_shape, cloud, params};
use nmt_geom::NodeId;
use nmt_geom::point::distance;
use proptest::prelude::*;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn nodes_scale_with_the_unit_and_their_number_does_not(
        shape in any_shape(), nodes in any_density(), irregularity in prop_oneof![Just(0.0), 0.01..0.49f64],
        unit in prop::sample::select(vec![1e-3, 1e3, 1e6, 1e-6, 0.3048]),
    ) {
        let params = params(nodes, irregularity);
        let (one, other) = (cloud(&shape.section(1.0), &params), cloud(&shape.section(unit), &params));
        prop_assert_eq!(one.n_vertices(), other.n_vertices());
        prop_assert_eq!(one.n_boundary(), other.n_boundary());
        prop_assert_eq!(one.n_interior(), other.n_interior());
        // By cause the census may differ by sites that lie exactly on a boundary: rounding settles on which side.
        prop_assert_eq!(one.census().kept, other.census().kept);
        for n in 0..one.n_nodes() {
            let scaled = one.xy()[n].map(|c| c * unit);
            let off = distance(scaled, other.xy()[n]) / other.size();
            prop_assert!(off < 1e-12, "node {} is off by {:e} of the size", n, off); // rounding, and arc lengths by bisection
            prop_assert_eq!(one.edges(NodeId::of(n)), other.edges(NodeId::of(n)));
        }
    }
}
