//! The report as data; the field names are those of report.json.

use crate::pipeline::{CloudPart, Estimated, MeshPart, PoissonPart, Solved, SolvedPart};
use crate::problem::Problem;
use crate::report::common::{self, CommonEdgeReport};
use crate::report::edges::{AlongEdges, EdgeReport, LoopReport};
use crate::report::estimate::ErrorEstimateReport;
use crate::report::linear::LinearSolverReport;
use crate::report::points::{self, PointReport, PointValues};
use crate::report::poisson::PoissonReport;
use crate::report::singular::singular_vertices;
use crate::report::solves::SolvesReport;
use crate::report::stars::{StarsReport, VariationalReport};
use crate::report::tolerance::ToleranceReport;
use crate::report::warnings::{self, CloudView};
use crate::report::wishes;
use nmt_cloud::{Achieved, Census, Closing, Cloud, CloudQuality, Section};
use nmt_geom::{NodeId, Point};
use nmt_tri::{MeshCensus, quality};
use serde::Serialize;

/// Everything a run has to say; [`Report::json`] writes it as report.json.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// Version of nmt.
    pub nmt: String,
    /// Title of the problem.
    pub title: String,
    /// Name of the length unit.
    pub units: String,
    /// What a solve will solve, in the report of a check.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub solves: Option<SolvesReport>,
    /// One entry a subdomain, in the order of the file.
    pub subdomains: Vec<SubdomainReport>,
    /// How several subdomains are solved; absent with one subdomain, and where nothing is solved.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub each_alone: Option<&'static str>,
    /// One entry a common edge, none where the subdomains share nothing; absent with one subdomain.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub common_edges: Option<Vec<CommonEdgeReport>>,
    /// One entry a point asked for, in order.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub points: Option<Vec<PointReport>>,
    /// Of all subdomains together.
    pub totals: Totals,
    /// What the user should know.
    pub warnings: Vec<String>,
}

/// One subdomain.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SubdomainReport {
    /// Name.
    pub name: String,
    /// Number of nodes.
    pub nodes: usize,
    /// How many of them lie on the boundary.
    pub boundary_nodes: usize,
    /// Number of triangles.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub triangles: Option<usize>,
    /// Area of the polygon.
    pub area: f64,
    /// Centroid of the polygon.
    pub centroid: Point,
    /// h_x and h_y; of a graded cloud those of its coarsest lattice.
    pub spacing: [f64; 2],
    /// Spacings asked for at the nodes of a graded cloud.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub local_spacing: Option<LocalSpacingReport>,
    /// Grid points by fate.
    pub census: CensusReport,
    /// Edges divided by chords.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub divisions: Vec<DivisionReport>,
    /// How evenly the nodes are spread.
    pub cloud_quality: Option<CloudQualityReport>,
    /// Triangles by what became of them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mesh: Option<MeshCensusReport>,
    /// What smoothing started from.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub smoothing: Option<SmoothingReport>,
    /// Shape of the triangles.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub quality: Option<QualityReport>,
    /// The solution of torsion.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    pub solution: Option<SolutionReport>,
    /// The solution of a Poisson problem.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    pub poisson: Option<PoissonReport>,
    /// Seconds by stage, filled in by whoever holds the clock.
    pub seconds: Seconds,
}

/// Spacings of a graded cloud.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LocalSpacingReport {
    /// The least that is asked for at a node.
    pub min: f64,
    /// The largest.
    pub max: f64,
    /// Nearest-node distance over what is asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub achieved: Option<AchievedReport>,
}

/// Nearest-node distances over the spacings asked for; see [`nmt_cloud::Achieved`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct AchievedReport {
    /// The least.
    pub min: f64,
    /// The middle one.
    pub median: f64,
    /// The largest.
    pub max: f64,
}

/// Grid points by fate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct CensusReport {
    /// Generated.
    pub grid: usize,
    /// Outside the contour.
    pub outside: usize,
    /// In a hole.
    pub in_hole: usize,
    /// Too near to a segment.
    pub near_edge: usize,
    /// Too near to a boundary node.
    pub near_node: usize,
    /// Interior nodes.
    pub kept: usize,
}

