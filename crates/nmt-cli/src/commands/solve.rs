//! `nmt solve`: torsion of the section, or the Poisson problem of the file.

use super::{finish, load, observer, out_dir};
use crate::args::SolveArgs;
use crate::exit::Failure;
use crate::progress::Progress;
use crate::timing::Stopwatch;
use nmt::figures::{edges_svg, error_svg, mesh_svg, nodes_svg, solved_svg};
use nmt::io::{NodeFields, csv_of_edges, csv_of_solutions, msh_of_solutions, stars_json, vtu_of_solutions};
use nmt::pipeline::{Solved, SolvedPart, Step, solve_any_observed};
use nmt::report::Report;

/// Runs the command.
pub fn solve(args: &SolveArgs, progress: &Progress) -> Result<(), Failure> {
    let mut watch = Stopwatch::start();
    let problem = load(&args.problem, &args.overrides())?;
    let mut out = out_dir(args.out.as_deref(), progress)?;
    let mut observer = observer(&problem, &mut watch, progress);
    let solved = solve_any_observed(&problem, &mut observer).map_err(|e| Failure::of(e, &problem.source))?;
    drop(observer);
    if let Some(out) = &mut out {
        let fields = NodeFields::of(&solved);
        out.write_with("nodes.csv", |sink| csv_of_solutions(sink, &fields))?;
        out.write_with("mesh.vtu", |sink| vtu_of_solutions(sink, &fields))?;
        out.write_with("mesh.msh", |sink| msh_of_solutions(sink, &fields))?;
        out.write_with("stars.json", |sink| stars_json(sink, &fields))?;
        let parts = solved.parts();
        out.write_picture("nodes", || nodes_svg(&problem, parts.iter().map(|p| (&*p.name, p.mesh.cloud()))))?;
        out.write_picture("mesh", || mesh_svg(&problem, parts.iter().map(|p| (&*p.name, &p.mesh))))?;
        out.write_picture("solution", || solved_svg(&problem, &solved))?;
        if let Solved::Torsion(parts) = &solved {
            out.write("edges.csv", csv_of_edges(parts))?;
            out.write_picture("edges", || edges_svg(&problem, parts))?;
            if let Some(error) = error_svg(&problem, parts) {
                out.write_picture("error", || error)?;
            }
        }
    }
    finish(Report::of_solved(&problem, &solved, &args.at), (&watch, progress), args.problem.json, out)?;
    match (problem.solve.tolerance, &solved) {
        (Some(tolerance), Solved::Torsion(parts)) => met(tolerance, parts),
        _ => Ok(()),
    }
}

/// Fails where a subdomain does not meet the tolerance; its results are written all the same.
fn met(tolerance: f64, parts: &[SolvedPart]) -> Result<(), Failure> {
    let missed = parts.iter().map(|part| (part, Step::of(part))).find(|(_, step)| step.error > tolerance);
    missed.map_or(Ok(()), |(part, step)| {
        Err(Failure::Tolerance {
            subdomain: part.part.name.clone(),
            asked: tolerance,
            reached: step.error,
            nodes: step.nodes,
            why: part.stop.as_ref().map_or(String::new(), |stop| format!("; {stop}")),
        })
    })
}
