//! Stencils: stars with their coefficient rows, for many nodes; and the diagnostics of all stars.

use crate::basis::n_monomials;
use crate::error::MfdmError;
use crate::mwls::Mwls;
use crate::parallel::map_chunks;
use crate::repair::{StarOutcome, sound_star};
use crate::star::StarFinder;
use crate::surroundings::{Metric, Surroundings};
use nmt_cloud::Nearest;
use nmt_geom::{NodeId, Point};
use std::ops::Range;

/// Order and size of stars.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StarParams {
    /// Order p of the MWLS polynomial.
    pub order: usize,
    /// Nodes in a star, the centre included.
    pub size: usize,
}

/// What became of the stars of a cloud.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StarReport {
    /// Nodes in a star as asked for.
    pub size: usize,
    /// Hidden nodes passed over, in all stars together.
    pub hidden_nodes_skipped: usize,
    /// Stars that had to be enlarged.
    pub enlarged: usize,
    /// Stars whose polynomial is of a lower order.
    pub order_lowered: usize,
    /// Largest condition number of a star's system.
    pub worst_condition: f64,
}

impl StarReport {
    pub(crate) fn add(&mut self, outcome: &StarOutcome, order: usize) {
        self.hidden_nodes_skipped += outcome.hidden;
        self.enlarged += usize::from(outcome.enlarged);
        self.order_lowered += usize::from(outcome.order < order);
        self.worst_condition = self.worst_condition.max(outcome.condition);
    }
}

/// The stars of consecutive nodes and the rows of their derivatives.
#[derive(Clone, Debug)]
pub struct Stencils {
    order: usize,
    metric: Metric,
    first: usize,       // number of the first node
    starts: Vec<usize>, // first star entry of each node, shape (n + 1,)
    nodes: Vec<NodeId>, // star after star, each ascending
    rows: Vec<f64>,     // for a star of m nodes, (n_monomials − 1) rows of m, in scaled coordinates
    radii: Vec<f64>,    // radius of each star, user's length unit
    outcomes: Vec<StarOutcome>,
    size: usize,
}

/// The stencil of one node.
#[derive(Clone, Copy, Debug)]
pub struct Stencil<'a> {
    /// The star's nodes, ascending.
    pub nodes: &'a [NodeId],
    /// Radius of the star in stretched coordinates, user's length unit.
    pub radius: f64,
    rows: &'a [f64],
}

impl<'a> Stencil<'a> {
    /// What each node contributes to derivative `m` (see [`crate::row`]; not 0, the value itself) at the centre in
    /// scaled coordinates: multiply by (stretch_x/radius)^a·(stretch_y/radius)^b for ∂ᵃ⁺ᵇ/∂xᵃ∂yᵇ.
    pub fn row(&self, m: usize) -> &'a [f64] {
        &self.rows[(m - 1) * self.nodes.len()..m * self.nodes.len()]
    }
}

impl Stencils {
    /// Stencils of the nodes `range` of a cloud.
    ///
    /// A star that cannot carry the polynomial is enlarged, then its order lowered (the rows of the missing derivatives
    /// are 0); [`Self::report`] tells.
    pub fn new(surroundings: &Surroundings, nearest: &Nearest, params: StarParams, range: Range<usize>) -> Self {
        let n_rows = n_monomials(params.order) - 1;
        let (places, metric) = (surroundings.stretched(), surroundings.metric());
        let first = range.start;
        let pieces = map_chunks(range, |piece| {
            let mut finder = StarFinder::new(surroundings, nearest);
            let (mut mwls, mut star) = (Mwls::default(), Vec::new());
            let mut part = Self::empty(params, metric, piece.start);
            for node in piece {
                let outcome =
                    sound_star(&mut finder, &mut mwls, places, NodeId::of(node), params.order, params.size, &mut star);
                let before = part.rows.len();
                if outcome.order > 0 {
                    mwls.rows(&mut part.rows);
                }
                part.rows.resize(before + n_rows * star.len(), 0.0);
                part.nodes.extend(&star);
                part.starts.push(part.nodes.len());
                part.radii.push(if mwls.radius() > 0.0 { mwls.radius() } else { 1.0 });
                part.outcomes.push(outcome);
            }
            part
        });
        let mut all = Self::empty(params, metric, first);
        for part in pieces {
            let offset = all.nodes.len();
            all.starts.extend(part.starts[1..].iter().map(|start| start + offset));
            all.nodes.extend(part.nodes);
            all.rows.extend(part.rows);
            all.radii.extend(part.radii);
            all.outcomes.extend(part.outcomes);
        }
        all
    }

    /// Requires the stars of the nodes `range` to carry polynomials of `order`.
    ///
    /// # Errors
    /// [`MfdmError::PoorStar`] for the first node whose star does not.
    pub fn require(&self, range: Range<usize>, xy: &[Point], order: usize) -> Result<(), MfdmError> {
        match range.clone().find(|node| self.outcomes[node - self.first].order < order) {
            Some(node) => {
                let tried = self.of(NodeId::of(node)).nodes.len();
                Err(MfdmError::PoorStar { node, at: xy[node], order, tried })
            }
            None => Ok(()),
        }
    }

    fn empty(params: StarParams, metric: Metric, first: usize) -> Self {
        Self {
            order: params.order,
            metric,
            first,
            starts: vec![0],
            nodes: Vec::new(),
            rows: Vec::new(),
            radii: Vec::new(),
            outcomes: Vec::new(),
            size: params.size,
        }
    }

    /// The metric of their coordinates.
    pub fn metric(&self) -> Metric {
        self.metric
    }

    /// Order of the polynomials.
    pub fn order(&self) -> usize {
        self.order
    }

    /// The stencil of a node of the range.
    pub fn of(&self, node: NodeId) -> Stencil<'_> {
        let k = node.index() - self.first;
        let star = self.starts[k]..self.starts[k + 1];
        let n_rows = n_monomials(self.order) - 1;
        Stencil {
            nodes: &self.nodes[star.clone()],
            radius: self.radii[k],
            rows: &self.rows[n_rows * star.start..n_rows * star.end],
        }
    }

    /// What became of the stars.
    pub fn report(&self) -> StarReport {
        let mut report = StarReport { size: self.size, ..StarReport::default() };
        self.outcomes.iter().for_each(|outcome| report.add(outcome, self.order));
        report
    }
}
