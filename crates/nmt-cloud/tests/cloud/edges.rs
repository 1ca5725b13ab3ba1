//! Nodes on the outline: how many (2), where (1), and how far an irregular cloud slides them.

use crate::sections::{Shape, any_density, any_shape, cloud, params};
use nmt_cloud::{Cloud, CloudParams, Section};
use nmt_curve::{Curve, Outline};
use nmt_geom::point::{cross, distance, sub};
use nmt_geom::{EdgeId, NodeId, Point};
use proptest::prelude::*;
use std::f64::consts::TAU;

/// Nodes of one edge, in the order of their numbers, without its vertices.
fn inner_nodes(cloud: &Cloud, edge: usize) -> Vec<Point> {
    let on_edge = |n: &usize| cloud.edges(NodeId::of(*n)).is_some_and(|edges| edges.first == EdgeId::of(edge));
    (cloud.n_vertices()..cloud.n_boundary()).filter(on_edge).map(|n| cloud.xy()[n]).collect()
}

fn curves(section: &Section) -> Vec<Curve> {
    section.loops().flat_map(|outline| outline.edges.iter().map(|edge| edge.curve.clone())).collect()
}

/// Fraction of the way along a line, angle or abscissa at which a point of the curve lies, and how far off it lies.
struct Place {
    fraction: f64,
    off: f64,
}

