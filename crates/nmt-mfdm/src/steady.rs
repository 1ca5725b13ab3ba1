//! Nodes that the variational equations hardly hold, held by what the nodes around predict.
//!
//! Larger stars do not mend every soft node (see [`crate::mend`]): on clouds of irregularity 0.4 and more one in some
//! hundreds keeps less than half of the linear elements' coefficient, and two nodes much nearer to each other than to all
//! others can move together at no cost though each by itself is held. For such a node ½E·(u_k − Q_k)² is added to the
//! energy whose minimum the equations are: E is that of its hat, Q_k the value at it of the polynomial of the equations'
//! order through the nodes around, without it and its twin. Polynomials of the order make that term 0, any other solution
//! as small as the equations' own error; and what it adds to the equations of a node and of those around has the sum 0,
//! so that the balance of fluxes holds.
//!
//! Measured on an ellipse with 5000 nodes, largest error at nodes of 24 seeds, without and with it: irregularity 0.4, order 2
//! 4.7e-2 → 1.2e-3, order 4 6.0e-4 → 4.4e-6; irregularity 0.49, order 4 2.8e-3 → 6.7e-6, order 2 2.1e-1 → 5.5e-2 in the
//! worst seed, 2.7e-3 → 6.7e-4 in the mean.

use crate::assembly::Frame;
use crate::mend::SOFT;
use crate::mwls::{MAX_CONDITION, Mwls};
use crate::star::{StarChoice, StarFinder, default_star};
use crate::surroundings::Surroundings;
use crate::system::{LinearSystem, Role};
use crate::variational::hat_energy;
use nmt_cloud::Nearest;
use nmt_geom::NodeId;

/// Least determinant of the equations of two nodes, over that of their hats' energies; linear elements have 3/4 and more.
const LOOSE_PAIR: f64 = 0.25;

/// ∫|∇v|² of a hat of a square lattice: what a node is held by there. Hats of two nodes close together have many times as
/// much, and so would the error that a prediction brings into the balance of fluxes.
const REGULAR_ENERGY: f64 = 4.0;

/// Nodes of a prediction, in halves of the usual star.
const HALVES: [usize; 3] = [3, 4, 6];

/// g of its weights: nearly even, so that no single neighbour decides.
const EVEN: f64 = 0.5;

/// A node that is hardly held.
#[derive(Clone, Copy, Debug)]
struct Loose {
    unknown: usize,
    /// Unknown number of the node that moves with it.
    twin: Option<usize>,
    energy: f64,
}

/// Adds the predictions of nodes that are hardly held.
pub(crate) fn steady(frame: Frame, around: (&Surroundings, &Nearest), order: usize, system: &mut LinearSystem) {
    let loose = loose_nodes(frame, system);
    if loose.is_empty() {
        return;
    }
    let mut predictor = Predictor::new(frame, around, order);
    let mut parts = Vec::new();
    for Loose { unknown, twin, energy } in loose {
        let strength = energy.min(REGULAR_ENERGY);
        let Some(departure) = predictor.departure(unknown, twin) else { continue };
        let functional = frame.roles.split(&departure);
        for (node, coefficient) in departure {
            if let Role::Unknown(k) = frame.roles.of(node) {
                parts.push((k as usize, functional.times(strength * coefficient)));
            }
        }
    }
    system.join(parts);
}

/// The nodes that are hardly held, ascending.
fn loose_nodes(frame: Frame, system: &LinearSystem) -> Vec<Loose> {
    let energy = |k: usize| hat_energy(frame.mesh, frame.node_tris, frame.roles.node(k));
    let matrix = &system.matrix;
    let mut loose: Vec<Loose> = Vec::new();
    for k in 0..system.n() {
        let (own, own_energy) = (matrix.diagonal(k), energy(k));
        if own < SOFT * own_energy {
            loose.push(Loose { unknown: k, twin: None, energy: own_energy });
        }
        for (j, there) in matrix.row(k).entries() {
            // Only of the first of two nodes, and only where they could cancel at all.
            if j <= k || 2.0 * there.abs() < own.abs() {
                continue;
            }
            let other_energy = energy(j);
            let determinant = own * matrix.diagonal(j) - there * matrix.entry(j, k as u32);
            if determinant.abs() < LOOSE_PAIR * own_energy * other_energy {
                loose.push(Loose { unknown: k, twin: Some(j), energy: own_energy });
                loose.push(Loose { unknown: j, twin: Some(k), energy: other_energy });
            }
        }
    }
    // One prediction each; that of a pair, which leaves more out.
    loose.sort_by_key(|node| (node.unknown, node.twin.is_none(), node.twin));
    loose.dedup_by_key(|node| node.unknown);
    loose
}

/// Predicts values of nodes from those around.
struct Predictor<'a> {
    frame: Frame<'a>,
    surroundings: &'a Surroundings<'a>,
    order: usize,
    finder: StarFinder<'a>,
    mwls: Mwls,
    star: Vec<NodeId>,
    rows: Vec<f64>,
}

impl<'a> Predictor<'a> {
    fn new(frame: Frame<'a>, around: (&'a Surroundings<'a>, &'a Nearest<'a>), order: usize) -> Self {
        Self {
            frame,
            surroundings: around.0,
            order,
            finder: StarFinder::new(around.0, around.1, StarChoice::Nearest),
            mwls: Mwls::default(),
            star: Vec::new(),
            rows: Vec::new(),
        }
    }

    /// u_k − Q_k by node, ascending; `None` where the nodes around carry no polynomial of the order.
    fn departure(&mut self, unknown: usize, twin: Option<usize>) -> Option<Vec<(NodeId, f64)>> {
        let roles = self.frame.roles;
        let (node, twin) = (roles.node(unknown), twin.map(|k| roles.node(k)));
        let places = self.surroundings.stretched();
        let usual = self.surroundings.metric().star_size(default_star(self.order));
        let carries = HALVES.into_iter().any(|halves| {
            self.finder.find(node, usual * halves / 2 + 2, &mut self.star);
            self.star.retain(|other| *other != node && Some(*other) != twin);
            let points = self.star.iter().map(|other| places[other.index()]);
            self.mwls.factorise(points, places[node.index()], None, self.order, EVEN) <= MAX_CONDITION
        });
        if !carries {
            return None;
        }
        self.rows.clear();
        self.mwls.rows(&mut self.rows);
        // The first row is that of the value.
        let mut departure: Vec<_> = self.star.iter().zip(&self.rows).map(|(other, c)| (*other, -c)).collect();
        departure.insert(departure.partition_point(|(other, _)| *other < node), (node, 1.0));
        Some(departure)
    }
}
