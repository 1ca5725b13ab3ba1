//! Common edges of adjacent subdomains, nodes that both sides share, and one mesh of all.
//!
//! ```text
//!   ┌───────────┐\
//!   │ subdomain │ \         a common edge   the part where an outline edge of one subdomain runs along one of another
//!   │     0     │1 \        its nodes       those of both sides; they need not coincide
//!   └───────────┴───┘
//! ```
//!
//! [`common_edges`] finds them for every pair of subdomains: the whole of two edges, a part of them, or the boundary of
//! a hole that another subdomain fills; straight or curved, whatever form each side gives its curve in.
//! [`conform`] makes nodes for both sides of a common edge before the clouds are generated, and [`weld`] joins the meshes of
//! such clouds to one.
//!
//! ```
//! use nmt_cloud::{CloudParams, Section, generate};
//! use nmt_curve::Outline;
//! use nmt_merge::{Side, common_edges};
//!
//! let square = Section::solid(Outline::rectangle([0.0, 0.0], [2.0, 2.0]));
//! let triangle = Section::solid(Outline::polygon([[2.0, 0.0], [4.0, 0.0], [2.0, 2.0]]));
//! let coarse = generate(&square, &CloudParams { nodes: [5, 5], ..CloudParams::default() })?;
//! let fine = generate(&triangle, &CloudParams { nodes: [9, 9], ..CloudParams::default() })?;
//!
//! let sides = [Side { section: &square, cloud: &coarse }, Side { section: &triangle, cloud: &fine }];
//! let common = common_edges(&sides);
//! assert_eq!(common.len(), 1);
//! assert_eq!(common[0].names, ["e2", "e3"]);
//! assert_eq!([common[0].from, common[0].to], [[2.0, 0.0], [2.0, 2.0]]);
//! assert_eq!(common[0].nodes.each_ref().map(Vec::len), [5, 9]);
//! # Ok::<(), nmt_cloud::CloudError>(())
//! ```

mod coincide;
mod common_edges;
mod conform;
mod error;
mod overlap;
mod track;
mod weld;

pub use common_edges::{CommonEdge, Side, common_edges};
pub use conform::{EdgeNodes, Planned, conform};
pub use error::MergeError;
pub use weld::{Interface, MeshSide, OuterSegment, Welded, weld, weld_at};
