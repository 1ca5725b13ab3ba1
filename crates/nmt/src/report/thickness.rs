//! How many nodes lie across the thinnest part of a cloud.

use nmt_cloud::Cloud;
use nmt_geom::point::{along, cross, distance, dot, sub};
use nmt_geom::{LoopId, Point};

/// Fewer nodes across a part than this, both walls included, and its stresses mean little.
pub const FEWEST_ACROSS: usize = 4;

/// Walls whose directions differ by more than this cosine do not face each other.
const FACING_COSINE: f64 = -0.9;

/// The walls of a wedge meet in its corner: then the way along the boundary from one to the other is what their angle and
/// distance say, within this fraction. The walls of a strip, tapered or not, are joined by another way.
const CORNER_PATH_REL: f64 = 0.2;

/// Interior angles below this make a wedge, which is thin at its tip whatever the density; 60°.
const SHARP_ANGLE: f64 = std::f64::consts::FRAC_PI_3;

/// A part near the tip of a wedge is no thinner than this fraction of what its angle and the distance make it: curved
/// sides close up a little faster.
const TIP_REL: f64 = 0.4;

/// The thinnest part of a cloud.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThinSpot {
    /// Nodes across it, both walls included.
    pub nodes_across: usize,
    /// In the middle between the walls.
    pub at: Point,
}

/// The thinnest part with fewer than [`FEWEST_ACROSS`] nodes across, measured from the middle of each boundary segment
/// to the wall it faces; `None` where there is none.
pub fn thinnest(cloud: &Cloud) -> Option<ThinSpot> {
    let boundary = cloud.boundary();
    let index = boundary.index();
    let ends: Vec<[Point; 2]> = boundary.all_ends().collect();
    let lengths: Vec<f64> = ends.iter().map(|[a, b]| distance(*a, *b)).collect();
    let mut before = Vec::with_capacity(ends.len()); // length along its loop before each segment
    let mut loop_length = Vec::with_capacity(ends.len());
    for ring in 0..boundary.n_loops() {
        let count = boundary.loop_segments(LoopId::of(ring)).len();
        let total: f64 = lengths[before.len()..before.len() + count].iter().sum();
        let mut so_far = 0.0;
        for _ in 0..count {
            so_far += lengths[before.len()];
            before.push(so_far - lengths[before.len()]);
        }
        loop_length.extend(std::iter::repeat_n(total, count));
    }
    let sharp = sharp_vertices(cloud);
    let rates = Rates { cloud };
    let mut thinnest: Option<(f64, Point)> = None;
    for (k, [a, b]) in ends.iter().enumerate() {
        let direction = sub(*b, *a);
        let normal = [-direction[1] / lengths[k], direction[0] / lengths[k]]; // into the material
        let middle = along(*a, 0.5, direction);
        // Spacings that a unit step along the normal counts for.
        let rate = rates.at(k, normal);
        let reach = (FEWEST_ACROSS - 1) as f64 / rate * (1.0 - 1e-9);
        let mut nearest: Option<(f64, usize)> = None;
        index.candidates(middle, along(middle, reach, normal), 0.0, |other| {
            let Some(t) = hit(middle, normal, ends[other]) else { return };
            if other != k && t <= reach && nearest.is_none_or(|(best, _)| t < best) {
                nearest = Some((t, other));
            }
        });
        let Some((width, other)) = nearest else { continue };
        let facing = dot(direction, sub(ends[other][1], ends[other][0])) / (lengths[k] * lengths[other]);
        let same_loop = boundary.loop_of_segment(k) == boundary.loop_of_segment(other);
        let apart = (before[k] - before[other]).abs();
        let path = if same_loop { apart.min(loop_length[k] - apart) } else { f64::INFINITY };
        let sine = cross(direction, sub(ends[other][1], ends[other][0])).abs() / (lengths[k] * lengths[other]);
        let path_by_corner = width * (1.0 - facing) / sine;
        let side_of_a_corner = (path / path_by_corner - 1.0).abs() < CORNER_PATH_REL;
        // Where the spacing varies, it is taken half from either wall.
        let across = 0.5 * width * (rate + rates.at(other, normal));
        let tip = sharp.iter().any(|v| width > TIP_REL * v.slope * distance(middle, v.at));
        if facing < FACING_COSINE && !side_of_a_corner && !tip && thinnest.is_none_or(|(least, _)| across < least) {
            thinnest = Some((across, along(middle, width / 2.0, normal)));
        }
    }
    thinnest.map(|(across, at)| ThinSpot { nodes_across: ((across + 1e-9).floor() as usize).max(1) + 1, at })
}

