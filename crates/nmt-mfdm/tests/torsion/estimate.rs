//! Error estimates against exact results: they cover the error, and not by much.

use nmt_cloud::{CloudParams, Grading, Section, generate};
use nmt_curve::{Curve, Expression, Outline, OutlineEdge};
use nmt_mfdm::{
    ErrorEstimate, Formulation, HoleCondition, Load, SolveParams, Solver, TorsionProblem, TorsionSolution, estimate,
    exact, hidden_bends, solve,
};
use nmt_tri::Mesh;
use std::error::Error;
use std::f64::consts::PI;

/// A section whose J, and τ_max where it is finite, are known.
struct Known {
    name: &'static str,
    section: Section,
    j: f64,
    tau_max: Option<f64>,
    grading: Option<Grading>,
}

fn known() -> Vec<Known> {
    let (square, ring, ellipse) = (exact::rectangle(1.0, 1.0), exact::ring(0.5, 1.0), exact::ellipse(1.0, 0.5));
    let l = Outline::polygon(vec![[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]]);
    let triangle = Outline::polygon(vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]);
    let holed = Section {
        contour: Outline::rectangle([-1.0, -1.0], [1.0, 1.0]),
        holes: vec![Outline::circle([0.0, 0.0], 0.5)],
    };
    let tube = Section { contour: Outline::circle([0.0, 0.0], 1.0), holes: vec![Outline::circle([0.0, 0.0], 0.5)] };
    let smooth = |name, section, j, tau_max| Known { name, section, j, tau_max: Some(tau_max), grading: None };
    // J of the L, the triangle and the square with a hole: hp-FEM and rational least squares, agreeing to 1e-9.
    let l_j = 0.856_303_210_746;
    vec![
        smooth("square", Section::solid(Outline::rectangle([0.0, 0.0], [1.0, 1.0])), square.j, square.tau_max),
        smooth("ellipse", Section::solid(Outline::ellipse([0.0, 0.0], [1.0, 0.5], 0.3)), ellipse.j, ellipse.tau_max),
        smooth("triangle", Section::solid(triangle), 0.026_089_651_711_5, 0.459_174_661_204),
        smooth("square with hole", holed, 2.150_239_545_678, 1.353_393_153_296),
        smooth("tube", tube, ring.j, ring.tau_max),
        Known { name: "L", section: Section::solid(l.clone()), j: l_j, tau_max: None, grading: None },
        Known {
            name: "L, graded",
            section: Section::solid(l),
            j: l_j,
            tau_max: None,
            grading: Some(Grading::default().near([1.0, 1.0], 1e-5, 0.2)),
        },
    ]
}

struct Case {
    solution: TorsionSolution,
    estimate: ErrorEstimate,
}

fn case(
    known: &Known,
    params: &SolveParams,
    nodes: usize,
    irregularity: f64,
    seed: u64,
) -> Result<Case, Box<dyn Error>> {
    let grading = known.grading.clone();
    let cloud = CloudParams { nodes: [nodes, nodes], irregularity, seed, grading, ..CloudParams::default() };
    let mesh = Mesh::constrained(generate(&known.section, &cloud)?)?;
    let problem = TorsionProblem::default();
    let solution = solve(&problem, &mesh, params)?;
    let estimate = estimate(&problem, &mesh, &known.section, params, &solution)?;
    Ok(Case { solution, estimate })
}

#[test]
fn estimates_cover_the_errors_and_not_by_much() -> Result<(), Box<dyn Error>> {
    let variational = |order| SolveParams { order, ..SolveParams::default() };
    let local = |order| SolveParams { formulation: Formulation::Local, ..variational(order) };
    let fem = SolveParams { formulation: Formulation::Fem, ..SolveParams::default() };
    let (mut of_j, mut of_tau) = (Vec::new(), Vec::new());
    for known in known() {
        for params in [variational(1), variational(2), variational(4), local(2), local(4), fem] {
            for (irregularity, seed) in [(0.0, 1), (0.25, 1), (0.25, 2), (0.4, 3)] {
                let Case { solution, estimate } = case(&known, &params, 25, irregularity, seed)?;
                let label = format!(
                    "{}, {} {}, irregularity {irregularity}, seed {seed}",
                    known.name,
                    params.formulation.name(),
                    params.order
                );
                let error = (solution.j - known.j).abs();
                // 1 measured at least; the reference itself has twelve digits.
                assert!(error <= 1.5 * estimate.j + 1e-11 * known.j, "{label}: J {error:e} against {:e}", estimate.j);
                // Coarse singular corners: the product of the errors of v and σ on the boundary enters.
                let [low, high] = estimate.j_bounds;
                let slack = 0.1 * (high - low) + 1e-11 * known.j;
                assert!(low - slack < known.j && known.j < high + slack, "{label}: {low} … {high}");
                if error > 1e-11 * known.j {
                    of_j.push(estimate.j / error);
                }
                if let Some(tau_max) = known.tau_max {
                    let error = (solution.tau_max.value - tau_max).abs();
                    // 0.84 measured at least.
                    assert!(error <= 2.0 * estimate.tau_max + 1e-11, "{label}: τ {error:e}, {:e}", estimate.tau_max);
                    if error > 1e-11 {
                        of_tau.push(estimate.tau_max / error);
                    }
                }
            }
        }
    }
    for ratios in [&mut of_j, &mut of_tau] {
        ratios.sort_by(f64::total_cmp);
        assert!(ratios.len() > 60);
        assert!(ratios[ratios.len() / 2] < 5.0, "median {}", ratios[ratios.len() / 2]); // 1.2 and 2 measured
    }
    Ok(())
}

