//! The problem as the pipeline takes it: read, typed, within its limits.

use super::error::{Place, Source};
use super::formula::Formula;
use super::grading::GradingSettings;
use nmt_cloud::ClearanceUnit;
use nmt_curve::{Division, Outline};
use nmt_mfdm::{Formulation, HoleCondition, Load, SolveParams, Solver, StarChoice, Test, Trial};
use nmt_tri::Elimination;

/// A sound problem: every value within its limits, every outline closed, simple and in its place.
#[derive(Clone, Debug)]
pub struct Problem {
    /// Title, empty by default.
    pub title: String,
    /// Name of the length unit, printed beside results; empty by default.
    pub units: String,
    /// The subdomains in the order of the file, at least one.
    pub subdomains: Vec<Subdomain>,
    /// How the clouds are triangulated.
    pub mesh: MeshSettings,
    /// How it is solved.
    pub solve: SolveSettings,
    /// The file, for the place of a fault that is found later.
    pub source: Source,
}

/// A main contour with its holes.
#[derive(Clone, Debug)]
pub struct Subdomain {
    /// Name, unique in the problem; `s1`, `s2` … by default.
    pub name: String,
    /// N_x, N_y: grid lines across the contour's envelope, each at least 2.
    pub nodes: [usize; 2],
    /// Amp of (10): the largest displacement of a node in spacings, in [0, 0.5); 0, the default, is a regular cloud.
    pub irregularity: f64,
    /// G, positive; 1 by default.
    pub shear_modulus: f64,
    /// Its own formulation, where it differs from that of [`SolveSettings`].
    pub formulation: Option<Formulation>,
    /// How nodes are spread along curved edges, those of the holes included \[D3\]; by arc length by default.
    pub division: Division,
    /// What the two clearances are measured in; max(h_x, h_y) by default.
    pub clearance: ClearanceUnit,
    /// Least distance of an interior node from a boundary segment, in spacings \[D6\]; ⅓ by default.
    pub edge_clearance: f64,
    /// Least distance of an interior node from a boundary node, in spacings \[D7\]; ½ by default.
    pub node_clearance: f64,
    /// True where its nodes on common edges shall be those of its neighbours too; false by default.
    pub conforming: bool,
    /// How its spacing varies; `None` where it does not.
    pub grading: Option<GradingSettings>,
    /// The main contour, either orientation.
    pub contour: Outline,
    /// The holes in the order of the file.
    pub holes: Vec<Hole>,
    /// ∂u/∂n of a Poisson problem on each edge, n outward, by [`nmt_geom::EdgeId`]: the contour's edges, then each hole's;
    /// `None` where u is given.
    pub fluxes: Vec<Option<Formula>>,
    /// Its `[[subdomain]]`.
    pub place: Place,
    /// Its `nodes`, or `--nodes`.
    pub nodes_place: Place,
    /// The key that gives its contour.
    pub contour_place: Place,
    /// Each edge of its contour, in order.
    pub edge_places: Vec<Place>,
}

/// A hole of a subdomain.
#[derive(Clone, Debug)]
pub struct Hole {
    /// Name, unique in the subdomain; `h1`, `h2` … by default.
    pub name: String,
    /// N_x, N_y over the hole's own envelope; by default the densities of the contour.
    pub nodes: Option<[usize; 2]>,
    /// The boundary of the hole, either orientation; its edges are named `HOLE/e1` … by default.
    pub outline: Outline,
    /// Its `[[subdomain.hole]]`.
    pub place: Place,
    /// Each edge of its outline, in order.
    pub edge_places: Vec<Place>,
}

/// A way to triangulate a cloud.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum MeshMethod {
    /// Constrained Delaunay; the default.
    #[default]
    Constrained,
    /// The paper's: Delaunay of all nodes, elimination, completion.
    Unconstrained,
}

impl MeshMethod {
    /// Both ways.
    pub const ALL: [Self; 2] = [Self::Constrained, Self::Unconstrained];

    /// The word of problem files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Constrained => "constrained",
            Self::Unconstrained => "unconstrained",
        }
    }
}

/// `[mesh]`, options of the command included.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshSettings {
    /// The way of every subdomain.
    pub method: MeshMethod,
    /// Steps of the unconstrained way.
    pub elimination: Elimination,
    /// Where `elim` is given.
    pub elimination_place: Option<Place>,
    /// Sweeps of smoothing over the interior nodes; 0 by default.
    pub smooth: usize,
}

