//! What can go wrong while a problem is solved.

use nmt_geom::Point;

/// What can go wrong while a boundary value problem is solved.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MfdmError {
    /// A star is smaller than its polynomial needs or larger than the cloud.
    #[error(
        "a star of {star} nodes cannot carry a polynomial of order {order} on a cloud of {n_nodes} nodes; \
         choose between {least} and {n_nodes}"
    )]
    StarSize {
        /// The size asked for.
        star: usize,
        /// The order.
        order: usize,
        /// Number of monomials.
        least: usize,
        /// Nodes of the cloud.
        n_nodes: usize,
    },
    /// The order has no default star or cannot be used.
    #[error("order {order} is not available in the {formulation} formulation; choose {least} to 4")]
    Order {
        /// The order asked for.
        order: usize,
        /// The formulation's name.
        formulation: &'static str,
        /// The least order it has.
        least: usize,
    },
    /// There is no Gauss rule of so many points.
    #[error("there is no Gauss rule of {points} points; choose 1, 3, 4, 6, 7 or 12")]
    Gauss {
        /// The number asked for.
        points: usize,
    },
    /// The smoothing g is out of range.
    #[error("a smoothing of {g} is out of range; choose 0, which interpolates, to 1")]
    Smoothing {
        /// The value.
        g: f64,
    },
    /// Fluxes alone determine the solution only to a constant.
    #[error("no edge has a value given, only fluxes: the solution is determined to a constant; give one edge a value")]
    NoValue,
    /// A datum of the problem is not finite.
    #[error("the {quantity} is {value} at ({}, {}); restrict it to what is finite on the section", .at[0], .at[1])]
    Datum {
        /// Which.
        quantity: &'static str,
        /// Where.
        at: Point,
        /// The value.
        value: f64,
    },
    /// An edge of the section has no length.
    #[error("an edge of the section cannot be measured: {source}")]
    Curve {
        /// What is wrong with it.
        source: nmt_curve::CurveError,
    },
    /// A cloud was put together without its edges' arc lengths.
    #[error("the cloud does not know where its nodes lie along their edges; generate it from the section")]
    EdgesUnknown,
    /// A section and a mesh do not belong together.
    #[error("the cloud has {found} edges on its boundary and the problem {given}; give each edge its condition")]
    Conditions {
        /// Edges of the cloud's boundary.
        found: usize,
        /// Conditions given.
        given: usize,
    },
    /// Too few visible nodes about a place carry no polynomial.
    #[error(
        "the star of ({}, {}) cannot carry a polynomial of order {order}, even with {tried} nodes; \
         give this part of the section more nodes, or choose trial = \"blended\"",
        .at[0], .at[1]
    )]
    PoorPlace {
        /// The place.
        at: Point,
        /// The order.
        order: usize,
        /// Nodes in the largest star tried.
        tried: usize,
    },
    /// A material or load constant is not usable.
    #[error("{quantity} = {value} must be a finite number other than 0")]
    Constant {
        /// Which.
        quantity: &'static str,
        /// The value.
        value: f64,
    },
    /// Too few visible nodes about a point carry no polynomial.
    #[error(
        "the star of node {node} at ({}, {}) cannot carry a polynomial of order {order}, even with {tried} nodes; \
         give this part of the section more nodes",
        .at[0], .at[1]
    )]
    PoorStar {
        /// The node.
        node: usize,
        /// Where it is.
        at: Point,
        /// The least order that would do.
        order: usize,
        /// Nodes in the largest star tried.
        tried: usize,
    },
    /// The factorisation met a zero pivot.
    #[error("the system of {n} equations is singular; use more nodes, or another seed")]
    Singular {
        /// Number of unknowns.
        n: usize,
    },
    /// The solver's answer does not satisfy the equations.
    #[error(
        "the solution of {n} equations leaves a relative residual of {residual:.1e}, above {limit:.0e}; use more nodes"
    )]
    Residual {
        /// Number of unknowns.
        n: usize,
        /// ‖b − Ax‖/‖b‖.
        residual: f64,
        /// The largest one allowed.
        limit: f64,
    },
    /// The factorisation does not fit into memory.
    #[error("the factorisation of {n} equations does not fit into memory; use fewer nodes")]
    Memory {
        /// Number of unknowns.
        n: usize,
    },
}
