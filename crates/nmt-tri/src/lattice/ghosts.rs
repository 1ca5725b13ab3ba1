//! Ghosts that are left inside the material are taken out again.

use super::half_edges::{NONE, Triangulation, next, prev};
use nmt_geom::side;
use std::cmp::Ordering;

impl Triangulation<'_> {
    /// Takes out every ghost; `None` where one lies exactly between its neighbours.
    pub fn remove_ghosts(&mut self) -> Option<()> {
        for ghost in 0..self.ghosts.len() {
            let node = (self.xy.len() + ghost) as u32;
            let h = self.leaving_ghost[ghost];
            if h != NONE && !self.is_dead(h) && self.origin(h) == node {
                self.remove(ghost)?;
                self.make_delaunay();
            }
        }
        Some(())
    }

    /// Flips sides away from a ghost until three are left, and makes one triangle of its three.
    fn remove(&mut self, ghost: usize) -> Option<()> {
        let is_left = |t: &Self, [a, b, c]: [u32; 3]| side(t.at(a), t.at(b), t.at(c)) == Ordering::Greater;
        loop {
            let first = self.leaving_ghost[ghost];
            let mut h = first;
            let mut degree = 0;
            let mut flippable = None;
            loop {
                degree += 1;
                let twin = self.twin(h)?;
                let [g, v, after, before] = [h, next(h), prev(h), prev(twin)].map(|h| self.origin(h));
                if flippable.is_none() && is_left(self, [v, after, before]) && is_left(self, [g, before, after]) {
                    flippable = Some((h, twin));
                }
                h = self.twin(prev(h))?;
                // Three are too few to flip, one more than that is enough to know.
                if h == first || (degree > 3 && flippable.is_some()) {
                    break;
                }
            }
            if degree == 3 {
                return self.merge_three(first);
            }
            let (h, twin) = flippable?;
            self.flip(h, twin);
            // The new triangle that is free of the ghost.
            self.unsettled.extend([twin, next(twin), prev(twin)]);
        }
    }

    /// The triangles (g, u, v), (g, v, w), (g, w, u) about the origin g of `h` become (u, v, w).
    fn merge_three(&mut self, h: u32) -> Option<()> {
        let second = self.twin(prev(h))?;
        let third = self.twin(prev(second))?;
        let (v, w) = (self.origin(next(second)), self.origin(next(third)));
        let (vw_twin, wu_twin) = (self.twins[next(second) as usize], self.twins[next(third) as usize]);
        for gone in [second, third] {
            self.origins[(gone - gone % 3) as usize] = NONE;
        }
        // u → v stays where it is.
        let (uv, vw, wu) = (next(h), prev(h), h);
        self.origins[vw as usize] = v;
        self.origins[wu as usize] = w;
        self.link(vw, vw_twin);
        self.link(wu, wu_twin);
        [uv, vw, wu].into_iter().for_each(|h| self.note_leaving(h));
        self.unsettled.extend([uv, vw, wu]);
        Some(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nmt_geom::Point;

    #[test]
    fn a_ghost_among_any_number_of_nodes_leaves_their_delaunay_triangulation() {
        for n in 3..12u32 {
            let angle = |k: u32| std::f64::consts::TAU * f64::from(k) / f64::from(n);
            // On an ellipse with one node pulled in, so that its polygon has a reflex corner.
            let radius = |k: u32| if k == 1 && n > 4 { 0.6 } else { 1.0 };
            let xy: Vec<Point> =
                (0..n).map(|k| [2.0 * radius(k) * angle(k).cos(), radius(k) * angle(k).sin()]).collect();
            let fan: Vec<[u32; 3]> = (0..n).map(|k| [n, k, (k + 1) % n]).collect();
            let mut ring = Triangulation::sample(&xy, &[[0.013, 0.007]], &[], &fan);
            assert_eq!(ring.remove_ghosts(), Some(()));
            let triangles = ring.triangles();
            assert_eq!(triangles.len(), n as usize - 2);
            assert!(triangles.iter().flatten().all(|node| *node < n));
            ring.unsettled
                .extend((0..ring.origins.len() as u32).filter(|h| ring.origins[(h - h % 3) as usize] != NONE));
            ring.make_delaunay();
            assert_eq!(ring.triangles(), triangles);
        }
    }
}
