//! Who owns each box: an interior node, a boundary node, a ghost or nobody; a row at a time.

use super::frame::Frame;
use super::half_edges::NONE;
use nmt_cloud::Cloud;
use nmt_geom::Point;

/// How far a ghost may be from the centre of its box, in units of the spacing.
///
/// Ghosts in a row would put whole rows of four on one circle, and on segments along the rows.
const JITTER: f64 = 0.2;

/// Ghosts that a triangulation may have for each node of the cloud, beyond [`FREE_GHOSTS`].
///
/// A wall one box thick has three; clouds that are all clearance are left to the general way.
const GHOSTS_PER_NODE: usize = 4;

/// Ghosts that any triangulation may have.
const FREE_GHOSTS: usize = 64;

/// Slack of what boxes a segment passes, in units of the spacing: far above rounding, far below a box.
const PASS_SLACK: f64 = 1.0e-6;

/// A boundary node in its box.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Placed {
    row: u32,
    pub col: u32,
    pub node: u32,
}

/// Boxes of one row within one box of a segment of the real boundary; `to` belongs to them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Span {
    row: u32,
    from: u32,
    to: u32,
}

/// What the boundary does to the boxes, sorted by row.
pub(super) struct Boxes {
    placed: Vec<Placed>,
    near: Vec<Span>,
    crossings: Vec<[u32; 2]>, // row; first column whose site is right of a segment that crosses the row
}

/// One row of boxes.
pub(super) struct Row {
    /// Who owns each box; `NONE` where nobody does.
    pub owners: Vec<u32>,
    /// Where the owners are.
    pub places: Vec<Point>,
    /// The boundary nodes in the boxes of this row, owners or not.
    pub placed: Vec<Placed>,
    /// The first ghost of the row, and the columns of all of them.
    pub first_ghost: usize,
    pub ghost_cols: Vec<u32>,
}

impl Row {
    pub fn new(width: usize) -> Self {
        let (owners, places) = (vec![NONE; width], vec![[0.0; 2]; width]);
        Self { owners, places, placed: Vec::new(), first_ghost: 0, ghost_cols: Vec::new() }
    }

    fn take(&mut self, col: usize, owner: u32, place: Point) {
        self.owners[col] = owner;
        self.places[col] = place;
    }
}

impl Boxes {
    /// `None` where a boundary node is outside all boxes.
    pub fn new(cloud: &Cloud, frame: &Frame) -> Option<Self> {
        let mut placed = Vec::with_capacity(cloud.n_boundary());
        for (node, p) in (0..).zip(cloud.boundary().xy()) {
            let [col, row] = frame.box_of(*p)?;
            placed.push(Placed { row, col, node });
        }
        let mut boxes = Self { placed, near: Vec::new(), crossings: Vec::new() };
        let mut last_box = None;
        for [a, b] in cloud.boundary().all_ends() {
            let scaled = [a, b].map(|p| [frame.scaled(0, p[0]), frame.scaled(1, p[1])]);
            let ends = [frame.box_of(a), frame.box_of(b)];
            // Many short segments in one box have the same surroundings.
            if ends[0] != ends[1] || ends[0] != last_box {
                boxes.mark_near(scaled, frame);
                last_box = if ends[0] == ends[1] { ends[0] } else { None };
            }
            boxes.mark_crossings(scaled, frame);
        }
        boxes.placed.sort_unstable();
        boxes.near.sort_unstable_by_key(|span| span.row);
        boxes.crossings.sort_unstable();
        Some(boxes)
    }

    fn mark_near(&mut self, [a, b]: [Point; 2], frame: &Frame) {
        let (low, high) = if a[1] <= b[1] { (a, b) } else { (b, a) };
        let slope = (high[0] - low[0]) / (high[1] - low[1]);
        let last = frame.shape.map(|n| (n - 1) as f64);
        let nearest = |v: f64| (v + 0.5).floor();
        let mut row = (nearest(low[1] - PASS_SLACK) - 1.0).max(0.0);
        while row <= (nearest(high[1] + PASS_SLACK) + 1.0).min(last[1]) {
            // The part of the segment in this row and the two beside it.
            let cut = |v: f64| if slope.is_finite() { low[0] + (v.clamp(low[1], high[1]) - low[1]) * slope } else { low[0] };
            let (mut from, mut to) = (cut(row - 1.5 - PASS_SLACK), cut(row + 1.5 + PASS_SLACK));
            if !slope.is_finite() {
                (from, to) = (low[0], high[0]);
            }
            let (from, to) = (from.min(to), from.max(to));
            let from = (nearest(from - PASS_SLACK) - 1.0).clamp(0.0, last[0]) as u32;
            let to = (nearest(to + PASS_SLACK) + 1.0).clamp(0.0, last[0]) as u32;
            self.near.push(Span { row: row as u32, from, to });
            row += 1.0;
        }
    }

    /// Sites between an odd and the next even crossing of a row are inside; a site nearer than a box to a crossing is in a
    /// span anyway, so that rounding decides nothing.
    fn mark_crossings(&mut self, [a, b]: [Point; 2], frame: &Frame) {
        let (low, high) = if a[1] <= b[1] { (a, b) } else { (b, a) };
        let slope = (high[0] - low[0]) / (high[1] - low[1]);
        let mut row = low[1].ceil();
        while row < high[1] {
            let x = low[0] + (row - low[1]) * slope;
            let col = x.ceil().clamp(0.0, frame.shape[0] as f64) as u32;
            self.crossings.push([row as u32, col]);
            row += 1.0;
        }
    }

