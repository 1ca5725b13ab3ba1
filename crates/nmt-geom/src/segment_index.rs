//! A tree of boxes over segments: which are near, which are crossed, where a point lies.

use crate::bbox::Bbox;
use crate::locate::{Crossing, Location, ray_crossing};
use crate::point::Point;
use crate::segment;

/// Consecutive segments in a leaf: along a polygon they lie together, so that only every fourth has to be sorted.
const LEAF: usize = 4;

/// Boxes are looked up with this much room, as a fraction of the coordinates: a segment exactly at a distance that is
/// asked for must not be missed by rounding.
const ROOM_REL: f64 = 1.0e-14;

/// Finds the segments near a point or a line in O(log n), whatever their lengths and however unevenly they lie.
///
/// Segments that follow each other should lie near each other, as along a polygon.
#[derive(Clone, Debug, PartialEq)]
pub struct SegmentIndex {
    segments: Vec<[Point; 2]>,
    boxes: Vec<TreeBox>, // depth first: a box, what is in its first half, what is in its second half
    envelope: Bbox,
    room: f64,
    upright_rays: bool, // rays along y cross fewer segments than rays along x
}

/// A box of the tree.
#[derive(Clone, Copy, Debug, PartialEq)]
struct TreeBox {
    envelope: Bbox,
    after: u32, // the box to go on with where this one is passed over
    first: u32, // segment of a leaf
    count: u32, // segments in a leaf, 0 in an inner box
}

impl SegmentIndex {
    /// Indexes `segments`; they keep their numbers 0, 1, …. O(n log n).
    pub fn new(segments: impl IntoIterator<Item = [Point; 2]>) -> Self {
        let segments: Vec<_> = segments.into_iter().collect();
        let mut leaves: Vec<TreeBox> = segments
            .chunks(LEAF)
            .enumerate()
            .map(|(k, run)| TreeBox {
                envelope: Bbox::of(run.iter().flatten().copied()),
                after: 0,
                first: (k * LEAF) as u32,
                count: run.len() as u32,
            })
            .collect();
        let envelope = leaves.iter().fold(Bbox::EMPTY, |all, leaf| all.union(leaf.envelope));
        let magnitude = envelope.min.iter().chain(&envelope.max).fold(0.0f64, |most, c| most.max(c.abs()));
        let mut boxes = Vec::with_capacity(2 * leaves.len());
        if !leaves.is_empty() {
            split(&mut leaves, &mut boxes);
        }
        let room = if magnitude.is_finite() { ROOM_REL * magnitude } else { 0.0 };
        // Crossings of a ray, on average: the extent of all segments across it over that of the envelope.
        let crossings = |d: usize, extent: f64| segments.iter().map(|[a, b]| (b[d] - a[d]).abs()).sum::<f64>() / extent;
        let upright_rays = crossings(0, envelope.width()) < crossings(1, envelope.height());
        Self { segments, boxes, envelope, room, upright_rays }
    }

    /// Number of segments.
    pub fn len(&self) -> usize {
        self.segments.len()
    }

    /// True where there is no segment.
    pub fn is_empty(&self) -> bool {
        self.segments.is_empty()
    }

    /// The ends of segment `k`.
    pub fn segment(&self, k: usize) -> [Point; 2] {
        self.segments[k]
    }

    /// Envelope of all segments.
    pub fn envelope(&self) -> Bbox {
        self.envelope
    }

    /// True where `holds` does for one of the segments whose boxes share a point with `window`; it is asked until then.
    #[inline]
    pub fn any_in(&self, window: &Bbox, mut holds: impl FnMut(usize) -> bool) -> bool {
        self.any_in_boxes(|b| b.envelope.overlaps(window, self.room), &mut holds)
    }

    #[inline]
    fn any_in_boxes(&self, enter: impl Fn(&TreeBox) -> bool, mut holds: impl FnMut(usize) -> bool) -> bool {
        let mut at = 0;
        while let Some(b) = self.boxes.get(at) {
            if !enter(b) {
                at = b.after as usize;
                continue;
            }
            if (b.first..b.first + b.count).any(|k| holds(k as usize)) {
                return true;
            }
            at += 1;
        }
        false
    }

    /// Calls `visit` with every segment whose box meets the envelope of `a` and `b` grown by `margin`, once each.
    #[inline]
    pub fn candidates(&self, a: Point, b: Point, margin: f64, mut visit: impl FnMut(usize)) {
        self.any_in(&Bbox::of([a, b]).grown([margin, margin]), |k| {
            visit(k);
            false
        });
    }

    /// True where a segment passes nearer to `p` than `radius`.
    pub fn any_within(&self, p: Point, radius: f64) -> bool {
        self.any_in(&Bbox::of([p]).grown([radius, radius]), |k| {
            let [a, b] = self.segments[k];
            segment::distance_to(p, a, b) < radius
        })
    }

