//! Lawson's flips until every side is Delaunay, then the ties.

use super::half_edges::{Corner, Triangulation, next, prev};
use crate::ties::{Flippable, Pair, settle};
use nmt_geom::point::{cross, dot, sub};
use nmt_geom::{Point, in_circle};
use std::cmp::Ordering;

/// Rounding of the in-circle determinant, as a fraction of the fourth power of the longest side.
///
/// Each of its two products has a relative error of a few 1e-16 in either factor, each at most the square of that side.
const ROUNDING_REL: f64 = 1.0e-14;

/// A determinant above this fraction of area times squared side is no tie: [`crate::ties`] takes 1e-9 of the longest
/// distance, whose square is at most four times that of the longest side about the diagonal.
const TIE_BAND_REL: f64 = 5.0e-9;

/// What becomes of a side of two triangles.
enum Verdict {
    Legal,
    Illegal,
    /// So near to a circle that only exact numbers tell; looked at again when ties are settled.
    Near,
}

impl Triangulation<'_> {
    /// The nodes of the two triangles at a side, its own two, then those opposite, left first; and its twin.
    ///
    /// `None` where it must stay.
    #[inline(always)]
    fn quadrilateral(&self, h: u32) -> Option<([u32; 4], u32)> {
        let twin = self.twin(h)?;
        let (a, b) = (self.origin(h), self.origin(next(h)));
        if self.is_segment(a, b) {
            return None;
        }
        Some(([a, b, self.origin(prev(h)), self.origin(prev(twin))], twin))
    }

    /// Flips until every side in `unsettled`, and every side about a flip, is Delaunay or a segment.
    ///
    /// A flip lowers the surface lifted to the paraboloid, so this ends.
    pub fn make_delaunay(&mut self) {
        while let Some(h) = self.unsettled.pop() {
            let Some(([a, b, c, d], twin)) = self.quadrilateral(h) else { continue };
            let corners = [self.at(a), self.at(b), self.at(c), self.at(d)];
            let flips = match verdict(corners) {
                Verdict::Legal => false,
                Verdict::Illegal => true,
                Verdict::Near => {
                    let [a, b, c, d] = corners.map(|p| p.map(|v| v * self.scale));
                    let flips = in_circle(a, b, c, d) == Ordering::Greater;
                    self.suspects.push(if flips { next(h) } else { h });
                    flips
                }
            };
            if flips {
                self.flip(h, twin);
                self.unsettled.extend([h, prev(h), twin, prev(twin)]);
            }
        }
    }

    /// Settles the ties among the suspects.
    pub fn settle_ties(&mut self) {
        let suspects = std::mem::take(&mut self.suspects);
        settle(self, suspects.into_iter());
    }
}

impl Flippable for Triangulation<'_> {
    fn at(&self, node: u32) -> Point {
        self.at(node)
    }

    fn n_triangles(&self) -> usize {
        self.origins.len() / 3
    }

    fn pair(&self, side: u32) -> Option<Pair> {
        if self.is_dead(side) {
            return None;
        }
        let (nodes, twin) = self.quadrilateral(side)?;
        Some(Pair { nodes, triangles: [side / 3, twin / 3], twin })
    }

    fn flip(&mut self, side: u32, pair: &Pair) -> [u32; 4] {
        self.flip(side, pair.twin);
        [side, prev(side), pair.twin, prev(pair.twin)]
    }
}

/// Whether the side a b of (a, b, c) and (b, a, d) is Delaunay.
#[inline]
fn verdict([a, b, c, d]: [Point; 4]) -> Verdict {
    let (ac, bc, ad, bd) = (sub(a, c), sub(b, c), sub(a, d), sub(b, d));
    let at_c = Corner { twice_area: cross(ac, bc), dot: dot(ac, bc) };
    let at_d = Corner { twice_area: cross(bd, ad), dot: dot(bd, ad) };
    let longest = dot(ac, ac).max(dot(bc, bc)).max(dot(ad, ad).max(dot(bd, bd)));
    let det = at_c.legality(at_d);
    let band = longest * (TIE_BAND_REL * at_c.twice_area.max(at_d.twice_area) + ROUNDING_REL * longest);
    if det > band {
        Verdict::Legal
    } else if det < -band {
        Verdict::Illegal
    } else {
        Verdict::Near
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A strip of triangles between two rows of nodes, cut the wrong way.
    fn strip(n: u32) -> (Vec<Point>, Vec<[u32; 3]>) {
        let lower = (0..n).map(|k| [f64::from(k), 0.0]);
        let upper = (0..n).map(|k| [f64::from(k) + 0.4, 1.0]);
        let cells = (0..n - 1).flat_map(|k| [[k, k + 1, n + k + 1], [k, n + k + 1, n + k]]);
        (lower.chain(upper).collect(), cells.collect())
    }

    #[test]
    fn flips_find_the_delaunay_triangulation_but_for_segments() {
        let (xy, triangles) = strip(4);
        for (segments, expected) in [
            (vec![], vec![[0, 1, 4], [1, 2, 5], [1, 5, 4], [2, 3, 6], [2, 6, 5], [3, 7, 6]]),
            (vec![[1, 6]], vec![[0, 1, 4], [1, 2, 6], [1, 5, 4], [1, 6, 5], [2, 3, 6], [3, 7, 6]]),
        ] {
            let mut strip = Triangulation::sample(&xy, &[], &segments, &triangles);
            strip.unsettled.extend(0..18);
            strip.make_delaunay();
            assert_eq!(strip.triangles(), expected);
        }
    }

    #[test]
    fn suspects_are_settled_by_number() {
        let xy = [[1.0, 1.0], [0.0, 1.0], [0.0, 0.0], [1.0, 0.0]];
        let mut square = Triangulation::sample(&xy, &[], &[], &[[2, 3, 1], [3, 0, 1]]);
        square.unsettled.extend(0..6);
        square.make_delaunay();
        assert_eq!(square.triangles(), [[0, 1, 3], [1, 2, 3]]);
        square.settle_ties();
        assert_eq!(square.triangles(), [[0, 1, 2], [0, 2, 3]]);
    }
}
