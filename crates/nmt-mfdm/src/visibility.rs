//! Which nodes see each other: stars must not reach across holes and slits \[D10\].

use nmt_cloud::Cloud;
use nmt_geom::point::{cross, distance, dot, lerp, sub};
use nmt_geom::tol::SAME_POINT_REL;
use nmt_geom::{Bbox, Location, LoopId, NodeId, Point, RealBoundary, SegmentIndex, segment};

/// A pair of nodes is hidden where the middle between them is outside by more than this fraction of max(h_x, h_y), or of the
/// smaller spacing of the two.
const OUTSIDE_FRACTION: f64 = 0.25;

/// Of two boundary nodes with the outside between them, the way along the boundary is at most this many times their
/// distance.
///
/// It is π/2 across a circle; opposite walls of a slit have twice the way to its end, over the width of the slit.
const MAX_DETOUR: f64 = 1.6;

/// Sine below which a line through a boundary node runs along one of its segments rather than into the outside.
///
/// Segments of a curve turn by their length over its radius, 1e-3 and more; rounding is 1e-9 of the spacing.
const ALONG_SINE: f64 = 1.0e-6;

/// Answers whether two nodes of a cloud see each other through the material.
#[derive(Clone, Debug)]
pub struct Visibility {
    segments: SegmentIndex,
    n_boundary: usize,
    margin: f64,              // user's length unit
    spacings: Vec<f64>,       // of the boundary nodes
    places: Vec<Place>,       // of the boundary nodes
    corners: Vec<[Point; 2]>, // at the first node of each segment: directions to the next and to the last node
}

impl Visibility {
    /// Indexes the real boundary of `cloud`.
    pub fn new(cloud: &Cloud) -> Self {
        let boundary = cloud.boundary();
        Self {
            segments: boundary.index().clone(),
            n_boundary: cloud.n_boundary(),
            margin: SAME_POINT_REL * cloud.size(),
            spacings: (0..cloud.n_boundary()).map(|node| cloud.local_spacing(NodeId::of(node))).collect(),
            places: places(boundary),
            corners: corners(boundary),
        }
    }

    /// True where no segment comes within `radius` of `p`: everything in there sees everything.
    pub fn all_within(&self, p: Point, radius: f64) -> bool {
        !self.segments.any_within(p, radius)
    }

    /// True where the node `other` is visible from the node `centre`.
    ///
    /// Hidden is what lies behind a segment of the real boundary (each pair of ends on opposite sides by more than
    /// 1e-9 of the size), or behind a boundary node through which the line enters the outside; and of two boundary
    /// nodes, those whose middle lies outside the material by more than a quarter of the spacing.
    pub fn sees(&self, xy: &[Point], centre: NodeId, other: NodeId) -> bool {
        if centre == other {
            return true;
        }
        let (p, q) = (xy[centre.index()], xy[other.index()]);
        if self.blocked(p, q) {
            return false;
        }
        let both_on_boundary = centre.index() < self.n_boundary && other.index() < self.n_boundary;
        !(both_on_boundary && self.outside_between(xy, centre, other))
    }

    /// True where `node` is visible from a place within the material that is none.
    pub fn sees_from(&self, at: Point, node: Point) -> bool {
        !self.blocked(at, node)
    }

    /// True where the open segment `p q` crosses the real boundary, at a segment or at a node between two of them.
    fn blocked(&self, p: Point, q: Point) -> bool {
        let direction = sub(q, p);
        let back = [-direction[0], -direction[1]];
        self.segments.any_in(&Bbox::of([p, q]).grown([self.margin; 2]), |k| {
            let [a, b] = self.segments.segment(k);
            if segment::cross_properly(p, q, a, b, self.margin) {
                return true;
            }
            let [to_next, to_last] = self.corners[k];
            self.is_between(a, p, q)
                && (leaves_material(direction, to_next, to_last) || leaves_material(back, to_next, to_last))
        })
    }

    /// True where `node` lies on the segment `p q`, away from its ends.
    fn is_between(&self, node: Point, p: Point, q: Point) -> bool {
        segment::distance_to(node, p, q) <= self.margin
            && distance(node, p) > self.margin
            && distance(node, q) > self.margin
    }

    /// True where the outside between two boundary nodes parts them: the middle lies deep in it, or the way along the
    /// boundary is a detour.
    fn outside_between(&self, xy: &[Point], centre: NodeId, other: NodeId) -> bool {
        let (p, q) = (xy[centre.index()], xy[other.index()]);
        let middle = lerp(p, q, 0.5);
        if self.segments.locate(middle) != Location::Outside {
            return false;
        }
        let (a, b) = (self.places[centre.index()], self.places[other.index()]);
        let along = (a.s - b.s).abs();
        let way = along.min(a.perimeter - along);
        let detour = a.ring != b.ring || way > MAX_DETOUR * distance(p, q) + self.margin;
        let spacing = self.spacings[centre.index()].min(self.spacings[other.index()]);
        detour || !self.segments.any_within(middle, OUTSIDE_FRACTION * spacing)
    }
}