/// An edge divided by chords.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DivisionReport {
    /// The edge's name.
    pub edge: String,
    /// Length of the equal chords.
    pub chord: f64,
    /// Nodes that no longer fitted.
    pub left_out: usize,
    /// By how much the last chord misses the length of the others.
    pub closing_error: f64,
}

/// How evenly nodes are spread; see [`nmt_cloud::CloudQuality`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct CloudQualityReport {
    /// Half the least distance between two nodes.
    pub separation: f64,
    /// Radius of the largest circle without a node whose centre is in the section.
    pub fill_distance: f64,
    /// Fill distance over separation.
    pub ratio: f64,
    /// Coefficient of variation of the nearest-node distance.
    pub nearest_variation: f64,
}

/// Triangles by what became of them: `delaunay − outside − in_hole − tiny − crossing + completed` are in the mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct MeshCensusReport {
    /// The way of triangulation.
    pub method: &'static str,
    /// Delaunay triangles: of all nodes, or constrained ones in the material.
    pub delaunay: usize,
    /// Dropped: centroid outside the contour.
    pub outside: usize,
    /// Dropped: centroid in a hole.
    pub in_hole: usize,
    /// Dropped: too small.
    pub tiny: usize,
    /// Taken away by completion.
    pub crossing: usize,
    /// Added by completion.
    pub completed: usize,
}

/// Smoothing of the cloud.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct SmoothingReport {
    /// Sweeps over the interior nodes.
    pub sweeps: usize,
    /// Shape of the triangles before.
    pub quality_before: QualityReport,
}

/// Shape of the triangles.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct QualityReport {
    /// Smallest 4√3·A/Σl².
    pub min: f64,
    /// Its mean.
    pub mean: f64,
    /// Smallest angle, degrees.
    pub min_angle_deg: f64,
}

/// The solution of one subdomain.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SolutionReport {
    /// Formulation.
    pub formulation: &'static str,
    /// Order p of the equations; of finite elements 1.
    pub order: usize,
    /// Trial and test functions and Gauss points of the variational formulation.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    pub variational: Option<VariationalReport>,
    /// One entry a hole.
    pub holes: Vec<HoleReport>,
    /// Interior nodes + holes under circulation.
    pub unknowns: usize,
    /// Torsion constant T/(Gθ).
    #[serde(rename = "J")]
    pub j: f64,
    /// T.
    pub torque: f64,
    /// θ.
    pub twist: f64,
    /// T/τ_max.
    #[serde(rename = "W_t")]
    pub w_t: f64,
    /// Largest F.
    #[serde(rename = "F_max")]
    pub f_max: f64,
    /// Where.
    #[serde(rename = "F_max_at")]
    pub f_max_at: Point,
    /// Largest τ at nodes.
    pub tau_max: f64,
    /// Where.
    pub tau_max_at: Point,
    /// Vertices where the exact τ is infinite.
    pub tau_singular_at: Vec<Point>,
    /// How far J, T and τ_max may be off; absent where nobody asked or nothing can be said, of which a warning tells.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error_estimate: Option<ErrorEstimateReport>,
    /// The way to a tolerance; absent where none is asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tolerance: Option<ToleranceReport>,
    /// τ along each edge, in the order of the file.
    pub edges: Vec<EdgeReport>,
    /// ∮τ·ds of each loop, the contour first.
    pub loops: Vec<LoopReport>,
    /// ‖b − Ax‖/‖b‖.
    pub linear_residual: f64,
    /// How the linear system was solved.
    pub linear_solver: LinearSolverReport,
    /// What became of the stars; absent for finite elements, which have none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stars: Option<StarsReport>,
}

/// One hole.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct HoleReport {
    /// Name.
    pub name: String,
    /// Condition.
    pub condition: &'static str,
    /// F on it.
    #[serde(rename = "F")]
    pub f: f64,
    /// Area of the polygon through its nodes.
    pub area: f64,
}

