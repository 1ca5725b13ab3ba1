//! Conjugate gradients and BiCGSTAB, preconditioned; the true residual decides.

use crate::solver::csr::Csr;
use crate::solver::vector::{dot, norm, update};

/// Iterations without halving the residual after which an iteration is given up.
const PATIENCE: usize = 40;

/// How far an iteration goes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limits {
    /// ‖b − Ax‖/‖b‖ to reach.
    pub target: f64,
    /// Iterations at most.
    pub iterations: usize,
}

/// What came of an iteration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Iterated {
    /// Iterations done.
    pub iterations: usize,
    /// ‖b − Ax‖/‖b‖ of the x returned, computed from x.
    pub residual: f64,
}

/// Counts iterations, tells them with their residuals, and says when to stop: at the cap, or where the residual has not
/// halved for long.
struct Watch<'a> {
    told: &'a mut dyn FnMut(usize, f64),
    iterations: usize,
    cap: usize,
    best: f64,
    since: usize,
}

impl<'a> Watch<'a> {
    fn new(limits: Limits, told: &'a mut dyn FnMut(usize, f64)) -> Self {
        Self { told, iterations: 0, cap: limits.iterations, best: f64::INFINITY, since: 0 }
    }

    /// One more iteration, with the residual it left; false where there is no use in another.
    fn goes_on(&mut self, residual: f64) -> bool {
        self.iterations += 1;
        (self.told)(self.iterations, residual);
        if residual < 0.5 * self.best {
            (self.best, self.since) = (residual, self.iterations);
        }
        residual.is_finite() && self.iterations < self.cap && self.iterations - self.since < PATIENCE
    }
}

/// Preconditioned conjugate gradients from x = 0: A and the preconditioner symmetric and positive definite.
pub(crate) fn cg(
    a: &Csr,
    b: &[f64],
    x: &mut [f64],
    limits: Limits,
    mut precondition: impl FnMut(&[f64], &mut [f64]),
    told: &mut dyn FnMut(usize, f64),
) -> Iterated {
    let n = b.len();
    let right = norm(b);
    x.fill(0.0);
    if right == 0.0 {
        return Iterated { iterations: 0, residual: 0.0 };
    }
    let (mut r, mut z, mut p, mut q) = (b.to_vec(), vec![0.0; n], vec![0.0; n], vec![0.0; n]);
    let mut watch = Watch::new(limits, told);
    let mut starts = 0;
    loop {
        // (Re)start from the true residual.
        starts += 1;
        let mut rho = 0.0;
        loop {
            precondition(&r, &mut z);
            let next = dot(&r, &z);
            let beta = if rho == 0.0 { 0.0 } else { next / rho };
            rho = next;
            update(&mut p, |i, p| z[i] + beta * p);
            a.apply_to(&p, &mut q);
            let curvature = dot(&p, &q);
            if !(rho > 0.0 && curvature > 0.0) {
                break;
            }
            let alpha = rho / curvature;
            update(x, |i, x| x + alpha * p[i]);
            update(&mut r, |i, r| r - alpha * q[i]);
            let residual = norm(&r) / right;
            if residual <= limits.target || !watch.goes_on(residual) {
                break;
            }
        }
        a.residual_to(b, x, &mut r);
        let residual = norm(&r) / right;
        if residual <= limits.target || starts == MAX_STARTS || !watch.goes_on(residual) {
            return Iterated { iterations: watch.iterations, residual };
        }
    }
}

/// Starts at most: from the true residual, after a breakdown or where recurrence and truth have drifted apart.
const MAX_STARTS: usize = 8;

/// A scalar product below this part of the product of the norms is a breakdown.
const BREAKDOWN: f64 = 1.0e-14;

