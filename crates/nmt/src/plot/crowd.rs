//! What lies too close to be drawn one by one: dots of which one in each place is drawn, lines that become a shade.
//!
//! A page has a million places for a dot and no more; beyond that a picture would grow and show nothing else.

use super::colour::Rgb;
use super::scene::{Point, Polyline, Shape};

/// Dots or lines on a picture up to which each is drawn, however close they lie.
pub(super) const ALL_DRAWN: usize = 200_000;
/// Side of the square in which one dot is drawn, in page units: the next dot would be beside it or over it.
pub(super) const PLACE: f64 = 1.7;
/// Side of the squares that are shaded or not, in page units: small in the picture, and of some hundred edges.
const SQUARE: f64 = 8.0;
/// Lines are drawn where they are longer than this on average, in page units.
const LEAST_LENGTH: f64 = 2.5;
/// Shades between none and full.
const SHADES: usize = 16;
/// The darkest shade, as a share of the colour of lines.
const DARKEST: f64 = 0.8;
/// Length of edges of a mesh of equilateral triangles in an area, times the length of one: √12.
const EDGES_IN_AREA: f64 = 3.464_101_615_137_754_6;

/// Squares of a page, by number, over what is drawn.
struct Squares {
    origin: Point,
    side: f64,
    columns: usize,
    rows: usize,
}

impl Squares {
    /// Over all `points`; `None` where there is none that can be drawn.
    fn over(points: impl Iterator<Item = Point>, side: f64) -> Option<Self> {
        let (mut min, mut max) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for p in points.filter(|p| p.iter().all(|v| v.is_finite())) {
            (min, max) = ([min[0].min(p[0]), min[1].min(p[1])], [max[0].max(p[0]), max[1].max(p[1])]);
        }
        let origin = min.map(|v| (v / side).floor() * side);
        let counts = [0, 1].map(|d| (max[d] - origin[d]) / side + 1.0);
        // Points are on a page; the bound keeps what is not from asking for memory.
        let is_page = counts.iter().all(|n| (1.0..1.0e4).contains(n));
        is_page.then(|| Self { origin, side, columns: counts[0] as usize, rows: counts[1] as usize })
    }

    fn of(&self, p: Point) -> usize {
        let [i, j] = [0, 1].map(|d| ((p[d] - self.origin[d]) / self.side) as usize);
        j.min(self.rows - 1) * self.columns + i.min(self.columns - 1)
    }
}

/// In each square of [`PLACE`] the first of the `centres` there; all are finite.
pub(super) fn one_in_each_place(centres: Vec<Point>) -> Vec<Point> {
    let Some(squares) = Squares::over(centres.iter().copied(), PLACE) else { return centres };
    let mut taken = vec![false; squares.columns * squares.rows];
    centres.into_iter().filter(|&p| !std::mem::replace(&mut taken[squares.of(p)], true)).collect()
}

/// Edges of a mesh, apart: those to be drawn, and the squares where they are a shade.
pub(super) struct Apart {
    /// Edges outside the shaded squares.
    pub drawn: Vec<[u32; 2]>,
    shades: Shades,
}

/// Shaded squares.
struct Shades {
    squares: Squares,
    /// Of each square, 0 where there is none.
    shade: Vec<usize>,
}

/// Tells the squares where edges are shorter than [`LEAST_LENGTH`] on average; `None` where there is none. `width` is
/// that of a drawn edge: a shade is as dark as the edges would be.
pub(super) fn apart(points: &[Point], edges: &[[u32; 2]], width: f64) -> Option<Apart> {
    let ends = |&[a, b]: &[u32; 2]| [points[a as usize], points[b as usize]];
    let middle = |[p, q]: [Point; 2]| [0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1])];
    let squares = Squares::over(edges.iter().map(|edge| middle(ends(edge))), SQUARE)?;
    let n = squares.columns * squares.rows;
    let (mut lengths, mut counts) = (vec![0.0; n], vec![0_u32; n]);
    for edge in edges {
        let [p, q] = ends(edge);
        let square = squares.of(middle([p, q]));
        lengths[square] += (q[0] - p[0]).hypot(q[1] - p[1]);
        counts[square] += 1;
    }
    let shade = |(length, count): (&f64, &u32)| {
        let mean = length / f64::from(*count);
        if *count == 0 || mean >= LEAST_LENGTH {
            return 0;
        }
        let share = (width * EDGES_IN_AREA / mean / DARKEST).min(1.0);
        ((share * SHADES as f64).round() as usize).clamp(1, SHADES)
    };
    let shade: Vec<usize> = lengths.iter().zip(&counts).map(shade).collect();
    if shade.iter().all(|shade| *shade == 0) {
        return None;
    }
    let drawn = edges.iter().copied().filter(|edge| shade[squares.of(middle(ends(edge)))] == 0).collect();
    Some(Apart { drawn, shades: Shades { squares, shade } })
}

