//! What stars are chosen from: the nodes of a cloud in the coordinates that distances are measured in, and what hides
//! them from each other.

use crate::visibility::Visibility;
use nmt_cloud::{Cloud, Nearest};
use nmt_geom::tol::SAME_POINT_REL;
use nmt_geom::{LoopId, NodeId, Point};
use std::borrow::Cow;
use std::f64::consts::PI;

/// Spacings whose ratio is at most this count as equal, and distances are plain.
///
/// Up to 1.25 the nearest nine nodes of an irregular cloud make as good a star as on a square lattice (J of a rectangle
/// to 4e-5 over 30 seeds, τ_max to 6e-4); at 1.5 they lose a digit, at 2 they are three rows and τ_max comes out 40 times
/// too large.
const EQUAL_SPACINGS: f64 = 1.25;

/// Above this ratio distances are plain again, and stars larger.
///
/// The clearances go by the larger spacing: beside the boundary they leave a strip half of that wide without nodes. In
/// stretched distances a star at such a strip would lie on one side of it.
const STRETCHABLE: f64 = 2.0;

/// Stars grow by at most this factor: at spacings of a ratio of 6 and more they are as large as they need to be.
const MAX_STAR_FACTOR: f64 = 4.0;

/// The coordinates that distances between nodes are measured in: x and y stretched so that h_x and h_y are equal.
///
/// A cloud of moderately unequal spacings then has the stars of a square one, and its polynomials their condition.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Metric {
    stretch: [f64; 2],
    ratio: f64, // of the spacings as stretched, at least 1
}

impl Metric {
    /// The metric of a cloud: stretched where the ratio of its spacings is between 1.25 and 2, and beyond where its
    /// clearances are scaled, so that no strip along the boundary is bare.
    ///
    /// A graded cloud is square already.
    pub fn of(cloud: &Cloud) -> Self {
        if cloud.is_graded() {
            return Self::plain();
        }
        let h = cloud.max_spacing();
        let stretch = cloud.spacing().map(|own| if own > 0.0 { h / own } else { 1.0 });
        let ratio = stretch[0].max(stretch[1]);
        let scaled = cloud.clearance().stretch != [1.0; 2];
        if above(ratio, EQUAL_SPACINGS) && (scaled || !above(ratio, STRETCHABLE)) {
            return Self { stretch, ratio: 1.0 };
        }
        Self { stretch: [1.0, 1.0], ratio }
    }

    /// The user's own coordinates.
    pub(crate) fn plain() -> Self {
        Self { stretch: [1.0; 2], ratio: 1.0 }
    }

    /// Factors of x and y, each at least 1.
    pub fn stretch(&self) -> [f64; 2] {
        self.stretch
    }

    /// Nodes in a star whose usual size is `usual`: at a ratio of 3 the nearest 9 nodes are almost one row, 20 are three
    /// of them.
    pub fn star_size(&self, usual: usize) -> usize {
        if !above(self.ratio, STRETCHABLE) {
            return usual;
        }
        let larger = usual as f64 * (1.0 + self.ratio / 2.0).min(MAX_STAR_FACTOR);
        (larger * (1.0 + SAME_POINT_REL)) as usize
    }

    /// A point, or a difference of points, in stretched coordinates.
    #[inline]
    pub fn stretched(&self, p: Point) -> Point {
        [p[0] * self.stretch[0], p[1] * self.stretch[1]]
    }
}

/// True where `ratio` is above `limit` by more than rounding: units must not decide at a ratio of exactly 2.
fn above(ratio: f64, limit: f64) -> bool {
    ratio > limit * (1.0 + SAME_POINT_REL)
}

/// The nodes of a cloud as stars see them.
#[derive(Clone, Debug)]
pub struct Surroundings<'a> {
    xy: &'a [Point],
    stretched: Cow<'a, [Point]>,
    metric: Metric,
    visibility: Visibility,
    clump_from: Vec<f64>, // shape (n_boundary,), see [`Surroundings::is_clumped`]
    n_boundary: usize,
}

/// A hole is a clump of nodes to stars whose nodes are spaced by this part of its extent and more.
///
/// Measured on a plate of 25 to 100 nodes across with one hole, on two with 128 holes, and on the sections of the verification,
/// which have no such hole: 0.7 leaves none of the largest errors, 0.5 gains nothing more and 1 leaves some.
const CLUMP: f64 = 0.7;