/// Preconditioned BiCGSTAB (van der Vorst 1992) from x = 0, preconditioned from the right.
pub(crate) fn bicgstab(
    a: &Csr,
    b: &[f64],
    x: &mut [f64],
    limits: Limits,
    mut precondition: impl FnMut(&[f64], &mut [f64]),
    told: &mut dyn FnMut(usize, f64),
) -> Iterated {
    let n = b.len();
    let right = norm(b);
    x.fill(0.0);
    if right == 0.0 {
        return Iterated { iterations: 0, residual: 0.0 };
    }
    let mut r = b.to_vec();
    let (mut shadow, mut p) = (r.clone(), vec![0.0; n]);
    let (mut v, mut t, mut y) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
    let mut watch = Watch::new(limits, told);
    let mut starts = 0;
    loop {
        starts += 1;
        shadow.copy_from_slice(&r);
        let shadow_norm = norm(&shadow);
        let (mut rho, mut alpha, mut omega) = (1.0, 1.0, 1.0);
        p.fill(0.0);
        v.fill(0.0);
        loop {
            let next = dot(&shadow, &r);
            if next.abs() <= BREAKDOWN * shadow_norm * norm(&r) {
                break;
            }
            let beta = next / rho * (alpha / omega);
            rho = next;
            update(&mut p, |i, p| r[i] + beta * (p - omega * v[i]));
            precondition(&p, &mut y);
            a.apply_to(&y, &mut v);
            alpha = rho / dot(&shadow, &v);
            if !alpha.is_finite() {
                break;
            }
            update(x, |i, x| x + alpha * y[i]);
            update(&mut r, |i, r| r - alpha * v[i]);
            precondition(&r, &mut y);
            a.apply_to(&y, &mut t);
            let square = dot(&t, &t);
            omega = if square > 0.0 { dot(&t, &r) / square } else { 0.0 };
            update(x, |i, x| x + omega * y[i]);
            update(&mut r, |i, r| r - omega * t[i]);
            let residual = norm(&r) / right;
            if residual <= limits.target || !watch.goes_on(residual) || omega == 0.0 {
                break;
            }
        }
        a.residual_to(b, x, &mut r);
        let residual = norm(&r) / right;
        if residual <= limits.target || starts == MAX_STARTS || !watch.goes_on(residual) {
            return Iterated { iterations: watch.iterations, residual };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
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

    fn jacobi(r: &[f64], z: &mut [f64]) {
        z.iter_mut().zip(r).for_each(|(z, r)| *z = r / 2.5);
    }

    #[test]
    fn both_find_the_solution_they_were_made_for() {
        let exact: Vec<f64> = (0..50).map(|i| f64::from(i % 7) - 2.0).collect();
        let (symmetric, other) = (tridiagonal(50, -1.0, -1.0), tridiagonal(50, -1.4, -0.8));
        for (a, is_symmetric) in [(&symmetric, true), (&symmetric, false), (&other, false)] {
            let (b, mut x) = (a.apply(&exact), vec![7.0; 50]);
            let done = if is_symmetric {
                cg(a, &b, &mut x, LIMITS, jacobi, &mut |_, _| {})
            } else {
                bicgstab(a, &b, &mut x, LIMITS, jacobi, &mut |_, _| {})
            };
            assert!(done.residual <= 1e-12 && done.iterations < 60, "{done:?}");
            assert!(x.iter().zip(&exact).all(|(x, e)| (x - e).abs() < 1e-10));
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
        let copy = |r: &[f64], z: &mut [f64]| z.copy_from_slice(r);
        for is_cg in [true, false] {
            let mut x = vec![0.0; 20];
            let done = if is_cg {
                cg(&a, &b, &mut x, LIMITS, copy, &mut |_, _| {})
            } else {
                bicgstab(&a, &b, &mut x, LIMITS, copy, &mut |_, _| {})
            };
            assert!(done.residual > 0.1 && done.iterations <= 100, "{done:?}");
            let left: f64 = a.apply(&x).iter().zip(&b).map(|(ax, b)| (b - ax) * (b - ax)).sum::<f64>();
            assert!((done.residual - (left / 20.0).sqrt()).abs() < 1e-12);
        }
    }

    #[test]
    fn numbers_that_are_none_end_the_iteration() {
        let mut rows = vec![vec![0.0; 3]; 3];
        (0..3).for_each(|i| rows[i][i] = if i == 1 { f64::NAN } else { 1.0 });
        let mut x = vec![0.0; 3];
        let done = bicgstab(&of_dense(&rows), &[1.0; 3], &mut x, LIMITS, |r, z| z.copy_from_slice(r), &mut |_, _| {});
        assert!(done.residual.is_nan() && done.iterations < 5, "{done:?}");
    }
}
