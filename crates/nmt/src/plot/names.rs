//! Names of edges: above a diagram, each over its stretch; on a drawing, each beside its edge, none over another.

use super::colour::Rgb;
use super::scene::{Anchor, Direction, Point, Polyline, Shape, Stroke, Text};
use super::text::{clipped, plain, width};

/// Size of names.
const SIZE: f64 = 13.0;
/// Longest name, in page units.
const LONGEST: f64 = 110.0;
/// Least distance of upright names.
const LINE: f64 = 15.0;
/// Height of the lines that lead from upright names to their stretches.
const LEADER: f64 = 16.0;
/// Look of those lines.
const LEADER_STROKE: Stroke = Stroke { colour: Rgb(0x9a9a9a), width: 0.7, opacity: 1.0 };

/// A stretch of the abscissa with its name.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stretch<'a> {
    pub name: &'a str,
    /// Left and right end, in page units.
    pub from: f64,
    pub to: f64,
}

/// Names above a diagram: level where all fit over their stretches, else upright and led to them.
pub(super) struct Names {
    texts: Vec<String>,
    middles: Vec<f64>,
    at: Option<Vec<f64>>, // of upright names
}

impl Names {
    /// Lays out the names of stretches that follow each other; those that there is no room for even upright, the
    /// shortest stretches, stay without.
    pub fn new(stretches: &[Stretch<'_>]) -> Self {
        let room = stretches.iter().map(|s| s.to).fold(0.0, f64::max) - stretches.first().map_or(0.0, |s| s.from);
        let most = ((room / LINE) as usize).max(1);
        let mut by_length: Vec<&Stretch<'_>> = stretches.iter().collect();
        by_length.sort_by(|a, b| (b.to - b.from).total_cmp(&(a.to - a.from)).then(a.from.total_cmp(&b.from)));
        by_length.truncate(most);
        by_length.sort_by(|a, b| a.from.total_cmp(&b.from));
        let texts: Vec<String> = by_length.iter().map(|s| clipped(s.name, SIZE, LONGEST)).collect();
        let middles: Vec<f64> = by_length.iter().map(|s| 0.5 * (s.from + s.to)).collect();
        let fits = |(text, s): (&String, &&Stretch<'_>)| width(&plain(text), SIZE) + 6.0 <= s.to - s.from;
        let level = texts.iter().zip(&by_length).all(fits);
        let ends = [stretches.first().map_or(0.0, |s| s.from), stretches.last().map_or(0.0, |s| s.to)];
        let at = (!level).then(|| spread(&middles, LINE, ends));
        Self { texts, middles, at }
    }

    /// Room above the diagram.
    pub fn height(&self) -> f64 {
        let longest = self.texts.iter().map(|text| width(&plain(text), SIZE)).fold(0.0, f64::max);
        if self.at.is_some() { longest + LEADER + 4.0 } else { SIZE + 4.0 }
    }

    /// The names, over a diagram whose upper edge is at `bottom`.
    pub fn draw(&self, bottom: f64) -> Vec<Shape> {
        let Some(at) = &self.at else {
            let text = |(text, x): (&String, &f64)| Shape::text([*x, bottom - 5.0], SIZE, Anchor::Middle, plain(text));
            return self.texts.iter().zip(&self.middles).map(text).collect();
        };
        let leader = |(x, middle): (&f64, &f64)| {
            Polyline::open(vec![[*x, bottom - LEADER + 1.0], [*x, bottom - LEADER + 4.0], [*middle, bottom]])
        };
        let mut shapes = vec![Shape::lines(at.iter().zip(&self.middles).map(leader).collect(), LEADER_STROKE)];
        for (text, x) in self.texts.iter().zip(at) {
            shapes.push(Shape::Text(Text {
                at: [x + 0.35 * SIZE, bottom - LEADER - 1.0],
                size: SIZE,
                anchor: Anchor::Start,
                direction: Direction::Upwards,
                runs: plain(text),
            }));
        }
        shapes
    }
}

/// Places near `wanted` (ascending) within `ends`, at least `distance` apart: runs that would overlap are centred together.
fn spread(wanted: &[f64], distance: f64, ends: [f64; 2]) -> Vec<f64> {
    struct Run {
        sum: f64, // of where its members would have its first
        n: usize,
    }
    let middle = |run: &Run| {
        let last = (ends[1] - distance * (run.n as f64 - 0.5)).max(ends[0] + 0.5 * distance);
        (run.sum / run.n as f64).clamp(ends[0] + 0.5 * distance, last)
    };
    let mut runs: Vec<Run> = Vec::new();
    for &x in wanted {
        let mut run = Run { sum: x, n: 1 };
        while let Some(before) = runs.last() {
            if middle(before) + distance * before.n as f64 <= middle(&run) {
                break;
            }
            let shift = distance * before.n as f64 * run.n as f64;
            run = Run { sum: before.sum + run.sum - shift, n: before.n + run.n };
            runs.pop();
        }
        runs.push(run);
    }
    runs.iter().flat_map(|run| (0..run.n).map(move |k| middle(run) + distance * k as f64)).collect()
}

/// An edge on a drawing: its points on the page in order, and its name.
pub(super) struct Named<'a> {
    pub name: &'a str,
    pub points: &'a [Point],
    /// 1 where what lies on the left of its way, as the page shows it, is the material, otherwise −1.
    pub material: f64,
}

/// How far from their edges names stand: outside the material, inside, then farther away.
const OFFSETS: [f64; 4] = [6.0, -6.0, 20.0, -20.0];

/// Names beside the middles of their edges, the longest edge first; one that would lie on another, on an edge, on one of
/// the boxes `taken` or beyond `bounds` is left out. Boxes are left, top, right, bottom.
pub(super) fn beside(edges: &[Named<'_>], mut taken: Vec<[f64; 4]>, bounds: [f64; 4]) -> Vec<Shape> {
    let lines: Vec<[Point; 2]> = edges.iter().flat_map(|e| e.points.windows(2).map(|p| [p[0], p[1]])).collect();
    let mut order: Vec<&Named<'_>> = edges.iter().filter(|edge| edge.points.len() > 1).collect();
    let length = |edge: &Named<'_>| edge.points.windows(2).map(|p| (p[1][0] - p[0][0]).hypot(p[1][1] - p[0][1])).sum();
    order.sort_by(|a, b| f64::total_cmp(&length(b), &length(a)));
    let mut shapes = Vec::new();
    for edge in order {
        let text = clipped(edge.name, SIZE, LONGEST);
        let half = [0.5 * width(&plain(&text), SIZE), 0.4 * SIZE];
        let k = (edge.points.len() - 1) / 2;
        let (p, q) = (edge.points[k], edge.points[k + 1]);
        let along = [q[0] - p[0], q[1] - p[1]];
        let size = along[0].hypot(along[1]).max(f64::MIN_POSITIVE);
        // On the page y leads down: the left of the way is (along_y, −along_x).
        let outward = [-edge.material * along[1] / size, edge.material * along[0] / size];
        let middle = if edge.points.len() % 2 == 0 { [0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1])] } else { p };
        let free = OFFSETS.iter().find_map(|offset| {
            let reach = offset + offset.signum() * (half[0] * outward[0].abs() + half[1] * outward[1].abs());
            let centre = [middle[0] + reach * outward[0], middle[1] + reach * outward[1]];
            let own = [centre[0] - half[0], centre[1] - half[1], centre[0] + half[0], centre[1] + half[1]];
            let inside = own[0] >= bounds[0] && own[1] >= bounds[1] && own[2] <= bounds[2] && own[3] <= bounds[3];
            let grown = [own[0] - 2.0, own[1] - 2.0, own[2] + 2.0, own[3] + 2.0];
            let clear = !taken.iter().any(|other| overlap(grown, *other)) && !lines.iter().any(|l| meets(grown, *l));
            (inside && clear).then_some((centre, own))
        });
        if let Some((centre, own)) = free {
            taken.push(own);
            let at = [centre[0], super::axes::centred_baseline(centre[1], SIZE)];
            shapes.push(Shape::text(at, SIZE, Anchor::Middle, plain(text)));
        }
    }
    shapes
}

