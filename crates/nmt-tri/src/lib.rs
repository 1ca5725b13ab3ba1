//! Triangular meshes of exactly the nodes of a given cloud: none added, none lost.
//!
//! The default is Delaunay with the real boundary as constraints, cut to the material. Ties (four nodes on one
//! circle, which is every cell of a regular cloud) are settled by node numbers, so that a section in millimetres and in
//! kilometres has the same triangles. The paper's own way, Delaunay without the boundary, elimination and completion, is
//! [`Mesh::unconstrained`].
//!
//! ```
//! use nmt_cloud::{CloudParams, Section, generate};
//! use nmt_curve::Outline;
//! use nmt_tri::{Mesh, quality};
//!
//! let ring = Section { contour: Outline::circle([0.0, 0.0], 1.0), holes: vec![Outline::circle([0.0, 0.0], 0.5)] };
//! let cloud = generate(&ring, &CloudParams { nodes: [21, 21], ..CloudParams::default() })?;
//! let mesh = Mesh::constrained(cloud)?;
//! mesh.check()?;
//! assert!(quality(&mesh).is_some_and(|q| q.min > 0.3));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod adjacency;
mod carve;
mod complete;
mod delaunay;
mod eliminate;
mod error;
mod lattice;
mod locate;
mod mesh;
mod order;
mod quality;
mod smooth;
mod ties;
mod unconstrained;

pub use adjacency::{MeshEdge, NodeTris, edges};
pub use error::MeshError;
pub use locate::{TriangleIndex, barycentric};
pub use mesh::Mesh;
pub use quality::{Quality, quality, shape};
pub use smooth::smooth;
pub use unconstrained::{Elimination, MeshCensus, Stages, stages};
