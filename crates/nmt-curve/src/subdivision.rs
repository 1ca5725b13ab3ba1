//! Local subdivision of a curve's parameter: intervals are halved where their own chords say so \[D2\].

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use nmt_geom::Point;

use crate::Curve;
use crate::chords::{CHORDS, ChordSums, End};

/// Intervals to begin with.
///
/// With 8 chords in each, a feature of 1/500 of the parameter is seen.
const FIRST_INTERVALS: usize = 64;

/// Further intervals towards each end of the curve, and the ratio of their widths.
const GRADED: i32 = 4;
const GRADING: f64 = 1.0 / 8.0;

/// An interval is not halved below this fraction of the parameter's own value: its chords would begin and end in the
/// same float.
const RESOLUTION: f64 = 16.0 * f64::EPSILON;

/// The same at the beginning of the parameter, where floats are finer than any curve can need.
const RESOLUTION_AT_ZERO: f64 = 1e-290;

/// An interval with more than this part of the whole length is halved although its chords agree: on a steep and narrow
/// peak that no chord ends on, they agree.
const LONGEST: f64 = 1.0 / 8.0;

/// Errors below this multiple of the coordinates' rounding are no errors of the subdivision: halving would not lower
/// them.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// An interval of the parameter, its ends, and its measured length.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Leaf {
    pub(crate) from: f64,
    pub(crate) to: f64,
    pub(crate) start: Point,
    pub(crate) finish: Point,
    pub(crate) length: f64,
    pub(crate) error: f64,
}

impl Leaf {
    fn new(curve: &Curve, from: End, to: End) -> Self {
        let sums = ChordSums::new(curve, from, to);
        let (length, error) = (sums.length(), sums.error(curve, from, to));
        let magnitude = [from.point, to.point].iter().flatten().fold(0.0_f64, |most, c| most.max(c.abs()));
        // Written so that NaN remains.
        let error = if error <= ROUNDING * magnitude { 0.0 } else { error };
        Self { from: from.u, to: to.u, start: from.point, finish: to.point, length, error }
    }

    fn can_be_halved(&self) -> bool {
        self.to - self.from > (RESOLUTION * self.to).max(RESOLUTION_AT_ZERO)
    }

    /// Points of the curve at the ends of the finest chords.
    pub(crate) fn points(&self, curve: &Curve) -> [(f64, Point); CHORDS + 1] {
        std::array::from_fn(|k| match k {
            0 => (self.from, self.start),
            CHORDS => (self.to, self.finish),
            _ => {
                let u = self.from + (self.to - self.from) * k as f64 / CHORDS as f64;
                (u, curve.point(u))
            }
        })
    }
}

/// A leaf that can be halved; the one of the largest error comes first, of equal ones the earliest made.
#[derive(Debug)]
struct Candidate {
    error: f64,
    leaf: usize,
}

impl Ord for Candidate {
    fn cmp(&self, other: &Self) -> Ordering {
        self.error.total_cmp(&other.error).then(other.leaf.cmp(&self.leaf))
    }
}

impl PartialOrd for Candidate {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Candidate {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Candidate {}

/// A subdivision that can be refined further.
pub(crate) struct Subdivision<'a> {
    curve: &'a Curve,
    leaves: Vec<Leaf>,
    queue: BinaryHeap<Candidate>,
    /// Sum of the leaves' lengths; NaN or infinite where the curve is.
    pub(crate) length: f64,
    /// Sum of the leaves' errors.
    pub(crate) error: f64,
}

impl<'a> Subdivision<'a> {
    /// The first intervals, at most `most`.
    ///
    /// Their widths are irregular, symmetric about the middle: a wave cannot have its nodes at all the ends, and a
    /// symmetric curve has symmetric intervals. Quarters of the parameter, where kinks are frequent, are among the
    /// ends. Towards both ends of the curve they shorten, since a kink near one of them has no chord beyond it to show
    /// it.
    pub(crate) fn new(curve: &'a Curve, most: usize) -> Self {
        let ends = first_ends(most);
        let n = ends.len();
        let mut division =
            Self { curve, leaves: Vec::with_capacity(2 * n), queue: BinaryHeap::new(), length: 0.0, error: 0.0 };
        let mut from = End { u: 0.0, point: curve.point(0.0) };
        for u in ends {
            let to = End { u, point: curve.point(u) };
            division.push(from, to);
            from = to;
        }
        division
    }

    fn push(&mut self, from: End, to: End) {
        let leaf = Leaf::new(self.curve, from, to);
        let number = self.leaves.len();
        self.leaves.push(leaf);
        self.enter(number);
    }

    /// Takes a new or changed leaf into the sums and the queue.
    fn enter(&mut self, number: usize) {
        let leaf = &self.leaves[number];
        self.length += leaf.length;
        self.error += leaf.error;
        if leaf.error > 0.0 && leaf.can_be_halved() {
            self.queue.push(Candidate { error: leaf.error, leaf: number });
        }
    }

