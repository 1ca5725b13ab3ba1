//! The region where a field is at least a level, by its boundary: traced exactly over the mesh, closed, without gaps.
//!
//! On each triangle the field is linear, so the level enters and leaves it at points of two edges. Points are known by the
//! edge they lie on, never by their coordinates, so segments chain into loops without tolerances: each triangle gives the
//! segment that closes its part of the region, each edge of the rim gives the piece of it where the field is high, and
//! whatever starts somewhere ends there too. Regions of ascending levels, painted over one another, fill the picture without
//! the seams that one polygon a triangle would leave, in O(√n) points a level.

use super::scene::Point;
use super::topology::Topology;

/// A stretch of a loop.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Piece {
    /// Its points, both ends included; the whole loop if there is one piece only, then its start is repeated at the end.
    pub points: Vec<Point>,
    /// Whether it is of the contour line; otherwise of the rim of the mesh.
    pub on_level: bool,
}

/// A closed loop: each piece starts where the one before ends, the last ends where the first starts.
pub(super) type Loop = Vec<Piece>;

/// A field on a mesh.
pub(super) struct Surface<'a> {
    points: &'a [Point],
    values: &'a [f64],
    topology: &'a Topology,
}

/// A stretch between two points known by number: nodes by their own, points of edges after them by the edge's.
struct Segment {
    from: usize,
    to: usize,
    on_level: bool,
}

impl<'a> Surface<'a> {
    /// Every node of the topology must have a value that can be drawn.
    pub fn new(points: &'a [Point], values: &'a [f64], topology: &'a Topology) -> Self {
        Self { points, values, topology }
    }

    /// Boundary of {value ≥ level}; of the whole mesh for a level of −∞.
    pub fn at_least(&self, level: f64) -> Vec<Loop> {
        let segments = self.segments(level);
        chain(&segments).into_iter().map(|chain| self.pieces(&chain, &segments, level)).collect()
    }

    fn is_high(&self, node: u32, level: f64) -> bool {
        self.values[node as usize] >= level
    }

    fn segments(&self, level: f64) -> Vec<Segment> {
        let on_edge = |edge: u32| self.points.len() + edge as usize;
        let mut segments = Vec::new();
        for (nodes, edges) in self.topology.triangles.iter().zip(&self.topology.triangle_edges) {
            let high = nodes.map(|node| self.is_high(node, level));
            if high[0] == high[1] && high[1] == high[2] {
                continue;
            }
            // Going around the triangle, the region is left on one edge and entered on another.
            let crossed = |leaving: bool| (0..3).find(|&k| high[k] == leaving && high[(k + 1) % 3] != leaving);
            if let (Some(left), Some(entered)) = (crossed(true), crossed(false)) {
                segments.push(Segment { from: on_edge(edges[left]), to: on_edge(edges[entered]), on_level: true });
            }
        }
        for rim in &self.topology.rim {
            let (from, to) = (rim.from as usize, rim.to as usize);
            let (from, to) = match (self.is_high(rim.from, level), self.is_high(rim.to, level)) {
                (true, true) => (from, to),
                (true, false) => (from, on_edge(rim.edge)),
                (false, true) => (on_edge(rim.edge), to),
                (false, false) => continue,
            };
            segments.push(Segment { from, to, on_level: false });
        }
        segments
    }

    fn point(&self, key: usize, level: f64) -> Point {
        let Some(edge) = key.checked_sub(self.points.len()) else { return self.points[key] };
        let [a, b] = self.topology.edges[edge].map(|node| node as usize);
        let t = ((level - self.values[a]) / (self.values[b] - self.values[a])).clamp(0.0, 1.0);
        let (p, q) = (self.points[a], self.points[b]);
        [p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])]
    }

    /// Splits a closed chain of segments where it passes between contour line and rim.
    fn pieces(&self, chain: &[usize], segments: &[Segment], level: f64) -> Loop {
        let kind = |i: usize| segments[chain[i % chain.len()]].on_level;
        let turn = (0..chain.len()).find(|&i| kind(i) != kind(i + chain.len() - 1)).unwrap_or(0);
        let mut pieces: Loop = Vec::new();
        for i in turn..turn + chain.len() {
            let segment = &segments[chain[i % chain.len()]];
            match pieces.last_mut() {
                Some(piece) if piece.on_level == segment.on_level => piece.points.push(self.point(segment.to, level)),
                _ => pieces.push(Piece {
                    points: vec![self.point(segment.from, level), self.point(segment.to, level)],
                    on_level: segment.on_level,
                }),
            }
        }
        pieces
    }
}

