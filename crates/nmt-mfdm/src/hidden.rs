//! Bends of curved edges between two boundary nodes that the places looked at there do not show: ripples, notches, kinks.
//!
//! Integrals over slivers take a piece of an edge as its four places show it, and fields see nothing of it but its ends. Arc
//! lengths are exact, whatever happens between: a piece longer than the parabola through its ends and its middle does
//! something that these do not tell, and so does one that begins in another direction. With e the relative length that is
//! left, the piece lies within c·√(e/2) of what is known of it, c its chord, and the slopes it has beyond that are √(2e) on
//! average.

use crate::error::MfdmError;
use crate::true_edges::{Piece, visit_edges};
use nmt_cloud::{Cloud, Section};
use nmt_geom::point::{cross, distance, dot, lerp, sub};
use nmt_geom::{EdgeId, Point};

/// A piece hides a bend where more than this part of its excess length is not that of the parabola: its curvature then about
/// trebles from one end to the other.
const HIDDEN_REL: f64 = 0.25;

/// Excess lengths less than this are rounding, and so is this part of the edge's length, which arc lengths are accurate to.
const ROUNDING: f64 = 1.0e-8;
const LENGTH_ROUNDING_REL: f64 = 1.0e-10;

/// So does one that begins or ends otherwise than the parabola by more than this part of its slope there, and this, rad.
const SLOPE_REL: f64 = 0.5;
const SLOPE_ROOM: f64 = 0.02;

/// A hidden excess length that is told: slopes of 4 % on average.
const TOLD: f64 = 1.0e-3;

/// Turns that are looked at more closely, rad.
const TURN: f64 = 0.3;

/// Stretches of a piece that are looked at, at least, and how often they are halved where the edge turns.
const STRETCHES: usize = 64;
const MOST_HALVINGS: usize = 24;

/// What a piece of an edge hides.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hidden {
    /// How much area it may gain or lose the section, length².
    pub area: f64,
    /// By how much, relatively, the stress at its sharpest bend into the material exceeds that of a smooth edge.
    ///
    /// A groove of depth t whose ground has the radius ρ raises the stresses of antiplane shear by √(t/ρ) (half an ellipse; H.
    /// Neuber, *Kerbspannungslehre*, 1937).
    pub concentration: f64,
}

impl Hidden {
    /// What a piece hides; `None` where it is as smooth as it seems.
    pub fn of(piece: &Piece) -> Option<Self> {
        let hidden = hidden_excess(piece)?;
        let chord = distance(piece.point(0.0), piece.point(1.0));
        let Bend { turn, radius } = Bend::sharpest(piece);
        // The depth of a notch that the whole piece is one side of, or of a ripple in it.
        let depth = (chord * (0.5 * hidden).sqrt()).max(0.5 * chord * (1.0 - turn.min(1.5).cos()));
        let concentration = if turn > 0.0 { (depth / radius).sqrt() } else { 0.0 };
        let seen: f64 = piece.beyond_segment().map(|(_, area)| area).sum();
        let area = chord * chord * hidden + (area_of(piece) - seen).abs();
        Some(Self { area, concentration })
    }
}

/// Excess length of a piece beyond the parabola, as a fraction of the chord; `None` where it is as smooth as it seems.
fn hidden_excess(piece: &Piece) -> Option<f64> {
    if piece.is_straight {
        return None;
    }
    let ends = [piece.point(0.0), piece.point(1.0)];
    let chord = distance(ends[0], ends[1]);
    if chord == 0.0 {
        return None;
    }
    let bulge = sub(piece.point(0.5), lerp(ends[0], ends[1], 0.5));
    let (height, along) = (bulge[0].hypot(bulge[1]) / chord, sub(ends[1], ends[0]));
    let (excess, smooth) = (piece.length / chord - 1.0, excess_of_parabola(height));
    let rounding = ROUNDING + LENGTH_ROUNDING_REL * piece.edge_length() / chord;
    // One ripple from crest to crest is as long as the parabola through its trough, but does not begin as that does.
    let slope = (4.0 * height).atan().copysign(cross(along, bulge));
    let turn_from = |expected: f64, tangent: Point| (turn(along, tangent) - expected).abs();
    let at_ends = turn_from(slope, piece.tangent(0.0)).max(turn_from(-slope, piece.tangent(1.0)));
    let is_longer = excess - smooth > HIDDEN_REL * smooth + rounding;
    let begins_otherwise = at_ends > SLOPE_REL * slope.abs() + SLOPE_ROOM;
    // A slope that falls from there to none has a third of its square on average.
    (is_longer || begins_otherwise).then(|| (excess - smooth).max(at_ends * at_ends / 6.0))
}

/// The angle from one direction to another, counter-clockwise in (−π, π].
fn turn(from: Point, to: Point) -> f64 {
    cross(from, to).atan2(dot(from, to))
}

/// (length − chord)/chord of a parabola by its height over its chord.
fn excess_of_parabola(height: f64) -> f64 {
    let x = 4.0 * height;
    // The series, where the difference would cancel.
    if x < 1e-2 { x * x / 6.0 * (1.0 - 0.15 * x * x) } else { 0.5 * (1.0 + x * x).sqrt() + 0.5 * x.asinh() / x - 1.0 }
}

