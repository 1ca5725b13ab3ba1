//! Four nodes on one circle have two Delaunay diagonals: the one that contains the smallest node number is taken, so
//! that rounding, units or the order of insertion decide nothing.

use crate::delaunay::{NO_TRIANGLE, Triangles};
use nmt_geom::Point;
use nmt_geom::point::{cross, distance_squared, dot, sub};

/// Four nodes are cocircular where the power of one with respect to the circle of the others is below this fraction of
/// the squared longest side.
///
/// Rounding of a regular grid gives 1e-15; irregular clouds of 10⁶ nodes come to 1e-7 by chance.
const COCIRCULAR_REL: f64 = 1.0e-9;

/// A new triangle must have this fraction of the squared longest side as twice its area: a tie among nodes that are
/// almost on one line is left as it is.
const FLAT_REL: f64 = 1.0e-6;

/// A triangulation whose diagonals can be flipped; each side of a triangle has a number of its own.
pub(crate) trait Flippable {
    /// Where a node is.
    fn at(&self, node: u32) -> Point;
    /// The number of triangles, and of those that are no more.
    fn n_triangles(&self) -> usize;
    /// The two triangles at a side; `None` where it must stay.
    fn pair(&self, side: u32) -> Option<Pair>;
    /// Replaces the side by the other diagonal of its pair; returns the sides around.
    fn flip(&mut self, side: u32, pair: &Pair) -> [u32; 4];
}

/// Two triangles (a, b, c) and (b, a, d) on the two sides of a b.
pub(crate) struct Pair {
    pub nodes: [u32; 4],
    pub triangles: [u32; 2],
    /// The side as the second triangle counts it.
    pub twin: u32,
}

/// Flips every tied diagonal that does not contain the smallest of its four nodes, among the `suspects` and what becomes
/// of them.
///
/// A flip replaces a diagonal by one whose smaller node number is smaller, so this ends; what remains of a polygon of
/// cocircular nodes is the fan from its smallest number, whatever it was before. Where only some of neighbouring ties are
/// near enough to be ties, the order of flips matters: rounds, each in the order of the nodes and at most one flip a
/// triangle, make it that of the triangulation, whatever the order of its triangles.
pub(crate) fn settle(triangulation: &mut impl Flippable, suspects: impl Iterator<Item = u32>) {
    let mut tied: Vec<Tied> = suspects.filter_map(|side| Tied::new(triangulation, side)).collect();
    let mut last_round = vec![0u32; if tied.is_empty() { 0 } else { triangulation.n_triangles() }];
    let mut round = 0;
    while !tied.is_empty() {
        round += 1;
        tied.sort_unstable();
        let mut around = Vec::new();
        for Tied { side, .. } in tied {
            // One that is skipped is around a flip of this round, or the other half of a side that is done.
            let Some(pair) = triangulation.pair(side) else { continue };
            if pair.triangles.iter().all(|t| last_round[*t as usize] < round) {
                around.extend(triangulation.flip(side, &pair));
                pair.triangles.iter().for_each(|t| last_round[*t as usize] = round);
            }
        }
        tied = around.into_iter().filter_map(|side| Tied::new(triangulation, side)).collect();
    }
}

/// A side to be flipped, in the order of its nodes.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
struct Tied {
    ends: [u32; 2],
    side: u32,
}

impl Tied {
    fn new(triangulation: &impl Flippable, side: u32) -> Option<Self> {
        let [a, b, c, d] = triangulation.pair(side)?.nodes;
        // One way round, so that both triangles find the same to the bit.
        let [a, b, c, d] = if a < b { [a, b, c, d] } else { [b, a, d, c] };
        let must_flip = c.min(d) < a && is_tie([a, b, c, d].map(|n| triangulation.at(n)));
        must_flip.then_some(Self { ends: [a, b], side })
    }
}

/// The triangles of the general way, with their nodes' places.
pub(crate) struct Placed<'a> {
    pub xy: &'a [Point],
    pub triangles: Triangles,
}

impl Flippable for Placed<'_> {
    fn at(&self, node: u32) -> Point {
        self.xy[node as usize]
    }

    fn n_triangles(&self) -> usize {
        self.triangles.nodes.len()
    }

    fn pair(&self, side: u32) -> Option<Pair> {
        let (t, k) = (side / 3, (side % 3) as usize);
        let u = self.triangles.neighbours[t as usize][k];
        let [a, b, c] = turned(self.triangles.nodes[t as usize], k);
        let other = self.triangles.nodes.get(u as usize)?;
        let m = (0..3).find(|&m| other[m] == b && other[(m + 1) % 3] == a)?;
        Some(Pair { nodes: [a, b, c, other[(m + 2) % 3]], triangles: [t, u], twin: 3 * u + m as u32 })
    }

    fn flip(&mut self, side: u32, pair: &Pair) -> [u32; 4] {
        let ([a, b, c, d], [t, u]) = (pair.nodes, pair.triangles);
        let Triangles { nodes, neighbours } = &mut self.triangles;
        let [_, t_bc, t_ca] = turned(neighbours[t as usize], (side % 3) as usize);
        let [_, u_ad, u_db] = turned(neighbours[u as usize], (pair.twin % 3) as usize);
        nodes[t as usize] = [c, a, d];
        neighbours[t as usize] = [t_ca, u_ad, u];
        nodes[u as usize] = [d, b, c];
        neighbours[u as usize] = [u_db, t_bc, t];
        for (outer, from, to) in [(u_ad, u, t), (t_bc, t, u)] {
            if outer != NO_TRIANGLE {
                // Two triangles can share two sides only around a node of degree two, which no mesh has.
                neighbours[outer as usize].iter_mut().filter(|s| **s == from).for_each(|s| *s = to);
            }
        }
        [3 * t, 3 * t + 1, 3 * u, 3 * u + 1]
    }
}

