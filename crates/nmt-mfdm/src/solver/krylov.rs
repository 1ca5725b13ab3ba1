//! Conjugate gradients and BiCGSTAB, preconditioned, for several right sides in step; the true residual decides.

use crate::solver::border::Operator;
use crate::solver::right_side::RightSide;
use crate::solver::vector::{Sides, dot, norm, one_of, update};
use std::array::from_fn;

/// Iterations without halving the residual after which an iteration is given up.
const PATIENCE: usize = 40;

/// Starts at most: from the true residual, after a breakdown or where recurrence and truth have drifted apart.
const MAX_STARTS: usize = 8;

/// A scalar product below this part of the product of the norms is a breakdown.
const BREAKDOWN: f64 = 1.0e-14;

/// How far an iteration goes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limits {
    /// ‖b − Ax‖/‖b‖ to reach.
    pub target: f64,
    /// Iterations at most.
    pub iterations: usize,
}

/// What is iterated, and to where.
pub(crate) struct Task<'a, const K: usize> {
    pub a: Operator<'a>,
    pub b: [RightSide<'a>; K],
    pub limits: Limits,
    /// Takes iterations and the largest residual after each.
    pub told: &'a mut dyn FnMut(usize, f64),
}

/// What came of an iteration.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Iterated {
    /// The solution.
    pub x: Vec<f64>,
    /// Iterations done.
    pub iterations: usize,
    /// ‖b − Ax‖/‖b‖, computed from x.
    pub residual: f64,
}

/// Where one right side stands.
#[derive(Clone, Copy, Debug)]
struct Watch {
    iterations: usize,
    residual: f64,
    best: f64,
    since: usize,
}

impl Watch {
    const NEW: Self = Self { iterations: 0, residual: f64::INFINITY, best: f64::INFINITY, since: 0 };

    /// Takes the residual after one more iteration; false where there is no use in another.
    fn goes_on(&mut self, residual: f64, limits: Limits) -> bool {
        self.iterations += 1;
        if residual < 0.5 * self.best {
            (self.best, self.since) = (residual, self.iterations);
        }
        self.is_open(residual, limits)
    }

    /// Neither at the target, nor at the cap, nor where the residual has not halved for long.
    fn is_open(&mut self, residual: f64, limits: Limits) -> bool {
        self.residual = residual;
        let is_tried = self.iterations >= limits.iterations || self.iterations - self.since >= PATIENCE;
        residual > limits.target && residual.is_finite() && !is_tried
    }
}

/// The right sides under way. One that has come to its end rests: its x stays to the bit what it was.
struct Progress<'a, const K: usize> {
    right: Sides<K>, // ‖b‖
    watches: [Watch; K],
    /// Whether the recurrence of each goes on.
    runs: [bool; K],
    limits: Limits,
    told: &'a mut dyn FnMut(usize, f64),
}

impl<const K: usize> Progress<'_, K> {
    /// The norms of the residuals by the recurrence after an iteration.
    fn take(&mut self, norms: Sides<K>) {
        for k in 0..K {
            self.runs[k] = self.runs[k] && self.watches[k].goes_on(norms[k] / self.right[k], self.limits);
        }
        self.tell();
    }

    /// Iterations so far and the largest residual.
    fn tell(&mut self) {
        let iterations = self.watches.iter().map(|watch| watch.iterations).max().unwrap_or(0);
        let residual = self.watches.iter().map(|watch| watch.residual).filter(|r| r.is_finite()).fold(0.0, f64::max);
        (self.told)(iterations, residual);
    }

    /// A number of each that goes on, 0 of the others.
    fn running(&self, of: impl Fn(usize) -> f64) -> Sides<K> {
        from_fn(|k| if self.runs[k] { of(k) } else { 0.0 })
    }

    fn stop_where(&mut self, is_stopped: impl Fn(usize) -> bool) {
        (0..K).for_each(|k| self.runs[k] &= !is_stopped(k));
    }
}

/// Starts a recurrence from x = 0, and again from the true residual where it ends without having come to the target.
///
/// `recur` takes x, r = b − Ax and the progress; it returns when no right side runs any more. What it holds is given back
/// before the solutions are parted.
fn iterate<const K: usize>(
    Task { a, b, limits, told }: Task<K>,
    mut recur: impl FnMut(&mut [Sides<K>], &mut [Sides<K>], &mut Progress<K>),
) -> [Iterated; K] {
    let (mut x, mut r) = (vec![[0.0; K]; a.n_rows()], vec![[0.0; K]; a.n_rows()]);
    (0..K).for_each(|k| b[k].add_to(k, &mut r));
    let right = norm(&r);
    let mut progress =
        Progress { right, watches: [Watch::NEW; K], runs: right.map(|right| right != 0.0), limits, told };
    // 0 solves A·x = 0.
    (0..K).filter(|k| right[*k] == 0.0).for_each(|k| progress.watches[k].residual = 0.0);
    let mut is_open = progress.runs;
    for _ in 0..MAX_STARTS {
        if !is_open.contains(&true) {
            break;
        }
        progress.runs = is_open;
        recur(&mut x, &mut r, &mut progress);
        a.apply_to(&x, &mut r);
        update(&mut r, |_, _, ax| -ax);
        (0..K).for_each(|k| b[k].add_to(k, &mut r));
        let norms = norm(&r);
        for k in 0..K {
            is_open[k] = is_open[k] && progress.watches[k].is_open(norms[k] / right[k], limits);
        }
    }
    let watches = progress.watches;
    drop((recur, r));
    from_fn(|k| {
        let Watch { iterations, residual, .. } = watches[k];
        Iterated { x: one_of(&x, k), iterations, residual }
    })
}