/// True where two boxes have more than their sides in common.
pub(super) fn overlap(a: [f64; 4], b: [f64; 4]) -> bool {
    a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3]
}

/// True where a straight line passes through a box: clipped to it, something is left.
pub(super) fn meets(bounds: [f64; 4], [p, q]: [Point; 2]) -> bool {
    let (mut low, mut high) = (0.0f64, 1.0f64);
    for k in 0..2 {
        let d = q[k] - p[k];
        let (near, far) = (bounds[k] - p[k], bounds[k + 2] - p[k]);
        if d.abs() < 1e-12 {
            // In page units: the line runs along the side.
            if near > 0.0 || far < 0.0 {
                return false;
            }
            continue;
        }
        let (a, b) = (near / d, far / d);
        low = low.max(a.min(b));
        high = high.min(a.max(b));
    }
    low <= high
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crowded_names_are_spread_and_stay_in_order_within_the_diagram() {
        let at = spread(&[1.0, 2.0, 3.0, 50.0, 99.0, 99.5], 10.0, [0.0, 100.0]);
        assert!(at.windows(2).all(|pair| pair[1] - pair[0] >= 10.0 - 1e-9), "{at:?}"); // rounding
        assert!(at[0] >= 5.0 && at[5] <= 95.0 + 1e-9, "{at:?}");
        assert_eq!(spread(&[20.0, 40.0], 10.0, [0.0, 100.0]), [20.0, 40.0]);
    }

    #[test]
    fn a_line_meets_the_boxes_it_passes_through() {
        let unit = [0.0, 0.0, 1.0, 1.0];
        assert!(meets(unit, [[-1.0, 0.5], [2.0, 0.5]]) && meets(unit, [[0.5, 0.5], [0.6, 0.6]]));
        assert!(!meets(unit, [[-1.0, 2.0], [2.0, 2.0]]) && !meets(unit, [[-1.0, 0.0], [0.4, 1.9]]));
    }
}
