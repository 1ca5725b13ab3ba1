//! Which solver, and what became of it.

/// Which linear solver.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Solver {
    /// The direct one up to [`DIRECT_MAX_UNKNOWNS`], the iteration above.
    #[default]
    Auto,
    /// Sparse LU.
    Direct,
    /// CG where the matrix is symmetric, else BiCGSTAB, with a smoothed-aggregation multigrid.
    Iterative,
}

/// [`Solver::Auto`] iterates above this many unknowns.
///
/// The iteration is as fast from 10⁴ on and takes less memory everywhere; the factorisation leaves a residual of rounding
/// alone, and up to here takes half a second and 250 MB at most (order 2; docs/adr/0004-iterative-solver.md).
pub const DIRECT_MAX_UNKNOWNS: usize = 30_000;

impl Solver {
    /// Every choice, in the order of the documentation.
    pub const ALL: [Self; 3] = [Self::Auto, Self::Direct, Self::Iterative];

    /// The word of the problem file.
    pub fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Direct => "direct",
            Self::Iterative => "iterative",
        }
    }

    /// Whether a system of `n` unknowns is iterated on.
    pub(crate) fn iterates(self, n: usize) -> bool {
        match self {
            Self::Auto => n > DIRECT_MAX_UNKNOWNS,
            Self::Direct => false,
            Self::Iterative => true,
        }
    }
}

/// What gave a solution.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// Sparse LU factorisation.
    #[default]
    Direct,
    /// Conjugate gradients.
    Cg,
    /// BiCGSTAB.
    Bicgstab,
}

impl Method {
    /// The word of the reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Direct => "direct",
            Self::Cg => "cg",
            Self::Bicgstab => "bicgstab",
        }
    }
}

/// How the linear system was solved, and how well.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LinearSolve {
    /// What gave the solution.
    pub method: Method,
    /// ‖b − Ax‖/‖b‖, the largest of all right sides.
    pub residual: f64,
    /// What the multigrid iteration did; `None` where there was none.
    pub iteration: Option<Iteration>,
    /// The iteration did not converge, and the direct solver gave the solution.
    pub fell_back: bool,
}

/// A multigrid iteration.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Iteration {
    /// Iterations, the most that a right side took.
    pub iterations: usize,
    /// Levels, the finest and the coarsest included.
    pub levels: usize,
    /// Entries of the matrices of all levels over those of the finest.
    pub operator_complexity: f64,
}
