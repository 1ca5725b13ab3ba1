//! What every assembly takes, and the rows that are the same in all of them.

use crate::error::MfdmError;
use crate::flux::Fluxes;
use crate::gauss::Rule;
use crate::row_sum::RowSum;
use crate::source::Source;
use crate::stencils::Stencils;
use crate::system::{Equation, NodeCondition, Roles};
use nmt_geom::NodeId;
use nmt_tri::{Mesh, NodeTris};

/// A boundary value problem on a mesh.
#[derive(Clone, Copy)]
pub(crate) struct Frame<'a> {
    pub mesh: &'a Mesh,
    pub node_tris: &'a NodeTris,
    pub roles: &'a Roles,
    pub source: Source<'a>,
    pub fluxes: &'a Fluxes,
    /// Integrates the source, where it is not constant.
    pub source_rule: &'a Rule,
}

/// A problem with its stencils, ready to be made equations.
#[derive(Clone, Copy)]
pub(crate) struct Setting<'a> {
    pub frame: Frame<'a>,
    pub stencils: &'a Stencils,
}

impl<'a> Frame<'a> {
    pub fn with(self, stencils: &'a Stencils) -> Setting<'a> {
        Setting { frame: self, stencils }
    }
}

/// Σφ_j(x_b)·u_j = value at a node whose value is given, where polynomials smooth (g > 0); `None` at all others.
pub(crate) fn dirichlet_row(setting: &Setting, node: NodeId, sum: &mut RowSum) -> Result<Option<Equation>, MfdmError> {
    let (hole, rhs) = match setting.frame.roles.condition(node) {
        Some(NodeCondition::Value(value)) => (None, value),
        Some(NodeCondition::Hole(hole)) => (Some(hole), 0.0),
        Some(NodeCondition::Flux) | None => return Ok(None),
    };
    let stencil = setting.stencils.of(node);
    for (&other, &coefficient) in stencil.nodes.iter().zip(stencil.row(0)) {
        sum.add(other, coefficient);
    }
    let mut row = sum.take(setting.frame.roles);
    // Σφ_j·u_j − c_k = 0.
    row.holes.extend(hole.map(|hole| (hole, -1.0)));
    Ok(Some(Equation { row, rhs }))
}
