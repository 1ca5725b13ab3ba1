//! How far the results may be off: bounds of J from the stress function and the warping function together.
//!
//! For every v that vanishes on the boundary 4∫v − ∫|∇v|² ≤ J, and for every σ with ∇·σ = −2 and the circulation 2A around
//! each hole (of any circulation where F = 0 on the hole) J ≤ ∫|σ|²; the difference of the two is ∫|∇v − σ|² (Prager and Synge,
//! Quart. Appl. Math. 5 (1947) 241–269).
//! Here v is the recovered stress function, for Gθ = 1, and σ that of the warping function ([`Warping`]).
//! v does not quite vanish between the boundary's nodes: Green's formula gives what that changes, but for a product of two
//! errors.

use crate::blend::{NodalPolynomials, place};
use crate::boundary_value::recover;
use crate::error::MfdmError;
use crate::gauss::six_points;
use crate::hidden::Hidden;
use crate::lanes::Lanes;
use crate::overshoot::{flatten, has_large};
use crate::parallel::map_chunks;
use crate::params::SolveParams;
use crate::post::torque;
use crate::problem::{Load, TorsionProblem};
use crate::quadrature::RuleLanes;
use crate::solution::TorsionSolution;
use crate::solve::Event;
use crate::solver::LinearSolve;
use crate::true_edges::{ALONG, Piece, Sample, visit_pieces};
use crate::warping::{NodalWarping, StressFrame, Stresses, Warping, elements_params, warping_params};
use nmt_cloud::Section;
use nmt_geom::point::{dot, sub};
use nmt_geom::{LoopId, NodeId, Point, TriId};
use nmt_tri::Mesh;

/// An estimated error of J, as a part of it, beyond which a second warping function is found.
const DOUBTFUL: f64 = 0.005;

/// How far the results of a [`TorsionSolution`] may be off.
#[derive(Clone, Debug, PartialEq)]
pub struct ErrorEstimate {
    /// Of J: its distance from the farther of the bounds; length⁴.
    pub j: f64,
    /// Lower and upper bound of J; length⁴. Their middle is nearer to J than 2∫F as a rule.
    pub j_bounds: [f64; 2],
    /// Of the torque T; 0 where it is given.
    pub torque: f64,
    /// Of the twist θ; 0 where it is given.
    pub twist: f64,
    /// Of τ_max: the difference of both stresses there, and by how much either exceeds it anywhere at the nodes and on the
    /// edges; stress. Where the exact τ is infinite it says nothing.
    pub tau_max: f64,
    /// What each triangle contributes, shape (n_triangles,): ∫|∇v − σ|², whose sum is the difference of the bounds, and at
    /// curved edges what 2∫F lacks beyond the polygon. They tell where nodes are missing; length⁴.
    pub indicators: Vec<f64>,
    /// How the linear system of the warping function was solved.
    pub linear: LinearSolve,
}

impl ErrorEstimate {
    /// [`Self::j`] as a fraction of `j`.
    pub fn relative(&self, j: f64) -> f64 {
        self.j / j.abs()
    }
}

