//! Smoothed-aggregation multigrid: one W-cycle as a preconditioner (Vaněk, Mandel, Brezina 1996).
//!
//! Three things are not in the textbook, since the matrices of nearest-node stars are not symmetric and a few equations in
//! a thousand have a weak diagonal, or one of wrong sign: such unknowns are smoothed together with their neighbours
//! ([`smoother`]), their equations are left out of the coarser levels, and the others are weighed there ([`weights`]).

mod aggregate;
mod prolongator;
mod smoother;
mod strength;
mod transfer;
mod weights;

use crate::solver::csr::{Csr, Diagonal};
use crate::solver::direct::DenseFactors;
use crate::solver::vector::{Sides, add_multiple};
use aggregate::aggregate;
use prolongator::prolongator;
use smoother::{Smoother, patches, weak};
use std::borrow::Cow;
use strength::strong;
use transfer::Transfer;
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
    prolongator: Transfer,
    restrictor: Transfer,
}

/// Room for the vectors of every level, to be used again in each cycle.
pub(crate) struct Workspace<const K: usize>(Vec<Vectors<K>>);

#[derive(Default)]
struct Vectors<const K: usize> {
    x: Vec<Sides<K>>,
    ax: Vec<Sides<K>>,
    b: Vec<Sides<K>>,
    r: Vec<Sides<K>>,
    more: Vec<Sides<K>>, // of a further visit
}

