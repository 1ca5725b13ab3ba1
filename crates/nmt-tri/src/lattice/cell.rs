//! One cell of four nodes: which diagonal is Delaunay, and what its triangles tell of its sides.
//!
//! Corners a, b, c, d run counter-clockwise from the lower left one.

use super::half_edges::Corner;
use nmt_geom::point::{cross, dot, sub};
use nmt_geom::{Point, in_circle, side};
use std::cmp::Ordering;

/// An in-circle determinant above this, in units of h_x·h_y·max(h_x, h_y)², is no tie and no rounding.
///
/// Two cells span three boxes: twice an area is at most 18 h_x·h_y, a squared distance 18 max(h_x, h_y)², and a tie is
/// 1e-9 of their product.
const DECIDED: f64 = 4.0e-7;

/// Twice an area above this, in units of h_x·h_y, is positive whatever the rounding.
const POSITIVE: f64 = 1.0e-12;

/// What the numbers of a cell are compared with.
pub(super) struct Limits {
    /// In-circle determinants above it are decided.
    pub decided: f64,
    /// Twice an area above it is positive.
    positive: f64,
}

impl Limits {
    pub fn new([h_x, h_y]: [f64; 2]) -> Self {
        let h = h_x.max(h_y);
        Self { decided: DECIDED * h_x * h_y * h * h, positive: POSITIVE * h_x * h_y }
    }
}

/// The sides of a cell as vectors, upwards and to the right, and its corners.
pub(super) struct Cell {
    bottom: Point,
    top: Point,
    left: Point,
    right: Point,
    at_a: Corner,
    at_b: Corner,
    at_c: Corner,
    at_d: Corner,
}

/// How a cell is cut.
#[derive(Clone, Copy)]
pub(super) struct Cut {
    /// Along the diagonal a c rather than b d.
    pub is_ac: bool,
    /// Whether the diagonal must be looked at again when ties are settled.
    pub is_suspect: bool,
}

/// What the two triangles of a cell tell of its sides.
pub(super) struct Sides {
    pub bottom: Corner,
    pub right: Corner,
    pub top: Corner,
    pub left: Corner,
}

impl Cell {
    #[inline]
    pub fn new([a, b, c, d]: [Point; 4]) -> Self {
        let (bottom, top, left, right) = (sub(b, a), sub(c, d), sub(d, a), sub(c, b));
        Self {
            at_a: Corner { twice_area: cross(bottom, left), dot: dot(bottom, left) },
            at_b: Corner { twice_area: cross(bottom, right), dot: -dot(bottom, right) },
            at_c: Corner { twice_area: cross(top, right), dot: dot(top, right) },
            at_d: Corner { twice_area: cross(top, left), dot: -dot(top, left) },
            bottom,
            top,
            left,
            right,
        }
    }

    /// The Delaunay diagonal by plain numbers; `None` where they do not decide.
    ///
    /// In a cell with a reflex corner the determinant is that of the diagonal from there.
    #[inline]
    pub fn cut(&self, [a, b, c, d]: [u32; 4], limits: &Limits) -> Option<Cut> {
        let legality = self.at_b.legality(self.at_d);
        let is_ac = legality > 0.0;
        let (one, other) = if is_ac { (self.at_b, self.at_d) } else { (self.at_a, self.at_c) };
        if one.twice_area.min(other.twice_area) <= limits.positive {
            return None;
        }
        if legality.abs() > limits.decided {
            return Some(Cut { is_ac, is_suspect: false });
        }
        // Every cell of a regular cloud: a tie, whatever the rounding.
        let is_rectangle = self.bottom[1] == 0.0 && self.top[1] == 0.0 && self.left[0] == 0.0 && self.right[0] == 0.0;
        is_rectangle.then_some(Cut { is_ac: a.min(c) < b.min(d), is_suspect: false })
    }