impl Apart {
    /// The shades between `light`, without lines, and `dark`, the colour of lines, moved by `offset`: each painted over the
    /// lighter ones, so that there is no seam between them.
    pub(super) fn shades(&self, light: Rgb, dark: Rgb, offset: Point) -> Vec<Shape> {
        let Shades { squares: Squares { origin, side, columns, .. }, shade } = &self.shades;
        let of_shade = |least: usize| {
            let mut lines = Vec::new();
            for (j, row) in shade.chunks(*columns).enumerate() {
                let mut start = 0;
                for run in row.chunk_by(|a, b| (*a >= least) == (*b >= least)) {
                    if run[0] >= least {
                        let at = |d: usize, k: usize| offset[d] + origin[d] + k as f64 * side;
                        let corner = [at(0, start), at(1, j)];
                        lines.push(Polyline::rectangle(corner, [run.len() as f64 * side, *side]));
                    }
                    start += run.len();
                }
            }
            Shape::area(lines, light.mixed(dark, DARKEST * least as f64 / SHADES as f64))
        };
        let lightest = shade.iter().copied().filter(|shade| *shade > 0).min().unwrap_or(SHADES);
        (lightest..=SHADES).filter(|least| shade.iter().any(|shade| shade >= least)).map(of_shade).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_dot_is_left_in_each_place_and_those_that_stand_alone_stay() {
        let dense = (0..400_000).map(|k| [f64::from(k % 1000) * 0.1, f64::from(k / 1000) * 0.1]);
        let alone: Vec<Point> = (0..50).map(|k| [300.0 + 10.0 * f64::from(k), 500.0]).collect();
        let left = one_in_each_place(dense.chain(alone.iter().copied()).collect());
        assert!(alone.iter().all(|p| left.contains(p)));
        let places = (100.0f64 / PLACE).ceil() * (40.0f64 / PLACE).ceil();
        assert_eq!(left.len() - alone.len(), places as usize);
        assert_eq!(one_in_each_place(Vec::new()), Vec::<Point>::new());
    }

    /// A row of horizontal edges of `length`, `n` of them, and as many below.
    fn edges(length: f64, n: u32) -> (Vec<Point>, Vec<[u32; 2]>) {
        let points = (0..=n).map(|k| [f64::from(k) * length, 3.0]).collect();
        (points, (0..n).map(|k| [k, k + 1]).collect())
    }

    #[test]
    fn short_edges_are_shaded_and_long_ones_drawn() {
        let (points, lines) = edges(3.0, 100);
        assert!(apart(&points, &lines, 0.12).is_none());
        let (points, lines) = edges(0.5, 100);
        let all = apart(&points, &lines, 0.12).expect("a shade");
        assert!(all.drawn.is_empty());
        // One run of squares; with 0.12·√12/0.5 the edges would cover 0.83 of the area: the darkest shade alone.
        let shades = all.shades(Rgb::WHITE, Rgb::BLACK, [0.0; 2]);
        assert_eq!(shades.len(), 1);
        assert!(apart(&[], &[], 0.12).is_none());
    }

    #[test]
    fn a_mesh_with_both_keeps_its_long_edges() {
        let (mut points, mut lines) = edges(0.5, 100);
        let first = points.len() as u32;
        points.extend([[200.0, 3.0], [220.0, 3.0], [240.0, 3.0]]);
        lines.extend([[first, first + 1], [first + 1, first + 2]]);
        let apart = apart(&points, &lines, 0.12).expect("a shade");
        assert_eq!(apart.drawn, [[first, first + 1], [first + 1, first + 2]]);
    }
}
