//! A tree of boxes over segments: which are near, which are crossed, where a point lies.

use crate::bbox::Bbox;
use crate::locate::{Crossing, Location, ray_crossing};
use crate::point::Point;
use crate::segment;

/// Segments in a leaf: more tests segments in vain, fewer tests boxes in vain.
const LEAF: usize = 4;

/// Boxes are looked up with this much room, as a fraction of the coordinates: a segment exactly at a distance that is
/// asked for must not be missed by rounding.
const ROOM_REL: f64 = 1.0e-14;

/// Finds the segments near a point or a line in O(log n), whatever their lengths and however unevenly they lie.
#[derive(Clone, Debug)]
pub struct SegmentIndex {
    segments: Vec<[Point; 2]>, // by number
    order: Vec<u32>,           // numbers, leaf by leaf
    boxes: Vec<TreeBox>,       // depth first: a box, what is in its first half, what is in its second half
    envelope: Bbox,
    room: f64,
}

/// A box of the tree.
#[derive(Clone, Copy, Debug)]
struct TreeBox {
    envelope: Bbox,
    after: u32, // the box to go on with where this one is passed over
    first: u32, // in `order`
    count: u32, // segments in a leaf, 0 in an inner box
}

impl SegmentIndex {
    /// Indexes `segments`; they keep their numbers 0, 1, …. O(n log n).
    pub fn new(segments: impl IntoIterator<Item = [Point; 2]>) -> Self {
        let segments: Vec<_> = segments.into_iter().collect();
        let envelope = Bbox::of(segments.iter().flatten().copied());
        let magnitude = envelope.min.iter().chain(&envelope.max).fold(0.0f64, |most, c| most.max(c.abs()));
        let mut order: Vec<u32> = (0..segments.len() as u32).collect();
        let mut boxes = Vec::with_capacity(2 * segments.len() / LEAF + 1);
        if !segments.is_empty() {
            let middles: Vec<Point> =
                segments.iter().map(|[a, b]| [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])]).collect();
            split(&segments, &middles, &mut order, 0, &mut boxes);
        }
        let room = if magnitude.is_finite() { ROOM_REL * magnitude } else { 0.0 };
        Self { segments, order, boxes, envelope, room }
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
    pub fn any_in(&self, window: &Bbox, holds: impl FnMut(usize) -> bool) -> bool {
        self.any_in_boxes(|b| b.overlaps(window, self.room), holds)
    }

    #[inline]
    fn any_in_boxes(&self, enter: impl Fn(&Bbox) -> bool, mut holds: impl FnMut(usize) -> bool) -> bool {
        let mut at = 0;
        while let Some(b) = self.boxes.get(at) {
            if !enter(&b.envelope) {
                at = b.after as usize;
                continue;
            }
            let leaf = b.first as usize..(b.first + b.count) as usize;
            if self.order[leaf].iter().any(|&k| holds(k as usize)) {
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

    /// Asks `stop` about every segment that the ray from `p` towards +x may cross, until it holds.
    pub(crate) fn crossed_by_ray(&self, p: Point, mut stop: impl FnMut(Crossing, usize) -> bool) -> bool {
        let meets = |b: &Bbox| b.min[1] <= p[1] && p[1] <= b.max[1] && p[0] <= b.max[0];
        self.any_in_boxes(meets, |k| {
            let [a, b] = self.segments[k];
            stop(ray_crossing(p, a, b), k)
        })
    }

    /// Every pair of segments whose boxes meet within `margin`, each once and in order: candidates for meeting.
    pub fn close_pairs(&self, margin: f64) -> Vec<[usize; 2]> {
        let mut pairs = Vec::new();
        for (k, [a, b]) in self.segments.iter().enumerate() {
            let own = Bbox::of([*a, *b]).grown([margin, margin]);
            self.any_in(&own, |other| {
                let [c, d] = self.segments[other];
                if other > k && own.overlaps(&Bbox::of([c, d]), self.room) {
                    pairs.push([k, other]);
                }
                false
            });
        }
        pairs.sort_unstable();
        pairs
    }
}

/// Builds the boxes of `order`, whose first element is number `first` of the whole; halves along the longer extent of the
/// middles, ties by number, so that the tree is balanced whatever the segments.
fn split(segments: &[[Point; 2]], middles: &[Point], order: &mut [u32], first: usize, boxes: &mut Vec<TreeBox>) {
    let envelope = Bbox::of(order.iter().flat_map(|&k| segments[k as usize]));
    let here = boxes.len();
    let count = if order.len() <= LEAF { order.len() as u32 } else { 0 };
    boxes.push(TreeBox { envelope, after: 0, first: first as u32, count });
    if count == 0 {
        let spread = Bbox::of(order.iter().map(|&k| middles[k as usize]));
        let d = usize::from(spread.height() > spread.width());
        // Whole leaves on the left.
        let half = (order.len() / 2).next_multiple_of(LEAF).min(order.len() - 1);
        order.select_nth_unstable_by(half, |&i, &j| {
            middles[i as usize][d].total_cmp(&middles[j as usize][d]).then(i.cmp(&j))
        });
        let (left, right) = order.split_at_mut(half);
        split(segments, middles, left, first, boxes);
        split(segments, middles, right, first + half, boxes);
    }
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
