//! Observed order of F on refined clouds: largest error at the nodes of the unit square against its series.

use nmt::prelude::*;
use nmt_mfdm::exact;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    for formulation in Formulation::MESHLESS {
        println!("{}", formulation.name());
        let mut errors = Vec::new();
        for n in [11, 21, 41] {
            let text = format!("[[subdomain]]\nnodes = [{n}, {n}]\nrectangle = {{ from = [0, 0], to = [1, 1] }}");
            let overrides = Overrides { formulation: Some(formulation.name().into()), ..Overrides::default() };
            let problem = Problem::parse("square.toml", &text, &overrides).map_err(nmt::NmtError::Problem)?;
            let solved = solve_problem(&problem)?.remove(0);
            let nodes = solved.part.mesh.xy().iter().zip(&solved.solution.f);
            let error = nodes.map(|(p, f)| (f - exact::rectangle_f(1.0, 1.0, *p)).abs()).fold(0.0, f64::max);
            println!("  {n:2} across, {:4} unknowns: largest error of F {error:.1e} m²", solved.solution.unknowns);
            errors.push(error);
        }
        let order = (errors[0] / errors[2]).log2() / 2.0;
        println!("  observed order {order:.2}");
        assert!(order > 1.8, "order 2 is promised for smooth solutions; 2.0 measured");
    }
    Ok(())
}
