//! Vertices where the exact stress is infinite.

use nmt_cloud::Section;
use nmt_geom::{Point, ring};
use std::f64::consts::{PI, TAU};

/// Interior angles above this make τ infinite; a degree more than straight, so that the seam of two tangent arcs, whose
/// directions are computed, is none.
const SINGULAR_ANGLE: f64 = 181.0 / 180.0 * PI;

/// Points of an outline polygon that decide its orientation: chords to 1e-3 of its size.
const ORIENTATION_TOLERANCE_REL: f64 = 1.0e-3;

/// The vertices of all outlines whose interior angle, between the edge tangents and through the material, exceeds 181°;
/// never nodes of a curve.
pub fn singular_vertices(section: &Section) -> Vec<Point> {
    vertex_angles(section).into_iter().filter(|(_, angle)| *angle > SINGULAR_ANGLE).map(|(at, _)| at).collect()
}

/// The vertices of all outlines with their interior angles, between the edge tangents and through the material.
pub(crate) fn vertex_angles(section: &Section) -> Vec<(Point, f64)> {
    let mut angles = Vec::new();
    for (k, outline) in section.loops().enumerate() {
        let flat = outline.flatten(ORIENTATION_TOLERANCE_REL * outline.envelope().size());
        let left_is_inside = ring::signed_area(&flat) > 0.0;
        let material_on_left = left_is_inside == (k == 0);
        for (vertex, &at) in outline.vertices.iter().enumerate() {
            let left = outline.interior_angle(vertex);
            angles.push((at, if material_on_left { left } else { TAU - left }));
        }
    }
    angles
}
