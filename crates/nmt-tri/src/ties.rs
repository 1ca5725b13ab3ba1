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

/// Flips every tied diagonal that does not contain the smallest of its four nodes.
///
/// A flip replaces a diagonal by one whose smaller node number is smaller, so this ends; what remains of a polygon of
/// cocircular nodes is the fan from its smallest number, whatever it was before.
pub(crate) fn settle(xy: &[Point], triangles: &mut Triangles) {
    let mut stack: Vec<u32> = (0..triangles.nodes.len() as u32).rev().collect();
    while let Some(t) = stack.pop() {
        for k in 0..3 {
            if let Some(other) = flip_if_tied(xy, triangles, t as usize, k) {
                stack.extend([other, t]);
                break;
            }
        }
    }
}

/// Flips side `k` of triangle `t` if it must; returns the neighbour it was flipped with.
fn flip_if_tied(xy: &[Point], triangles: &mut Triangles, t: usize, k: usize) -> Option<u32> {
    let neighbour = triangles.neighbours[t][k];
    if neighbour == NO_TRIANGLE {
        return None;
    }
    let u = neighbour as usize;
    // t = (a, b, c) with the shared side a → b; u has it as b → a and d opposite.
    let turned = |n: [u32; 3], k: usize| [n[k], n[(k + 1) % 3], n[(k + 2) % 3]];
    let [a, b, c] = turned(triangles.nodes[t], k);
    let m = (0..3).find(|&m| triangles.nodes[u][m] == b && triangles.nodes[u][(m + 1) % 3] == a)?;
    let d = triangles.nodes[u][(m + 2) % 3];
    if !must_flip([a, b, c, d], |n| xy[n as usize]) {
        return None;
    }
    // New: t = (c, a, d), u = (d, b, c).
    let [_, t_bc, t_ca] = turned(triangles.neighbours[t], k);
    let [_, u_ad, u_db] = turned(triangles.neighbours[u], m);
    triangles.nodes[t] = [c, a, d];
    triangles.neighbours[t] = [t_ca, u_ad, u as u32];
    triangles.nodes[u] = [d, b, c];
    triangles.neighbours[u] = [u_db, t_bc, t as u32];
    for (outer, from, to) in [(u_ad, u, t), (t_bc, t, u)] {
        if outer != NO_TRIANGLE {
            let sides = &mut triangles.neighbours[outer as usize];
            // Two triangles can share two sides only around a node of degree two, which no mesh has.
            sides.iter_mut().filter(|s| **s == from as u32).for_each(|s| *s = to as u32);
        }
    }
    Some(neighbour)
}

/// True where the diagonal a b of the triangles (a, b, c) and (b, a, d) is tied and c d contains the smallest number.
#[inline]
pub(crate) fn must_flip([a, b, c, d]: [u32; 4], at: impl Fn(u32) -> Point) -> bool {
    c.min(d) < a.min(b) && is_tie([a, b, c, d].map(at))
}

/// True where the quadrilateral a d b c (diagonal a b) has its corners on one circle and may be cut the other way.
pub(crate) fn is_tie([a, b, c, d]: [Point; 4]) -> bool {
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

    #[test]
    fn any_cut_of_a_cocircular_polygon_becomes_the_fan_from_its_smallest_node() {
        for apex in 0..8 {
            let (xy, mut triangles) = fan(8, apex);
            settle(&xy, &mut triangles);
            assert_eq!(triangles.nodes.len(), 6);
            assert!(triangles.nodes.iter().all(|t| t.contains(&0)), "{:?}", triangles.nodes);
        }
    }

    #[test]
    fn four_nodes_off_one_circle_keep_their_diagonal() {
        let xy = vec![[1.0, 1.2], [0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
        let mut triangles = Triangles {
            nodes: vec![[1, 2, 3], [2, 0, 3]],
            neighbours: vec![[NO_TRIANGLE, 1, NO_TRIANGLE], [NO_TRIANGLE, NO_TRIANGLE, 0]],
        };
        settle(&xy, &mut triangles);
        assert_eq!(triangles.nodes, [[1, 2, 3], [2, 0, 3]]);
    }
}
