//! The discrete operator of one problem, taken over by another on the same mesh that differs from it on the boundary alone.
//!
//! ∫∇φ_j·∇v_k of nodes inside is the same whatever holds on the boundary. The equations that no value on the boundary enters
//! are those of the other problem too, their mended stars and what holds loose nodes included: of N nodes all but O(√N). The
//! others, and those of boundary nodes that are unknown now, are made anew.

use crate::assembly::Frame;
use crate::error::MfdmError;
use crate::gauss::Rule;
use crate::mend::{mend, nodes_around};
use crate::patched::Patched;
use crate::solver::csr::Csr;
use crate::steady::{Hold, holds};
use crate::stencils::{StarParams, Stencils};
use crate::surroundings::Surroundings;
use crate::system::LinearSystem;
use crate::variational::{self, Firmness};
use crate::weak::WeakForm;
use nmt_cloud::Nearest;
use nmt_geom::NodeId;
use std::collections::BTreeMap;

/// The matrix of hats on blends in the interior nodes, in their order, with what it was made from.
pub(crate) struct Operator {
    /// Shape (n_interior, n_interior).
    pub matrix: Csr,
    /// Whether a value on the boundary enters the equation; shape (n_interior,).
    pub is_beside: Vec<bool>,
    /// What holds loose nodes.
    pub holds: Vec<Hold>,
    /// Nodes asked for, of stars that were mended.
    pub larger: BTreeMap<NodeId, usize>,
}

