//! Constrained Delaunay triangulation of a cloud that was born on a lattice, many times faster than the general way, with
//! the same triangles.
//!
//! Nodes that are each in the box of their own site are triangulated cell by cell, without a search. Boundary nodes take
//! free boxes; what is left free in the material or within a box of the boundary gets a ghost, a node of our own, so
//! that cells cover the boundary on both sides. Afterwards boundary nodes without a box are inserted, segments recovered,
//! the outside dropped and the ghosts inside taken out, all of it near the boundary alone. Whatever is unusual ends in
//! `None`: then the general way, spade's, is taken, which also words the errors.

mod boxes;
mod cells;
mod flips;
mod frame;
mod ghosts;
mod half_edges;
mod insert;
mod recover;

use crate::delaunay::power_of_two_near;
use crate::order::in_order;
use boxes::Boxes;
use frame::Frame;
use half_edges::{NONE, Triangulation};
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
    let origins = triangulation.origins;
    finish(cloud, &origins)
}

/// A triangulation without triangles, with room for those of so many owners of boxes; `None` where the boundary's nodes are
/// not each on one loop.
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

/// The triangles that are left, in order; `None` where they are not as many as Euler's formula says, or one has a ghost.
fn finish(cloud: &Cloud, origins: &[u32]) -> Option<Vec<[NodeId; 3]>> {
    let alive = || origins.as_chunks::<3>().0.iter().copied().filter(|nodes| nodes[0] != NONE);
    let holes = cloud.boundary().n_loops() - 1;
    let expected = 2 * cloud.n_nodes() + 2 * holes - cloud.n_boundary() - 2;
    let triangles = in_order(cloud.n_nodes(), alive)?;
    (triangles.len() == expected).then_some(triangles)
}
