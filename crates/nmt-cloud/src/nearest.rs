//! The k nearest nodes, on cell grids of our own; equal distances are settled by node number.

use nmt_geom::point::distance_squared;
use nmt_geom::{Bbox, NodeId, Point};

/// Distances that agree within this fraction are equal, and node numbers decide.
///
/// Rounding makes equal distances of a regular grid differ by 1e-15; what a change of unit (mm to km) adds is of that
/// order too. Distances that differ by 1e-9 on purpose do not occur.
pub const TIE_REL: f64 = 1.0e-9;

/// Nodes a cell on average: fewer makes more cells to visit, more makes more distances to compute.
const NODES_PER_CELL: f64 = 2.0;

/// A cell with more nodes than this gets a grid of its own, over their envelope.
const MOST_IN_A_CELL: usize = 12;

/// Grids within grids, at most; at each level the spacing may fall by the square root of the number of nodes.
const MOST_LEVELS: u32 = 24;

/// Nodes looked for within the first radius, as a multiple of those wanted: a cell's neighbours are not as dense.
const EXPECTED: f64 = 1.4;

/// Room of a look-up by radius, as a fraction: distances are rounded.
const ROOM_REL: f64 = 1.0e-12;

/// A search begins with this multiple of the distance of the farthest node that the last one found: neighbours' neighbours
/// are as dense, and on irregular clouds that distance changes by a tenth from node to node.
const AS_FAR_AGAIN: f64 = 1.2;

/// But at most with this multiple of the radius that the density about the place itself suggests: the last search may have
/// been where nodes are far apart.
const MOST_OF_OWN: f64 = 2.0;

/// Room for the nodes met by a search that looks once.
const MET: usize = 128;

/// Says that a cell has no grid of its own.
const NO_GRID: u32 = u32::MAX;

/// Finds the nodes nearest to a point, in O(k) wherever the density is that of the surroundings; grids nest where it
/// is not even.
#[derive(Clone, Debug)]
pub struct Nearest<'a> {
    xy: &'a [Point],
    envelope: Bbox,
    grids: Vec<Grid>,
    starts: Vec<u32>,   // first entry of each cell, one more at the end of each grid
    children: Vec<u32>, // grid of each cell, numbered as `starts`
    entries: Vec<u32>,  // nodes by cell, ascending
    places: Vec<Point>, // of the entries
}

/// Equal cells over an envelope.
#[derive(Clone, Copy, Debug)]
struct Grid {
    origin: Point,
    per_length: [f64; 2], // cells per unit of length along x and y
    side: f64,            // of a cell
    shape: [u32; 2],
    first: u32, // of its cells in `starts`
    nests: bool,
}

impl Grid {
    /// Square cells for `n` nodes within `envelope`; nodes along a line get a single row of them.
    fn new(envelope: Bbox, n: usize, first: usize) -> Self {
        let extent = [envelope.width(), envelope.height()].map(|e| if e > 0.0 { e } else { 0.0 });
        let n_cells = (n as f64 / NODES_PER_CELL).max(1.0);
        let side = (extent[0] * extent[1] / n_cells).sqrt().max(extent[0].max(extent[1]) / n_cells);
        let side = if side.is_finite() && side > 0.0 { side } else { 1.0 };
        let shape = extent.map(|e| ((e / side).ceil() as u32).clamp(1, n.max(1) as u32));
        Self { origin: envelope.min, per_length: [1.0 / side; 2], side, shape, first: first as u32, nests: false }
    }

    fn n_cells(&self) -> usize {
        self.shape[0] as usize * self.shape[1] as usize
    }

    /// Column (or row) of a coordinate; rises with it, whatever the rounding.
    #[inline]
    fn column(&self, v: f64, d: usize) -> u32 {
        // Negative and NaN become 0.
        (((v - self.origin[d]) * self.per_length[d]) as u32).min(self.shape[d] - 1)
    }

    #[inline]
    fn cell_of(&self, p: Point) -> usize {
        self.column(p[1], 1) as usize * self.shape[0] as usize + self.column(p[0], 0) as usize
    }
}

/// Room for a search, to be used again for the next one.
#[derive(Clone, Debug, Default)]
pub struct Scratch {
    pending: Vec<(f64, u32)>,  // (distance², node) met, not asked about yet
    accepted: Vec<(f64, u32)>, // by distance
    last: (f64, usize),        // radius to begin with after the last search, and its k
}

