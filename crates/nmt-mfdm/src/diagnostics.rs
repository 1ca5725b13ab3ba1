//! What is known of each node's star: what a reader of the results looks at where a number is suspect.

use crate::basis::{MAX_MONOMIALS, monomials, n_monomials, row};
use crate::parallel::map_chunks;
use crate::slopes::gradient_of_monomial;
use crate::stencils::Stencils;
use crate::surroundings::Surroundings;
use nmt_geom::NodeId;
use nmt_geom::point::{dot, sub};

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

/// The stars of all nodes, shape (n_nodes,); empty for finite elements.
pub(crate) fn diagnose(surroundings: &Surroundings, stencils: &Stencils) -> Vec<StarDiagnostics> {
    if stencils.order() == 0 {
        return Vec::new();
    }
    let range = stencils.range();
    let mut all = vec![StarDiagnostics::default(); range.start];
    let pieces = map_chunks(range, |piece| {
        piece.map(|node| diagnose_one(surroundings, stencils, NodeId::of(node))).collect::<Vec<_>>()
    });
    all.extend(pieces.into_iter().flatten());
    all
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
