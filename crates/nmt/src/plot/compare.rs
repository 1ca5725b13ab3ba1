//! The picture of errors against cost, both logarithmic: a line and marks for each series, named beside the frame.

use super::axes::{FRAME_STROKE, LABEL_SIZE, TICK_GAP, TICK_LENGTH, TICK_SIZE, centred_baseline};
use super::colour::{Rgb, of_subdomain};
use super::page::{MARGIN, PAGE_WIDTH, description, title};
use super::scene::{Anchor, Direction, MarkForm, Point, Polyline, Scene, Shape, Stroke, Text};
use super::text::{CAP_HEIGHT, Run, Style, clipped, plain};
use super::ticks::{Decimal, decade, power_of_ten, signed};
use super::{Caption, ErrorSeries};

/// Size of the frame; the legend stands to its right.
const FRAME: [f64; 2] = [640.0, 520.0];
/// Left of the frame: ticks, their labels, the label of the axis.
const LEFT: f64 = MARGIN + 80.0;
/// Between the frame and the legend.
const LEGEND_GAP: f64 = 18.0;
/// Size of legend texts.
const LEGEND_SIZE: f64 = 14.0;
/// From line to line of the legend.
const LEGEND_LINE: f64 = 25.0;
/// Length of the line that shows a series in the legend.
const SAMPLE: f64 = 30.0;
/// Size of marks.
const MARK: f64 = 9.0;
/// Lines of the grid.
const GRID: Stroke = Stroke { colour: Rgb(0xe3e3e3), width: 0.8, opacity: 1.0 };
/// Free room at either end of an axis, in decades.
const PADDING: f64 = 0.12;
/// On axes shorter than this many decades 1, 2 and 5 of each are labelled, on longer ones powers of ten alone.
const SHORT_AXIS: f64 = 2.5;
/// Exponents of ten whose numbers read well in full.
const PLAIN: std::ops::Range<i32> = -3..6;
/// Least distance of labels of the upright axis.
const LABEL_DISTANCE: f64 = 22.0;

/// A logarithmic axis: from `low` to `high` in decades.
struct LogAxis {
    low: f64,
    high: f64,
}

/// A place on an axis: mantissa and exponent.
struct Tick {
    digits: i128,
    exponent: i32,
}

impl LogAxis {
    /// That shows all values, or one decade where there is none.
    fn of(values: impl Iterator<Item = f64>) -> Self {
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
            let log = v.log10();
            (low.min(log), high.max(log))
        });
        if low > high {
            return Self { low: 0.0, high: 1.0 };
        }
        // Where all values are one, a decade is shown about it.
        let padding = if high - low < 0.5 { 0.5 - 0.5 * (high - low) } else { PADDING };
        Self { low: low - padding, high: high + padding }
    }

    /// 0 at the lower end, 1 at the upper.
    fn share(&self, value: f64) -> f64 {
        (value.log10() - self.low) / (self.high - self.low)
    }

    fn ticks(&self, length: f64) -> Vec<Tick> {
        let decades = self.high - self.low;
        let digits: &[i128] = if decades < SHORT_AXIS { &[1, 2, 5] } else { &[1] };
        // Powers of ten at every second, third … decade where all would crowd.
        let stride = (LABEL_DISTANCE * decades / length).ceil().max(1.0) as i32;
        let exponents = (self.low.floor() as i32..=self.high.ceil() as i32).filter(|e| e.rem_euclid(stride) == 0);
        exponents
            .flat_map(|exponent| digits.iter().map(move |&digits| Tick { digits, exponent }))
            .filter(|tick| (0.0..=1.0).contains(&self.share(tick.value())))
            .collect()
    }

    /// Ticks with their labels: as plain numbers where all read well so, otherwise all with powers of ten.
    fn labelled(&self, length: f64) -> Vec<(f64, Vec<Run>)> {
        let ticks = self.ticks(length);
        let plainly = self.high - self.low < SHORT_AXIS && ticks.iter().all(|t| PLAIN.contains(&t.exponent));
        ticks.iter().map(|tick| (tick.value(), tick.label(plainly))).collect()
    }
}

