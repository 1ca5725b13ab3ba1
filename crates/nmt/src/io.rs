//! Files that other tools open: one format a file, written piece by piece to whatever takes bytes.

mod csv;
mod edges;
mod fields;
mod msh;
mod stars;
mod text;
mod vtu;

pub use csv::{csv_of_clouds, csv_of_solutions};
pub use edges::csv_of_edges;
pub use fields::NodeFields;
pub use msh::{msh_of_meshes, msh_of_solutions};
pub use stars::{StarArrays, stars_json};
pub use vtu::{vtu_of_meshes, vtu_of_solutions};
