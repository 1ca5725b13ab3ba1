//! Stars and stencils on whole clouds: who is in them, and what their rows reproduce.

use crate::sections::{holed_l, keyway, mesh, params, semicircle};
use nmt_cloud::{Cloud, Section};
use nmt_curve::Outline;
use nmt_geom::point::distance;
use nmt_geom::{NodeId, Point, segment};
use nmt_mfdm::{
    Formulation, NodeStar, SolveParams, StarChoice, StarFinder, StarParams, Stencils, Surroundings, TorsionProblem,
    n_monomials, row, solve,
};
use nmt_tri::Mesh;
use proptest::prelude::*;

/// A plate 4 × 2 with a slot from above, `width` wide at its bottom and twice that at its mouth.
fn slotted(width: f64) -> Section {
    Section::solid(Outline::polygon([
        [0.0, 0.0],
        [4.0, 0.0],
        [4.0, 2.0],
        [1.7 + width, 2.0],
        [1.7 + width / 2.0, 0.6],
        [1.7 - width / 2.0, 0.6],
        [1.7 - width, 2.0],
        [0.0, 2.0],
    ]))
}

/// The stars of `size` of all nodes.
fn stars(cloud: &Cloud, size: usize) -> Vec<Vec<NodeId>> {
    let surroundings = Surroundings::new(cloud);
    let nearest = surroundings.nearest();
    let mut finder = StarFinder::new(&surroundings, &nearest, StarChoice::Nearest);
    let mut star = Vec::new();
    (0..cloud.n_nodes())
        .map(|node| {
            finder.find(NodeId::of(node), size, &mut star);
            star.clone()
        })
        .collect()
}

