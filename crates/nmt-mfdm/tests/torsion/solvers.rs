//! The iteration against the factorisation, on whole problems: the same numbers, and it tells what it did.

use nmt_cloud::{CloudParams, Section, generate};
use nmt_curve::Outline;
use nmt_mfdm::{
    Formulation, LinearSolve, Method, PoissonProblem, SolveParams, Solver, Test, TorsionProblem, Trial, solve,
    solve_poisson,
};
use nmt_tri::Mesh;

/// A plate with a round and a square hole.
fn two_holes() -> Section {
    Section {
        contour: Outline::rectangle([0.0, 0.0], [2.0, 1.0]),
        holes: vec![Outline::circle([0.5, 0.5], 0.25), Outline::rectangle([1.2, 0.3], [1.7, 0.7])],
    }
}

fn irregular(section: &Section, nodes: [usize; 2]) -> Mesh {
    let params = CloudParams { nodes, irregularity: 0.4, ..CloudParams::default() };
    Mesh::constrained(generate(section, &params).expect("a cloud")).expect("a mesh")
}

/// Largest difference over the largest value.
fn difference(x: &[f64], y: &[f64]) -> f64 {
    let scale = y.iter().fold(0.0, |s: f64, v| s.max(v.abs()));
    x.iter().zip(y).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max) / scale
}

fn assert_iterated(how: &LinearSolve, method: Method, what: &str) {
    assert_eq!((how.method, how.fell_back), (method, false), "{what}: {how:?}");
    let iteration = how.iteration.expect("an iteration");
    assert!(how.residual <= 1e-10 && iteration.iterations < 40 && iteration.levels > 1, "{what}: {how:?}");
}

#[test]
fn iteration_and_factorisation_agree_on_torsion_with_two_holes() {
    let mesh = irregular(&two_holes(), [81, 41]);
    let base = SolveParams::default();
    let cases = [
        ("variational 2", base),
        ("variational 4", SolveParams { order: 4, ..base }),
        ("variational mwls", SolveParams { trial: Trial::Mwls, ..base }),
        ("local 2", SolveParams { formulation: Formulation::Local, ..base }),
        ("local 4", SolveParams { formulation: Formulation::Local, order: 4, ..base }),
        ("fem", SolveParams { formulation: Formulation::Fem, ..base }),
        ("galerkin", SolveParams { test: Test::Trial, ..base }),
    ];
    for (what, params) in cases {
        let by = |solver| solve(&TorsionProblem::default(), &mesh, &SolveParams { solver, ..params }).expect(what);
        let (direct, iterated) = (by(Solver::Direct), by(Solver::Iterative));
        println!("{what}: {:?}, {:.1e}", iterated.linear, difference(&iterated.f, &direct.f));
        // With the equations of the holes no system is symmetric.
        assert_iterated(&iterated.linear, Method::Bicgstab, what);
        assert!(difference(&iterated.f, &direct.f) < 1e-9, "{what}"); // of residuals of 1e-10
        assert!((iterated.j / direct.j - 1.0).abs() < 1e-9, "{what}");
    }
}

#[test]
fn iteration_and_factorisation_agree_on_a_problem_with_fluxes() {
    let section = two_holes();
    let mesh = irregular(&section, [81, 41]);
    let (source, boundary) = (|p: [f64; 2]| 1.0 + p[0], |p: [f64; 2]| p[1]);
    let flux = |_: [f64; 2]| 0.5;
    // Values on the left edge alone.
    let flux = &flux as &(dyn Fn([f64; 2]) -> f64 + Sync);
    let fluxes = (0..9).map(|edge| (edge != 3).then_some(flux)).collect();
    let problem = PoissonProblem { source: &source, boundary: &boundary, fluxes, section: &section };
    for formulation in Formulation::ALL {
        let by = |solver| {
            let params = SolveParams { formulation, solver, ..SolveParams::default() };
            solve_poisson(&problem, &mesh, &params).expect("a solution")
        };
        let (direct, iterated) = (by(Solver::Direct), by(Solver::Iterative));
        println!("{}: {:?}, {:.1e}", formulation.name(), iterated.linear, difference(&iterated.u, &direct.u));
        let method = if formulation == Formulation::Fem { Method::Cg } else { Method::Bicgstab };
        assert_iterated(&iterated.linear, method, formulation.name());
        assert!(difference(&iterated.u, &direct.u) < 1e-8); // of residuals of 1e-10; 2.7e-9 measured, local
    }
}

#[test]
fn iterations_hardly_grow_with_the_cloud() {
    let square = Section::solid(Outline::rectangle([0.0, 0.0], [1.0, 1.0]));
    for formulation in Formulation::ALL {
        let iterations = |n: usize| {
            let params = SolveParams { formulation, solver: Solver::Iterative, ..SolveParams::default() };
            let solution = solve(&TorsionProblem::default(), &irregular(&square, [n, n]), &params).expect("a solution");
            solution.linear.iteration.expect("an iteration").iterations
        };
        let counts = [51, 301].map(iterations);
        println!("{}: {counts:?}", formulation.name());
        assert!(counts[1] <= 2 * counts[0], "{counts:?}"); // 9, 14; 10, 11; 16, 18
    }
}
