//! Coordinates in units of the spacings, and the box that a point is in.

use nmt_cloud::{Cloud, Lattice};
use nmt_geom::Point;

/// Sizes for which fourth powers of spacings neither overflow nor underflow, with room for what is made of them.
const SIZES: std::ops::Range<f64> = 1e-60..1e60;

/// The lattice with one more box on each side, so that the real boundary lies between nodes and ghosts.
///
/// Box (i, j) is the half-open unit square about site (i − 1, j − 1).
pub(super) struct Frame {
    lattice: Lattice,
    pub spacing: [f64; 2],
    pub shape: [usize; 2], // boxes along x and y
}

impl Frame {
    /// `None` where numbers would be out of range.
    pub fn new(cloud: &Cloud) -> Option<Self> {
        let lattice = *cloud.lattice()?;
        let spacing = lattice.spacing();
        let is_usable = |h: &f64| h.is_finite() && *h > 0.0;
        let fits =
            SIZES.contains(&cloud.size()) && spacing.iter().all(is_usable) && lattice.shape.iter().all(|n| *n >= 2);
        fits.then(|| Self { lattice, spacing, shape: lattice.shape.map(|n| n + 2) })
    }

    /// A coordinate along axis `d` in units of the spacing: box k is about k.
    #[inline]
    pub fn scaled(&self, d: usize, v: f64) -> f64 {
        (v - self.lattice.origin[d]) / self.spacing[d] + 1.0
    }

    /// The box of a point; `None` outside the lattice's own boxes.
    pub fn box_of(&self, p: Point) -> Option<[u32; 2]> {
        let along = |d: usize| {
            let k = (self.scaled(d, p[d]) + 0.5).floor();
            (k >= 1.0 && k < (self.shape[d] - 1) as f64).then_some(k as u32)
        };
        Some([along(0)?, along(1)?])
    }

    /// The coordinates of the sites of all columns (`d` = 0) or rows (1) of boxes.
    pub fn sites_along(&self, d: usize) -> Vec<f64> {
        let n = self.shape[d];
        let rim = |site: f64, way: f64| site + way * self.spacing[d];
        let inner = (0..n - 2).map(|k| self.lattice.coordinate(d, k));
        let (first, last) = (self.lattice.coordinate(d, 0), self.lattice.coordinate(d, n - 3));
        std::iter::once(rim(first, -1.0)).chain(inner).chain(std::iter::once(rim(last, 1.0))).collect()
    }
}
