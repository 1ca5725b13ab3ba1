//! A diagram of a quantity over a length: frame, ticks, the curve with its area, cut off at the top of its axis.

use super::axes::{FRAME_STROKE, LABEL_SIZE, TICK_GAP, TICK_LENGTH, TICK_SIZE, centred_baseline};
use super::colour::Rgb;
use super::scene::{Anchor, Direction, Point, Polyline, Shape, Stroke, Text};
use super::text::{CAP_HEIGHT, Run, plain, width};
use super::ticks::{Decimal, TICK_STEPS, Ticks, step_at_least, unit_exponent};

/// Least distance of ticks, in page units.
const TICK_DISTANCE: Point = [70.0, 30.0];
/// Lines of the grid.
const GRID: Stroke = Stroke { colour: Rgb(0xe3e3e3), width: 0.8, opacity: 1.0 };

/// Where a diagram stands and what it shows: abscissas from 0 to `reach[0]`, ordinates from 0 to `reach[1]`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Strip {
    /// Upper left corner of the frame.
    pub origin: Point,
    /// Size of the frame.
    pub size: Point,
    /// Greatest abscissa and ordinate, both above 0.
    pub reach: Point,
}

impl Strip {
    /// Room below the frame for ticks, their labels and the label of the axis.
    pub const BELOW: f64 = TICK_LENGTH + TICK_GAP + TICK_SIZE + 6.0 + LABEL_SIZE;

    pub fn x(&self, s: f64) -> f64 {
        self.origin[0] + self.size[0] * (s / self.reach[0])
    }

    pub fn y(&self, value: f64) -> f64 {
        self.bottom() - self.size[1] * (value / self.reach[1])
    }

    pub fn bottom(&self) -> f64 {
        self.origin[1] + self.size[1]
    }

    /// Grid below the curve.
    pub fn grid(&self) -> Shape {
        let lines = self.ticks(1).at.into_iter().map(|value| {
            let y = self.y(value);
            Polyline::open(vec![[self.origin[0], y], [self.origin[0] + self.size[0], y]])
        });
        Shape::lines(lines.collect(), GRID)
    }

    /// The curve through `points` (abscissa, ordinate) and the area below it; above the frame it is cut off.
    pub fn curve(&self, points: &[Point], fill: Rgb, line: Stroke) -> [Shape; 2] {
        let within = below(points, self.reach[1]);
        let page: Vec<Point> = within.iter().map(|&[s, value]| [self.x(s), self.y(value.max(0.0))]).collect();
        let mut area = page.clone();
        if let (Some(first), Some(last)) = (page.first(), page.last()) {
            area.extend([[last[0], self.bottom()], [first[0], self.bottom()]]);
        }
        [Shape::area(vec![Polyline::closed(area)], fill), Shape::lines(vec![Polyline::open(page)], line)]
    }

    /// Frame, ticks and labels; `units` is the length unit or empty.
    pub fn axes(&self, abscissa: Vec<Run>, ordinate: Vec<Run>, units: &str) -> Shape {
        let mut lines = vec![Polyline::rectangle(self.origin, self.size)];
        let mut shapes = Vec::new();
        let ticks = self.ticks(0);
        for (at, label) in ticks.at.iter().zip(&ticks.labels) {
            let x = self.x(*at);
            lines.push(Polyline::open(vec![[x, self.bottom()], [x, self.bottom() + TICK_LENGTH]]));
            let baseline = self.bottom() + TICK_LENGTH + TICK_GAP + CAP_HEIGHT * TICK_SIZE;
            shapes.push(Shape::text([x, baseline], TICK_SIZE, Anchor::Middle, plain(label)));
        }
        let ticks = self.ticks(1);
        let left = self.origin[0];
        for (at, label) in ticks.at.iter().zip(&ticks.labels) {
            let y = self.y(*at);
            lines.push(Polyline::open(vec![[left, y], [left - TICK_LENGTH, y]]));
            let at = [left - TICK_LENGTH - TICK_GAP, centred_baseline(y, TICK_SIZE)];
            shapes.push(Shape::text(at, TICK_SIZE, Anchor::End, plain(label)));
        }
        let widest = ticks.labels.iter().map(|label| width(&plain(label), TICK_SIZE)).fold(0.0, f64::max);
        let below = [left + 0.5 * self.size[0], self.bottom() + Self::BELOW - 0.22 * LABEL_SIZE];
        let abscissa = with_unit(abscissa, units, unit_exponent(self.reach[0]));
        shapes.push(Shape::text(below, LABEL_SIZE, Anchor::Middle, abscissa));
        shapes.push(Shape::Text(Text {
            at: [left - TICK_LENGTH - TICK_GAP - widest - 8.0, self.origin[1] + 0.5 * self.size[1]],
            size: LABEL_SIZE,
            anchor: Anchor::Middle,
            direction: Direction::Upwards,
            runs: with_unit(ordinate, "", unit_exponent(self.reach[1])),
        }));
        shapes.insert(0, Shape::lines(lines, FRAME_STROKE));
        Shape::Group { id: "axes", shapes }
    }

    fn ticks(&self, k: usize) -> Ticks {
        let step: Decimal = step_at_least(self.reach[k] * (TICK_DISTANCE[k] / self.size[k]), TICK_STEPS);
        Ticks::new(step, 0.0, self.reach[k], unit_exponent(self.reach[k]))
    }
}

/// `s [mm]`, `s [10³ mm]`, `τ [10⁶]`.
fn with_unit(mut label: Vec<Run>, units: &str, exponent: i32) -> Vec<Run> {
    let units = super::text::clipped(units, LABEL_SIZE, 120.0);
    if exponent != 0 || !units.is_empty() {
        label.push(Run::upright(" ["));
        if exponent != 0 {
            label.extend(super::ticks::power_of_ten(exponent));
        }
        let space = if exponent != 0 && !units.is_empty() { " " } else { "" };
        label.push(Run::upright(format!("{space}{units}]")));
    }
    label
}

/// The line through `points`, with what is above `top` at `top`: where it passes through, a point is put in.
fn below(points: &[Point], top: f64) -> Vec<Point> {
    let mut line: Vec<Point> = Vec::with_capacity(points.len());
    for (k, &[s, value]) in points.iter().enumerate() {
        let before = k.checked_sub(1).and_then(|before| points.get(before));
        if let Some(&[s0, v0]) = before.filter(|before| (before[1] > top) != (value > top)) {
            line.push([s0 + (s - s0) * ((top - v0) / (value - v0)), top]);
        }
        line.push([s, value.min(top)]);
    }
    line
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_above_the_axis_is_cut_where_the_line_passes_through() {
        let cut = below(&[[0.0, 0.0], [1.0, 4.0], [2.0, 0.0]], 2.0);
        assert_eq!(cut, [[0.0, 0.0], [0.5, 2.0], [1.0, 2.0], [1.5, 2.0], [2.0, 0.0]]);
        assert!(below(&[], 1.0).is_empty());
    }
}