/// Seconds by stage; 0 where nobody held a clock.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Seconds {
    /// Boundary and interior nodes.
    pub cloud: f64,
    /// Triangulation.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mesh: Option<f64>,
    /// Stars and rows.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stencils: Option<f64>,
    /// The linear system.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub assemble: Option<f64>,
    /// Its solution.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub solve: Option<f64>,
    /// Recovery and results.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub post: Option<f64>,
    /// How far the results may be off.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub estimate: Option<f64>,
}

/// Of all subdomains together.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Totals {
    /// Nodes.
    pub nodes: usize,
    /// Seconds, filled in by whoever holds the clock.
    pub seconds: f64,
    /// Peak memory in 10⁶ bytes, filled in likewise; `null` where the system does not tell.
    pub peak_rss_mb: Option<f64>,
}

/// Of a solved subdomain, until somebody fills in what the clock said.
const SOLVED: Seconds = {
    let zero = Some(0.0);
    Seconds { cloud: 0.0, mesh: zero, stencils: zero, assemble: zero, solve: zero, post: zero, estimate: None }
};

impl Report {
    /// The report of clouds.
    pub fn of_clouds(problem: &Problem, parts: &[CloudPart]) -> Self {
        let subdomains = parts.iter().map(|part| cloud_report(&part.name, &part.edge_names, &part.cloud)).collect();
        let mut report = Self::new(problem, subdomains);
        report.common_edges = common::of_parts(parts.iter().map(|part| (&*part.name, &part.section, &part.cloud)));
        report.warn_of_clouds(problem, parts.iter().map(CloudView::from));
        report
    }

    /// The report of a check: clouds, and what a solution will have to say of their sections.
    pub fn of_check(problem: &Problem, parts: &[CloudPart]) -> Self {
        let mut report = Self::of_clouds(problem, parts);
        report.solves = Some(SolvesReport::of(problem));
        report.warn_of_sections(problem, parts.iter().map(|part| (&*part.name, &part.section)));
        report
    }

    /// The report of meshes.
    pub fn of_meshes(problem: &Problem, parts: &[MeshPart]) -> Self {
        let mut report = Self::new(problem, parts.iter().map(mesh_report).collect());
        report.common_edges =
            common::of_parts(parts.iter().map(|part| (&*part.name, &part.section, part.mesh.cloud())));
        report.warn_of_clouds(problem, parts.iter().map(CloudView::from));
        if !problem.mesh.elimination.is_whole() {
            report.warnings.extend(parts.iter().filter_map(warnings::of_mesh));
        }
        report
    }

    /// The report of solutions, with the values at `points`.
    pub fn of_solutions(problem: &Problem, parts: &[SolvedPart], points: &[Point]) -> Self {
        let mut report =
            Self::new(problem, parts.iter().map(|part| solved_report(part, problem.solve.tolerance)).collect());
        let meshes = parts.iter().map(|solved| &solved.part);
        report.common_edges = common::of_parts(meshes.map(|part| (&*part.name, &part.section, part.mesh.cloud())));
        let fields: Vec<_> = parts.iter().map(|solved| (&solved.part, &solved.solution.field)).collect();
        let points = points::report(&fields, points, PointValues::of_torsion);
        report.warn_of_clouds(problem, parts.iter().map(|part| CloudView::from(&part.part)));
        report.warn_of_sections(problem, parts.iter().map(|part| (&*part.part.name, &part.part.section)));
        parts.iter().for_each(|part| report.warnings.extend(warnings::of_solution(part)));
        report.warnings.extend(points.iter().filter_map(warnings::of_point));
        report.points = Some(points);
        report
    }

    /// The report of a Poisson problem, with the values at `points`.
    pub fn of_poisson(problem: &Problem, parts: &[PoissonPart], points: &[Point]) -> Self {
        let mut report = Self::new(problem, parts.iter().map(poisson_report).collect());
        let meshes = parts.iter().map(|solved| &solved.part);
        report.common_edges = common::of_parts(meshes.map(|part| (&*part.name, &part.section, part.mesh.cloud())));
        let fields: Vec<_> = parts.iter().map(|solved| (&solved.part, &solved.solution.field)).collect();
        let points = points::report(&fields, points, PointValues::of_poisson);
        report.warn_of_clouds(problem, parts.iter().map(|part| CloudView::from(&part.part)));
        report.warn_of_sections(problem, parts.iter().map(|part| (&*part.part.name, &part.part.section)));
        parts.iter().for_each(|part| report.warnings.extend(warnings::of_poisson(part)));
        report.warnings.extend(points.iter().filter_map(warnings::of_point));
        report.points = Some(points);
        report
    }