/// Where a boundary node lies along its loop.
#[derive(Clone, Copy, Debug, Default)]
struct Place {
    ring: usize,
    s: f64,         // user's length unit
    perimeter: f64, // of the loop
}

fn places(boundary: &RealBoundary) -> Vec<Place> {
    let mut places = vec![Place::default(); boundary.xy().len()];
    for ring in 0..boundary.n_loops() {
        let segments = boundary.loop_segments(LoopId::of(ring));
        let length = |[a, b]: [Point; 2]| distance(a, b);
        let perimeter = segments.iter().map(|s| length(boundary.ends(s))).sum();
        let mut s = 0.0;
        for segment in segments {
            places[segment.from.index()] = Place { ring, s, perimeter };
            s += length(boundary.ends(segment));
        }
    }
    places
}

/// Directions from the first node of each segment to its neighbours along the loop: the next one and the last one.
fn corners(boundary: &RealBoundary) -> Vec<[Point; 2]> {
    let mut corners = Vec::with_capacity(boundary.segments().len());
    for ring in 0..boundary.n_loops() {
        let segments = boundary.loop_segments(LoopId::of(ring));
        for (k, s) in segments.iter().enumerate() {
            let last = &segments[(k + segments.len() - 1) % segments.len()];
            let ([at, next], [before, _]) = (boundary.ends(s), boundary.ends(last));
            corners.push([sub(next, at), sub(before, at)]);
        }
    }
    corners
}

/// True where `direction` points out of the material at a corner, whose material spans counter-clockwise from `to_next`
/// to `to_last`; along either of them is not out.
fn leaves_material(direction: Point, to_next: Point, to_last: Point) -> bool {
    let sine = |u: Point, v: Point| cross(u, v) / (dot(u, u) * dot(v, v)).sqrt();
    let right_of_next = sine(to_next, direction) < -ALONG_SINE;
    let left_of_last = sine(to_last, direction) > ALONG_SINE;
    let reflex = cross(to_next, to_last) < 0.0;
    if reflex { right_of_next && left_of_last } else { right_of_next || left_of_last }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nmt_cloud::Census;
    use nmt_geom::{BoundaryLoop, EdgeId};

    /// A square of side 4 with a square hole of side 1 in its middle; node 8 and up are interior.
    fn holed(interior: Vec<Point>) -> Cloud {
        let xy = vec![[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0], [1.5, 1.5], [2.5, 1.5], [2.5, 2.5], [1.5, 2.5]];
        let ring = |first: u32| BoundaryLoop {
            nodes: (first..first + 4).map(NodeId).collect(),
            edges: (first..first + 4).map(EdgeId).collect(),
        };
        let boundary = RealBoundary::new(xy, vec![ring(0), ring(4)]).expect("two loops of four nodes");
        Cloud::from_parts(boundary, 8, interior, [1.0, 1.0], Census::default())
    }

    fn sees(p: Point, q: Point) -> bool {
        let cloud = holed(vec![p, q]);
        Visibility::new(&cloud).sees(cloud.xy(), NodeId(8), NodeId(9))
    }

    #[test]
    fn a_hole_hides_what_lies_behind_it() {
        assert!(!sees([1.0, 2.0], [3.0, 2.0]));
        assert!(sees([1.0, 1.0], [3.0, 1.0]));
    }

    #[test]
    fn a_line_through_two_opposite_corners_of_a_hole_is_blocked() {
        assert!(!sees([1.0, 1.0], [3.0, 3.0]));
        assert!(!sees([1.0, 3.0], [3.0, 1.0]));
    }

    #[test]
    fn touching_a_corner_or_running_along_a_segment_hides_nothing() {
        assert!(sees([1.0, 2.0], [2.0, 1.0])); // through (1.5, 1.5), material on both sides
        assert!(sees([1.0, 1.5], [3.0, 1.5])); // along the hole's lower side
    }

    #[test]
    fn boundary_nodes_across_the_hole_do_not_see_each_other() {
        let cloud = holed(vec![]);
        let visibility = Visibility::new(&cloud);
        assert!(!visibility.sees(cloud.xy(), NodeId(4), NodeId(6)));
        assert!(visibility.sees(cloud.xy(), NodeId(4), NodeId(5)));
        assert!(visibility.sees(cloud.xy(), NodeId(0), NodeId(4)));
    }
}
