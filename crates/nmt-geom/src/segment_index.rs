//! A grid of buckets over segments: which are near, which are crossed.

use crate::bbox::Bbox;
use crate::point::Point;
use crate::segment;

/// Buckets a segment on average: finer finds fewer false candidates, coarser visits fewer buckets.
const BUCKETS_PER_SEGMENT: f64 = 2.0;

/// Bucket entries a segment at most, so that a few segments much longer than the rest cannot fill the memory.
const MAX_ENTRIES_PER_SEGMENT: f64 = 16.0;

/// Finds the segments near a point or a line in O(1) for segments of about equal length.
#[derive(Clone, Debug)]
pub struct SegmentIndex {
    segments: Vec<[Point; 2]>,
    envelope: Bbox,
    cell: [f64; 2],
    shape: [usize; 2],
    starts: Vec<u32>,
    entries: Vec<u32>,
}

impl SegmentIndex {
    /// Indexes `segments`; they keep their numbers 0, 1, ….
    pub fn new(segments: impl IntoIterator<Item = [Point; 2]>) -> Self {
        let segments: Vec<_> = segments.into_iter().collect();
        let envelope = Bbox::of(segments.iter().flatten().copied());
        let (w, h) = (envelope.width().max(0.0), envelope.height().max(0.0));
        let n = segments.len().max(1) as f64;
        // Square buckets of about the segments' mean length, but no more of them, and no more entries in them, than the
        // segments can pay for.
        let total: f64 = segments.iter().map(|[a, b]| crate::point::distance(*a, *b)).sum();
        let by_count = (w * h / (BUCKETS_PER_SEGMENT * n)).sqrt().max(w.max(h) / (BUCKETS_PER_SEGMENT * n));
        let by_entries = total / (MAX_ENTRIES_PER_SEGMENT * n);
        let side = (total / n).max(by_count).max(by_entries);
        let side = if side.is_finite() && side > 0.0 { side } else { 1.0 };
        let count = |extent: f64| ((extent / side).ceil() as usize).clamp(1, (BUCKETS_PER_SEGMENT * n) as usize + 1);
        let shape = [count(w), count(h)];
        let cell = [nonzero(w / shape[0] as f64), nonzero(h / shape[1] as f64)];
        let mut index =
            Self { segments, envelope, cell, shape, starts: vec![0; shape[0] * shape[1] + 1], entries: vec![] };
        let mut pairs: Vec<(u32, u32)> = Vec::with_capacity(2 * index.segments.len());
        for (k, [a, b]) in index.segments.iter().enumerate() {
            index.walk(*a, *b, 0.0, |bucket| pairs.push((bucket as u32, k as u32)));
        }
        pairs.iter().for_each(|&(bucket, _)| index.starts[bucket as usize + 1] += 1);
        (0..shape[0] * shape[1]).for_each(|bucket| index.starts[bucket + 1] += index.starts[bucket]);
        let mut next = index.starts.clone();
        index.entries = vec![0; pairs.len()];
        for (bucket, k) in pairs {
            index.entries[next[bucket as usize] as usize] = k;
            next[bucket as usize] += 1;
        }
        index
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

    fn column(&self, v: f64, d: usize) -> usize {
        let c = (v - self.envelope.min[d]) / self.cell[d];
        if c > 0.0 { (c as usize).min(self.shape[d] - 1) } else { 0 }
    }

    /// Calls `visit` with every bucket that the segment `a b`, widened by `margin`, may touch: row by row, the columns
    /// between its entry and its exit.
    fn walk(&self, a: Point, b: Point, margin: f64, mut visit: impl FnMut(usize)) {
        let (low, high) = if a[1] <= b[1] { (a, b) } else { (b, a) };
        let rows = self.column(low[1] - margin, 1)..=self.column(high[1] + margin, 1);
        let slope = (high[0] - low[0]) / (high[1] - low[1]);
        // Rounding must not lose a bucket: widen by a hair of the cell.
        let slack = margin + 1e-9 * self.cell[0];
        for row in rows {
            let floor = self.envelope.min[1] + row as f64 * self.cell[1];
            let (y0, y1) = (floor - slack, floor + self.cell[1] + slack);
            let x_at = |y: f64| {
                let y = y.clamp(low[1], high[1]);
                if slope.is_finite() { low[0] + (y - low[1]) * slope } else { low[0] }
            };
            let (mut x0, mut x1) = (x_at(y0), x_at(y1));
            if !slope.is_finite() {
                (x0, x1) = (a[0], b[0]);
            }
            let columns = self.column(x0.min(x1) - slack, 0)..=self.column(x0.max(x1) + slack, 0);
            columns.for_each(|column| visit(row * self.shape[0] + column));
        }
    }

    fn bucket(&self, bucket: usize) -> &[u32] {
        &self.entries[self.starts[bucket] as usize..self.starts[bucket + 1] as usize]
    }

    /// Calls `visit` with every segment whose buckets meet the envelope of `a` and `b` grown by `margin`; a segment can
    /// come more than once.
    pub fn candidates(&self, a: Point, b: Point, margin: f64, mut visit: impl FnMut(usize)) {
        if !self.envelope.overlaps(&Bbox::of([a, b]), margin) {
            return;
        }
        self.walk(a, b, margin, |bucket| self.bucket(bucket).iter().for_each(|&k| visit(k as usize)));
    }

    /// True where a segment passes nearer to `p` than `radius`.
    pub fn any_within(&self, p: Point, radius: f64) -> bool {
        let mut found = false;
        self.candidates(p, p, radius, |k| {
            let [a, b] = self.segments[k];
            found = found || segment::distance_to(p, a, b) < radius;
        });
        found
    }

    /// True where a segment is properly crossed by `p q`, each pair of ends on opposite sides by more than `margin`.
    pub fn crosses(&self, p: Point, q: Point, margin: f64) -> bool {
        let mut found = false;
        self.candidates(p, q, 0.0, |k| {
            let [a, b] = self.segments[k];
            found = found || segment::cross_properly(p, q, a, b, margin);
        });
        found
    }

    /// Every pair of segments that share a bucket within `margin`, each once and in order: candidates for meeting.
    pub fn close_pairs(&self, margin: f64) -> Vec<[usize; 2]> {
        let mut pairs = Vec::new();
        let mut seen = vec![usize::MAX; self.segments.len()];
        for (k, [a, b]) in self.segments.iter().enumerate() {
            self.candidates(*a, *b, margin, |other| {
                if other > k && seen[other] != k {
                    seen[other] = k;
                    pairs.push([k, other]);
                }
            });
        }
        pairs.sort_unstable();
        pairs
    }
}

fn nonzero(v: f64) -> f64 {
    if v > 0.0 { v } else { 1.0 }
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
    fn one_vertical_segment_is_found_though_its_envelope_has_no_width() {
        let index = SegmentIndex::new([[[1.0, 0.0], [1.0, 5.0]]]);
        assert!(index.any_within([1.1, 2.0], 0.2));
        assert!(index.crosses([0.0, 1.0], [2.0, 1.0], 1e-9));
    }
}
