//! Fills what is missing at bare segments of the real boundary; paper, Sec. 5.5 (`complete_mesh`).
//!
//! ```text
//!      covered            The front goes around every gap, the gap on its left: bare segments of the real boundary, and
//!    ┌────────────┐       sides of triangles beyond which nothing is. A triangle on a piece of the front takes that piece
//!    │  ←  front  │       away and puts its own two sides in its place, until the front is gone.
//!    ├─ bare ─────┤
//! ```

use crate::eliminate::TinyArea;
use crate::error::MeshError;
use nmt_cloud::Cloud;
use nmt_geom::point::{cross, sub};
use nmt_geom::{Bbox, Point, SegmentIndex, segment, side};
use std::cmp::Ordering;
use std::collections::{BTreeMap, BTreeSet};

/// A mesh after completion.
pub(crate) struct Completed {
    pub triangles: Vec<[u32; 3]>,
    /// Triangles taken away first.
    pub taken: usize,
    /// Triangles added.
    pub added: usize,
}

/// Completes `triangles` so that every segment of the real boundary is an edge of one of them, and nothing is left between.
///
/// # Errors
/// [`MeshError::BareSegment`] for a segment that no node can be joined to.
pub(crate) fn complete(cloud: &Cloud, triangles: Vec<[u32; 3]>) -> Result<Completed, MeshError> {
    let n_before = triangles.len();
    let mut gaps = Gaps::new(cloud, triangles);
    gaps.take_what_crosses();
    gaps.find_front();
    gaps.widen_slivers();
    let n_left = gaps.triangles.len();
    let triangles = gaps.fill()?;
    let added = triangles.len() - n_left;
    Ok(Completed { triangles, taken: n_before - n_left, added })
}

/// A triangulation with gaps.
struct Gaps<'a> {
    cloud: &'a Cloud,
    triangles: Vec<[u32; 3]>,
    /// Pieces with a gap on their left, from node to node; those of the real boundary are filled first.
    front: BTreeSet<[u32; 2]>,
    is_segment: BTreeSet<[u32; 2]>,
    tiny: TinyArea<'a>,
}

fn sides([a, b, c]: [u32; 3]) -> [[u32; 2]; 3] {
    [[a, b], [b, c], [c, a]]
}

impl<'a> Gaps<'a> {
    fn new(cloud: &'a Cloud, triangles: Vec<[u32; 3]>) -> Self {
        let is_segment = cloud.boundary().segments().iter().map(|s| [s.from.0, s.to.0]).collect();
        let tiny = TinyArea::of(cloud);
        Self { cloud, triangles, front: BTreeSet::new(), is_segment, tiny }
    }

    fn at(&self, node: u32) -> Point {
        self.cloud.xy()[node as usize]
    }

    /// Takes away triangles that a segment of the real boundary passes through.
    fn take_what_crosses(&mut self) {
        let mut covered = BTreeSet::new();
        for nodes in &self.triangles {
            covered.extend(sides(*nodes).into_iter().filter(|side| self.is_segment.contains(side)));
        }
        let bare: Vec<[u32; 2]> = self.is_segment.difference(&covered).copied().collect();
        if bare.is_empty() {
            return;
        }
        let ends = |&[from, to]: &[u32; 2]| [self.at(from), self.at(to)];
        let index = SegmentIndex::new(bare.iter().map(ends));
        let at = |node: u32| self.cloud.xy()[node as usize];
        let crosses = |nodes: [u32; 3]| {
            let corners = nodes.map(at);
            index.any_in(&Bbox::of(corners), |k| passes_through(index.segment(k), corners))
        };
        self.triangles.retain(|&nodes| !crosses(nodes));
    }

    /// Collects the pieces with a gap on their left.
    fn find_front(&mut self) {
        let mut covered: Vec<[u32; 2]> = self.triangles.iter().flat_map(|nodes| sides(*nodes)).collect();
        covered.sort_unstable();
        let is_covered = |side: [u32; 2]| covered.binary_search(&side).is_ok();
        self.front = self.is_segment.iter().filter(|side| !is_covered(**side)).copied().collect();
        let beyond = covered.iter().filter(|side| !self.is_segment.contains(*side)).map(|&[a, b]| [b, a]);
        self.front.extend(beyond.filter(|side| !is_covered(*side)));
    }

    /// Takes away the triangles beside a gap that encloses next to nothing: nodes on a skew line with rounding noise leave
    /// such gaps, and filled alone they would be what was dropped as too small.
    fn widen_slivers(&mut self) {
        loop {
            let is_narrow = |gap: &Vec<[u32; 2]>| self.area(gap) < self.tiny.at(gap.iter().map(|piece| piece[0]));
            let narrow: BTreeSet<[u32; 2]> = self.gaps().into_iter().filter(is_narrow).flatten().collect();
            let before = self.triangles.len();
            // A triangle whose side leads the other way lies beyond the front.
            self.triangles.retain(|nodes| !sides(*nodes).iter().any(|&[a, b]| narrow.contains(&[b, a])));
            if self.triangles.len() == before {
                return;
            }
            self.find_front();
        }
    }

    /// The front as closed paths.
    fn gaps(&self) -> Vec<Vec<[u32; 2]>> {
        let mut left = self.front.clone();
        let mut paths = Vec::new();
        while let Some(first) = left.pop_first() {
            let mut path = vec![first];
            let mut at = first[1];
            while at != first[0] {
                let Some(&next) = left.range([at, 0]..=[at, u32::MAX]).next() else { break };
                left.remove(&next);
                path.push(next);
                at = next[1];
            }
            paths.push(path);
        }
        paths
    }

