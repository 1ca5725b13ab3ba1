//! Triangles in the order of a mesh: each begins with its smallest node, all are sorted.

use nmt_geom::NodeId;

/// Turns and sorts the triangles that `triangles` gives, the same each time; O(nodes + triangles) where no node begins
/// many. Their nodes are below `n_nodes`.
pub(crate) fn in_order<I>(n_nodes: usize, triangles: impl Fn() -> I) -> Vec<[NodeId; 3]>
where
    I: Iterator<Item = [u32; 3]>,
{
    // Buckets by first node, one after the other: first their sizes, then where each begins.
    let mut next = vec![0u32; n_nodes + 1];
    let mut n_triangles = 0;
    for [a, b, c] in triangles() {
        next[a.min(b).min(c) as usize] += 1;
        n_triangles += 1;
    }
    let mut start = 0;
    for size in &mut next {
        start += std::mem::replace(size, start);
    }
    let mut sorted = vec![[NodeId(0); 3]; n_triangles];
    for nodes in triangles() {
        let nodes = smallest_first(nodes);
        let next = &mut next[nodes[0] as usize];
        sorted[*next as usize] = nodes.map(NodeId);
        *next += 1;
    }
    // Each bucket now ends where the next one begins.
    let mut start = 0;
    for end in next {
        sort_bucket(&mut sorted[start..end as usize]);
        start = end as usize;
    }
    sorted
}

/// Most buckets hold two or three triangles.
#[inline]
fn sort_bucket(bucket: &mut [[NodeId; 3]]) {
    match bucket {
        [] | [_] => {}
        [a, b] => {
            if a > b {
                std::mem::swap(a, b);
            }
        }
        _ => bucket.sort_unstable(),
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_begin_with_their_smallest_node_and_are_sorted() {
        let given = [[5, 0, 4], [3, 1, 2], [4, 2, 0], [1, 0, 5], [2, 1, 0]];
        let expected = [[0, 2, 1], [0, 4, 2], [0, 4, 5], [0, 5, 1], [1, 2, 3]];
        assert_eq!(in_order(6, || given.into_iter()), expected.map(|nodes| nodes.map(NodeId)));
    }
}
