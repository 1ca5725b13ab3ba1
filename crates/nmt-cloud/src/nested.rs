//! The nested lattices of a graded cloud: each level's sites are those of the level before and the middles between them.

use crate::grading::MIN_SPACING_REL;
use nmt_geom::{Bbox, Point};
use std::f64::consts::{FRAC_1_SQRT_2, SQRT_2};

/// Levels whose counts of cells along a side must stay exact in an `i64` and an `f64`.
const MOST_LEVELS: usize = 64;

/// The bits of the exponent of 1.
const ONE_EXPONENT: usize = 1023;

/// A count of cells is met to this, so that rounding adds none.
const COUNT_SLACK: f64 = 1.0e-9;

/// Lattices over an envelope, each with √½ of the spacing of the one before.
///
/// Level 0 has square cells, as nearly as the envelope allows. Level 2m halves them m times; level 2m + 1 has the corners
/// and the centres of the cells of level 2m: a square lattice turned by 45°. Each contains the ones before.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NestedLattice {
    /// Lower left corner of the envelope, user's length unit.
    pub origin: Point,
    /// Width and height of the envelope.
    pub extent: [f64; 2],
    /// Cells of level 0 along x and y, at least 2.
    pub cells: [u32; 2],
}

/// A square cell of the hierarchy: 2^−depth cells of level 0 wide; its lower left corner is site (i, j) of level 2·depth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Cell {
    pub depth: i32,
    pub i: i64,
    pub j: i64,
}

impl Cell {
    /// The four cells it consists of: lower left, lower right, upper left, upper right.
    pub fn children(self) -> [Self; 4] {
        let Self { depth, i, j } = self;
        [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(a, b)| Self { depth: depth + 1, i: 2 * i + a, j: 2 * j + b })
    }

    /// The level at which its lower left corner first is a site.
    pub fn level_of_corner(self) -> usize {
        let Self { depth, i, j } = self;
        let halvings = (i | j).trailing_zeros().min(63) as i32;
        let first = (depth - halvings).max(0);
        if first == 0 {
            return 0;
        }
        let is_centre = (i >> halvings) & (j >> halvings) & 1 == 1;
        2 * first as usize - usize::from(is_centre)
    }
}

impl NestedLattice {
    /// The lattices over `envelope` whose widest spacing is `most`, or less: a whole number of nearly square cells, and at
    /// least two along each side.
    pub fn new(envelope: Bbox, most: f64) -> Self {
        let extent = [envelope.width(), envelope.height()];
        let short = usize::from(extent[1] < extent[0]);
        let count = |extent: f64, side: f64| ((extent / side - COUNT_SLACK).ceil()).clamp(2.0, f64::from(u32::MAX));
        let mut cells = [0; 2];
        let across = count(extent[short], most);
        cells[short] = across as u32;
        cells[1 - short] = count(extent[1 - short], extent[short] / across) as u32;
        Self { origin: envelope.min, extent, cells }
    }

    /// Spacing of level 0 along x and y, user's length unit.
    pub fn spacing(&self) -> [f64; 2] {
        std::array::from_fn(|d| self.extent[d] / f64::from(self.cells[d]))
    }

    /// The larger of the two.
    pub fn max_spacing(&self) -> f64 {
        let [x, y] = self.spacing();
        x.max(y)
    }

    /// Coordinate of the lower left corners of a row or column of cells, along axis `d`.
    ///
    /// Written as nodes of a straight edge are, so that sites of a rectangle meet its boundary to the bit.
    #[inline]
    pub(crate) fn coordinate(&self, d: usize, depth: i32, i: i64) -> f64 {
        let (i, n) = if depth >= 0 {
            (i, i64::from(self.cells[d]) << depth.min(31))
        } else {
            (i << (-depth).min(31), i64::from(self.cells[d]))
        };
        self.origin[d] + self.extent[d] * (i as f64 / n as f64)
    }

    /// The lower left corner of a cell.
    #[inline]
    pub(crate) fn corner(&self, cell: Cell) -> Point {
        [self.coordinate(0, cell.depth, cell.i), self.coordinate(1, cell.depth, cell.j)]
    }

    /// The cell that holds all others: the smallest of the hierarchy with the envelope in it.
    pub(crate) fn root(&self) -> Cell {
        let most = self.cells[0].max(self.cells[1]);
        Cell { depth: -(most.next_power_of_two().trailing_zeros() as i32), i: 0, j: 0 }
    }

    /// The two steps from a site of a level to its neighbours: along x and y, or along the diagonals.
    pub(crate) fn steps(&self, level: usize) -> [[f64; 2]; 2] {
        let [x, y] = self.spacing().map(|s| s * 0.5f64.powi((level / 2) as i32));
        if level.is_multiple_of(2) { [[x, 0.0], [0.0, y]] } else { [[0.5 * x, 0.5 * y], [-0.5 * x, 0.5 * y]] }
    }

