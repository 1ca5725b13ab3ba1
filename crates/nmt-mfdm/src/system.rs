//! The linear system of one problem: interior nodes are unknown, boundary nodes are known, share a hole's constant, or have
//! a flux.

use crate::error::MfdmError;
use crate::problem::HoleCondition;
use crate::row_sum::RowSum;
use crate::solver::csr::Csr;
use nmt_geom::{LoopId, NodeId, Point};
use nmt_tri::Mesh;
use std::collections::BTreeMap;
use std::ops::Range;

/// What a node's value is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Role {
    /// Unknown number so and so.
    Unknown(u32),
    /// The constant of hole number so and so (circulation).
    Hole(u32),
    /// Known: a Dirichlet node.
    Known(f64),
}

/// What holds at a boundary node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum NodeCondition {
    /// A Dirichlet value.
    Value(f64),
    /// The constant of a hole.
    Hole(u32),
    /// A flux is given: the value is free.
    Flux,
}

/// How Dirichlet values enter the system.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Dirichlet {
    /// Known and holes' nodes are eliminated: polynomials meet the nodal values.
    Eliminated,
    /// Every node is unknown, and Σφ_j(x_b)·u_j = value is an equation of its own: polynomials smooth (g > 0).
    Rows,
}

/// The role of every node: Dirichlet values are eliminated here and nowhere else.
#[derive(Clone, Debug)]
pub(crate) struct Roles {
    conditions: Vec<NodeCondition>, // shape (n_boundary,)
    boundary: Vec<Role>,            // shape (n_boundary,)
    unknown_nodes: Vec<NodeId>,     // of the boundary, ascending; all interior nodes follow
    /// Number of unknown nodal values.
    pub n_unknowns: usize,
    /// Number of holes with an unknown constant.
    pub n_holes: usize,
}

impl Roles {
    /// Roles by the condition at each boundary node; all interior nodes are unknown.
    pub fn new(conditions: Vec<NodeCondition>, n_interior: usize, dirichlet: Dirichlet) -> Self {
        let mut unknown_nodes = Vec::new();
        let mut boundary = Vec::with_capacity(conditions.len());
        let mut n_holes = 0;
        for (node, condition) in conditions.iter().enumerate() {
            if let NodeCondition::Hole(hole) = condition {
                n_holes = n_holes.max(*hole as usize + 1);
            }
            boundary.push(match *condition {
                NodeCondition::Value(value) if dirichlet == Dirichlet::Eliminated => Role::Known(value),
                NodeCondition::Hole(hole) if dirichlet == Dirichlet::Eliminated => Role::Hole(hole),
                _ => {
                    unknown_nodes.push(NodeId::of(node));
                    Role::Unknown(unknown_nodes.len() as u32 - 1)
                }
            });
        }
        let n_unknowns = unknown_nodes.len() + n_interior;
        Self { conditions, boundary, unknown_nodes, n_unknowns, n_holes }
    }

    /// The conditions of torsion: F = 0 on the outer boundary; on holes F = 0 too, or a constant each.
    pub fn of_torsion(mesh: &Mesh, holes: HoleCondition) -> Vec<NodeCondition> {
        let cloud = mesh.cloud();
        let mut conditions = vec![NodeCondition::Value(0.0); cloud.n_boundary()];
        if holes == HoleCondition::Circulation {
            for hole in 0..cloud.boundary().n_loops() - 1 {
                let segments = cloud.boundary().loop_segments(LoopId::of(hole + 1));
                segments.iter().for_each(|s| conditions[s.from.index()] = NodeCondition::Hole(hole as u32));
            }
        }
        conditions
    }

    /// The role of a node.
    #[inline]
    pub fn of(&self, node: NodeId) -> Role {
        match self.boundary.get(node.index()) {
            Some(role) => *role,
            None => Role::Unknown((node.index() - self.boundary.len() + self.unknown_nodes.len()) as u32),
        }
    }