    fn area(&self, path: &[[u32; 2]]) -> f64 {
        let Some(&[first, _]) = path.first() else { return 0.0 };
        let origin = self.at(first);
        let part = |&[a, b]: &[u32; 2]| 0.5 * cross(sub(self.at(a), origin), sub(self.at(b), origin));
        path.iter().map(part).sum()
    }

    /// Puts triangles on the front until it is gone, first on the segments of the real boundary.
    fn fill(mut self) -> Result<Vec<[u32; 3]>, MeshError> {
        let mut loose = self.loose_nodes();
        while let Some(piece) = self.next_piece() {
            let Some(apex) = self.nearest_visible(piece, &loose) else { return Err(self.bare(piece)) };
            let [a, b] = piece;
            self.triangles.push([a, b, apex]);
            self.front.remove(&piece);
            for side in [[b, apex], [apex, a]] {
                if !self.front.remove(&side) {
                    self.front.insert([side[1], side[0]]);
                }
            }
            loose.remove(&apex);
        }
        Ok(self.triangles)
    }

    /// Nodes that no triangle has and no piece of the front leads to.
    fn loose_nodes(&self) -> BTreeSet<u32> {
        let mut used = vec![false; self.cloud.n_nodes()];
        self.triangles.iter().flatten().for_each(|node| used[*node as usize] = true);
        self.front.iter().flatten().for_each(|node| used[*node as usize] = true);
        (0..used.len() as u32).filter(|node| !used[*node as usize]).collect()
    }

    fn next_piece(&self) -> Option<[u32; 2]> {
        let segment = self.front.iter().find(|piece| self.is_segment.contains(*piece));
        segment.or_else(|| self.front.first()).copied()
    }

    /// The node nearest to a piece of the front that makes a triangle with it on its left, crossing nothing and holding no
    /// other node; the smaller number of equally near ones.
    ///
    /// Not one that elimination would drop as too small \[D8\], where there is another: the nodes of a skew side are on one
    /// line but for rounding, and the next of them is nearer to a piece of that side than any node across the gap. Never one
    /// without an area in floating point, which gradients are divided by.
    fn nearest_visible(&self, [a, b]: [u32; 2], loose: &BTreeSet<u32>) -> Option<u32> {
        let (p, q) = (self.at(a), self.at(b));
        let ends: BTreeSet<u32> = self.front.iter().flatten().copied().collect();
        let mut candidates: BTreeMap<(bool, OrderedDistance, u32), ()> = BTreeMap::new();
        for &node in ends.iter().chain(loose) {
            let at = self.at(node);
            let area = 0.5 * cross(sub(q, p), sub(at, p));
            if node != a && node != b && side(p, q, at) == Ordering::Greater && area > 0.0 {
                let distance = OrderedDistance(segment::distance_to(at, p, q));
                candidates.insert((area < self.tiny.at([a, b, node]), distance, node), ());
            }
        }
        let fits = |node: &u32| {
            let corners = [p, q, self.at(*node)];
            let holds = |other: u32| ![a, b, *node].contains(&other) && is_within(self.at(other), corners);
            let crossed = |&[u, v]: &[u32; 2]| {
                let (s, t) = (self.at(u), self.at(v));
                crosses(s, t, q, corners[2]) || crosses(s, t, corners[2], p)
            };
            !ends.iter().chain(loose).any(|other| holds(*other)) && !self.front.iter().any(crossed)
        };
        candidates.into_keys().map(|(_, _, node)| node).find(fits)
    }

    fn bare(&self, [from, to]: [u32; 2]) -> MeshError {
        MeshError::BareSegment { nodes: [from as usize, to as usize], from: self.at(from), to: self.at(to) }
    }
}

/// A distance that can be sorted by.
#[derive(Clone, Copy, Debug, PartialEq)]
struct OrderedDistance(f64);

impl Eq for OrderedDistance {}

impl PartialOrd for OrderedDistance {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for OrderedDistance {
    fn cmp(&self, other: &Self) -> Ordering {
        self.0.total_cmp(&other.0)
    }
}

/// True where the open segments cross at one point within both; exact.
fn crosses(a: Point, b: Point, c: Point, d: Point) -> bool {
    let opposite = |s: Ordering, t: Ordering| s != Ordering::Equal && t == s.reverse();
    opposite(side(a, b, c), side(a, b, d)) && opposite(side(c, d, a), side(c, d, b))
}

/// True where `p` lies in the closed counter-clockwise triangle; exact.
fn is_within(p: Point, [a, b, c]: [Point; 3]) -> bool {
    [(a, b), (b, c), (c, a)].iter().all(|(u, v)| side(*u, *v, p) != Ordering::Less)
}

/// True where a segment passes through the inside of a triangle: crosses a side, or leads from a corner into it.
fn passes_through([s, t]: [Point; 2], corners: [Point; 3]) -> bool {
    let [a, b, c] = corners;
    if [(a, b), (b, c), (c, a)].iter().any(|&(u, v)| crosses(s, t, u, v)) {
        return true;
    }
    // From a corner through the opposite side is a crossing of that side; what is left ends inside, or runs along a side.
    let strictly_within = |p: Point| [(a, b), (b, c), (c, a)].iter().all(|&(u, v)| side(u, v, p) == Ordering::Greater);
    strictly_within(s) || strictly_within(t)
}
