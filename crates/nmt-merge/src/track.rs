//! A curve that points are looked up on: does a point lie on it, and where?

use nmt_curve::Curve;
use nmt_geom::point::{cross, distance, dot, lerp, sub};
use nmt_geom::{Bbox, Point, SegmentIndex};

/// Tangent of the angle that a piece may lead away from its chord anywhere: small enough that the foot of a point on it is
/// unique.
const STRAIGHT: f64 = 0.3;

/// Pieces that a curve is looked at in, of irregular widths: a wave cannot have its nodes at the ends of all of them.
const FIRST_ENDS: [f64; 9] = [0.0, 0.11, 0.23, 0.37, 0.49, 0.62, 0.74, 0.89, 1.0];

/// Parts of a piece, at whose ends it is looked at.
const PARTS: usize = 8;

/// A piece is not halved below this width of the parameter: it holds a kink, or a cusp, where y = x^(2/3) makes 1e-10 of it.
const NARROWEST: f64 = 1e-15;

/// Most pieces of a curve; beyond, they are left as they are.
const MAX_PIECES: usize = 1 << 14;

/// Steps towards a foot, at most: every third one halves the bracket.
const MAX_STEPS: usize = 180;

/// A foot is found where the residual is this fraction of the tolerance.
const FOOT_REL: f64 = 1e-3;

/// A curve in nearly straight pieces, each in its box.
#[derive(Debug)]
pub(crate) struct Track<'c> {
    curve: &'c Curve,
    pieces: Vec<Piece>,
    /// The diagonals of the pieces' boxes, so that the tree over them is one of boxes.
    boxes: SegmentIndex,
}

/// An interval of the parameter.
#[derive(Clone, Copy, Debug)]
struct Piece {
    from: f64,
    to: f64,
    start: Point,
    end: Point,
}

/// Where a point lies on a curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Foot {
    /// Fraction of the parameter.
    pub u: f64,
    /// Distance of the point from the curve there, user's length unit.
    pub distance: f64,
}

impl<'c> Track<'c> {
    /// Cuts the curve into pieces.
    pub fn new(curve: &'c Curve) -> Self {
        let mut pieces = Vec::new();
        let mut boxes = Vec::new();
        let mut rest: Vec<[f64; 2]> = match curve {
            Curve::Line { .. } => vec![[0.0, 1.0]],
            _ => FIRST_ENDS.windows(2).rev().map(|ends| [ends[0], ends[1]]).collect(),
        };
        while let Some([from, to]) = rest.pop() {
            let probes: [Point; PARTS + 1] =
                std::array::from_fn(|k| curve.point(from + (to - from) * (k as f64 / PARTS as f64)));
            let bent = to - from > NARROWEST && pieces.len() + rest.len() < MAX_PIECES && !is_straight(&probes);
            if bent {
                let middle = 0.5 * (from + to);
                rest.extend([[middle, to], [from, middle]]);
                continue;
            }
            let bend = |three: &[Point]| distance(lerp(three[0], three[2], 0.5), three[1]);
            let between = probes.windows(3).map(bend).fold(0.0, f64::max);
            let envelope = Bbox::of(probes).grown([between; 2]);
            boxes.push([envelope.min, envelope.max]);
            pieces.push(Piece { from, to, start: curve.point(from), end: curve.point(to) });
        }
        Self { curve, pieces, boxes: SegmentIndex::new(boxes) }
    }