/// The middle of the bounds gains a digit and more on 2∫F.
#[test]
fn the_middle_of_the_bounds_is_nearer() -> Result<(), Box<dyn Error>> {
    let known = known();
    let graded = known.iter().find(|known| known.grading.is_some()).ok_or("a graded section")?;
    let Case { solution, estimate } = case(graded, &SolveParams::default(), 41, 0.0, 1)?;
    let [low, high] = estimate.j_bounds;
    let (middle, found) = ((0.5 * (low + high) - graded.j).abs(), (solution.j - graded.j).abs());
    assert!(middle < 0.1 * found, "{middle:e} against {found:e}"); // 1e-7 against 1.1e-5 of J measured
    Ok(())
}

/// Indicators sum to no less than the distance of the bounds, and are largest at a re-entrant corner.
#[test]
fn indicators_point_at_the_corner() -> Result<(), Box<dyn Error>> {
    let known = known();
    let l = known.iter().find(|known| known.name == "L").ok_or("the L")?;
    let cloud = CloudParams { nodes: [25, 25], ..CloudParams::default() };
    let mesh = Mesh::constrained(generate(&l.section, &cloud)?)?;
    let (problem, params) = (TorsionProblem::default(), SolveParams::default());
    let solution = solve(&problem, &mesh, &params)?;
    let estimate = estimate(&problem, &mesh, &l.section, &params, &solution)?;
    let [low, high] = estimate.j_bounds;
    assert!(estimate.indicators.len() == mesh.n_triangles());
    assert!((estimate.indicators.iter().sum::<f64>() / (high - low) - 1.0).abs() < 1e-12); // rounding
    let largest =
        mesh.triangles().max_by(|a, b| estimate.indicators[a.index()].total_cmp(&estimate.indicators[b.index()]));
    let corners = mesh.corners(largest.ok_or("a triangle")?);
    assert!(corners.iter().any(|p| (p[0] - 1.0).hypot(p[1] - 1.0) < 0.1), "{corners:?}");
    Ok(())
}

#[test]
fn estimates_follow_the_load() -> Result<(), Box<dyn Error>> {
    let section = Section::solid(Outline::rectangle([0.0, 0.0], [1.0, 1.0]));
    let cloud = CloudParams { nodes: [15, 15], irregularity: 0.2, ..CloudParams::default() };
    let mesh = Mesh::constrained(generate(&section, &cloud)?)?;
    let params = SolveParams::default();
    let of = |load| -> Result<(TorsionSolution, ErrorEstimate), Box<dyn Error>> {
        let problem = TorsionProblem { shear_modulus: 3.0, load, ..TorsionProblem::default() };
        let solution = solve(&problem, &mesh, &params)?;
        let estimate = estimate(&problem, &mesh, &section, &params, &solution)?;
        Ok((solution, estimate))
    };
    let (by_twist, of_twist) = of(Load::Twist(-2.0))?;
    let (by_torque, of_torque) = of(Load::Torque(5.0))?;
    let relative = of_twist.relative(by_twist.j);
    let close = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-9; // two solutions of one system
    assert!(close(of_torque.relative(by_torque.j), relative));
    assert!(close(of_twist.torque, relative * by_twist.torque.abs()) && of_twist.twist == 0.0);
    assert!(close(of_torque.twist, relative * by_torque.twist) && of_torque.torque == 0.0);
    // A given torque carries the error of the twist into τ.
    let [a, b] = [(&of_twist, &by_twist), (&of_torque, &by_torque)].map(|(e, s)| e.tau_max / s.tau_max.value);
    assert!(close(b, a + relative));
    Ok(())
}