    /// Which level a spacing asks for.
    pub(crate) fn levels(&self) -> Levels {
        let size = self.extent[0].hypot(self.extent[1]);
        let mut spacings = vec![self.max_spacing()];
        while spacings.len() < MOST_LEVELS && spacings[spacings.len() - 1] > MIN_SPACING_REL * size {
            let (m, odd) = (spacings.len() / 2, spacings.len() % 2 == 1);
            let halved = spacings[0] * 0.5f64.powi(m as i32);
            spacings.push(if odd { halved * FRAC_1_SQRT_2 } else { halved });
        }
        let thresholds = spacings.iter().map(|s| s / SQRT_2.sqrt()).collect();
        Levels { spacings, thresholds }
    }
}

/// The spacings of the levels, and where one gives way to the next: half-way, by ratio.
#[derive(Clone, Debug)]
pub(crate) struct Levels {
    spacings: Vec<f64>,
    thresholds: Vec<f64>,
}

impl Levels {
    /// The level whose spacing is nearest to `h` by ratio: within a factor of ⁴√2, unless `h` is beyond all levels.
    #[inline]
    pub fn level_of(&self, h: f64) -> usize {
        // Most nodes of most clouds are of the first levels.
        if h >= self.thresholds[0] {
            return 0;
        }
        // Whole part of the logarithm of the ratio's square, to the base 2: half a power of two a level. Rounding is put right.
        let ratio = self.thresholds[0] / h;
        let exponent = ((ratio * ratio).to_bits() >> 52) as usize; // not negative, for the ratio is above 1
        let last = self.thresholds.len() - 1;
        let mut level = (exponent - ONE_EXPONENT + 1).min(last);
        while level < last && self.thresholds[level] > h {
            level += 1;
        }
        while self.thresholds[level - 1] <= h {
            level -= 1;
        }
        level
    }

    /// Number of levels.
    pub fn len(&self) -> usize {
        self.spacings.len()
    }

    /// Distance from a site of a level to the nearest others.
    pub fn spacing(&self, level: usize) -> f64 {
        self.spacings[level]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_nearly_square_whatever_the_envelope() {
        for extent in [[2.0, 1.0], [1.0, 7.3], [10.0, 0.1], [3.0, 2.9], [1.0, 1.0]] {
            for most in [5.0, 0.3, 0.07, 0.001] {
                let lattice = NestedLattice::new(Bbox::of([[0.0, 0.0], extent]), most);
                let [x, y] = lattice.spacing();
                assert!(x <= most * (1.0 + 1e-8) && y <= most * (1.0 + 1e-8));
                let [n, m] = lattice.cells;
                let limit = 1.0 + 1.0 / f64::from(n.max(m).saturating_sub(1).max(1));
                assert!(x.max(y) / x.min(y) <= limit + 1e-8, "{extent:?}, {most}: {x}, {y}");
            }
        }
        let lattice = NestedLattice::new(Bbox::of([[0.0, 0.0], [2.0, 1.0]]), 0.05);
        assert_eq!(lattice.cells, [40, 20]);
    }

    #[test]
    fn a_level_is_within_the_fourth_root_of_two_of_what_is_asked() {
        let levels = NestedLattice::new(Bbox::of([[0.0, 0.0], [1.0, 1.0]]), 0.1).levels();
        let mut h = 0.1;
        while h > 1e-6 {
            let ratio = levels.spacing(levels.level_of(h)) / h;
            assert!((0.840..1.190).contains(&ratio), "{ratio} at {h}");
            h *= 0.97;
        }
    }

    #[test]
    fn a_level_begins_at_its_threshold() {
        let levels = NestedLattice::new(Bbox::of([[0.0, 0.0], [3.0, 1.0]]), 0.17).levels();
        let anew = |h: f64| levels.thresholds.partition_point(|&least| least > h).min(levels.len() - 1);
        for &threshold in &levels.thresholds {
            for h in [threshold.next_down(), threshold, threshold.next_up(), 1.1 * threshold] {
                assert_eq!(levels.level_of(h), anew(h), "{h}");
            }
        }
        assert_eq!([levels.level_of(1e-300), levels.level_of(1e300)], [levels.len() - 1, 0]);
    }

    #[test]
    fn the_level_of_a_site_is_that_of_the_coarsest_lattice_with_it() {
        let level = |depth, i, j| Cell { depth, i, j }.level_of_corner();
        assert_eq!([level(0, 3, 5), level(2, 4, 8), level(-1, 1, 1), level(3, 0, 0)], [0, 0, 0, 0]);
        assert_eq!([level(1, 1, 1), level(1, 1, 2), level(2, 2, 2), level(2, 2, 6)], [1, 2, 1, 1]);
        assert_eq!([level(2, 1, 3), level(2, 1, 0), level(3, 6, 4)], [3, 4, 4]);
    }
}