    /// The curve.
    pub fn curve(&self) -> &'c Curve {
        self.curve
    }

    /// Corners of the box around every piece, in order.
    pub fn boxes(&self) -> impl Iterator<Item = [Point; 2]> {
        (0..self.boxes.len()).map(|k| self.boxes.segment(k))
    }

    /// The ends and middles of the pieces between two fractions of the parameter, both exclusive.
    pub fn probes(&self, low: f64, high: f64) -> impl Iterator<Item = f64> {
        let of_piece = |piece: &Piece| [piece.from, 0.5 * (piece.from + piece.to)];
        self.pieces.iter().flat_map(of_piece).filter(move |&u| low < u && u < high)
    }

    /// Where `p` lies on the curve, if it does within `tolerance` (a length).
    pub fn foot(&self, p: Point, tolerance: f64) -> Option<Foot> {
        let mut best: Option<Foot> = None;
        self.boxes.candidates(p, p, tolerance, |k| {
            let foot = self.foot_on(&self.pieces[k], p, tolerance);
            if foot.distance <= tolerance && best.is_none_or(|best| foot.distance < best.distance) {
                best = Some(foot);
            }
        });
        best
    }

    /// The point of a piece where the way to `p` is square to its chord; an end where there is none.
    ///
    /// That is the nearest point where `p` lies on the curve, and within 5 % of its distance otherwise.
    fn foot_on(&self, piece: &Piece, p: Point, tolerance: f64) -> Foot {
        let chord = sub(piece.end, piece.start);
        let length = dot(chord, chord).sqrt();
        let beyond = |q: Point| dot(sub(q, p), chord);
        let at = |u: f64, q: Point| Foot { u, distance: distance(q, p) };
        let (mut low, mut high) = (piece.from, piece.to);
        let (mut at_low, mut at_high) = (beyond(piece.start), beyond(piece.end));
        if at_low >= 0.0 {
            return at(low, piece.start);
        }
        if at_high <= 0.0 {
            return at(high, piece.end);
        }
        let enough = FOOT_REL * tolerance * length;
        let mut foot = at(low, piece.start);
        for step in 0..MAX_STEPS {
            let secant = low - at_low * (high - low) / (at_high - at_low);
            let u = if step % 3 == 2 || !(low < secant && secant < high) { 0.5 * (low + high) } else { secant };
            let q = self.curve.point(u);
            let residual = beyond(q);
            foot = at(u, q);
            if residual.abs() <= enough || u <= low || u >= high {
                break;
            }
            if residual < 0.0 {
                (low, at_low) = (u, residual);
            } else {
                (high, at_high) = (u, residual);
            }
        }
        foot
    }
}

/// True where every step from probe to probe leads along the chord.
fn is_straight(probes: &[Point; PARTS + 1]) -> bool {
    let chord = sub(probes[PARTS], probes[0]);
    probes.windows(2).all(|pair| {
        let step = sub(pair[1], pair[0]);
        let ahead = dot(step, chord);
        ahead > 0.0 && cross(step, chord).abs() <= STRAIGHT * ahead
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use nmt_curve::Expression;
    use std::f64::consts::TAU;

    fn graph(text: &str, from_x: f64, to_x: f64) -> Curve {
        Curve::Graph { y: Expression::parse(text, &["x"]).expect("a formula"), from_x, to_x }
    }

    #[test]
    fn points_of_a_curve_have_their_parameter_as_foot() {
        let curves = [
            graph("sqrt(1-x^2)", -1.0, 1.0),
            graph("sin(20*x)", 3.0, 0.0),
            graph("abs(x)^(2/3)", -1.0, 2.0),
            Curve::Ellipse { centre: [1.0, 2.0], semi_axes: [3.0, 0.5], rotation: 0.4 },
            Curve::Arc { centre: [0.0, 0.0], radius: 2.0, start: 1.0, sweep: -5.0 },
            Curve::Line { from: [0.0, 1.0], to: [5.0, -2.0] },
        ];
        for curve in &curves {
            let track = Track::new(curve);
            for k in 0..=500 {
                let u = f64::from(k) / 500.0;
                let p = curve.point(u);
                let foot = track.foot(p, 1e-9).unwrap_or_else(|| panic!("{curve:?} {u}"));
                assert!(foot.distance < 1e-11, "{curve:?} {u} {foot:?}"); // a hundredth of the tolerance
                assert!(distance(curve.point(foot.u), p) < 1e-11);
            }
        }
    }

    #[test]
    fn points_beside_a_curve_have_no_foot() {
        let circle = Curve::Ellipse { centre: [0.0, 0.0], semi_axes: [1.0; 2], rotation: 0.0 };
        let track = Track::new(&circle);
        for k in 0..100 {
            let (sine, cosine) = (TAU * f64::from(k) / 100.0).sin_cos();
            let at = |radius: f64| [radius * cosine, radius * sine];
            assert_eq!(track.foot(at(1.0 + 2e-9), 1e-9), None);
            assert_eq!(track.foot(at(1.0 - 2e-9), 1e-9), None);
            assert!(track.foot(at(1.0 + 0.9e-9), 1e-9).is_some());
        }
        assert_eq!(track.foot([0.0, 0.0], 1e-9), None);
    }

    #[test]
    fn a_curve_that_is_no_number_somewhere_does_no_harm() {
        let root = graph("sqrt(x)", -1.0, 1.0);
        let track = Track::new(&root);
        assert!(track.foot(root.point(0.9), 1e-9).is_some());
        assert_eq!(track.foot([f64::NAN, 0.0], 1e-9), None);
    }
}
