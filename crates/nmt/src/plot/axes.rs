//! From the plane to the page at equal scale, with a frame, ticks and axis labels.

use super::Part;
use super::colour::Rgb;
use super::is_drawable;
use super::scene::{Anchor, Direction, Point, Polyline, Shape, Stroke, Text};
use super::text::{CAP_HEIGHT, Run, Style, plain, width};
use super::ticks::{Decimal, TICK_STEPS, Ticks, multiples, power_of_ten, step_at_least, unit_exponent};

/// Between the outline and the frame, in page units: room for marks, whatever the shape of the section.
const PADDING: f64 = 14.0;
/// Least width and height of a frame, so that slender sections keep readable axes.
pub(super) const LEAST_FRAME: f64 = 112.0;
/// Size of tick labels.
pub(super) const TICK_SIZE: f64 = 13.0;
/// Size of axis labels.
pub(super) const LABEL_SIZE: f64 = 15.0;
/// Length of a tick.
pub(super) const TICK_LENGTH: f64 = 5.0;
/// Between a tick and its label.
pub(super) const TICK_GAP: f64 = 4.0;
/// Between tick labels and the axis label.
const LABEL_GAP: f64 = 8.0;
/// Height of all that stands below a frame: ticks, their labels, the label of the axis.
const X_LABELS: f64 = TICK_LENGTH + TICK_GAP + TICK_SIZE + LABEL_GAP + LABEL_SIZE;
/// Least free space between neighbouring tick labels of the x axis.
const LABEL_SPACE: f64 = 12.0;
/// Least distance of ticks on a long axis.
const TICK_DISTANCE: [f64; 2] = [56.0, 44.0];
/// Where to have two ticks at all, those of the y axis may be this close.
const LEAST_TICK_DISTANCE: f64 = 1.6 * TICK_SIZE;
/// Most intervals between ticks on a long axis.
const MOST_INTERVALS: f64 = 9.0;
/// Axes longer than this have ticks at one distance; on shorter ones it would leave too few.
const LONG_AXIS: f64 = 180.0;

/// Extents smaller than this share of the coordinates are rounding: the part is drawn as a point.
const POINT_REL: f64 = 1.0e-12;
/// Extents below this cannot be scaled to the page without overflow.
const POINT_ABS: f64 = 1.0e-290;

/// Lines of frames and ticks.
pub(super) const FRAME_STROKE: Stroke = Stroke { colour: Rgb::INK, width: 1.0, opacity: 1.0 };

/// Baseline of a text of this size whose capitals are centred on `y`.
pub(super) fn centred_baseline(y: f64, size: f64) -> f64 {
    y + 0.5 * CAP_HEIGHT * size
}

/// Smallest and largest coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Extent {
    pub min: Point,
    pub max: Point,
}

impl Extent {
    /// Of all nodes that can be drawn; the unit square where there is none.
    pub fn of<'a>(parts: impl Iterator<Item = &'a Part<'a>>) -> Self {
        let nothing = Self { min: [f64::INFINITY; 2], max: [f64::NEG_INFINITY; 2] };
        let nodes = parts.flat_map(|part| part.xy).filter(|p| p.iter().all(|&v| is_drawable(v)));
        let extent = nodes.fold(nothing, |e, p| Self {
            min: [e.min[0].min(p[0]), e.min[1].min(p[1])],
            max: [e.max[0].max(p[0]), e.max[1].max(p[1])],
        });
        if extent.min[0] <= extent.max[0] { extent } else { Self { min: [0.0; 2], max: [1.0; 2] } }
    }

    /// Width and height.
    pub fn span(&self) -> [f64; 2] {
        [self.max[0] - self.min[0], self.max[1] - self.min[1]]
    }
}

/// A window on the plane: what of it is seen, how large, in a frame of which size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct View {
    /// Point of the plane at the lower left corner of the frame.
    pub corner: Point,
    /// Page units to a length unit, along both axes.
    pub scale: f64,
    /// Size of the frame in page units.
    pub size: [f64; 2],
}

