//! The variational formulation with linear hats as test functions, and linear finite elements; paper, eq. (18) \[D13\].

use crate::assembly::{Frame, Setting, dirichlet_row};
use crate::error::MfdmError;
use crate::hat::Hat;
use crate::parallel::{Pool, map_chunks};
use crate::row_sum::RowSum;
use crate::system::{Equation, LinearSystem};
use crate::system_maker::SystemMaker;
use crate::vectors::widest;
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
    made: &mut SystemMaker<EquationRoom>,
) -> Result<Vec<Firmness>, MfdmError> {
    let (maker, room) = (EquationMaker { setting, weak }, || EquationRoom::of(setting));
    made.extend(unknowns, room, |room, k, system| maker.append(k, room, system))
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
    let (maker, rooms) = (EquationMaker { setting, weak }, Pool::default());
    let pieces = map_chunks(0..unknowns.len(), |piece| {
        let of_piece = |room: &mut EquationRoom| {
            unknowns[piece].iter().map(|&k| Ok((k, maker.of(k, room)?))).collect::<Result<Vec<_>, MfdmError>>()
        };
        rooms.with(|| EquationRoom::of(setting), of_piece)
    });
    Ok(pieces.into_iter().collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect())
}

/// Makes equations.
#[derive(Clone, Copy)]
pub(crate) struct EquationMaker<'a> {
    pub setting: &'a Setting<'a>,
    pub weak: &'a WeakForm<'a>,
}

/// Room to make equations in, to be used again: one a thread, since it is as large as the cloud.
pub(crate) struct EquationRoom {
    sum: RowSum,
    gathered: Gathered,
    hat: Hat,
}

impl EquationRoom {
    pub fn of(setting: &Setting) -> Self {
        let sum = RowSum::new(setting.frame.mesh.cloud().n_nodes());
        Self { sum, gathered: Gathered::default(), hat: Hat::default() }
    }
}

impl EquationMaker<'_> {
    /// The equation of unknown `k`.
    ///
    /// # Errors
    /// [`MfdmError::Datum`] where the source is not finite.
    pub fn of(&self, k: usize, room: &mut EquationRoom) -> Result<Equation, MfdmError> {
        let roles = self.setting.frame.roles;
        let node = roles.node(k);
        if let Some(of_value) = dirichlet_row(self.setting, node, &mut room.sum)? {
            return Ok(of_value);
        }
        widest(
            #[inline(always)]
            || self.sum_up(node, room),
        );
        Ok(Equation { row: room.sum.take(roles), rhs: self.rhs(&room.hat)? })
    }

    /// Appends the equation of unknown `k`; tells how firmly it holds its node.
    ///
    /// # Errors
    /// As [`Self::of`].
    fn append(&self, k: usize, room: &mut EquationRoom, system: &mut LinearSystem) -> Result<Firmness, MfdmError> {
        let roles = self.setting.frame.roles;
        let node = roles.node(k);
        if let Some(of_value) = dirichlet_row(self.setting, node, &mut room.sum)? {
            let own = of_value.row.of_unknown(k);
            system.push(&of_value);
            return Ok(Firmness { own, energy: 0.0 });
        }
        let own = widest(
            #[inline(always)]
            || {
                self.sum_up(node, room);
                let own = room.sum.of(node);
                system.add_row(roles, &mut room.sum);
                own
            },
        );
        system.end(self.rhs(&room.hat)?);
        Ok(Firmness { own, energy: room.hat.energy() })
    }

    /// Sums up the left side of the equation with a node's hat.
    #[inline(always)]
    fn sum_up(&self, node: NodeId, room: &mut EquationRoom) {
        let EquationRoom { sum, gathered, hat } = room;
        hat.become_of(node, self.setting.frame.mesh, self.setting.frame.node_tris);
        self.weak.add(TestFunction::Hat(hat), gathered, sum);
    }

    /// The right side of the equation with this hat.
    fn rhs(&self, hat: &Hat) -> Result<f64, MfdmError> {
        let Frame { mesh, source, fluxes, source_rule, .. } = self.setting.frame;
        source.with_hat(mesh, source_rule, fluxes, hat)
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
        let mut hat = Hat::default();
        hat.become_of(node, frame.mesh, frame.node_tris);
        Self { own, energy: hat.energy() }
    }
}
