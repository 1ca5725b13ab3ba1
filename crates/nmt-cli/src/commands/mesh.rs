//! `nmt mesh`: the cloud and its triangles.

use super::{finish, load, out_dir};
use crate::args::MeshArgs;
use crate::exit::Failure;
use crate::timing::Stopwatch;
use nmt::figures::{mesh_svg, nodes_svg, quality_svg};
use nmt::io::{csv_of_clouds, msh_of_meshes, vtu_of_meshes};
use nmt::pipeline::{clouds, meshes};
use nmt::report::Report;

/// Runs the command.
pub fn mesh(args: &MeshArgs) -> Result<(), Failure> {
    let mut watch = Stopwatch::start();
    let problem = load(&args.cloud.problem, &args.cloud.problem.overrides_with_mesh(&args.mesh))?;
    let mut out = out_dir(args.cloud.out.as_deref())?;
    let mut lap = |k, stage| watch.lap(k, stage);
    let parts = clouds(&problem, &mut lap)
        .and_then(|clouds| meshes(&problem, clouds, &mut lap))
        .map_err(|e| Failure::of(e, &problem.source))?;
    if let Some(out) = &mut out {
        out.write("nodes.csv", csv_of_clouds(parts.iter().map(|p| (&*p.name, &*p.edge_names, p.mesh.cloud()))))?;
        out.write("mesh.vtu", vtu_of_meshes(&parts))?;
        out.write("mesh.msh", msh_of_meshes(&parts))?;
        out.write_picture("nodes", &nodes_svg(&problem, parts.iter().map(|p| (&*p.name, p.mesh.cloud()))))?;
        out.write_picture("quality", &quality_svg(&problem, &parts))?;
        out.write_picture("mesh", &mesh_svg(&problem, parts.iter().map(|p| (&*p.name, &p.mesh))))?;
    }
    finish(Report::of_meshes(&problem, &parts), &watch, args.cloud.problem.json, out)
}
