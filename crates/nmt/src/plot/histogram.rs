//! The picture of the shapes of triangles: their share by shape measure, before and after smoothing.

use super::Caption;
use super::axes::{FRAME_STROKE, LABEL_SIZE, TICK_GAP, TICK_LENGTH, TICK_SIZE, centred_baseline};
use super::colour::{Rgb, of_subdomain};
use super::page::{MARGIN, PAGE_WIDTH, description, title};
use super::scene::{Anchor, Direction, Point, Polyline, Scene, Shape, Stroke, Text};
use super::text::{CAP_HEIGHT, Run, Style, plain, width};

/// Size of the frame.
const FRAME: [f64; 2] = [PAGE_WIDTH - 2.0 * MARGIN - 120.0, 380.0];
/// Left of the frame: ticks, their labels, the label of the axis.
const LEFT: f64 = MARGIN + 80.0;
/// Free room on either side of a bin, as a fraction of it.
const BIN_GAP: f64 = 0.1;
/// Size of legend texts.
const LEGEND_SIZE: f64 = 14.0;
/// Size of the colour of a series in the legend.
const SWATCH: Point = [18.0, 12.0];
/// Distances of ticks, in per cent: the smallest that makes at most [`MOST_TICKS`] is taken.
const STEPS: [f64; 5] = [1.0, 2.0, 5.0, 10.0, 20.0];
const MOST_TICKS: f64 = 6.0;

/// One series of bars.
pub(super) struct Series<'a> {
    pub name: &'a str,
    /// Number of triangles by shape measure: [0, 0.1), …, [0.9, 1].
    pub counts: [usize; 10],
}

/// The figure of up to a few series.
pub(super) fn scene(caption: &Caption<'_>, series: &[Series<'_>]) -> Scene {
    let (mut shapes, title_height) = title(caption, PAGE_WIDTH);
    let origin = [LEFT, MARGIN + title_height];
    let bottom = origin[1] + FRAME[1];
    let share = |s: &Series<'_>, k: usize| 100.0 * s.counts[k] as f64 / s.counts.iter().sum::<usize>().max(1) as f64;
    let highest = series.iter().flat_map(|s| (0..10).map(move |k| share(s, k))).fold(0.0, f64::max).max(1.0);
    let step = STEPS.into_iter().find(|step| highest / step <= MOST_TICKS).unwrap_or(STEPS[4]);
    let top = (highest / step).ceil() * step;
    let y_of = |percent: f64| bottom - FRAME[1] * percent / top;
    let x_of = |q: f64| origin[0] + FRAME[0] * q;

    let colours: Vec<Rgb> = if series.len() > 1 { vec![Rgb(0xb0b0b0), of_subdomain(0)] } else { vec![of_subdomain(0)] };
    for (n, (s, colour)) in series.iter().zip(&colours).enumerate() {
        let wide = 0.1 * (1.0 - 2.0 * BIN_GAP) / series.len() as f64;
        let bar = |k: usize| {
            let left = x_of(0.1 * (k as f64 + BIN_GAP) + wide * n as f64);
            let y = y_of(share(s, k));
            Polyline::rectangle([left, y], [FRAME[0] * wide, bottom - y])
        };
        let bars = (0..10).filter(|&k| s.counts[k] > 0).map(bar).collect();
        shapes.push(Shape::area(bars, *colour));
    }

    let mut lines = vec![Polyline::rectangle(origin, FRAME)];
    for k in 0..=10 {
        let x = x_of(0.1 * f64::from(k));
        lines.push(Polyline::open(vec![[x, bottom], [x, bottom + TICK_LENGTH]]));
        let at = [x, bottom + TICK_LENGTH + TICK_GAP + CAP_HEIGHT * TICK_SIZE];
        let label = if k % 10 == 0 { format!("{}", k / 10) } else { format!("0.{k}") };
        shapes.push(Shape::text(at, TICK_SIZE, Anchor::Middle, plain(label)));
    }
    for k in 0..=(top / step).round() as u32 {
        let (percent, x) = (f64::from(k) * step, origin[0]);
        let y = y_of(percent);
        lines.push(Polyline::open(vec![[x, y], [x - TICK_LENGTH, y]]));
        let at = [x - TICK_LENGTH - TICK_GAP, centred_baseline(y, TICK_SIZE)];
        shapes.push(Shape::text(at, TICK_SIZE, Anchor::End, plain(format!("{percent}"))));
    }
    shapes.push(Shape::lines(lines, FRAME_STROKE));
    let below = bottom + TICK_LENGTH + TICK_GAP + TICK_SIZE + 8.0 + LABEL_SIZE;
    let label = vec![
        Run::upright("shape measure 4√3 "),
        Run::new("A", Style::Italic),
        Run::upright("/(sum of squared sides); 1 is equilateral"),
    ];
    shapes.push(Shape::text([x_of(0.5), below], LABEL_SIZE, Anchor::Middle, label));
    shapes.push(Shape::Text(Text {
        at: [MARGIN + LABEL_SIZE, origin[1] + 0.5 * FRAME[1]],
        size: LABEL_SIZE,
        anchor: Anchor::Middle,
        direction: Direction::Upwards,
        runs: plain("triangles [%]"),
    }));

    let mut height = below + MARGIN;
    if series.len() > 1 {
        height += LEGEND_SIZE + 14.0;
        let widths: Vec<f64> = series.iter().map(|s| SWATCH[0] + 7.0 + width(&plain(s.name), LEGEND_SIZE)).collect();
        let mut x = x_of(0.5) - 0.5 * (widths.iter().sum::<f64>() + 26.0);
        let middle = height - MARGIN;
        for ((s, colour), wide) in series.iter().zip(&colours).zip(widths) {
            let swatch = vec![Polyline::rectangle([x, middle - 0.5 * SWATCH[1]], SWATCH)];
            shapes.push(Shape::area(swatch.clone(), *colour));
            shapes.push(Shape::lines(swatch, Stroke::new(Rgb::INK, 0.7)));
            let at = [x + SWATCH[0] + 7.0, centred_baseline(middle, LEGEND_SIZE)];
            shapes.push(Shape::text(at, LEGEND_SIZE, Anchor::Start, plain(s.name)));
            x += wide + 26.0;
        }
    }
    let description = description(caption, "shape of the triangles");
    Scene { width: PAGE_WIDTH, height: (height + MARGIN).ceil(), description, shapes }
}
