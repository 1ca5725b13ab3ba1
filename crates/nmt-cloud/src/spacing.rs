//! The spacing of a graded cloud at every place: a function, limited in its growth, and what grows from points and edges.

use crate::error::CloudError;
use crate::grading::{Grading, MIN_SPACING_REL, Refinement, STEEPEST, SpacingFunction, Target};
use crate::gradual::{FirstLook, steep_places};
use crate::nested::NestedLattice;
use crate::section::{CloudParams, GivenNode, Section};
use crate::sources::{Source, SourceTree};
use nmt_curve::{ArcTable, CLOSED_NODES_LEAST, CURVED_NODES_LEAST, Curve, OutlineEdge};
use nmt_geom::{Bbox, EdgeId, Location, Locator, Point};

/// The chords that a curved edge is replaced by leave it by at most this fraction of the spacing along it.
const CHORD_REL: f64 = 0.02;

/// Chords for the section, where it is asked whether a place is in it, as a fraction of the size.
const SECTION_CHORD_REL: f64 = 1.0e-6;

/// h(x, y): the least of all that a [`Grading`] and the section ask for, and at most the uniform spacing.
///
/// |∇h| is at most the largest growth, up to the resolution at which a function is looked at: a grid of 64 cells across at
/// least, and finer wherever the function varies much or asks for less, or may do so by its lower bound.
#[derive(Clone, Debug)]
pub struct Spacing {
    function: Option<(Asked, FirstLook)>, // and what has been seen of it
    sources: SourceTree,
    lattice: NestedLattice,
    most: f64,
    least: f64,
    finest: f64,
    may_miss_dips: bool,
}

/// A function that is asked for a spacing.
#[derive(Clone, Debug)]
pub(crate) struct Asked {
    function: SpacingFunction,
    section: Locator,
    chord: f64, // by which the section may differ from that
    most: f64,
    least: f64,
}

impl Asked {
    /// The function's spacing at `p`, within the bounds; outside the section, where it has none, the upper one.
    ///
    /// # Errors
    /// [`CloudError::NotASpacing`] where it is not a positive number, in the section.
    pub fn at(&self, p: Point) -> Result<f64, CloudError> {
        let value = self.function.at(p);
        if value > 0.0 && value < f64::INFINITY {
            return Ok(value.clamp(self.least, self.most));
        }
        match self.section.locate(p) {
            Location::Outside => Ok(self.most),
            Location::Inside | Location::OnBoundary => Err(CloudError::NotASpacing { at: p, value }),
        }
    }

    /// What the function is not less than in a rectangle, where that is known; within the bounds.
    pub fn lower_bound(&self, rectangle: Bbox, enough: f64) -> Option<f64> {
        self.function.lower_bound(rectangle, enough).map(|bound| bound.clamp(self.least, self.most))
    }

    /// Whether what the function is within `radius` of `p` concerns nobody: the section is not there.
    pub fn is_outside(&self, p: Point, radius: f64) -> bool {
        self.section.misses_disc(p, radius + self.chord)
    }
}

impl Spacing {
    /// The spacing that `params` ask for in `section`: the uniform one where they hold no [`Grading`].
    ///
    /// The uniform one is max(h_x, h_y), or a little less, so that a whole number of squares fits, and at most half of the
    /// shorter side of the envelope.
    ///
    /// # Errors
    /// [`CloudError`] where a number is out of its range, an edge cannot be measured, or the function is not a positive
    /// number somewhere in the section.
    pub fn new(section: &Section, params: &CloudParams) -> Result<Self, CloudError> {
        params.check()?;
        let envelope = section.contour.envelope();
        let (width, height) = (envelope.width(), envelope.height());
        let size = envelope.size();
        if !(width > 0.0 && height > 0.0 && size.is_finite()) {
            return Err(CloudError::NoExtent { width, height });
        }
        let [n_x, n_y] = params.nodes.map(|n| (n - 1) as f64);
        let lattice = NestedLattice::new(envelope, (width / n_x).max(height / n_y));
        let (most, least) = (lattice.max_spacing(), MIN_SPACING_REL * size);
        let none = Grading::default();
        let grading = params.grading.as_ref().unwrap_or(&none);
        grading.check(size, section.n_edges())?;
        let mut found = Vec::new();
        for Refinement { target, size: own, growth } in &grading.refinements {
            match target {
                Target::Point(p) => found.push(Source::point(*p, *own, *growth)),
                Target::Edge(edge) => {
                    if let Some(edge) = section.edge(*edge) {
                        found.extend(along(&edge.curve, *own, *growth));
                    }
                }
            }
        }
        if params.grading.is_some() {
            found.extend(of_short_edges(section, params, grading.growth)?);
        }
        found.retain(|source| source.size < most);
        for source in &mut found {
            (source.size, source.growth) = (source.size.max(least), source.growth.min(STEEPEST));
        }
        let function = grading.function.clone().map(|function| {
            let sides = section.loops().map(|outline| outline.flatten(SECTION_CHORD_REL * size));
            let sides = sides.flat_map(|ring| {
                (0..ring.len()).map(move |k| [ring[k], ring[(k + 1) % ring.len()]]).collect::<Vec<_>>()
            });
            Asked { function, section: Locator::new(sides), chord: SECTION_CHORD_REL * size, most, least }
        });
        let (mut finest, mut may_miss_dips) = (most, false);
        let looked_at = |function| FirstLook::new(&function, &lattice).map(|look| (function, look));
        let function = function.map(looked_at).transpose()?;
        if let Some((function, look)) = &function {
            let steep = steep_places(function, look, &lattice, grading.growth.min(STEEPEST))?;
            found.extend(steep.sources);
            (finest, may_miss_dips) = (steep.least, steep.may_miss_dips);
        }
        let finest = found.iter().map(|source| source.size).fold(finest, f64::min);
        Ok(Self { function, sources: SourceTree::new(found), lattice, most, least, finest, may_miss_dips })
    }

