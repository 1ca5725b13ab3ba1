//! Nodes along a curve.

use nmt_geom::Point;

use crate::{ArcTable, Curve, CurveError};

/// Most nodes one edge may have: as many as a cloud may have points.
pub const MAX_NODES_ON_EDGE: usize = 100_000_000;

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
    let (least, segments) = if curve.is_closed() { (1, n) } else { (2, n.saturating_sub(1)) };
    if !(least..=MAX_NODES_ON_EDGE).contains(&n) {
        return Err(CurveError::NodeCount { n, least, most: MAX_NODES_ON_EDGE });
    }
    let table = ArcTable::new(curve)?;
    Ok((0..n).map(|k| table.point_at(table.length() * (k as f64 / segments as f64))).collect())
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
