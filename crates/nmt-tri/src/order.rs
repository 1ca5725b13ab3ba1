//! Triangles in the order of a mesh: each begins with its smallest node, all are sorted.

use nmt_geom::NodeId;

/// Turns and sorts the triangles that `triangles` gives, the same each time; O(nodes + triangles) where no node begins
/// many.
///
/// `None` where one has a node that is not below `n_nodes`.
pub(crate) fn in_order<I>(n_nodes: usize, triangles: impl Fn() -> I) -> Option<Vec<[NodeId; 3]>>
where
    I: Iterator<Item = [u32; 3]>,
{
    // Buckets by first node; those of a bucket are few.
    let mut ends = vec![0u32; n_nodes + 1];
    let mut n_triangles = 0;
    for [a, b, c] in triangles() {
        if a.max(b).max(c) as usize >= n_nodes {
            return None;
        }
        ends[a.min(b).min(c) as usize + 1] += 1;
        n_triangles += 1;
    }
    let mut sum = 0;
    for end in &mut ends {
        sum += *end;
        *end = sum;
    }
    let mut sorted = vec![[NodeId(0); 3]; n_triangles];
    for nodes in triangles() {
        let nodes = smallest_first(nodes);
        let end = &mut ends[nodes[0] as usize];
        sorted[*end as usize] = nodes.map(NodeId);
        *end += 1;
    }
    let mut start = 0;
    for end in ends {
        let bucket = sorted.get_mut(start..end as usize)?;
        if bucket.len() > 1 {
            bucket.sort_unstable();
        }
        start = end as usize;
    }
    Some(sorted)
}

#[inline]
fn smallest_first([a, b, c]: [u32; 3]) -> [u32; 3] {
    if a < b && a < c {
        [a, b, c]
    } else if b < c {
        [b, c, a]
    } else {
        [c, a, b]
    }
}
