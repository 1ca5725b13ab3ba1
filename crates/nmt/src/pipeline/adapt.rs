//! Solving to a tolerance: refine where the estimate says that nodes are missing, and solve again.
//!
//! Every triangle shall contribute as much to the error of J as any other: that is the cloud with the fewest nodes. What a
//! triangle contributes falls by h^(2p+2) where F is smooth, and at a corner of interior angle ω by h^(2π/ω), so that
//! nodes are asked for by both laws, the corners' spacing at once and not by halves.

use super::{Event, elimination_fault, torsion_fault};
use super::{Finer, MeshPart, Observer, SolvedPart, clouds_of, mesh_of, solution_of};
use crate::error::NmtError;
use crate::problem::Problem;
use crate::report::vertex_angles;
use nmt_cloud::{DEFAULT_GROWTH, MIN_SPACING_REL, Refinement, Target};
use nmt_geom::point::distance;
use nmt_geom::{NodeId, Point};
use nmt_mfdm::{ErrorEstimate, Formulation};
use nmt_tri::NodeTris;
use std::error::Error;
use std::f64::consts::PI;

/// One solution on the way to a tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// Nodes of its cloud.
    pub nodes: usize,
    /// Its J.
    pub j: f64,
    /// The estimated error of J as a fraction of it; infinite where the cloud is too coarse for an estimate.
    pub error: f64,
}

/// Why no finer cloud was solved although the tolerance is not met.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Stop {
    /// It would have more nodes than allowed.
    #[error(
        "the next cloud would have more than {most} nodes; allow more (max_nodes, --max-nodes), give a larger tolerance, or order = 4"
    )]
    Nodes {
        /// What is allowed.
        most: usize,
    },
    /// Many have been solved.
    #[error("{clouds} clouds have been solved; give a larger tolerance, a finer first cloud, or order = 4")]
    Clouds {
        /// How many.
        clouds: usize,
    },
    /// It was tried and failed; of conforming subdomains that of one ends all.
    #[error("the next cloud failed: {}; give a larger tolerance, or another first cloud", with_causes(.0))]
    Failed(NmtError),
}

/// An error and what it comes from, in one line.
fn with_causes(error: &NmtError) -> String {
    let mut line = error.to_string();
    let mut cause = error.source();
    while let Some(error) = cause {
        line = format!("{line}: {error}");
        cause = error.source();
    }
    line.replace('\n', "; ")
}

/// Clouds after which it is given up.
const MOST_STEPS: usize = 14;

/// By how much the number of nodes grows in one step, at most: what coarse clouds foretell is not to be relied on.
const MOST_GROWTH: f64 = 4.0;

/// By how much it may grow with what lies between fine places and coarse ones. That is foretold only beyond this: elsewhere it is
/// little.
const MOST_GRADED_GROWTH: f64 = 6.0;

/// Passes over the nodes, to and fro, in which a small spacing is felt around it.
const PASSES: usize = 4;

/// By how much it grows at least: what is nearly good enough shall not be solved again and again.
const LEAST_GROWTH: f64 = 1.6;

/// The spacing in one step becomes this part of what it was, at least; at corners with a law of their own, that below.
const LEAST_FACTOR: f64 = 0.125;
const LEAST_CORNER_FACTOR: f64 = 1.0e-3;

/// It becomes coarser by this factor, at most.
const MOST_FACTOR: f64 = 1.4;

/// The part of the tolerance that is aimed at, so that it is not missed by a hair and solved once more.
const AIM: f64 = 0.6;

/// The part of it that all corners together may have.
const CORNERS: f64 = 0.05;

/// An exponent of a corner this near to a whole number is that number.
const WHOLE_WITHIN: f64 = 1.0e-9;

/// Solves torsion in all subdomains, each on clouds that are refined until the estimated error of its J is at most
/// `tolerance`·J, or until that would take more nodes than [`crate::problem::SolveSettings::max_nodes`]: then the best of
/// them, or of conforming subdomains the last, whose clouds fit together. [`Step::of`] the solution tells, and
/// [`SolvedPart::stop`] why it is not met.
///
/// The first clouds are those of the file; refined ones are never coarser than that spacing, and grow away from where they
/// are refined as the file's do.
///
/// # Errors
/// As [`super::clouds`], [`super::meshes`] and [`super::solutions`], for the first clouds; those of finer ones end the
/// refinement of their subdomain.
pub fn to_tolerance(problem: &Problem, tolerance: f64, observer: &mut Observer) -> Result<Vec<SolvedPart>, NmtError> {
    if let Some(fault) = torsion_fault(problem, "has no torsion", "leave it out, or call solve_any") {
        return Err(NmtError::Problem(vec![fault]));
    }
    refined(problem, tolerance, observer, &mut |finer, wanted, observer| round(problem, finer, wanted, observer))
}

