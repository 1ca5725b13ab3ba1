//! What is known of each node's star: what a reader of the results looks at where a number is suspect.

use crate::basis::{MAX_MONOMIALS, monomials, n_monomials, row};
use crate::parallel::map_chunks;
use crate::slopes::{KnownSlopes, gradient_of_monomial};
use crate::stencils::{Kept, StarParams, Stencils};
use crate::surroundings::Surroundings;
use nmt_geom::NodeId;
use nmt_geom::point::{dot, sub};
use nmt_tri::Mesh;
use std::collections::BTreeMap;

/// The star of one node in the equations.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StarDiagnostics {
    /// Nodes in it, the centre included; 0 where the equations need no star (a Dirichlet node in the local formulation,
    /// finite elements).
    pub size: u32,
    /// Order of its polynomial.
    pub order: u32,
    /// Distance of its farthest node, in stretched coordinates, user's length unit.
    pub radius: f64,
    /// Condition number of its system.
    pub condition: f64,
    /// Hidden nodes passed over.
    pub hidden: u32,
    /// Sign of the node's own coefficient in its ∇² row: −1 is the right one.
    pub diagonal: i8,
    /// Largest error of its rows on the monomials of its order, in scaled coordinates.
    pub residual: f64,
}

/// Which stars the equations of a solution were made from: enough to find them again.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct UsedStars {
    params: Option<StarParams>, // of no finite element
    first: usize,
    larger: BTreeMap<NodeId, usize>, // nodes asked for, of stars that were enlarged for the equations' sake
    known: BTreeMap<NodeId, KnownSlopes>,
}

/// Nodes whose stencils are held at a time.
const BATCH: usize = 1 << 14;

impl UsedStars {
    /// Stars of all nodes from number `first` on, by `params`, some of them larger, some meeting what is `known`.
    pub(crate) fn new(
        params: StarParams,
        first: usize,
        larger: BTreeMap<NodeId, usize>,
        known: BTreeMap<NodeId, KnownSlopes>,
    ) -> Self {
        Self { params: Some(params), first, larger, known }
    }

    /// Nodes asked for, of stars that were enlarged for the equations' sake.
    pub(crate) fn larger(&self) -> &BTreeMap<NodeId, usize> {
        &self.larger
    }

    /// What is known of every star, shape (n_nodes,), with the `mesh` of the solution; empty for finite elements.
    ///
    /// The stars are found again, in the time that they took: a solution of 10⁶ nodes would keep 50 MB for few readers.
    pub fn diagnostics(&self, mesh: &Mesh) -> Vec<StarDiagnostics> {
        let Some(params) = self.params else { return Vec::new() };
        let surroundings = Surroundings::new(mesh.cloud());
        let nearest = surroundings.nearest();
        let n_nodes = mesh.cloud().n_nodes();
        let mut all = vec![StarDiagnostics::default(); self.first.min(n_nodes)];
        for first in (self.first..n_nodes).step_by(BATCH) {
            let range = first..(first + BATCH).min(n_nodes);
            let known = |node: NodeId| self.known.get(&node).copied();
            let around = (&surroundings, &nearest);
            let mut stencils = Stencils::meeting(around, params, Kept::Derivatives, range.clone(), known, &mut |_| {});
            let larger = self.larger.range(NodeId::of(range.start)..NodeId::of(range.end));
            stencils.replace(&surroundings, &nearest, &larger.map(|(node, size)| (*node, *size)).collect::<Vec<_>>());
            let pieces = map_chunks(range, |piece| {
                piece.map(|node| diagnose_one(&surroundings, &stencils, NodeId::of(node))).collect::<Vec<_>>()
            });
            all.extend(pieces.into_iter().flatten());
        }
        all
    }
}

fn diagnose_one(surroundings: &Surroundings, stencils: &Stencils, node: NodeId) -> StarDiagnostics {
    let (stencil, outcome) = (stencils.of(node), stencils.outcome(node));
    let slopes = stencils.known(node).slopes;
    let places = surroundings.stretched();
    let centre = places[node.index()];
    let n = n_monomials(outcome.order);
    // Derivative m of monomial k is 1 where they are the same, otherwise 0.
    let mut errors = [[0.0f64; MAX_MONOMIALS]; MAX_MONOMIALS];
    for (position, other) in stencil.nodes.iter().enumerate() {
        let offset = sub(places[other.index()], centre).map(|v| v / stencil.radius);
        let mut basis = [0.0; MAX_MONOMIALS];
        monomials(offset, outcome.order, &mut basis);
        // The rows hold for values less the known slope.
        for m in [row(1, 0), row(0, 1)] {
            basis[m] -= dot(slopes.known_part(gradient_of_monomial(m)), offset);
        }
        for m in stencil.first_row()..n {
            let coefficient = stencil.row(m)[position];
            (0..n).for_each(|k| errors[m][k] += coefficient * basis[k]);
        }
    }
    let mut residual = 0.0f64;
    for (m, row) in errors.iter().enumerate().take(n).skip(stencil.first_row()) {
        for (k, value) in row.iter().enumerate().take(n) {
            let known = slopes.known_part(gradient_of_monomial(k));
            let exact = f64::from(u8::from(m == k)) - dot(known, gradient_of_monomial(m));
            residual = residual.max((value - exact).abs());
        }
    }
    let own = stencil.nodes.iter().position(|other| *other == node);
    let diagonal = own.filter(|_| outcome.order >= 2).map_or(0.0, |k| {
        let [s_x, s_y] = stencils.metric().stretch();
        stencil.row(row(2, 0))[k] * s_x * s_x + stencil.row(row(0, 2))[k] * s_y * s_y
    });
    StarDiagnostics {
        size: stencil.nodes.len() as u32,
        order: outcome.order as u32,
        radius: stencil.radius,
        condition: outcome.condition,
        hidden: outcome.hidden as u32,
        diagonal: if diagonal == 0.0 { 0 } else { diagonal.signum() as i8 },
        residual,
    }
}
