//! Meshes for tests, on the sections of the tests of nmt-cloud.

#[path = "../../../nmt-cloud/tests/cloud/sections.rs"]
mod shapes;

use nmt_cloud::{CloudParams, Section};
use nmt_curve::Outline;
use nmt_tri::Mesh;
pub use shapes::*;

/// A mesh that has passed its own check, on a cloud that has passed its own.
pub fn mesh(section: &Section, params: &CloudParams) -> Mesh {
    let mesh = Mesh::constrained(cloud(section, params)).expect("every generated cloud has a mesh");
    assert_eq!(mesh.check(), Ok(()));
    mesh
}

/// The plate with a slot that narrows to 0.06 at its mouth, meshed with spacings of half a unit.
pub fn narrow_slot() -> Section {
    Section::solid(Outline::polygon([
        [0.0, 0.0],
        [4.0, 0.0],
        [4.0, 1.0],
        [0.5, 1.0],
        [0.5, 1.06],
        [3.7, 1.1],
        [3.7, 2.0],
        [0.0, 2.0],
    ]))
}
