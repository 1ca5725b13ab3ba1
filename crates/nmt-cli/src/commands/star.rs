//! `nmt plot star`: the star of one node.

use super::{load, observer};
use crate::args::{ProblemArgs, StarArgs};
use crate::exit::Failure;
use crate::files::print;
use crate::out_dir::OutDir;
use crate::progress::Progress;
use crate::timing::Stopwatch;
use nmt::NmtError;
use nmt::figures::star_svg;
use nmt::pipeline::{clouds, meshes};
use nmt::star::{StarError, StarView};

/// Runs the command.
pub fn star(args: &StarArgs, progress: &Progress) -> Result<(), Failure> {
    let file = ProblemArgs { file: args.file.clone(), nodes: args.nodes, seed: args.seed, json: false };
    let problem = load(&file, &file.overrides_with(&args.keys, &args.mesh))?;
    let mut watch = Stopwatch::start();
    let mut observer = observer(&problem, &mut watch, progress);
    let parts = clouds(&problem, &mut observer)
        .and_then(|clouds| meshes(&problem, clouds, &mut observer))
        .map_err(|e| Failure::of(e, &problem.source))?;
    let view = StarView::new(&problem, &parts, args.subdomain.as_deref(), args.node).map_err(|error| match error {
        StarError::Star(source) => {
            let subdomain = args.subdomain.clone().or(parts.first().map(|part| part.name.clone())).unwrap_or_default();
            Failure::Numerics(NmtError::Solve { subdomain, source })
        }
        other => Failure::Option(other.to_string()),
    })?;
    let mut out = OutDir::create(&args.out, progress)?;
    out.write_picture(&file_name(&view, parts.len() > 1), || star_svg(&problem, &view))?;
    out.publish()?;
    progress.clear();
    print(&view.text())
}

/// `star-N`, or where there are several subdomains `star-NAME-N`; what file systems do not take in a name becomes `_`.
fn file_name(view: &StarView, several: bool) -> String {
    let node = view.star.node.0;
    if !several {
        return format!("star-{node}");
    }
    let takes = |c: char| c.is_alphanumeric() || matches!(c, '-' | '_' | '.');
    let name: String = view.part.name.chars().map(|c| if takes(c) { c } else { '_' }).collect();
    format!("star-{name}-{node}")
}
