//! Cells of four occupied boxes, each cut along its Delaunay diagonal; flips follow a row behind.
//!
//! With one node per box, rows of nodes run to the right in their bands and columns upwards: every cell is a simple
//! counter-clockwise quadrilateral, with at most one reflex corner, for any displacement below half a spacing.

use super::boxes::Boxes;
use super::cell::{Cell, Limits, cut_exactly};
use super::frame::Frame;
use super::half_edges::{FrontEdge, NONE, Triangulation};
use super::rows::{Row, Rows};
use nmt_cloud::Cloud;

/// Builds the triangulation of all owners of boxes, row by row; `None` where a cell is no counter-clockwise
/// quadrilateral, or the rows cannot be filled.
pub(super) fn sweep(triangulation: &mut Triangulation, cloud: &Cloud, frame: &Frame, boxes: &Boxes) -> Option<()> {
    let [width, height] = frame.shape;
    let limits = Limits::new(frame.spacing);
    let mut rows = Rows::new(cloud, frame, boxes)?;
    let (mut below, mut above) = (Row::new(width), Row::new(width));
    triangulation.front = vec![FrontEdge::OPEN; width - 1];
    rows.fill(0, &mut triangulation.ghosts, &mut below)?;
    for row in 1..height {
        rows.fill(row, &mut triangulation.ghosts, &mut above)?;
        triangulation.leaving_ghost.resize(triangulation.ghosts.len(), NONE);
        triangulation.add_cells(&below, &above, &limits)?;
        triangulation.note_lower_corners(&below);
        // While the row is in the cache: a pass of its own at the end takes twice as long.
        triangulation.make_delaunay();
        std::mem::swap(&mut below, &mut above);
    }
    triangulation.close_front();
    rows.are_complete().then_some(())
}

impl Triangulation<'_> {
    /// Puts cells between two rows of boxes; sides that may not be Delaunay are left in `unsettled`.
    ///
    /// The slots of a cell are its bottom, right and top sides in turn from the first, so that the bottom has the first
    /// and the top the fourth, whichever way it is cut.
    fn add_cells(&mut self, below: &Row, above: &Row, limits: &Limits) -> Option<()> {
        let Self { origins, twins, front, unsettled, suspects, scale, .. } = self;
        // The right side of the cell on the left.
        let mut beside = FrontEdge::OPEN;
        let owners = below.owners.windows(2).zip(above.owners.windows(2));
        let places = below.places.windows(2).zip(above.places.windows(2));
        for (col, (beneath, (owners, places))) in front.iter_mut().zip(owners.zip(places)).enumerate() {
            let (&[a, b], &[d, c]) = owners else { continue };
            if a.max(b).max(c).max(d) == NONE {
                if beneath.slot != NONE {
                    twins[beneath.slot as usize] = NONE;
                }
                (*beneath, beside) = (FrontEdge::OPEN, FrontEdge::OPEN);
                continue;
            }
            let (&[p_a, p_b], &[p_d, p_c]) = places else { continue };
            let (nodes, corners) = ([a, b, c, d], [p_a, p_b, p_c, p_d]);
            let cell = Cell::new(corners);
            let cut = match cell.cut(nodes, limits) {
                Some(cut) => cut,
                None => cut_exactly(nodes, corners, *scale)?,
            };
            let sides = cell.sides(cut);
            let first = origins.len() as u32;
            let top_twin = Self::front_twin(col);
            let (right, left, diagonal) = if cut.is_ac {
                origins.extend_from_slice(&[a, b, c, c, d, a]);
                twins.extend_from_slice(&[beneath.slot, NONE, first + 5, top_twin, beside.slot, first + 2]);
                (first + 1, first + 4, first + 2)
            } else {
                origins.extend_from_slice(&[a, b, d, c, d, b]);
                twins.extend_from_slice(&[beneath.slot, first + 4, beside.slot, top_twin, first + 1, NONE]);
                (first + 5, first + 2, first + 1)
            };
            for (neighbour, slot, corner) in [(*beneath, first, sides.bottom), (beside, left, sides.left)] {
                if neighbour.slot != NONE {
                    twins[neighbour.slot as usize] = slot;
                }
                let is_legal = neighbour.corner.legality(corner) > limits.decided;
                if !is_legal {
                    unsettled.push(slot);
                }
            }
            if cut.is_suspect {
                suspects.push(diagonal);
            }
            *beneath = FrontEdge { slot: first + 3, corner: sides.top };
            beside = FrontEdge { slot: right, corner: sides.right };
        }
        Some(())
    }

    /// Notes half-edges at the boundary nodes and ghosts of the lower row, or near those that own no box.
    ///
    /// The first slot of a cell begins at its lower left corner, until it is flipped.
    fn note_lower_corners(&mut self, below: &Row) {
        let first_slot = |front: &[FrontEdge], col: u32| match front.get(col as usize) {
            Some(top) if top.slot != NONE => top.slot - 3,
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
        for top in std::mem::take(&mut self.front) {
            if top.slot != NONE {
                self.twins[top.slot as usize] = NONE;
            }
        }
    }
}