impl View {
    /// The largest view of `extent` whose frame fits into `room`, but for [`LEAST_FRAME`].
    pub fn fit(extent: &Extent, room: [f64; 2]) -> Self {
        let [dx, dy] = extent.span();
        let magnitude = extent.min.iter().chain(&extent.max).fold(0.0, |m: f64, v| m.max(v.abs()));
        let inner = room.map(|r| (r.max(LEAST_FRAME)) - 2.0 * PADDING);
        let length = dx.max(dy);
        let is_point = !(length > POINT_REL * magnitude && length > POINT_ABS);
        let scale = match is_point {
            true if magnitude > POINT_ABS => inner[0].min(inner[1]) / magnitude,
            true => inner[0].min(inner[1]),
            false if dx * inner[1] >= dy * inner[0] => inner[0] / dx,
            false => inner[1] / dy,
        };
        let frame = |d: f64| (d * scale + 2.0 * PADDING).max(LEAST_FRAME);
        let size = [frame(dx), frame(dy)];
        let corner = |k: usize| 0.5 * (extent.min[k] + extent.max[k]) - 0.5 * size[k] / scale;
        Self { corner: [corner(0), corner(1)], scale, size }
    }

    /// The page point of a point of the plane, the frame's upper left corner being at `origin`.
    pub fn to_page(self, origin: Point, p: [f64; 2]) -> Point {
        let x = origin[0] + (p[0] - self.corner[0]) * self.scale;
        let y = origin[1] + self.size[1] - (p[1] - self.corner[1]) * self.scale;
        [x, y]
    }

    /// Interval of coordinate `k` that the frame shows.
    fn shown(&self, k: usize) -> [f64; 2] {
        [self.corner[k], self.corner[k] + self.size[k] / self.scale]
    }
}

/// Room that ticks and labels take around a frame, in page units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Margins {
    pub left: f64,
    pub right: f64,
    pub top: f64,
    pub bottom: f64,
}

/// Ticks and labels of a view, ready to be drawn at one or more places.
#[derive(Clone, Debug)]
pub(super) struct Axes {
    pub view: View,
    ticks: [Ticks; 2],
    labels: [Vec<Run>; 2],
}

impl Axes {
    /// Ticks at 1-2-5 steps, as many as have room; both long axes with one step. `units` is the length unit or empty.
    pub fn new(view: View, units: &str) -> Self {
        let shown = [view.shown(0), view.shown(1)];
        let largest = |[low, high]: [f64; 2]| {
            let magnitude = low.abs().max(high.abs());
            let span = high - low;
            if Ticks::new(step_at_least(span, TICK_STEPS), low, high, 0).offset.is_some() { span } else { magnitude }
        };
        let unit = unit_exponent(largest(shown[0]).max(largest(shown[1])));
        let mut steps = [0, 1].map(|k| choose_step(&view, k, unit));
        if view.size.iter().all(|&s| s > LONG_AXIS) {
            let coarser = if steps[0].value() > steps[1].value() { steps[0] } else { steps[1] };
            steps = [coarser; 2];
        }
        let ticks = [0, 1].map(|k| Ticks::new(steps[k], shown[k][0], shown[k][1], unit));
        let labels = [axis_label("x", units, unit, ticks[0].offset), axis_label("y", units, unit, ticks[1].offset)];
        Self { view, ticks, labels }
    }

    /// Room needed around the frame.
    pub fn margins(&self) -> Margins {
        let y_labels = self.ticks[1].labels.iter().map(|l| width(&plain(l), TICK_SIZE)).fold(0.0, f64::max);
        let [frame_width, frame_height] = self.view.size;
        let (mut beyond_left, mut beyond_right): (f64, f64) = (0.0, 0.0);
        for (at, label) in self.ticks[0].at.iter().zip(&self.ticks[0].labels) {
            let (x, half) = ((at - self.view.corner[0]) * self.view.scale, 0.5 * width(&plain(label), TICK_SIZE));
            beyond_left = beyond_left.max(half - x);
            beyond_right = beyond_right.max(x + half - frame_width);
        }
        let x_label_excess = 0.5 * (width(&self.labels[0], LABEL_SIZE) - frame_width);
        let y_label_excess = 0.5 * (width(&self.labels[1], LABEL_SIZE) - frame_height);
        let left = TICK_LENGTH + TICK_GAP + y_labels + LABEL_GAP + LABEL_SIZE;
        Margins {
            left: left.max(beyond_left).max(x_label_excess),
            right: beyond_right.max(x_label_excess).max(0.0),
            top: y_label_excess.max(0.0),
            bottom: X_LABELS.max(y_label_excess),
        }
    }

