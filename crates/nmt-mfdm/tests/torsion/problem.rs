//! What is refused, and that small and odd clouds give a result or an error.

use crate::sections::{holed_l, mesh, params, square};
use nmt_cloud::{CloudParams, Section, generate};
use nmt_curve::Outline;
use nmt_mfdm::{Formulation, Load, MfdmError, SolveParams, TorsionProblem, solve};
use nmt_tri::Mesh;
use proptest::prelude::*;

#[test]
fn a_star_smaller_than_its_polynomial_or_larger_than_the_cloud_is_refused_with_the_range() {
    let mesh = mesh(&square().section, &params([5, 5], 0.0, 0));
    let n = mesh.cloud().n_nodes();
    for formulation in Formulation::MESHLESS {
        for star in [0, 1, 5, n + 1, usize::MAX] {
            let params = SolveParams { formulation, star: Some(star), ..SolveParams::default() };
            let error = solve(&TorsionProblem::default(), &mesh, &params);
            assert_eq!(error, Err(MfdmError::StarSize { star, order: 2, least: 6, n_nodes: n }));
        }
        for star in [6, 9, 15, n] {
            let params = SolveParams { formulation, star: Some(star), ..SolveParams::default() };
            let solution = solve(&TorsionProblem::default(), &mesh, &params).expect("a size within the range");
            // Sixteen cells: a tenth of J is all that can be asked for.
            assert!((solution.j / square().j - 1.0).abs() < 0.1, "{star} {}: {}", formulation.name(), solution.j);
        }
    }
}

#[test]
fn constants_that_make_no_problem_are_named() {
    let mesh = mesh(&square().section, &params([5, 5], 0.0, 0));
    let wrong = [
        ("shear_modulus", 0.0, Load::Twist(1.0)),
        ("shear_modulus", -1.0, Load::Twist(1.0)),
        ("shear_modulus", f64::NAN, Load::Torque(1.0)),
        ("twist", 1.0, Load::Twist(0.0)),
        ("twist", 1.0, Load::Twist(f64::INFINITY)),
        ("torque", 1.0, Load::Torque(0.0)),
        ("torque", 1.0, Load::Torque(f64::NAN)),
    ];
    for (name, shear_modulus, load) in wrong {
        let problem = TorsionProblem { shear_modulus, load, ..TorsionProblem::default() };
        let error = solve(&problem, &mesh, &SolveParams::default());
        assert!(matches!(&error, Err(MfdmError::Constant { quantity, .. }) if *quantity == name), "{error:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn coarse_clouds_give_finite_results_or_an_error(
        nodes in prop::array::uniform2(3usize..12), irregularity in 0.0..0.49f64, seed in any::<u64>(), holed in any::<bool>(),
    ) {
        let section =
            if holed { holed_l(1.0, [0.0, 0.0]) } else { Section::solid(Outline::rectangle([0.0, 0.0], [3.0, 2.0])) };
        let cloud = generate(&section, &CloudParams { nodes, irregularity, seed, ..CloudParams::default() });
        prop_assume!(cloud.is_ok());
        let Ok(cloud) = cloud else { return Ok(()) };
        let mesh = Mesh::constrained(cloud).expect("every generated cloud has a mesh");
        for formulation in Formulation::MESHLESS {
            let params = SolveParams { formulation, ..SolveParams::default() };
            match solve(&TorsionProblem::default(), &mesh, &params) {
                Ok(solution) => {
                    prop_assert!(solution.linear.residual < 1e-9);
                    prop_assert!(solution.f.iter().all(|f| f.is_finite()) && solution.j.is_finite());
                }
                Err(error) => prop_assert!(!error.to_string().is_empty()),
            }
        }
    }
}