/// Closed chains of segment numbers. As many segments start at a point as end there, so that a walk that cannot go on is
/// back at its start.
fn chain(segments: &[Segment]) -> Vec<Vec<usize>> {
    let mut by_start: Vec<usize> = (0..segments.len()).collect();
    by_start.sort_by_key(|&i| segments[i].from);
    // Segments of one start are neighbours in `by_start`; `taken` counts, at the first of them, those already used.
    let mut taken = vec![0_usize; segments.len()];
    let mut take_from = |key: usize| {
        let first = by_start.partition_point(|&i| segments[i].from < key);
        let next = first + taken.get(first)?;
        let segment = *by_start.get(next).filter(|&&i| segments[i].from == key)?;
        taken[first] += 1;
        Some(segment)
    };
    let mut chains = Vec::new();
    for &start in &by_start {
        let home = segments[start].from;
        while let Some(first) = take_from(home) {
            let mut chain = vec![first];
            let mut at = segments[first].to;
            while at != home {
                let Some(next) = take_from(at) else { break };
                chain.push(next);
                at = segments[next].to;
            }
            chains.push(chain);
        }
    }
    chains
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lattice of `n` by `n` nodes on the unit square, its triangles, with those dropped whose nodes all fail `inside`.
    fn lattice(n: u32, inside: impl Fn(Point) -> bool) -> (Vec<Point>, Topology) {
        let step = 1.0 / f64::from(n - 1);
        let points: Vec<Point> = (0..n * n).map(|i| [f64::from(i % n) * step, f64::from(i / n) * step]).collect();
        let cells = (0..(n - 1) * (n - 1)).map(|c| c / (n - 1) * n + c % (n - 1));
        let triangles: Vec<[u32; 3]> = cells
            .flat_map(|a| [[a, a + 1, a + n + 1], [a, a + n + 1, a + n]])
            .filter(|t| t.iter().all(|&i| inside(points[i as usize])))
            .collect();
        let topology = Topology::new(&points, &triangles, |_| true);
        (points, topology)
    }

    fn area(loops: &[Loop]) -> f64 {
        let ring_area = |ring: &Loop| {
            let points: Vec<Point> = ring.iter().flat_map(|piece| &piece.points[1..]).copied().collect();
            (0..points.len())
                .map(|i| (points[i], points[(i + 1) % points.len()]))
                .map(|(p, q)| 0.5 * (p[0] * q[1] - p[1] * q[0]))
                .sum::<f64>()
        };
        loops.iter().map(ring_area).sum()
    }

    fn assert_closed(loops: &[Loop]) {
        for ring in loops {
            for (piece, next) in ring.iter().zip(ring.iter().cycle().skip(1)) {
                assert!(piece.points.len() >= 2);
                assert_eq!(piece.points.last(), next.points.first());
            }
        }
    }

    #[test]
    fn a_linear_field_cuts_the_square_exactly() {
        let (points, topology) = lattice(11, |_| true);
        let values: Vec<f64> = points.iter().map(|p| p[0] + 2.0 * p[1]).collect();
        let surface = Surface::new(&points, &values, &topology);
        for (level, exact) in [(f64::NEG_INFINITY, 1.0), (0.5, 1.0 - 0.0625), (1.5, 0.5), (2.3, 0.1225), (3.1, 0.0)] {
            let loops = surface.at_least(level);
            assert_closed(&loops);
            assert!((area(&loops) - exact).abs() < 1e-12, "level {level}"); // linear fields are exact to rounding
        }
    }

    #[test]
    fn a_level_through_nodes_closes_too() {
        let (points, topology) = lattice(9, |_| true);
        let values: Vec<f64> = points.iter().map(|p| p[0]).collect();
        let loops = Surface::new(&points, &values, &topology).at_least(0.5);
        assert_closed(&loops);
        assert!((area(&loops) - 0.5).abs() < 1e-12); // rounding
    }

    #[test]
    fn a_hill_gives_one_ring_of_contour_line_of_the_right_area() {
        let (points, topology) = lattice(201, |_| true);
        let values: Vec<f64> = points.iter().map(|p| -(p[0] - 0.5).hypot(p[1] - 0.5)).collect();
        let loops = Surface::new(&points, &values, &topology).at_least(-0.3);
        assert_eq!(loops.len(), 1);
        assert!(loops[0].len() == 1 && loops[0][0].on_level);
        assert_closed(&loops);
        let exact = std::f64::consts::PI * 0.09;
        assert!((area(&loops) - exact).abs() < 1e-4 * exact); // h² error of linear interpolation, h = 0.005
    }

    #[test]
    fn a_hole_and_a_pinched_mesh_keep_all_loops_closed() {
        let outside = |p: Point| (p[0] - 0.5).abs().max((p[1] - 0.5).abs()) > 0.19;
        let (points, topology) = lattice(21, outside);
        let values: Vec<f64> = points.iter().map(|p| (7.0 * p[0]).sin() * (9.0 * p[1]).cos()).collect();
        let surface = Surface::new(&points, &values, &topology);
        for k in -10..=10 {
            assert_closed(&surface.at_least(f64::from(k) / 10.0));
        }
        let whole = surface.at_least(f64::NEG_INFINITY);
        assert_eq!(whole.len(), 2);
        // Of the hole of 0.4 by 0.4, two corners are cut by triangles of half a cell.
        assert!((area(&whole) - (1.0 - 0.16 + 0.0025)).abs() < 1e-12); // rounding

        // Two triangles that touch in one node.
        let points = [[0.0, 0.0], [1.0, 0.0], [0.5, 0.5], [0.0, 1.0], [1.0, 1.0]];
        let topology = Topology::new(&points, &[[0, 1, 2], [2, 4, 3]], |_| true);
        let values = [0.0, 0.0, 1.0, 0.0, 0.0];
        for level in [f64::NEG_INFINITY, 0.5, 1.0] {
            assert_closed(&Surface::new(&points, &values, &topology).at_least(level));
        }
    }

    #[test]
    fn regions_of_neighbouring_levels_add_up() {
        let (points, topology) = lattice(31, |_| true);
        let values: Vec<f64> = points.iter().map(|p| (5.0 * p[0]).sin() + p[1] * p[1]).collect();
        let negated: Vec<f64> = values.iter().map(|v| -v).collect();
        for level in [-0.5, 0.1, 0.77] {
            let above = area(&Surface::new(&points, &values, &topology).at_least(level));
            let below = area(&Surface::new(&points, &negated, &topology).at_least(-level));
            assert!((above + below - 1.0).abs() < 1e-12); // no node lies on a level; rounding
        }
    }
}
