//! Linear solvers: direct for systems of moderate size, preconditioned iteration above; every solution is checked by its
//! true residual.

mod amg;
mod border;
mod choice;
pub(crate) mod csr;
pub(crate) mod direct;
#[cfg(feature = "kernels")]
pub(crate) mod kernels;
mod krylov;
mod ordering;
mod right_side;
mod vector;

pub(crate) use border::Border;
pub use choice::{DIRECT_MAX_UNKNOWNS, Iteration, LinearSolve, Method, Solver};
pub(crate) use right_side::RightSide;

use crate::error::MfdmError;
use crate::solve::Event;
use crate::system::LinearSystem;
use amg::{Hierarchy, Symmetry};
use border::{Bordered, Operator};
use csr::{Csr, Diagonal};
use krylov::{Iterated, Limits, Task};
use nmt_geom::Point;
use vector::Sides;

/// Largest relative residual ‖b − Ax‖/‖b‖ that is accepted.
///
/// LU with one step of refinement leaves 1e-15 times the growth of the pivots; sound systems of 10⁵ unknowns came to
/// 1e-13. Discretisation errors are 1e-7 at best.
pub(crate) const MAX_RESIDUAL: f64 = 1.0e-9;

/// The residual that the iteration goes on to.
///
/// Rounding alone leaves 1e-16 times the number of unknowns, so that beyond 10⁶ this may not be reached: the iteration
/// then ends where it stands still, and [`MAX_RESIDUAL`] decides.
const LIMITS: Limits = Limits { target: TARGET, iterations: 200 };

/// The residual that the iteration goes on to, where nothing less will do.
pub(crate) const TARGET: f64 = 1.0e-10;

/// Entries a_ij and a_ji of a symmetric matrix differ by rounding only: by this part of the diagonals.
const SYMMETRIC_REL: f64 = 1.0e-12;

/// Solutions of one system.
#[derive(Clone, Debug)]
pub(crate) struct Solutions {
    /// One vector a right side.
    pub x: Vec<Vec<f64>>,
    /// How they were found.
    pub how: LinearSolve,
}

/// Solves A·x = b for every right side, with one set-up for all.
///
/// `places` gives those of the unknowns, shape (n, 2), where the direct solver asks for them; `target` is the relative residual that an iteration goes on to. Where
/// it does not converge, the direct solver takes over.
///
/// # Errors
/// [`MfdmError::Singular`], [`MfdmError::Memory`], or [`MfdmError::Residual`] where no solver finds a solution.
pub(crate) fn solve(
    system: &LinearSystem,
    places: &dyn Fn() -> Vec<Point>,
    right_sides: &[RightSide],
    choice: Solver,
    target: f64,
    observer: &mut dyn FnMut(Event),
) -> Result<Solutions, MfdmError> {
    solve_within(system, places, right_sides, choice, Limits { target, ..LIMITS }, observer)
}

fn solve_within(
    system: &LinearSystem,
    places: &dyn Fn() -> Vec<Point>,
    right_sides: &[RightSide],
    choice: Solver,
    limits: Limits,
    observer: &mut dyn FnMut(Event),
) -> Result<Solutions, MfdmError> {
    let iterates = choice.iterates(system.n());
    if iterates && let Some(solutions) = iterate(&system.matrix, right_sides, limits, observer) {
        return Ok(solutions);
    }
    let dense: Vec<_> = right_sides.iter().map(|b| b.dense(system.n())).collect();
    let dense: Vec<&[f64]> = dense.iter().map(|b| &**b).collect();
    let direct::Solutions { x, residual } = direct::solve(system, &places(), &dense)?;
    let how = LinearSolve { method: Method::Direct, residual, iteration: None, fell_back: iterates };
    Ok(Solutions { x, how })
}