    /// Frame, ticks and labels, the frame's upper left corner being at `origin`.
    pub fn draw(&self, origin: Point) -> Shape {
        let [left, top] = origin;
        let [frame_width, frame_height] = self.view.size;
        let bottom = top + frame_height;
        let mut lines = vec![Polyline::rectangle(origin, self.view.size)];
        let mut shapes = Vec::new();
        for (&at, label) in self.ticks[0].at.iter().zip(&self.ticks[0].labels) {
            let x = left + (at - self.view.corner[0]) * self.view.scale;
            lines.push(Polyline::open(vec![[x, bottom], [x, bottom + TICK_LENGTH]]));
            let baseline = bottom + TICK_LENGTH + TICK_GAP + CAP_HEIGHT * TICK_SIZE;
            shapes.push(Shape::text([x, baseline], TICK_SIZE, Anchor::Middle, plain(label)));
        }
        let mut y_labels: f64 = 0.0;
        for (&at, label) in self.ticks[1].at.iter().zip(&self.ticks[1].labels) {
            let y = bottom - (at - self.view.corner[1]) * self.view.scale;
            lines.push(Polyline::open(vec![[left, y], [left - TICK_LENGTH, y]]));
            let at = [left - TICK_LENGTH - TICK_GAP, centred_baseline(y, TICK_SIZE)];
            shapes.push(Shape::text(at, TICK_SIZE, Anchor::End, plain(label)));
            y_labels = y_labels.max(width(&plain(label), TICK_SIZE));
        }
        let x_baseline = bottom + X_LABELS - 0.22 * LABEL_SIZE;
        let x_at = [left + 0.5 * frame_width, x_baseline];
        shapes.push(Shape::text(x_at, LABEL_SIZE, Anchor::Middle, self.labels[0].clone()));
        let y_baseline = left - TICK_LENGTH - TICK_GAP - y_labels - LABEL_GAP;
        shapes.push(Shape::Text(Text {
            at: [y_baseline, top + 0.5 * frame_height],
            size: LABEL_SIZE,
            anchor: Anchor::Middle,
            direction: Direction::Upwards,
            runs: self.labels[1].clone(),
        }));
        shapes.insert(0, Shape::lines(lines, FRAME_STROKE));
        Shape::Group { id: "axes", shapes }
    }
}

/// Step of the ticks along coordinate `k`: wide enough for the labels, finer only where there would be but one tick.
fn choose_step(view: &View, k: usize, unit: i32) -> Decimal {
    let [low, high] = view.shown(k);
    let fits = |step: Decimal| {
        let distance = step.value() * view.scale;
        match k {
            0 => Ticks::new(step, low, high, unit)
                .labels
                .iter()
                .all(|label| width(&plain(label), TICK_SIZE) + LABEL_SPACE <= distance),
            _ => distance >= LEAST_TICK_DISTANCE,
        }
    };
    let wanted = TICK_DISTANCE[k].max(view.size[k] / MOST_INTERVALS) / view.scale;
    let mut step = step_at_least(wanted, TICK_STEPS);
    for _ in 0..12 {
        if fits(step) {
            break;
        }
        step = step_at_least(1.5 * step.value(), TICK_STEPS);
    }
    while multiples(step, low, high).count() < 2 {
        let finer = step_at_least(0.35 * step.value(), TICK_STEPS);
        if finer == step || !fits(finer) {
            break;
        }
        step = finer;
    }
    step
}

/// `x [m]`, with a power of ten or an offset where the ticks are written with one.
fn axis_label(name: &str, units: &str, exponent: i32, offset: Option<Decimal>) -> Vec<Run> {
    let units = super::text::clipped(units, LABEL_SIZE, LEAST_FRAME);
    let mut runs = vec![Run::new(name, Style::Italic)];
    if let Some(offset) = offset {
        let sign = if offset.digits < 0 { "+" } else { "−" };
        let magnitude = Decimal { digits: offset.digits.saturating_abs(), ..offset };
        runs.push(Run::upright(format!(" {sign} ")));
        if (-6..=6).contains(&magnitude.exponent) {
            runs.push(Run::upright(magnitude.in_units_of(0)));
        } else {
            runs.push(Run::upright(format!("{}×", magnitude.digits)));
            runs.extend(power_of_ten(magnitude.exponent));
        }
        if !units.is_empty() {
            runs.push(Run::upright(format!(" {units}")));
        }
    }
    match (exponent, units.is_empty()) {
        (0, true) => {}
        (0, false) => runs.push(Run::upright(format!(" [{units}]"))),
        (e, no_units) => {
            runs.push(Run::upright(" ["));
            runs.extend(power_of_ten(e));
            runs.push(Run::upright(if no_units { "]".to_owned() } else { format!(" {units}]") }));
        }
    }
    runs
}

