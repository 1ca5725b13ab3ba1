//! The background grid of the interior nodes; paper, eq. (6) \[D5\].

use nmt_geom::{Bbox, Point};

/// N_x × N_y sites over the envelope of a contour, the outermost on the envelope itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lattice {
    /// Lower left corner of the envelope, user's length unit.
    pub origin: Point,
    /// Width and height of the envelope.
    pub extent: [f64; 2],
    /// N_x and N_y.
    pub shape: [usize; 2],
}

impl Lattice {
    /// The grid of `shape` = [N_x, N_y] (each at least 2) over `envelope`.
    pub fn new(envelope: Bbox, shape: [usize; 2]) -> Self {
        Self { origin: envelope.min, extent: [envelope.width(), envelope.height()], shape }
    }

    /// h_x = W/(N_x − 1) and h_y = H/(N_y − 1), user's length unit.
    pub fn spacing(&self) -> [f64; 2] {
        std::array::from_fn(|d| self.extent[d] / (self.shape[d] - 1) as f64)
    }

    /// Coordinate `i` along axis `d`.
    ///
    /// Written as nodes of a straight edge are, so that the grid of a rectangle meets its boundary nodes to the bit.
    #[inline]
    pub fn coordinate(&self, d: usize, i: usize) -> f64 {
        self.origin[d] + self.extent[d] * (i as f64 / (self.shape[d] - 1) as f64)
    }

    /// Site (i, j).
    #[inline]
    pub fn site(&self, i: usize, j: usize) -> Point {
        [self.coordinate(0, i), self.coordinate(1, j)]
    }

    /// Number of site (i, j): j·N_x + i.
    #[inline]
    pub fn number(&self, i: usize, j: usize) -> u32 {
        (j * self.shape[0] + i) as u32
    }

    /// The (i, j) of a site's number.
    #[inline]
    pub fn site_of(&self, number: u32) -> [usize; 2] {
        let columns = self.shape[0] as u32;
        [(number % columns) as usize, (number / columns) as usize]
    }

    /// Number of interior sites along each axis, without the outermost: N_x − 2, N_y − 2.
    pub fn interior_shape(&self) -> [usize; 2] {
        self.shape.map(|n| n.saturating_sub(2))
    }

    /// Interior indices `1..N−1` of axis `d` whose coordinate may lie in [low, high], with one more at either side.
    pub(crate) fn interior_range(&self, d: usize, low: f64, high: f64) -> std::ops::Range<usize> {
        let per_length = (self.shape[d] - 1) as f64 / self.extent[d];
        // Truncation is the floor of what is positive; below it, and NaN, is 0.
        let index = |v: f64| ((v - self.origin[d]) * per_length) as usize;
        let first = index(low).saturating_sub(1).max(1);
        let last = index(high).saturating_add(3).min(self.shape[d] - 1);
        first..last.max(first)
    }
}
