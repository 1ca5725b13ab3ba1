//! Cells of four occupied boxes, each cut along its Delaunay diagonal; flips follow a row behind.
//!
//! With one node per box, rows of nodes run to the right in their bands and columns upwards: every cell is a simple
//! counter-clockwise quadrilateral, with at most one reflex corner, for any displacement below half a spacing.

use super::boxes::{Boxes, Row, Rows};
use super::frame::Frame;
use super::half_edges::{Corner, FrontEdge, NONE, Triangulation};
use crate::ties::is_tie;
use nmt_cloud::Cloud;
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

/// What a cell is compared with.
struct Limits {
    decided: f64,
    positive: f64,
}

/// Builds the triangulation of all owners of boxes, row by row; `None` where a cell is no counter-clockwise
/// quadrilateral, or the rows cannot be filled.
pub(super) fn sweep(triangulation: &mut Triangulation, cloud: &Cloud, frame: &Frame, boxes: &Boxes) -> Option<()> {
    let [width, height] = frame.shape;
    let [h_x, h_y] = frame.spacing;
    let h = h_x.max(h_y);
    let limits = Limits { decided: DECIDED * h_x * h_y * h * h, positive: POSITIVE * h_x * h_y };
    let mut rows = Rows::new(cloud, frame, boxes)?;
    let (mut below, mut above) = (Row::new(width), Row::new(width));
    triangulation.front = vec![FrontEdge::OPEN; width - 1];
    rows.fill(0, &mut triangulation.ghosts, &mut below)?;
    for row in 1..height {
        rows.fill(row, &mut triangulation.ghosts, &mut above)?;
        triangulation.leaving_ghost.resize(triangulation.ghosts.len(), NONE);
        triangulation.add_cells(&below, &above, &limits)?;
        triangulation.note_lower_corners(&below);
        triangulation.make_delaunay();
        std::mem::swap(&mut below, &mut above);
    }
    triangulation.close_front();
    rows.are_all_placed().then_some(())
}