/// F = 0 on holes too: what flows out of them is found from F, and the bounds hold as elsewhere.
#[test]
fn bounds_where_holes_have_no_circulation() -> Result<(), Box<dyn Error>> {
    let (a, b) = (0.5f64, 1.0f64);
    let tube = Section { contour: Outline::circle([0.0, 0.0], b), holes: vec![Outline::circle([0.0, 0.0], a)] };
    // F = (b² − r²)/2 + A·ln(r/b), 0 at both radii.
    let log = (b * b - a * a) / (2.0 * (b / a).ln());
    let by_log = a * a / 2.0 * (b / a).ln() - (b * b - a * a) / 4.0;
    let j = 4.0 * PI * ((b * b - a * a).powi(2) / 8.0 + log * by_log);
    // A slot, a hole that bends about a corner and a small round one: bounds from 68 042 and 29 044 graded nodes of orders 2
    // and 4, 7e-9 and 4e-8 apart, agree.
    let bent = vec![[1.2, 0.2], [1.8, 0.2], [1.8, 0.8], [1.6, 0.8], [1.6, 0.4], [1.2, 0.4]];
    let plate = Section {
        contour: Outline::rectangle([0.0, 0.0], [2.0, 1.0]),
        holes: vec![
            Outline::rectangle([0.15, 0.3], [0.25, 0.8]),
            Outline::polygon(bent),
            Outline::circle([0.7, 0.55], 0.1),
        ],
    };
    for (section, exact) in [(&tube, j), (&plate, 0.102_913_263)] {
        for formulation in [Formulation::Variational, Formulation::Local] {
            for (nodes, irregularity) in [(25, 0.0), (25, 0.3), (61, 0.3)] {
                let cloud = CloudParams { nodes: [nodes; 2], irregularity, seed: 2, ..CloudParams::default() };
                let mesh = Mesh::constrained(generate(section, &cloud)?)?;
                let problem = TorsionProblem { holes: HoleCondition::Zero, ..TorsionProblem::default() };
                let params = SolveParams { formulation, ..SolveParams::default() };
                let solution = solve(&problem, &mesh, &params)?;
                let ErrorEstimate { j, j_bounds: [low, high], .. } =
                    estimate(&problem, &mesh, section, &params, &solution)?;
                let error = (solution.j - exact).abs();
                let label = format!("{} {nodes} {irregularity}: {error:e}, {j:e}", formulation.name());
                // From 1.0 to 3.2 measured.
                assert!(error < j && j < 6.0 * error, "{label}");
                let slack = 0.1 * (high - low);
                assert!(low - slack < exact && exact < high + slack, "{label}, {low} … {high}");
            }
        }
    }
    Ok(())
}

/// The image of the unit disc under z = ζ + mζⁿ: n − 1 ripples, or with nm near 1 as many sharp notches.
struct Rippled {
    n: u32,
    m: f64,
}

impl Rippled {
    fn section(&self) -> Result<Section, Box<dyn Error>> {
        let Self { n, m } = self;
        let formula = |f: &str| Expression::parse(&format!("{f}(t) + {m}*{f}({n}*t)"), &["t"]);
        let (x, y) = (formula("cos")?, formula("sin")?);
        let curve = Curve::Parametric { x, y, from_t: 0.0, to_t: std::f64::consts::TAU };
        let edges = vec![OutlineEdge { name: "e1".into(), curve, nodes: None }];
        Ok(Section::solid(Outline { vertices: vec![[1.0 + m, 0.0]], edges }))
    }

    /// 2∫F over the disc, F = (H − |z|²)/2 with the harmonic H = 1 + m² + 2m·Re ζⁿ⁻¹ that is |z|² on the circle.
    fn j(&self) -> f64 {
        let (n, m2) = (f64::from(self.n), self.m * self.m);
        let plain = 0.5 * (1.0 + m2) - 0.25 - m2 / (2.0 * n + 2.0);
        let stretched = n * n * m2 * ((1.0 + m2) / (2.0 * n) - 1.0 / (2.0 * n + 2.0) - m2 / (4.0 * n));
        let mixed = 2.0 * n * m2 * (1.0 / (2.0 * n) - 1.0 / (2.0 * n + 2.0));
        std::f64::consts::TAU * (plain + stretched + mixed)
    }

    /// |∇F| at the ground of a notch.
    fn tau_max(&self) -> f64 {
        let (n, m) = (f64::from(self.n), self.m);
        (1.0 + n * m * m - 2.0 * m) / (1.0 - n * m)
    }
}

