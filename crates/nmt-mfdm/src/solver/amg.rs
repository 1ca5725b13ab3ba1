//! Smoothed-aggregation multigrid: one V-cycle as a preconditioner (Vaněk, Mandel, Brezina 1996).
//!
//! Two things are not in the textbook, since the matrices of nearest-node stars are not symmetric and a few equations in a
//! thousand have a weak diagonal, or one of wrong sign: such unknowns are smoothed together with their neighbours
//! ([`smoother`]), and their equations are left out of the coarser levels.

mod aggregate;
mod prolongator;
mod smoother;
mod strength;

use crate::solver::csr::Csr;
use crate::solver::direct::DenseFactors;
use aggregate::aggregate;
use prolongator::prolongator;
use smoother::{Smoother, weak};
use std::borrow::Cow;
use strength::strong;

/// At most this many unknowns are solved for by a dense factorisation, in each cycle in the time of 4·10⁴ additions.
const COARSEST: usize = 200;

/// A level with more than this part of the unknowns of the one above is not worth while: the matrix cannot be coarsened.
const LEAST_COARSENING: f64 = 0.8;

/// Strength of connection on the finest level; half of it on each coarser one, whose matrices have wider rows.
const THRESHOLD: f64 = 0.08;

/// Whether aᵢⱼ = aⱼᵢ, so that the preconditioner has to be symmetric too.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Symmetry {
    /// To rounding.
    Symmetric,
    /// Not.
    Unsymmetric,
}

/// The levels of one matrix.
pub(crate) struct Hierarchy<'a> {
    levels: Vec<Level<'a>>,
    coarsest: DenseFactors,
}

struct Level<'a> {
    matrix: Cow<'a, Csr>,
    smoother: Smoother,
    prolongator: Csr,
    restrictor: Csr,
}

/// Room for the vectors of every level, to be used again in each cycle.
pub(crate) struct Workspace(Vec<Vectors>);

#[derive(Default)]
struct Vectors {
    x: Vec<f64>,
    b: Vec<f64>,
    r: Vec<f64>,
}

impl<'a> Hierarchy<'a> {
    /// Levels down to at most [`COARSEST`] unknowns; `None` where the matrix cannot be coarsened. O(entries).
    pub fn new(fine: &'a Csr, symmetry: Symmetry) -> Option<Self> {
        let mut levels = Vec::new();
        let mut matrix = Cow::Borrowed(fine);
        let mut threshold = THRESHOLD;
        while matrix.n_rows() > COARSEST {
            let strong = strong(&matrix, threshold);
            let aggregates = aggregate(&strong.matrix);
            if aggregates.n == 0 || aggregates.n as f64 > LEAST_COARSENING * matrix.n_rows() as f64 {
                return None;
            }
            let is_weak = weak(&matrix);
            let prolongator = prolongator(&strong, &aggregates, &is_weak);
            let smoother = Smoother::new(&matrix, &strong.matrix, &is_weak);
            drop((strong, aggregates));
            let mut restrictor = prolongator.transpose();
            if symmetry == Symmetry::Unsymmetric {
                // Patches have settled these equations; in a coarser one they would cancel what is sound.
                restrictor.clear_columns(&is_weak);
            }
            let coarse = restrictor.product(&matrix.product(&prolongator));
            levels.push(Level { matrix, smoother, prolongator, restrictor });
            matrix = Cow::Owned(coarse);
            threshold *= 0.5;
        }
        Some(Self { levels, coarsest: DenseFactors::new(&matrix) })
    }

    /// Number of levels, the finest and the coarsest included.
    pub fn n_levels(&self) -> usize {
        self.levels.len() + 1
    }

    /// Entries of the matrices of all levels over those of the finest.
    pub fn operator_complexity(&self) -> f64 {
        let entries = |level: &Level| level.matrix.n_entries() as f64;
        let coarsest = (self.coarsest.n() as f64).powi(2);
        let finest = self.levels.first().map_or(coarsest, entries);
        (self.levels.iter().map(entries).sum::<f64>() + coarsest) / finest
    }

    /// Room for [`Self::cycle`].
    pub fn workspace(&self) -> Workspace {
        let vectors = |(k, level): (usize, &Level)| {
            let n = level.matrix.n_rows();
            // The finest x and b are the caller's.
            let own = if k == 0 { 0 } else { n };
            Vectors { x: vec![0.0; own], b: vec![0.0; own], r: vec![0.0; n] }
        };
        let mut all: Vec<Vectors> = self.levels.iter().enumerate().map(vectors).collect();
        let n = self.coarsest.n();
        all.push(Vectors { x: vec![0.0; n], b: vec![0.0; n], r: Vec::new() });
        Workspace(all)
    }

    /// x = M⁻¹·b by one V-cycle; a symmetric M where the matrix is symmetric.
    pub fn cycle(&self, b: &[f64], x: &mut [f64], room: &mut Workspace) {
        self.cycle_from(0, b, x, &mut room.0);
    }

    fn cycle_from(&self, k: usize, b: &[f64], x: &mut [f64], room: &mut [Vectors]) {
        let (Some(level), Some((own, coarser))) = (self.levels.get(k), room.split_first_mut()) else {
            return self.coarsest.solve(b, x);
        };
        let Level { matrix, smoother, prolongator, restrictor } = level;
        smoother.ascend_from_zero(matrix, b, x);
        matrix.residual_to(b, x, &mut own.r);
        // The next level's x and b are lent out; its r stays in its room.
        let (mut next_x, mut next_b) = (std::mem::take(&mut coarser[0].x), std::mem::take(&mut coarser[0].b));
        restrictor.apply_to(&own.r, &mut next_b);
        self.cycle_from(k + 1, &next_b, &mut next_x, coarser);
        prolongator.add_to(&next_x, x);
        (coarser[0].x, coarser[0].b) = (next_x, next_b);
        smoother.descend(matrix, b, x, &mut own.r);
    }
}