fn place(curve: &Curve, p: Point) -> Place {
    match curve {
        Curve::Line { from, to } => {
            let (v, length) = (sub(*to, *from), distance(*from, *to));
            let along = sub(p, *from);
            let fraction = (along[0] * v[0] + along[1] * v[1]) / (length * length);
            Place { fraction, off: (cross(v, along) / length).abs() }
        }
        Curve::Graph { y, from_x, to_x } => {
            Place { fraction: (p[0] - from_x) / (to_x - from_x), off: (p[1] - y.at(p[0])).abs() }
        }
        Curve::Arc { centre, radius, start, sweep } => {
            let v = sub(p, *centre);
            let turned = (v[1].atan2(v[0]) - start) * sweep.signum();
            Place { fraction: turned.rem_euclid(TAU) / sweep.abs(), off: (v[0].hypot(v[1]) - radius).abs() }
        }
        Curve::Ellipse { centre, semi_axes, rotation } => {
            let v = sub(p, *centre);
            let (s, c) = rotation.sin_cos();
            let [x, y] = [(c * v[0] + s * v[1]) / semi_axes[0], (c * v[1] - s * v[0]) / semi_axes[1]];
            Place { fraction: y.atan2(x).rem_euclid(TAU) / TAU, off: (x.hypot(y) - 1.0).abs() * semi_axes[0] }
        }
        Curve::Parametric { .. } => unreachable!("no shape of these tests has one"),
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn straight_edges_have_the_nodes_of_equations_1_and_2(shape in any_shape(), nodes in any_density()) {
        let section = shape.section(1.0);
        let cloud = cloud(&section, &params(nodes, 0.0));
        let envelope = section.contour.envelope();
        for (edge, curve) in curves(&section).iter().enumerate() {
            let Curve::Line { from, to } = curve else { continue };
            let along_x = nodes[0] as f64 * (to[0] - from[0]).abs() / envelope.width();
            let along_y = nodes[1] as f64 * (to[1] - from[1]).abs() / envelope.height();
            let n = ((along_x.max(along_y) - 1e-6).ceil() as usize).max(2);
            let inner = inner_nodes(&cloud, edge);
            prop_assert_eq!(inner.len(), n - 2, "edge {}", edge);
            for (k, p) in inner.iter().enumerate() {
                let t = (k + 1) as f64 / (n - 1) as f64;
                let expected = [from[0] + t * (to[0] - from[0]), from[1] + t * (to[1] - from[1])];
                prop_assert!(distance(*p, expected) < 1e-14 * envelope.size()); // rounding
            }
        }
    }

    #[test]
    fn edge_nodes_lie_on_their_curves_in_order_however_irregular(
        shape in any_shape(), nodes in any_density(),
        irregularity in prop_oneof![Just(0.0), 0.01..0.49f64], seed in any::<u64>(),
    ) {
        let section = shape.section(1.0);
        let size = section.contour.envelope().size();
        let cloud = cloud(&section, &CloudParams { seed, ..params(nodes, irregularity) });
        for (edge, curve) in curves(&section).iter().enumerate() {
            let places: Vec<Place> = inner_nodes(&cloud, edge).iter().map(|p| place(curve, *p)).collect();
            // The promise of the curves: 1e-9 of the size.
            prop_assert!(places.iter().all(|place| place.off < 1e-9 * size), "edge {}", edge);
            let fractions: Vec<f64> = places.iter().map(|place| place.fraction).collect();
            prop_assert!(fractions.iter().all(|t| (0.0..1.0).contains(t)), "edge {}: {:?}", edge, fractions);
            prop_assert!(fractions.windows(2).all(|t| t[0] < t[1]), "edge {}: {:?}", edge, fractions);
        }
    }

    #[test]
    fn nodes_of_lines_and_circles_slide_by_at_most_amp_of_a_segment(
        nodes in any_density(), irregularity in 0.01..0.49f64, seed in any::<u64>(),
    ) {
        let section = Shape::Perforated.section(1.0);
        let cloud = cloud(&section, &CloudParams { seed, ..params(nodes, irregularity) });
        let mut largest = 0.0f64;
        for (edge, curve) in curves(&section).iter().enumerate() {
            let of_constant_speed = matches!(curve, Curve::Line { .. })
                || matches!(curve, Curve::Ellipse { semi_axes: [a, b], .. } if a == b);
            if !of_constant_speed {
                continue;
            }
            let inner = inner_nodes(&cloud, edge);
            let n_segments = (inner.len() + 1) as f64;
            for (k, p) in inner.iter().enumerate() {
                let slide = place(curve, *p).fraction * n_segments - (k + 1) as f64;
                largest = largest.max(slide.abs());
            }
        }
        prop_assert!(largest <= irregularity * (1.0 + 1e-9)); // rounding of the fractions
        // Of 50 nodes and more, one is in the outer half: the chance of none is 2⁻⁵⁰.
        prop_assert!(largest > irregularity / 2.0);
    }
}

#[test]
fn an_edge_with_a_count_of_its_own_gets_it() {
    let mut section = Shape::Arch.section(1.0);
    let own = [7, 12, 30, 5];
    section.contour.edges.iter_mut().zip(own).for_each(|(edge, n)| edge.nodes = Some(n));
    section.holes[0].edges[0].nodes = Some(40);
    let cloud = cloud(&section, &params([25, 19], 0.2));
    for (edge, n) in own.into_iter().enumerate() {
        assert_eq!(inner_nodes(&cloud, edge).len(), n - 2);
    }
    assert_eq!(inner_nodes(&cloud, 4).len(), 39); // a closed edge has one vertex
}

#[test]
fn a_hole_may_have_a_density_of_its_own_relative_to_its_own_envelope() {
    let section = Shape::Perforated.section(1.0);
    let counts = |hole_nodes: Vec<Option<[usize; 2]>>| -> Vec<usize> {
        let cloud = cloud(&section, &CloudParams { hole_nodes, ..params([41, 21], 0.0) });
        (4..10).map(|edge| inner_nodes(&cloud, edge).len() + 2).collect()
    };
    // By default 41/4 and 21/2 for each unit: circle ⌈4·√2·0.4·…⌉ by the piecewise rule, square 0.6 × 1.
    let default = counts(vec![]);
    assert_eq!(default[1..5], [11, 7, 11, 7]);
    // The square hole alone: 20 across its own width, 9 along its own height.
    let own = counts(vec![None, Some([20, 9])]);
    assert_eq!(own[1..5], [9, 20, 9, 20]);
    assert_eq!((own[0], own[5]), (default[0], default[5]));
    // A circle of N across its own envelope: I = 4·√2·(N/2), one vertex counted in.
    let round = counts(vec![Some([25, 25])]);
    assert_eq!(round[0] - 1, (50.0 * 2f64.sqrt()).ceil() as usize);
}

#[test]
fn a_regular_circle_has_its_nodes_at_equal_angles_from_angle_0() {
    let cloud = cloud(&Section::solid(Outline::circle([3.0, -2.0], 1.5)), &params([21, 21], 0.0));
    let n = cloud.n_boundary();
    assert_eq!((cloud.n_vertices(), n), (1, (42.0 * 2f64.sqrt()).ceil() as usize));
    for (k, p) in cloud.boundary().xy().iter().enumerate() {
        let t = TAU * k as f64 / n as f64;
        let expected = [3.0 + 1.5 * t.cos(), -2.0 + 1.5 * t.sin()];
        assert!(distance(*p, expected) < 1e-12); // the accuracy of the arc table is 1e-14, rounding less
    }
}
