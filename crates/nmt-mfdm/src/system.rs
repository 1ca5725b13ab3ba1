//! The linear system of one problem: interior nodes are unknown, boundary nodes are known or share a hole's constant.

use nmt_geom::{LoopId, NodeId};
use nmt_tri::Mesh;

/// What a node's value is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Role {
    /// Unknown number so and so.
    Unknown(u32),
    /// The constant of hole number so and so (circulation).
    Hole(u32),
    /// Zero: a Dirichlet node.
    Zero,
}

/// The role of every node: Dirichlet values are eliminated here and nowhere else.
#[derive(Clone, Debug)]
pub(crate) struct Roles {
    boundary: Vec<Role>, // shape (n_boundary,)
    /// Number of unknown nodal values: the interior nodes.
    pub n_unknowns: usize,
    /// Number of holes with an unknown constant.
    pub n_holes: usize,
}

impl Roles {
    /// `free_holes`: each hole has an unknown constant; otherwise F = 0 on holes too.
    pub fn new(mesh: &Mesh, free_holes: FreeHoles) -> Self {
        let cloud = mesh.cloud();
        let mut boundary = vec![Role::Zero; cloud.n_boundary()];
        let n_holes = if free_holes == FreeHoles::Yes { cloud.boundary().n_loops() - 1 } else { 0 };
        for hole in 0..n_holes {
            let segments = cloud.boundary().loop_segments(LoopId::of(hole + 1));
            segments.iter().for_each(|s| boundary[s.from.index()] = Role::Hole(hole as u32));
        }
        Self { boundary, n_unknowns: cloud.n_interior(), n_holes }
    }

    /// The role of a node.
    #[inline]
    pub fn of(&self, node: NodeId) -> Role {
        match self.boundary.get(node.index()) {
            Some(role) => *role,
            None => Role::Unknown((node.index() - self.boundary.len()) as u32),
        }
    }
}

/// Whether holes have unknown constants.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FreeHoles {
    Yes,
    No,
}

/// A linear functional of the nodal values, split by role; what meets a Dirichlet node is gone.
#[derive(Clone, Debug, Default)]
pub(crate) struct SplitRow {
    /// (unknown, coefficient), ascending.
    pub unknowns: Vec<(u32, f64)>,
    /// (hole, coefficient), each hole once.
    pub holes: Vec<(u32, f64)>,
}

impl SplitRow {
    /// Adds `coefficient` times the value of a node of that role; unknowns must come in ascending order.
    #[inline]
    pub fn add(&mut self, role: Role, coefficient: f64) {
        match role {
            Role::Unknown(k) => self.unknowns.push((k, coefficient)),
            Role::Hole(k) => match self.holes.iter_mut().find(|(hole, _)| *hole == k) {
                Some((_, total)) => *total += coefficient,
                None => self.holes.push((k, coefficient)),
            },
            Role::Zero => {}
        }
    }
}

/// Sums coefficients by node, to be used again for the next row; O(entries).
#[derive(Clone, Debug)]
pub(crate) struct RowSum {
    sums: Vec<f64>, // shape (n_nodes,), zero where untouched
    touched: Vec<u32>,
    is_touched: Vec<bool>,
}

impl RowSum {
    pub fn new(n_nodes: usize) -> Self {
        Self { sums: vec![0.0; n_nodes], touched: Vec::new(), is_touched: vec![false; n_nodes] }
    }

    /// Adds `coefficient` times the value of `node`.
    #[inline]
    pub fn add(&mut self, node: NodeId, coefficient: f64) {
        let k = node.index();
        if !self.is_touched[k] {
            self.is_touched[k] = true;
            self.touched.push(node.0);
        }
        self.sums[k] += coefficient;
    }

    /// The row so far, by role; begins the next one.
    pub fn take(&mut self, roles: &Roles) -> SplitRow {
        self.touched.sort_unstable();
        let mut row = SplitRow::default();
        for node in self.touched.drain(..) {
            let sum = std::mem::take(&mut self.sums[node as usize]);
            self.is_touched[node as usize] = false;
            row.add(roles.of(NodeId(node)), sum);
        }
        row
    }
}

/// A·x = b by rows, with what the constants of the holes add: A·x + Σ c_k·B_k = b.
#[derive(Clone, Debug, Default)]
pub(crate) struct LinearSystem {
    /// First entry of each row, shape (n + 1,).
    pub row_starts: Vec<usize>,
    /// Column of each entry, ascending in a row.
    pub columns: Vec<u32>,
    /// Value of each entry.
    pub values: Vec<f64>,
    /// b, shape (n,).
    pub rhs: Vec<f64>,
    /// (row, coefficient) of each B_k.
    pub hole_columns: Vec<Vec<(u32, f64)>>,
}

impl LinearSystem {
    pub fn new(n_holes: usize) -> Self {
        Self { row_starts: vec![0], hole_columns: vec![Vec::new(); n_holes], ..Self::default() }
    }

    /// Number of equations.
    pub fn n(&self) -> usize {
        self.rhs.len()
    }

    /// Appends an equation.
    pub fn push(&mut self, row: &SplitRow, rhs: f64) {
        let number = self.rhs.len() as u32;
        for &(column, value) in &row.unknowns {
            self.columns.push(column);
            self.values.push(value);
        }
        row.holes.iter().for_each(|&(hole, value)| self.hole_columns[hole as usize].push((number, value)));
        self.row_starts.push(self.columns.len());
        self.rhs.push(rhs);
    }

    /// A·x.
    pub fn apply(&self, x: &[f64]) -> Vec<f64> {
        let row = |r: usize| {
            let entries = self.row_starts[r]..self.row_starts[r + 1];
            entries.map(|e| self.values[e] * x[self.columns[e] as usize]).sum()
        };
        (0..self.n()).map(row).collect()
    }
}