    /// The report of whatever was solved, with the values at `points`.
    pub fn of_solved(problem: &Problem, solved: &Solved, points: &[Point]) -> Self {
        match solved {
            Solved::Torsion(parts) => Self::of_solutions(problem, parts, points),
            Solved::Poisson(parts) => Self::of_poisson(problem, parts, points),
        }
    }

    /// `clouds` are those of the subdomains in order.
    fn warn_of_clouds<'a>(&mut self, problem: &Problem, clouds: impl Iterator<Item = CloudView<'a>>) {
        for (part, subdomain) in clouds.zip(&problem.subdomains) {
            let CloudView { name, cloud, .. } = part;
            self.warnings.extend(warnings::of_cloud(part));
            let asked = subdomain.grading.as_ref();
            let wishes = |asked| wishes::without_effect(name, asked, cloud, problem.solve.tolerance.is_some());
            self.warnings.extend(asked.into_iter().flat_map(wishes));
        }
    }

    fn warn_of_sections<'a>(&mut self, problem: &Problem, sections: impl Iterator<Item = (&'a str, &'a Section)>) {
        let common = self.common_edges.as_deref().unwrap_or_default();
        let names = self.subdomains.iter().map(|subdomain| &*subdomain.name);
        let each = if problem.solve.poisson.is_none() { warnings::EACH_BAR } else { warnings::EACH_PROBLEM };
        self.each_alone = (self.subdomains.len() > 1).then_some(each);
        if let Some(poisson) = &problem.solve.poisson {
            // With the exact solution at hand nothing need be guessed.
            if poisson.exact.is_none() {
                self.warnings.extend(sections.filter_map(|(name, section)| warnings::of_corners(name, section)));
            }
            self.warnings.extend(warnings::of_common_edges(names, common, warnings::POISSON_ALONE));
            return;
        }
        for (name, section) in sections {
            self.warnings.extend(warnings::of_section(name, section, problem.solve.holes));
        }
        self.warnings.extend(warnings::of_common_edges(names, common, warnings::TORSION_ALONE));
        self.warnings.extend(warnings::of_torque(self.subdomains.len(), problem.solve.load));
    }

    fn new(problem: &Problem, subdomains: Vec<SubdomainReport>) -> Self {
        let nodes = subdomains.iter().map(|s| s.nodes).sum();
        Self {
            nmt: env!("CARGO_PKG_VERSION").into(),
            title: problem.title.clone(),
            units: problem.units.clone(),
            solves: None,
            subdomains,
            each_alone: None,
            common_edges: None,
            points: None,
            totals: Totals { nodes, ..Totals::default() },
            warnings: Vec::new(),
        }
    }

    /// The report as JSON text, ending with a line break.
    ///
    /// # Errors
    /// Where a number is not finite, which no solution's is.
    pub fn json(&self) -> Result<String, serde_json::Error> {
        serde_json::to_string_pretty(self).map(|text| text + "\n")
    }
}

fn cloud_report(name: &str, edge_names: &[String], cloud: &Cloud) -> SubdomainReport {
    let division = |closing: &Closing| DivisionReport {
        edge: edge_names.get(closing.edge.index()).cloned().unwrap_or_default(),
        chord: closing.chord,
        left_out: closing.left_out,
        closing_error: closing.closing_error,
    };
    let spread = |q: CloudQuality| CloudQualityReport {
        separation: q.separation,
        fill_distance: q.fill_distance,
        ratio: q.ratio,
        nearest_variation: q.nearest_variation,
    };
    let spread_of_nodes = nmt_cloud::quality(cloud);
    let Census { grid, outside, in_hole, near_edge, near_node, kept } = cloud.census();
    SubdomainReport {
        name: name.into(),
        nodes: cloud.n_nodes(),
        boundary_nodes: cloud.n_boundary(),
        triangles: None,
        area: cloud.boundary().area(),
        centroid: cloud.boundary().centroid(),
        spacing: cloud.spacing(),
        local_spacing: local_spacing(cloud, spread_of_nodes.as_ref()),
        census: CensusReport { grid, outside, in_hole, near_edge, near_node, kept },
        divisions: cloud.closings().iter().map(division).collect(),
        cloud_quality: spread_of_nodes.map(spread),
        mesh: None,
        smoothing: None,
        quality: None,
        solution: None,
        poisson: None,
        seconds: Seconds::default(),
    }
}