/// `[solve]`, options of the command included.
#[derive(Clone, Debug, PartialEq)]
pub struct SolveSettings {
    /// The formulation of every subdomain without its own.
    pub formulation: Formulation,
    /// Twist or torque.
    pub load: Load,
    /// The condition on holes \[D12\].
    pub holes: HoleCondition,
    /// p, the order of the MWLS polynomial, 1 to 4; 2 by default. Finite elements are linear whatever it is.
    pub order: usize,
    /// Nodes in a star, the centre included; by default the order's own.
    ///
    /// At least the number of monomials; that it is no larger than the cloud is known only when there is one.
    pub star: Option<usize>,
    /// How the nodes of a star are chosen; by default as [`SolveParams::star_choice`] has it.
    pub stars: Option<StarChoice>,
    /// g of the weight, in [0, 1]; 0, the default, interpolates.
    pub smoothing: f64,
    /// Trial functions of the variational formulation \[D13\].
    pub trial: Trial,
    /// Its test functions.
    pub test: Test,
    /// Its Gauss points a triangle; by default the order's own.
    pub gauss: Option<usize>,
    /// Linear solver.
    pub solver: Solver,
    /// Seed of the randomisation.
    pub seed: u64,
    /// Whether the errors of torsion are estimated; true by default.
    pub estimate: bool,
    /// The error of J, as a fraction of it, that clouds are refined down to; `None` for the clouds as they are given.
    pub tolerance: Option<f64>,
    /// Most nodes of a subdomain on the way to a tolerance; 10⁶ by default.
    pub max_nodes: usize,
    /// Where `star` is given.
    pub star_place: Option<Place>,
    /// What makes it a Poisson problem; `None` for torsion.
    pub poisson: Option<PoissonSettings>,
}

/// The data of a Poisson problem: ∇²u = f, with u = g on edges without a flux.
#[derive(Clone, Debug, PartialEq)]
pub struct PoissonSettings {
    /// f.
    pub source: Formula,
    /// g; 0 by default.
    pub boundary: Option<Formula>,
    /// u where it is known, for the errors.
    pub exact: Option<Formula>,
}

impl Default for SolveSettings {
    fn default() -> Self {
        Self {
            formulation: Formulation::default(),
            load: Load::Twist(1.0),
            holes: HoleCondition::default(),
            order: 2,
            star: None,
            stars: None,
            smoothing: 0.0,
            trial: Trial::default(),
            test: Test::default(),
            gauss: None,
            solver: Solver::default(),
            seed: nmt_cloud::DEFAULT_SEED,
            estimate: true,
            tolerance: None,
            max_nodes: 1_000_000,
            star_place: None,
            poisson: None,
        }
    }
}

impl SolveSettings {
    /// How a subdomain is solved, `formulation` being its own, if it has one.
    pub fn params(&self, formulation: Option<Formulation>) -> SolveParams {
        SolveParams {
            formulation: formulation.unwrap_or(self.formulation),
            order: self.order,
            star: self.star,
            stars: self.stars,
            smoothing: self.smoothing,
            trial: self.trial,
            test: self.test,
            gauss: self.gauss,
            solver: self.solver,
        }
    }
}

/// Options of the command: each replaces its key of the file and obeys the same limits.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Overrides {
    /// `--nodes Nx,Ny`: the grid lines of every subdomain.
    pub nodes: Option<[usize; 2]>,
    /// `--formulation`: of every subdomain, those with a formulation of their own included.
    pub formulation: Option<String>,
    /// `--twist`; replaces a torque of the file too.
    pub twist: Option<f64>,
    /// `--torque`; replaces a twist of the file too.
    pub torque: Option<f64>,
    /// `--holes`.
    pub holes: Option<String>,
    /// `--order`.
    pub order: Option<i64>,
    /// `--star`.
    pub star: Option<i64>,
    /// `--stars`.
    pub stars: Option<String>,
    /// `--smoothing`.
    pub smoothing: Option<f64>,
    /// `--trial`.
    pub trial: Option<String>,
    /// `--test`.
    pub test: Option<String>,
    /// `--gauss`.
    pub gauss: Option<i64>,
    /// `--source`, a formula of x and y.
    pub source: Option<String>,
    /// `--boundary`, likewise.
    pub boundary: Option<String>,
    /// `--exact`, likewise.
    pub exact: Option<String>,
    /// `--solver`.
    pub solver: Option<String>,
    /// `--seed`.
    pub seed: Option<u64>,
    /// `--no-estimate` is `Some(false)`.
    pub estimate: Option<bool>,
    /// `--tolerance`.
    pub tolerance: Option<f64>,
    /// `--max-nodes`.
    pub max_nodes: Option<i64>,
    /// `--method`.
    pub method: Option<String>,
    /// `--smooth`.
    pub smooth: Option<i64>,
    /// `--elim`: names of steps, or their flags 1 and 0.
    pub elim: Option<Vec<String>>,
}
