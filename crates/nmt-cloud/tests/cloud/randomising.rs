//! An existing cloud randomised as a library call.

use crate::sections::{Shape, any_density, any_shape, cloud, params};
use nmt_cloud::{Cloud, CloudError, NodeKind, Section, randomise};
use nmt_curve::Outline;
use nmt_geom::NodeId;
use nmt_geom::point::distance;
use proptest::prelude::*;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn vertices_stay_edge_nodes_slide_and_interior_nodes_move_within_the_amplitude(
        shape in any_shape(), nodes in any_density(), amplitude in 0.01..0.49f64, seed in any::<u64>(),
    ) {
        let section = shape.section(1.0);
        let regular = cloud(&section, &params(nodes, 0.0));
        let moved = randomise(&section, &regular, amplitude, seed).expect("a sound section");
        prop_assert_eq!(moved.check(), Ok(()));
        prop_assert_eq!(moved.n_boundary(), regular.n_boundary());
        prop_assert_eq!(&moved.xy()[..moved.n_vertices()], &regular.xy()[..regular.n_vertices()]);
        let fractions = |cloud: &Cloud| cloud.edge_fractions().expect("a generated cloud").to_vec();
        let (before, after) = (fractions(&regular), fractions(&moved));
        for node in regular.n_vertices()..regular.n_boundary() {
            let id = NodeId::of(node);
            prop_assert_eq!(moved.kind(id), NodeKind::Edge);
            prop_assert_eq!(moved.edges(id), regular.edges(id));
            let on_edge = (regular.n_vertices()..regular.n_boundary())
                .filter(|n| regular.edges(NodeId::of(*n)) == regular.edges(id))
                .count();
            // Evenly divided: a segment is 1/(n + 1) of its edge.
            let slide = (after[node] - before[node]).abs() * (on_edge + 1) as f64;
            prop_assert!(slide <= amplitude * (1.0 + 1e-9), "{}", slide);
        }
        let lost = regular.n_nodes() - moved.n_nodes();
        let census = (regular.census(), moved.census());
        prop_assert_eq!(census.0.kept - census.1.kept, lost);
        let [h_x, h_y] = regular.spacing();
        let sites = moved.sites().expect("born on a lattice");
        let lattice = moved.lattice().expect("born on a lattice");
        for (site, p) in sites.iter().zip(&moved.xy()[moved.n_boundary()..]) {
            let [i, j] = lattice.site_of(*site);
            let site = lattice.site(i, j);
            prop_assert!((p[0] - site[0]).abs() <= amplitude * h_x * (1.0 + 1e-9));
            prop_assert!((p[1] - site[1]).abs() <= amplitude * h_y * (1.0 + 1e-9));
        }
    }
}

#[test]
fn nothing_moves_at_amplitude_0_and_much_at_a_large_one() {
    let section = Shape::Perforated.section(1.0);
    let regular = cloud(&section, &params([41, 21], 0.0));
    let still = randomise(&section, &regular, 0.0, 5).expect("a sound section");
    assert_eq!(still.n_nodes(), regular.n_nodes());
    // Nodes of curves are placed anew from their fraction of the length: equal to rounding.
    assert!(still.xy().iter().zip(regular.xy()).all(|(p, q)| distance(*p, *q) < 1e-12));
    let moved = randomise(&section, &regular, 0.45, 5).expect("a sound section");
    let far = moved.xy().iter().filter(|p| regular.xy().iter().all(|q| distance(**p, *q) > 0.01)).count();
    assert!(far > moved.n_interior() / 2, "{far}");
    assert_eq!(randomise(&section, &regular, 0.45, 5), Ok(moved)); // the same seed, the same cloud
}

#[test]
fn a_cloud_randomised_again_and_again_leaves_its_lattice() {
    let section = Section::solid(Outline::rectangle([0.0, 0.0], [1.0, 1.0]));
    let mut again = cloud(&section, &params([21, 21], 0.0));
    for seed in 0..6 {
        again = randomise(&section, &again, 0.4, seed).expect("a sound section");
        assert_eq!(again.check(), Ok(()));
    }
    assert_eq!((again.sites(), again.lattice()), (None, None));
}

#[test]
fn what_cannot_be_randomised_is_an_error() {
    let section = Shape::Arch.section(1.0);
    let regular = cloud(&section, &params([25, 19], 0.0));
    assert!(matches!(randomise(&section, &regular, 0.5, 1), Err(CloudError::Parameter { .. })));
    assert!(matches!(randomise(&section, &regular, f64::NAN, 1), Err(CloudError::Parameter { .. })));
    let other = Section::solid(Outline::rectangle([0.0, 0.0], [1.0, 1.0]));
    let error = randomise(&other, &regular, 0.2, 1);
    assert_eq!(error, Err(CloudError::OtherSection { vertices: 4, n_vertices: 5 }));
    let parts = Cloud::from_parts(regular.boundary().clone(), 5, vec![[1.0, 0.5]], [0.1, 0.1], regular.census());
    assert_eq!(randomise(&section, &parts, 0.2, 1), Err(CloudError::NotGenerated));
}
