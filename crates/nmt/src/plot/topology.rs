//! Edges and rim of a triangulation, and its edges as few long lines. Any list of triangles will do: what cannot be drawn is
//! left out, and where triangles overlap, edges have more than two.

use super::is_drawable;
use super::scene::Point;

/// An edge of the rim: on one side only there is a triangle. Goes around it as that triangle does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct RimEdge {
    pub from: u32,
    pub to: u32,
    pub edge: u32,
}

/// Triangles with their edges numbered.
#[derive(Clone, Debug)]
pub(super) struct Topology {
    /// Nodes of each triangle, all in one orientation, shape (n, 3).
    pub triangles: Vec<[u32; 3]>,
    /// Edge `k` of a triangle goes from its node `k` to the next, shape (n, 3).
    pub triangle_edges: Vec<[u32; 3]>,
    /// Smaller and larger node of each edge, in ascending order.
    pub edges: Vec<[u32; 2]>,
    /// The rim; as many of its edges start at a node as end there.
    pub rim: Vec<RimEdge>,
}

/// Twice the signed area.
fn doubled_area(points: &[Point], [a, b, c]: [u32; 3]) -> f64 {
    let [a, b, c] = [a, b, c].map(|i| points[i as usize]);
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

impl Topology {
    /// Of those triangles whose nodes are among `points`, have coordinates and pass `accepts`, and that have an area.
    pub fn new(points: &[Point], triangles: &[[u32; 3]], accepts: impl Fn(usize) -> bool) -> Self {
        let usable =
            |&i: &u32| points.get(i as usize).is_some_and(|p| p.iter().all(|&v| is_drawable(v))) && accepts(i as usize);
        let triangles: Vec<[u32; 3]> = triangles
            .iter()
            .filter(|t| t.iter().all(usable))
            .filter_map(|&t| {
                let area = doubled_area(points, t);
                if area > 0.0 { Some(t) } else { (area < 0.0).then_some([t[0], t[2], t[1]]) }
            })
            .collect();

        let sides = sides(&triangles, points.len());
        let mut topology =
            Self { triangle_edges: vec![[0; 3]; triangles.len()], triangles, edges: Vec::new(), rim: Vec::new() };
        for same_edge in sides.chunk_by(|s, t| (s.low, s.high) == (t.low, t.high)) {
            let Side { low, high, .. } = same_edge[0];
            let edge = topology.edges.len() as u32;
            topology.edges.push([low, high]);
            let mut upwards = 0_i64; // how many more triangles go from low to high than back
            for side in same_edge {
                let (number, k) = (side.number as usize / 3, side.number as usize % 3);
                topology.triangle_edges[number][k] = edge;
                upwards += if topology.triangles[number][k] == low { 1 } else { -1 };
            }
            let (from, to) = if upwards > 0 { (low, high) } else { (high, low) };
            topology.rim.extend((0..upwards.abs()).map(|_| RimEdge { from, to, edge }));
        }
        topology
    }
}

/// A side of a triangle: side `k` of triangle `t` has the number 3·t + k.
#[derive(Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord)]
struct Side {
    low: u32,
    high: u32,
    number: u32,
}

/// All sides in ascending order: those of each smaller node together by counting, and these few sorted.
fn sides(triangles: &[[u32; 3]], n_points: usize) -> Vec<Side> {
    let of_triangles = || {
        triangles.iter().enumerate().flat_map(|(t, nodes)| {
            (0..3).map(move |k| {
                let (a, b) = (nodes[k], nodes[(k + 1) % 3]);
                Side { low: a.min(b), high: a.max(b), number: (3 * t + k) as u32 }
            })
        })
    };
    let mut starts = vec![0_usize; n_points + 1];
    of_triangles().for_each(|side| starts[side.low as usize + 1] += 1);
    (0..n_points).for_each(|node| starts[node + 1] += starts[node]);
    let (mut sides, mut next) = (vec![Side::default(); 3 * triangles.len()], starts.clone());
    for side in of_triangles() {
        sides[next[side.low as usize]] = side;
        next[side.low as usize] += 1;
    }
    for bounds in starts.windows(2) {
        sides[bounds[0]..bounds[1]].sort_unstable();
    }
    sides
}

/// Cosine of the largest turn (60°) within one line of [`long_lines`]: more, and the lines would wind about like a maze,
/// which no viewer draws faster.
const LEAST_TURN_COSINE: f64 = 0.5;

/// Every edge once, in lines that go on as straight as they can; node numbers. Long lines make small files.
pub(super) fn long_lines(points: &[Point], edges: &[[u32; 2]]) -> Vec<Vec<u32>> {
    let mut starts = vec![0_usize; points.len() + 1];
    for &[a, b] in edges {
        starts[a as usize + 1] += 1;
        starts[b as usize + 1] += 1;
    }
    for k in 1..starts.len() {
        starts[k] += starts[k - 1];
    }
    let mut fill = starts.clone();
    let mut around = vec![(0_u32, 0_u32); 2 * edges.len()]; // (neighbour, edge) of each node in turn
    for (number, &[a, b]) in edges.iter().enumerate() {
        for (here, there) in [(a, b), (b, a)] {
            around[fill[here as usize]] = (there, number as u32);
            fill[here as usize] += 1;
        }
    }

    let direction = |a: u32, b: u32| {
        let (p, q) = (points[a as usize], points[b as usize]);
        let d = [q[0] - p[0], q[1] - p[1]];
        let length = d[0].hypot(d[1]);
        if length > 0.0 { d.map(|v| v / length) } else { [0.0; 2] }
    };
    let mut used = vec![false; edges.len()];
    // Goes on from the end of `line` until no unused edge leads straight enough.
    let extend = |line: &mut Vec<u32>, used: &mut [bool]| {
        while let [.., before, at] = line[..] {
            let way = direction(before, at);
            let mut best: Option<(f64, u32, u32)> = None;
            for &(next, edge) in &around[starts[at as usize]..starts[at as usize + 1]] {
                let turn = direction(at, next);
                let cosine = way[0] * turn[0] + way[1] * turn[1];
                if !used[edge as usize] && cosine > best.map_or(LEAST_TURN_COSINE, |(cosine, ..)| cosine) {
                    best = Some((cosine, next, edge));
                }
            }
            let Some((_, next, edge)) = best else { break };
            used[edge as usize] = true;
            line.push(next);
        }
    };
    let mut lines = Vec::new();
    for number in 0..edges.len() {
        if used[number] {
            continue;
        }
        used[number] = true;
        let [a, b] = edges[number];
        let mut line = vec![b, a];
        extend(&mut line, &mut used);
        line.reverse();
        extend(&mut line, &mut used);
        lines.push(line);
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: [Point; 4] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];

    #[test]
    fn two_triangles_of_either_orientation_have_five_edges_and_a_rim_of_four() {
        let topology = Topology::new(&SQUARE, &[[0, 1, 2], [0, 3, 2]], |_| true);
        assert_eq!(topology.edges, [[0, 1], [0, 2], [0, 3], [1, 2], [2, 3]]);
        let rim: Vec<(u32, u32)> = topology.rim.iter().map(|r| (r.from, r.to)).collect();
        assert_eq!(rim, [(0, 1), (3, 0), (1, 2), (2, 3)]);
    }

    #[test]
    fn what_cannot_be_drawn_is_left_out() {
        let mut points = SQUARE.to_vec();
        points.push([f64::NAN, 0.0]);
        let bad = [[0, 1, 9], [0, 1, 4], [0, 0, 1], [0, 1, 2]];
        assert_eq!(Topology::new(&points, &bad, |_| true).triangles, [[0, 1, 2]]);
        assert!(Topology::new(&points, &bad, |node| node != 2).triangles.is_empty());
    }

    #[test]
    fn long_lines_hold_every_edge_once_and_are_few() {
        let n = 20_u32;
        let points: Vec<Point> = (0..n * n).map(|i| [f64::from(i % n), f64::from(i / n)]).collect();
        let cells = (0..(n - 1) * (n - 1)).map(|c| c / (n - 1) * n + c % (n - 1));
        let triangles: Vec<[u32; 3]> = cells.flat_map(|a| [[a, a + 1, a + n + 1], [a, a + n + 1, a + n]]).collect();
        let edges = Topology::new(&points, &triangles, |_| true).edges;
        let lines = long_lines(&points, &edges);
        let mut seen: Vec<[u32; 2]> =
            lines.iter().flat_map(|l| l.windows(2)).map(|w| [w[0].min(w[1]), w[0].max(w[1])]).collect();
        seen.sort_unstable();
        assert_eq!(seen, edges);
        assert!(lines.len() <= 20 + 20 + 37, "{}", lines.len()); // rows, columns and diagonals
    }
}