/// Estimates the errors of `solution`, which is that of `problem` on `mesh` with `params`; `section` is what the mesh's
/// cloud was generated from. It costs about as much as the solution; [`crate::solve_estimated`] takes half of that.
///
/// Where holes have F = 0 ([`crate::HoleCondition::Zero`]), J stands for 2∫F/(Gθ), which is no torsion constant but bounded alike:
/// σ then need not have any circulation.
///
/// # Errors
/// As [`crate::solve`]; [`MfdmError::Curve`] where an edge has no length.
///
/// ```
/// use nmt_cloud::{CloudParams, Section, generate};
/// use nmt_curve::Outline;
/// use nmt_mfdm::{SolveParams, TorsionProblem, estimate, exact, solve};
/// use nmt_tri::Mesh;
///
/// let square = Section::solid(Outline::rectangle([0.0, 0.0], [1.0, 1.0]));
/// let cloud = generate(&square, &CloudParams { nodes: [21, 21], irregularity: 0.2, ..CloudParams::default() })?;
/// let mesh = Mesh::constrained(cloud)?;
/// let (problem, params) = (TorsionProblem::default(), SolveParams::default());
/// let solution = solve(&problem, &mesh, &params)?;
/// let estimate = estimate(&problem, &mesh, &square, &params, &solution)?;
/// let [low, high] = estimate.j_bounds;
/// let exact = exact::rectangle(1.0, 1.0).j;
/// assert!(low < exact && exact < high && high - low < 1e-4 * exact);
/// assert!((solution.j - exact).abs() < estimate.j);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn estimate(
    problem: &TorsionProblem,
    mesh: &Mesh,
    section: &Section,
    params: &SolveParams,
    solution: &TorsionSolution,
) -> Result<ErrorEstimate, MfdmError> {
    estimate_observed(problem, mesh, section, params, solution, &mut |_| {})
}

/// [`estimate`], telling `observer` how far the solution for the warping function is.
///
/// # Errors
/// As [`estimate`].
pub fn estimate_observed(
    problem: &TorsionProblem,
    mesh: &Mesh,
    section: &Section,
    params: &SolveParams,
    solution: &TorsionSolution,
    observer: &mut dyn FnMut(Event),
) -> Result<ErrorEstimate, MfdmError> {
    let case = Case { problem, mesh, section, params, solution };
    case.estimate(case.warping(&warping_params(params), observer)?, observer)
}

/// A torsion problem and its solution.
#[derive(Clone, Copy)]
pub(crate) struct Case<'a> {
    pub problem: &'a TorsionProblem,
    pub mesh: &'a Mesh,
    pub section: &'a Section,
    pub params: &'a SolveParams,
    pub solution: &'a TorsionSolution,
}