impl Tick {
    fn value(&self) -> f64 {
        Decimal { digits: self.digits, exponent: self.exponent }.value()
    }

    fn label(&self, plainly: bool) -> Vec<Run> {
        match self.digits {
            digits if plainly => plain(Decimal { digits, exponent: self.exponent }.in_units_of(0)),
            1 => power_of_ten(self.exponent),
            digits => {
                let ten = Run::upright(format!("{digits}·10"));
                vec![ten, Run::new(signed(self.exponent), Style::Superscript)]
            }
        }
    }
}

/// Colour of a family of methods; the first is grey, for what the others are compared with.
fn colour(family: usize) -> Rgb {
    if family == 0 { Rgb(0x555555) } else { of_subdomain(family - 1) }
}

/// Mark of an order: a cross for 1, then disc, square, triangle.
fn marks(centres: Vec<Point>, order: usize, colour: Rgb) -> Shape {
    let polygons = |corners: &[[f64; 2]]| {
        let at = |c: &Point| corners.iter().map(|d| [c[0] + MARK * d[0], c[1] + MARK * d[1]]).collect();
        Shape::area(centres.iter().map(|c| Polyline::closed(at(c))).collect(), colour)
    };
    match order {
        2 => Shape::Marks { centres, form: MarkForm::Disc, size: MARK, colour },
        3 => Shape::Marks { centres, form: MarkForm::Square, size: MARK, colour },
        4 => polygons(&[[-0.6, 0.46], [0.6, 0.46], [0.0, -0.62]]),
        _ => polygons(&[[-0.65, 0.0], [0.0, 0.65], [0.65, 0.0], [0.0, -0.65]]),
    }
}

/// The figure; points that are not positive cannot be shown.
pub(super) fn scene(caption: &Caption<'_>, cost: &str, error: &str, series: &[ErrorSeries<'_>]) -> Scene {
    let shown = |p: &&[f64; 2]| p.iter().all(|&v| v.is_normal() && v > 0.0 && super::is_drawable(v));
    let points: Vec<Vec<[f64; 2]>> = series.iter().map(|s| s.points.iter().filter(shown).copied().collect()).collect();
    let axes = [0, 1].map(|k| LogAxis::of(points.iter().flatten().map(move |p| p[k])));

    let (mut shapes, title_height) = title(caption, PAGE_WIDTH);
    let origin = [LEFT, MARGIN + title_height.max(0.5 * TICK_SIZE)];
    let [left, bottom] = [origin[0], origin[1] + FRAME[1]];
    let to_page = |p: &[f64; 2]| [left + FRAME[0] * axes[0].share(p[0]), bottom - FRAME[1] * axes[1].share(p[1])];

    shapes.push(frame(&axes, origin));
    let middle = [left + 0.5 * FRAME[0], origin[1] + 0.5 * FRAME[1]];
    let below = bottom + TICK_LENGTH + TICK_GAP + TICK_SIZE + 8.0 + LABEL_SIZE;
    shapes.push(Shape::text([middle[0], below], LABEL_SIZE, Anchor::Middle, plain(cost)));
    shapes.push(Shape::Text(Text {
        at: [MARGIN + LABEL_SIZE, middle[1]],
        size: LABEL_SIZE,
        anchor: Anchor::Middle,
        direction: Direction::Upwards,
        runs: plain(error),
    }));

    let mut legend = Vec::new();
    for (k, (s, points)) in series.iter().zip(&points).enumerate() {
        let colour = colour(s.family);
        let line = Stroke::new(colour, 1.6);
        let at: Vec<Point> = points.iter().map(to_page).collect();
        shapes.push(Shape::lines(vec![Polyline::open(at.clone())], line));
        shapes.push(marks(at, s.order, colour));

        let x = left + FRAME[0] + LEGEND_GAP;
        let y = origin[1] + (k as f64 + 0.5) * LEGEND_LINE;
        legend.push(Shape::lines(vec![Polyline::open(vec![[x, y], [x + SAMPLE, y]])], line));
        legend.push(marks(vec![[x + 0.5 * SAMPLE, y]], s.order, colour));
        let from = x + SAMPLE + 8.0;
        let about = if points.is_empty() { format!("{} (none)", s.name) } else { s.name.to_owned() };
        let name = clipped(&about, LEGEND_SIZE, PAGE_WIDTH - from - 2.0);
        legend.push(Shape::text([from, centred_baseline(y, LEGEND_SIZE)], LEGEND_SIZE, Anchor::Start, plain(name)));
    }
    shapes.push(Shape::Group { id: "legend", shapes: legend });
    let description = description(caption, &format!("{error} against {cost}"));
    Scene { width: PAGE_WIDTH, height: (below + MARGIN).ceil(), description, shapes }
}

