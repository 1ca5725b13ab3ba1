//! Clouds of nodes, regular or randomly irregular, on a 2D section with holes and curved edges.
//!
//! A cloud begins with the vertices of the outline, goes on with nodes along its edges, evenly by arc length, and ends
//! with the points of a background grid that are inside and clear of the boundary; an irregular cloud then slides its
//! edge nodes along their edges and moves its interior nodes at random, by a counter-based generator, so that one seed
//! gives one cloud everywhere. After S. Milewski's nodes_mesh_tool; \[D3\] … are the points where nmt departs from it.
//!
//! ```
//! use nmt_cloud::{CloudParams, NodeKind, Section, generate};
//! use nmt_curve::Outline;
//! use nmt_geom::NodeId;
//!
//! let tube = Section {
//!     contour: Outline::rectangle([0.0, 0.0], [2.0, 2.0]),
//!     holes: vec![Outline::circle([1.0, 1.0], 0.5)],
//! };
//! let params = CloudParams { nodes: [21, 21], irregularity: 0.25, ..CloudParams::default() };
//! let cloud = generate(&tube, &params)?;
//! assert_eq!(cloud.kind(NodeId(0)), NodeKind::Vertex);
//! assert_eq!(cloud.census().grid, 19 * 19);
//! assert_eq!(cloud.census().kept, cloud.n_interior());
//! # Ok::<(), nmt_cloud::CloudError>(())
//! ```

mod boundary;
mod census;
mod clearance;
mod cloud;
mod error;
mod even;
mod generate;
mod graded;
mod grading;
mod gradual;
mod irregular;
mod lattice;
mod nearest;
mod nested;
mod quality;
mod section;
mod sources;
mod sow;
mod spacing;

pub use boundary::{Closing, segment_counts};
pub use census::Census;
pub use clearance::Clearance;
pub use cloud::{Cloud, NodeEdges, NodeKind};
pub use error::CloudError;
pub use generate::{BYTES_PER_GRID_POINT, MAX_GRID_POINTS, generate, generate_with, randomise};
pub use grading::{DEFAULT_GROWTH, Grading, MAX_GROWTH, MIN_SPACING_REL, Refinement, SpacingFunction, Target};
pub use irregular::Displacements;
pub use lattice::Lattice;
pub use nearest::{Nearest, Scratch, TIE_REL};
pub use nested::NestedLattice;
pub use quality::{Achieved, CloudQuality, quality};
pub use section::{ClearanceUnit, CloudParams, DEFAULT_SEED, GivenNode, Section};
pub use spacing::Spacing;
