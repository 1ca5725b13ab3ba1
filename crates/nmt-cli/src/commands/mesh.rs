//! `nmt mesh`: the cloud and its triangles.

use super::{finish, load, observer, out_dir};
use crate::args::MeshArgs;
use crate::exit::Failure;
use crate::progress::Progress;
use crate::timing::Stopwatch;
use nmt::figures::{mesh_svg, nodes_svg, quality_svg};
use nmt::io::{csv_of_clouds, msh_of_meshes, vtu_of_meshes};
use nmt::pipeline::{clouds, meshes};
use nmt::report::Report;

/// Runs the command.
pub fn mesh(args: &MeshArgs, progress: &Progress) -> Result<(), Failure> {
    let mut watch = Stopwatch::start();
    let problem = load(&args.cloud.problem, &args.cloud.problem.overrides_with_mesh(&args.mesh))?;
    let mut out = out_dir(args.cloud.out.as_deref(), progress)?;
    let mut observer = observer(&problem, &mut watch, progress);
    let parts = clouds(&problem, &mut observer)
        .and_then(|clouds| meshes(&problem, clouds, &mut observer))
        .map_err(|e| Failure::of(e, &problem.source))?;
    drop(observer);
    if let Some(out) = &mut out {
        out.write_with("nodes.csv", |sink| {
            csv_of_clouds(sink, parts.iter().map(|p| (&*p.name, &*p.edge_names, p.mesh.cloud())))
        })?;
        out.write_with("mesh.vtu", |sink| vtu_of_meshes(sink, &parts))?;
        out.write_with("mesh.msh", |sink| msh_of_meshes(sink, &parts))?;
        out.write_picture("nodes", || nodes_svg(&problem, parts.iter().map(|p| (&*p.name, p.mesh.cloud()))))?;
        out.write_picture("quality", || quality_svg(&problem, &parts))?;
        out.write_picture("mesh", || mesh_svg(&problem, parts.iter().map(|p| (&*p.name, &p.mesh))))?;
    }
    finish(Report::of_meshes(&problem, &parts), (&watch, progress), args.cloud.problem.json, out)
}
