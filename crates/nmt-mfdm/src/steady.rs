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
//! The equations are not symmetric, and of some nodes or pairs the energy is negative: moving pays. Added to −E, E would
//! leave 0, a node that moves at no cost; so what is below 0 is added to E.
//!
//! Measured on an ellipse with 5000 nodes, u = sin 3x cos 2y, largest error at nodes of 24 seeds, the worst and the geometric
//! mean: irregularity 0.25, order 2 5.3e-5 and 2.3e-5, order 4 2.0e-7 and 6.5e-8; 0.4, 1.2e-4 and 5.8e-5, 2.6e-7 and 1.3e-7;
//! 0.49, 1.5e-4 and 9.5e-5, 1.4e-6 and 2.7e-7. With E alone, and with pairs sought by one of the two rows, the worst were
//! 2.5e-4 and 1.9e-6 at 0.4, 2.0e-2 at 0.49 in order 2.

use crate::assembly::Frame;
use crate::mwls::{MAX_CONDITION, Mwls};
use crate::parallel::map_chunks;
use crate::patched::Patched;
use crate::star::{StarChoice, StarFinder, default_star};
use crate::surroundings::Surroundings;
use crate::system::{Equation, LinearSystem, Role, Roles, SplitRow};
use crate::variational::Firmness;
use nmt_cloud::Nearest;
use nmt_geom::NodeId;
use std::collections::BTreeMap;
use std::ops::Range;

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
///
/// `lacking` is what its own coefficient, or the least eigenvalue of the two equations of a pair, is below 0.
#[derive(Clone, Copy, Debug)]
struct Loose {
    unknown: usize,
    /// Unknown number of the node that moves with it.
    twin: Option<usize>,
    energy: f64,
    lacking: f64,
}

/// A term ½·strength·(u_k − Q_k)² of the energy: a node that is held by what the nodes around predict.
#[derive(Clone, Debug)]
pub(crate) struct Hold {
    strength: f64,
    /// u_k − Q_k by node, ascending.
    departure: Vec<(NodeId, f64)>,
}

impl Hold {
    /// What it adds to the equations of its nodes, by the number of the unknown.
    pub fn parts(&self, roles: &Roles) -> impl Iterator<Item = (usize, SplitRow)> {
        let functional = roles.split(&self.departure);
        self.departure.iter().filter_map(move |&(node, coefficient)| match roles.of(node) {
            Role::Unknown(k) => Some((k as usize, functional.times(self.strength * coefficient))),
            Role::Hole(_) | Role::Known(_) => None,
        })
    }
}

/// Puts equations made `anew` in the place of others, and adds the predictions of nodes that are hardly held; tells them.
/// `firmness` is that of the equations then.
pub(crate) fn steady(
    frame: Frame,
    around: (&Surroundings, &Nearest),
    order: usize,
    system: &mut LinearSystem,
    anew: BTreeMap<usize, Equation>,
    firmness: &[Firmness],
) -> Vec<Hold> {
    let holds = holds(frame, around, order, &Patched::new(system, &anew), |k| firmness[k], 0..system.n());
    system.mend(anew, holds.iter().flat_map(|hold| hold.parts(frame.roles)).collect());
    holds
}

/// Predictions of the nodes that are hardly held, of the unknowns `among` and of the twins of these.
pub(crate) fn holds(
    frame: Frame,
    around: (&Surroundings, &Nearest),
    order: usize,
    rows: &Patched,
    firmness: impl Fn(usize) -> Firmness + Sync + Send,
    among: Range<usize>,
) -> Vec<Hold> {
    let mut predictor = Predictor::new(frame, around, order);
    let loose = loose_nodes(rows, firmness, among).into_iter();
    let hold = |Loose { unknown, twin, energy, lacking }: Loose| {
        let strength = energy.min(REGULAR_ENERGY) + lacking;
        Some(Hold { strength, departure: predictor.departure(unknown, twin)? })
    };
    loose.filter_map(hold).collect()
}

/// The nodes that are hardly held, ascending.
fn loose_nodes(rows: &Patched, firmness: impl Fn(usize) -> Firmness + Sync + Send, among: Range<usize>) -> Vec<Loose> {
    let pieces = map_chunks(among, |piece| {
        let mut loose: Vec<Loose> = Vec::new();
        for k in piece {
            let firm = firmness(k);
            let Firmness { own, energy: own_energy } = firm;
            if firm.is_soft() {
                loose.push(Loose { unknown: k, twin: None, energy: own_energy, lacking: (-own).max(0.0) });
            }
            // Hardly any row has one; all are looked at without a branch.
            let is_large = |j: usize, there: f64| 2.0 * there * there >= firm.own * firmness(j).own;
            if rows.n_entries(k, is_large) <= usize::from(is_large(k, firm.own)) {
                continue;
            }
            rows.each_entry(k, |j, there| {
                // The two rows may differ much, but two nodes could cancel only where the larger of the coefficients beside
                // the diagonal is large: from its row the pair is seen. A negative coefficient of its own makes a node loose
                // without a twin.
                let Firmness { own: other, energy: other_energy } = firmness(j);
                if 2.0 * there * there < own * other || own.min(other) <= 0.0 || j == k {
                    return;
                }
                let back = rows.entry(j, k);
                if 2.0 * there * back < own * other {
                    return;
                }
                let determinant = own * other - there * back;
                if determinant < LOOSE_PAIR * own_energy * other_energy {
                    let lacking = (-least_eigenvalue(own + other, determinant)).max(0.0);
                    loose.push(Loose { unknown: k, twin: Some(j), energy: own_energy, lacking });
                    loose.push(Loose { unknown: j, twin: Some(k), energy: other_energy, lacking });
                }
            });
        }
        loose
    });
    let mut loose: Vec<Loose> = pieces.into_iter().flatten().collect();
    // One prediction each; that of a pair, which leaves more out.
    loose.sort_by_key(|node| (node.unknown, node.twin.is_none(), node.twin));
    loose.dedup_by_key(|node| node.unknown);
    loose
}

/// The lesser eigenvalue of a 2 × 2 matrix whose eigenvalues are real; of others their real part.
fn least_eigenvalue(trace: f64, determinant: f64) -> f64 {
    0.5 * (trace - (trace * trace - 4.0 * determinant).max(0.0).sqrt())
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