impl Operator {
    /// The equations of a problem in which nodes on the boundary are unknown, all of them by the stars of `params`.
    ///
    /// # Errors
    /// As the equations have them; [`MfdmError::PoorStar`] where a star carries no polynomial at all.
    pub fn equations(
        self,
        frame: Frame,
        around: (&Surroundings, &Nearest),
        params: StarParams,
        rule: &Rule,
    ) -> Result<LinearSystem, MfdmError> {
        let (n, n_interior) = (frame.roles.n_unknowns, self.matrix.n_rows());
        let n_boundary = n - n_interior;
        let is_anew = |k: usize| k < n_boundary || self.is_beside[k - n_boundary];
        let anew: Vec<usize> = (0..n).filter(|&k| is_anew(k)).collect();

        let mut is_met = vec![false; frame.mesh.cloud().n_nodes()];
        let nodes = nodes_around(frame, anew.iter().copied(), &mut is_met);
        let mut stencils = Stencils::of_some(around, params, nodes.clone(), |_| None);
        let xy = frame.mesh.xy();
        nodes.iter().try_for_each(|node| stencils.require(node.index()..node.index() + 1, xy, 1))?;
        let mended = nodes.iter().filter_map(|node| Some((*node, *self.larger.get(node)?)));
        stencils.replace(around.0, around.1, &mended.collect::<Vec<_>>());

        let mut system = LinearSystem::homogeneous(self.matrix.after(n_boundary), frame.roles.n_holes);
        let weak = WeakForm::blended(&stencils, frame.fluxes, rule);
        system.replace(&variational::equations(&frame.with(&stencils), &weak, &anew)?);

        mend(frame, around, rule, &mut stencils, &mut system, 0..n_boundary)?;
        // Equations taken over have what holds their nodes in them.
        let known = self.holds.iter().flat_map(|hold| hold.parts(frame.roles));
        let mut parts: Vec<_> = known.filter(|(k, _)| *k < n_boundary || self.is_beside[*k - n_boundary]).collect();
        let firmness = |k: usize| Firmness::of(system.matrix.diagonal(k), &frame, frame.roles.node(k));
        let none = BTreeMap::new();
        let rows = Patched::new(&system, &none);
        let further = holds(frame, around, params.order, &rows, firmness, 0..n_boundary);
        parts.extend(further.iter().flat_map(|hold| hold.parts(frame.roles)));
        system.mend(none, parts);
        Ok(system)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::flux::Fluxes;
    use crate::gauss::three_points;
    use crate::problem::HoleCondition;
    use crate::source::Source;
    use crate::steady::steady;
    use crate::system::{Dirichlet, NodeCondition, Roles};
    use crate::true_edges::visit_pieces;
    use nmt_cloud::{CloudParams, Section, generate};
    use nmt_curve::Outline;
    use nmt_tri::{Mesh, NodeTris};

    /// Equations with stars mended and loose nodes held, and the operator of interior ones.
    fn whole(frame: Frame, around: (&Surroundings, &Nearest), params: StarParams) -> (LinearSystem, Operator) {
        let (rule, n_nodes) = (three_points(), frame.mesh.cloud().n_nodes());
        let mut stencils = Stencils::new(around.0, around.1, params, 0..n_nodes);
        let weak = WeakForm::blended(&stencils, frame.fluxes, &rule);
        let mut system = variational::assemble(&frame.with(&stencils), &weak).expect("a system");
        let n = system.n();
        let larger = mend(frame, around, &rule, &mut stencils, &mut system, 0..n).expect("a system");
        let firmness = |k: usize| Firmness::of(system.matrix.diagonal(k), &frame, frame.roles.node(k));
        let firmness: Vec<_> = (0..n).map(firmness).collect();
        let holds = steady(frame, around, params.order, &mut system, BTreeMap::new(), &firmness);
        let (matrix, is_beside) = (system.matrix.clone(), system.is_beside.clone());
        (system, Operator { matrix, is_beside, holds, larger })
    }

    #[test]
    fn equations_taken_over_are_those_made_anew_and_balance() {
        let section = Section {
            contour: Outline::circle([0.0, 0.0], 1.0),
            holes: vec![Outline::rectangle([-0.2, -0.3], [0.3, 0.2])],
        };
        for (irregularity, differing) in [(0.2, 0.0), (0.47, 0.05)] {
            let params = CloudParams { nodes: [61, 61], irregularity, seed: 5, ..CloudParams::default() };
            let mesh = Mesh::constrained(generate(&section, &params).expect("a cloud")).expect("a mesh");
            let surroundings = Surroundings::new(mesh.cloud());
            let nearest = surroundings.nearest();
            let around = (&surroundings, &nearest);
            let node_tris = NodeTris::new(mesh.cloud().n_nodes(), mesh.tri_nodes());
            let (source, rule) = (Source::Constant(0.0), three_points());
            let stars = StarParams::nearest(2, 9);
            let mut fluxes = Fluxes::default();
            visit_pieces(
                &mesh,
                &section,
                |_| true,
                |_, piece, triangle| {
                    fluxes.slivers.extend(piece.sliver(triangle));
                    Ok(())
                },
            )
            .expect("edges have lengths");
            fluxes.slivers.sort_by_key(|sample| sample.triangle);
            let made = |conditions: Vec<NodeCondition>, fluxes: &Fluxes, from: Option<Operator>| {
                let roles = Roles::new(conditions, mesh.cloud().n_interior(), Dirichlet::Eliminated);
                let frame =
                    Frame { mesh: &mesh, node_tris: &node_tris, roles: &roles, source, fluxes, source_rule: &rule };
                match from {
                    Some(operator) => (operator.equations(frame, around, stars, &rule).expect("a system"), None),
                    None => {
                        let (system, operator) = whole(frame, around, stars);
                        (system, Some(operator))
                    }
                }
            };
            let operator = made(Roles::of_torsion(&mesh, HoleCondition::Circulation), &Fluxes::NONE, None).1;
            let is_held = operator.as_ref().is_some_and(|operator| !operator.holds.is_empty());
            assert_eq!(is_held, irregularity > 0.4, "there are loose nodes on very irregular clouds");
            let free = vec![NodeCondition::Flux; mesh.cloud().n_boundary()];
            let (anew, taken) = (made(free.clone(), &fluxes, None).0, made(free, &fluxes, operator).0);

            let n = taken.n();
            assert_eq!((n, &taken.rhs), (mesh.cloud().n_nodes(), &vec![0.0; n]));
            let differs = |k: &usize| {
                let row = |system: &LinearSystem| system.matrix.row(*k).entries().collect::<Vec<_>>();
                let (a, b) = (row(&taken), row(&anew));
                a.len() != b.len() || a.iter().zip(&b).any(|(a, b)| a.0 != b.0 || (a.1 - b.1).abs() > 1e-13)
            };
            let n_differing = (0..n).filter(differs).count();
            assert!(n_differing as f64 <= differing * n as f64, "{n_differing} of {n} at {irregularity}");
            // Fluxes balance: hats sum to 1, and so do polynomials of 1.
            let sums = [taken.matrix.apply(&vec![1.0; n]), taken.matrix.transpose().apply(&vec![1.0; n])];
            let largest = sums.iter().flatten().fold(0.0f64, |most, sum| most.max(sum.abs()));
            assert!(largest < 1e-11, "{largest}"); // rounding
        }
    }
}