#[cfg(test)]
mod tests {
    use super::*;

    fn extent(min: Point, max: Point) -> Extent {
        Extent { min, max }
    }

    #[test]
    fn both_axes_have_one_scale_and_the_section_lies_within_the_frame() {
        for max in [[1.0, 1.0], [20.0, 1.0], [1.0, 20.0], [1e-6, 3e-6], [1e6, 1e5]] {
            let e = extent([0.0, 0.0], max);
            let view = View::fit(&e, [700.0, 600.0]);
            let (a, b) = (view.to_page([10.0, 20.0], e.min), view.to_page([10.0, 20.0], e.max));
            let (across, up) = ((b[0] - a[0]) / max[0], (a[1] - b[1]) / max[1]);
            assert!((across - up).abs() < 1e-9 * up); // rounding
            assert!(a[0] >= 23.9 && b[0] <= 10.0 + view.size[0] - 13.9); // PADDING but for rounding
            assert!(b[1] >= 33.9 && a[1] <= 20.0 + view.size[1] - 13.9);
            assert!(view.size[0] <= 700.1 && view.size[1] <= 600.1);
        }
    }

    #[test]
    fn tick_labels_never_overlap_and_every_axis_has_some() {
        for (w, h) in
            [(1.0, 1.0), (20.0, 1.0), (1.0, 20.0), (3.7, 1.3), (1e-6, 1e-6), (1e6, 2e6), (123_456.0, 99_999.0)]
        {
            for shift in [0.0, -0.5, 17.3, 1e5] {
                let e = extent([shift * w, shift * w], [shift * w + w, shift * w + h]);
                for room in [[120.0, 500.0], [330.0, 330.0], [850.0, 700.0]] {
                    let axes = Axes::new(View::fit(&e, room), "mm");
                    for k in 0..2 {
                        assert!(!axes.ticks[k].at.is_empty(), "{w} {h} {shift} {room:?}");
                        assert!(axes.ticks[k].at.len() < 16);
                    }
                    let label = |i: usize| width(&plain(&axes.ticks[0].labels[i]), TICK_SIZE);
                    for i in 1..axes.ticks[0].at.len() {
                        let distance = (axes.ticks[0].at[i] - axes.ticks[0].at[i - 1]) * axes.view.scale;
                        assert!(distance > 0.5 * (label(i) + label(i - 1)) + 6.0, "{w} {h} {shift} {room:?}");
                    }
                    for pair in axes.ticks[1].at.windows(2) {
                        assert!((pair[1] - pair[0]) * axes.view.scale > 1.3 * TICK_SIZE);
                    }
                }
            }
        }
    }

    #[test]
    fn a_point_and_nothing_at_all_have_a_view() {
        let e = extent([3.0, -2.0], [3.0, -2.0]);
        assert!(View::fit(&e, [300.0, 300.0]).scale.is_finite());
        for tiny in [0.0, 1e-310] {
            let view = View::fit(&extent([0.0; 2], [tiny; 2]), [300.0, 300.0]);
            assert!(view.scale.is_finite() && view.scale > 0.0);
            assert!(!Axes::new(view, "").draw([0.0; 2]).eq(&Shape::text([0.0; 2], 1.0, Anchor::Start, vec![])));
        }
        assert_eq!(Extent::of(std::iter::empty()), extent([0.0; 2], [1.0; 2]));
        let huge = View::fit(&extent([-9e289; 2], [9e289; 2]), [300.0, 300.0]);
        assert!(huge.scale > 0.0 && huge.to_page([0.0; 2], [9e289; 2]).iter().all(|v| v.is_finite()));
    }

    #[test]
    fn labels_carry_units_powers_and_offsets() {
        let text = |runs: Vec<Run>| runs.into_iter().map(|r| r.text).collect::<String>();
        assert_eq!(text(axis_label("x", "m", 0, None)), "x [m]");
        assert_eq!(text(axis_label("y", "", 0, None)), "y");
        assert_eq!(text(axis_label("x", "m", -6, None)), "x [10−6 m]");
        assert_eq!(text(axis_label("x", "", 6, None)), "x [106]");
        let offset = Some(Decimal { digits: 2, exponent: 6 });
        assert_eq!(text(axis_label("x", "m", 0, offset)), "x − 2000000 m [m]");
    }
}
