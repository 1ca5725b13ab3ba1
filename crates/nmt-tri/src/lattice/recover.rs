//! Segments of the real boundary that are no sides yet: the triangles they cross are taken out and both halves filled
//! again. (Anglada, Computers & Graphics 21, 1997.)

use super::half_edges::{NONE, Triangulation, next, prev, sides};
use nmt_cloud::Cloud;
use nmt_geom::point::{dot, sub};
use nmt_geom::{Point, in_circle, side};
use std::cmp::Ordering;

/// What a missing segment crosses.
struct Cavity {
    /// A half-edge of each crossed triangle.
    triangles: Vec<u32>,
    /// The nodes left and right of the segment, in its direction.
    left: Vec<u32>,
    right: Vec<u32>,
    /// Sides of the cavity: their ends, seen from inside, and their twins outside.
    walls: Vec<([u32; 2], u32)>,
}

impl Triangulation<'_> {
    /// Makes every segment a side; `None` where a node lies on one, or two cross.
    pub fn recover_segments(&mut self, cloud: &Cloud) -> Option<()> {
        for segment in cloud.boundary().segments() {
            let (p, q) = (segment.from.0, segment.to.0);
            if self.half_edge(p, q).is_none() {
                let cavity = self.cavity(p, q)?;
                self.fill(&cavity, p, q)?;
                self.make_delaunay();
            }
        }
        Some(())
    }

    /// The half-edge from boundary node `p` to `q`, if there is one.
    pub fn half_edge(&self, p: u32, q: u32) -> Option<u32> {
        let first = *self.leaving_boundary.get(p as usize)?;
        self.around(first, |h| (self.origin(next(h)) == q).then_some(h))
    }

    /// The triangles between `p` and `q`.
    fn cavity(&self, p: u32, q: u32) -> Option<Cavity> {
        let (at_p, at_q) = (self.at(p), self.at(q));
        let of_line = |n: u32| side(at_p, at_q, self.at(n));
        let first = *self.leaving_boundary.get(p as usize)?;
        let is_in_the_way = |n: u32| of_line(n) == Ordering::Equal && dot(sub(self.at(n), at_p), sub(at_q, at_p)) > 0.0;
        let wedge = self.around(first, |h| {
            let (u, v) = (self.origin(next(h)), self.origin(prev(h)));
            if is_in_the_way(u) {
                return Some(None);
            }
            (of_line(u) == Ordering::Less && of_line(v) == Ordering::Greater).then_some(Some(h))
        })??;
        let (mut u, mut v) = (self.origin(next(wedge)), self.origin(prev(wedge)));
        let wall = |from: u32, to: u32, h: u32| ([from, to], self.twins[h as usize]);
        let mut cavity = Cavity {
            triangles: vec![wedge],
            left: vec![v],
            right: vec![u],
            walls: vec![wall(p, u, wedge), wall(v, p, prev(wedge))],
        };
        let mut crossed = next(wedge); // u → v, from right to left
        loop {
            if self.is_segment(u, v) {
                return None;
            }
            let entered = self.twin(crossed)?; // v → u
            let w = self.origin(prev(entered));
            cavity.triangles.push(entered);
            let (of_right, of_left) = (wall(u, w, next(entered)), wall(w, v, prev(entered)));
            if w == q {
                cavity.walls.extend([of_right, of_left]);
                return Some(cavity);
            }
            match of_line(w) {
                Ordering::Greater => {
                    cavity.left.push(w);
                    cavity.walls.push(of_left);
                    (v, crossed) = (w, next(entered));
                }
                Ordering::Less => {
                    cavity.right.push(w);
                    cavity.walls.push(of_right);
                    (u, crossed) = (w, prev(entered));
                }
                Ordering::Equal => return None,
            }
        }
    }

    /// Fills both halves of a cavity; `None` where a triangle would not be counter-clockwise.
    fn fill(&mut self, cavity: &Cavity, p: u32, q: u32) -> Option<()> {
        let mut triangles = Vec::with_capacity(cavity.triangles.len());
        self.fill_half(p, q, &cavity.left, &mut triangles)?;
        let right: Vec<u32> = cavity.right.iter().rev().copied().collect();
        self.fill_half(q, p, &right, &mut triangles)?;
        if triangles.len() != cavity.triangles.len() {
            return None;
        }
        // Every side of the new triangles, by its ends.
        let mut new_sides = Vec::with_capacity(3 * triangles.len());
        for (nodes, h) in triangles.iter().zip(&cavity.triangles) {
            for (k, slot) in sides(*h).into_iter().enumerate() {
                self.origins[slot as usize] = nodes[k];
                new_sides.push(([nodes[k], nodes[(k + 1) % 3]], slot));
            }
        }
        new_sides.sort_unstable();
        let mut walls = cavity.walls.clone();
        walls.sort_unstable();
        let find = |list: &[([u32; 2], u32)], ends: [u32; 2]| {
            list.binary_search_by_key(&ends, |(e, _)| *e).ok().map(|k| list[k].1)
        };
        for &([from, to], slot) in &new_sides {
            // A wall with the cavity on both its sides is found among the new sides.
            let twin = find(&new_sides, [to, from]).or_else(|| find(&walls, [from, to]))?;
            self.link(slot, twin);
            self.note_leaving(slot);
            self.unsettled.push(slot);
        }
        Some(())
    }

    /// Triangulates the polygon of the base p → q and the nodes `chain` left of it, in the order of the base: next to
    /// the base comes the node whose circle with it holds none of the others.
    fn fill_half(&self, p: u32, q: u32, chain: &[u32], triangles: &mut Vec<[u32; 3]>) -> Option<()> {
        let scaled = |n: u32| -> Point { self.at(n).map(|v| v * self.scale) };
        let mut open = vec![(p, q, chain)];
        while let Some((p, q, chain)) = open.pop() {
            let mut best = 0;
            for k in 1..chain.len() {
                let [a, b, c, d] = [p, q, chain[best], chain[k]].map(scaled);
                if in_circle(a, b, c, d) == Ordering::Greater {
                    best = k;
                }
            }
            let Some(&apex) = chain.get(best) else { continue };
            if side(self.at(p), self.at(q), self.at(apex)) != Ordering::Greater {
                return None;
            }
            triangles.push([p, q, apex]);
            open.push((p, apex, &chain[..best]));
            open.push((apex, q, &chain[best + 1..]));
        }
        Some(())
    }

    /// Takes away everything outside the material, which lies on the left of each segment.
    pub fn drop_outside(&mut self, cloud: &Cloud) -> Option<()> {
        let mut stack = Vec::new();
        for segment in cloud.boundary().segments() {
            let h = self.half_edge(segment.from.0, segment.to.0)?;
            stack.push(self.twin(h)?);
        }
        while let Some(h) = stack.pop() {
            if self.is_dead(h) {
                continue;
            }
            let beyond = sides(h).map(|s| {
                let twin = self.twin(s)?;
                (!self.is_segment(self.origin(s), self.origin(next(s)))).then_some(twin)
            });
            stack.extend(beyond.into_iter().flatten());
            self.origins[(h - h % 3) as usize] = NONE;
        }
        Some(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Nodes 0 and 1 at the ends of a row, with nodes above and below that hide them from each other.
    fn lens(below: &[Point]) -> Vec<Point> {
        [[0.0, 0.0], [4.0, 0.0], [1.0, 1.0], [2.0, 1.2], [3.0, 1.0]].iter().chain(below).copied().collect()
    }

    #[test]
    fn a_segment_across_several_triangles_is_recovered_with_all_nodes() {
        let xy = lens(&[[1.0, -1.0], [3.0, -1.0]]);
        let triangles = [[0, 5, 2], [5, 3, 2], [5, 6, 3], [6, 4, 3], [6, 1, 4]];
        let mut lens = Triangulation::sample(&xy, &[], &[[0, 1]], &triangles);
        // Turning about node 0 stops at the border: begin at its first triangle.
        lens.leaving_boundary[0] = 0;
        let cavity = lens.cavity(0, 1).expect("nothing lies on it");
        assert_eq!((&*cavity.left, &*cavity.right), (&[2, 3, 4][..], &[5, 6][..]));
        lens.fill(&cavity, 0, 1).expect("two polygons");
        lens.make_delaunay();
        let triangles = lens.triangles();
        assert_eq!(triangles.len(), 5);
        assert!(triangles.iter().any(|t| t[0] == 0 && t[1] == 1) && triangles.iter().any(|t| t[0] == 0 && t[2] == 1));
    }

    #[test]
    fn a_node_on_the_way_or_another_segment_is_refused() {
        let xy = lens(&[[1.0, -1.0], [3.0, -1.0], [2.0, 0.0]]);
        let triangles = [[0, 5, 2], [5, 7, 2], [2, 7, 3], [5, 6, 7], [6, 4, 7], [7, 4, 3], [6, 1, 4]];
        let lens_with_node = Triangulation::sample(&xy, &[], &[[0, 1]], &triangles);
        assert!(lens_with_node.cavity(0, 1).is_none());
        let xy = lens(&[[1.0, -1.0], [3.0, -1.0]]);
        let triangles = [[0, 5, 2], [5, 3, 2], [5, 6, 3], [6, 4, 3], [6, 1, 4]];
        let crossed = Triangulation::sample(&xy, &[], &[[0, 1], [3, 6]], &triangles);
        assert!(crossed.cavity(0, 1).is_none());
    }
}