/// Makes solutions of the subdomains that are wanted, on clouds refined beyond the file.
type Round<'a> = dyn FnMut(&Finer, &[bool], &mut Observer) -> Result<Vec<(usize, SolvedPart)>, NmtError> + 'a;

/// [`to_tolerance`] by `round`.
fn refined(
    problem: &Problem,
    tolerance: f64,
    observer: &mut Observer,
    round: &mut Round,
) -> Result<Vec<SolvedPart>, NmtError> {
    let n = problem.subdomains.len();
    let is_conforming = problem.subdomains.iter().any(|subdomain| subdomain.conforming);
    let mut finer = Finer(vec![Vec::new(); n]);
    let mut ways: Vec<Way> = (0..n).map(|_| Way::default()).collect();
    let mut wanted = vec![true; n];
    for step in 0..MOST_STEPS {
        // First ones are told all their faults at once, and conforming ones need each other.
        let groups = if step == 0 || is_conforming { vec![wanted.clone()] } else { each_alone(&wanted) };
        for group in groups {
            match round(&finer, &group, observer) {
                Ok(parts) => {
                    for (k, part) in parts {
                        observer(k, Event::Step(Step::of(&part)));
                        ways[k].add(part);
                    }
                }
                Err(error) if step == 0 => return Err(error),
                // What has been found so far stands, and says that it does not meet the tolerance.
                Err(error) => {
                    let failed = ways.iter_mut().zip(group).filter(|(_, is_of_it)| *is_of_it);
                    failed.for_each(|(way, _)| way.stop = Some(Stop::Failed(error.clone())));
                }
            }
        }
        for (k, way) in ways.iter_mut().enumerate() {
            wanted[k] = false;
            if matches!(way.stop, Some(Stop::Failed(_))) {
                continue;
            }
            let (most, growth) = (problem.solve.max_nodes, growth(problem, k));
            way.stop = None;
            match way.latest.as_ref().map_or(Next::Met, |part| next(part, tolerance, most, growth)) {
                Next::Met => {}
                Next::TooLarge => way.stop = Some(Stop::Nodes { most }),
                Next::Finer(refinements) => (wanted[k], finer.0[k]) = (true, refinements),
            }
        }
        if !wanted.contains(&true) {
            break;
        }
        if is_conforming {
            // Its neighbours have the nodes of a finer side too.
            wanted.fill(true);
        }
    }
    // Conforming clouds fit together only if they are of one round.
    let of = |way: Way| {
        let stop = way.stop.clone().unwrap_or(Stop::Clouds { clouds: MOST_STEPS });
        let part = if is_conforming { way.newest() } else { way.best() }?;
        let is_met = Step::of(&part).error <= tolerance;
        Some(SolvedPart { stop: (!is_met).then_some(stop), ..part })
    };
    Ok(ways.into_iter().filter_map(of).collect())
}

/// Those that are wanted, one by one.
fn each_alone(wanted: &[bool]) -> Vec<Vec<bool>> {
    let alone = |k: usize| (0..wanted.len()).map(|other| other == k).collect();
    (0..wanted.len()).filter(|k| wanted[*k]).map(alone).collect()
}

/// How fast the spacing of subdomain `k` grows away from where it is refined.
fn growth(problem: &Problem, k: usize) -> f64 {
    problem.subdomains[k].grading.as_ref().map_or(DEFAULT_GROWTH, |grading| grading.growth)
}

/// The solutions of one subdomain.
#[derive(Default)]
struct Way {
    latest: Option<SolvedPart>,
    /// The best before the latest.
    before: Option<SolvedPart>,
    history: Vec<Step>,
    /// Why there is no next cloud although the tolerance is not met.
    stop: Option<Stop>,
}