impl Triangulation<'_> {
    /// Puts cells between two rows of boxes; sides that may not be Delaunay are left in `unsettled`.
    fn add_cells(&mut self, below: &Row, above: &Row, limits: &Limits) -> Option<()> {
        let Self { origins, twins, front, unsettled, suspects, scale, .. } = self;
        // The right side of the last cell, its slot and the corner opposite to it; none where there is no cell.
        let mut left_side = FrontEdge::OPEN;
        let owners = below.owners.windows(2).zip(above.owners.windows(2));
        let places = below.places.windows(2).zip(above.places.windows(2));
        for (col, (lower, (owners, places))) in front.iter_mut().zip(owners.zip(places)).enumerate() {
            let ([a, b], [d, c]) = (owners.0, owners.1) else { continue };
            let ([p_a, p_b], [p_d, p_c]) = (places.0, places.1) else { continue };
            let (a, b, c, d) = (*a, *b, *c, *d);
            if a.max(b).max(c.max(d)) == NONE {
                if lower.slot != NONE {
                    twins[lower.slot as usize] = NONE;
                }
                (*lower, left_side) = (FrontEdge::OPEN, FrontEdge::OPEN);
                continue;
            }
            let base = origins.len() as u32;
            let (bottom, top, left, right) = (sub(*p_b, *p_a), sub(*p_c, *p_d), sub(*p_d, *p_a), sub(*p_c, *p_b));
            let at_a = Corner { twice_area: cross(bottom, left), dot: dot(bottom, left) };
            let at_b = Corner { twice_area: cross(bottom, right), dot: -dot(bottom, right) };
            let at_c = Corner { twice_area: cross(top, right), dot: dot(top, right) };
            let at_d = Corner { twice_area: cross(top, left), dot: -dot(top, left) };
            let legality = at_b.legality(at_d);
            let mut is_ac = legality > 0.0;
            let least = |is_ac: bool| {
                if is_ac { at_b.twice_area.min(at_d.twice_area) } else { at_a.twice_area.min(at_c.twice_area) }
            };
            let mut is_suspect = false;
            if !(legality.abs() > limits.decided && least(is_ac) > limits.positive) {
                let is_rectangle = bottom[1] == 0.0 && top[1] == 0.0 && left[0] == 0.0 && right[0] == 0.0;
                if is_rectangle && least(is_ac) > limits.positive {
                    is_ac = a.min(c) < b.min(d);
                } else {
                    Choice { is_ac, is_suspect } = choose([a, b, c, d], [*p_a, *p_b, *p_c, *p_d], *scale)?;
                }
            }
            let square = |v: Point| dot(v, v);
            let opposite = |corner: Corner, side: Point| Corner { dot: square(side) - corner.dot, ..corner };
            let (of_bottom, of_right, of_top, of_left);
            let bottom_twin = lower.slot;
            let top_twin = Self::front_twin(col);
            if is_ac {
                // (a, b, c) and (c, d, a).
                (of_bottom, of_right) = (opposite(at_b, right), opposite(at_b, bottom));
                (of_top, of_left) = (opposite(at_d, left), opposite(at_d, top));
                origins.extend_from_slice(&[a, b, c, c, d, a]);
                twins.extend_from_slice(&[bottom_twin, NONE, base + 5, top_twin, left_side.slot, base + 2]);
            } else {
                // (a, b, d) and (c, d, b).
                (of_bottom, of_left) = (opposite(at_a, left), opposite(at_a, bottom));
                (of_top, of_right) = (opposite(at_c, right), opposite(at_c, top));
                origins.extend_from_slice(&[a, b, d, c, d, b]);
                twins.extend_from_slice(&[bottom_twin, base + 4, left_side.slot, top_twin, base + 1, NONE]);
            }
            let (left_slot, right_slot, diagonal) =
                if is_ac { (base + 4, base + 1, base + 2) } else { (base + 2, base + 5, base + 1) };
            if bottom_twin != NONE {
                twins[bottom_twin as usize] = base;
            }
            if left_side.slot != NONE {
                twins[left_side.slot as usize] = left_slot;
            }
            if !(lower.corner.legality(of_bottom) > limits.decided) {
                unsettled.push(base);
            }
            if !(left_side.corner.legality(of_left) > limits.decided) {
                unsettled.push(left_slot);
            }
            if is_suspect {
                suspects.push(diagonal);
            }
            *lower = FrontEdge { slot: base + 3, corner: of_top };
            left_side = FrontEdge { slot: right_slot, corner: of_right };
        }
        Some(())
    }

    /// Notes half-edges at, or near, the boundary nodes and ghosts of a row that has just become the lower one: the first
    /// slot of a cell begins at its lower left corner, until it is flipped.
    fn note_lower_corners(&mut self, below: &Row) {
        let first_slot = |front: &[FrontEdge], col: u32| match front.get(col as usize) {
            Some(FrontEdge { slot, .. }) if *slot != NONE => *slot - 3,
            _ => NONE,
        };
        for placed in &below.placed {
            self.leaving_boundary[placed.node as usize] = first_slot(&self.front, placed.col);
        }
        for (ghost, &col) in (below.first_ghost..).zip(&below.ghost_cols) {
            self.leaving_ghost[ghost] = first_slot(&self.front, col);
        }
    }

    /// The upper sides of the last row have nothing above them.
    fn close_front(&mut self) {
        for edge in std::mem::take(&mut self.front) {
            if edge.slot != NONE {
                self.twins[edge.slot as usize] = NONE;
            }
        }
    }
}

/// Which diagonal a cell gets.
struct Choice {
    is_ac: bool,
    /// Whether it must be looked at again when ties are settled.
    is_suspect: bool,
}

/// The diagonal of a cell that plain numbers do not decide; `None` where neither cuts it into two triangles.
#[cold]
fn choose([a, b, c, d]: [u32; 4], corners: [Point; 4], scale: f64) -> Option<Choice> {
    let [p_a, p_b, p_c, p_d] = corners.map(|p| p.map(|v| v * scale));
    let is_left = |p: Point, q: Point, r: Point| side(p, q, r) == Ordering::Greater;
    let may_be_ac = is_left(p_a, p_b, p_c) && is_left(p_c, p_d, p_a);
    let may_be_bd = is_left(p_b, p_c, p_d) && is_left(p_d, p_a, p_b);
    let is_ac = match (may_be_ac, may_be_bd) {
        (false, false) => return None,
        (true, true) if is_tie([p_c, p_a, p_b, p_d]) => a.min(c) < b.min(d),
        (true, true) => in_circle(p_a, p_b, p_c, p_d) != Ordering::Greater,
        (only_ac, _) => only_ac,
    };
    Some(Choice { is_ac, is_suspect: true })
}