/// Nodes of a boundary may miss ripples altogether, or see others that are not there, and all fields then agree about a section
/// that is another one. Arc lengths tell.
#[test]
fn what_boundary_nodes_do_not_see_is_in_the_estimate() -> Result<(), Box<dyn Error>> {
    // (section, nodes across, whether all segments are smooth)
    let cases = [
        (Rippled { n: 61, m: 0.0015 }, 21, false),
        (Rippled { n: 61, m: 0.0015 }, 121, true),
        (Rippled { n: 31, m: 0.006 }, 11, false),
        (Rippled { n: 31, m: 0.02 }, 9, false),
        (Rippled { n: 31, m: 0.02 }, 5, false),
        (Rippled { n: 121, m: 0.002 }, 41, false),
        // Boundary nodes on crests alone: each segment has one ripple, which looks like a parabola.
        (Rippled { n: 46, m: 0.01776 }, 14, false),
        (Rippled { n: 4, m: 0.24 }, 21, false),
        (Rippled { n: 4, m: 0.24 }, 41, false),
        (Rippled { n: 3, m: 0.1 }, 41, true),
    ];
    for (rippled, nodes, is_seen) in cases {
        let section = rippled.section()?;
        for (irregularity, formulation) in [(0.0, Formulation::Variational), (0.25, Formulation::Local)] {
            let label = format!("ζ + {}ζ^{}, {nodes} nodes, irregularity {irregularity}", rippled.m, rippled.n);
            let cloud = CloudParams { nodes: [nodes, nodes], irregularity, ..CloudParams::default() };
            let mesh = Mesh::constrained(generate(&section, &cloud)?)?;
            assert_eq!(hidden_bends(&section, mesh.cloud())?.is_empty(), is_seen, "{label}");
            let (problem, params) = (TorsionProblem::default(), SolveParams { formulation, ..SolveParams::default() });
            let solution = solve(&problem, &mesh, &params)?;
            let estimate = estimate(&problem, &mesh, &section, &params, &solution)?;
            let error = (solution.j - rippled.j()).abs();
            assert!(error <= estimate.j, "{label}: J is off by {error:e}, not {:e}", estimate.j);
            let error = (solution.tau_max.value - rippled.tau_max()).abs();
            assert!(error <= 2.0 * estimate.tau_max, "{label}: τ is off by {error:e}, not {:e}", estimate.tau_max);
            if is_seen {
                assert!(estimate.relative(solution.j) < 1e-3, "{label}: {:e}", estimate.relative(solution.j));
            }
        }
    }
    Ok(())
}

/// A wall as wide as a spacing and three quarters: the polynomials of both fields overshoot there, piecewise linear ones do not.
#[test]
fn a_cloud_too_coarse_for_polynomials_has_an_estimate_all_the_same() -> Result<(), Box<dyn Error>> {
    let section = Section {
        contour: Outline::rectangle([0.0, 0.0], [4.0, 2.0]),
        holes: vec![Outline::rectangle([0.1, 0.1], [3.9, 1.9])],
    };
    let exact = 1.924_351; // to a tolerance of 1e-7
    for nodes in [[61, 31], [71, 36]] {
        let mesh = Mesh::constrained(generate(&section, &CloudParams { nodes, ..CloudParams::default() })?)?;
        let (problem, params) = (TorsionProblem::default(), SolveParams::default());
        let solution = solve(&problem, &mesh, &params)?;
        let estimate = estimate(&problem, &mesh, &section, &params, &solution)?;
        let ([low, high], error) = (estimate.j_bounds, (solution.j - exact).abs());
        // 0.6 % and 0.9 % off, told to be 1.1 % and 1.3 %; by polynomials alone 8.6 % and 68 %.
        assert!(low < exact && exact < high, "{low} to {high}");
        assert!(error < estimate.j && estimate.j < 3.0 * error, "{error:e} {:e}", estimate.j);
    }
    Ok(())
}