/// Area between a piece and its chord, by many places.
fn area_of(piece: &Piece) -> f64 {
    let from = piece.point(0.0);
    let at = |k: usize| sub(piece.point(k as f64 / STRETCHES as f64), from);
    -0.5 * (0..STRETCHES).map(|k| cross(at(k), at(k + 1))).sum::<f64>()
}

/// A bend of a piece into the material.
#[derive(Clone, Copy, Debug)]
struct Bend {
    turn: f64,   // rad; 0 where there is none
    radius: f64, // the least, user's length unit
}

impl Bend {
    /// The largest turn in one stretch that bends into the material, and the least radius there.
    fn sharpest(piece: &Piece) -> Self {
        let mut search = Search { piece, run: 0.0, turn: 0.0, radius: f64::INFINITY };
        let mut before = (0.0, piece.tangent(0.0));
        for k in 1..=STRETCHES {
            let s = k as f64 / STRETCHES as f64;
            let next = (s, piece.tangent(s));
            search.add(before, next, MOST_HALVINGS);
            before = next;
        }
        Self { turn: search.turn, radius: search.radius }
    }
}

struct Search<'p, 'a> {
    piece: &'p Piece<'a>,
    run: f64, // turned into the material without turning back
    turn: f64,
    radius: f64,
}

impl Search<'_, '_> {
    /// Adds a stretch from one (fraction, unit tangent) to another.
    fn add(&mut self, from: (f64, Point), to: (f64, Point), halvings: usize) {
        // The material is on the left: a turn to the right is one into it.
        let turned = -turn(from.1, to.1);
        if turned.abs() > TURN && halvings > 0 {
            let middle = 0.5 * (from.0 + to.0);
            let between = (middle, self.piece.tangent(middle));
            self.add(from, between, halvings - 1);
            return self.add(between, to, halvings - 1);
        }
        if turned > 0.0 {
            self.run += turned;
            self.turn = self.turn.max(self.run);
            self.radius = self.radius.min((to.0 - from.0) * self.piece.length / turned);
        } else if turned < 0.0 {
            self.run = 0.0;
        }
    }
}

/// Bends of the edges of one section that its boundary nodes do not show.
#[derive(Clone, Debug, PartialEq)]
pub struct HiddenBends {
    /// The edge, by its number: those of the contour first, then of each hole.
    pub edge: EdgeId,
    /// Segments of the boundary that hide a bend.
    pub segments: usize,
    /// Segments of the edge.
    pub of: usize,
    /// The middle of the edge's piece at the one that hides most.
    pub at: Point,
    /// By what part of its length, beyond what can be seen, that piece is longer than its segment.
    pub excess: f64,
}

/// The curved edges that bend between boundary nodes more than nodes and middles of the segments show, so that clouds, meshes
/// and solutions are those of another section; `section` is what the cloud was generated from.
///
/// # Errors
/// [`MfdmError::Curve`] where an edge has no length.
///
/// ```
/// use nmt_cloud::{CloudParams, Section, generate};
/// use nmt_curve::{Curve, Expression, Outline, OutlineEdge};
/// use nmt_mfdm::hidden_bends;
///
/// let teeth = |n: f64| -> Result<_, Box<dyn std::error::Error>> {
///     let y = Expression::parse(&format!("1 + 0.02*sin({n}*pi*x)^2"), &["x"])?;
///     let mut outline = Outline::rectangle([0.0, 0.0], [1.0, 1.0]);
///     outline.edges[2].curve = Curve::Graph { y, from_x: 1.0, to_x: 0.0 };
///     let section = Section::solid(outline);
///     let cloud = generate(&section, &CloudParams { nodes: [21, 21], ..CloudParams::default() })?;
///     Ok(hidden_bends(&section, &cloud)?)
/// };
/// assert!(teeth(1.0)?.is_empty());
/// let of_many = teeth(40.0)?;
/// assert!(of_many.len() == 1 && of_many[0].edge.index() == 2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn hidden_bends(section: &Section, cloud: &Cloud) -> Result<Vec<HiddenBends>, MfdmError> {
    let mut all: Vec<HiddenBends> = Vec::new();
    visit_edges(
        cloud,
        section,
        |_| true,
        |segment, piece| {
            let excess = hidden_excess(piece).unwrap_or(0.0);
            if all.last().is_none_or(|last| last.edge != segment.edge) {
                all.push(HiddenBends { edge: segment.edge, segments: 0, of: 0, at: piece.point(0.5), excess: 0.0 });
            }
            if let Some(own) = all.last_mut() {
                own.of += 1;
                own.segments += usize::from(excess > TOLD);
                if excess > own.excess {
                    (own.excess, own.at) = (excess, piece.point(0.5));
                }
            }
            Ok(())
        },
    )?;
    all.retain(|of_edge| of_edge.segments > 0);
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parabola_is_longer_than_its_chord_by_what_the_formula_says() {
        for height in [1e-4f64, 0.0024, 0.0026, 0.1, 1.0] {
            let point = |k: i32| {
                let t = f64::from(k) * 1e-4;
                [t, 4.0 * height * t * (1.0 - t)]
            };
            let length: f64 = (0..10_000).map(|k| distance(point(k), point(k + 1))).sum();
            let found = excess_of_parabola(height);
            // Chords of 1e-4 lose a part of 1e-8, their sum 1e-13.
            assert!((found - (length - 1.0)).abs() < 1e-7 * found + 1e-12, "{height}: {found:e} {:e}", length - 1.0);
        }
    }
}
