//! Constrained Delaunay triangulation of a cloud that was born on a lattice: many times faster than the general way,
//! with the same triangles.
//!
//! Nodes that are each in the box of their own site are triangulated cell by cell, without a search. Boundary nodes
//! take free boxes; what is left free in the material or within a box of the boundary gets a ghost, a node of our own,
//! so that cells cover the boundary on both sides. Afterwards boundary nodes without a box are inserted, segments
//! recovered, the outside dropped and the ghosts inside taken out, all of it near the boundary alone. Whatever is
//! unusual ends in `None`: then the general way, spade's, is taken, which also words the errors.

mod boxes;
mod cell;
mod cells;
mod flips;
mod frame;
mod ghosts;
mod half_edges;
mod insert;
mod recover;
mod rows;

use crate::delaunay::power_of_two_near;
use crate::order::in_order;
use boxes::Boxes;
use frame::Frame;
use half_edges::{MOST_SLOTS, NONE, Triangulation};
use nmt_cloud::Cloud;
use nmt_geom::NodeId;

/// The triangles of the cloud, in order; `None` where the general way must be taken.
pub(crate) fn triangulate(cloud: &Cloud) -> Option<Vec<[NodeId; 3]>> {
    let frame = Frame::new(cloud)?;
    let boxes = Boxes::new(cloud, &frame)?;
    let mut triangulation = empty(cloud, boxes.n_owners_at_most(cloud))?;
    cells::sweep(&mut triangulation, cloud, &frame, &boxes)?;
    triangulation.insert_extras(cloud)?;
    triangulation.recover_segments(cloud)?;
    triangulation.drop_outside(cloud)?;
    triangulation.remove_ghosts()?;
    triangulation.settle_ties();
    finish(cloud, &triangulation.into_origins())
}

/// A triangulation without triangles, with room for those of so many owners of boxes; `None` where there would be too
/// many, or a boundary node is not on exactly one loop.
fn empty(cloud: &Cloud, n_owners: usize) -> Option<Triangulation<'_>> {
    let n_boundary = cloud.n_boundary();
    let mut leads_to = vec![NONE; n_boundary];
    let segments = cloud.boundary().segments();
    for segment in segments {
        *leads_to.get_mut(segment.from.index())? = segment.to.0;
    }
    if segments.len() != n_boundary || leads_to.contains(&NONE) {
        return None;
    }
    // A cell for each box, and two triangles for each inserted node.
    let n_slots = 6 * (n_owners + n_boundary);
    if n_slots >= MOST_SLOTS {
        return None;
    }
    Some(Triangulation {
        xy: cloud.xy(),
        ghosts: Vec::new(),
        scale: power_of_two_near(cloud.size()),
        leads_to,
        origins: Vec::with_capacity(n_slots),
        twins: Vec::with_capacity(n_slots),
        leaving_boundary: vec![NONE; n_boundary],
        leaving_ghost: Vec::new(),
        front: Vec::new(),
        unsettled: Vec::new(),
        suspects: Vec::new(),
    })
}

/// The triangles that are left, in order; `None` where they are not as many as Euler's formula says, less those with a
/// ghost.
fn finish(cloud: &Cloud, origins: &[u32]) -> Option<Vec<[NodeId; 3]>> {
    let n_nodes = cloud.n_nodes();
    // A triangle that is no more begins with the largest number.
    let is_of_nodes = |[a, b, c]: &[u32; 3]| (*a.max(b).max(c) as usize) < n_nodes;
    let triangles = in_order(n_nodes, || origins.as_chunks().0.iter().copied().filter(is_of_nodes));
    let expected = 2 * n_nodes + 2 * cloud.boundary().n_loops() - cloud.n_boundary() - 4;
    (triangles.len() == expected).then_some(triangles)
}
