//! Polynomials that overshoot, flattened where the stress function and the warping function then agree better.
//!
//! At a hole or fillet much smaller than the spacing stars are as small as that, but triangles reach a whole spacing out: an
//! error of what is quadratic in a node's polynomial grows by the square of the ratio on the way. Any continuous v and w give
//! bounds of J ([`crate::estimate`]), so that where ∫|∇v − σ|² is largest the polynomial of a node may become its plane, the
//! mean plane of the triangles around, or its value alone.

use crate::blend::NodalPolynomials;
use nmt_geom::{NodeId, TriId};
use nmt_tri::{Mesh, NodeTris};
use std::collections::BTreeSet;

/// Triangles with more than this part of the whole are looked at.
const SHARE: f64 = 0.02;

/// Times that they are: what is large is small when what was larger is mended.
const ROUNDS: usize = 4;

/// A polynomial is taken for another that leaves at most this part of ∫|∇v − σ|² about its node.
const GAIN: f64 = 0.9;

/// Whether some triangles have much of the whole.
pub(crate) fn has_large(squares: &[f64]) -> bool {
    large(squares).next().is_some()
}

/// Flattens polynomials of v and w, `fields`, where that makes `square` smaller: ∫|∇v − σ|² over a triangle, `squares` those
/// of all triangles at first. Tells in which triangles they change, ascending.
pub(crate) fn flatten(
    mesh: &Mesh,
    fields: &mut [NodalPolynomials; 2],
    squares: &[f64],
    square: impl Fn(&[NodalPolynomials; 2], TriId) -> f64,
) -> Vec<TriId> {
    let node_tris = NodeTris::new(mesh.cloud().n_nodes(), mesh.tri_nodes());
    let (mut squares, mut changed) = (squares.to_vec(), BTreeSet::new());
    for _ in 0..ROUNDS {
        let mut nodes: Vec<NodeId> = large(&squares).flat_map(|t| mesh.tri_nodes()[t.index()]).collect();
        nodes.sort_unstable();
        nodes.dedup();
        let mut has_changed = false;
        for node in nodes {
            let around = node_tris.around(node);
            if flatten_at(mesh, fields, node, around, &square) {
                has_changed = true;
                changed.extend(around);
                around.iter().for_each(|&t| squares[t.index()] = square(fields, t));
            }
        }
        if !has_changed {
            break;
        }
    }
    changed.into_iter().collect()
}

/// Flattens the polynomials of one node, with the triangles `around` it; tells whether that gains anything.
fn flatten_at(
    mesh: &Mesh,
    fields: &mut [NodalPolynomials; 2],
    node: NodeId,
    around: &[TriId],
    square: &impl Fn(&[NodalPolynomials; 2], TriId) -> f64,
) -> bool {
    let about = |fields: &[NodalPolynomials; 2]| around.iter().map(|&t| square(fields, t)).sum::<f64>();
    let (mut least, mut has_changed) = (about(fields), false);
    for which in 0..fields.len() {
        for flat in fields[which].flatter(mesh, node, around) {
            let before = fields[which].replace(node, &flat);
            let sum = about(fields);
            if sum < GAIN * least {
                (least, has_changed) = (sum, true);
            } else {
                fields[which].replace(node, &before);
            }
        }
    }
    has_changed
}

/// Triangles with much of the whole.
fn large(squares: &[f64]) -> impl Iterator<Item = TriId> {
    let least = SHARE * squares.iter().sum::<f64>();
    let all = squares.iter().enumerate();
    all.filter(move |(_, square)| **square > least).map(|(t, _)| TriId::of(t))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::blend::tests::fields_of_all_orders;
    use crate::gauss::six_points;
    use crate::lanes::Lanes;
    use crate::quadrature::RuleLanes;

    #[test]
    fn what_overshoots_is_flattened_and_all_else_left() -> Result<(), Box<dyn std::error::Error>> {
        let (mesh, fields) = fields_of_all_orders()?;
        let rule = RuleLanes::from(&six_points());
        // Of the difference of both gradients.
        let square = |[v, w]: &[NodalPolynomials; 2], t: TriId| {
            let mut sum = Lanes::default();
            let fours = v.slopes_at(&mesh, t, &rule).into_iter().zip(w.slopes_at(&mesh, t, &rule));
            for ((v, w), weight) in fours.zip(rule.weights) {
                let [x, y] = [0, 1].map(|d| v.gradient[d] - w.gradient[d]);
                sum += weight * (x * x + y * y);
            }
            mesh.area(t) * sum.sum()
        };
        let squares = |fields: &[NodalPolynomials; 2]| mesh.triangles().map(|t| square(fields, t)).collect::<Vec<_>>();
        for field in fields.into_iter().filter(|field| field.blended_order() >= 2) {
            let mut pair = [field.clone(), field.clone()];
            assert!(!has_large(&squares(&pair)), "no difference at all");
            let node = NodeId::of(mesh.cloud().n_nodes() - 1);
            let mut wild = field.coefficients(node).to_vec();
            wild.iter_mut().skip(3).for_each(|coefficient| *coefficient = 1.0e3);
            pair[1].replace(node, &wild);
            let before = squares(&pair);
            assert!(has_large(&before));
            flatten(&mesh, &mut pair, &before, square);
            let sums = [before, squares(&pair)].map(|squares| squares.iter().sum::<f64>());
            assert!(sums[1] < 1.0e-3 * sums[0], "order {}: {sums:?}", field.order());
            for other in (0..mesh.cloud().n_nodes() - 1).map(NodeId::of) {
                assert_eq!(pair[0].coefficients(other), field.coefficients(other), "{other:?}");
            }
        }
        Ok(())
    }
}
