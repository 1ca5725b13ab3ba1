//! Formulas, arcs and lines to evenly spaced nodes on an outline.
//!
//! An [`Outline`] is a closed path of [`Curve`]s between vertices: straight lines, graphs `y = f(x)`, arcs, ellipses
//! and parametric curves, the last given by an [`Expression`]. This crate answers what the generator of nodes asks
//! about them:
//!
//! * is it a curve at all, and does it meet its vertices? [`Curve::faults`], [`Outline::faults`]
//! * how long is it? [`arc_length`], paper (3)–(4) \[D2\]
//! * where is the point at a given arc length? [`ArcTable`]
//! * how many nodes does it get? [`node_count`], paper (2) \[D4\]
//! * where do they lie? [`divide()`], [`divide_by_chords`] \[D3\]; where their spacing varies, [`SpacingTable`]
//!
//! All tolerances are relative: a section in micrometres and the same in kilometres get the same nodes.
//!
//! ```
//! use nmt_curve::{ArcLengthParams, Curve, Expression, arc_length, divide, node_count};
//!
//! // Half a circle, with vertical tangents at both ends.
//! let y = Expression::parse("sqrt(1 - x^2)", &["x"])?;
//! let arch = Curve::Graph { y, from_x: 1.0, to_x: -1.0 };
//! assert_eq!(arch.faults([1.0, 0.0], [-1.0, 0.0], 2.2), []);
//!
//! let measured = arc_length(&arch, &ArcLengthParams::default());
//! assert!(measured.converged && measured.intervals <= 1000);
//! assert!((measured.length / std::f64::consts::PI - 1.0).abs() < 1e-6);
//!
//! // Twenty nodes for each unit of x or y, whichever of the two needs more, piece by piece.
//! assert_eq!(node_count(&arch, [20.0, 20.0]), 57);
//! let nodes = divide(&arch, 7)?;
//! assert!((nodes[1][1] - 0.5).abs() < 1e-9); // 30 degrees
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod arc_length;
mod arc_table;
mod bisection;
mod chords;
mod count;
mod curve;
mod divide;
mod error;
mod expression;
mod graded;
mod jump;
mod outline;
mod subdivision;

pub use arc_length::{ArcLength, ArcLengthParams, arc_length};
pub use arc_table::ArcTable;
pub use count::{CLOSED_NODES_LEAST, CURVED_NODES_LEAST, STRAIGHT_NODES_LEAST, node_count};
pub use curve::{Curve, Turn};
pub use divide::{Division, EdgeNodes, MAX_NODES_ON_EDGE, divide, divide_by_chords};
pub use error::{CurveEnd, CurveError};
pub use expression::{Expression, ExpressionError, Jet, MAX_FORMULA_BYTES, MAX_FORMULA_NESTING};
pub use graded::SpacingTable;
pub use outline::{Outline, OutlineEdge, OutlineFault};