#[test]
fn holes_much_smaller_than_the_spacing_do_not_spoil_the_estimate() -> Result<(), Box<dyn Error>> {
    let mut ratios = Vec::new();
    // J by bounds 2e-10 apart, on clouds refined about the hole.
    for (radius, j) in [(0.015, 0.457_336_809_6), (0.005, 0.457_360_419_7)] {
        let hole = Outline::circle([0.6, 0.45], radius);
        let section = Section { contour: Outline::rectangle([0.0, 0.0], [2.0, 1.0]), holes: vec![hole] };
        let known = Known { name: "plate with a tiny hole", section, j, tau_max: None, grading: None };
        for nodes in [[36, 19], [61, 31]] {
            for (irregularity, seed) in [(0.0, 1), (0.25, 1), (0.25, 2), (0.25, 3)] {
                let cloud = CloudParams { nodes, irregularity, seed, ..CloudParams::default() };
                let mesh = Mesh::constrained(generate(&known.section, &cloud)?)?;
                let (problem, params) = (TorsionProblem::default(), SolveParams::default());
                let solution = solve(&problem, &mesh, &params)?;
                let estimate = estimate(&problem, &mesh, &known.section, &params, &solution)?;
                let context = format!("{radius} {nodes:?} {irregularity} {seed}");
                let [low, high] = estimate.j_bounds;
                assert!(low <= j && j <= high, "{context}: {low} {high}");
                let error = (solution.j - j).abs();
                assert!(error <= estimate.j, "{context}: {error} {}", estimate.j);
                ratios.push(estimate.j / error);
            }
        }
    }
    ratios.sort_by(f64::total_cmp);
    // Those beyond are of solutions that are right by chance.
    assert!(ratios[ratios.len() / 2] < 8.0, "{ratios:?}");
    Ok(())
}

#[test]
fn many_holes_much_smaller_than_the_spacing_are_solved_by_iteration_and_bounded_closely() -> Result<(), Box<dyn Error>>
{
    // 32 holes of a fifth and of a sixteenth of the spacing.
    for radius in [0.006, 0.002] {
        let centre = |k: usize| [0.125 + 0.25 * (k % 8) as f64, 0.125 + 0.25 * (k / 8) as f64];
        let holes = (0..32).map(|k| Outline::circle(centre(k), radius)).collect();
        let section = Section { contour: Outline::rectangle([0.0, 0.0], [2.0, 1.0]), holes };
        let (mut highest, mut lowest) = (f64::NEG_INFINITY, f64::INFINITY);
        for (irregularity, seed) in [(0.0, 1), (0.25, 1), (0.25, 2), (0.4, 1)] {
            let cloud = CloudParams { nodes: [61, 31], irregularity, seed, ..CloudParams::default() };
            let mesh = Mesh::constrained(generate(&section, &cloud)?)?;
            for formulation in [Formulation::Variational, Formulation::Local] {
                let context = format!("{radius} {irregularity} {seed} {formulation:?}");
                let params = SolveParams { formulation, solver: Solver::Iterative, ..SolveParams::default() };
                let problem = TorsionProblem::default();
                let solution = solve(&problem, &mesh, &params)?;
                let estimate = estimate(&problem, &mesh, &section, &params, &solution)?;
                assert!(!solution.linear.fell_back && !estimate.linear.fell_back, "{context}");
                // 0.0068 at most; with the nearest nodes 0.02 in the variational form, up to 25 in the local one.
                assert!(estimate.relative(solution.j) < 0.008, "{context}: {}", estimate.relative(solution.j));
                let [low, high] = estimate.j_bounds;
                (lowest, highest) = (lowest.min(high), highest.max(low));
            }
        }
        assert!(highest <= lowest, "{radius}: {highest} {lowest}: all bounds are about one J");
    }
    Ok(())
}

#[test]
fn bounds_hold_beside_a_tiny_hole_without_stress_function() -> Result<(), Box<dyn Error>> {
    // What flows out of the hole falls by the distance within one triangle. J by bounds 8e-10 apart, on a cloud refined there.
    let j = 0.138_870_882_8;
    let hole = Outline::circle([0.5, 0.45], 0.01);
    let contour = Outline::polygon(vec![[0.0, 0.0], [3.0, 0.15], [0.0, 1.0]]);
    let section = Section { contour, holes: vec![hole] };
    let problem = TorsionProblem { holes: HoleCondition::Zero, ..TorsionProblem::default() };
    for (order, irregularity) in [(1, 0.0), (2, 0.0), (2, 0.3), (2, 0.45), (4, 0.0), (4, 0.45)] {
        let cloud = CloudParams { nodes: [61, 21], irregularity, seed: 1, ..CloudParams::default() };
        let mesh = Mesh::constrained(generate(&section, &cloud)?)?;
        let params = SolveParams { order, ..SolveParams::default() };
        let solution = solve(&problem, &mesh, &params)?;
        let estimate = estimate(&problem, &mesh, &section, &params, &solution)?;
        let context = format!("order {order}, irregularity {irregularity}");
        let [low, high] = estimate.j_bounds;
        assert!(low <= j && j <= high, "{context}: {low} {high}");
        let error = (solution.j - j).abs();
        assert!(error <= estimate.j && estimate.j < 10.0 * error, "{context}: {error} {}", estimate.j);
    }
    Ok(())
}
