//! Points, polygons, regions and the real boundary of a 2D section: the words that every nmt crate shares.
//!
//! ```text
//!   y ┌────────────────────┐      contour   the main loop; counter-clockwise once it is a real boundary
//!     │   ┌────┐           │      hole      a loop inside it; clockwise, so that the material is on the left
//!     │   │hole│  material │      edge      a piece of the outline that the user gave (line, arc, y = f(x))
//!     │   └────┘           │      segment   the straight piece between two neighbouring boundary nodes
//!     └────────────────────┘ x    size      diagonal of the envelope; tolerances are relative to it
//! ```
//!
//! Everything here is plain data and O(n log n) at most; orientation tests are exact.
//!
//! ```
//! use nmt_geom::{Location, Region};
//!
//! let tube = Region {
//!     contour: vec![[0.0, 0.0], [4.0, 0.0], [4.0, 3.0], [0.0, 3.0]],
//!     holes: vec![vec![[1.0, 1.0], [3.0, 1.0], [3.0, 2.0], [1.0, 2.0]]],
//! };
//! assert!(tube.faults(1e-9).is_empty());
//! let locator = tube.locator();
//! assert_eq!(locator.locate([0.5, 0.5]), Location::Inside);
//! assert_eq!(locator.locate([2.0, 1.5]), Location::Outside); // in the hole
//! assert_eq!(locator.locate([2.0, 1.0]), Location::OnBoundary); // exactly on its edge
//! ```

mod bbox;
mod boundary;
mod error;
mod ids;
mod locate;
pub mod point;
mod predicates;
mod region;
pub mod ring;
pub mod segment;
mod segment_index;
pub mod tol;

pub use bbox::Bbox;
pub use boundary::{BoundaryLoop, RealBoundary, Segment};
pub use error::GeomError;
pub use ids::{EdgeId, LoopId, NodeId, SubdomainId, TriId};
pub use locate::{Location, Locator};
pub use point::Point;
pub use predicates::{in_circle, side};
pub use region::{IndexedRegion, Region, RegionFault, overlap};
pub use segment_index::SegmentIndex;
