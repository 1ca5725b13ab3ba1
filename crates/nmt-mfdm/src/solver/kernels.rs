//! Parts of the iteration, repeated so that their instructions can be counted.

use super::amg::{Hierarchy, Symmetry};
use super::csr::Diagonal;
use crate::system::LinearSystem;

/// Builds the levels so many times.
pub(crate) fn setups(system: &LinearSystem, times: usize) -> f64 {
    let complexity = |_| hierarchy(system).map_or(0.0, |hierarchy| hierarchy.operator_complexity());
    (0..times).map(complexity).sum()
}

fn hierarchy(system: &LinearSystem) -> Option<Hierarchy<'_>> {
    Hierarchy::new(&system.matrix, Diagonal::new(&system.matrix), Symmetry::Unsymmetric, 0)
}

/// Builds them once and makes so many cycles.
pub(crate) fn cycles(system: &LinearSystem, times: usize) -> f64 {
    let Some(hierarchy) = hierarchy(system) else { return 0.0 };
    let (mut room, b) = (hierarchy.workspace(), system.rhs.as_chunks::<1>().0);
    let (mut x, mut ax) = (vec![[0.0]; b.len()], vec![[0.0]; b.len()]);
    let mut cycle = |_| {
        hierarchy.cycle(b, &mut x, &mut ax, &mut room);
        x.as_flattened().iter().sum::<f64>()
    };
    (0..times).map(&mut cycle).sum()
}

/// Multiplies the right side by the matrix so many times.
pub(crate) fn products(system: &LinearSystem, times: usize) -> f64 {
    (0..times).map(|_| system.matrix.apply(&system.rhs).iter().sum::<f64>()).sum()
}
