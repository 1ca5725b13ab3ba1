//! The variational formulation with linear hats as test functions, and linear finite elements; paper, eq. (18) \[D13\].

use crate::assembly::{Frame, Setting, dirichlet_row};
use crate::element::Element;
use crate::error::MfdmError;
use crate::system::{Equation, LinearSystem, RowSum};
use crate::weak::{Gathered, WeakForm};
use nmt_geom::point::{cross, dot, sub};
use nmt_geom::{NodeId, TriId};
use nmt_tri::{Mesh, NodeTris};

/// One equation an unknown: ∫∇u·∇v = ∫s·v + ∫q·v with the node's hat v.
pub(crate) fn assemble(setting: &Setting, weak: &WeakForm) -> Result<LinearSystem, MfdmError> {
    let maker = || EquationMaker::new(setting, weak);
    LinearSystem::of_unknowns(setting.frame.roles, maker, |maker, k, system| maker.append(k, system))
}

/// Makes equations; one a thread, with room to be used again.
pub(crate) struct EquationMaker<'a> {
    setting: &'a Setting<'a>,
    weak: &'a WeakForm<'a>,
    sum: RowSum,
    gathered: Gathered,
    around: Vec<Element>, // the node under way
}

impl<'a> EquationMaker<'a> {
    pub fn new(setting: &'a Setting<'a>, weak: &'a WeakForm<'a>) -> Self {
        let sum = RowSum::new(setting.frame.mesh.cloud().n_nodes());
        Self { setting, weak, sum, gathered: Gathered::default(), around: Vec::new() }
    }

    /// The equation of unknown `k`.
    ///
    /// # Errors
    /// [`MfdmError::Datum`] where the source is not finite.
    pub fn of(&mut self, k: usize) -> Result<Equation, MfdmError> {
        let node = self.setting.frame.roles.node(k);
        if let Some(of_value) = dirichlet_row(self.setting, node, &mut self.sum)? {
            return Ok(of_value);
        }
        let rhs = self.sum_up(node)?;
        Ok(Equation { row: self.sum.take(self.setting.frame.roles), rhs })
    }

    /// Appends the equation of unknown `k`.
    ///
    /// # Errors
    /// As [`Self::of`].
    fn append(&mut self, k: usize, system: &mut LinearSystem) -> Result<(), MfdmError> {
        let roles = self.setting.frame.roles;
        let node = roles.node(k);
        if let Some(of_value) = dirichlet_row(self.setting, node, &mut self.sum)? {
            system.push(&of_value);
            return Ok(());
        }
        let rhs = self.sum_up(node)?;
        self.sum.drain(|node, coefficient| system.add(roles.of(node), coefficient));
        system.end(rhs);
        Ok(())
    }

    /// Sums up the left side of the equation with a node's hat; its right side.
    fn sum_up(&mut self, node: NodeId) -> Result<f64, MfdmError> {
        let Frame { mesh, node_tris, source, fluxes, source_rule, .. } = self.setting.frame;
        self.around.clear();
        self.around.extend(node_tris.around(node).iter().map(|&t| Element::new(mesh, t)));
        let slopes = self.around.iter().map(|element| (element, element.hat_slope(node)));
        self.weak.add(slopes, &mut self.gathered, &mut self.sum);
        source.with_hat(mesh, source_rule, fluxes, node, &self.around)
    }
}

/// ∫|∇v|² of a node's hat: over a triangle the square of the opposite side over four times the area.
pub(crate) fn hat_energy(mesh: &Mesh, node_tris: &NodeTris, node: NodeId) -> f64 {
    let at = mesh.xy()[node.index()];
    let of_triangle = |t: &TriId| {
        let [a, b, c] = mesh.tri_nodes()[t.index()];
        // Counter-clockwise after the node.
        let others = if a == node {
            [b, c]
        } else if b == node {
            [c, a]
        } else {
            [a, b]
        };
        let [s, t] = others.map(|other| sub(mesh.xy()[other.index()], at));
        let opposite = sub(t, s);
        dot(opposite, opposite) / (2.0 * cross(s, t))
    };
    node_tris.around(node).iter().map(of_triangle).sum()
}