impl Case<'_> {
    /// The estimate by a warping function; where that leaves J in doubt, as it may in thin walls and at unresolved features, the
    /// best one of those with the linear interpolant of the stress function, with the warping function of linear elements, with
    /// the polynomials through its values, and with two of them: any function gives bounds.
    ///
    /// # Errors
    /// [`MfdmError::Curve`] where an edge has no length, [`MfdmError::Singular`] where a number is none.
    pub fn estimate(&self, warping: Warping, observer: &mut dyn FnMut(Event)) -> Result<ErrorEstimate, MfdmError> {
        let (mut best, warping) = self.without_overshoots(warping)?;
        if best.relative(self.solution.j) <= DOUBTFUL {
            return Ok(best);
        }
        let linear = NodalPolynomials::linear(self.mesh, &self.solution.f);
        let by_linear = self.bounds(&linear, &warping);
        drop(warping);
        let others = self.by_elements(&linear, observer).unwrap_or_default();
        for other in by_linear.into_iter().chain(others) {
            best = if other.j < best.j { other } else { best };
        }
        Ok(best)
    }

    /// The estimates by the warping function of linear elements and by the polynomials through its values; `linear` is the
    /// linear interpolant of the stress function.
    fn by_elements(
        &self,
        linear: &NodalPolynomials,
        observer: &mut dyn FnMut(Event),
    ) -> Result<Vec<ErrorEstimate>, MfdmError> {
        let nodal = self.nodal_warping(&elements_params(self.params), observer)?;
        let polynomials = recover(self.mesh, &warping_params(self.params), [&nodal.values], observer);
        let plane = NodalPolynomials::linear(self.mesh, &nodal.values);
        let warping = nodal.with_field(plane);
        let fields = [&self.solution.field, linear].into_iter();
        let mut found: Vec<ErrorEstimate> = fields.filter_map(|v| self.bounds(v, &warping).ok()).collect();
        if let Ok([field]) = polynomials {
            let recovered = self.without_overshoots(Warping { field, ..warping });
            found.extend(recovered.map(|(estimate, _)| estimate));
        }
        Ok(found)
    }

    /// The estimate by the recovered stress function and a warping function, without what overshoots where that is better; and
    /// the warping function without it.
    fn without_overshoots(&self, warping: Warping) -> Result<(ErrorEstimate, Warping), MfdmError> {
        let Self { mesh, solution, .. } = *self;
        let both = Both { mesh, solution, field: &solution.field, stresses: warping.stresses() };
        let (mut parts, volume) = (both.over_triangles(), solution.field.volume(mesh));
        let best = self.bounds_of(&both, &parts, volume, warping.linear)?;
        if !has_large(&best.indicators) {
            return Ok((best, warping));
        }
        let Warping { field, frame, linear } = warping;
        let (mut fields, rule) = ([solution.field.clone(), field], RuleLanes::from(&six_points()));
        let changed = flatten(mesh, &mut fields, &best.indicators, |[v, w], triangle| {
            let stresses = Stresses { field: w, frame: &frame };
            Both { mesh, solution, field: v, stresses }.over(triangle, &rule).square
        });
        let [v, field] = fields;
        let warping = Warping { field, frame, linear };
        if changed.is_empty() {
            return Ok((best, warping));
        }
        let both = Both { mesh, solution, field: &v, stresses: warping.stresses() };
        changed.iter().for_each(|&triangle| parts[triangle.index()] = both.over(triangle, &rule));
        let volume = volume + v.volume_of(mesh, &changed) - solution.field.volume_of(mesh, &changed);
        let other = self.bounds_of(&both, &parts, volume, linear)?;
        Ok((if other.j < best.j { other } else { best }, warping))
    }

    fn warping(&self, params: &SolveParams, observer: &mut dyn FnMut(Event)) -> Result<Warping, MfdmError> {
        let nodal = self.nodal_warping(params, observer)?;
        let [field] = recover(self.mesh, params, [&nodal.values], observer)?;
        Ok(nodal.with_field(field))
    }

    fn nodal_warping(&self, params: &SolveParams, observer: &mut dyn FnMut(Event)) -> Result<NodalWarping, MfdmError> {
        let frame = StressFrame::of(self.mesh, self.solution);
        NodalWarping::solve(self.mesh, self.section, frame, params, None, observer)
    }

    /// What a field of the stress function and a warping function say of each other.
    ///
    /// # Errors
    /// As [`Self::estimate`].
    fn bounds(&self, field: &NodalPolynomials, warping: &Warping) -> Result<ErrorEstimate, MfdmError> {
        let Self { mesh, solution, .. } = *self;
        let both = Both { mesh, solution, field, stresses: warping.stresses() };
        self.bounds_of(&both, &both.over_triangles(), field.volume(mesh), warping.linear)
    }

    /// [`Self::bounds`] by the integrals over the triangles and ∫v over the polygon, in the solution's unit.
    fn bounds_of(
        &self,
        both: &Both,
        parts: &[Parts],
        volume: f64,
        linear: LinearSolve,
    ) -> Result<ErrorEstimate, MfdmError> {
        let Self { problem, mesh, section, solution, .. } = *self;
        let beyond = Beyond::new(both, section)?;
        let mut indicators: Vec<f64> = parts.iter().map(|own| own.square).collect();
        for &(triangle, [square, _]) in &beyond.slivers {
            indicators[triangle.index()] += square;
        }
        let product = parts.iter().map(|own| own.product).sum::<f64>() + beyond.product;
        let square = indicators.iter().sum::<f64>();
        for &(triangle, [_, lacking]) in &beyond.slivers {
            indicators[triangle.index()] += lacking.abs();
        }
        // ∫∇v·(∇v − σ) is what 4∫v − ∫|∇v|² lies below 2∫v, here over the polygon.
        let (constants, areas): (Vec<f64>, Vec<f64>) =
            solution.holes.iter().map(|hole| (hole.f / solution.g_theta, hole.area)).unzip();
        let low = torque(volume / solution.g_theta, &constants, &areas) - product;
        let j_bounds = [low - beyond.hidden, low + square + beyond.hidden];
        let rounding = f64::EPSILON * mesh.cloud().n_nodes() as f64;
        let j = j_bounds.iter().map(|bound| (bound - solution.j).abs()).fold(rounding * solution.j.abs(), f64::max);
        let relative = j / solution.j.abs();
        let (torque, twist) = match problem.load {
            Load::Twist(_) => (relative * solution.torque.abs(), 0.0),
            Load::Torque(_) => (0.0, relative * solution.twist.abs()),
        };
        let of_load = if twist > 0.0 { relative * solution.tau_max.value } else { 0.0 };
        let tau_max = (both.tau_max(&beyond) + of_load).max(rounding * solution.tau_max.value);
        let numbers = [j, low, square, tau_max];
        if numbers.iter().any(|number| !number.is_finite()) {
            return Err(MfdmError::Singular { n: mesh.cloud().n_nodes() });
        }
        Ok(ErrorEstimate { j, j_bounds, torque, twist, tau_max, indicators, linear })
    }
}

