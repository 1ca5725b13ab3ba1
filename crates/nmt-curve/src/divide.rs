//! Nodes along a curve, by either rule \[D3\].

use nmt_geom::Point;
use nmt_geom::point::distance;

use crate::{ArcTable, Curve, CurveError};

/// Most nodes one edge may have: as many as a cloud may have points.
pub const MAX_NODES_ON_EDGE: usize = 100_000_000;

/// A chord that is short of its length by less than this fraction of the curve has it.
///
/// Ten times the residual of a position on an [`ArcTable`]: what is left is rounding.
const CHORD_REL_TOL: f64 = 1e-12;

/// Steps along the curve towards one node, at most.
///
/// Each step leaves 1 − cos(angle between chord and curve) of the way: tens are enough unless the curve runs around the
/// node before at nearly the chord's length, where the crossing itself is uncertain.
const MAX_CHORD_STEPS: usize = 10_000;

/// How the nodes of a curved edge are spread.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Division {
    /// At equal arc lengths \[D3\]; the default.
    #[default]
    Arc,
    /// The paper's (5): each at the same straight distance from the one before.
    Chord,
}

impl Division {
    /// Both rules.
    pub const ALL: [Self; 2] = [Self::Arc, Self::Chord];

    /// The word of problem files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Arc => "arc",
            Self::Chord => "chord",
        }
    }
}

/// Nodes on a curve at equal straight distances.
#[derive(Clone, Debug, PartialEq)]
pub struct EdgeNodes {
    /// The nodes, ends included (closed: once around), shape (n − left_out,), user's length unit.
    pub nodes: Vec<Point>,
    /// Arc length from the first point to each, as a fraction of the whole: from 0 to 1 (closed: below 1).
    pub fractions: Vec<f64>,
    /// The straight distance h = L/(n − 1) (closed: L/n) from each node to the next, user's length unit.
    pub chord: f64,
    /// Nodes that no longer fitted between the last one and the end.
    pub left_out: usize,
    /// By how much the last chord misses the length of the others, user's length unit.
    pub closing_error: f64,
}

/// `n` nodes at equal arc lengths, both ends included; node k at (k−1)·L/(n−1) \[D3\].
///
/// A closed curve gets n nodes evenly around, the first at angle 0. Positions are accurate to about 1e-11 of the
/// length, the ends to rounding.
///
/// # Errors
/// Those of [`ArcTable::new`], and [`CurveError::NodeCount`] where `n` is less than 2 (closed: 1) or beyond all bounds.
///
/// ```
/// # use nmt_curve::{Curve, divide};
/// let quarter = Curve::Line { from: [0.0, 0.0], to: [1.0, 2.0] };
/// assert_eq!(divide(&quarter, 3)?, [[0.0, 0.0], [0.5, 1.0], [1.0, 2.0]]);
/// # Ok::<(), nmt_curve::CurveError>(())
/// ```
pub fn divide(curve: &Curve, n: usize) -> Result<Vec<Point>, CurveError> {
    let segments = segments(curve, n)?;
    let table = ArcTable::new(curve)?;
    Ok((0..n).map(|k| table.point_at(table.length() * (k as f64 / segments as f64))).collect())
}

/// Up to `n` nodes each at the straight distance h = L/(n − 1) from the one before (closed: L/n); paper, (5), with its
/// rule for the bracket mended \[D3\].
///
/// The next node is where the curve first gets that far from the one before. Chords are shorter than the curve, so that
/// fewer than n may fit: the others are left out, and the last chord, to the end of the curve, closes the division with an
/// error that is told.
///
/// # Errors
/// As [`divide`].
///
/// ```
/// # use nmt_curve::{Curve, Expression, divide_by_chords};
/// let y = Expression::parse("sin(x)", &["x"])?;
/// let wave = Curve::Graph { y, from_x: 0.0, to_x: 6.283185307179586 };
/// let divided = divide_by_chords(&wave, 4)?;
/// assert!((divided.nodes[1][0] - 2.469522883627966).abs() < 1e-9);
/// assert_eq!(divided.left_out, 0);
/// assert!((divided.closing_error - 0.481323050323882).abs() < 1e-9); // of a chord of 2.5468
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn divide_by_chords(curve: &Curve, n: usize) -> Result<EdgeNodes, CurveError> {
    let segments = segments(curve, n)?;
    let table = ArcTable::new(curve)?;
    let (length, chord) = (table.length(), table.length() / segments as f64);
    let (nodes, fractions) = (vec![curve.point(0.0)], vec![0.0]);
    let mut divided = EdgeNodes { nodes, fractions, chord, left_out: 0, closing_error: 0.0 };
    let mut s = 0.0;
    for k in 1..segments {
        let Some(next) = first_at_distance(&table, s, chord) else {
            divided.left_out = segments - k;
            break;
        };
        s = next;
        divided.nodes.push(table.point_at(s));
        divided.fractions.push(s / length);
    }
    let last = divided.nodes[divided.nodes.len() - 1];
    let end = curve.point(1.0);
    divided.closing_error = (distance(last, end) - chord).abs();
    if !curve.is_closed() {
        divided.nodes.push(end);
        divided.fractions.push(1.0);
    }
    Ok(divided)
}

