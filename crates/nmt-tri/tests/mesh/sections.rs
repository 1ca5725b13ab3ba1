//! Meshes for tests, on the sections of the tests of nmt-cloud.

#[path = "../../../nmt-cloud/tests/cloud/sections.rs"]
mod shapes;

use nmt_cloud::{CloudParams, Section};
use nmt_tri::Mesh;
pub use shapes::*;

/// A mesh that has passed its own check, on a cloud that has passed its own.
pub fn mesh(section: &Section, params: &CloudParams) -> Mesh {
    let mesh = Mesh::constrained(cloud(section, params)).expect("every generated cloud has a mesh");
    assert_eq!(mesh.check(), Ok(()));
    mesh
}
