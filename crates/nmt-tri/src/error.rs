//! What can go wrong while a mesh is made.

use nmt_geom::Point;

/// What can go wrong while a cloud is triangulated, or with a mesh that is checked.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// Two nodes are at one place.
    #[error("nodes {} and {} are both at ({}, {}); remove one", .nodes[0], .nodes[1], .at[0], .at[1])]
    SameNode {
        /// The two nodes.
        nodes: [usize; 2],
        /// Where they are.
        at: Point,
    },
    /// A segment of the real boundary is crossed by another or passes through a node.
    #[error(
        "the boundary segment from node {} at ({}, {}) to node {} at ({}, {}) is no edge of the mesh: another segment \
         crosses it or a node lies on it; move that node or give the outline more nodes",
        .nodes[0], .from[0], .from[1], .nodes[1], .to[0], .to[1]
    )]
    BareSegment {
        /// Its nodes.
        nodes: [usize; 2],
        /// Where it begins.
        from: Point,
        /// Where it ends.
        to: Point,
    },
    /// The triangulation refused a coordinate.
    #[error("node {node} at ({}, {}) cannot be triangulated; use coordinates below 1e100 of the size", .at[0], .at[1])]
    Coordinate {
        /// The node.
        node: usize,
        /// Its coordinates.
        at: Point,
    },
    /// A triangle's area is not positive.
    #[error("triangle {triangle} (nodes {}, {}, {}) has the area {area:e}; its nodes lie on one line", .nodes[0], .nodes[1], .nodes[2])]
    FlatTriangle {
        /// The triangle.
        triangle: usize,
        /// Its nodes.
        nodes: [usize; 3],
        /// Its signed area.
        area: f64,
    },
    /// The triangles do not fill the polygon.
    #[error("the triangles' areas sum to {sum}, the real boundary encloses {area}")]
    Area {
        /// Sum of the triangles' areas.
        sum: f64,
        /// Area of the polygon.
        area: f64,
    },
    /// An edge belongs to more or fewer triangles than it must.
    #[error("the edge between nodes {} and {} belongs to {found} triangles instead of {expected}", .nodes[0], .nodes[1])]
    Edge {
        /// Its nodes.
        nodes: [usize; 2],
        /// Triangles found at it.
        found: usize,
        /// One for a segment of the real boundary, two inside.
        expected: usize,
    },
    /// V − E + T is not 1 − holes.
    #[error("V − E + T = {found} instead of {expected}")]
    Euler {
        /// What was found.
        found: i64,
        /// 1 − holes.
        expected: i64,
    },
    /// A node is in no triangle.
    #[error("node {node} at ({}, {}) is in no triangle", .at[0], .at[1])]
    LostNode {
        /// The node.
        node: usize,
        /// Where it is.
        at: Point,
    },
}
