//! Who owns each box: an interior node, a boundary node, a ghost or nobody; a row at a time.

use super::boxes::{Boxes, Crossing, Placed, Span};
use super::frame::Frame;
use super::half_edges::NONE;
use nmt_cloud::Cloud;
use nmt_geom::Point;
use std::iter::Peekable;
use std::ops::Range;
use std::slice::Iter;

/// How far a ghost may be from the centre of its box, in units of the spacing.
///
/// Ghosts in line would put whole rows of four on one circle, and lie on segments along the rows.
const JITTER: f64 = 0.2;

/// Ghosts that a triangulation may have for each node of the cloud, beyond [`FREE_GHOSTS`].
///
/// A wall one box thick has three; clouds that are all clearance are left to the general way.
const GHOSTS_PER_NODE: usize = 4;

/// Ghosts that any triangulation may have.
const FREE_GHOSTS: usize = 64;

/// One row of boxes.
pub(super) struct Row {
    /// Who owns each box; [`NONE`] where nobody does.
    pub owners: Vec<u32>,
    /// Where the owners are.
    pub places: Vec<Point>,
    /// The boundary nodes in the boxes of this row, owners or not.
    pub placed: Vec<Placed>,
    /// The first ghost of the row.
    pub first_ghost: usize,
    /// The column of each ghost of the row.
    pub ghost_cols: Vec<u32>,
}

impl Row {
    pub fn new(width: usize) -> Self {
        let (owners, places) = (vec![NONE; width], vec![[0.0; 2]; width]);
        Self { owners, places, placed: Vec::new(), first_ghost: 0, ghost_cols: Vec::new() }
    }

    fn clear(&mut self, first_ghost: usize) {
        self.owners.fill(NONE);
        self.placed.clear();
        self.ghost_cols.clear();
        self.first_ghost = first_ghost;
    }

    #[inline]
    fn take(&mut self, col: usize, owner: u32, place: Point) {
        self.owners[col] = owner;
        self.places[col] = place;
    }
}

/// Fills rows of boxes from the bottom up.
pub(super) struct Rows<'a> {
    cloud: &'a Cloud,
    half: [f64; 2],
    columns: Vec<f64>,
    lines: Vec<f64>,
    /// Sites and places of the interior nodes that are still to come, and the number of the first.
    sites: &'a [u32],
    interior: &'a [Point],
    first_interior: u32,
    placed: Peekable<Iter<'a, Placed>>,
    near: Peekable<Iter<'a, Span>>,
    crossings: Peekable<Iter<'a, Crossing>>,
}

impl<'a> Rows<'a> {
    /// `None` where the cloud does not know its sites.
    pub fn new(cloud: &'a Cloud, frame: &Frame, boxes: &'a Boxes) -> Option<Self> {
        let interior = cloud.xy().get(cloud.n_boundary()..)?;
        let sites = cloud.sites().filter(|sites| sites.len() == interior.len())?;
        Some(Self {
            cloud,
            half: frame.spacing.map(|h| 0.5 * h),
            columns: frame.sites_along(0),
            lines: frame.sites_along(1),
            sites,
            interior,
            first_interior: cloud.n_boundary() as u32,
            placed: boxes.placed.iter().peekable(),
            near: boxes.near.iter().peekable(),
            crossings: boxes.crossings.iter().peekable(),
        })
    }

    /// True when every node has come to its box.
    pub fn are_complete(&mut self) -> bool {
        self.sites.is_empty() && self.placed.peek().is_none()
    }

    /// Fills `into` with row `row`, the one after the last.
    ///
    /// `None` where an interior node is not in the box of its site, two share one, or ghosts are too many.
    pub fn fill(&mut self, row: usize, ghosts: &mut Vec<Point>, into: &mut Row) -> Option<()> {
        into.clear(ghosts.len());
        self.take_interior(row, into)?;
        while let Some(&placed) = self.placed.next_if(|placed| placed.row as usize == row) {
            into.placed.push(placed);
            if into.owners[placed.col as usize] == NONE {
                into.take(placed.col as usize, placed.node, self.cloud.xy()[placed.node as usize]);
            }
        }
        while let Some(span) = self.near.next_if(|span| span.row as usize == row) {
            self.haunt(span.from as usize..span.to as usize + 1, row, ghosts, into);
        }
        // Between each odd crossing and the next one is material.
        while let Some(enters) = self.crossings.next_if(|crossing| crossing.row as usize == row) {
            let leaves = self.crossings.next_if(|crossing| crossing.row as usize == row)?;
            self.haunt(enters.col as usize..leaves.col as usize, row, ghosts, into);
        }
        (ghosts.len() <= GHOSTS_PER_NODE * self.cloud.n_nodes() + FREE_GHOSTS).then_some(())
    }

    fn take_interior(&mut self, row: usize, into: &mut Row) -> Option<()> {
        // The lattice's own sites, without the rim.
        let n_columns = self.columns.len() - 2;
        let Some(first) = row.checked_sub(1).map(|j| j * n_columns) else { return Some(()) };
        let y = self.lines[row];
        let mut last_col = 0;
        let mut n_taken = 0;
        for (&site, &p) in self.sites.iter().zip(self.interior) {
            let col = (site as usize).checked_sub(first)? + 1;
            if col > n_columns {
                break;
            }
            let is_home = (p[0] - self.columns[col]).abs() < self.half[0] && (p[1] - y).abs() < self.half[1];
            if col <= last_col || !is_home {
                return None;
            }
            into.take(col, self.first_interior + n_taken, p);
            last_col = col;
            n_taken += 1;
        }
        self.sites = self.sites.get(n_taken as usize..)?;
        self.interior = self.interior.get(n_taken as usize..)?;
        self.first_interior += n_taken;
        Some(())
    }

    /// Gives every free box of `cols` a ghost.
    fn haunt(&self, cols: Range<usize>, row: usize, ghosts: &mut Vec<Point>, into: &mut Row) {
        let (n_nodes, last) = (self.cloud.n_nodes(), into.owners.len());
        for col in cols.start.min(last)..cols.end.min(last) {
            if into.owners[col] == NONE {
                let [r, s] = jitter(col as u64, row as u64).map(|r| 2.0 * JITTER * r);
                let place = [self.columns[col] + r * self.half[0], self.lines[row] + s * self.half[1]];
                into.take(col, (n_nodes + ghosts.len()) as u32, place);
                into.ghost_cols.push(col as u32);
                ghosts.push(place);
            }
        }
    }
}

/// Two numbers of [−1, 1) that depend on the box alone: the mixing of SplitMix64.
fn jitter(col: u64, row: u64) -> [f64; 2] {
    let mut z = (col << 32 | row).wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^= z >> 31;
    [z >> 32, z & 0xffff_ffff].map(|bits| bits as f64 / 2_147_483_648.0 - 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ghosts_are_spread_over_the_middle_of_their_boxes() {
        let drawn: Vec<f64> = (0..100).flat_map(|k| jitter(k % 10, k / 10)).collect();
        assert!(drawn.iter().all(|r| (-1.0..1.0).contains(r)));
        let mean = drawn.iter().sum::<f64>() / 200.0;
        assert!(mean.abs() < 0.2, "{mean}"); // five standard deviations of 0.577/√200
    }
}