    /// Boxes that may have owners, with those counted twice that several segments pass.
    pub fn n_owners_at_most(&self, cloud: &Cloud) -> usize {
        cloud.n_nodes() + self.near.iter().map(|span| (span.to - span.from + 1) as usize).sum::<usize>()
    }
}

/// Fills rows of boxes from the bottom up.
pub(super) struct Rows<'a> {
    cloud: &'a Cloud,
    boxes: &'a Boxes,
    sites: &'a [u32],
    half: [f64; 2],
    columns: Vec<f64>,
    lines: Vec<f64>,
    /// What has been used of the interior nodes, the placed nodes, the spans and the crossings.
    used: [usize; 4],
}

impl<'a> Rows<'a> {
    pub fn new(cloud: &'a Cloud, frame: &'a Frame, boxes: &'a Boxes) -> Option<Self> {
        let sites = cloud.sites()?;
        let half = frame.spacing.map(|h| 0.5 * h);
        let (columns, lines) = (frame.sites_along(0), frame.sites_along(1));
        Some(Self { cloud, boxes, sites, half, columns, lines, used: [0; 4] })
    }

    /// True when every interior node has been given its box.
    pub fn are_all_placed(&self) -> bool {
        self.used[0] == self.sites.len() && self.used[1] == self.boxes.placed.len()
    }

    /// Fills `into` with row `row`, which is the one after the last.
    ///
    /// `None` where an interior node is not in the box of its site, two share one, or ghosts are too many.
    pub fn fill(&mut self, row: usize, ghosts: &mut Vec<Point>, into: &mut Row) -> Option<()> {
        into.owners.fill(NONE);
        into.placed.clear();
        into.ghost_cols.clear();
        into.first_ghost = ghosts.len();
        self.take_interior(row, into)?;
        while let Some(&placed) = self.boxes.placed.get(self.used[1]).filter(|p| p.row as usize == row) {
            self.used[1] += 1;
            into.placed.push(placed);
            if into.owners[placed.col as usize] == NONE {
                into.take(placed.col as usize, placed.node, self.cloud.xy()[placed.node as usize]);
            }
        }
        while let Some(span) = self.boxes.near.get(self.used[2]).filter(|s| s.row as usize == row) {
            self.used[2] += 1;
            self.haunt(span.from as usize..span.to as usize + 1, row, ghosts, into);
        }
        let mut entered = None;
        while let Some(&[_, col]) = self.boxes.crossings.get(self.used[3]).filter(|c| c[0] as usize == row) {
            self.used[3] += 1;
            entered = match entered {
                None => Some(col as usize),
                Some(from) => {
                    self.haunt(from..col as usize, row, ghosts, into);
                    None
                }
            };
        }
        (ghosts.len() <= GHOSTS_PER_NODE * self.cloud.n_nodes() + FREE_GHOSTS).then_some(())
    }

    fn take_interior(&mut self, row: usize, into: &mut Row) -> Option<()> {
        let n_columns = self.columns.len() - 2;
        let Some(first) = row.checked_sub(1).map(|j| j * n_columns) else { return Some(()) };
        let interior = self.cloud.xy().get(self.cloud.n_boundary()..)?;
        let y = self.lines[row];
        let (sites, places) = (self.sites.get(self.used[0]..)?, interior.get(self.used[0]..)?);
        let mut least = 0;
        for (&site, &p) in sites.iter().zip(places) {
            let Some(i) = (site as usize).checked_sub(first) else { return None };
            if i >= n_columns {
                break;
            }
            let col = i + 1;
            let is_home = (p[0] - self.columns[col]).abs() < self.half[0] && (p[1] - y).abs() < self.half[1];
            if col <= least || !is_home {
                return None;
            }
            least = col;
            into.take(col, (self.cloud.n_boundary() + self.used[0]) as u32, p);
            self.used[0] += 1;
        }
        Some(())
    }

    /// Gives every free box of `cols` a ghost.
    fn haunt(&self, cols: std::ops::Range<usize>, row: usize, ghosts: &mut Vec<Point>, into: &mut Row) {
        let cols = cols.start.min(into.owners.len())..cols.end.min(into.owners.len());
        for col in cols {
            if into.owners[col] == NONE {
                let [r, s] = jitter(col as u64, row as u64);
                let place = [
                    self.columns[col] + 2.0 * JITTER * r * self.half[0],
                    self.lines[row] + 2.0 * JITTER * s * self.half[1],
                ];
                into.take(col, (self.cloud.n_nodes() + ghosts.len()) as u32, place);
                into.ghost_cols.push(col as u32);
                ghosts.push(place);
            }
        }
    }
}

/// Two numbers of [−1, 1) that depend on the box alone.
fn jitter(col: u64, row: u64) -> [f64; 2] {
    // The mixing of SplitMix64.
    let mut z = (col << 32 | row).wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^= z >> 31;
    let signed = |bits: u64| (bits & 0xffff_ffff) as f64 / 2_147_483_648.0 - 1.0;
    [signed(z >> 32), signed(z)]
}
