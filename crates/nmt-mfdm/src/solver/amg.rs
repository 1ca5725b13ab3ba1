//! Smoothed-aggregation multigrid: one W-cycle as a preconditioner (Vaněk, Mandel, Brezina 1996).
//!
//! Three things are not in the textbook, since the matrices of nearest-node stars are not symmetric and a few equations in
//! a thousand have a weak diagonal, or one of wrong sign: such unknowns are smoothed together with their neighbours
//! ([`smoother`]), their equations are left out of the coarser levels, and the others are weighed there ([`weights`]).

mod aggregate;
mod prolongator;
mod smoother;
mod strength;
mod weights;

use crate::solver::csr::Csr;
use crate::solver::direct::DenseFactors;
use aggregate::aggregate;
use prolongator::prolongator;
use smoother::{Smoother, weak};
use std::borrow::Cow;
use strength::strong;
use weights::equation_weights;

/// At most this many unknowns are solved for by a dense factorisation, in each cycle in the time of 4·10⁴ additions.
const COARSEST: usize = 200;

/// A level with more than this part of the unknowns of the one above is not worth while: the matrix cannot be coarsened.
const LEAST_COARSENING: f64 = 0.8;

/// Times that each coarser level is visited in a cycle.
///
/// What one visit leaves adds up over the levels: with one, 10⁶ unknowns take twice the iterations of 10⁴ (symmetric
/// matrices 1.4 times); with two the cycle costs a tenth more, since a level has a ninth of the unknowns of that above.
const VISITS: usize = 2;

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
    // Of a further visit.
    more_x: Vec<f64>,
    more_b: Vec<f64>,
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
                // Coarser levels inherit the weights of the finest.
                let mut weights =
                    if levels.is_empty() { equation_weights(&matrix, &is_weak) } else { vec![1.0; matrix.n_rows()] };
                // Patches have settled these equations; in a coarser one they would cancel what is sound.
                weights.iter_mut().zip(&is_weak).filter(|(_, weak)| **weak).for_each(|(weight, _)| *weight = 0.0);
                restrictor.scale_columns(&weights);
            }
            let coarse = matrix.between(&restrictor, &prolongator);
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
            let own = || vec![0.0; if k == 0 { 0 } else { n }];
            Vectors { x: own(), b: own(), r: vec![0.0; n], more_x: own(), more_b: own() }
        };
        let mut all: Vec<Vectors> = self.levels.iter().enumerate().map(vectors).collect();
        let n = self.coarsest.n();
        all.push(Vectors { x: vec![0.0; n], b: vec![0.0; n], ..Vectors::default() });
        Workspace(all)
    }

    /// x = M⁻¹·b by one W-cycle; a symmetric M where the matrix is symmetric.
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
        let mut next = std::mem::take(&mut coarser[0]);
        std::mem::swap(&mut coarser[0].r, &mut next.r);
        restrictor.apply_to(&own.r, &mut next.b);
        self.cycle_from(k + 1, &next.b, &mut next.x, coarser);
        // The coarsest is solved exactly.
        if let Some(Level { matrix, .. }) = self.levels.get(k + 1) {
            for _ in 1..VISITS {
                matrix.residual_to(&next.b, &next.x, &mut next.more_b);
                self.cycle_from(k + 1, &next.more_b, &mut next.more_x, coarser);
                next.x.iter_mut().zip(&next.more_x).for_each(|(x, more)| *x += more);
            }
        }
        prolongator.add_to(&next.x, x);
        std::mem::swap(&mut coarser[0].r, &mut next.r);
        coarser[0] = next;
        smoother.descend(matrix, b, x, &mut own.r);
    }
}