/// Barycentric coordinates of a triangle's own corners.
const WHOLE: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Times that a triangle is parted beside a source.
const MOST_HALVINGS: u32 = 6;

/// A part of a triangle parted by the middles of its sides.
fn quarters([a, b, c]: [[f64; 3]; 3]) -> [[[f64; 3]; 3]; 4] {
    let middle = |p: [f64; 3], q: [f64; 3]| [0, 1, 2].map(|k| (p[k] + q[k]) / 2.0);
    let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
    [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
}

/// Integrals over a triangle.
#[derive(Clone, Copy, Default)]
struct Parts {
    product: f64, // ∫∇v·(∇v − σ)
    square: f64,  // ∫|∇v − σ|²
}

/// The stress function and the warping function of one section.
struct Both<'a> {
    mesh: &'a Mesh,
    solution: &'a TorsionSolution,
    /// v, in the solution's unit.
    field: &'a NodalPolynomials,
    stresses: Stresses<'a>,
}

impl Both<'_> {
    /// [v, ∇v, σ] for Gθ = 1 at `p`, continued from `triangle`.
    fn at(&self, triangle: TriId, p: Point) -> (f64, Point, Point) {
        let (v, gradient) = self.field.slope(self.mesh, triangle, p);
        let scale = 1.0 / self.solution.g_theta;
        (v * scale, gradient.map(|slope| slope * scale), self.stresses.at(self.mesh, triangle, p))
    }

    fn over_triangles(&self) -> Vec<Parts> {
        let (mesh, rule) = (self.mesh, RuleLanes::from(&six_points()));
        let pieces = map_chunks(0..mesh.n_triangles(), |piece| {
            piece.map(|t| self.over(TriId::of(t), &rule)).collect::<Vec<Parts>>()
        });
        pieces.into_iter().flatten().collect()
    }

    fn over(&self, triangle: TriId, rule: &RuleLanes) -> Parts {
        if self.stresses.frame.is_steep(self.mesh.corners(triangle)) {
            self.over_part(triangle, WHOLE, rule, MOST_HALVINGS)
        } else {
            self.by_rule(triangle, rule)
        }
    }

    /// Over the part of a triangle that has these barycentric coordinates at its corners, quarter by quarter where a source is
    /// near.
    fn over_part(&self, triangle: TriId, part: [[f64; 3]; 3], rule: &RuleLanes, halvings: u32) -> Parts {
        let corners = self.mesh.corners(triangle);
        if halvings == 0 || !self.stresses.frame.is_steep(part.map(|lambda| place(corners, lambda))) {
            return self.by_rule(triangle, &rule.of_part(part));
        }
        let mut sum = Parts::default();
        for quarter in quarters(part) {
            let own = self.over_part(triangle, quarter, rule, halvings - 1);
            sum.product += own.product / 4.0;
            sum.square += own.square / 4.0;
        }
        sum
    }

    /// By the mean over the points of a rule.
    fn by_rule(&self, triangle: TriId, rule: &RuleLanes) -> Parts {
        let (v, sigma) =
            (self.field.slopes_at(self.mesh, triangle, rule), self.stresses.at_rule(self.mesh, triangle, rule));
        let (scale, area) = (1.0 / self.solution.g_theta, self.mesh.area(triangle));
        let [mut product, mut square] = [Lanes::default(); 2];
        for ((v, sigma), weight) in v.iter().zip(sigma).zip(rule.weights) {
            let slope = v.gradient.map(|slope| slope * scale);
            let difference = [slope[0] - sigma[0], slope[1] - sigma[1]];
            product += weight * (slope[0] * difference[0] + slope[1] * difference[1]);
            square += weight * (difference[0] * difference[0] + difference[1] * difference[1]);
        }
        Parts { product: area * product.sum(), square: area * square.sum() }
    }

    /// τ at a node by both, and their difference, for Gθ = 1.
    fn at_node(&self, node: NodeId) -> [f64; 3] {
        let v = self.solution.field.at_node(node).gradient.map(|slope| slope / self.solution.g_theta);
        let sigma = self.stresses.at_node(self.mesh, node);
        let difference = sub(v, sigma);
        [v, sigma, difference].map(size)
    }

    /// Largest difference at a node, for Gθ = 1, between the gradient of its own polynomial and those of the nodes it shares
    /// triangles with: where both fields err alike, since section and cloud are symmetric, this one tells.
    fn spread(&self, node: NodeId) -> f64 {
        let (mesh, field) = (self.mesh, &self.solution.field);
        if field.is_linear_interpolant() {
            return 0.0;
        }
        let (at, own) = (mesh.xy()[node.index()], field.at_node(node).gradient);
        let around = mesh.tri_nodes().iter().filter(|nodes| nodes.contains(&node)).flatten();
        let differs = |other: &NodeId| size(sub(field.polynomial(*other, mesh.xy()[other.index()], at).gradient, own));
        around.map(differs).fold(0.0, f64::max) / self.solution.g_theta.abs()
    }

    /// The estimate of τ_max.
    fn tau_max(&self, beyond: &Beyond) -> f64 {
        let [_, _, difference] = self.at_node(self.solution.tau_max.node);
        let difference = difference.max(self.spread(self.solution.tau_max.node));
        let nodes = (0..self.mesh.cloud().n_nodes()).map(NodeId::of);
        let by_warping = nodes.map(|node| self.at_node(node)[1]).fold(0.0, f64::max);
        let found = self.solution.tau_max.value / self.solution.g_theta.abs();
        let exceeds = beyond.largest.max(by_warping) - found;
        self.solution.g_theta.abs() * difference.max(beyond.at_maximum).max(exceeds).max((by_warping - found).abs())
    }
}

