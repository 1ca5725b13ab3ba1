//! Boundary nodes whose box was taken: found by a walk from their neighbour on the boundary, and put in.

use super::half_edges::{NONE, Triangulation, next, prev, sides};
use nmt_cloud::Cloud;
use nmt_geom::{LoopId, Point, side};
use std::cmp::Ordering;
use std::collections::{BTreeSet, VecDeque};

/// Steps of a walk beyond which it is given up.
///
/// It begins a box away; a walk that does not arrive goes round in circles, which constraints make possible.
const MOST_STEPS: usize = 10_000;

/// Triangles that are searched where a walk is given up: those of hundreds of boxes around.
const MOST_SEARCHED: usize = 1_000;

/// Where a point is with respect to a triangle.
enum Place {
    /// Strictly inside.
    Inside,
    /// On this side of it.
    On(u32),
    /// At one of its nodes.
    AtNode,
    /// Beyond some side.
    Beyond,
}

/// The triangle that holds a point, by one of its half-edges.
struct Found {
    h: u32,
    /// Whether the point is on `h` itself.
    is_on_side: bool,
}

impl Triangulation<'_> {
    /// Puts in every boundary node that owns no box; `None` where one coincides with another node or lies on a segment.
    pub fn insert_extras(&mut self, cloud: &Cloud) -> Option<()> {
        for ring in 0..cloud.boundary().n_loops() {
            let mut last = None;
            for segment in cloud.boundary().loop_segments(LoopId::of(ring)) {
                let node = segment.from.0;
                let near = *self.leaving_boundary.get(node as usize)?;
                if near == NONE {
                    return None;
                }
                // The half-edge noted for a node that is not in yet begins at another.
                if self.origin(near) != node {
                    self.insert(node, [last.unwrap_or(near), near])?;
                    self.make_delaunay();
                }
                last = Some(self.leaving_boundary[node as usize]);
            }
        }
        Some(())
    }

    fn insert(&mut self, node: u32, starts: [u32; 2]) -> Option<()> {
        let p = self.at(node);
        let walked = starts.iter().find_map(|from| self.walk(*from, p));
        let Found { h, is_on_side } = walked.or_else(|| starts.iter().find_map(|from| self.search(*from, p)))?;
        if is_on_side && self.is_segment(self.origin(h), self.origin(next(h))) {
            return None;
        }
        self.split(h, node);
        if is_on_side {
            // The triangle on this side of the edge is flat; the flip makes two proper ones of it and its neighbour.
            let twin = self.twin(h)?;
            self.flip(h, twin);
            self.unsettled.extend([h, prev(h), twin, prev(twin)]);
        }
        Some(())
    }

    /// `Greater` where `p` is beyond the side `h` of its triangle.
    fn beyond(&self, h: u32, p: Point) -> Ordering {
        side(self.at(self.origin(h)), self.at(self.origin(next(h))), p).reverse()
    }

    /// Where `p` is with respect to the triangle of `h`.
    fn place(&self, h: u32, p: Point) -> Place {
        let mut place = Place::Inside;
        for h in sides(h) {
            match self.beyond(h, p) {
                Ordering::Greater => return Place::Beyond,
                Ordering::Equal if matches!(place, Place::On(_)) => place = Place::AtNode,
                Ordering::Equal => place = Place::On(h),
                Ordering::Less => {}
            }
        }
        place
    }

    /// The triangle of `h` if it holds `p`; `None` also where a node does.
    fn holder(&self, h: u32, p: Point) -> Option<Found> {
        match self.place(h, p) {
            Place::Inside => Some(Found { h, is_on_side: false }),
            Place::On(h) => Some(Found { h, is_on_side: true }),
            Place::AtNode | Place::Beyond => None,
        }
    }

    /// Walks from the triangle of `from` towards `p`; `None` where the way leads out through the border: where material
    /// is thin, triangles cover a band about the boundary alone.
    fn walk(&self, from: u32, p: Point) -> Option<Found> {
        let mut entered = from;
        for _ in 0..MOST_STEPS {
            let ways = [next(entered), prev(entered), entered];
            match ways.into_iter().find(|h| self.beyond(*h, p) == Ordering::Greater && self.twin(*h).is_some()) {
                Some(way) => entered = self.twin(way)?,
                None => return self.holder(entered, p),
            }
        }
        None
    }

    /// Searches the triangles about that of `from` for the one that holds `p`, nearest first.
    fn search(&self, from: u32, p: Point) -> Option<Found> {
        let mut seen = BTreeSet::from([from - from % 3]);
        let mut queue = VecDeque::from([from]);
        for _ in 0..MOST_SEARCHED {
            let h = queue.pop_front()?;
            if let Some(found) = self.holder(h, p) {
                return Some(found);
            }
            let beyond = sides(h).into_iter().filter_map(|s| self.twin(s));
            queue.extend(beyond.filter(|twin| seen.insert(twin - twin % 3)));
        }
        None
    }

    /// Cuts the triangle of `h` into three about `node`; `h` keeps its slot.
    fn split(&mut self, h: u32, node: u32) {
        let (h_next, h_prev) = (next(h), prev(h));
        let (b, c) = (self.origin(h_next), self.origin(h_prev));
        let a = self.origin(h);
        let (bc_twin, ca_twin) = (self.twins[h_next as usize], self.twins[h_prev as usize]);
        let (bc, ca) = (self.origins.len() as u32, self.origins.len() as u32 + 3);
        self.origins.extend_from_slice(&[b, c, node, c, a, node]);
        self.twins.extend_from_slice(&[NONE; 6]);
        self.origins[h_prev as usize] = node; // (a, b, node)
        self.link(bc, bc_twin);
        self.link(ca, ca_twin);
        self.link(h_next, bc + 2); // b → node
        self.link(bc + 1, ca + 2); // c → node
        self.link(ca + 1, h_prev); // a → node
        [h, h_next, ca, h_prev].into_iter().for_each(|h| self.note_leaving(h));
        self.unsettled.extend([h, bc, ca]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CORNERS: [Point; 4] = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]];
    const HALVES: [[u32; 3]; 2] = [[0, 1, 2], [0, 2, 3]];

    fn inserted(p: Point, segments: &[[u32; 2]]) -> Option<Vec<[u32; 3]>> {
        let xy: Vec<Point> = CORNERS.into_iter().chain([p]).collect();
        let mut square = Triangulation::sample(&xy, &[], segments, &HALVES);
        square.insert(4, [0, 0])?;
        square.make_delaunay();
        Some(square.triangles())
    }

    #[test]
    fn a_node_in_a_triangle_or_on_a_side_is_joined_to_all_around() {
        for p in [[1.0, 0.7], [1.0, 1.0], [0.6, 1.0]] {
            assert_eq!(inserted(p, &[]), Some(vec![[0, 1, 4], [0, 4, 3], [1, 2, 4], [2, 3, 4]]), "{p:?}");
        }
    }

    #[test]
    fn a_node_on_a_segment_at_another_or_outside_is_refused() {
        assert_eq!(inserted([1.0, 1.0], &[[0, 2]]), None);
        assert_eq!(inserted([2.0, 2.0], &[]), None);
        assert_eq!(inserted([3.0, 1.0], &[]), None);
    }

    #[test]
    fn a_walk_that_would_leave_a_bent_band_is_a_search() {
        // A band of triangles round three sides of a square; seen from its one end, the other is beyond the border.
        let xy = [[0.0, 0.0], [9.0, 0.0], [9.0, 9.0], [0.0, 9.0], [1.0, 1.0], [8.0, 1.0], [8.0, 8.0], [1.0, 8.0]];
        let band = [[0, 1, 5], [0, 5, 4], [1, 2, 6], [1, 6, 5], [2, 3, 7], [2, 7, 6]];
        let band = Triangulation::sample(&xy, &[], &[], &band);
        let p = [1.0, 8.5];
        assert!(band.walk(5, p).is_none());
        assert_eq!(band.search(5, p).map(|found| found.h / 3), Some(4));
    }
}