/// CG or BiCGSTAB with a multigrid cycle; `None` where one right side does not converge.
///
/// Two right sides at a time go through the same passes over the matrices; more would take memory that one solution can do
/// without.
fn iterate(
    matrix: &Csr,
    right_sides: &[RightSide],
    limits: Limits,
    observer: &mut dyn FnMut(Event),
) -> Option<Solutions> {
    let diagonal = Diagonal::new(matrix);
    let symmetry =
        if matrix.is_symmetric(&diagonal, SYMMETRIC_REL) { Symmetry::Symmetric } else { Symmetry::Unsymmetric };
    let hierarchy = Hierarchy::new(matrix, diagonal, symmetry, 0)?;
    let a = Operator::from(matrix);
    let mut all = Vec::with_capacity(right_sides.len());
    for some in right_sides.chunks(2) {
        let (first, before) = (all.len(), all.iter().map(|one: &Iterated| one.iterations).max().unwrap_or(0));
        let mut told = |iterations: usize, residual| {
            let iterations = iterations.max(before);
            observer(Event::Iteration { iterations, residual, target: limits.target });
        };
        let told: &mut dyn FnMut(usize, f64) = &mut told;
        match *some {
            [one, other] => {
                all.extend(iterate_some(Task { a, b: [one, other], limits, told }, &hierarchy, symmetry));
            }
            [one] => all.extend(iterate_some(Task { a, b: [one], limits, told }, &hierarchy, symmetry)),
            _ => {}
        }
        let limit = MAX_RESIDUAL.max(10.0 * limits.target);
        if !all[first..].iter().all(|one| one.residual <= limit) {
            return None;
        }
    }
    let how = how(&all, &hierarchy, symmetry);
    Some(Solutions { x: all.into_iter().map(|one| one.x).collect(), how })
}

fn how(all: &[Iterated], hierarchy: &Hierarchy, symmetry: Symmetry) -> LinearSolve {
    let iteration = Iteration {
        iterations: all.iter().map(|one| one.iterations).max().unwrap_or(0),
        levels: hierarchy.n_levels(),
        operator_complexity: hierarchy.operator_complexity(),
    };
    let residual = all.iter().map(|one| one.residual).fold(0.0, f64::max);
    let method = if symmetry == Symmetry::Symmetric { Method::Cg } else { Method::Bicgstab };
    LinearSolve { method, residual, iteration: Some(iteration), fell_back: false }
}

/// The unknowns of a system and those of its border, found together by BiCGSTAB with a multigrid cycle; `None` where that does
/// not converge, or where the system is one for the direct solver. The system is as it was then.
pub(crate) fn solve_bordered(
    system: &mut LinearSystem,
    border: Border,
    choice: Solver,
    target: f64,
    observer: &mut dyn FnMut(Event),
) -> Option<(Vec<f64>, LinearSolve)> {
    if !choice.iterates(system.n()) {
        return None;
    }
    let bordered = Bordered::new(system, border)?;
    let (matrix, symmetry) = (bordered.matrix(), Symmetry::Unsymmetric);
    let hierarchy = Hierarchy::new(matrix, Diagonal::new(matrix), symmetry, bordered.n_more())?;
    let told: &mut dyn FnMut(usize, f64) =
        &mut |iterations, residual| observer(Event::Iteration { iterations, residual, target });
    let b = [RightSide::All(bordered.rhs())];
    let task = Task { a: bordered.operator(), b, limits: Limits { target, ..LIMITS }, told };
    let found = iterate_some(task, &hierarchy, symmetry);
    let how = how(&found, &hierarchy, symmetry);
    let [Iterated { x, residual, .. }] = found;
    // NaN is no solution.
    (residual <= MAX_RESIDUAL.max(10.0 * target)).then_some((x, how))
}

