//! Holes: the circulation about each, the constant on each, and the paper's zero condition.

use crate::sections::{holed_l, mesh, params, ring, solved};
use nmt_cloud::Section;
use nmt_curve::Outline;
use nmt_geom::{LoopId, Point};
use nmt_mfdm::{Formulation, HoleCondition, SolveParams, TorsionProblem, TorsionSolution, solve};
use nmt_tri::{Mesh, TriangleIndex};
use std::f64::consts::{PI, TAU};

/// −∮ ∂F/∂r ds along a circle, over 2·(its area): 1 where the circulation about the hole within is 2GθA and ∇²F = −2Gθ
/// between the two.
fn circulation(mesh: &Mesh, solution: &TorsionSolution, centre: Point, radius: f64) -> f64 {
    let index = TriangleIndex::new(mesh);
    let n = 2000;
    let outflow = |k: i32| {
        let (s, c) = (TAU * f64::from(k) / f64::from(n)).sin_cos();
        let at = [centre[0] + radius * c, centre[1] + radius * s];
        let field = solution.at(mesh, &index, at, 0.0).expect("the circle lies in the material");
        -(field.gradient[0] * c + field.gradient[1] * s)
    };
    let mean = (0..n).map(outflow).sum::<f64>() / f64::from(n);
    TAU * radius * mean / (2.0 * PI * radius * radius)
}

#[test]
fn the_circulation_about_every_hole_is_twice_the_area_it_encloses() {
    let plate =
        Section { contour: Outline::rectangle([0.0, 0.0], [2.0, 2.0]), holes: vec![Outline::circle([1.0, 1.0], 0.5)] };
    for formulation in Formulation::MESHLESS {
        for irregularity in [0.0, 0.25] {
            let mesh_of = |section: &Section, nodes| mesh(section, &params(nodes, irregularity, 2));
            let what = format!("{} {irregularity}", formulation.name());
            let plate = mesh_of(&plate, [41, 41]);
            let found = circulation(&plate, &solved(&plate, formulation), [1.0, 1.0], 0.75);
            println!("{what}: plate {:.1e}", found - 1.0);
            // The error of the recovered field's gradient is h³; 3e-5 measured.
            assert!((found - 1.0).abs() < 1e-4, "{what}: {found}");
            let l = mesh_of(&holed_l(1.0, [0.0, 0.0]), [61, 41]);
            let solution = solved(&l, formulation);
            // Near re-entrant corners τ is infinite and the order lost: 5e-4 measured (local, irregular) about the round
            // hole; the circle about the square one passes its corners at 0.1.
            for (centre, radius, limit) in [([0.5, 1.3], 0.35, 1.5e-3), ([1.75, 0.5], 0.42, 5e-3)] {
                let found = circulation(&l, &solution, centre, radius);
                println!("{what}: L {centre:?} {:.1e}", found - 1.0);
                assert!((found - 1.0).abs() < limit, "{what} about {centre:?}: {found}");
            }
        }
    }
}

#[test]
fn every_hole_has_one_constant_that_all_its_nodes_share() {
    let mesh = mesh(&holed_l(1.0, [0.0, 0.0]), &params([46, 31], 0.2, 1));
    let boundary = mesh.cloud().boundary();
    for formulation in Formulation::MESHLESS {
        let solution = solved(&mesh, formulation);
        assert_eq!(solution.unknowns, mesh.cloud().n_interior() + 2);
        for (k, hole) in solution.holes.iter().enumerate() {
            let ring = LoopId::of(k + 1);
            assert_eq!(hole.condition, HoleCondition::Circulation);
            assert_eq!(hole.area, boundary.loop_area(ring));
            assert!(hole.f > 0.0);
            assert!(boundary.loop_segments(ring).iter().all(|s| solution.f[s.from.index()] == hole.f));
        }
        assert!(boundary.loop_segments(LoopId(0)).iter().all(|s| solution.f[s.from.index()] == 0.0));
    }
}

#[test]
fn the_constant_of_the_ring_is_that_of_the_full_circle() {
    let case = ring();
    for formulation in Formulation::MESHLESS {
        let solution = solved(&mesh(&case.section, &params([31, 31], 0.3, 4)), formulation);
        assert!((solution.holes[0].f - 0.375).abs() < 1e-12); // (1 − ¼)/2, quadratic: rounding
    }
}

#[test]
fn a_hole_with_the_zero_condition_has_f_0_and_the_volume_of_the_membrane_with_a_hole() {
    let case = ring();
    // F = (1 − r²)/2 + k·ln r with F(a) = 0, integrated by hand.
    let a = 0.5f64;
    let k = -(1.0 - a * a) / (2.0 * a.ln());
    let quarter = 1.0 / 8.0 - a * a / 4.0 + a.powi(4) / 8.0;
    let j = 4.0 * PI * (quarter + k * (-0.25 - a * a / 2.0 * a.ln() + a * a / 4.0));
    for formulation in Formulation::MESHLESS {
        for irregularity in [0.0, 0.25] {
            let mesh = mesh(&case.section, &params([61, 61], irregularity, 1));
            let problem = TorsionProblem { holes: HoleCondition::Zero, ..TorsionProblem::default() };
            let params = SolveParams { formulation, ..SolveParams::default() };
            let solution = solve(&problem, &mesh, &params).expect("a sound problem");
            assert_eq!((solution.holes[0].condition, solution.holes[0].f), (HoleCondition::Zero, 0.0));
            assert_eq!(solution.unknowns, mesh.cloud().n_interior());
            assert!(solution.f[..mesh.cloud().n_boundary()].iter().all(|f| *f == 0.0));
            let error = solution.j / j - 1.0;
            println!("{} {irregularity}: {error:.1e}", formulation.name());
            // The gap is 15 spacings wide, and the polygons of both circles are short of area by 1e-4 of it.
            assert!(error.abs() < 3e-4, "{} {irregularity}: {error:e}", formulation.name());
            assert!(solution.j < 0.2 * case.j, "the paper's condition is not the torsion constant");
        }
    }
}