/// What the true edges add to the triangles.
struct Beyond {
    /// Over slivers ∫∇v·(∇v − σ) − 2∫(v − c), less ∮(v − c)σ·n over the edges; c the value on the boundary.
    product: f64,
    /// ∫|∇v − σ|² and 2|∫(v − c)| over slivers.
    slivers: Vec<(TriId, [f64; 2])>,
    /// Largest |∇v| or |σ| on the edges.
    largest: f64,
    /// Largest |∇v − σ| on the edges from the node of τ_max to the next ones.
    at_maximum: f64,
    /// What bends of edges that nobody sees may change in J: τ² times the area.
    hidden: f64,
}

impl Beyond {
    fn new(both: &Both, section: &Section) -> Result<Self, MfdmError> {
        let cloud = both.mesh.cloud();
        let mut on_boundary = vec![0.0; cloud.n_boundary()];
        for (k, hole) in both.solution.holes.iter().enumerate() {
            let segments = cloud.boundary().loop_segments(LoopId::of(k + 1));
            segments.iter().for_each(|s| on_boundary[s.from.index()] = hole.f / both.solution.g_theta);
        }
        let mut beyond = Self { product: 0.0, slivers: Vec::new(), largest: 0.0, at_maximum: 0.0, hidden: 0.0 };
        visit_pieces(
            both.mesh,
            section,
            |_| true,
            |segment, piece, triangle| {
                let is_at_maximum = [segment.from, segment.to].contains(&both.solution.tau_max.node);
                let at_maximum = beyond.add(both, piece, triangle, on_boundary[segment.from.index()]);
                if is_at_maximum {
                    beyond.at_maximum = beyond.at_maximum.max(at_maximum);
                }
                Ok(())
            },
        )?;
        Ok(beyond)
    }

