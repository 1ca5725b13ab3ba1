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
    LinearSystem::of_pieces(setting.frame.roles, |piece| {
        let (mut maker, mut equation) = (EquationMaker::new(setting, weak), Equation::default());
        let mut system = LinearSystem::new(setting.frame.roles.n_unknowns, setting.frame.roles.n_holes);
        for k in piece {
            maker.make(k, &mut equation)?;
            system.push(&equation);
        }
        Ok(system)
    })
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
        let mut equation = Equation::default();
        self.make(k, &mut equation)?;
        Ok(equation)
    }

    /// As [`Self::of`], in the place of what is in `equation`.
    fn make(&mut self, k: usize, equation: &mut Equation) -> Result<(), MfdmError> {
        let Frame { mesh, roles, node_tris, source, fluxes, source_rule } = self.setting.frame;
        let node = roles.node(k);
        if let Some(of_value) = dirichlet_row(self.setting, node, &mut self.sum)? {
            *equation = of_value;
            return Ok(());
        }
        self.around.clear();
        self.around.extend(node_tris.around(node).iter().map(|&t| Element::new(mesh, t)));
        let slopes = self.around.iter().map(|element| (element, element.hat_slope(node)));
        self.weak.add(slopes, &mut self.gathered, &mut self.sum);
        self.sum.take_to(roles, &mut equation.row);
        equation.rhs = source.with_hat(mesh, source_rule, fluxes, node, &self.around)?;
        Ok(())
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
