//! Ten thousand random regions: whatever the outline, a cloud is sound or an error says why there is none.

use nmt_cloud::{ClearanceUnit, CloudError, CloudParams, Section, generate, randomise};
use nmt_curve::{Curve, Division, Expression, Outline, OutlineEdge, Turn};
use nmt_geom::{Point, Region};
use proptest::prelude::*;
use std::f64::consts::TAU;

/// What a region is drawn from: a contour that its middle sees all of, with spikes, bays and curved sides, and holes on a
/// ring of places within it.
#[derive(Clone, Debug)]
struct Draft {
    radii: Vec<f64>,
    curved: Vec<u8>, // kind of each side
    holes: Vec<(f64, u8)>,
    stretch: [f64; 2],
    turn: f64,
}

fn draft() -> impl Strategy<Value = Draft> {
    (3usize..16)
        .prop_flat_map(|n| {
            (
                prop::collection::vec(0.55..1.6f64, n),
                prop::collection::vec(0u8..8, n),
                prop::collection::vec((0.02..0.09f64, 0u8..3), 0..4),
                prop::array::uniform2(0.2..5.0f64),
                0.0..TAU,
            )
        })
        .prop_map(|(radii, curved, holes, stretch, turn)| Draft { radii, curved, holes, stretch, turn })
}

impl Draft {
    /// The section; sides between corners may be arcs or waves, which can make the outline cross itself.
    fn section(&self) -> Section {
        let n = self.radii.len();
        let at = |p: Point| [p[0] * self.stretch[0], p[1] * self.stretch[1]];
        let corner = |k: usize| {
            let t = self.turn + TAU * k as f64 / n as f64;
            at([self.radii[k % n] * t.cos(), self.radii[k % n] * t.sin()])
        };
        let mut contour = Outline::polygon((0..n).map(corner));
        for (k, edge) in contour.edges.iter_mut().enumerate() {
            let (a, b) = (corner(k), corner(k + 1));
            edge.curve = match self.curved[k] {
                0 => bulge(a, b, 0.15, Turn::CounterClockwise),
                1 => bulge(a, b, 0.15, Turn::Clockwise),
                2 => wave(a, b, 0.05),
                _ => continue,
            };
        }
        let hole = |(k, &(size, kind)): (usize, &(f64, u8))| {
            let t = self.turn + TAU * k as f64 / 4.0;
            // Inside the circle of radius 0.25 that every polygon of radii from 0.55 and at least three corners holds.
            let centre = at([0.12 * t.cos(), 0.12 * t.sin()]);
            let [w, h] = self.stretch.map(|s| s * size * 0.8);
            match kind {
                0 => Outline::circle(centre, w.min(h)),
                1 => Outline::ellipse(centre, [w.min(h), 0.5 * w.min(h)], t),
                _ => Outline::rectangle([centre[0] - w, centre[1] - h], [centre[0] + w, centre[1] + h]),
            }
        };
        Section { contour, holes: self.holes.iter().enumerate().map(hole).collect() }
    }
}

/// An arc whose height is `rise` of its chord.
fn bulge(a: Point, b: Point, rise: f64, turn: Turn) -> Curve {
    let chord = [b[0] - a[0], b[1] - a[1]];
    let sign = if turn == Turn::CounterClockwise { 1.0 } else { -1.0 };
    let to_centre = sign * (0.25 - rise * rise) / (2.0 * rise);
    let centre = [0.5 * (a[0] + b[0]) - to_centre * chord[1], 0.5 * (a[1] + b[1]) + to_centre * chord[0]];
    Curve::arc(centre, a, b, turn)
}

/// A sine wave of three half-waves about the chord.
fn wave(a: Point, b: Point, height: f64) -> Curve {
    let [dx, dy] = [b[0] - a[0], b[1] - a[1]];
    let formula = |start: f64, run: f64, across: f64| {
        Expression::parse(&format!("{start:e} + {run:e}*t + {:e}*sin(3*pi*t)", across * height), &["t"])
            .expect("a formula")
    };
    let (x, y) = (formula(a[0], dx, -dy), formula(a[1], dy, dx));
    Curve::Parametric { x, y, from_t: 0.0, to_t: 1.0 }
}

fn is_sound(section: &Section) -> bool {
    let size = section.contour.envelope().size();
    let flat = |outline: &Outline| outline.flatten(1e-4 * size);
    let region = Region { contour: flat(&section.contour), holes: section.holes.iter().map(flat).collect() };
    let curves =
        |outline: &Outline| outline.edges.iter().all(|OutlineEdge { curve, .. }| curve.envelope().size() > 0.0);
    section.loops().all(curves) && region.faults(1e-3 * size).is_empty()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 10_000, max_global_rejects: 200_000, ..ProptestConfig::default() })]

    #[test]
    fn every_cloud_of_a_random_region_passes_its_check(
        draft in draft(),
        nodes in prop::array::uniform2(3usize..24),
        irregularity in prop_oneof![2 => Just(0.0), 4 => 0.0..0.5f64, 1 => (1i32..16).prop_map(|k| 0.1f64.powi(k))],
        seed in any::<u64>(),
        clearance in prop::sample::select(ClearanceUnit::ALL.to_vec()),
        division in prop::sample::select(Division::ALL.to_vec()),
        clearances in prop_oneof![3 => Just([1.0 / 3.0, 0.5]), 1 => prop::array::uniform2(0.0..1.2f64), 1 => Just([0.0, 0.0])],
    ) {
        let section = draft.section();
        prop_assume!(is_sound(&section));
        let [edge_clearance, node_clearance] = clearances;
        let hole_nodes = vec![];
        let params = CloudParams {
            grading: None,
            nodes, irregularity, seed, clearance, division, edge_clearance, node_clearance, hole_nodes,
            edge_nodes: Vec::new(),
        };
        match generate(&section, &params) {
            Ok(cloud) => {
                prop_assert_eq!(cloud.check(), Ok(()));
                let census = cloud.census();
                let deleted = census.outside + census.in_hole + census.near_edge + census.near_node;
                prop_assert_eq!(census.grid, deleted + cloud.n_interior());
                prop_assert_eq!(cloud.sites().map(<[u32]>::len), Some(cloud.n_interior()));
                match randomise(&section, &cloud, irregularity, seed ^ 1) {
                    Ok(moved) => prop_assert_eq!(moved.check(), Ok(())),
                    Err(error) => prop_assert!(is_expected(&error), "{}", error),
                }
            }
            Err(error) => prop_assert!(is_expected(&error), "{}", error),
        }
    }
}

/// Coarse clouds may have no room for a node, or too few of them for the curves; nothing else goes wrong.
fn is_expected(error: &CloudError) -> bool {
    matches!(error, CloudError::NoInterior { .. } | CloudError::BoundaryCrosses { .. } | CloudError::Boundary(_))
}
