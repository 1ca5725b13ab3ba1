//! The same section elsewhere, in another unit, with another load, twice.

use crate::sections::{ellipse, holed_l, mesh, params, solved};
use nmt_cloud::Section;
use nmt_curve::{Curve, Outline};
use nmt_geom::{NodeId, Point};
use nmt_mfdm::{Formulation, Load, SolveParams, TorsionProblem, TorsionSolution, exact, solve};
use nmt_tri::TriangleIndex;

const PLACE: Point = [0.0, 0.0];

#[test]
fn j_scales_with_the_fourth_power_of_the_unit_and_nothing_else_changes() {
    for formulation in Formulation::MESHLESS {
        for irregularity in [0.0, 0.3] {
            let build = |unit: f64| mesh(&holed_l(unit, PLACE), &params([46, 31], irregularity, 3));
            let one = build(1.0);
            let solution = solved(&one, formulation);
            for unit in [1e-3, 1e3, 1e6, 0.3048] {
                let other = build(unit);
                let scaled = solved(&other, formulation);
                assert_eq!(one.tri_nodes(), other.tri_nodes());
                let relative = |a: f64, b: f64| (a / b - 1.0).abs();
                // The promise is 1e-9; rounding times the condition of the system is 1e-13.
                assert!(relative(scaled.j, solution.j * unit.powi(4)) < 1e-9);
                assert!(relative(scaled.tau_max.value, solution.tau_max.value * unit) < 1e-9);
                assert!(relative(scaled.f_max.value, solution.f_max.value * unit * unit) < 1e-9);
                assert_eq!(scaled.tau_max.node, solution.tau_max.node);
                assert_eq!((scaled.stars.enlarged, scaled.unknowns), (solution.stars.enlarged, solution.unknowns));
            }
        }
    }
}

#[test]
fn moving_the_section_moves_no_result() {
    for formulation in Formulation::MESHLESS {
        let at = |shift: Point| solved(&mesh(&holed_l(1.0, shift), &params([46, 31], 0.3, 3)), formulation);
        let home = at(PLACE);
        for shift in [[0.3, 0.7], [10.0, -20.0], [1000.0, 1000.0]] {
            let moved = at(shift);
            // Coordinates of 1000 are rounded to 1e-13, of a spacing of 0.07: derivatives lose a few digits more.
            assert!((moved.j / home.j - 1.0).abs() < 1e-10, "{shift:?}");
            assert_eq!(moved.tau_max.node, home.tau_max.node);
        }
    }
}

#[test]
fn turning_the_section_moves_j_by_no_more_than_the_discretisation() {
    let j = exact::rectangle(1.0, 1.0).j;
    for angle in [0.1, 0.3, 0.5, std::f64::consts::FRAC_PI_4] {
        let (s, c) = f64::sin_cos(angle);
        let turned = |p: Point| [3.0 + c * p[0] - s * p[1], -7.0 + s * p[0] + c * p[1]];
        let section = Section::solid(Outline::polygon([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(turned)));
        let n = (40.0 * (s + c)).round() as usize + 1; // the envelope grows: the spacing stays
        for formulation in Formulation::MESHLESS {
            for irregularity in [0.0, 0.25] {
                let error = solved(&mesh(&section, &params([n, n], irregularity, 1)), formulation).j / j - 1.0;
                // The square itself is promised within 2e-4 at this spacing; 1.2e-4 measured, at 45 degrees.
                assert!(error.abs() < 2e-4, "{angle} {} {irregularity}: {error:e}", formulation.name());
            }
        }
    }
}

#[test]
fn a_turned_ellipse_is_still_met_to_rounding() {
    let case = ellipse();
    let mut section = case.section.clone();
    section.contour.edges[0].curve = Curve::Ellipse { centre: PLACE, semi_axes: [2.0, 1.0], rotation: 0.6 };
    section.contour.vertices = vec![section.contour.edges[0].curve.point(0.0)];
    for formulation in Formulation::MESHLESS {
        let solution = solved(&mesh(&section, &params([41, 33], 0.3, 2)), formulation);
        let f_max = exact::ellipse(2.0, 1.0).f_max;
        assert!((solution.f_max.value / f_max - 1.0).abs() < 1e-12); // quadratic: rounding
        assert!(solution.f_max.at[0].hypot(solution.f_max.at[1]) < 1e-9); // the Newton step is exact
    }
}

fn with(problem: TorsionProblem) -> TorsionSolution {
    let mesh = mesh(&holed_l(1.0, PLACE), &params([31, 21], 0.2, 1));
    solve(&problem, &mesh, &SolveParams::default()).expect("a sound problem")
}

#[test]
fn a_torque_gives_the_twist_that_gives_the_torque() {
    let unit = with(TorsionProblem::default());
    let loaded = with(TorsionProblem { shear_modulus: 80e9, load: Load::Torque(1.5e6), ..TorsionProblem::default() });
    let same = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-14; // a product or two
    assert!(same(loaded.j, unit.j) && same(loaded.torque, 1.5e6));
    assert!(same(loaded.twist, 1.5e6 / (80e9 * unit.j)));
    assert!(same(loaded.g_theta, loaded.twist * 80e9));
    assert!(same(loaded.tau_max.value, unit.tau_max.value * loaded.g_theta));
    assert!(same(loaded.w_t, unit.w_t));
}

#[test]
fn the_shear_modulus_and_the_twist_scale_stresses_but_not_j() {
    let unit = with(TorsionProblem::default());
    for (shear_modulus, twist) in [(3.0, 1.0), (1.0, -0.5), (2.0, 0.25)] {
        let g_theta = shear_modulus * twist;
        let scaled = with(TorsionProblem { shear_modulus, load: Load::Twist(twist), ..TorsionProblem::default() });
        let same = |a: f64, b: f64| (a - b).abs() <= 1e-14 * b.abs(); // one product
        assert!(scaled.f.iter().zip(&unit.f).all(|(a, b)| same(*a, b * g_theta)));
        assert!(same(scaled.j, unit.j) && same(scaled.torque, unit.j * g_theta));
        assert!(same(scaled.tau_max.value, unit.tau_max.value * g_theta.abs()));
        assert!(same(scaled.f_max.value, unit.f_max.value * g_theta));
        assert!(scaled.holes.iter().zip(&unit.holes).all(|(a, b)| same(a.f, b.f * g_theta)));
        assert_eq!((scaled.tau_max.node, scaled.f_max.node), (unit.tau_max.node, unit.f_max.node));
    }
}

#[test]
fn two_runs_agree_to_the_bit() {
    for formulation in Formulation::MESHLESS {
        let run = || solved(&mesh(&holed_l(1.0, PLACE), &params([46, 31], 0.3, 3)), formulation);
        assert_eq!(run(), run());
    }
}

#[test]
fn the_field_meets_the_nodal_values_and_vanishes_nowhere_inside() {
    let mesh = mesh(&holed_l(1.0, PLACE), &params([46, 31], 0.3, 3));
    let solution = solved(&mesh, Formulation::Variational);
    let index = TriangleIndex::new(&mesh);
    for (node, &p) in mesh.xy().iter().enumerate() {
        let field = solution.at(&mesh, &index, p, 1e-9).expect("a node is in some triangle");
        // Barycentric coordinates of a node are 0 and 1 but for rounding.
        assert!((field.value - solution.f[node]).abs() < 1e-12 * solution.f_max.value);
        assert_eq!(solution.field.at_node(NodeId::of(node)).value, solution.f[node]);
        // −∇²F > 0: the least F is on the outer boundary.
        assert!(node < mesh.cloud().n_boundary() || solution.f[node] > 0.0);
    }
}