    /// True where a segment is properly crossed by `p q`, each pair of ends on opposite sides by more than `margin`.
    pub fn crosses(&self, p: Point, q: Point, margin: f64) -> bool {
        self.any_in(&Bbox::of([p, q]), |k| {
            let [a, b] = self.segments[k];
            segment::cross_properly(p, q, a, b, margin)
        })
    }

    /// Where `p` lies in the even–odd region between the segments, which must form closed polygons; exact.
    ///
    /// Paper, Sec. 4.3 (`internal_point`), with ties settled by exact predicates.
    pub fn locate(&self, p: Point) -> Location {
        let mut inside = false;
        let on = self.crossed_by_ray(p, |crossing, _| {
            inside ^= crossing == Crossing::Right;
            crossing == Crossing::On
        });
        if on {
            Location::OnBoundary
        } else if inside {
            Location::Inside
        } else {
            Location::Outside
        }
    }

    /// Asks `stop` about every segment that a ray from `p` may cross, until it holds: towards +x, or +y where that crosses
    /// fewer, as between the teeth of a comb.
    pub(crate) fn crossed_by_ray(&self, p: Point, mut stop: impl FnMut(Crossing, usize) -> bool) -> bool {
        if self.upright_rays {
            let meets = |TreeBox { envelope: Bbox { min, max }, .. }: &TreeBox| {
                min[0] <= p[0] && p[0] <= max[0] && p[1] <= max[1]
            };
            // The same question in the plane with x and y exchanged.
            let turned = |[x, y]: Point| [y, x];
            return self.any_in_boxes(meets, |k| {
                let [a, b] = self.segments[k];
                stop(ray_crossing(turned(p), turned(a), turned(b)), k)
            });
        }
        let meets =
            |TreeBox { envelope: Bbox { min, max }, .. }: &TreeBox| min[1] <= p[1] && p[1] <= max[1] && p[0] <= max[0];
        self.any_in_boxes(meets, |k| {
            let [a, b] = self.segments[k];
            stop(ray_crossing(p, a, b), k)
        })
    }

    /// Every pair of segments whose boxes meet within `margin`, each once and in order: candidates for meeting.
    pub fn close_pairs(&self, margin: f64) -> Vec<[usize; 2]> {
        self.close_pairs_of(margin, |_, _| true)
    }

    /// Those of [`Self::close_pairs`] that `counts`: a curve that is closely wound has very many with itself.
    pub fn close_pairs_of(&self, margin: f64, counts: impl Fn(usize, usize) -> bool) -> Vec<[usize; 2]> {
        let mut pairs = Vec::new();
        let grown = |k: usize| Bbox::of(self.segments[k]).grown([margin; 2]);
        for leaf in self.boxes.iter().filter(|b| b.count > 0) {
            let window = leaf.envelope.grown([margin; 2]);
            let own: [Bbox; LEAF] =
                std::array::from_fn(
                    |i| if i < leaf.count as usize { grown(leaf.first as usize + i) } else { Bbox::EMPTY },
                );
            // Each pair from the leaf of its first segment.
            let enter =
                |b: &TreeBox| (b.count == 0 || b.first >= leaf.first) && b.envelope.overlaps(&window, self.room);
            self.any_in_boxes(enter, |other| {
                let box_of_other = Bbox::of(self.segments[other]);
                for (i, own) in own.iter().enumerate() {
                    let k = leaf.first as usize + i;
                    if k < other && own.overlaps(&box_of_other, self.room) && counts(k, other) {
                        pairs.push([k, other]);
                    }
                }
                false
            });
        }
        pairs.sort_unstable();
        pairs
    }
}