impl Way {
    fn add(&mut self, part: SolvedPart) {
        self.history.push(Step::of(&part));
        self.before = better(self.before.take(), self.latest.take());
        self.latest = Some(part);
    }

    fn best(self) -> Option<SolvedPart> {
        let best = better(self.before, self.latest)?;
        Some(SolvedPart { history: self.history, ..best })
    }

    fn newest(self) -> Option<SolvedPart> {
        Some(SolvedPart { history: self.history, ..self.latest? })
    }
}

/// The one whose estimate is smaller; of two alike the later one.
fn better(a: Option<SolvedPart>, b: Option<SolvedPart>) -> Option<SolvedPart> {
    match (a, b) {
        (Some(a), Some(b)) => Some(if Step::of(&a).error < Step::of(&b).error { a } else { b }),
        (a, b) => a.or(b),
    }
}

/// The subdomains that are wanted, from cloud to estimate.
fn round(
    problem: &Problem,
    finer: &Finer,
    wanted: &[bool],
    observer: &mut Observer,
) -> Result<Vec<(usize, SolvedPart)>, NmtError> {
    let clouds = clouds_of(problem, finer, wanted, observer)?;
    let numbers = (0..wanted.len()).filter(|k| wanted[*k]);
    let mut meshes: Vec<(usize, MeshPart)> = Vec::new();
    for (k, cloud) in numbers.zip(clouds) {
        meshes.push((k, mesh_of(problem, k, cloud, observer)?));
    }
    if let Some(fault) = meshes.iter().find_map(|(_, part)| elimination_fault(problem, part)) {
        return Err(NmtError::Problem(vec![fault]));
    }
    meshes.into_iter().map(|(k, part)| Ok((k, solution_of(problem, k, part, observer)?))).collect()
}

impl Step {
    /// The step that a solution is.
    pub fn of(solved: &SolvedPart) -> Self {
        let error = solved.estimate.made().map_or(f64::INFINITY, |estimate| estimate.relative(solved.solution.j));
        Self { nodes: solved.part.mesh.cloud().n_nodes(), j: solved.solution.j, error }
    }
}

/// What a solution calls for.
enum Next {
    /// Nothing: it meets the tolerance.
    Met,
    /// A cloud with more nodes than allowed.
    TooLarge,
    /// A cloud refined to these.
    Finer(Vec<Refinement>),
}

/// What the next cloud shall be, its spacing growing by `growth`.
fn next(solved: &SolvedPart, tolerance: f64, most_nodes: usize, growth: f64) -> Next {
    let cloud = solved.part.mesh.cloud();
    let (spacing, least) = (spacings(solved), least_spacing(solved));
    let (factors, corners) = match solved.estimate.made() {
        Some(estimate) if estimate.relative(solved.solution.j) <= tolerance => return Next::Met,
        Some(estimate) => {
            let sought = Sought::new(solved, estimate, tolerance);
            (sought.factors(&spacing, growth), sought.corners(growth))
        }
        // Too coarse to say anything: half the spacing everywhere.
        None => (vec![0.5; cloud.n_nodes()], Vec::new()),
    };
    let nodes: f64 = factors.iter().map(|factor| factor.powi(-2)).sum();
    if nodes > most_nodes as f64 {
        return Next::TooLarge;
    }
    let at = |(node, factor): (usize, f64)| Refinement {
        target: Target::Point(cloud.xy()[node]),
        size: (factor * spacing[node]).max(least),
        growth,
    };
    let everywhere = factors.into_iter().enumerate().map(at);
    Next::Finer(everywhere.chain(corners).collect())
}

/// The spacing at every node of a graded cloud; of one with unequal h_x and h_y that of a square lattice as dense, since graded
/// ones are such lattices.
fn spacings(solved: &SolvedPart) -> Vec<f64> {
    let cloud = solved.part.mesh.cloud();
    let [h_x, h_y] = cloud.spacing();
    let even = (h_x * h_y).sqrt();
    let of_node = |node: usize| cloud.local_spacing(NodeId::of(node));
    (0..cloud.n_nodes()).map(|node| if cloud.is_graded() { of_node(node) } else { even }).collect()
}

/// The least spacing of a cloud, and some room to it.
fn least_spacing(solved: &SolvedPart) -> f64 {
    2.0 * MIN_SPACING_REL * solved.part.section.contour.envelope().size()
}