/// Preconditioned conjugate gradients from x = 0: A and the preconditioner M⁻¹ symmetric and positive definite.
///
/// `precondition` takes r and makes z = M⁻¹r and A·z.
pub(crate) fn cg<const K: usize>(
    task: Task<K>,
    mut precondition: impl FnMut(&[Sides<K>], &mut [Sides<K>], &mut [Sides<K>]),
) -> [Iterated; K] {
    let room = || vec![[0.0; K]; task.a.n_rows()];
    let (mut z, mut az, mut p, mut ap) = (room(), room(), room(), room());
    iterate(task, move |x, r, progress| {
        let mut rho = [0.0; K];
        while progress.runs.contains(&true) {
            precondition(r, &mut z, &mut az);
            let next = dot(r, &z);
            let beta = progress.running(|k| if rho[k] == 0.0 { 0.0 } else { next[k] / rho[k] });
            rho = next;
            update(&mut p, |i, k, p| z[i][k] + beta[k] * p);
            update(&mut ap, |i, k, ap| az[i][k] + beta[k] * ap);
            let curvature = dot(&p, &ap);
            progress.stop_where(|k| !(rho[k] > 0.0 && curvature[k] > 0.0));
            let alpha = progress.running(|k| rho[k] / curvature[k]);
            update(x, |i, k, x| x + alpha[k] * p[i][k]);
            update(r, |i, k, r| r - alpha[k] * ap[i][k]);
            progress.take(norm(r));
        }
    })
}