impl<'a> Nearest<'a> {
    /// Indexes the nodes at `xy`, shape (n_nodes, 2); coordinates must be finite. About 30 bytes a node.
    pub fn new(xy: &'a [Point]) -> Self {
        let mut nearest = Self {
            xy,
            envelope: Bbox::of(xy.iter().copied()),
            grids: Vec::new(),
            starts: Vec::new(),
            children: Vec::new(),
            entries: (0..xy.len() as u32).collect(),
            places: Vec::new(),
        };
        nearest.add_grid(0..xy.len(), MOST_LEVELS);
        nearest.places = nearest.entries.iter().map(|&node| xy[node as usize]).collect();
        nearest
    }

    /// Sorts a range of the entries into the cells of a new grid, and crowded cells into grids of their own.
    fn add_grid(&mut self, range: std::ops::Range<usize>, levels: u32) -> u32 {
        let number = self.grids.len();
        let xy = self.xy;
        let nodes: Vec<u32> = self.entries[range.clone()].to_vec();
        let envelope = Bbox::of(nodes.iter().map(|&node| xy[node as usize]));
        let grid = Grid::new(envelope, nodes.len(), self.starts.len());
        let (first, n_cells) = (grid.first as usize, grid.n_cells());
        self.grids.push(grid);
        self.starts.resize(first + n_cells + 1, 0);
        self.children.resize(first + n_cells + 1, NO_GRID);
        let starts = &mut self.starts[first..];
        let cells: Vec<u32> = nodes.iter().map(|&node| grid.cell_of(xy[node as usize]) as u32).collect();
        cells.iter().for_each(|&cell| starts[cell as usize] += 1);
        let mut end = range.start as u32;
        for start in starts.iter_mut() {
            end += *start;
            *start = end; // the end of the cell: filled from its back
        }
        for (&node, &cell) in nodes.iter().zip(&cells).rev() {
            starts[cell as usize] -= 1;
            self.entries[starts[cell as usize] as usize] = node;
        }
        drop((nodes, cells));
        for cell in first..first + n_cells {
            let range = self.starts[cell] as usize..self.starts[cell + 1] as usize;
            let crowded = range.len() > MOST_IN_A_CELL && levels > 0 && n_cells > 1;
            if crowded {
                self.children[cell] = self.add_grid(range, levels - 1);
                self.grids[number].nests = true;
            }
        }
        number as u32
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
        let Scratch { pending, accepted, .. } = scratch;
        accepted.clear();
        if k == 0 || self.xy.is_empty() {
            return;
        }
        // What lies within `radius` is met and asked about in order; then the ring out to the next radius.
        let mut radius = self.first_radius(p, k);
        let mut asked = -1.0; // square of the radius within which all have been asked about
        loop {
            let all = self.reaches_all(p, radius);
            let within = if all { f64::INFINITY } else { radius * radius };
            pending.clear();
            self.visit_all(p, radius, &mut |node, place| {
                let d2 = distance_squared(p, place);
                if d2 > asked && d2 <= within {
                    pending.push((d2, node));
                }
            });
            pending.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            for &(d2, node) in pending.iter() {
                if accepted.len() >= k && d2 > tied_square(accepted[k - 1].0) {
                    break;
                }
                if accept(NodeId(node)) {
                    accepted.push((d2, node));
                }
            }
            if all || accepted.len() >= k && tied_square(accepted[k - 1].0) <= within {
                break;
            }
            asked = within;
            let growth = (EXPECTED * k as f64 / (accepted.len().max(1) as f64)).sqrt();
            radius *= growth.clamp(1.25, 2.0);
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

    /// As [`Self::nearest`] where all nodes pass; returns the distance of the farthest in `out`, 0 where there are none.
    ///
    /// Most nodes are found by looking once, within a radius that the last search with this `scratch` suggests: quickest
    /// where searches follow each other from neighbour to neighbour. What is found does not depend on it.
    pub fn nearest_of_all(&self, p: Point, k: usize, scratch: &mut Scratch, out: &mut Vec<NodeId>) -> f64 {
        if let Some(farthest) = self.look_once(p, k, scratch, out) {
            scratch.last = (AS_FAR_AGAIN * farthest, k);
            return farthest;
        }
        self.nearest(p, k, |_| true, scratch, out);
        let square = out.iter().map(|node| distance_squared(p, self.xy[node.index()])).fold(0.0, f64::max);
        scratch.last = (AS_FAR_AGAIN * square.sqrt(), k);
        square.sqrt()
    }

    /// The radius within which the `k` nearest nodes of `p` should be after the last search; 0 where there is no such search.
    #[inline]
    fn radius_after(&self, p: Point, k: usize, scratch: &Scratch) -> f64 {
        let (radius, last_k) = scratch.last;
        if last_k == k && !self.xy.is_empty() { radius.min(MOST_OF_OWN * self.first_radius(p, k)) } else { 0.0 }
    }

    /// The `k` nearest nodes where the radius of `scratch` holds enough of them, not too many, and no tie decides.
    #[inline]
    fn look_once(&self, p: Point, k: usize, scratch: &Scratch, out: &mut Vec<NodeId>) -> Option<f64> {
        let radius = self.radius_after(p, k, scratch);
        if k == 0 || k >= MET || !(radius > 0.0 && radius.is_finite()) {
            return None;
        }
        let within = radius * radius;
        let (mut squares, mut nodes, mut n) = ([0.0; MET], [0; MET], 0);
        self.visit_runs(p, radius, &mut |run, places| {
            if n + run.len() > MET {
                n = MET; // too many
                return;
            }
            let mut kept = n;
            for (&node, &place) in run.iter().zip(places) {
                let d2 = distance_squared(p, place);
                // Always written, but kept only where it is near enough: no branch to guess.
                (squares[kept % MET], nodes[kept % MET]) = (d2, node);
                kept += usize::from(d2 <= within);
            }
            n = kept;
        });
        if n < k || n == MET {
            return None;
        }
        let [nearer, farther] = if n < 16 {
            keep_least::<16>(&squares[..n], &mut nodes, k)
        } else if n < 32 {
            keep_least::<32>(&squares[..n], &mut nodes, k)
        } else {
            keep_least_of_many(&squares[..n], &mut nodes, k)
        };
        let tied = tied_square(nearer);
        if tied > within || farther <= tied {
            return None;
        }
        out.clear();
        out.extend(nodes[..k].iter().map(|&node| NodeId(node)));
        Some(nearer.sqrt())
    }

    /// Distance of `p` from the nearest node; infinite where there is none.
    pub fn distance(&self, p: Point) -> f64 {
        if self.xy.is_empty() {
            return f64::INFINITY;
        }
        let mut radius = self.first_radius(p, 1);
        loop {
            let mut least = f64::INFINITY;
            self.visit_all(p, radius, &mut |_, place| least = least.min(distance_squared(p, place)));
            let least = least.sqrt();
            if least <= radius || self.reaches_all(p, radius) {
                return least;
            }
            radius *= 2.0;
        }
    }

    /// A radius that holds about [`EXPECTED`]·k nodes if all are as dense as in the cell of `p`, and reaches the envelope.
    pub(crate) fn first_radius(&self, p: Point, k: usize) -> f64 {
        let mut grid = &self.grids[0];
        loop {
            let cell = grid.first as usize + grid.cell_of(p);
            match self.grids.get(self.children[cell] as usize) {
                Some(finer) => grid = finer,
                None => break,
            }
        }
        let by_density = grid.side * (EXPECTED * k as f64 / (NODES_PER_CELL * std::f64::consts::PI)).sqrt();
        // From outside nothing is met before the envelope.
        let outside =
            (0..2).fold(0.0f64, |most, d| most.max(self.envelope.min[d] - p[d]).max(p[d] - self.envelope.max[d]));
        by_density + outside.max(0.0)
    }

    /// True where the square of half side `radius` about `p` holds every node.
    pub(crate) fn reaches_all(&self, p: Point, radius: f64) -> bool {
        (0..2).all(|d| p[d] - radius <= self.envelope.min[d] && self.envelope.max[d] <= p[d] + radius)
            || !radius.is_finite()
    }

    /// Calls `visit` with every node nearer to `p` than `radius`, and some more.
    #[inline]
    pub(crate) fn visit_all(&self, p: Point, radius: f64, visit: &mut impl FnMut(u32, Point)) {
        self.visit_runs(p, radius, &mut |nodes, places| {
            nodes.iter().zip(places).for_each(|(&node, &place)| visit(node, place));
        });
    }

    /// [`Self::visit_all`] in runs of nodes and their places.
    #[inline]
    fn visit_runs(&self, p: Point, radius: f64, visit: &mut impl FnMut(&[u32], &[Point])) {
        self.visit(0, p, radius * (1.0 + ROOM_REL), visit);
    }

    /// Calls `visit` with every node of the cells that the square of half side `radius` about `p` meets.
    #[inline]
    fn visit(&self, grid: u32, p: Point, radius: f64, visit: &mut impl FnMut(&[u32], &[Point])) {
        let grid = &self.grids[grid as usize];
        let [from, to] = [-radius, radius].map(|r| [grid.column(p[0] + r, 0), grid.column(p[1] + r, 1)]);
        for row in from[1]..=to[1] {
            let row = grid.first as usize + row as usize * grid.shape[0] as usize;
            let cells = row + from[0] as usize..row + to[0] as usize + 1;
            if !grid.nests {
                self.visit_entries(cells, visit);
                continue;
            }
            for cell in cells {
                match self.children[cell] {
                    NO_GRID => self.visit_entries(cell..cell + 1, visit),
                    finer => self.visit_nested(finer, p, radius, visit),
                }
            }
        }
    }

    /// [`Self::visit`] where it calls itself.
    #[inline(never)]
    fn visit_nested(&self, grid: u32, p: Point, radius: f64, visit: &mut impl FnMut(&[u32], &[Point])) {
        self.visit(grid, p, radius, visit);
    }

    /// The nodes of neighbouring cells of one row.
    #[inline]
    fn visit_entries(&self, cells: std::ops::Range<usize>, visit: &mut impl FnMut(&[u32], &[Point])) {
        let range = self.starts[cells.start] as usize..self.starts[cells.end] as usize;
        visit(&self.entries[range.clone()], &self.places[range]);
    }
}

/// Puts the `k` nodes of the least `squares` first, ascending by number, and returns the `k`-th least square and the next
/// one, infinite where there is none; the same twice where any are equal. There are fewer than `N` squares.
///
/// Every square is compared with every other: on so few that takes no longer than sorting them, and no branch is guessed.
#[inline]
fn keep_least<const N: usize>(squares: &[f64], nodes: &mut [u32; MET], k: usize) -> [f64; 2] {
    let mut of = [f64::INFINITY; N];
    of.iter_mut().zip(squares).for_each(|(of, square)| *of = *square);
    let mut n_nearer = [0u64; N];
    for other in of {
        for (count, &square) in n_nearer.iter_mut().zip(&of) {
            *count += u64::from(other < square);
        }
    }
    let (mut sorted, mut numbers, mut sum) = ([f64::INFINITY; N], [u32::MAX; N], 0);
    for ((&square, &count), &node) in squares.iter().zip(&n_nearer).zip(nodes.iter()) {
        let place = count as usize % N;
        (sorted[place], numbers[place]) = (square, node);
        sum += count as usize;
    }
    let nearer = sorted[k - 1];
    if 2 * sum != squares.len() * (squares.len() - 1) {
        return [nearer, nearer]; // equal squares have one place
    }
    numbers[k..].fill(u32::MAX);
    // The order of unsigned numbers as that of signed ones, which processors compare faster.
    let signed = numbers.map(|number| (number ^ 1 << 31) as i32);
    let mut n_smaller = [0u32; N];
    for other in signed {
        for (count, &number) in n_smaller.iter_mut().zip(&signed) {
            *count += u32::from(other < number);
        }
    }
    for (&number, &place) in numbers[..k].iter().zip(&n_smaller) {
        nodes[place as usize % N] = number;
    }
    [nearer, sorted[k]]
}

/// [`keep_least`] of any number.
fn keep_least_of_many(squares: &[f64], nodes: &mut [u32; MET], k: usize) -> [f64; 2] {
    let mut order = [(0.0, 0); MET];
    let pairs = &mut order[..squares.len()];
    pairs.iter_mut().zip(squares.iter().zip(nodes.iter())).for_each(|(pair, (&square, &node))| *pair = (square, node));
    pairs.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    nodes[..k].iter_mut().zip(pairs.iter()).for_each(|(node, pair)| *node = pair.1);
    nodes[..k].sort_unstable();
    [pairs[k - 1].0, pairs.get(k).map_or(f64::INFINITY, |pair| pair.0)]
}

/// The square of (1 + 1e-9) times a distance, from its square.
fn tied_square(d2: f64) -> f64 {
    d2 * ((1.0 + TIE_REL) * (1.0 + TIE_REL))
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

    proptest! {
        #[test]
        fn looking_once_finds_what_the_careful_search_finds(
            nodes in prop::collection::vec(prop::array::uniform2(0i32..9), 0..80),
            scatter in prop::collection::vec(prop::array::uniform2(0.0..9.0f64), 1..160),
            centres in prop::collection::vec(prop::array::uniform2(-2.0..11.0f64), 1..20),
            k in 0usize..70,
        ) {
            let mut xy: Vec<Point> = nodes.iter().map(|n| n.map(f64::from)).collect();
            xy.extend(&scatter);
            let nearest = Nearest::new(&xy);
            let (mut scratch, mut found, mut expected) = (Scratch::default(), Vec::new(), Vec::new());
            // The centres follow each other as they come: the radius of the last one may be far too small or large.
            for (number, p) in centres.iter().chain(xy.iter().take(40)).enumerate() {
                let k = if number % 5 == 4 { k / 2 } else { k };
                let farthest = nearest.nearest_of_all(*p, k, &mut scratch, &mut found);
                nearest.nearest(*p, k, |_| true, &mut Scratch::default(), &mut expected);
                prop_assert_eq!(&found, &expected);
                let distance = expected.iter().map(|node| distance_squared(*p, xy[node.index()])).fold(0.0, f64::max).sqrt();
                prop_assert!((farthest - distance).abs() <= 1e-14 * distance, "{} {}", farthest, distance);
            }
        }
    }

    #[test]
    fn clouds_of_very_uneven_density_are_searched_as_even_ones() {
        // Spacing 1 : 10⁶, a dense line, a far outlier, and twenty nodes at one place.
        let mut xy: Vec<Point> = (0..600)
            .map(|k| {
                let (r, t) = (1e-6_f64.powf(f64::from(k % 30) / 30.0), f64::from(k / 30) * 0.314);
                [r * t.cos(), r * t.sin()]
            })
            .collect();
        xy.extend((0..500).map(|k| [2.0, 1e-4 * f64::from(k)]));
        xy.push([1e3, -1e3]);
        xy.extend([[0.5, 0.5]; 20]);
        let nearest = Nearest::new(&xy);
        let (mut scratch, mut out) = (Scratch::default(), Vec::new());
        for p in xy.iter().step_by(7).copied().chain([[0.0, 0.0], [500.0, 0.0], [-1e6, 3.0], [0.5, 0.5]]) {
            for k in [1, 9, 30] {
                nearest.nearest(p, k, |_| true, &mut scratch, &mut out);
                assert_eq!(out, by_brute_force(&xy, p, k), "{p:?}, k = {k}");
            }
        }
    }

    #[test]
    fn a_graded_cloud_is_searched_without_meeting_many_nodes() {
        // Spacing grows 1000-fold from the origin.
        let n = 200;
        let pull = |v: usize| (1e-3_f64.ln() * (1.0 - v as f64 / n as f64)).exp();
        let xy: Vec<Point> = (0..n * n)
            .map(|k| {
                let (r, t) = (pull(k % n), (k / n) as f64 / n as f64);
                [r * t.cos(), r * t.sin()]
            })
            .collect();
        let nearest = Nearest::new(&xy);
        let mut met = 0;
        for p in &xy {
            nearest.visit(0, *p, nearest.first_radius(*p, 9), &mut |run, _| met += run.len());
        }
        assert!(met < 80 * xy.len(), "{met}"); // an even cloud: 30
        // In any order: a search after one where nodes are a thousand times as far apart does not meet them all.
        let (mut scratch, mut out, mut met) = (Scratch::default(), Vec::new(), 0);
        for k in 0..xy.len() {
            let p = xy[k * 7919 % xy.len()];
            let radius = nearest.radius_after(p, 9, &scratch);
            nearest.visit(0, p, radius, &mut |run, _| met += run.len());
            nearest.nearest_of_all(p, 9, &mut scratch, &mut out);
        }
        assert!(met < 160 * xy.len(), "{met}");
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
