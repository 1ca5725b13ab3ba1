//! The k nearest nodes, on a cell grid of our own; equal distances are settled by node number.

use nmt_geom::point::distance_squared;
use nmt_geom::{Bbox, NodeId, Point};

/// Distances that agree within this fraction are equal, and node numbers decide.
///
/// Rounding makes equal distances of a regular grid differ by 1e-15; what a change of unit (mm to km) adds is of that
/// order too. Distances that differ by 1e-9 on purpose do not occur.
pub const TIE_REL: f64 = 1.0e-9;

/// Nodes a cell on average: fewer makes more cells to visit, more makes more distances to compute.
const NODES_PER_CELL: f64 = 2.0;

/// Finds the nodes nearest to a point, in O(k) for clouds of even density.
#[derive(Clone, Debug)]
pub struct Nearest<'a> {
    xy: &'a [Point],
    origin: Point,
    cell: [f64; 2],
    shape: [usize; 2],
    starts: Vec<u32>,
    entries: Vec<u32>, // nodes by cell, ascending
}

/// Room for a search, to be used again for the next one.
#[derive(Clone, Debug, Default)]
pub struct Scratch {
    pending: Vec<(f64, u32)>,  // (distance², node) met, not asked about yet
    accepted: Vec<(f64, u32)>, // by distance
}

impl<'a> Nearest<'a> {
    /// Indexes the nodes at `xy`, shape (n_nodes, 2); coordinates must be finite.
    pub fn new(xy: &'a [Point]) -> Self {
        let envelope = Bbox::of(xy.iter().copied());
        let extent = [envelope.width(), envelope.height()].map(|e| if e > 0.0 { e } else { 0.0 });
        let n_cells = (xy.len() as f64 / NODES_PER_CELL).max(1.0);
        // Square cells; a cloud along a line gets a single row of them.
        let side = (extent[0] * extent[1] / n_cells).sqrt().max(extent[0].max(extent[1]) / n_cells);
        let side = if side.is_finite() && side > 0.0 { side } else { 1.0 };
        let shape = extent.map(|e| ((e / side).ceil() as usize).clamp(1, xy.len().max(1)));
        let cell: [f64; 2] = std::array::from_fn(|d| if extent[d] > 0.0 { extent[d] / shape[d] as f64 } else { side });
        let mut nearest =
            Self { xy, origin: envelope.min, cell, shape, starts: vec![0; shape[0] * shape[1] + 1], entries: vec![] };
        let cells: Vec<u32> = xy.iter().map(|p| nearest.cell_of(*p) as u32).collect();
        cells.iter().for_each(|&c| nearest.starts[c as usize + 1] += 1);
        (0..shape[0] * shape[1]).for_each(|c| nearest.starts[c + 1] += nearest.starts[c]);
        let mut next = nearest.starts.clone();
        nearest.entries = vec![0; xy.len()];
        for (node, &c) in cells.iter().enumerate() {
            nearest.entries[next[c as usize] as usize] = node as u32;
            next[c as usize] += 1;
        }
        nearest
    }

    fn column(&self, v: f64, d: usize) -> usize {
        let c = (v - self.origin[d]) / self.cell[d];
        if c > 0.0 { (c as usize).min(self.shape[d] - 1) } else { 0 }
    }

    fn cell_of(&self, p: Point) -> usize {
        self.column(p[1], 1) * self.shape[0] + self.column(p[0], 0)
    }