/// How many spacings a length is.
struct Rates<'a> {
    cloud: &'a Cloud,
}

impl Rates<'_> {
    /// Spacings a unit of length along `normal` at a boundary segment.
    fn at(&self, segment: usize, normal: Point) -> f64 {
        let cloud = self.cloud;
        if cloud.is_graded() {
            return 1.0 / cloud.local_spacing(cloud.boundary().segments()[segment].from);
        }
        let [h_x, h_y] = cloud.spacing();
        (normal[0].abs() / h_x).max(normal[1].abs() / h_y)
    }
}

/// A vertex of the outline whose sides meet at an acute angle.
struct SharpVertex {
    at: Point,
    slope: f64, // width of the wedge over the distance from its tip
}

fn sharp_vertices(cloud: &Cloud) -> Vec<SharpVertex> {
    let boundary = cloud.boundary();
    let mut sharp = Vec::new();
    for ring in 0..boundary.n_loops() {
        let segments = boundary.loop_segments(LoopId::of(ring));
        for (k, s) in segments.iter().enumerate().filter(|(_, s)| s.from.index() < cloud.n_vertices()) {
            let [at, next] = boundary.ends(s);
            let [before, _] = boundary.ends(&segments[(k + segments.len() - 1) % segments.len()]);
            let (to_next, to_last) = (sub(next, at), sub(before, at));
            let angle = cross(to_next, to_last).atan2(dot(to_next, to_last));
            if angle > 0.0 && angle < SHARP_ANGLE {
                sharp.push(SharpVertex { at, slope: angle.tan() });
            }
        }
    }
    sharp
}

/// Distance along the ray from `p` to the segment; `None` where it misses.
fn hit(p: Point, direction: Point, [a, b]: [Point; 2]) -> Option<f64> {
    let (v, to_a) = (sub(b, a), sub(a, p));
    let denominator = cross(direction, v);
    let (t, s) = (cross(to_a, v) / denominator, cross(to_a, direction) / denominator);
    (t > 0.0 && (0.0..=1.0).contains(&s)).then_some(t)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nmt_cloud::{CloudParams, Section, generate};
    use nmt_curve::Outline;

    fn thin(section: &Section, nodes: [usize; 2]) -> Option<usize> {
        let cloud = generate(section, &CloudParams { nodes, ..CloudParams::default() });
        thinnest(&cloud.expect("a cloud")).map(|spot| spot.nodes_across)
    }

    #[test]
    fn a_wall_of_two_spacings_has_three_nodes_across() {
        let tube = |wall: f64| Section {
            contour: Outline::rectangle([0.0, 0.0], [4.0, 2.0]),
            holes: vec![Outline::rectangle([wall, wall], [4.0 - wall, 2.0 - wall])],
        };
        assert_eq!(thin(&tube(0.1), [81, 41]), Some(3));
        assert_eq!(thin(&tube(0.2), [81, 41]), None);
    }

    #[test]
    fn corners_are_not_thin() {
        let triangle = Section::solid(Outline::polygon(vec![[0.0, 0.0], [4.0, 0.0], [0.0, 1.0]]));
        assert_eq!(thin(&triangle, [41, 21]), None);
        assert_eq!(thin(&Section::solid(Outline::rectangle([0.0, 0.0], [1.0, 1.0])), [4, 4]), None);
        assert_eq!(thin(&Section::solid(Outline::rectangle([0.0, 0.0], [1.0, 1.0])), [9, 3]), Some(3));
    }
}
