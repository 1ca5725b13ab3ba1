//! What can go wrong where subdomains meet.

use nmt_curve::CurveError;
use nmt_geom::{EdgeId, Point, SubdomainId};

/// What can go wrong where subdomains meet.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MergeError {
    /// A subdomain whose spacing is none somewhere.
    #[error("subdomain {}: {source}", .subdomain.0)]
    Spacing {
        /// The subdomain.
        subdomain: SubdomainId,
        /// Why.
        source: nmt_cloud::CloudError,
    },
    /// An edge has no length to divide.
    #[error("edge {} of subdomain {} cannot be divided; correct it", .edge.0, .subdomain.0)]
    Edge {
        /// The subdomain.
        subdomain: SubdomainId,
        /// The edge.
        edge: EdgeId,
        /// Why.
        source: CurveError,
    },
    /// A node on a common edge has no node of the other side at its place.
    #[error(
        "node {node} of subdomain \"{subdomain}\" at ({}, {}), on its common edge with subdomain \"{neighbour}\", has no \
         node of that at its place; give one of the two `conforming = true`",
        .at[0], .at[1]
    )]
    Apart {
        /// Name of the subdomain whose node it is.
        subdomain: String,
        /// Name of the other.
        neighbour: String,
        /// The node, counted from 0.
        node: usize,
        /// Where it is.
        at: Point,
    },
    /// A triangle of a welded mesh has no area.
    #[error("triangle {triangle} of the welded mesh has the area {area:e}; its nodes are too near to each other")]
    FlatTriangle {
        /// The triangle.
        triangle: usize,
        /// Its signed area.
        area: f64,
    },
    /// The welded mesh does not fill what its parts do.
    #[error("the welded triangles' areas sum to {sum}, those of the parts to {area}")]
    Area {
        /// Sum of the triangles' areas.
        sum: f64,
        /// Sum over the parts.
        area: f64,
    },
    /// An edge of a welded mesh belongs to more or fewer triangles than it must.
    #[error(
        "the edge between nodes {} and {} of the welded mesh belongs to {found} triangles instead of {expected}",
        .nodes[0], .nodes[1]
    )]
    MeshEdge {
        /// Its nodes.
        nodes: [usize; 2],
        /// Triangles found at it.
        found: usize,
        /// One on the outer boundary, two inside.
        expected: usize,
    },
}