/// What belongs to sides k, k + 1 and k + 2 of a triangle.
fn turned(of_sides: [u32; 3], k: usize) -> [u32; 3] {
    [of_sides[k], of_sides[(k + 1) % 3], of_sides[(k + 2) % 3]]
}

/// True where the quadrilateral a d b c (diagonal a b) has its corners on one circle and may be cut the other way.
fn is_tie([a, b, c, d]: [Point; 4]) -> bool {
    let [u, v, w] = [sub(a, d), sub(b, d), sub(c, d)];
    let lift = |p: Point| dot(p, p);
    let incircle = lift(u) * cross(v, w) + lift(v) * cross(w, u) + lift(w) * cross(u, v);
    let longest = [(a, b), (b, c), (c, a), (a, d), (d, b), (c, d)]
        .iter()
        .fold(0.0f64, |l, (p, q)| l.max(distance_squared(*p, *q)));
    let twice_area = |p: Point, q: Point, r: Point| cross(sub(q, p), sub(r, p));
    let area = twice_area(a, b, c).max(twice_area(b, a, d));
    incircle.abs() <= COCIRCULAR_REL * area * longest
        && twice_area(c, a, d) > FLAT_REL * longest
        && twice_area(d, b, c) > FLAT_REL * longest
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A regular polygon of `n` nodes, cut as the fan from node `apex`.
    fn fan(n: u32, apex: u32) -> (Vec<Point>, Triangles) {
        let angle = |k: u32| std::f64::consts::TAU * f64::from(k) / f64::from(n);
        let xy = (0..n).map(|k| [angle(k).cos(), angle(k).sin()]).collect();
        let nodes: Vec<[u32; 3]> = (1..n - 1).map(|k| [apex, (apex + k) % n, (apex + k + 1) % n]).collect();
        let last = nodes.len() - 1;
        let neighbour = |exists: bool, t: usize| if exists { t as u32 } else { NO_TRIANGLE };
        let neighbours = (0..nodes.len())
            .map(|t| [neighbour(t > 0, t.wrapping_sub(1)), NO_TRIANGLE, neighbour(t < last, t + 1)])
            .collect();
        (xy, Triangles { nodes, neighbours })
    }

    fn settled(xy: &[Point], triangles: Triangles) -> Vec<[u32; 3]> {
        let n_sides = 3 * triangles.nodes.len() as u32;
        let mut placed = Placed { xy, triangles };
        settle(&mut placed, 0..n_sides);
        placed.triangles.nodes
    }

    #[test]
    fn any_cut_of_a_cocircular_polygon_becomes_the_fan_from_its_smallest_node() {
        for apex in 0..8 {
            let (xy, triangles) = fan(8, apex);
            let nodes = settled(&xy, triangles);
            assert_eq!(nodes.len(), 6);
            assert!(nodes.iter().all(|t| t.contains(&0)), "{nodes:?}");
        }
    }

    #[test]
    fn where_only_some_ties_hold_the_order_of_the_triangles_decides_nothing() {
        for apex in 1..12 {
            let (mut xy, triangles) = fan(12, apex);
            // Off the circle by about what still is a tie.
            xy.iter_mut()
                .zip([3.0, -2.0, 0.0, 5.0, 1.0, -4.0].iter().cycle())
                .for_each(|(p, off)| p[0] *= 1.0 + off * 1e-9);
            let sorted = |mut nodes: Vec<[u32; 3]>| {
                nodes.iter_mut().for_each(|t| {
                    let smallest = (0..3).min_by_key(|k| t[*k]).unwrap_or(0);
                    t.rotate_left(smallest);
                });
                nodes.sort_unstable();
                nodes
            };
            let last = triangles.nodes.len() as u32 - 1;
            let renumber = |t: u32| if t == NO_TRIANGLE { t } else { last - t };
            let backwards = Triangles {
                nodes: triangles.nodes.iter().rev().map(|n| turned(*n, 1)).collect(),
                neighbours: triangles.neighbours.iter().rev().map(|n| turned(n.map(renumber), 1)).collect(),
            };
            assert_eq!(sorted(settled(&xy, triangles)), sorted(settled(&xy, backwards)));
        }
    }

    #[test]
    fn four_nodes_off_one_circle_keep_their_diagonal() {
        let xy = vec![[1.0, 1.2], [0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
        let triangles = Triangles {
            nodes: vec![[1, 2, 3], [2, 0, 3]],
            neighbours: vec![[NO_TRIANGLE, 1, NO_TRIANGLE], [NO_TRIANGLE, NO_TRIANGLE, 0]],
        };
        assert_eq!(settled(&xy, triangles), [[1, 2, 3], [2, 0, 3]]);
    }
}