impl<'a> Hierarchy<'a> {
    /// Levels down to at most [`COARSEST`] unknowns; `None` where the matrix cannot be coarsened. O(entries).
    ///
    /// The last `n_borders` unknowns hang together with as many others as they like, such as a hole's constant with all around
    /// it: aggregated, they would have all of those hang together. Every level has them, each by itself.
    pub fn new(fine: &'a Csr, of_fine: Diagonal, symmetry: Symmetry, n_borders: usize) -> Option<Self> {
        let mut levels = Vec::new();
        let (mut matrix, mut diagonal) = (Cow::Borrowed(fine), of_fine);
        let mut threshold = THRESHOLD;
        while matrix.n_rows() > COARSEST + 2 * n_borders {
            let strong = strong(&matrix, &diagonal, threshold, n_borders);
            let n_inside = matrix.n_rows() - n_borders;
            let mut aggregates = aggregate(&strong.matrix);
            aggregates.add_single(n_inside);
            if aggregates.n == 0 || aggregates.n as f64 > LEAST_COARSENING * matrix.n_rows() as f64 {
                return None;
            }
            let mut is_weak = weak(&matrix, &diagonal);
            is_weak[n_inside..].fill(false);
            let prolongator = prolongator(&strong, &aggregates, &is_weak);
            let patches = patches(&matrix, &diagonal, &strong.matrix, &is_weak, symmetry);
            drop((strong, aggregates));
            let mut restrictor = prolongator.transpose();
            if symmetry == Symmetry::Unsymmetric {
                // Coarser levels inherit the weights of the finest.
                let mut weights = if levels.is_empty() {
                    equation_weights(&matrix, &diagonal, &is_weak)
                } else {
                    vec![1.0; matrix.n_rows()]
                };
                // Patches have settled these equations; in a coarser one they would cancel what is sound.
                weights.iter_mut().zip(&is_weak).filter(|(_, weak)| **weak).for_each(|(weight, _)| *weight = 0.0);
                restrictor.scale_columns(&weights);
            }
            let smoother = Smoother::new(&matrix, diagonal, &is_weak, patches, symmetry);
            let coarse = matrix.between(&restrictor, &prolongator);
            let (prolongator, restrictor) = (Transfer::new(&prolongator), Transfer::new(&restrictor));
            levels.push(Level { matrix, smoother, prolongator, restrictor });
            diagonal = Diagonal::new(&coarse);
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
    pub fn workspace<const K: usize>(&self) -> Workspace<K> {
        let vectors = |(k, level): (usize, &Level)| {
            let n = level.matrix.n_rows();
            // The finest x, ax and b are the caller's.
            let own = || vec![[0.0; K]; if k == 0 { 0 } else { n }];
            Vectors { x: own(), ax: own(), b: own(), r: vec![[0.0; K]; n], more: own() }
        };
        let mut all: Vec<Vectors<K>> = self.levels.iter().enumerate().map(vectors).collect();
        let room = || vec![[0.0; K]; self.coarsest.n()];
        all.push(Vectors { x: room(), b: room(), ..Vectors::default() });
        Workspace(all)
    }

    /// x = M⁻¹·b by one W-cycle, and ax = A·x; a symmetric M where the matrix is symmetric.
    pub fn cycle<const K: usize>(
        &self,
        b: &[Sides<K>],
        x: &mut [Sides<K>],
        ax: &mut [Sides<K>],
        room: &mut Workspace<K>,
    ) {
        self.cycle_from(0, b, [x, ax], &mut room.0);
    }

    /// The coarsest level gives no ax.
    fn cycle_from<const K: usize>(
        &self,
        k: usize,
        b: &[Sides<K>],
        [x, ax]: [&mut [Sides<K>]; 2],
        room: &mut [Vectors<K>],
    ) {
        let (Some(level), Some((own, coarser))) = (self.levels.get(k), room.split_first_mut()) else {
            return self.coarsest.solve(b, x);
        };
        let Level { matrix, smoother, prolongator, restrictor } = level;
        smoother.ascend(matrix, b, [x, &mut own.r, ax]);
        // The next level's vectors are lent out; its r stays in its room.
        let mut next = std::mem::take(&mut coarser[0]);
        std::mem::swap(&mut coarser[0].r, &mut next.r);
        restrictor.apply_to(&own.r, &mut next.b);
        self.cycle_from(k + 1, &next.b, [&mut next.x, &mut next.ax], coarser);
        // The coarsest is solved exactly.
        let n_visits = if k + 1 < self.levels.len() { VISITS } else { 1 };
        for _ in 1..n_visits {
            next.b.iter_mut().zip(&next.ax).for_each(|(b, ax)| add_multiple(b, -1.0, *ax));
            self.cycle_from(k + 1, &next.b, [&mut next.more, &mut next.ax], coarser);
            next.x.iter_mut().zip(&next.more).for_each(|(x, more)| add_multiple(x, 1.0, *more));
        }
        prolongator.add_to(&next.x, x);
        std::mem::swap(&mut coarser[0].r, &mut next.r);
        coarser[0] = next;
        smoother.descend(matrix, b, [x, ax, &mut own.r]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Differences on a square of 60 by 60, symmetric; about every 50th unknown two weak equations side by side.
    fn symmetric() -> Csr {
        let n = 60;
        let is_weak = |i: usize| i % 50 == 20;
        let mut a = Csr::new(n * n);
        for i in 0..n * n {
            let diagonal = if is_weak(i) { 0.9 } else { 4.2 };
            let near = [(i >= n, i.wrapping_sub(n)), (i % n > 0, i.wrapping_sub(1)), (true, i), (i % n + 1 < n, i + 1)];
            for (_, j) in near.into_iter().chain([(i + n < n * n, i + n)]).filter(|(is_inside, _)| *is_inside) {
                a.push(j as u32, if i == j { diagonal } else { -1.0 });
            }
            a.end_row();
        }
        a
    }

    #[test]
    fn a_symmetric_matrix_has_a_symmetric_cycle_and_its_product_with_it() {
        let a = symmetric();
        let diagonal = Diagonal::new(&a);
        assert!(a.is_symmetric(&diagonal, 0.0));
        let hierarchy = Hierarchy::new(&a, diagonal, Symmetry::Symmetric, 0);
        let hierarchy = hierarchy.unwrap_or_else(|| unreachable!("it can be coarsened"));
        let n = a.n_rows();
        let pair: Vec<Sides<2>> = (0..n).map(|i| [((i * 7) % 11) as f64 - 5.0, ((i * 5) % 13) as f64 - 6.0]).collect();
        let (mut x, mut ax) = (vec![[0.0; 2]; n], vec![[0.0; 2]; n]);
        hierarchy.cycle(&pair, &mut x, &mut ax, &mut hierarchy.workspace());
        let along = |m: usize, k: usize| (0..n).map(|i| pair[i][m] * x[i][k]).sum::<f64>();
        assert!((along(0, 1) - along(1, 0)).abs() < 1e-6 * along(0, 0)); // transfers of single precision
        let mut product = vec![[0.0; 2]; n];
        a.apply_to(&x, &mut product);
        let scale = 8.0 * x.as_flattened().iter().fold(0.0f64, |largest, x| largest.max(x.abs()));
        let sides = product.as_flattened().iter().zip(ax.as_flattened());
        assert!(sides.into_iter().all(|(p, ax)| (p - ax).abs() <= 1e-14 * scale)); // rounding
    }
}
