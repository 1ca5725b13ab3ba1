//! A system in which equations are to be put in the place of others, all at once: what stays is moved then.

use crate::solver::csr::Csr;
use crate::system::{Equation, LinearSystem};
use std::collections::BTreeMap;

/// The rows of a system in which equations are to be put in the place of others.
pub(crate) struct Patched<'a> {
    matrix: &'a Csr,
    anew: &'a BTreeMap<usize, Equation>,
    is_anew: Vec<bool>,
}

impl<'a> Patched<'a> {
    pub fn new(system: &'a LinearSystem, anew: &'a BTreeMap<usize, Equation>) -> Self {
        let mut is_anew = vec![false; system.n()];
        anew.keys().for_each(|number| is_anew[*number] = true);
        Self { matrix: &system.matrix, anew, is_anew }
    }

    /// Hands over (column, value) of a row in order.
    #[inline]
    pub fn each_entry(&self, i: usize, mut to: impl FnMut(usize, f64)) {
        if self.is_anew[i] {
            let unknowns = self.anew.get(&i).into_iter().flat_map(|equation| &equation.row.unknowns);
            return unknowns.for_each(|&(j, value)| to(j as usize, value));
        }
        self.matrix.row(i).entries().for_each(|(j, value)| to(j, value));
    }

    /// Entries of a row, by column and value, that are as asked for.
    #[inline]
    pub fn n_entries(&self, i: usize, is_wanted: impl Fn(usize, f64) -> bool) -> usize {
        let mut n = 0;
        self.each_entry(i, |j, value| n += usize::from(is_wanted(j, value)));
        n
    }

    /// a_ij, or 0.
    pub fn entry(&self, i: usize, j: usize) -> f64 {
        match self.anew.get(&i) {
            Some(equation) => equation.row.of_unknown(j),
            None => self.matrix.entry(i, j as u32),
        }
    }
}