    /// The node of unknown number `k`.
    #[inline]
    pub fn node(&self, k: usize) -> NodeId {
        match self.unknown_nodes.get(k) {
            Some(node) => *node,
            None => NodeId::of(k - self.unknown_nodes.len() + self.boundary.len()),
        }
    }

    /// Numbers of the unknowns among consecutive nodes.
    pub fn unknowns_of(&self, nodes: Range<usize>) -> Range<usize> {
        let before = |node: usize| match node.checked_sub(self.boundary.len()) {
            Some(inside) => self.unknown_nodes.len() + inside,
            None => self.unknown_nodes.partition_point(|unknown| unknown.index() < node),
        };
        before(nodes.start)..before(nodes.end)
    }

    /// Where all nodes from `least` on are unknown: what their numbers as unknowns differ by from those as nodes, wrapping.
    pub fn shift_from(&self, least: NodeId) -> Option<u32> {
        let shift = (self.unknown_nodes.len() as u32).wrapping_sub(self.boundary.len() as u32);
        (least.index() >= self.boundary.len()).then_some(shift)
    }

    /// The condition at a node; `None` inside.
    pub fn condition(&self, node: NodeId) -> Option<NodeCondition> {
        self.conditions.get(node.index()).copied()
    }

    /// A functional of the nodal values, given by ascending node.
    pub fn split(&self, coefficients: &[(NodeId, f64)]) -> SplitRow {
        let mut row = SplitRow::default();
        coefficients.iter().for_each(|&(node, coefficient)| row.add(self.of(node), coefficient));
        row
    }

    /// Places of the unknowns, shape (n_unknowns, 2).
    pub fn places(&self, xy: &[Point]) -> Vec<Point> {
        (0..self.n_unknowns).map(|k| xy[self.node(k).index()]).collect()
    }
}

/// A linear functional of the nodal values, split by role.
#[derive(Clone, Debug, Default)]
pub(crate) struct SplitRow {
    /// (unknown, coefficient), ascending.
    pub unknowns: Vec<(u32, f64)>,
    /// (hole, coefficient), each hole once.
    pub holes: Vec<(u32, f64)>,
    /// What the known values contribute.
    pub known: f64,
    /// Whether a value that is known or a hole's enters it, be it 0.
    pub is_beside: bool,
}

impl SplitRow {
    /// This functional times a factor.
    pub fn times(&self, factor: f64) -> Self {
        let scaled = |parts: &[(u32, f64)]| parts.iter().map(|&(k, c)| (k, c * factor)).collect();
        let (unknowns, holes) = (scaled(&self.unknowns), scaled(&self.holes));
        Self { unknowns, holes, known: self.known * factor, is_beside: self.is_beside }
    }

    /// The coefficient of an unknown.
    pub fn of_unknown(&self, k: usize) -> f64 {
        self.unknowns.binary_search_by_key(&(k as u32), |(unknown, _)| *unknown).map_or(0.0, |at| self.unknowns[at].1)
    }

    /// Adds `coefficient` times the value of a node of that role; unknowns must come in ascending order.
    #[inline]
    pub fn add(&mut self, role: Role, coefficient: f64) {
        self.is_beside |= !matches!(role, Role::Unknown(_));
        match role {
            Role::Unknown(k) => self.unknowns.push((k, coefficient)),
            Role::Hole(k) => match self.holes.iter_mut().find(|(hole, _)| *hole == k) {
                Some((_, total)) => *total += coefficient,
                None => self.holes.push((k, coefficient)),
            },
            Role::Known(value) => self.known += coefficient * value,
        }
    }
}

/// An equation: row · values = rhs.
#[derive(Clone, Debug, Default)]
pub(crate) struct Equation {
    pub row: SplitRow,
    pub rhs: f64,
}