/// Segments between `n` nodes of a curve.
fn segments(curve: &Curve, n: usize) -> Result<usize, CurveError> {
    let (least, segments) = if curve.is_closed() { (1, n) } else { (2, n.saturating_sub(1)) };
    if !(least..=MAX_NODES_ON_EDGE).contains(&n) {
        return Err(CurveError::NodeCount { n, least, most: MAX_NODES_ON_EDGE });
    }
    Ok(segments)
}

/// The first arc length beyond `from` at which the curve is `chord` away from its point there; `None` where it never is.
///
/// The straight distance grows no faster than the arc length, so that the curve cannot be that far before it has run
/// what is missing: steps of that length approach the first crossing from before it, and pass over none.
fn first_at_distance(table: &ArcTable, from: f64, chord: f64) -> Option<f64> {
    let start = table.point_at(from);
    let tolerance = CHORD_REL_TOL * table.length();
    let missing = |s: f64| chord - distance(start, table.point_at(s));
    let mut s = from + chord;
    for _ in 0..MAX_CHORD_STEPS {
        if s >= table.length() {
            // The end itself counts, to rounding.
            return (missing(table.length()) <= tolerance).then_some(table.length());
        }
        let left = missing(s);
        if left <= tolerance {
            return Some(s);
        }
        s += left;
    }
    Some(s)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Turn;
    use crate::curve::samples::{graph, parametric};
    use nmt_geom::point::distance;

    #[test]
    fn divisions_agree_with_reference_values() {
        // Seven nodes at equal arc length, computed with 30 digits by quadrature and bisection of the exact arc length.
        let cases: [(Curve, [Point; 7]); 6] = [
            (
                graph("sin(x)", 0.0, std::f64::consts::TAU),
                [
                    [0.0, 0.0],
                    [0.966_725_734_528_348_7, 0.823_030_354_190_336_8],
                    [2.174_866_919_061_444_5, 0.823_030_354_190_336_8],
                    [std::f64::consts::PI, 0.0],
                    [4.108_318_388_118_142, -0.823_030_354_190_336_8],
                    [5.316_459_572_651_238, -0.823_030_354_190_336_8],
                    [std::f64::consts::TAU, 0.0],
                ],
            ),
            (
                graph("0.25*sin(2*pi*x)", 0.0, 2.0),
                [
                    [0.0, 0.0],
                    [0.356_173_037_048_329_37, 0.196_404_053_962_434_47],
                    [0.643_826_962_951_670_6, -0.196_404_053_962_434_47],
                    [1.0, 0.0],
                    [1.356_173_037_048_329_4, 0.196_404_053_962_434_47],
                    [1.643_826_962_951_670_6, -0.196_404_053_962_434_47],
                    [2.0, 0.0],
                ],
            ),
            (
                // Angles of 30 degrees.
                graph("sqrt(1-x^2)", -1.0, 1.0),
                [
                    [-1.0, 0.0],
                    [-0.866_025_403_784_438_6, 0.5],
                    [-0.5, 0.866_025_403_784_438_6],
                    [0.0, 1.0],
                    [0.5, 0.866_025_403_784_438_6],
                    [0.866_025_403_784_438_6, 0.5],
                    [1.0, 0.0],
                ],
            ),
            (
                graph("x^2", 0.0, 1.0),
                [
                    [0.0, 0.0],
                    [0.237_806_859_085_596_98, 0.056_552_102_228_156_98],
                    [0.441_083_958_526_557_1, 0.194_555_058_469_457_55],
                    [0.610_738_682_958_059_9, 0.373_001_738_861_345_6],
                    [0.756_211_591_421_421_9, 0.571_855_971_000_119_5],
                    [0.884_471_559_803_434_4, 0.782_289_940_101_120_2],
                    [1.0, 1.0],
                ],
            ),
            (
                graph("1/(1+25*x^2)", -1.0, 1.0),
                [
                    [-1.0, 1.0 / 26.0],
                    [-0.498_683_926_670_052_6, 0.138_559_013_210_027_3],
                    [-0.188_133_164_325_731_16, 0.530_545_581_439_749_6],
                    [0.0, 1.0],
                    [0.188_133_164_325_731_16, 0.530_545_581_439_749_6],
                    [0.498_683_926_670_052_6, 0.138_559_013_210_027_3],
                    [1.0, 1.0 / 26.0],
                ],
            ),
            (
                graph("abs(x)", -1.0, 1.0),
                [-1.0, -2.0 / 3.0, -1.0 / 3.0, 0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0].map(|x: f64| [x, x.abs()]),
            ),
        ];
        for (curve, expected) in cases {
            let nodes = divide(&curve, 7).unwrap();
            let length = ArcTable::new(&curve).unwrap().length();
            for (node, reference) in nodes.iter().zip(&expected) {
                let off = distance(*node, *reference) / length;
                assert!(off < 1e-10, "{curve:?}: {node:?}, expected {reference:?}"); // ten times the table's tolerance
            }
        }
    }

    #[test]
    fn a_circle_is_divided_evenly_from_angle_zero() {
        let circle = Curve::Ellipse { centre: [1.0, 2.0], semi_axes: [0.5, 0.5], rotation: 0.0 };
        let nodes = divide(&circle, 8).unwrap();
        assert_eq!(nodes[0], [1.5, 2.0]);
        let segment = |k: usize| distance(nodes[k], nodes[(k + 1) % 8]);
        assert!((1..8).all(|k| (segment(k) - segment(0)).abs() < 1e-15)); // rounding
        assert_eq!(divide(&circle, 1).unwrap(), [[1.5, 2.0]]);
    }

    #[test]
    fn an_ellipse_is_divided_evenly_by_length() {
        let oval = Curve::Ellipse { centre: [0.0, 0.0], semi_axes: [3.0, 1.0], rotation: 0.4 };
        let nodes = divide(&oval, 4).unwrap();
        let (sine, cosine) = 0.4_f64.sin_cos();
        assert!(distance(nodes[1], [-sine, cosine]) < 1e-10); // ten times the table's tolerance
        assert!(distance(nodes[2], [-3.0 * cosine, -3.0 * sine]) < 1e-10);
    }

    #[test]
    fn ends_are_exact_and_directions_opposite() {
        let there = divide(&graph("sqrt(1-x^2)", -1.0, 1.0), 11).unwrap();
        let mut back = divide(&graph("sqrt(1-x^2)", 1.0, -1.0), 11).unwrap();
        back.reverse();
        assert_eq!((there[0], there[10]), ([-1.0, 0.0], [1.0, 0.0]));
        assert!(there.iter().zip(&back).all(|(p, q)| distance(*p, *q) < 1e-10)); // ten times the table's tolerance
    }

    #[test]
    fn equal_chords_agree_with_reference_values() {
        // The paper's rule with 30 digits: nodes of which the last is the last that fits, then the chord left to the end.
        let wave = graph("sin(x)", 0.0, std::f64::consts::TAU);
        let three = divide_by_chords(&wave, 3).unwrap();
        assert!(distance(three.nodes[1], [3.774_170_532_272_055, -0.591_225_794_956_115_5]) < 1e-10);
        assert!((three.closing_error - 1.242_465_630_457_745_2).abs() < 1e-10);
        let four = divide_by_chords(&wave, 4).unwrap();
        assert!(distance(four.nodes[2], [4.458_563_570_070_1, -0.967_958_912_952_076_9]) < 1e-10);
        assert_eq!((four.left_out, four.nodes.len(), four.fractions[3]), (0, 4, 1.0));
        // Two nodes: only the ends, and the chord misses the length by all that the wave is longer.
        let two = divide_by_chords(&wave, 2).unwrap();
        assert_eq!(two.nodes.len(), 2);
        assert!((two.closing_error - 1.357_210_271_085_756_7).abs() < 1e-9);
    }

    #[test]
    fn nodes_that_do_not_fit_are_left_out() {
        // Chords advance further than arcs.
        let half = graph("sqrt(1-x^2)", -1.0, 1.0);
        for n in 3..40 {
            let divided = divide_by_chords(&half, n).unwrap();
            let h = std::f64::consts::PI / (n - 1) as f64;
            assert_eq!(divided.nodes.len() + divided.left_out, n);
            let inner = &divided.nodes[..divided.nodes.len() - 1];
            assert!(inner.windows(2).all(|pair| (distance(pair[0], pair[1]) - h).abs() < 1e-11), "{n}");
            // On a circle a chord h spans 2·asin(h/2).
            let fit = (std::f64::consts::PI / (2.0 * (h / 2.0).asin())).floor() as usize;
            assert_eq!(inner.len() - 1, fit.min(n - 2), "{n}");
        }
    }

    #[test]
    fn the_first_of_several_crossings_is_taken() {
        // A thin hairpin: the way back passes the start at the distance of a chord again, much later.
        let hairpin = parametric("cos(t)", "0.01*sin(t)", 0.0, std::f64::consts::PI * 1.9);
        let divided = divide_by_chords(&hairpin, 30).unwrap();
        let table = ArcTable::new(&hairpin).unwrap();
        let h = table.length() / 29.0;
        for pair in divided.fractions.windows(2).take(divided.fractions.len() - 2) {
            let start = table.point_at(pair[0] * table.length());
            // No point before the next node is as far away: looked for on a fine sampling.
            let nearer = |k: u32| {
                let s = pair[0] + (pair[1] - pair[0]) * f64::from(k) / 1000.0;
                distance(start, table.point_at(s * table.length())) < h * (1.0 + 1e-9)
            };
            assert!((0..1000).all(nearer));
        }
    }

    #[test]
    fn chords_close_around_a_circle() {
        let circle = Curve::Ellipse { centre: [1.0, 2.0], semi_axes: [0.5, 0.5], rotation: 0.0 };
        let divided = divide_by_chords(&circle, 12).unwrap();
        // Chords of L/12 span more than 30 degrees each: eleven fit, the last is short.
        assert_eq!((divided.nodes.len(), divided.left_out), (12, 0));
        assert!(divided.closing_error > 0.01 && divided.fractions[11] < 1.0);
    }

    #[test]
    fn equal_chords_of_a_line_are_its_equal_parts() {
        let line = graph("2*x", 0.0, 1.0);
        let divided = divide_by_chords(&line, 11).unwrap();
        assert_eq!(divided.left_out, 0);
        assert!(divided.closing_error < 1e-11); // ten times the tolerance of a chord
        assert!(divided.nodes.iter().zip(divide(&line, 11).unwrap()).all(|(p, q)| distance(*p, q) < 1e-10));
    }

    #[test]
    fn impossible_counts_are_rejected() {
        let line = Curve::Line { from: [0.0, 0.0], to: [1.0, 0.0] };
        for n in [0, 1, usize::MAX] {
            assert!(matches!(divide(&line, n), Err(CurveError::NodeCount { .. })));
        }
    }

    #[test]
    fn divisions_scale_with_the_unit() {
        let cusp = |unit: f64| {
            let text = format!("{unit:e}*(0.2 + abs(x/{unit:e} - 0.3)^(2/3))");
            divide(&graph(&text, 0.0, unit), 20).unwrap()
        };
        let metres = cusp(1.0);
        for unit in [1e-6, 1e3] {
            for (p, q) in metres.iter().zip(cusp(unit)) {
                assert!(distance(*p, q.map(|c| c / unit)) < 1e-9); // rounding of x near the cusp: (1e-16)^(2/3) = 2e-11
            }
        }
    }

    #[test]
    fn every_curve_of_the_plane_is_divided_into_equal_chords_when_they_are_short() {
        let curves = [
            graph("0.25*sin(2*pi*x)", 0.0, 2.0),
            graph("sqrt(1-x^2)", -1.0, 1.0),
            parametric("cos(t)^3", "sin(t)^3", 0.1, 1.5),
            parametric("t*cos(t)", "t*sin(t)", 0.0, 12.0),
            Curve::arc([0.0, 0.0], [1.0, 0.0], [-1.0, 0.0], Turn::Clockwise),
        ];
        for curve in curves {
            let nodes = divide(&curve, 10_000).unwrap();
            let chord = ArcTable::new(&curve).unwrap().length() / 9999.0;
            for pair in nodes.windows(2) {
                let off = distance(pair[0], pair[1]) / chord - 1.0;
                // (κ·chord)²/24 of the chord: below 2e-6 with the greatest curvature here, 10 over a length of 3.
                assert!(off.abs() < 1e-5, "{curve:?} at {pair:?}: {off}");
            }
        }
    }
}