fn local_spacing(cloud: &Cloud, quality: Option<&CloudQuality>) -> Option<LocalSpacingReport> {
    if !cloud.is_graded() {
        return None;
    }
    let asked = (0..cloud.n_nodes()).map(|node| cloud.local_spacing(NodeId::of(node)));
    let (min, max) = asked.fold((f64::INFINITY, 0.0f64), |(min, max), h| (min.min(h), max.max(h)));
    let achieved = quality.and_then(|quality| quality.achieved);
    let achieved = achieved.map(|Achieved { min, median, max }| AchievedReport { min, median, max });
    Some(LocalSpacingReport { min, max, achieved })
}

fn mesh_report(part: &MeshPart) -> SubdomainReport {
    let mesh = &part.mesh;
    let of_quality = |q: &nmt_tri::Quality| QualityReport { min: q.min, mean: q.mean, min_angle_deg: q.min_angle_deg };
    let smoothing =
        part.smoothing.as_ref().map(|s| SmoothingReport { sweeps: s.sweeps, quality_before: of_quality(&s.before) });
    let MeshCensus { delaunay, outside, in_hole, tiny, crossing, completed } = part.census;
    let method = part.method.name();
    SubdomainReport {
        triangles: Some(mesh.n_triangles()),
        mesh: Some(MeshCensusReport { method, delaunay, outside, in_hole, tiny, crossing, completed }),
        area: mesh.total_area(),
        centroid: mesh.centroid(),
        quality: quality(mesh).as_ref().map(of_quality),
        smoothing,
        seconds: Seconds { mesh: Some(0.0), ..Seconds::default() },
        ..cloud_report(&part.name, &part.edge_names, mesh.cloud())
    }
}

fn solved_report(solved: &SolvedPart, tolerance: Option<f64>) -> SubdomainReport {
    let SolvedPart { part, params, solution, estimate, .. } = solved;
    let AlongEdges { edges, loops } = AlongEdges::of(solved);
    let hole = |(name, hole): (&String, &nmt_mfdm::HoleResult)| HoleReport {
        name: name.clone(),
        condition: hole.condition.name(),
        f: hole.f,
        area: hole.area,
    };
    let solution = SolutionReport {
        formulation: params.formulation.name(),
        order: params.order_used(),
        variational: VariationalReport::of(params),
        holes: part.hole_names.iter().zip(&solution.holes).map(hole).collect(),
        unknowns: solution.unknowns,
        j: solution.j,
        torque: solution.torque,
        twist: solution.twist,
        w_t: solution.w_t,
        f_max: solution.f_max.value,
        f_max_at: solution.f_max.at,
        tau_max: solution.tau_max.value,
        tau_max_at: solution.tau_max.at,
        tau_singular_at: singular_vertices(&part.section),
        error_estimate: ErrorEstimateReport::of(solved),
        tolerance: tolerance.and_then(|asked| ToleranceReport::of(solved, asked)),
        edges,
        loops,
        linear_residual: solution.linear.residual,
        linear_solver: LinearSolverReport::of(&solution.linear),
        stars: StarsReport::of(params, &solution.stars),
    };
    SubdomainReport {
        solution: Some(solution),
        seconds: Seconds { estimate: (*estimate != Estimated::NotAsked).then_some(0.0), ..SOLVED },
        ..mesh_report(part)
    }
}

fn poisson_report(solved: &PoissonPart) -> SubdomainReport {
    SubdomainReport { poisson: Some(PoissonReport::of(solved)), seconds: SOLVED, ..mesh_report(&solved.part) }
}
