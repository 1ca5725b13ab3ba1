//! The variational formulation with linear hats as test functions, and linear finite elements; paper, eq. (18) \[D13\].

use crate::assembly::{Frame, Setting, dirichlet_row};
use crate::element::Element;
use crate::error::MfdmError;
use crate::parallel::{Pool, map_chunks};
use crate::system::{Equation, LinearSystem, RowSum};
use crate::system_maker::SystemMaker;
use crate::weak::{Gathered, TestFunction, WeakForm};
use nmt_geom::NodeId;
use std::ops::Range;

/// One equation an unknown: ∫∇u·∇v = ∫s·v + ∫q·v with the node's hat v.
pub(crate) fn assemble(setting: &Setting, weak: &WeakForm) -> Result<LinearSystem, MfdmError> {
    let roles = setting.frame.roles;
    let mut made = SystemMaker::new(roles);
    append(setting, weak, 0..roles.n_unknowns, &mut made)?;
    Ok(made.system())
}

/// Appends the equations of `unknowns`; tells how firmly each holds its node.
///
/// # Errors
/// As [`EquationMaker::of`].
pub(crate) fn append(
    setting: &Setting,
    weak: &WeakForm,
    unknowns: Range<usize>,
    made: &mut SystemMaker,
) -> Result<Vec<Firmness>, MfdmError> {
    let maker = || EquationMaker::new(setting, weak);
    made.extend(unknowns, maker, |maker, k, system| maker.append(k, system))
}

/// The equations of `unknowns`, each with its number.
///
/// # Errors
/// As [`EquationMaker::of`].
pub(crate) fn equations(
    setting: &Setting,
    weak: &WeakForm,
    unknowns: &[usize],
) -> Result<Vec<(usize, Equation)>, MfdmError> {
    let makers = Pool::new(|| EquationMaker::new(setting, weak));
    let pieces = map_chunks(0..unknowns.len(), |piece| {
        makers
            .with(|maker| unknowns[piece].iter().map(|&k| Ok((k, maker.of(k)?))).collect::<Result<Vec<_>, MfdmError>>())
    });
    Ok(pieces.into_iter().collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect())
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

    /// Appends the equation of unknown `k`; tells how firmly it holds its node.
    ///
    /// # Errors
    /// As [`Self::of`].
    fn append(&mut self, k: usize, system: &mut LinearSystem) -> Result<Firmness, MfdmError> {
        let roles = self.setting.frame.roles;
        let node = roles.node(k);
        if let Some(of_value) = dirichlet_row(self.setting, node, &mut self.sum)? {
            let own = of_value.row.of_unknown(k);
            system.push(&of_value);
            return Ok(Firmness { own, energy: 0.0 });
        }
        let rhs = self.sum_up(node)?;
        let own = self.sum.of(node);
        system.add_row(roles, &mut self.sum);
        system.end(rhs);
        let energy = self.around.iter().map(|element| element.hat_energy_of(node)).sum();
        Ok(Firmness { own, energy })
    }

    /// Sums up the left side of the equation with a node's hat; its right side.
    fn sum_up(&mut self, node: NodeId) -> Result<f64, MfdmError> {
        let Frame { mesh, node_tris, source, fluxes, source_rule, .. } = self.setting.frame;
        self.around.clear();
        self.around.extend(node_tris.around(node).iter().map(|&t| Element::new(mesh, t)));
        self.weak.add(TestFunction::Hat(node, &self.around), &mut self.gathered, &mut self.sum);
        source.with_hat(mesh, source_rule, fluxes, node, &self.around)
    }
}

/// How firmly an equation holds its node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Firmness {
    /// The coefficient of the node itself.
    pub own: f64,
    /// That of linear elements: ∫|∇v|² of the node's hat.
    pub energy: f64,
}

impl Firmness {
    /// Of an equation whose coefficient of its own node is `own`.
    pub fn of(own: f64, frame: &Frame, node: NodeId) -> Self {
        let elements = frame.node_tris.around(node).iter().map(|&t| Element::new(frame.mesh, t));
        Self { own, energy: elements.map(|element| element.hat_energy_of(node)).sum() }
    }
}