/// A·x = b by rows, with what the constants of the holes add: A·x + Σ c_k·B_k = b.
#[derive(Clone, Debug)]
pub(crate) struct LinearSystem {
    /// A, shape (n, n); columns ascend in a row.
    pub matrix: Csr,
    /// b, shape (n,).
    pub rhs: Vec<f64>,
    /// (row, coefficient) of each B_k.
    pub hole_columns: Vec<Vec<(u32, f64)>>,
    /// Whether a value on the boundary enters the equation, be it 0; shape (n,).
    pub is_beside: Vec<bool>,
    /// What known values contribute to the equation under way.
    known: f64,
    /// Whether a value on the boundary enters it.
    is_under_way_beside: bool,
}

impl LinearSystem {
    /// No equation yet, in `n` unknowns.
    pub fn new(n: usize, n_holes: usize) -> Self {
        let (matrix, hole_columns) = (Csr::new(n), vec![Vec::new(); n_holes]);
        Self { matrix, rhs: Vec::new(), hole_columns, is_beside: Vec::new(), known: 0.0, is_under_way_beside: false }
    }

    /// A·x = 0.
    pub fn homogeneous(matrix: Csr, n_holes: usize) -> Self {
        let n = matrix.n_rows();
        Self { rhs: vec![0.0; n], is_beside: vec![false; n], matrix, ..Self::new(n, n_holes) }
    }

    /// Number of equations.
    pub fn n(&self) -> usize {
        self.rhs.len()
    }

    /// Collects equations in their order.
    ///
    /// # Errors
    /// The first that an equation has.
    pub fn of(roles: &Roles, equations: impl Iterator<Item = Result<Equation, MfdmError>>) -> Result<Self, MfdmError> {
        let mut system = Self::new(roles.n_unknowns, roles.n_holes);
        for equation in equations {
            system.push(&equation?);
        }
        Ok(system)
    }

    /// Makes it empty, with the room it has.
    pub fn clear(&mut self) {
        self.matrix.clear();
        self.rhs.clear();
        self.is_beside.clear();
        self.hole_columns.iter_mut().for_each(Vec::clear);
        (self.known, self.is_under_way_beside) = (0.0, false);
    }

    /// Appends the equations of `other`, but for their rows of A.
    pub fn append_all_but_rows(&mut self, other: &Self) {
        let first = self.rhs.len() as u32;
        self.rhs.extend_from_slice(&other.rhs);
        self.is_beside.extend_from_slice(&other.is_beside);
        for (all, own) in self.hole_columns.iter_mut().zip(&other.hole_columns) {
            all.extend(own.iter().map(|&(row, coefficient)| (first + row, coefficient)));
        }
    }

    /// Puts equations in the place of those that have their numbers, which ascend.
    pub fn replace(&mut self, anew: &[(usize, Equation)]) {
        if anew.is_empty() {
            return;
        }
        let numbers: Vec<usize> = anew.iter().map(|(number, _)| *number).collect();
        let rows: Vec<&[(u32, f64)]> = anew.iter().map(|(_, equation)| equation.row.unknowns.as_slice()).collect();
        self.matrix.replace_rows(&numbers, &rows);
        for (number, equation) in anew {
            self.rhs[*number] = equation.rhs - equation.row.known;
            self.is_beside[*number] = equation.row.is_beside;
        }
        for (hole, column) in self.hole_columns.iter_mut().enumerate() {
            column.retain(|(number, _)| numbers.binary_search(&(*number as usize)).is_err());
            for (number, equation) in anew {
                let own = equation.row.holes.iter().filter(|(of, _)| *of as usize == hole);
                column.extend(own.map(|(_, value)| (*number as u32, *value)));
            }
            column.sort_unstable_by_key(|(number, _)| *number);
        }
    }

