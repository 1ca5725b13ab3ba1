//! What can go wrong while a cloud is generated.

use nmt_curve::CurveError;
use nmt_geom::{GeomError, Point};

/// What can go wrong while a cloud of nodes is generated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CloudError {
    /// A parameter is out of its range.
    #[error("{parameter} = {value} is outside {range}; choose it from there")]
    Parameter {
        /// Its name in [`crate::CloudParams`].
        parameter: &'static str,
        /// The value given.
        value: f64,
        /// The allowed range.
        range: &'static str,
    },
    /// The contour has no extent along an axis.
    #[error("the contour is {width} wide and {height} high; give it an area")]
    NoExtent {
        /// Along x, user's length unit.
        width: f64,
        /// Along y.
        height: f64,
    },
    /// More grid points than memory would bear.
    #[error(
        "{} × {} grid points would take about {gigabytes:.0} GB; choose fewer than {limit:.0e}", .nodes[0], .nodes[1]
    )]
    TooManyNodes {
        /// N_x and N_y.
        nodes: [usize; 2],
        /// Memory of the grid, the nodes and what a solution needs.
        gigabytes: f64,
        /// The most grid points allowed.
        limit: f64,
    },
    /// An edge of the outline cannot be divided.
    #[error("edge {edge}: {source}")]
    Edge {
        /// Number of the edge: those of the contour first, then of each hole.
        edge: usize,
        /// Why.
        source: CurveError,
    },
    /// The polygon through the boundary nodes crosses or touches itself.
    #[error(
        "the polygon through the boundary nodes crosses itself near ({:.6}, {:.6}): too few nodes for the curves; {remedy}",
        .at[0], .at[1]
    )]
    BoundaryCrosses {
        /// Where.
        at: Point,
        /// The density that would do.
        remedy: String,
    },
    /// No grid point is left as an interior node.
    #[error("the cloud has no interior node; {remedy}")]
    NoInterior {
        /// The density that would give some.
        remedy: String,
    },
    /// A node that should be inside is not.
    #[error("interior node at ({}, {}) lies outside the real boundary; remove it", .at[0], .at[1])]
    InteriorOutside {
        /// Where.
        at: Point,
    },
    /// The boundary's loops are malformed.
    #[error(transparent)]
    Boundary(#[from] GeomError),
}
