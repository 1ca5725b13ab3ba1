//! The hats of linear finite elements: 1 at a node, 0 at all others, linear on each triangle.

use crate::element::Element;
use nmt_geom::NodeId;
use nmt_geom::point::{dot, sub};
use nmt_tri::{Mesh, NodeTris};

/// Nodes that are looked at side by side.
const AT_ONCE: usize = u8::BITS as usize;

/// The hat of a node with what is around; room to be used again for the next.
#[derive(Clone, Debug, Default)]
pub(crate) struct Hat {
    elements: Vec<Element>,
    nexts: Vec<[NodeId; AT_ONCE]>, // the second node of each element, filled up with no node
}

impl Hat {
    /// Makes it that of `node`.
    #[inline(always)]
    pub fn become_of(&mut self, node: NodeId, mesh: &Mesh, node_tris: &NodeTris) {
        let at = mesh.xy()[node.index()];
        self.elements.clear();
        for &t in node_tris.around(node) {
            self.elements.push(Element::about(mesh, t, node, at));
        }
        self.find_nexts();
    }

    #[inline(always)]
    fn find_nexts(&mut self) {
        self.nexts.clear();
        for some in self.elements.chunks(AT_ONCE) {
            let mut nexts = [NodeId(u32::MAX); AT_ONCE];
            nexts.iter_mut().zip(some).for_each(|(next, element)| *next = element.nodes[1]);
            self.nexts.push(nexts);
        }
    }

    /// The elements around its node, which is the first of each.
    #[inline]
    pub fn elements(&self) -> &[Element] {
        &self.elements
    }

    /// The element whose second node this is, by number; there is one for each side that lies inside the mesh.
    #[inline(always)]
    pub fn element_from(&self, node: NodeId) -> Option<usize> {
        // Where it is found cannot be foreseen: all are looked at, a bit each, none branched on.
        let found = |nexts: &[NodeId; AT_ONCE]| {
            let mut bits = 0;
            for (k, next) in nexts.iter().enumerate() {
                bits |= u8::from(*next == node) << k;
            }
            bits
        };
        self.nexts.iter().enumerate().find_map(|(some, nexts)| match found(nexts) {
            0 => None,
            bits => Some(some * AT_ONCE + bits.trailing_zeros() as usize),
        })
    }

    /// ∫v of its v.
    pub fn volume(&self) -> f64 {
        self.elements.iter().map(|element| element.area).sum::<f64>() / 3.0
    }

    /// ∫|∇v|² of its v: squares of the opposite sides over four times the areas.
    pub fn energy(&self) -> f64 {
        let of_element = |element: &Element| {
            let [_, from, to] = element.corners;
            let opposite = sub(to, from);
            dot(opposite, opposite) / element.area
        };
        self.elements.iter().map(of_element).sum::<f64>() / 4.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nmt_cloud::{CloudParams, Section, generate};
    use nmt_curve::Outline;

    #[test]
    fn elements_follow_one_another_about_inner_nodes_and_end_at_the_boundary() {
        let section = Section { contour: Outline::circle([0.0, 0.0], 1.0), holes: Vec::new() };
        let params = CloudParams { nodes: [13, 13], irregularity: 0.49, ..CloudParams::default() };
        let mesh = Mesh::constrained(generate(&section, &params).expect("a cloud")).expect("a mesh");
        let (n_nodes, n_boundary) = (mesh.cloud().n_nodes(), mesh.cloud().n_boundary());
        let node_tris = NodeTris::new(n_nodes, mesh.tri_nodes());
        let (mut hat, mut volume) = (Hat::default(), 0.0);
        for node in (0..n_nodes).map(NodeId::of) {
            hat.become_of(node, &mesh, &node_tris);
            let last_nodes = hat.elements().iter().map(|element| element.nodes[2]);
            let n_ends = last_nodes.filter(|last| hat.element_from(*last).is_none()).count();
            assert_eq!(n_ends, usize::from(node.index() < n_boundary), "{node:?}");
            for (k, element) in hat.elements().iter().enumerate() {
                assert_eq!((element.nodes[0], hat.element_from(element.nodes[1])), (node, Some(k)));
                assert_eq!(element.corners, element.nodes.map(|node| mesh.xy()[node.index()]));
                assert!(element.area > 0.0);
            }
            assert_eq!(hat.element_from(node), None);
            let slopes = hat.elements().iter().map(|element| (element.slopes()[0], element.area));
            let energy: f64 = slopes.map(|(slope, area)| dot(slope, slope) * area).sum();
            assert!((hat.energy() - energy).abs() < 1e-12 * energy, "{node:?}"); // rounding
            volume += hat.volume();
        }
        let area: f64 = mesh.triangles().map(|t| mesh.area(t)).sum();
        assert!((volume - area).abs() < 1e-13, "hats sum to 1: {volume} {area}"); // rounding
    }

    #[test]
    fn more_elements_than_are_looked_at_at_once() {
        let next = |k: u32| NodeId(10 + k);
        let element = |k: u32| Element {
            triangle: nmt_geom::TriId(k),
            nodes: [NodeId(0), next(k), next((k + 1) % 19)],
            corners: [[0.0; 2]; 3],
            area: 1.0,
        };
        let mut hat = Hat { elements: (0..19).map(element).collect(), nexts: Vec::new() };
        hat.find_nexts();
        (0..19).for_each(|k| assert_eq!(hat.element_from(next(k)), Some(k as usize)));
        assert_eq!(hat.element_from(next(19)), None);
    }
}