    /// Adds the integrals over one piece and its sliver; the largest |∇v − σ| on it.
    fn add(&mut self, both: &Both, piece: &Piece, triangle: TriId, c: f64) -> f64 {
        let mut largest_difference: f64 = 0.0;
        let (mut by_v, mut by_warping) = ([[0.0; 2]; ALONG.len() + 2], [[0.0; 2]; ALONG.len() + 2]);
        let ends = [(0.0, piece.point(0.0), 0.0), (1.0, piece.point(1.0), 0.0)];
        let [start, finish] = ends;
        for (k, (s, at, ds)) in std::iter::once(start).chain(piece.along()).chain([finish]).enumerate() {
            let (v, slope, sigma) = both.at(triangle, at);
            self.product -= ds * (v - c) * dot(sigma, piece.normal(s));
            largest_difference = largest_difference.max(size(sub(slope, sigma)));
            (by_v[k], by_warping[k]) = ([s, size(slope)], [s, size(sigma)]);
        }
        let stress = peak(&by_v).max(peak(&by_warping));
        self.largest = self.largest.max(stress);
        let mut sums = [0.0; 2];
        for Sample { at, weight, .. } in piece.sliver(triangle) {
            let (v, slope, sigma) = both.at(triangle, at);
            let difference = sub(slope, sigma);
            self.product += weight * (dot(slope, difference) - 2.0 * (v - c));
            sums[0] += weight * dot(difference, difference);
            sums[1] += 2.0 * weight * (v - c);
        }
        if let Some(hidden) = Hidden::of(piece) {
            // The derivative of J, as the boundary moves outwards, is ∮τ² (Hadamard).
            let of_area = stress * stress * hidden.area;
            self.hidden += of_area;
            sums[1] += of_area;
            self.largest = self.largest.max(stress * (1.0 + hidden.concentration));
        }
        if !piece.is_straight {
            self.slivers.push((triangle, sums));
        }
        largest_difference
    }
}

fn size(g: Point) -> f64 {
    g[0].hypot(g[1])
}

/// The largest value of (abscissa, value), ascending: the top of the parabola through the largest and its neighbours.
fn peak(values: &[[f64; 2]]) -> f64 {
    let larger = |a: usize, b: usize| if values[b][1] > values[a][1] { b } else { a };
    let top = (0..values.len()).reduce(larger).unwrap_or(0);
    let Some(&[left, middle, right]) = top.checked_sub(1).and_then(|first| values.get(first..first + 3)?.first_chunk())
    else {
        return values.get(top).map_or(0.0, |[_, value]| *value);
    };
    // Divided differences about the middle; the second is negative or 0.
    let [by_left, by_right] = [left, right].map(|[x, value]| (value - middle[1]) / (x - middle[0]));
    let curvature = (by_right - by_left) / (right[0] - left[0]);
    let slope = by_left + curvature * (middle[0] - left[0]);
    if curvature < 0.0 { middle[1] - slope * slope / (4.0 * curvature) } else { middle[1] }
}
