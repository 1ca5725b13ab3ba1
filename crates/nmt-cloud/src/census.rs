//! Generated and deleted nodes by cause: the paper's text report as data.

/// What became of the grid points of (6); each of the causes is counted where the ones before it do not apply.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Census {
    /// Grid points generated: (N_x − 2)·(N_y − 2); of a graded cloud those that the spacing asks for, and what comes between.
    pub grid: usize,
    /// Deleted: not strictly inside the main contour.
    pub outside: usize,
    /// Deleted: in a hole or on its boundary.
    pub in_hole: usize,
    /// Deleted: too near to a segment of the real boundary (7)–(8).
    pub near_edge: usize,
    /// Deleted: too near to a boundary node (9), in a graded cloud for its neighbours farther inside too.
    pub near_node: usize,
    /// Left: the interior nodes.
    pub kept: usize,
}