/// What is sought: contributions that sum to less than the tolerance, and are all alike.
struct Sought<'a> {
    solved: &'a SolvedPart,
    node_tris: NodeTris,
    indicators: &'a [f64],
    /// p, the order of the gradient.
    order: f64,
    /// What all triangles shall contribute together.
    all: f64,
}

/// True of an exponent that is that of a smooth function, up to the rounding of angles between tangent arcs.
fn is_whole(exponent: f64) -> bool {
    (exponent - exponent.round()).abs() < WHOLE_WITHIN
}

impl<'a> Sought<'a> {
    fn new(solved: &'a SolvedPart, estimate: &'a ErrorEstimate, tolerance: f64) -> Self {
        let mesh = &solved.part.mesh;
        let sum: f64 = estimate.indicators.iter().sum();
        // Where the estimate is larger than the sum of what the triangles contribute, both fall together.
        let share = (estimate.j / sum).max(1.0);
        let order = match solved.params.formulation {
            Formulation::Fem => 1.0,
            Formulation::Local | Formulation::Variational => solved.params.order as f64,
        };
        Self {
            solved,
            node_tris: NodeTris::new(mesh.cloud().n_nodes(), mesh.tri_nodes()),
            indicators: &estimate.indicators,
            order,
            all: AIM * tolerance * solved.solution.j.abs() / share,
        }
    }

    /// New spacing over old at every node, that being `spacing`; the new one grows by `rise` a unit of length.
    fn factors(&self, spacing: &[f64], rise: f64) -> Vec<f64> {
        // N = S·τ^(−1/(p+1)) triangles that contribute τ each; N·τ = all.
        let power = 1.0 / (self.order + 1.0);
        let sum: f64 = self.indicators.iter().map(|own| own.powf(power)).sum();
        let each = (self.all / sum).powf((self.order + 1.0) / self.order);
        let factor_of = |each: f64, own: f64| match own > 0.0 {
            true => (each / own).powf(0.5 * power).clamp(LEAST_FACTOR, MOST_FACTOR),
            false => MOST_FACTOR,
        };
        let growth = |each: f64| {
            self.indicators.iter().map(|own| factor_of(each, *own).powi(-2)).sum::<f64>() / self.indicators.len() as f64
        };
        // Within what one step may add: larger or smaller contributions, by bisection of their logarithm.
        let bounded = growth(each).clamp(LEAST_GROWTH, MOST_GROWTH);
        let each = if growth(each) == bounded { each } else { self.each_for(bounded, growth) };
        let n_nodes = self.solved.part.mesh.cloud().n_nodes();
        let largest: Vec<f64> = (0..n_nodes).map(|node| self.around(node).fold(0.0, f64::max)).collect();
        let factors = |each: f64| largest.iter().map(|own| factor_of(each, *own)).collect::<Vec<_>>();
        let graded_growth = |each: f64| self.graded_growth(spacing, &factors(each), rise);
        // A few triangles much worse than all others bring many nodes along with them.
        let each = match graded_growth(each) > MOST_GRADED_GROWTH {
            true => self.each_for(MOST_GROWTH, graded_growth).max(each),
            false => each,
        };
        factors(each)
    }

    /// By how much the number of nodes grows, with those that the rise of the spacing from fine places brings.
    fn graded_growth(&self, spacing: &[f64], factors: &[f64], rise: f64) -> f64 {
        let mesh = &self.solved.part.mesh;
        let mut new: Vec<f64> = spacing.iter().zip(factors).map(|(h, factor)| h * factor).collect();
        let feel = |new: &mut [f64], node: usize| {
            for &t in self.node_tris.around(NodeId::of(node)) {
                for other in mesh.tri_nodes()[t.index()] {
                    let apart = distance(mesh.xy()[node], mesh.xy()[other.index()]);
                    new[node] = new[node].min(new[other.index()] + rise * apart);
                }
            }
        };
        for _ in 0..PASSES {
            (0..new.len()).for_each(|node| feel(&mut new, node));
            (0..new.len()).rev().for_each(|node| feel(&mut new, node));
        }
        spacing.iter().zip(&new).map(|(h, new)| (h / new).powi(2)).sum::<f64>() / spacing.len() as f64
    }

