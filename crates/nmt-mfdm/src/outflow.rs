//! What flows out of holes on which F = 0: sources within them, beside the warping function.
//!
//! The stresses of [`crate::warping`] have the circulation that belongs to a hole whose constant is free. Where F is 0 on the
//! hole, ∇F has another flow through its edge; a source within the hole makes up for it, without divergence in the material.

use crate::error::MfdmError;
use crate::lanes::Lanes;
use crate::problem::HoleCondition;
use crate::solution::TorsionSolution;
use crate::true_edges::visit_pieces;
use nmt_cloud::Section;
use nmt_geom::point::{dot, sub};
use nmt_geom::ring::inner_point;
use nmt_geom::{EdgeId, LoopId, Point};
use nmt_tri::Mesh;
use std::f64::consts::TAU;

/// The field strength·(r − at)/|r − at|², of which 2π·strength flows out of its hole.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Outflow {
    at: Point,
    strength: f64, // length², for Gθ = 1
}

impl Outflow {
    /// Those of the holes on which F = 0 in `solution`; `centre` is r₀ of the warping function.
    ///
    /// # Errors
    /// [`MfdmError::Curve`] where an edge has no length.
    pub fn of_holes(
        mesh: &Mesh,
        section: &Section,
        solution: &TorsionSolution,
        centre: Point,
    ) -> Result<Vec<Self>, MfdmError> {
        let is_zero = |hole: usize| solution.holes[hole].condition == HoleCondition::Zero;
        if !(0..solution.holes.len()).any(is_zero) {
            return Ok(Vec::new());
        }
        let mut ends = Vec::new(); // numbers of the edges at which the loops end
        section.loops().for_each(|outline| ends.push(ends.last().unwrap_or(&0) + outline.edges.len()));
        // Loop 0 is the contour.
        let hole_of = |edge: EdgeId| ends.partition_point(|end| *end <= edge.index()).checked_sub(1);
        let mut flows = vec![0.0; solution.holes.len()];
        visit_pieces(
            mesh,
            section,
            |edge| hole_of(edge).is_some_and(is_zero),
            |segment, piece, triangle| {
                let Some(flow) = hole_of(segment.edge).and_then(|hole| flows.get_mut(hole)) else { return Ok(()) };
                for (s, at, ds) in piece.along() {
                    let gradient = solution.field.slope(mesh, triangle, at).1.map(|slope| slope / solution.g_theta);
                    let offset = sub(at, centre);
                    // The normal points out of the material; −(r − r₀) flows already.
                    *flow -= ds * dot([gradient[0] + offset[0], gradient[1] + offset[1]], piece.normal(s));
                }
                Ok(())
            },
        )?;
        let boundary = mesh.cloud().boundary();
        let within = |hole: usize| {
            let segments = boundary.loop_segments(LoopId::of(hole + 1)).iter();
            inner_point(&segments.map(|segment| mesh.xy()[segment.from.index()]).collect::<Vec<_>>())
        };
        let outflow = |hole: usize| Some(Self { at: within(hole)?, strength: flows[hole] / TAU });
        Ok((0..flows.len()).filter(|hole| is_zero(*hole)).filter_map(outflow).collect())
    }

    /// Its field at a place.
    pub fn field(&self, p: Point) -> Point {
        let offset = sub(p, self.at);
        let factor = self.strength / dot(offset, offset);
        offset.map(|c| factor * c)
    }

    /// Its field at four places.
    pub fn field_at(&self, [x, y]: [Lanes; 2]) -> [Lanes; 2] {
        let (x, y) = (x - Lanes::all(self.at[0]), y - Lanes::all(self.at[1]));
        let factor = Lanes::all(self.strength) / (x * x + y * y);
        [x * factor, y * factor]
    }
}