    /// h at `p`, user's length unit.
    ///
    /// # Errors
    /// [`CloudError::NotASpacing`] where the function is not a positive number there, in the section.
    pub fn at(&self, p: Point) -> Result<f64, CloudError> {
        let most = match &self.function {
            Some((function, _)) => function.at(p)?,
            None => self.most,
        };
        Ok(self.sources.least(p, most).max(self.least))
    }

    /// The uniform spacing: the upper bound.
    pub fn most(&self) -> f64 {
        self.most
    }

    /// The lower bound, 1e-7 of the size.
    pub fn least(&self) -> f64 {
        self.least
    }

    /// The least spacing asked for, as far as a function has been looked at.
    pub fn finest(&self) -> f64 {
        self.finest
    }

    /// True where a function with a lower bound has so many places at which that is far below the function that they could not
    /// all be looked into: dips may have been passed over.
    pub fn may_miss_dips(&self) -> bool {
        self.may_miss_dips
    }

    /// The lattices that the interior nodes come from.
    pub fn lattice(&self) -> &NestedLattice {
        &self.lattice
    }

    pub(crate) fn function(&self) -> Option<&Asked> {
        self.function.as_ref().map(|(function, _)| function)
    }

    /// The function, and what has been seen of it.
    pub(crate) fn function_and_look(&self) -> Option<&(Asked, FirstLook)> {
        self.function.as_ref()
    }

    pub(crate) fn sources(&self) -> &[Source] {
        self.sources.sources()
    }
}

/// A spacing along a whole curve.
fn along(curve: &Curve, size: f64, growth: f64) -> Vec<Source> {
    let line = curve.flatten(CHORD_REL * size);
    line.windows(2).map(|pair| Source { ends: [pair[0], pair[1]], size, growth }).collect()
}

/// What edges want whose nodes are nearer to each other than the uniform spacing: by the least number that an edge has, by
/// a count of their own or their hole's, or since they are given.
fn of_short_edges(section: &Section, params: &CloudParams, growth: f64) -> Result<Vec<Source>, CloudError> {
    let mut found = Vec::new();
    let mut number = 0;
    for (k, outline) in section.loops().enumerate() {
        let own = k.checked_sub(1).and_then(|hole| params.hole_nodes.get(hole).copied().flatten());
        let envelope = outline.envelope();
        let of_hole = own.map_or(f64::INFINITY, |n| {
            (envelope.width() / (n[0] - 1) as f64).max(envelope.height() / (n[1] - 1) as f64)
        });
        for edge in &outline.edges {
            let failed = |source| CloudError::Edge { edge: number, source };
            let table = ArcTable::new(&edge.curve).map_err(failed)?;
            match params.edge_nodes.get(number).and_then(Option::as_deref) {
                Some(given) => found.extend(between(given, &table, growth)),
                None => {
                    let size = (table.length() / least_segments(edge) as f64).min(of_hole);
                    found.extend(along(&edge.curve, size, growth));
                }
            }
            number += 1;
        }
    }
    Ok(found)
}

/// Segments that an edge has whatever the spacing: by its own count, else the fewest that its kind may have.
pub(crate) fn least_segments(edge: &OutlineEdge) -> usize {
    if edge.curve.is_closed() {
        return edge.nodes.unwrap_or(CLOSED_NODES_LEAST).max(3);
    }
    let least = if edge.curve.is_straight() { 2 } else { CURVED_NODES_LEAST };
    edge.nodes.unwrap_or(least).max(2) - 1
}

/// The segments between nodes that an edge is given.
fn between(given: &[GivenNode], table: &ArcTable, growth: f64) -> Vec<Source> {
    let inner = given.iter().map(|node| node.fraction);
    let fractions: Vec<f64> = std::iter::once(0.0).chain(inner).chain([1.0]).collect();
    let point = |t: f64| table.point_at(t * table.length());
    let source = |pair: &[f64]| Source {
        ends: [point(pair[0]), point(pair[1])],
        size: (pair[1] - pair[0]) * table.length(),
        growth,
    };
    fractions.windows(2).map(source).collect()
}

impl Section {
    /// An edge by its number: those of the contour first, then of each hole.
    pub(crate) fn edge(&self, edge: EdgeId) -> Option<&OutlineEdge> {
        self.loops().flat_map(|outline| &outline.edges).nth(edge.index())
    }
}