    /// The contribution with which the number of nodes grows by `wanted`.
    fn each_for(&self, wanted: f64, growth: impl Fn(f64) -> f64) -> f64 {
        let positive = self.indicators.iter().copied().filter(|own| *own > 0.0);
        let (least, most) = positive.fold((f64::MAX, f64::MIN_POSITIVE), |(a, b), own| (a.min(own), b.max(own)));
        // With these every triangle becomes as small, or as large, as it may.
        let margin = LEAST_FACTOR.powf(2.0 * self.order + 2.0);
        let (mut low, mut high) = ((least * margin).max(f64::MIN_POSITIVE).ln(), (most / margin).ln());
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if growth(middle.exp()) > wanted { low = middle } else { high = middle }
        }
        high.exp()
    }

    fn around(&self, node: usize) -> impl Iterator<Item = f64> + '_ {
        self.node_tris.around(NodeId::of(node)).iter().map(|t| self.indicators[t.index()])
    }

    /// Refinements at the vertices whose singularity limits the order: r^(π/ω) with π/ω < p + 1.
    fn corners(&self, growth: f64) -> Vec<Refinement> {
        let cloud = self.solved.part.mesh.cloud();
        let angles = vertex_angles(&self.solved.part.section);
        let limiting: Vec<(Point, f64)> = angles
            .into_iter()
            .map(|(at, angle)| (at, PI / angle))
            .filter(|(_, exponent)| *exponent < self.order + 1.0 && !is_whole(*exponent))
            .collect();
        let each = CORNERS * self.all / limiting.len().max(1) as f64;
        let refinement = |(at, exponent): &(Point, f64)| {
            let node = (0..cloud.n_vertices()).find(|node| cloud.xy()[*node] == *at)?;
            let own: f64 = self.around(node).sum();
            let factor = (each / own).powf(0.5 / exponent).max(LEAST_CORNER_FACTOR);
            let size = (factor * cloud.local_spacing(NodeId::of(node))).max(least_spacing(self.solved));
            (factor < 1.0).then_some(Refinement { target: Target::Point(*at), size, growth })
        };
        limiting.iter().filter_map(refinement).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::Overrides;
    use nmt_mfdm::MfdmError;

    /// Two L's, and rounds of which that of "b" fails when it comes to the second.
    fn solved(conforming: &str) -> (Vec<SolvedPart>, usize) {
        let shape = |name: &str, x: f64| {
            let at = |p: [f64; 2]| format!("[{}, {}]", p[0] + x, p[1]);
            let corners = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]].map(at).join(", ");
            format!("[[subdomain]]\nname = \"{name}\"\nnodes = [15, 15]\n{conforming}\noutline = [{corners}]\n")
        };
        let text = format!("{}{}[solve]\ntolerance = 1e-4\n", shape("a", 0.0), shape("b", 2.0));
        let problem = Problem::parse("t.toml", &text, &Overrides::default()).expect("a sound problem");
        let mut rounds_of_b = 0;
        let mut with_failure = |finer: &Finer, wanted: &[bool], observer: &mut Observer| {
            rounds_of_b += usize::from(wanted[1]);
            if wanted[1] && rounds_of_b > 1 {
                return Err(NmtError::Solve { subdomain: "b".into(), source: MfdmError::Singular { n: 7 } });
            }
            round(&problem, finer, wanted, observer)
        };
        let solved = refined(&problem, 1e-4, &mut |_, _| {}, &mut with_failure).expect("first solutions");
        (solved, rounds_of_b)
    }

    #[test]
    fn a_later_cloud_that_fails_ends_the_way_of_its_subdomain_and_is_told() {
        let (apart, rounds) = solved("");
        assert_eq!(rounds, 2, "what failed is not tried again");
        assert!(apart[0].history.len() > 1 && Step::of(&apart[0]).error <= 1e-4 && apart[0].stop.is_none());
        assert!(apart[1].history.len() == 1 && Step::of(&apart[1]).error > 1e-4);
        let told = apart[1].stop.as_ref().map(Stop::to_string).unwrap_or_default();
        assert!(told.starts_with("the next cloud failed: ") && told.contains('7'), "{told}");

        // Clouds of different rounds do not fit together.
        let (conforming, _) = solved("conforming = true");
        assert!(conforming.iter().all(|part| part.history.len() == 1 && part.stop.is_some()));
    }
}
