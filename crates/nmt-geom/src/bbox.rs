//! The envelope of a set of points, and the size that tolerances are scaled by.

use crate::point::Point;

/// Axis-parallel envelope, in the user's length unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bbox {
    /// Lower left corner.
    pub min: Point,
    /// Upper right corner.
    pub max: Point,
}

impl Bbox {
    /// The envelope of no point: the identity of [`Bbox::include`] and [`Bbox::union`].
    pub const EMPTY: Self = Self { min: [f64::INFINITY; 2], max: [f64::NEG_INFINITY; 2] };

    /// The envelope of `points`.
    ///
    /// ```
    /// let envelope = nmt_geom::Bbox::of([[0.0, 1.0], [3.0, -3.0]]);
    /// assert_eq!((envelope.width(), envelope.height(), envelope.size()), (3.0, 4.0, 5.0));
    /// ```
    pub fn of(points: impl IntoIterator<Item = Point>) -> Self {
        let mut envelope = Self::EMPTY;
        points.into_iter().for_each(|p| envelope.include(p));
        envelope
    }

    /// Grows the envelope to take in `p`.
    #[inline]
    pub fn include(&mut self, p: Point) {
        for d in 0..2 {
            self.min[d] = self.min[d].min(p[d]);
            self.max[d] = self.max[d].max(p[d]);
        }
    }

    /// The envelope of both.
    pub fn union(self, other: Self) -> Self {
        let mut both = self;
        both.include(other.min);
        both.include(other.max);
        both
    }

    /// The envelope with `margin` more on either side along x and along y.
    #[inline]
    pub fn grown(self, margin: [f64; 2]) -> Self {
        Self {
            min: [self.min[0] - margin[0], self.min[1] - margin[1]],
            max: [self.max[0] + margin[0], self.max[1] + margin[1]],
        }
    }

    /// W, the extent along x.
    pub fn width(&self) -> f64 {
        self.max[0] - self.min[0]
    }

    /// H, the extent along y.
    pub fn height(&self) -> f64 {
        self.max[1] - self.min[1]
    }

    /// Length of the diagonal: the *size* that tolerances are relative to.
    pub fn size(&self) -> f64 {
        self.width().hypot(self.height())
    }

    /// True where the two envelopes, each grown by `margin`, share a point.
    #[inline]
    pub fn overlaps(&self, other: &Self, margin: f64) -> bool {
        (0..2).all(|d| self.min[d] - margin <= other.max[d] && other.min[d] - margin <= self.max[d])
    }

    /// True where `p` is inside the envelope grown by `margin`.
    pub fn contains(&self, p: Point, margin: f64) -> bool {
        (0..2).all(|d| self.min[d] - margin <= p[d] && p[d] <= self.max[d] + margin)
    }
}