    /// Puts equations in the place of those that have their numbers, then adds functionals to the left sides of those that have
    /// theirs, in any order, one equation more than once.
    pub fn mend(&mut self, mut anew: BTreeMap<usize, Equation>, mut parts: Vec<(usize, SplitRow)>) {
        parts.sort_by_key(|(number, _)| *number);
        for of_one in parts.chunk_by(|a, b| a.0 == b.0) {
            let row = &mut anew.entry(of_one[0].0).or_insert_with_key(|number| self.equation(*number)).row;
            for (_, part) in of_one {
                row.unknowns.extend(&part.unknowns);
                part.holes.iter().for_each(|&(hole, coefficient)| row.add(Role::Hole(hole), coefficient));
                row.known += part.known;
                row.is_beside |= part.is_beside;
            }
            row.unknowns.sort_by_key(|(unknown, _)| *unknown);
            row.unknowns = row.unknowns.chunk_by(|a, b| a.0 == b.0).map(sum_of_same).collect();
        }
        self.replace(&anew.into_iter().collect::<Vec<_>>());
    }

    /// The equation of a number.
    fn equation(&self, number: usize) -> Equation {
        let entries = self.matrix.row(number).entries();
        let unknowns = entries.map(|(column, value)| (column as u32, value)).collect();
        let of_hole = |(hole, column): (u32, &Vec<(u32, f64)>)| {
            let at = column.binary_search_by_key(&(number as u32), |(row, _)| *row).ok()?;
            Some((hole, column[at].1))
        };
        let holes = (0..).zip(&self.hole_columns).filter_map(of_hole).collect();
        let row = SplitRow { unknowns, holes, known: 0.0, is_beside: self.is_beside[number] };
        Equation { row, rhs: self.rhs[number] }
    }

    /// Appends an equation.
    pub fn push(&mut self, equation: &Equation) {
        let SplitRow { unknowns, holes, known, is_beside } = &equation.row;
        unknowns.iter().for_each(|&(k, coefficient)| self.add(Role::Unknown(k), coefficient));
        holes.iter().for_each(|&(hole, coefficient)| self.add(Role::Hole(hole), coefficient));
        self.known += known;
        self.is_under_way_beside |= is_beside;
        self.end(equation.rhs);
    }

    /// Adds `coefficient` times the value of a node of that role to the equation under way; unknowns must come in ascending
    /// order.
    #[inline]
    pub fn add(&mut self, role: Role, coefficient: f64) {
        match role {
            Role::Unknown(k) => return self.matrix.push(k, coefficient),
            Role::Hole(hole) => {
                let (number, column) = (self.rhs.len() as u32, &mut self.hole_columns[hole as usize]);
                match column.last_mut() {
                    Some((row, total)) if *row == number => *total += coefficient,
                    _ => column.push((number, coefficient)),
                }
            }
            Role::Known(value) => self.known += coefficient * value,
        }
        self.is_under_way_beside = true;
    }

    /// Adds a row to the equation under way, and begins the next one.
    #[inline(always)]
    pub fn add_row(&mut self, roles: &Roles, row: &mut RowSum) {
        match roles.shift_from(row.least()) {
            Some(shift) => {
                let (columns, values) = self.matrix.room(row.n_nodes());
                let mut places = columns.iter_mut().zip(values);
                row.drain(|node, sum| {
                    if let Some((column, value)) = places.next() {
                        (*column, *value) = (node.0.wrapping_add(shift), sum);
                    }
                });
            }
            None => row.drain(|node, sum| self.add(roles.of(node), sum)),
        }
    }

    /// Ends the equation under way.
    #[inline]
    pub fn end(&mut self, rhs: f64) {
        self.matrix.end_row();
        self.rhs.push(rhs - std::mem::take(&mut self.known));
        self.is_beside.push(std::mem::take(&mut self.is_under_way_beside));
    }
}

/// One entry for several of the same number.
fn sum_of_same(same: &[(u32, f64)]) -> (u32, f64) {
    (same[0].0, same.iter().map(|(_, value)| value).sum())
}