/// Grid, frame, ticks and their labels.
fn frame(axes: &[LogAxis; 2], origin: Point) -> Shape {
    let [left, top] = origin;
    let bottom = top + FRAME[1];
    let mut lines = vec![Polyline::rectangle(origin, FRAME)];
    let (mut grid, mut labels) = (Vec::new(), Vec::new());
    for (value, label) in axes[0].labelled(FRAME[0]) {
        let x = left + FRAME[0] * axes[0].share(value);
        grid.push(Polyline::open(vec![[x, top], [x, bottom]]));
        lines.push(Polyline::open(vec![[x, bottom], [x, bottom + TICK_LENGTH]]));
        let at = [x, bottom + TICK_LENGTH + TICK_GAP + CAP_HEIGHT * TICK_SIZE];
        labels.push(Shape::text(at, TICK_SIZE, Anchor::Middle, label));
    }
    for (value, label) in axes[1].labelled(FRAME[1]) {
        let y = bottom - FRAME[1] * axes[1].share(value);
        grid.push(Polyline::open(vec![[left, y], [left + FRAME[0], y]]));
        lines.push(Polyline::open(vec![[left, y], [left - TICK_LENGTH, y]]));
        let at = [left - TICK_LENGTH - TICK_GAP, centred_baseline(y, TICK_SIZE)];
        labels.push(Shape::text(at, TICK_SIZE, Anchor::End, label));
    }
    // Marks of the ninths of a decade, without labels.
    for (k, axis) in axes.iter().enumerate() {
        let first = decade(10f64.powf(axis.low.clamp(-290.0, 290.0)));
        let fits = axis.high - axis.low < 6.0;
        for exponent in (first..=axis.high.ceil() as i32).filter(|_| fits) {
            for digits in 2..10 {
                let share = axis.share(Tick { digits, exponent }.value());
                let (x, y) = (left + FRAME[0] * share, bottom - FRAME[1] * share);
                match k {
                    _ if !(0.0..=1.0).contains(&share) => {}
                    0 => lines.push(Polyline::open(vec![[x, bottom], [x, bottom + 0.5 * TICK_LENGTH]])),
                    _ => lines.push(Polyline::open(vec![[left, y], [left - 0.5 * TICK_LENGTH, y]])),
                }
            }
        }
    }
    let mut shapes = vec![Shape::lines(grid, GRID), Shape::lines(lines, FRAME_STROKE)];
    shapes.append(&mut labels);
    Shape::Group { id: "axes", shapes }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_axes_are_labelled_at_one_two_five_and_long_ones_at_powers_of_ten() {
        let labels = |low: f64, high: f64| -> Vec<f64> {
            LogAxis::of([low, high].into_iter()).ticks(500.0).iter().map(Tick::value).collect()
        };
        assert_eq!(labels(361.0, 6241.0), [500.0, 1000.0, 2000.0, 5000.0]);
        assert_eq!(labels(1e-7, 1e-3), [1e-7, 1e-6, 1e-5, 1e-4, 1e-3]);
        assert!(labels(1e-200, 1e200).len() < 25);
    }

    #[test]
    fn whatever_comes_in_a_tidy_page_comes_out() {
        let caption = Caption { title: "", units: "" };
        for points in [vec![], vec![[1.0, 0.0]], vec![[f64::NAN, 1.0], [1e300, 1.0]], vec![[5.0, 1e-16]]] {
            let series = [ErrorSeries { name: "fem", points: &points, family: 0, order: 1 }];
            let scene = scene(&caption, "unknowns", "error", &series);
            assert!(!super::super::svg::render(&scene).contains("NaN"));
        }
    }
}
