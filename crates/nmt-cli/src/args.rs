//! The options of the command.

use clap::{Parser, Subcommand};
use nmt::problem::Overrides;
use std::path::PathBuf;

/// Clouds of nodes, triangular meshes and the torsion of 2D sections by the meshless finite difference method.
#[derive(Debug, Parser)]
#[command(name = "nmt", version, about, long_about = None)]
pub struct Args {
    /// Draw no bar of progress; without this one is drawn on stderr, where that is a terminal, after a second
    #[arg(long, global = true)]
    pub no_progress: bool,
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Validate a problem file: every fault, the census a solve would have, and warnings
    Check(CheckArgs),
    /// Generate the cloud of nodes
    Nodes(CloudArgs),
    /// Generate the cloud and its triangular mesh
    Mesh(MeshArgs),
    /// Solve the Prandtl torsion problem, or with a `source` the Poisson problem
    Solve(SolveArgs),
    /// Solve by every formulation on the same clouds: unknowns, J (or u), error and time side by side
    Compare(CompareArgs),
    /// Draw one thing
    #[command(subcommand)]
    Plot(Picture),
}

/// What `nmt plot` draws.
#[derive(Debug, Subcommand)]
pub enum Picture {
    /// The star of one node as the equations use it: weights, hidden nodes, the row of ∇²
    Star(StarArgs),
}

/// The problem file and its densities.
#[derive(Debug, clap::Args)]
pub struct ProblemArgs {
    /// Problem file (TOML)
    pub file: PathBuf,
    /// Densities N_x,N_y of every subdomain, instead of the file's
    #[arg(long, value_name = "Nx,Ny", value_parser = counts)]
    pub nodes: Option<[usize; 2]>,
    /// Seed of the randomisation, 0 or more
    #[arg(long, allow_hyphen_values = true)]
    pub seed: Option<u64>,
    /// Print the report as JSON on stdout
    #[arg(long)]
    pub json: bool,
}

/// Keys of [solve], each winning over the file's.
#[derive(Debug, clap::Args)]
pub struct SolveKeys {
    /// Formulation: variational, local, or fem (linear finite elements, for comparison)
    #[arg(long)]
    pub formulation: Option<String>,
    /// Twist θ per unit length
    #[arg(long, allow_hyphen_values = true)]
    pub twist: Option<f64>,
    /// Torque T, instead of a twist
    #[arg(long, allow_hyphen_values = true)]
    pub torque: Option<f64>,
    /// Condition on holes: circulation or zero
    #[arg(long)]
    pub holes: Option<String>,
    /// Order p of the MWLS polynomial: 2, 3, 4; 1 in the variational formulation
    #[arg(long, allow_hyphen_values = true)]
    pub order: Option<i64>,
    /// Nodes in a star, the centre included
    #[arg(long, allow_hyphen_values = true)]
    pub star: Option<i64>,
    /// How the nodes of a star are chosen: nearest or balanced
    #[arg(long)]
    pub stars: Option<String>,
    /// Smoothing g of the weight: 0, which interpolates, to 1
    #[arg(long, value_name = "G", allow_hyphen_values = true)]
    pub smoothing: Option<f64>,
    /// Trial functions of the variational formulation: blended, or the paper's mwls
    #[arg(long)]
    pub trial: Option<String>,
    /// Its test functions: hat, or the paper's trial
    #[arg(long)]
    pub test: Option<String>,
    /// Its Gauss points a triangle: 1, 3, 4, 6, 7 or 12
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub gauss: Option<i64>,
    /// f(x, y) of the Poisson problem ∇²u = f, which is then solved instead of torsion
    #[arg(long, value_name = "F", allow_hyphen_values = true)]
    pub source: Option<String>,
    /// Its boundary values g(x, y); 0 by default
    #[arg(long, value_name = "G", allow_hyphen_values = true)]
    pub boundary: Option<String>,
    /// Its exact solution u(x, y), for the errors
    #[arg(long, value_name = "U", allow_hyphen_values = true)]
    pub exact: Option<String>,
    /// Linear solver: auto, direct, or iterative (multigrid; auto takes it for large systems)
    #[arg(long)]
    pub solver: Option<String>,
}

/// Options of `nmt check`.
#[derive(Debug, clap::Args)]
pub struct CheckArgs {
    #[command(flatten)]
    pub problem: ProblemArgs,
    #[command(flatten)]
    pub keys: SolveKeys,
}