#[test]
fn the_star_of_an_interior_node_never_reaches_across_a_slit() {
    for width in [1e-6, 1e-3, 0.04, 0.3] {
        for irregularity in [0.0, 0.3] {
            let mesh = mesh(&slotted(width), &params([41, 21], irregularity, 1));
            let xy = mesh.xy();
            // Beside the slit, above its bottom; nodes of its walls are on their own side.
            let beside = |n: usize| xy[n][1] > 0.6 + 1e-9;
            let stars = stars(mesh.cloud(), 20);
            let mut seen = 0;
            for node in (mesh.cloud().n_boundary()..xy.len()).filter(|n| beside(*n)) {
                let on_left = xy[node][0] < 1.7;
                for other in stars[node].iter().map(|o| o.index()).filter(|o| beside(*o)) {
                    assert_eq!(xy[other][0] < 1.7, on_left, "width {width}: {:?} sees {:?}", xy[node], xy[other]);
                    seen += 1;
                }
            }
            assert!(seen > 1000, "the plate has nodes beside its slit");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn no_member_of_a_star_is_behind_a_wall(
        which in 0usize..4, irregularity in prop_oneof![Just(0.0), 0.01..0.45f64], seed in any::<u64>(), size in 6usize..24,
    ) {
        let section = match which {
            0 => holed_l(1.0, [0.0, 0.0]),
            1 => slotted(0.2),
            2 => keyway().section,
            _ => semicircle(),
        };
        let mesh = mesh(&section, &params([31, 21], irregularity, seed));
        let cloud = mesh.cloud();
        let margin = 1e-9 * cloud.size(); // what visibility promises
        for (node, star) in stars(cloud, size).iter().enumerate() {
            prop_assert!(star.contains(&NodeId::of(node)), "the centre belongs");
            prop_assert!(star.windows(2).all(|pair| pair[0] < pair[1]), "ascending, none twice");
            prop_assert_eq!(star.len(), size);
            let p = cloud.xy()[node];
            for other in star {
                let q = cloud.xy()[other.index()];
                let crossed = cloud.boundary().all_ends().any(|[a, b]| segment::cross_properly(p, q, a, b, margin));
                prop_assert!(!crossed, "{:?} and {:?}", p, q);
            }
        }
    }

    #[test]
    fn stars_far_from_the_boundary_are_the_nearest_nodes(seed in any::<u64>(), size in 6usize..20) {
        let mesh = mesh(&holed_l(1.0, [0.0, 0.0]), &params([46, 31], 0.3, seed));
        let (xy, stars) = (mesh.xy(), stars(mesh.cloud(), size));
        let far = |p: Point| mesh.cloud().boundary().all_ends().all(|[a, b]| segment::distance_to(p, a, b) > 0.2);
        for node in (0..xy.len()).filter(|n| far(xy[*n])) {
            let farthest = stars[node].iter().map(|o| distance(xy[o.index()], xy[node])).fold(0.0, f64::max);
            let nearer = (0..xy.len()).filter(|o| distance(xy[*o], xy[node]) < farthest * (1.0 - 1e-9)).count();
            prop_assert!(nearer < size, "{} nodes are nearer than the farthest of {}", nearer, size);
        }
    }
}

/// A polynomial of `order` about the origin with coefficients that differ, and its derivatives.
struct Polynomial {
    order: usize,
}

impl Polynomial {
    fn coefficient(a: usize, b: usize) -> f64 {
        1.0 + 0.37 * a as f64 - 0.61 * b as f64
    }

    /// ∂^(i+j)/∂x^i∂y^j at a point.
    fn derivative(&self, [x, y]: Point, i: usize, j: usize) -> f64 {
        let falling = |n: usize, k: usize| (n + 1 - k..=n).product::<usize>() as f64;
        let mut sum = 0.0;
        for a in i..=self.order {
            for b in j..=self.order.saturating_sub(a) {
                let factor = falling(a, i) * falling(b, j) * Self::coefficient(a, b);
                sum += factor * x.powi((a - i) as i32) * y.powi((b - j) as i32);
            }
        }
        sum
    }
}

fn assert_reproduces(mesh: &Mesh, params: StarParams) {
    let cloud = mesh.cloud();
    let surroundings = Surroundings::new(cloud);
    let stencils = Stencils::new(&surroundings, &surroundings.nearest(), params, 0..cloud.n_nodes());
    let report = stencils.report();
    assert_eq!(report.order_lowered, 0);
    let polynomial = Polynomial { order: params.order };
    let values: Vec<f64> = cloud.xy().iter().map(|p| polynomial.derivative(*p, 0, 0)).collect();
    let largest = values.iter().fold(0.0f64, |l, v| l.max(v.abs()));
    for node in 0..cloud.n_nodes() {
        let stencil = stencils.of(NodeId::of(node));
        assert!(stencil.nodes.len() >= n_monomials(params.order));
        for i in 0..=params.order {
            for j in 0..=params.order - i {
                if i + j == 0 {
                    continue;
                }
                let coefficients = stencil.row(row(i, j));
                let found: f64 = coefficients.iter().zip(stencil.nodes).map(|(c, n)| c * values[n.index()]).sum();
                let [s_x, s_y] = stencils.metric().stretch().map(|stretch| stencil.radius / stretch);
                let scale = s_x.powi(i as i32) * s_y.powi(j as i32);
                let exact = polynomial.derivative(cloud.xy()[node], i, j) * scale;
                // Rounding of the values times the condition of the star.
                let tolerance = 1e-14 * report.worst_condition * largest;
                assert!((found - exact).abs() < tolerance, "node {node}, derivative {i} {j}: {found} {exact}");
                // Constants vanish, to the rounding of the terms.
                let terms: f64 = coefficients.iter().map(|c| c.abs()).sum();
                assert!(coefficients.iter().sum::<f64>().abs() < 1e-14 * terms);
            }
        }
    }
}

#[test]
fn rows_reproduce_quadratics_and_cubics_on_irregular_clouds_with_holes() {
    for section in [holed_l(1.0, [0.0, 0.0]), slotted(0.3), keyway().section] {
        for (irregularity, seed) in [(0.0, 0), (0.25, 1), (0.45, 2)] {
            let mesh = mesh(&section, &params([46, 31], irregularity, seed));
            assert_reproduces(&mesh, StarParams::nearest(2, 9));
            assert_reproduces(&mesh, StarParams::nearest(3, 20));
        }
    }
}

#[test]
fn a_section_has_the_same_stars_in_every_unit() {
    for irregularity in [0.0, 0.3] {
        let stars_in = |unit: f64| {
            let mesh = mesh(&holed_l(unit, [0.0, 0.0]), &params([46, 31], irregularity, 1));
            stars(mesh.cloud(), 9)
        };
        let one = stars_in(1.0);
        for unit in [1e-3, 1e3, 1e6, 0.3048] {
            assert_eq!(stars_in(unit), one);
        }
    }
}
#[test]
fn the_star_of_a_wall_node_never_reaches_the_other_wall_of_a_slit() {
    for width in [1e-6, 1e-3, 0.04, 0.3] {
        for irregularity in [0.0, 0.3] {
            let mesh = mesh(&slotted(width), &params([41, 21], irregularity, 1));
            let xy = mesh.xy();
            let spacing = mesh.cloud().max_spacing();
            // Two spacings above the slit's bottom, around which the walls see each other along a short way.
            let beside = |n: usize| xy[n][1] > 0.6 + 2.0 * spacing;
            for (node, star) in stars(mesh.cloud(), 9).iter().enumerate().filter(|(n, _)| beside(*n)) {
                for other in star.iter().map(|o| o.index()).filter(|o| beside(*o)) {
                    assert_eq!(
                        xy[other][0] < 1.7,
                        xy[node][0] < 1.7,
                        "width {width}: {:?} sees {:?}",
                        xy[node],
                        xy[other]
                    );
                }
            }
        }
    }
}

#[test]
fn no_laplacian_row_keeps_a_wrong_sign_on_the_most_irregular_clouds() {
    // Of such a cloud a million nodes have 380 that larger stars, from all sides, do not mend; flatter weights do.
    let section = Section::solid(Outline::rectangle([0.0, 0.0], [1.0, 1.0]));
    let mesh = mesh(&section, &params([201, 201], 0.49, 1));
    let surroundings = Surroundings::new(mesh.cloud());
    let nearest = surroundings.nearest();
    let range = mesh.cloud().n_boundary()..mesh.cloud().n_nodes();
    for choice in [StarChoice::Nearest, StarChoice::Balanced] {
        let params = StarParams { choice, ..StarParams::nearest(2, 9) };
        let report = Stencils::new(&surroundings, &nearest, params, range.clone()).report();
        assert_eq!(report.wrong_sign, 0, "{choice:?}");
        assert!(report.enlarged > 20, "{choice:?}: {}", report.enlarged);
    }
}

#[test]
fn one_star_opened_up_is_the_one_that_the_equations_use() {
    let mesh = mesh(&holed_l(1.0, [0.0, 0.0]), &params([31, 21], 0.25, 3));
    for params in
        [SolveParams::default(), SolveParams { order: 3, stars: Some(StarChoice::Balanced), ..SolveParams::default() }]
    {
        let solution = solve(&TorsionProblem::default(), &mesh, &params).expect("a sound problem");
        let mut hidden = 0;
        for (node, used) in solution.used_stars.diagnostics(&mesh).iter().enumerate() {
            let star = NodeStar::of(mesh.cloud(), &params, NodeId::of(node)).expect("sound parameters");
            let star = star.expect("meshless formulations have stars");
            let size = (star.members.len(), star.outcome.order, star.radius, star.outcome.condition);
            assert_eq!(size, (used.size as usize, used.order as usize, used.radius, used.condition), "{node}");
            assert_eq!((star.hidden.len(), star.diagonal()), (used.hidden as usize, used.diagonal), "{node}");
            hidden += star.hidden.len();
            // A constant has no second derivative: rounding of the largest coefficient.
            let row: Vec<f64> = star.members.iter().filter_map(|member| member.laplacian).collect();
            let largest = row.iter().fold(0.0f64, |most, v| most.max(v.abs()));
            assert!(row.iter().sum::<f64>().abs() < 1e-10 * largest, "{node}");
        }
        assert!(hidden > 0);
    }
}

#[test]
fn a_star_that_was_mended_is_opened_up_as_the_solution_has_it() {
    let mesh = mesh(&holed_l(1.0, [0.0, 0.0]), &params([61, 41], 0.45, 3));
    let params = SolveParams::default();
    let problem = TorsionProblem::default();
    let solution = solve(&problem, &mesh, &params).expect("a sound problem");
    let chosen = |node: usize| {
        let star = NodeStar::of(mesh.cloud(), &params, NodeId::of(node)).expect("sound parameters");
        star.expect("meshless formulations have stars").members.len()
    };
    let all_used = solution.used_stars.diagnostics(&mesh);
    let is_mended = |node: &usize| all_used[*node].size as usize > chosen(*node);
    let mended: Vec<usize> = (0..mesh.cloud().n_nodes()).filter(is_mended).collect();
    assert!(mended.len() > 3, "{mended:?}");
    for node in [mended[0], mended[mended.len() - 1], 0] {
        let star = NodeStar::in_torsion(&problem, &mesh, &params, NodeId::of(node)).expect("sound parameters");
        let star = star.expect("meshless formulations have stars");
        let used = &all_used[node];
        let found = (star.members.len(), star.outcome.order, star.radius, star.outcome.condition);
        assert_eq!(found, (used.size as usize, used.order as usize, used.radius, used.condition), "{node}");
        assert_eq!((star.asked, star.outcome.enlarged), (9, used.size > 9));
    }
}

#[test]
fn beside_a_hole_smaller_than_the_spacing_stars_come_from_all_sides_with_flatter_weights() {
    let holed = |radius: f64| Section {
        contour: Outline::rectangle([0.0, 0.0], [2.0, 1.0]),
        holes: vec![Outline::circle([0.98, 0.52], radius)],
    };
    // The spacing is 0.05: in the second hole a star would fit.
    for (radius, is_clump) in [(0.01, true), (0.08, false)] {
        let mesh = mesh(&holed(radius), &params([41, 21], 0.2, 3));
        let cloud = mesh.cloud();
        let segments = cloud.boundary().loop_segments(nmt_geom::LoopId::of(1));
        let on_hole: Vec<usize> = segments.iter().map(|segment| segment.from.index()).collect();
        for (formulation, evening) in [(Formulation::Variational, 0.1), (Formulation::Local, 0.5)] {
            let params = SolveParams { formulation, ..SolveParams::default() };
            let star = |node: usize| {
                let star = NodeStar::of(cloud, &params, NodeId::of(node)).expect("sound parameters");
                star.expect("meshless formulations have stars")
            };
            let near = |node: &usize| distance(cloud.xy()[*node], [0.98, 0.52]) < radius + 0.04;
            for node in (cloud.n_boundary()..cloud.n_nodes()).filter(near).chain(on_hole.iter().copied()) {
                let star = star(node);
                let n_on_hole = star.members.iter().filter(|member| on_hole.contains(&member.node.index())).count();
                let g = star.outcome.flattening;
                // From all sides there may be one node of those that made the clump.
                let is_right = if g >= evening { is_clump && n_on_hole >= 1 } else { !is_clump || n_on_hole < 2 };
                assert!(is_right, "{radius} {node} {formulation:?}: {n_on_hole} {g}");
                // The weights shown are those used.
                for member in &star.members[1..] {
                    let (rho2, g2) = ((member.distance / star.radius).powi(2), g * g);
                    let weight = (rho2 + if g > 0.0 { g2 * g2 / (rho2 + g2) } else { 0.0 }).powi(-3);
                    assert!((member.weight / weight - 1.0).abs() < 1e-12, "{radius} {node}"); // rounding
                }
                assert!(star.members[0].weight.is_infinite());
            }
        }
    }
}