    /// The `k` nodes nearest to `p` among those that `accept` lets pass, by node number, into `out`; fewer where there
    /// are no more.
    ///
    /// With r the k-th smallest distance, nodes nearer than (1 − 1e-9)·r belong, the rest come from those within
    /// (1 + 1e-9)·r in order of node number. `accept` is asked about nodes in order of distance, until there are enough.
    ///
    /// ```
    /// use nmt_cloud::{Nearest, Scratch};
    /// let xy = [[0.0, 0.0], [1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [3.0, 0.0]];
    /// let mut out = Vec::new();
    /// Nearest::new(&xy).nearest([0.0, 0.0], 3, |_| true, &mut Scratch::default(), &mut out);
    /// let numbers: Vec<u32> = out.iter().map(|node| node.0).collect();
    /// assert_eq!(numbers, [0, 1, 2]); // 1, 2 and 3 are equally far: the smaller numbers win
    /// ```
    pub fn nearest(
        &self,
        p: Point,
        k: usize,
        mut accept: impl FnMut(NodeId) -> bool,
        scratch: &mut Scratch,
        out: &mut Vec<NodeId>,
    ) {
        out.clear();
        let Scratch { pending, accepted } = scratch;
        pending.clear();
        accepted.clear();
        if k == 0 || self.xy.is_empty() {
            return;
        }
        let home = [self.column(p[0], 0), self.column(p[1], 1)];
        let mut ring = 0;
        loop {
            self.visit_ring(home, ring, |node| pending.push((distance_squared(p, self.xy[node as usize]), node)));
            let complete = self.complete_radius(p, home, ring);
            // What lies within the complete radius is nearer than all that may still come: it is asked in order.
            let limit = if complete > 0.0 { complete * complete } else { -1.0 };
            let is_in = |candidate: &(f64, u32)| candidate.0 <= limit;
            let n_in = partition(pending, is_in);
            if accepted.len() + n_in >= k || complete == f64::INFINITY {
                pending[..n_in].sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
                for &(d2, node) in &pending[..n_in] {
                    let enough = accepted.len() >= k && d2 > tied_square(accepted[k - 1].0);
                    if enough {
                        break;
                    }
                    if accept(NodeId(node)) {
                        accepted.push((d2, node));
                    }
                }
                pending.drain(..n_in);
                let known = accepted.len() >= k && tied_square(accepted[k - 1].0) <= limit;
                if known || complete == f64::INFINITY {
                    break;
                }
            }
            ring += 1;
        }
        if accepted.len() > k {
            // Nodes surely nearer than the k-th belong; the smallest numbers of those at its distance fill up.
            let sure = (accepted[k - 1].0.sqrt() * (1.0 - TIE_REL)).powi(2);
            let n_sure = accepted.partition_point(|(d2, _)| *d2 < sure);
            accepted[n_sure..].sort_unstable_by_key(|(_, node)| *node);
            accepted.truncate(k);
        }
        out.extend(accepted.iter().map(|(_, node)| NodeId(*node)));
        out.sort_unstable();
    }

    /// Calls `visit` with the nodes of the cells at Chebyshev distance `ring` from `home`.
    fn visit_ring(&self, home: [usize; 2], ring: usize, mut visit: impl FnMut(u32)) {
        let [c, r] = home.map(|v| v as isize);
        let ring = ring as isize;
        let columns = (c - ring).max(0)..=(c + ring).min(self.shape[0] as isize - 1);
        let mut row = |row: isize, from: isize, to: isize| {
            let first = row as usize * self.shape[0] + from as usize;
            let last = row as usize * self.shape[0] + to as usize;
            let entries = self.starts[first] as usize..self.starts[last + 1] as usize;
            self.entries[entries].iter().for_each(|&node| visit(node));
        };
        for j in (r - ring).max(0)..=(r + ring).min(self.shape[1] as isize - 1) {
            if (j - r).abs() == ring {
                row(j, *columns.start(), *columns.end());
            } else {
                [c - ring, c + ring].into_iter().filter(|i| columns.contains(i)).for_each(|i| row(j, i, i));
            }
        }
    }