/// Preconditioned BiCGSTAB (van der Vorst 1992) from x = 0, preconditioned from the right.
///
/// `precondition` takes r and makes z = M⁻¹r and A·z.
pub(crate) fn bicgstab<const K: usize>(
    task: Task<K>,
    mut precondition: impl FnMut(&[Sides<K>], &mut [Sides<K>], &mut [Sides<K>]),
) -> [Iterated; K] {
    let room = || vec![[0.0; K]; task.a.n_rows()];
    let (mut p, mut v, mut t, mut y) = (room(), room(), room(), room());
    let (b, mut starts) = (task.b, 0);
    iterate(task, move |x, r, progress| {
        starts += 1;
        // The first residual: b itself at the first start, which is mostly the only one.
        let again = if starts > 1 { Some(r.to_vec()) } else { None };
        let along_shadow =
            |x: &[Sides<K>]| again.as_ref().map_or_else(|| from_fn(|k| b[k].dot(k, x)), |shadow| dot(shadow, x));
        let shadow_norm = norm(r);
        let mut r_norm = shadow_norm;
        let [mut rho, mut alpha, mut omega] = [[1.0; K]; 3];
        p.fill([0.0; K]);
        v.fill([0.0; K]);
        while progress.runs.contains(&true) {
            let next = along_shadow(r);
            progress.stop_where(|k| next[k].abs() <= BREAKDOWN * shadow_norm[k] * r_norm[k]);
            let beta = progress.running(|k| next[k] / rho[k] * (alpha[k] / omega[k]));
            rho = next;
            update(&mut p, |i, k, p| r[i][k] + beta[k] * (p - omega[k] * v[i][k]));
            precondition(&p, &mut y, &mut v);
            let along = along_shadow(&v);
            progress.stop_where(|k| !(rho[k] / along[k]).is_finite());
            alpha = progress.running(|k| rho[k] / along[k]);
            update(x, |i, k, x| x + alpha[k] * y[i][k]);
            update(r, |i, k, r| r - alpha[k] * v[i][k]);
            precondition(r, &mut y, &mut t);
            let (square, along) = (dot(&t, &t), dot(&t, r));
            omega = progress.running(|k| if square[k] > 0.0 { along[k] / square[k] } else { 0.0 });
            update(x, |i, k, x| x + omega[k] * y[i][k]);
            update(r, |i, k, r| r - omega[k] * t[i][k]);
            r_norm = norm(r);
            progress.take(r_norm);
            progress.stop_where(|k| omega[k] == 0.0);
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::csr::Csr;
    use crate::solver::csr::tests::of_dense;

    const LIMITS: Limits = Limits { target: 1e-12, iterations: 100 };

    fn tridiagonal(n: usize, below: f64, above: f64) -> Csr {
        let entry = |i: usize, j: usize| match (j + 1).wrapping_sub(i) {
            0 => below,
            1 => 2.5,
            2 => above,
            _ => 0.0,
        };
        let rows: Vec<Vec<f64>> = (0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect();
        of_dense(&rows)
    }

    /// One number of the diagonal for all.
    fn jacobi<const K: usize>(a: &Csr, diagonal: f64) -> impl FnMut(&[Sides<K>], &mut [Sides<K>], &mut [Sides<K>]) {
        move |r, z, az| {
            z.iter_mut().zip(r).for_each(|(z, r)| *z = r.map(|r| r / diagonal));
            a.apply_to(z, az);
        }
    }

    /// By conjugate gradients or BiCGSTAB, with one number of the diagonal for all.
    fn solved<const K: usize>(a: &Csr, b: [RightSide; K], diagonal: f64, by_cg: bool) -> [Iterated; K] {
        let task = Task { a: a.into(), b, limits: LIMITS, told: &mut |_, _| {} };
        if by_cg { cg(task, jacobi(a, diagonal)) } else { bicgstab(task, jacobi(a, diagonal)) }
    }

    #[test]
    fn both_find_the_solution_they_were_made_for() {
        let exact: Vec<f64> = (0..50).map(|i| f64::from(i % 7) - 2.0).collect();
        let (symmetric, other) = (tridiagonal(50, -1.0, -1.0), tridiagonal(50, -1.4, -0.8));
        for (a, is_symmetric) in [(&symmetric, true), (&symmetric, false), (&other, false)] {
            let b = a.apply(&exact);
            let [done] = solved(a, [RightSide::All(&b)], 2.5, is_symmetric);
            assert!(done.residual <= 1e-12 && done.iterations < 60, "{done:?}");
            assert!(done.x.iter().zip(&exact).all(|(x, e)| (x - e).abs() < 1e-10));
        }
    }

    #[test]
    fn right_sides_in_step_come_out_to_the_bit_as_alone() {
        let (symmetric, other) = (tridiagonal(90, -1.0, -1.0), tridiagonal(90, -1.4, -0.8));
        let hard: Vec<f64> = (0..90).map(|i| f64::from(i * i % 11) - 3.0).collect();
        let mut easy = vec![0.0; 90]; // an iteration or two
        easy[40] = 1e-3;
        let (easy, zero) = (other.apply(&easy), vec![0.0; 90]);
        let [hard, easy, zero] = [&hard, &easy, &zero].map(|b| RightSide::All(b));
        let column = RightSide::Column(&[(7, -1.0), (30, 0.5)]);
        for pair in [[hard, easy], [easy, hard], [zero, hard], [hard, column]] {
            let together = solved(&other, pair, 2.5, false);
            let alone = pair.map(|b| solved(&other, [b], 2.5, false));
            assert_eq!(together, alone.map(|[one]| one));
            assert!(together.iter().all(|one| one.residual <= LIMITS.target));
            let together = solved(&symmetric, pair, 2.5, true);
            let alone = pair.map(|b| solved(&symmetric, [b], 2.5, true));
            assert_eq!(together, alone.map(|[one]| one));
        }
    }

    #[test]
    fn without_convergence_the_true_residual_is_told_after_a_bounded_time() {
        // Rotations: BiCGSTAB breaks down at once, since Ax is orthogonal to x. CG meets no curvature.
        let mut rows = vec![vec![0.0; 20]; 20];
        for k in 0..10 {
            (rows[2 * k][2 * k + 1], rows[2 * k + 1][2 * k]) = (1.0, -1.0);
        }
        let a = of_dense(&rows);
        let b = vec![1.0; 20];
        for is_cg in [true, false] {
            let [done] = solved(&a, [RightSide::All(&b)], 1.0, is_cg);
            assert!(done.residual > 0.1 && done.iterations <= 100, "{done:?}");
            let left: f64 = a.apply(&done.x).iter().zip(&b).map(|(ax, b)| (b - ax) * (b - ax)).sum::<f64>();
            assert!((done.residual - (left / 20.0).sqrt()).abs() < 1e-12);
        }
    }

    #[test]
    fn numbers_that_are_none_end_the_iteration() {
        let mut rows = vec![vec![0.0; 3]; 3];
        (0..3).for_each(|i| rows[i][i] = if i == 1 { f64::NAN } else { 1.0 });
        let a = of_dense(&rows);
        let [done] = solved(&a, [RightSide::All(&[1.0; 3])], 1.0, false);
        assert!(done.residual.is_nan() && done.iterations < 5, "{done:?}");
    }
}