/// Adds the boxes of the tree over `leaves`, halved along the longer extent of their middles, ties by number: the tree is
/// balanced whatever the segments.
fn split(leaves: &mut [TreeBox], boxes: &mut Vec<TreeBox>) {
    let here = boxes.len();
    if let [leaf] = leaves {
        boxes.push(TreeBox { after: here as u32 + 1, ..*leaf });
        return;
    }
    let twice_middle = |leaf: &TreeBox, d: usize| leaf.envelope.min[d] + leaf.envelope.max[d];
    let (mut envelope, mut spread) = (Bbox::EMPTY, Bbox::EMPTY);
    for leaf in leaves.iter() {
        envelope = envelope.union(leaf.envelope);
        spread.include([twice_middle(leaf, 0), twice_middle(leaf, 1)]);
    }
    boxes.push(TreeBox { envelope, after: 0, first: 0, count: 0 });
    let d = usize::from(spread.height() > spread.width());
    let half = leaves.len() / 2;
    leaves.select_nth_unstable_by(half, |a, b| {
        twice_middle(a, d).total_cmp(&twice_middle(b, d)).then(a.first.cmp(&b.first))
    });
    let (left, right) = leaves.split_at_mut(half);
    split(left, boxes);
    split(right, boxes);
    boxes[here].after = boxes.len() as u32;
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    prop_compose! {
        fn point()(x in -3.0..3.0f64, y in -1.0..1.0f64) -> Point { [x, y] }
    }

    proptest! {
        #[test]
        fn nothing_near_or_crossed_is_missed(
            segments in prop::collection::vec((point(), point()), 1..40),
            p in point(), q in point(), radius in 0.0..0.5f64,
        ) {
            let segments: Vec<[Point; 2]> = segments.into_iter().map(|(a, b)| [a, b]).collect();
            let index = SegmentIndex::new(segments.iter().copied());
            let near = segments.iter().any(|[a, b]| segment::distance_to(p, *a, *b) < radius);
            let crossed = segments.iter().any(|[a, b]| segment::cross_properly(p, q, *a, *b, 1e-9));
            prop_assert_eq!(index.any_within(p, radius), near);
            prop_assert_eq!(index.crosses(p, q, 1e-9), crossed);
        }

        #[test]
        fn close_pairs_hold_every_pair_that_touches(segments in prop::collection::vec((point(), point()), 2..30)) {
            let segments: Vec<[Point; 2]> = segments.into_iter().map(|(a, b)| [a, b]).collect();
            let pairs = SegmentIndex::new(segments.iter().copied()).close_pairs(0.0);
            for i in 0..segments.len() {
                for j in i + 1..segments.len() {
                    let ([a, b], [c, d]) = (segments[i], segments[j]);
                    if segment::touch(a, b, c, d) {
                        prop_assert!(pairs.contains(&[i, j]));
                    }
                }
            }
        }
    }

    #[test]
    fn segments_of_very_different_lengths_are_found_without_looking_at_many() {
        // 10⁴ segments around a hole of 1e-6 of the size, and a comb of 10⁴ long teeth.
        let n = 10_000;
        let corner = |k: usize| {
            let t = std::f64::consts::TAU * k as f64 / n as f64;
            [0.5 + 1e-6 * t.cos(), 0.5 + 1e-6 * t.sin()]
        };
        let tooth = |k: usize| [[1.0 + k as f64 / n as f64, 0.0], [1.0 + k as f64 / n as f64, 1.0]];
        let index = SegmentIndex::new((0..n).map(|k| [corner(k), corner(k + 1)]).chain((0..n).map(tooth)));
        let mut looked_at = 0;
        for k in 0..n {
            index.candidates(corner(k), corner(k), 1e-10, |_| looked_at += 1);
            let p = [tooth(k)[0][0], 0.3];
            index.candidates(p, p, 1e-5, |_| looked_at += 1);
        }
        assert!(looked_at < 12 * 2 * n, "{looked_at}"); // at most three leaves each
        assert!(index.any_within([0.5, 0.5 + 2e-6], 1.1e-6) && !index.any_within([0.5, 0.5 + 2e-6], 0.9e-6));
        assert!(index.close_pairs(0.0).len() < 2 * n);
    }

    #[test]
    fn a_point_between_the_teeth_of_a_comb_is_located_across_few_of_them() {
        let n = 2000;
        let mut corners: Vec<Point> = vec![[0.0, -1.0], [f64::from(n), -1.0]];
        for k in (0..n).rev().map(f64::from) {
            corners.extend([[k + 0.8, 0.0], [k + 0.75, 1e3], [k + 0.25, 1e3], [k + 0.2, 0.0]]);
        }
        for turned in [false, true] {
            let at = |[x, y]: Point| if turned { [y, x] } else { [x, y] };
            let ends = (0..corners.len()).map(|k| [at(corners[k]), at(corners[(k + 1) % corners.len()])]);
            let index = SegmentIndex::new(ends);
            let mut looked_at = 0;
            for k in (0..n).map(f64::from) {
                assert_eq!(index.locate(at([k + 0.5, 500.0])), Location::Inside);
                assert_eq!(index.locate(at([k + 0.01, 500.0])), Location::Outside);
                index.crossed_by_ray(at([k + 0.5, 500.0]), |_, _| {
                    looked_at += 1;
                    false
                });
            }
            assert!(looked_at < 40 * n, "{looked_at}");
        }
    }

    #[test]
    fn no_segments_meet_nothing() {
        let none = SegmentIndex::new([]);
        assert!(none.is_empty() && !none.any_within([0.0, 0.0], 1.0) && !none.crosses([0.0, 0.0], [1.0, 1.0], 0.0));
        assert_eq!(none.locate([0.0, 0.0]), Location::Outside);
    }

    #[test]
    fn one_vertical_segment_is_found_though_its_envelope_has_no_width() {
        let index = SegmentIndex::new([[[1.0, 0.0], [1.0, 5.0]]]);
        assert!(index.any_within([1.1, 2.0], 0.2));
        assert!(index.crosses([0.0, 1.0], [2.0, 1.0], 1e-9));
    }
}
