//! What can go wrong with a boundary.

use crate::point::Point;

/// What can go wrong when a real boundary is put together.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GeomError {
    /// A loop of fewer than three nodes encloses nothing.
    #[error("loop {ring} of the boundary has {n_nodes} nodes; give at least 3")]
    LoopTooShort {
        /// The loop: 0 is the main contour.
        ring: usize,
        /// How many it has.
        n_nodes: usize,
    },
    /// A loop names a node that has no coordinates.
    #[error("loop {ring} names node {node}, but there are {n_nodes} boundary nodes; number them from 0")]
    NoSuchNode {
        /// The loop.
        ring: usize,
        /// The number found.
        node: u32,
        /// How many there are.
        n_nodes: usize,
    },
    /// A loop has nodes and edges of different number.
    #[error("loop {ring} has {n_nodes} nodes and {n_edges} segment edges; give one edge for each segment")]
    EdgesMissing {
        /// The loop.
        ring: usize,
        /// Its nodes.
        n_nodes: usize,
        /// The edges given.
        n_edges: usize,
    },
    /// A coordinate is NaN or infinite.
    #[error("boundary node {node} is at ({}, {}); coordinates must be finite", .at[0], .at[1])]
    NotFinite {
        /// The node.
        node: usize,
        /// Its coordinates.
        at: Point,
    },
}