/// Options of `nmt nodes`, and some of `nmt mesh`.
#[derive(Debug, clap::Args)]
pub struct CloudArgs {
    #[command(flatten)]
    pub problem: ProblemArgs,
    /// Directory for the files (created if need be)
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// Keys of [mesh], each winning over the file's.
#[derive(Debug, Default, clap::Args)]
pub struct MeshKeys {
    /// Triangulation: constrained, or the paper's unconstrained
    #[arg(long)]
    pub method: Option<String>,
    /// Sweeps of smoothing over the interior nodes
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub smooth: Option<i64>,
    /// Steps of the unconstrained way, of outside,in_hole,tiny,complete; or four flags such as 1,1,1,0; or none
    #[arg(long, value_name = "STEPS", value_delimiter = ',')]
    pub elim: Option<Vec<String>>,
}

/// Options of `nmt mesh`.
#[derive(Debug, clap::Args)]
pub struct MeshArgs {
    #[command(flatten)]
    pub cloud: CloudArgs,
    #[command(flatten)]
    pub mesh: MeshKeys,
}

/// Options of `nmt solve`.
#[derive(Debug, clap::Args)]
pub struct SolveArgs {
    #[command(flatten)]
    pub problem: ProblemArgs,
    #[command(flatten)]
    pub keys: SolveKeys,
    #[command(flatten)]
    pub mesh: MeshKeys,
    /// Do not estimate the errors of torsion, which takes half as long as the solution or more
    #[arg(long)]
    pub no_estimate: bool,
    /// Refine the clouds until the estimated error of J is at most this fraction of it; without, clouds are as given
    #[arg(long, value_name = "E", allow_hyphen_values = true)]
    pub tolerance: Option<f64>,
    /// Most nodes of a subdomain on the way to the tolerance; 1000000 by default
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub max_nodes: Option<i64>,
    /// Directory for the files (created if need be)
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Point at which F and τ (of a Poisson problem u and its gradient) are reported; may be repeated
    #[arg(long, value_name = "x,y", value_parser = point, allow_hyphen_values = true)]
    pub at: Vec<[f64; 2]>,
}

/// Options of `nmt compare`.
#[derive(Debug, clap::Args)]
pub struct CompareArgs {
    /// Problem file (TOML)
    pub file: PathBuf,
    /// Densities N_x,N_y of every subdomain, instead of the file's; may be repeated, one cloud each
    #[arg(long, value_name = "Nx,Ny", value_parser = counts)]
    pub nodes: Vec<[usize; 2]>,
    /// Seed of the randomisation, 0 or more
    #[arg(long, allow_hyphen_values = true)]
    pub seed: Option<u64>,
    /// Exact J to hold the others against, for torsion of one subdomain; by default the best of them is
    #[arg(long = "exact-J", value_name = "X", value_parser = positive, allow_hyphen_values = true)]
    pub exact_j: Option<f64>,
    /// Print the rows as JSON on stdout
    #[arg(long)]
    pub json: bool,
    /// Directory for the files (created if need be)
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// Options of `nmt plot star`.
#[derive(Debug, clap::Args)]
pub struct StarArgs {
    /// Problem file (TOML)
    pub file: PathBuf,
    /// Number of the node in its subdomain, from 0, as in nodes.csv and mesh.vtu
    #[arg(long, value_name = "N")]
    pub node: usize,
    /// Subdomain of the node, where there are several
    #[arg(long, value_name = "NAME")]
    pub subdomain: Option<String>,
    /// Densities N_x,N_y of every subdomain, instead of the file's
    #[arg(long, value_name = "Nx,Ny", value_parser = counts)]
    pub nodes: Option<[usize; 2]>,
    /// Seed of the randomisation, 0 or more
    #[arg(long, allow_hyphen_values = true)]
    pub seed: Option<u64>,
    #[command(flatten)]
    pub keys: SolveKeys,
    #[command(flatten)]
    pub mesh: MeshKeys,
    /// Directory for star-N.svg and star-N.png (created if need be)
    #[arg(long, value_name = "DIR", default_value = ".")]
    pub out: PathBuf,
}

impl SolveArgs {
    /// What the options change of the file.
    pub fn overrides(&self) -> Overrides {
        Overrides {
            estimate: self.no_estimate.then_some(false),
            tolerance: self.tolerance,
            max_nodes: self.max_nodes,
            ..self.problem.overrides_with(&self.keys, &self.mesh)
        }
    }
}

impl ProblemArgs {
    /// What the options change of the file, without keys of [solve].
    pub fn overrides(&self) -> Overrides {
        Overrides { nodes: self.nodes, seed: self.seed, ..Overrides::default() }
    }

    /// What the options change of the file, without keys of [solve].
    pub fn overrides_with_mesh(&self, mesh: &MeshKeys) -> Overrides {
        Overrides { method: mesh.method.clone(), elim: mesh.elim.clone(), smooth: mesh.smooth, ..self.overrides() }
    }

    /// What the options change of the file.
    pub fn overrides_with(&self, keys: &SolveKeys, mesh: &MeshKeys) -> Overrides {
        Overrides {
            formulation: keys.formulation.clone(),
            twist: keys.twist,
            torque: keys.torque,
            holes: keys.holes.clone(),
            order: keys.order,
            star: keys.star,
            stars: keys.stars.clone(),
            smoothing: keys.smoothing,
            trial: keys.trial.clone(),
            test: keys.test.clone(),
            gauss: keys.gauss,
            source: keys.source.clone(),
            boundary: keys.boundary.clone(),
            exact: keys.exact.clone(),
            solver: keys.solver.clone(),
            ..self.overrides_with_mesh(mesh)
        }
    }
}

fn pair<T: std::str::FromStr>(text: &str, what: &str) -> Result<[T; 2], String> {
    let wrong = || format!("expected two {what} with a comma between, such as {}", example(what));
    let (first, second) = text.split_once(',').ok_or_else(wrong)?;
    let parse = |part: &str| part.trim().parse().map_err(|_| wrong());
    Ok([parse(first)?, parse(second)?])
}

fn example(what: &str) -> &'static str {
    if what == "counts" { "41,21" } else { "0.5,-0.25" }
}

fn counts(text: &str) -> Result<[usize; 2], String> {
    pair(text, "counts")
}

fn point(text: &str) -> Result<[f64; 2], String> {
    let point: [f64; 2] = pair(text, "numbers")?;
    if point.iter().all(|v| v.is_finite()) { Ok(point) } else { Err("expected finite numbers".into()) }
}

fn positive(text: &str) -> Result<f64, String> {
    let value: Option<f64> = text.trim().parse().ok();
    value.filter(|v| v.is_normal() && *v > 0.0).ok_or_else(|| "expected a positive number, such as 0.1406".into())
}