/// For every boundary node the spacing of a star from which on its hole is a clump in it; ∞ on the contour.
fn clump_from(cloud: &Cloud, stretched: &[Point]) -> Vec<f64> {
    let mut from = vec![f64::INFINITY; cloud.n_boundary()];
    for hole in 1..cloud.boundary().n_loops() {
        let nodes = cloud.boundary().loop_segments(LoopId::of(hole)).iter().map(|segment| segment.from.index());
        let extent = [0, 1].map(|d| {
            let along = nodes.clone().map(|node| stretched[node][d]);
            along.clone().fold(f64::NEG_INFINITY, f64::max) - along.fold(f64::INFINITY, f64::min)
        });
        nodes.for_each(|node| from[node] = CLUMP * extent[0].max(extent[1]));
    }
    from
}

impl<'a> Surroundings<'a> {
    /// Prepares the search for stars in `cloud`.
    pub fn new(cloud: &'a Cloud) -> Self {
        let metric = Metric::of(cloud);
        let stretched = match metric.stretch() {
            [1.0, 1.0] => Cow::Borrowed(cloud.xy()),
            _ => cloud.xy().iter().map(|p| metric.stretched(*p)).collect(),
        };
        let clump_from = clump_from(cloud, &stretched);
        let (visibility, n_boundary) = (Visibility::new(cloud), cloud.n_boundary());
        Self { xy: cloud.xy(), stretched, metric, visibility, clump_from, n_boundary }
    }

    /// An index of the nodes by their stretched coordinates.
    pub fn nearest(&self) -> Nearest<'_> {
        Nearest::new(&self.stretched)
    }

    /// Nodes 0 … n_boundary − 1 lie on the boundary.
    pub fn n_boundary(&self) -> usize {
        self.n_boundary
    }

    /// Coordinates, shape (n_nodes, 2), user's length unit.
    pub fn xy(&self) -> &'a [Point] {
        self.xy
    }

    /// Stretched coordinates, shape (n_nodes, 2): those of stars and polynomials.
    pub fn stretched(&self) -> &[Point] {
        &self.stretched
    }

    /// The metric.
    pub fn metric(&self) -> Metric {
        self.metric
    }

    /// Whether two nodes or more of a star, ascending, are those of holes smaller than its nodes are spaced: many of the nearest
    /// nodes then lie at one place.
    #[inline]
    pub(crate) fn is_clumped(&self, star: &[NodeId], radius: f64) -> bool {
        // Most stars have no node on the boundary.
        if star.get(1).is_none_or(|node| node.index() >= self.n_boundary) {
            return false;
        }
        let spacing = radius * (PI / star.len() as f64).sqrt();
        let on_boundary = star.iter().take_while(|node| node.index() < self.n_boundary);
        on_boundary.filter(|node| self.clump_from[node.index()] < spacing).count() >= 2
    }

    /// True where nothing hides nodes within the stretched distance `radius` of `at`: stretching only lengthens.
    pub(crate) fn all_visible(&self, at: Point, radius: f64) -> bool {
        self.visibility.all_within(at, radius)
    }

    /// True where `node` is visible from the place `at` (user's coordinates) within the material.
    pub fn sees_from(&self, at: Point, node: NodeId) -> bool {
        self.visibility.sees_from(at, self.xy[node.index()])
    }

    /// True where `other` is visible from `centre`.
    pub fn sees(&self, centre: NodeId, other: NodeId) -> bool {
        self.visibility.sees(self.xy, centre, other)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nmt_cloud::{ClearanceUnit, CloudParams, Section, generate};
    use nmt_curve::Outline;

    #[test]
    fn nearly_equal_spacings_are_left_alone_and_others_become_equal() {
        let metric = |nodes: [usize; 2]| {
            let plate = Section::solid(Outline::rectangle([0.0, 0.0], [2.0, 1.0]));
            let cloud = generate(&plate, &CloudParams { nodes, ..CloudParams::default() }).expect("a cloud");
            Metric::of(&cloud).stretch()
        };
        assert_eq!(metric([41, 21]), [1.0, 1.0]);
        assert_eq!(metric([41, 25]), [1.0, 1.0]);
        assert_eq!(metric([41, 41]), [1.0, 2.0]);
        assert_eq!(metric([21, 21]), [1.0, 2.0]);
        assert_eq!(metric([21, 81]), [1.0, 1.0]);
        let scaled = CloudParams { nodes: [21, 81], clearance: ClearanceUnit::Scaled, ..CloudParams::default() };
        let cloud = generate(&Section::solid(Outline::rectangle([0.0, 0.0], [2.0, 1.0])), &scaled).expect("a cloud");
        assert_eq!((Metric::of(&cloud).stretch(), Metric::of(&cloud).star_size(9)), ([1.0, 8.0], 9));
    }
}
