//! Boundary nodes whose box was taken: found by a walk from their neighbour on the boundary, and put in.

use super::half_edges::{NONE, Triangulation, next, prev};
use nmt_cloud::Cloud;
use nmt_geom::{Point, side};
use std::cmp::Ordering;

/// Steps of a walk beyond which it is given up.
///
/// It begins a box away; a walk that does not arrive goes round in circles, which constraints make possible.
const MOST_STEPS: usize = 10_000;

/// Where a point is.
enum Place {
    /// Strictly inside the triangle of this half-edge.
    In(u32),
    /// On this half-edge.
    On(u32),
}

impl Triangulation<'_> {
    /// Puts in every boundary node that owns no box; `None` where one coincides with another node or lies on a segment.
    pub fn insert_extras(&mut self, cloud: &Cloud) -> Option<()> {
        for ring in 0..cloud.boundary().n_loops() {
            let mut last = None;
            for segment in cloud.boundary().loop_segments(nmt_geom::LoopId::of(ring)) {
                let node = segment.from.0;
                let near = *self.leaving_boundary.get(node as usize)?;
                if near == NONE {
                    return None;
                }
                // The hint of a node that is not in yet begins at another.
                if self.origin(near) != node {
                    let from = last.unwrap_or(near);
                    self.insert(node, from)?;
                }
                last = Some(self.leaving_boundary[node as usize]);
            }
        }
        Some(())
    }

    fn insert(&mut self, node: u32, from: u32) -> Option<()> {
        let place = self.locate(from, self.at(node))?;
        let h = match place {
            Place::In(h) => h,
            Place::On(h) if self.is_segment(self.origin(h), self.origin(next(h))) => return None,
            Place::On(h) => h,
        };
        self.split(h, node);
        if let Place::On(h) = place {
            // The triangle on this side of the edge is flat; the flip makes two proper ones of it and its neighbour.
            let twin = self.twin(h)?;
            self.flip(h, twin);
            self.unsettled.extend([h, prev(h), twin, prev(twin)]);
        }
        self.make_delaunay();
        Some(())
    }

    /// Walks from the triangle of `from` towards `p`; `None` where it meets a node exactly at `p`, or only the border leads on.
    fn locate(&self, from: u32, p: Point) -> Option<Place> {
        let mut entered = from;
        for step in 0..MOST_STEPS {
            let first = entered - entered % 3;
            let mut on = None;
            let mut is_outside = false;
            let mut leads_on = None;
            for k in 0..3 {
                let h = first + (entered + k) % 3;
                if step > 0 && h == entered {
                    continue; // came through it
                }
                match side(self.at(self.origin(h)), self.at(self.origin(next(h))), p) {
                    Ordering::Less => {
                        is_outside = true;
                        // Triangles cover a band about the boundary: the way round is not through its border.
                        leads_on = self.twin(h);
                        if leads_on.is_some() {
                            break;
                        }
                    }
                    Ordering::Equal if on.is_some() => return None,
                    Ordering::Equal => on = Some(h),
                    Ordering::Greater => {}
                }
            }
            match on {
                _ if is_outside => entered = leads_on?,
                Some(h) => return Some(Place::On(h)),
                None => return Some(Place::In(first)),
            }
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
