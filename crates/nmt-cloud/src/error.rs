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
    /// A node is nearer to the boundary than its cloud's clearance.
    #[error("interior node at ({}, {}) is too near to the real boundary; remove it or lower the clearance", .at[0], .at[1])]
    TooNear {
        /// Where.
        at: Point,
    },
    /// Interior nodes and the sites they come from do not belong together.
    #[error("interior nodes are not each in the box of its own site; put the cloud together without sites")]
    OffSites,
    /// A graded cloud whose nodes do not each have a spacing.
    #[error("the nodes of a graded cloud do not each have a spacing within its bounds; generate it anew")]
    NoLocalSpacing,
    /// A cloud and a section that it was not generated from.
    #[error("the cloud has {n_vertices} vertices and the section {vertices}; give the section it was generated from")]
    OtherSection {
        /// Vertices of the section, as many as its edges.
        vertices: usize,
        /// Vertices of the cloud.
        n_vertices: usize,
    },
    /// A spacing that is below the bound, or no number.
    #[error("a spacing of {spacing:e} is not at least {least:.1e}, 1e-7 of the section's size; choose a larger one")]
    SpacingTooSmall {
        /// The spacing asked for, user's length unit.
        spacing: f64,
        /// The least one.
        least: f64,
    },
    /// A spacing function that is no spacing at a place of the section.
    #[error("the spacing is {value} at ({}, {}); it must be a positive number everywhere in the section", .at[0], .at[1])]
    NotASpacing {
        /// Where.
        at: Point,
        /// The value there.
        value: f64,
    },
    /// A graded cloud of more nodes than memory would bear.
    #[error(
        "with spacings down to {spacing:.1e} there would be more than {limit:.0e} nodes{place}; ask for larger ones, or let \
         them grow faster"
    )]
    TooFine {
        /// The least spacing asked for, user's length unit.
        spacing: f64,
        /// The most nodes allowed.
        limit: f64,
        /// Where: empty for the cloud, or ` on one edge`.
        place: &'static str,
    },
    /// A refinement along an edge that the section does not have.
    #[error("there is no edge {edge} to refine along; the section has {n_edges}, counted from 0")]
    NoSuchEdge {
        /// The edge's number.
        edge: usize,
        /// How many edges there are.
        n_edges: usize,
    },
    /// A parameter that belongs to uniform clouds.
    #[error("a graded cloud has no {parameter}; {remedy}")]
    NotGraded {
        /// What it is.
        parameter: &'static str,
        /// What to do.
        remedy: &'static str,
    },
    /// Interior nodes of another number than the cloud's.
    #[error("{given} interior nodes are given for a cloud that has {n_interior}; give one place for each")]
    OtherNumber {
        /// How many places.
        given: usize,
        /// How many nodes.
        n_interior: usize,
    },
    /// A cloud that was put together from parts does not know the edges its nodes could slide along.
    #[error("the cloud was not generated from a section; generate one to randomise it")]
    NotGenerated,
    /// The boundary's loops are malformed.
    #[error(transparent)]
    Boundary(#[from] GeomError),
}