    /// Every node nearer to `p` than this has been visited once rings 0 to `ring` have; infinite when all cells have.
    fn complete_radius(&self, p: Point, home: [usize; 2], ring: usize) -> f64 {
        let mut radius = f64::INFINITY;
        for d in 0..2 {
            if home[d] > ring {
                let wall = self.origin[d] + (home[d] - ring) as f64 * self.cell[d];
                radius = radius.min(p[d] - wall);
            }
            if home[d] + ring + 1 < self.shape[d] {
                let wall = self.origin[d] + (home[d] + ring + 1) as f64 * self.cell[d];
                radius = radius.min(wall - p[d]);
            }
        }
        // Cells are found by division, walls by multiplication: leave room for their rounding.
        radius - 1e-12 * (self.cell[0] + self.cell[1])
    }
}

/// The square of (1 + 1e-9) times a distance, from its square.
fn tied_square(d2: f64) -> f64 {
    (d2.sqrt() * (1.0 + TIE_REL)).powi(2)
}

/// Brings the elements that hold to the front; returns how many they are.
fn partition<T: Copy>(list: &mut [T], holds: impl Fn(&T) -> bool) -> usize {
    let mut n = 0;
    for k in 0..list.len() {
        if holds(&list[k]) {
            list.swap(n, k);
            n += 1;
        }
    }
    n
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn by_brute_force(xy: &[Point], p: Point, k: usize) -> Vec<NodeId> {
        let mut all: Vec<(f64, u32)> =
            xy.iter().enumerate().map(|(n, q)| (distance_squared(p, *q).sqrt(), n as u32)).collect();
        all.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        if all.len() <= k {
            return (0..all.len()).map(NodeId::of).collect();
        }
        let r = all[k - 1].0;
        let mut chosen: Vec<u32> = all.iter().filter(|a| a.0 < r * (1.0 - TIE_REL)).map(|a| a.1).collect();
        let mut rest: Vec<u32> =
            all.iter().filter(|a| a.0 >= r * (1.0 - TIE_REL) && a.0 <= r * (1.0 + TIE_REL)).map(|a| a.1).collect();
        rest.sort_unstable();
        chosen.extend(rest.into_iter().take(k - chosen.len()));
        chosen.sort_unstable();
        chosen.into_iter().map(NodeId).collect()
    }

    proptest! {
        #[test]
        fn the_grid_agrees_with_a_search_through_all_nodes(
            nodes in prop::collection::vec(prop::array::uniform2(0i32..9), 1..80),
            scatter in prop::collection::vec(prop::array::uniform2(0.0..9.0f64), 0..80),
            p in prop::array::uniform2(-2.0..11.0f64),
            k in 1usize..25,
        ) {
            // Integer coordinates bring ties, the others irregularity.
            let mut xy: Vec<Point> = nodes.iter().map(|n| n.map(f64::from)).collect();
            xy.extend(&scatter);
            let at_node = xy[k % xy.len()];
            for centre in [p, at_node, [4.0, 4.0]] {
                let mut out = Vec::new();
                Nearest::new(&xy).nearest(centre, k, |_| true, &mut Scratch::default(), &mut out);
                prop_assert_eq!(&out, &by_brute_force(&xy, centre, k));
            }
        }
    }

    #[test]
    fn nodes_on_one_line_or_at_one_point_are_found() {
        for xy in [vec![[1.0, 2.0]; 3], (0..3).map(|k| [f64::from(k), 5.0]).collect::<Vec<_>>()] {
            let mut out = Vec::new();
            Nearest::new(&xy).nearest([0.0, 5.0], 2, |_| true, &mut Scratch::default(), &mut out);
            assert_eq!(out, [NodeId(0), NodeId(1)]);
        }
    }

    #[test]
    fn a_node_that_is_not_accepted_is_replaced_by_the_next_one() {
        let xy: Vec<Point> = (0..10).map(|k| [f64::from(k), 0.0]).collect();
        let mut out = Vec::new();
        Nearest::new(&xy).nearest([0.0, 0.0], 3, |node| node.0 != 1, &mut Scratch::default(), &mut out);
        assert_eq!(out, [NodeId(0), NodeId(2), NodeId(3)]);
    }
}