    /// Halves intervals until the error is at most `rel_tol` of the length, or there are `most`; true where it is
    /// reached.
    pub(crate) fn refine(&mut self, rel_tol: f64, most: usize) -> bool {
        loop {
            if !self.length.is_finite() || !self.error.is_finite() {
                return false;
            }
            let mut next = None;
            if self.error <= rel_tol * self.length || self.queue.is_empty() || self.leaves.len() >= most {
                self.sum_anew();
                if self.error <= rel_tol * self.length {
                    next = self.too_long();
                    if next.is_none() {
                        return true;
                    }
                }
            }
            if self.leaves.len() >= most {
                return false;
            }
            let Some(number) = next.or_else(|| self.least_certain()) else { return false };
            let Leaf { from, to, start, finish, length, error } = self.leaves[number];
            self.length -= length;
            self.error -= error;
            let u = 0.5 * (from + to);
            let middle = End { u, point: self.curve.point(u) };
            self.leaves[number] = Leaf::new(self.curve, End { u: from, point: start }, middle);
            self.enter(number);
            self.push(middle, End { u: to, point: finish });
        }
    }

    /// The interval with the largest error; entries of intervals that have been halved since are passed over.
    fn least_certain(&mut self) -> Option<usize> {
        while let Some(Candidate { error, leaf }) = self.queue.pop() {
            if self.leaves[leaf].error == error {
                return Some(leaf);
            }
        }
        None
    }

    /// An interval that has more than its share of the length and can be halved.
    fn too_long(&self) -> Option<usize> {
        self.leaves.iter().position(|leaf| leaf.length > LONGEST * self.length && leaf.can_be_halved())
    }

    /// The sums, without the rounding of all the additions and subtractions on the way: those of a pole hide all
    /// others.
    fn sum_anew(&mut self) {
        self.length = self.leaves.iter().map(|leaf| leaf.length).sum();
        self.error = self.leaves.iter().map(|leaf| leaf.error).sum();
    }

    /// Number of intervals.
    pub(crate) fn intervals(&self) -> usize {
        self.leaves.len()
    }

    /// The intervals in order along the curve.
    pub(crate) fn into_leaves(mut self) -> Vec<Leaf> {
        self.leaves.sort_by(|a, b| a.from.total_cmp(&b.from));
        self.leaves
    }

    /// The intervals, in no order.
    pub(crate) fn leaves(&self) -> &[Leaf] {
        &self.leaves
    }
}

/// Where the first intervals end, at most so many, the last one at 1.
fn first_ends(most: usize) -> Vec<f64> {
    let n = FIRST_INTERVALS.min(most).max(1);
    let mut ends: Vec<f64> = (1..=n).map(|k| first_end(k, n)).collect();
    if most >= FIRST_INTERVALS + 2 * GRADED as usize {
        let first = ends[0];
        for level in 1..=GRADED {
            let u = first * GRADING.powi(level);
            ends.extend([u, 1.0 - u]);
        }
        ends.sort_by(f64::total_cmp);
    }
    ends
}

/// End of the k-th of `n` irregular intervals that [`Subdivision::new`] describes.
pub(crate) fn first_end(k: usize, n: usize) -> f64 {
    // Fractional parts of multiples of the golden ratio: never periodic, never close to each other.
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    const SHIFT: f64 = 0.4; // of an interval, at most: the ends stay in order
    let mirrored = 2 * k > n;
    let from_end = if mirrored { n - k } else { k };
    let quarter = n.is_multiple_of(4) && k.is_multiple_of(n / 4);
    let shift = if quarter || 2 * from_end == n || from_end == 0 {
        0.0
    } else {
        SHIFT * ((from_end as f64 * GOLDEN).fract() - 0.5)
    };
    let u = (from_end as f64 + shift) / n as f64;
    if mirrored { 1.0 - u } else { u }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curve::samples::graph;

    #[test]
    fn first_ends_are_in_order_and_symmetric() {
        assert!(first_ends(1000).windows(2).all(|pair| pair[0] < pair[1]));
        assert_eq!((first_ends(0), first_ends(10).len(), first_ends(1000).len()), (vec![1.0], 10, 72));
        for n in [1, 2, 3, 7, 8, 64] {
            let ends: Vec<f64> = (0..=n).map(|k| first_end(k, n)).collect();
            assert_eq!((ends[0], ends[n]), (0.0, 1.0));
            assert!(ends.windows(2).all(|pair| pair[0] < pair[1]), "{ends:?}");
            assert!((0..=n).all(|k| (ends[k] + ends[n - k] - 1.0).abs() < 1e-15), "{ends:?}"); // rounding
        }
        assert_eq!(first_end(16, 64), 0.25);
        assert_eq!(first_end(32, 64), 0.5);
    }

    #[test]
    fn a_wave_in_step_with_the_intervals_is_seen() {
        for waves in [32, 64, 128, 256, 512] {
            let wave = graph(&format!("sin({waves}*pi*x)"), 0.0, 1.0);
            let division = Subdivision::new(&wave, 1000);
            assert!(division.error > 1e-6 * division.length, "{waves}");
        }
    }
}
