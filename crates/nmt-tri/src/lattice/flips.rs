//! Lawson's flips until every side is Delaunay, then the ties.

use super::half_edges::{Corner, Triangulation, next, prev};
use crate::ties::must_flip;
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
    /// The nodes of the two triangles at a side: its own two, then those opposite, left first; `None` where it must stay.
    #[inline]
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
            let Some((nodes, twin)) = self.quadrilateral(h) else { continue };
            let corners = nodes.map(|n| self.at(n));
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

    /// Flips every tied diagonal among the suspects that does not contain the smallest of its four nodes.
    pub fn settle_ties(&mut self) {
        let mut suspects = std::mem::take(&mut self.suspects);
        while let Some(h) = suspects.pop() {
            if self.is_dead(h) {
                continue;
            }
            let Some((nodes, twin)) = self.quadrilateral(h) else { continue };
            if must_flip(nodes, |n| self.at(n)) {
                self.flip(h, twin);
                suspects.extend([h, prev(h), twin, prev(twin)]);
            }
        }
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
