//! `nmt plot star`: the star of one node.

use super::load;
use crate::args::{ProblemArgs, StarArgs};
use crate::exit::Failure;
use crate::files::print;
use crate::out_dir::OutDir;
use nmt::NmtError;
use nmt::figures::star_svg;
use nmt::pipeline::{clouds, meshes};
use nmt::star::{StarError, StarView};

/// Runs the command.
pub fn star(args: &StarArgs) -> Result<(), Failure> {
    let file = ProblemArgs { file: args.file.clone(), nodes: args.nodes, seed: args.seed, json: false };
    let problem = load(&file, &file.overrides_with(&args.keys, &args.mesh))?;
    let parts = clouds(&problem, &mut |_, _| {})
        .and_then(|clouds| meshes(&problem, clouds, &mut |_, _| {}))
        .map_err(|e| Failure::of(e, &problem.source))?;
    let view = StarView::new(&problem, &parts, args.subdomain.as_deref(), args.node).map_err(|error| match error {
        StarError::Star(source) => {
            let subdomain = args.subdomain.clone().or(parts.first().map(|part| part.name.clone())).unwrap_or_default();
            Failure::Numerics(NmtError::Solve { subdomain, source })
        }
        other => Failure::Option(other.to_string()),
    })?;
    let mut out = OutDir::create(&args.out)?;
    out.write_picture(&format!("star-{}", args.node), &star_svg(&problem, &view))?;
    out.publish()?;
    print(&view.text())
}
