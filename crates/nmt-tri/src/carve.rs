//! Keeps the triangles of the material: flood fill bounded by the segments of the real boundary.

use crate::delaunay::{NO_TRIANGLE, Triangles};
use crate::error::MeshError;
use nmt_cloud::Cloud;

/// Drops every triangle outside the main contour or in a hole.
///
/// The material lies on the left of each segment: the triangles there are its seeds. A segment with no such triangle is
/// an error, never a gap.
pub(crate) fn carve(cloud: &Cloud, all: Triangles) -> Result<Triangles, MeshError> {
    // Each boundary node begins one segment.
    let mut leads_to = vec![u32::MAX; cloud.n_nodes()];
    cloud.boundary().segments().iter().for_each(|s| leads_to[s.from.index()] = s.to.0);
    let is_segment = |a: u32, b: u32| leads_to[a as usize] == b;

    let mut inside = vec![false; all.nodes.len()];
    let mut stack = Vec::new();
    let mut covered = vec![false; cloud.n_nodes()];
    for (t, nodes) in all.nodes.iter().enumerate() {
        for k in 0..3 {
            let (a, b) = (nodes[k], nodes[(k + 1) % 3]);
            if is_segment(a, b) {
                covered[a as usize] = true;
                if !inside[t] {
                    inside[t] = true;
                    stack.push(t);
                }
            }
        }
    }
    if let Some(bare) = cloud.boundary().segments().iter().find(|s| !covered[s.from.index()]) {
        let [from, to] = cloud.boundary().ends(bare);
        return Err(MeshError::BareSegment { nodes: [bare.from.index(), bare.to.index()], from, to });
    }
    while let Some(t) = stack.pop() {
        for k in 0..3 {
            let (a, b) = (all.nodes[t][k], all.nodes[t][(k + 1) % 3]);
            let neighbour = all.neighbours[t][k];
            if neighbour != NO_TRIANGLE && !is_segment(a, b) && !inside[neighbour as usize] {
                inside[neighbour as usize] = true;
                stack.push(neighbour as usize);
            }
        }
    }
    Ok(compact(&all, &inside))
}

/// The triangles marked `inside`, renumbered in order; a neighbour outside becomes none.
fn compact(all: &Triangles, inside: &[bool]) -> Triangles {
    let mut new_number = vec![NO_TRIANGLE; all.nodes.len()];
    let inside_ones = inside.iter().enumerate().filter(|(_, inside)| **inside);
    inside_ones.enumerate().for_each(|(number, (t, _))| new_number[t] = number as u32);
    let kept = |t: &usize| inside[*t];
    let renumber = |t: u32| if t == NO_TRIANGLE { t } else { new_number[t as usize] };
    Triangles {
        nodes: (0..inside.len()).filter(kept).map(|t| all.nodes[t]).collect(),
        neighbours: (0..inside.len()).filter(kept).map(|t| all.neighbours[t].map(renumber)).collect(),
    }
}
