//! Observed order of J on refined irregular clouds: a half disc, whose boundary is curved and whose J is known.

use nmt::prelude::*;

/// π/2 − 4/π, Timoshenko and Goodier, Theory of Elasticity, Art. 110: half disc of radius 1.
fn exact_j() -> f64 {
    std::f64::consts::FRAC_PI_2 - 4.0 / std::f64::consts::PI
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    for formulation in Formulation::ALL {
        println!("{}", formulation.name());
        let mut errors = Vec::new();
        for n in [21, 41, 81] {
            let text = format!(
                "[[subdomain]]\nnodes = [{n}, {}]\nirregularity = 0.2\n\
                 outline = [[1, 0], {{ arc = {{ centre = [0, 0] }} }}, [-1, 0]]",
                n / 2 + 1
            );
            let overrides = Overrides { formulation: Some(formulation.name().into()), ..Overrides::default() };
            let problem = Problem::parse("half-disc.toml", &text, &overrides).map_err(nmt::NmtError::Problem)?;
            let solution = &solve_problem(&problem)?[0].solution;
            let error = (solution.j / exact_j() - 1.0).abs();
            println!(
                "  {n:3} across, {:5} unknowns: J = {:.8}, relative error {error:.1e}",
                solution.unknowns, solution.j
            );
            errors.push(error);
        }
        let order = (errors[0] / errors[2]).log2() / 2.0;
        println!("  observed order {order:.1}");
        assert!(order > 1.8, "two refinements gain more than a factor of 12");
    }
    Ok(())
}
