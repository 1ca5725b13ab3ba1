//! `nmt solve`: torsion of the section.

use super::{finish, load};
use crate::args::SolveArgs;
use crate::exit::Failure;
use crate::files::OutDir;
use crate::timing::Stopwatch;
use nmt::figures::{edges_svg, mesh_svg, nodes_svg, solution_svg};
use nmt::io::{csv_of_edges, csv_of_solutions, msh_of_solutions, stars_json, vtu_of_solutions};
use nmt::pipeline::{clouds, meshes, solutions};
use nmt::report::Report;

/// Runs the command.
pub fn solve(args: &SolveArgs) -> Result<(), Failure> {
    let mut watch = Stopwatch::start();
    let problem = load(&args.problem, &args.problem.overrides_with(&args.keys, &args.mesh))?;
    let mut lap = |k, stage| watch.lap(k, stage);
    let parts = clouds(&problem, &mut lap)
        .and_then(|clouds| meshes(&problem, clouds, &mut lap))
        .and_then(|meshes| solutions(&problem, meshes, &mut lap))
        .map_err(|e| Failure::of(e, &problem.source))?;
    if let Some(out) = &args.out {
        let out = OutDir::create(out)?;
        out.write("nodes.csv", csv_of_solutions(&parts))?;
        out.write("edges.csv", csv_of_edges(&parts))?;
        out.write("mesh.vtu", vtu_of_solutions(&parts))?;
        out.write("mesh.msh", msh_of_solutions(&parts))?;
        out.write("stars.json", stars_json(&parts).map_err(|error| Failure::Json(error.to_string()))?)?;
        out.write_picture("nodes", &nodes_svg(&problem, parts.iter().map(|p| (&*p.part.name, p.part.mesh.cloud()))))?;
        out.write_picture("mesh", &mesh_svg(&problem, parts.iter().map(|p| (&*p.part.name, &p.part.mesh))))?;
        out.write_picture("solution", &solution_svg(&problem, &parts))?;
        out.write_picture("edges", &edges_svg(&problem, &parts))?;
    }
    finish(Report::of_solutions(&problem, &parts, &args.at), &watch, args.problem.json, args.out.as_deref())
}