fn iterate_some<const K: usize>(task: Task<K>, hierarchy: &Hierarchy, symmetry: Symmetry) -> [Iterated; K] {
    let mut room = hierarchy.workspace();
    let a = task.a;
    let cycle = move |r: &[Sides<K>], z: &mut [Sides<K>], az: &mut [Sides<K>]| {
        hierarchy.cycle(r, z, az, &mut room);
        a.correct(z, az);
    };
    match symmetry {
        Symmetry::Symmetric => krylov::cg(task, cycle),
        Symmetry::Unsymmetric => krylov::bicgstab(task, cycle),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::system::{Equation, Role, SplitRow};

    /// Five-point differences on a square of `n` by `n` unknowns, with `wind` to make it unsymmetric.
    fn differences(n: u32, wind: f64) -> (LinearSystem, Vec<Point>) {
        let mut system = LinearSystem::new((n * n) as usize, 0);
        let mut places = Vec::new();
        for (i, j) in (0..n).flat_map(|j| (0..n).map(move |i| (i, j))) {
            let mut row = SplitRow::default();
            let mut add = |is_inside: bool, k: u32, value: f64| {
                if is_inside {
                    row.add(Role::Unknown(k), value);
                }
            };
            let k = j * n + i;
            add(j > 0, k.wrapping_sub(n), -1.0);
            add(i > 0, k.wrapping_sub(1), -1.0 - wind);
            add(true, k, 4.0);
            add(i + 1 < n, k + 1, -1.0 + wind);
            add(j + 1 < n, k + n, -1.0);
            system.push(&Equation { row, rhs: 1.0 + f64::from(k % 5) });
            places.push([f64::from(i), f64::from(j)]);
        }
        (system, places)
    }

    fn largest_difference(x: &[f64], y: &[f64]) -> f64 {
        let scale = y.iter().fold(0.0, |s: f64, v| s.max(v.abs()));
        x.iter().zip(y).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max) / scale
    }

    #[test]
    fn iteration_and_factorisation_agree_and_tell_what_they_did() -> Result<(), MfdmError> {
        for (wind, method) in [(0.0, Method::Cg), (0.3, Method::Bicgstab)] {
            let (system, xy) = differences(60, wind);
            let other: Vec<f64> = (0..system.n()).map(|i| f64::from(i as u32 % 7) - 3.0).collect();
            let zero = vec![0.0; system.n()];
            let right_sides = [&system.rhs[..], &other, &zero].map(RightSide::All);
            let direct = solve(&system, &|| xy.clone(), &right_sides, Solver::Auto, TARGET, &mut |_| {})?;
            assert_eq!((direct.how.method, direct.how.iteration), (Method::Direct, None));
            let iterated = solve(&system, &|| xy.clone(), &right_sides, Solver::Iterative, TARGET, &mut |_| {})?;
            assert_eq!((iterated.how.method, iterated.how.fell_back), (method, false));
            let iteration = iterated.how.iteration.unwrap_or_default();
            // 12 and 6 measured, three levels, 1.6.
            assert!((5..20).contains(&iteration.iterations) && iteration.levels >= 3, "{iteration:?}");
            assert!((1.0..2.0).contains(&iteration.operator_complexity), "{iteration:?}");
            assert!(iterated.how.residual <= LIMITS.target);
            for (x, y) in iterated.x.iter().zip(&direct.x).take(2) {
                assert!(largest_difference(x, y) < 1e-9); // residual 1e-10; 2e-10 measured
            }
            assert!(iterated.x[2].iter().all(|v| *v == 0.0));
        }
        Ok(())
    }

    #[test]
    fn what_does_not_converge_falls_back_and_says_so() -> Result<(), MfdmError> {
        let (system, xy) = differences(40, 0.2);
        let limits = Limits { iterations: 2, ..LIMITS };
        let solutions = solve_within(
            &system,
            &|| xy.clone(),
            &[RightSide::All(&system.rhs)],
            Solver::Iterative,
            limits,
            &mut |_| {},
        )?;
        assert!(solutions.how.fell_back && solutions.how.method == Method::Direct);
        assert!(solutions.how.iteration.is_none() && solutions.how.residual < 1e-12);
        Ok(())
    }

    #[test]
    fn a_singular_matrix_is_an_error_whatever_the_solver() {
        // No boundary: constants are in the null space, and the right side is not in the range.
        let n = 900u32;
        let mut system = LinearSystem::new(n as usize, 0);
        for i in 0..n {
            let mut row = SplitRow::default();
            let ends = u8::from(i > 0) + u8::from(i + 1 < n);
            if i > 0 {
                row.add(Role::Unknown(i - 1), -1.0);
            }
            row.add(Role::Unknown(i), f64::from(ends));
            if i + 1 < n {
                row.add(Role::Unknown(i + 1), -1.0);
            }
            system.push(&Equation { row, rhs: 1.0 });
        }
        let xy: Vec<Point> = (0..n).map(|i| [f64::from(i), 0.0]).collect();
        for choice in Solver::ALL {
            assert!(
                solve(&system, &|| xy.clone(), &[RightSide::All(&system.rhs)], choice, TARGET, &mut |_| {}).is_err(),
                "{choice:?}"
            );
        }
    }

    /// Twice the differences at distance 2 less those at distance 1: consistent, and of wrong sign, at some unknowns.
    #[test]
    fn diagonals_of_wrong_sign_do_not_spoil_the_iteration() -> Result<(), MfdmError> {
        let n = 80;
        let (sound, xy) = differences(n as u32, 0.0);
        let mut system = LinearSystem::new(sound.n(), 0);
        for k in 0..sound.n() {
            let (i, j) = (k % n, k / n);
            let is_wrong = k % 97 == 50 && i.min(j) > 1 && i.max(j) < n - 2;
            let mut row = SplitRow::default();
            if is_wrong {
                let wide = [(k - 2 * n, -0.5), (k - n, 1.0), (k - 2, -0.5), (k - 1, 1.0), (k, -2.0)];
                let mirrored = wide.iter().rev().skip(1).map(|(at, value)| (2 * k - at, *value));
                wide.into_iter().chain(mirrored).for_each(|(at, value)| row.add(Role::Unknown(at as u32), value));
            } else {
                sound.matrix.row(k).entries().for_each(|(at, value)| row.add(Role::Unknown(at as u32), value));
            }
            system.push(&Equation { row, rhs: sound.rhs[k] });
        }
        let iterated =
            solve(&system, &|| xy.clone(), &[RightSide::All(&system.rhs)], Solver::Iterative, TARGET, &mut |_| {})?;
        let iterations = iterated.how.iteration.unwrap_or_default().iterations;
        assert!((1..40).contains(&iterations), "{iterations}");
        let direct =
            solve(&system, &|| xy.clone(), &[RightSide::All(&system.rhs)], Solver::Direct, TARGET, &mut |_| {})?;
        assert!(largest_difference(&iterated.x[0], &direct.x[0]) < 1e-9); // residual 1e-10
        Ok(())
    }

    #[cfg(feature = "parallel")]
    #[test]
    fn one_thread_and_several_give_the_same_bits() -> Result<(), Box<dyn std::error::Error>> {
        // Above the size of a block, so that there is more than one.
        let (system, xy) = differences(200, 0.3);
        let solve = |threads: usize| -> Result<Vec<f64>, Box<dyn std::error::Error>> {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
            let mut solutions = pool.install(|| {
                solve(&system, &|| xy.clone(), &[RightSide::All(&system.rhs)], Solver::Auto, TARGET, &mut |_| {})
            })?;
            assert_eq!(solutions.how.method, Method::Bicgstab);
            Ok(solutions.x.swap_remove(0))
        };
        let one = solve(1)?;
        assert!(one.iter().zip(solve(2)?).all(|(x, y)| x.to_bits() == y.to_bits()));
        assert!(one.iter().zip(solve(5)?).all(|(x, y)| x.to_bits() == y.to_bits()));
        Ok(())
    }
}
