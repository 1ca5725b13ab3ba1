//! What the real boundary does to the boxes: which its nodes are in, which are near it, where rows cross it.

use super::frame::Frame;
use nmt_cloud::Cloud;
use nmt_geom::Point;

/// Slack of what boxes a segment passes, in units of the spacing: far above rounding, far below a box.
const PASS_SLACK: f64 = 1.0e-6;

/// A boundary node in its box.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Placed {
    pub row: u32,
    pub col: u32,
    pub node: u32,
}

/// Boxes of one row within one box of a segment; `to` belongs to them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Span {
    pub row: u32,
    pub from: u32,
    pub to: u32,
}

/// Where the sites of a row change sides: those from column `col` on are right of a segment that crosses the row.
///
/// A site nearer than a box to a crossing is in a span, so that rounding decides nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Crossing {
    pub row: u32,
    pub col: u32,
}

/// All of them, sorted by row.
#[derive(Default)]
pub(super) struct Boxes {
    pub placed: Vec<Placed>,
    pub near: Vec<Span>,
    pub crossings: Vec<Crossing>,
}

impl Boxes {
    /// `None` where a boundary node is outside all boxes.
    pub fn new(cloud: &Cloud, frame: &Frame) -> Option<Self> {
        let mut boxes = Self::default();
        for (node, p) in (0..).zip(cloud.boundary().xy()) {
            let [col, row] = frame.box_of(*p)?;
            boxes.placed.push(Placed { row, col, node });
        }
        let mut last_box = None;
        for [a, b] in cloud.boundary().all_ends() {
            let ends = [frame.box_of(a)?, frame.box_of(b)?];
            let only_box = (ends[0] == ends[1]).then_some(ends[0]);
            // Many short segments in one box have the same surroundings.
            if only_box.is_none() || only_box != last_box {
                boxes.mark_near(a, b, frame);
                last_box = only_box;
            }
            boxes.mark_crossings(a, b, frame);
        }
        boxes.placed.sort_unstable();
        boxes.near.sort_unstable_by_key(|span| span.row);
        boxes.crossings.sort_unstable();
        Some(boxes)
    }

    /// How many boxes may have an owner; those that several segments are near to count several times.
    pub fn n_owners_at_most(&self, cloud: &Cloud) -> usize {
        cloud.n_nodes() + self.near.iter().map(|span| (span.to - span.from + 1) as usize).sum::<usize>()
    }

    fn mark_near(&mut self, a: Point, b: Point, frame: &Frame) {
        let slope = Slope::new(a, b, frame);
        let nearest = |v: f64| (v + 0.5).floor();
        let [last_col, last_row] = frame.shape.map(|n| (n - 1) as f64);
        let mut row = (nearest(slope.low[1] - PASS_SLACK) - 1.0).max(0.0);
        while row <= (nearest(slope.high[1] + PASS_SLACK) + 1.0).min(last_row) {
            // The part of the segment in this row and the two beside it.
            let [from, to] = slope.between(row - 1.5 - PASS_SLACK, row + 1.5 + PASS_SLACK);
            let from = (nearest(from - PASS_SLACK) - 1.0).clamp(0.0, last_col);
            let to = (nearest(to + PASS_SLACK) + 1.0).clamp(0.0, last_col);
            self.near.push(Span { row: row as u32, from: from as u32, to: to as u32 });
            row += 1.0;
        }
    }

    fn mark_crossings(&mut self, a: Point, b: Point, frame: &Frame) {
        let slope = Slope::new(a, b, frame);
        // An end exactly on a row is above it, so that a row enters as often as it leaves.
        let mut row = slope.low[1].ceil();
        while row < slope.high[1] {
            let col = slope.x_at(row).ceil().clamp(0.0, frame.shape[0] as f64);
            self.crossings.push(Crossing { row: row as u32, col: col as u32 });
            row += 1.0;
        }
    }
}

/// A segment in units of the spacing, upwards.
struct Slope {
    low: Point,
    high: Point,
    /// Δx/Δy; not finite where it is level.
    slope: f64,
}

impl Slope {
    fn new(a: Point, b: Point, frame: &Frame) -> Self {
        let [a, b] = [a, b].map(|p| [frame.scaled(0, p[0]), frame.scaled(1, p[1])]);
        let (low, high) = if a[1] <= b[1] { (a, b) } else { (b, a) };
        Self { low, high, slope: (high[0] - low[0]) / (high[1] - low[1]) }
    }

    fn x_at(&self, y: f64) -> f64 {
        self.low[0] + (y.clamp(self.low[1], self.high[1]) - self.low[1]) * self.slope
    }

    /// Least and greatest x of the part between two heights.
    fn between(&self, bottom: f64, top: f64) -> [f64; 2] {
        let ends =
            if self.slope.is_finite() { [self.x_at(bottom), self.x_at(top)] } else { [self.low[0], self.high[0]] };
        [ends[0].min(ends[1]), ends[0].max(ends[1])]
    }
}