    /// The corners opposite to the sides after the cut.
    #[inline]
    pub fn sides(&self, cut: Cut) -> Sides {
        // Of a triangle whose sides u, v meet in an angle with the product u·v, that at the far end of u is u² − u·v.
        let seen = |corner: Corner, side: Point| Corner { dot: dot(side, side) - corner.dot, ..corner };
        if cut.is_ac {
            Sides {
                bottom: seen(self.at_b, self.right),
                right: seen(self.at_b, self.bottom),
                top: seen(self.at_d, self.left),
                left: seen(self.at_d, self.top),
            }
        } else {
            Sides {
                bottom: seen(self.at_a, self.left),
                left: seen(self.at_a, self.bottom),
                top: seen(self.at_c, self.right),
                right: seen(self.at_c, self.top),
            }
        }
    }
}

/// The diagonal of a cell that plain numbers do not decide; `None` where neither cuts it into two triangles.
///
/// `scale` brings the corners near 1.
#[cold]
pub(super) fn cut_exactly([a, b, c, d]: [u32; 4], corners: [Point; 4], scale: f64) -> Option<Cut> {
    let [p_a, p_b, p_c, p_d] = corners.map(|p| p.map(|v| v * scale));
    let is_left = |p: Point, q: Point, r: Point| side(p, q, r) == Ordering::Greater;
    let may_be_ac = is_left(p_a, p_b, p_c) && is_left(p_c, p_d, p_a);
    let may_be_bd = is_left(p_b, p_c, p_d) && is_left(p_d, p_a, p_b);
    let is_ac = match (may_be_ac, may_be_bd) {
        (false, false) => return None,
        (true, true) => match in_circle(p_a, p_b, p_c, p_d) {
            Ordering::Less => true,
            Ordering::Greater => false,
            Ordering::Equal => a.min(c) < b.min(d),
        },
        (only_ac, _) => only_ac,
    };
    Some(Cut { is_ac, is_suspect: true })
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT: [f64; 2] = [1.0, 1.0];

    fn cut(corners: [Point; 4], nodes: [u32; 4]) -> Option<bool> {
        let by_numbers = Cell::new(corners).cut(nodes, &Limits::new(UNIT));
        by_numbers.or_else(|| cut_exactly(nodes, corners, 1.0)).map(|cut| cut.is_ac)
    }

    #[test]
    fn a_cell_with_a_reflex_corner_is_cut_from_there() {
        let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        for (corner, to) in [(0, [0.6, 0.7]), (1, [0.4, 0.7]), (2, [0.3, 0.4]), (3, [0.7, 0.4])] {
            let mut corners = square;
            corners[corner] = to;
            assert_eq!(cut(corners, [0, 1, 2, 3]), Some(corner % 2 == 0), "{corners:?}");
        }
    }

    #[test]
    fn a_rectangle_along_the_axes_is_cut_by_number_and_done_with() {
        let rectangle = Cell::new([[0.0, 0.0], [1.0, 0.0], [1.0, 0.8], [0.0, 0.8]]);
        for (nodes, is_ac) in [([0, 1, 2, 3], true), ([9, 1, 8, 3], false)] {
            let cut = rectangle.cut(nodes, &Limits::new(UNIT)).expect("plain numbers do");
            assert_eq!((cut.is_ac, cut.is_suspect), (is_ac, false));
        }
    }

    #[test]
    fn a_tie_within_rounding_is_left_for_when_ties_are_settled() {
        let (s, c) = 0.3f64.sin_cos();
        let turned = [[0.0, 0.0], [c, s], [c - 0.8 * s, s + 0.8 * c], [-0.8 * s, 0.8 * c]];
        assert!(Cell::new(turned).cut([0, 1, 2, 3], &Limits::new(UNIT)).is_none());
        assert!(cut_exactly([0, 1, 2, 3], turned, 1.0).is_some_and(|cut| cut.is_suspect));
    }

    #[test]
    fn a_cell_turned_inside_out_is_not_cut() {
        assert_eq!(cut([[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]], [0, 1, 2, 3]), None);
    }

    #[test]
    fn sides_see_the_angle_opposite_to_them() {
        let cell = Cell::new([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
        for is_ac in [true, false] {
            let Sides { bottom, right, top, left } = cell.sides(Cut { is_ac, is_suspect: false });
            // 45° each: area 1/2, and 1·√2·cos 45° = 1.
            assert!([bottom, right, top, left].iter().all(|corner| corner.twice_area == 1.0 && corner.dot == 1.0));
        }
    }
}
