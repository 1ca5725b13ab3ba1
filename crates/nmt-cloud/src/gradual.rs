//! Where a spacing function rises too fast: the places from which the spacing grows instead.

use crate::error::CloudError;
use crate::generate::MAX_GRID_POINTS;
use crate::nested::{Cell, NestedLattice};
use crate::sources::Source;
use crate::spacing::Asked;
use nmt_geom::{Bbox, Point};
use std::f64::consts::{FRAC_1_SQRT_2, SQRT_2};

/// A function is looked at on at least this many cells across the envelope.
pub(crate) const CELLS_ACROSS: u32 = 64;

/// A cell in which the function varies by more than this factor is looked at more closely.
const MUCH: f64 = 1.5;

/// Cells that are looked into for no other reason than that the function may have a dip there, at most: half a second's work.
const MOST_SUSPECTED: usize = 1 << 17;

/// A slope above the growth by no more than this fraction is rounding.
const SLOPE_SLACK: f64 = 1.0e-6;

/// Places that the spacing may grow from, at most.
const MOST_SOURCES: usize = 4_000_000;

/// The function at the corners of a cell, the middles of its sides and its centre: rows from below.
pub(crate) type Nine = [[f64; 3]; 3];

/// Pairs of neighbours among the nine, as (row, column), the first below or left of the second.
const NEIGHBOURS: [[(usize, usize); 2]; 16] = [
    [(0, 0), (0, 1)],
    [(0, 1), (0, 2)],
    [(1, 0), (1, 1)],
    [(1, 1), (1, 2)],
    [(2, 0), (2, 1)],
    [(2, 1), (2, 2)],
    [(0, 0), (1, 0)],
    [(0, 1), (1, 1)],
    [(0, 2), (1, 2)],
    [(1, 0), (2, 0)],
    [(1, 1), (2, 1)],
    [(1, 2), (2, 2)],
    [(0, 0), (1, 1)],
    [(0, 2), (1, 1)],
    [(1, 1), (2, 0)],
    [(1, 1), (2, 2)],
];

/// The depth of cells at which looking at a function begins.
fn first_depth(lattice: &NestedLattice) -> i32 {
    let mut depth = lattice.root().depth;
    let most = f64::from(lattice.cells[0].max(lattice.cells[1]));
    while most * 2f64.powi(depth) < f64::from(CELLS_ACROSS) {
        depth += 1;
    }
    depth
}

/// A function at the corners, the middles of the sides and the centres of all cells at which looking at it begins.
#[derive(Clone, Debug)]
pub(crate) struct FirstLook {
    depth: i32,
    columns: usize,
    values: Vec<f64>, // row by row from below
}

impl FirstLook {
    /// Looks at every place once, some 10⁴ of them.
    ///
    /// # Errors
    /// [`CloudError::NotASpacing`].
    pub fn new(function: &Asked, lattice: &NestedLattice) -> Result<Self, CloudError> {
        let depth = first_depth(lattice);
        let cells = lattice.cells.map(|n| {
            let n = i64::from(n);
            if depth >= 0 { n << depth } else { (n + (1 << -depth) - 1) >> -depth }
        });
        let [columns, rows] = cells.map(|n| 2 * n + 1);
        let places = (0..rows).flat_map(|j| (0..columns).map(move |i| Cell { depth: depth + 1, i, j }));
        let values = places.map(|place| function.at(lattice.corner(place))).collect::<Result<_, _>>()?;
        Ok(Self { depth, columns: columns as usize, values })
    }

    /// The depth of its cells.
    pub fn depth(&self) -> i32 {
        self.depth
    }

    /// The nine values of one of its cells.
    pub fn nine(&self, cell: Cell) -> Nine {
        let first = 2 * (cell.j as usize * self.columns + cell.i as usize);
        std::array::from_fn(|row| std::array::from_fn(|column| self.values[first + row * self.columns + column]))
    }
}

/// The nine values of a cell; those at its corners (lower left, lower right, upper left, upper right) are known.
pub(crate) fn nine(
    lattice: &NestedLattice,
    cell: Cell,
    corners: [f64; 4],
    function: &Asked,
) -> Result<Nine, CloudError> {
    let mut values = [[0.0; 3]; 3];
    let at = |row: usize, column: usize| place(lattice, cell, row, column);
    for (row, values) in values.iter_mut().enumerate() {
        for (column, value) in values.iter_mut().enumerate() {
            let is_corner = row != 1 && column != 1;
            *value = if is_corner { corners[row + column / 2] } else { function.at(at(row, column))? };
        }
    }
    Ok(values)
}

/// Where one of the nine values is taken.
fn place(lattice: &NestedLattice, cell: Cell, row: usize, column: usize) -> Point {
    lattice.corner(Cell { depth: cell.depth + 1, i: 2 * cell.i + column as i64, j: 2 * cell.j + row as i64 })
}

/// The four values at the corners of the child number `k`.
pub(crate) fn corners_of_child(v: &Nine, k: usize) -> [f64; 4] {
    let (row, column) = (k / 2, k % 2);
    [v[row][column], v[row][column + 1], v[row + 1][column], v[row + 1][column + 1]]
}

/// The nine values of the child number `k`, linear between those of its parent.
pub(crate) fn nine_of_child(v: &Nine, k: usize) -> Nine {
    let [a, b, c, d] = corners_of_child(v, k);
    let centre = 0.25 * ((a + d) + (b + c));
    [[a, 0.5 * (a + b), b], [0.5 * (a + c), centre, 0.5 * (b + d)], [c, 0.5 * (c + d), d]]
}

/// The largest second difference of three values in a line.
pub(crate) fn bend(v: &Nine) -> f64 {
    let mut bend = 0.0f64;
    for k in 0..3 {
        bend = bend.max((v[k][0] - 2.0 * v[k][1] + v[k][2]).abs());
        bend = bend.max((v[0][k] - 2.0 * v[1][k] + v[2][k]).abs());
    }
    bend = bend.max((v[0][0] - 2.0 * v[1][1] + v[2][2]).abs());
    bend.max((v[0][2] - 2.0 * v[1][1] + v[2][0]).abs())
}

/// Least and largest of the function in a cell: of the nine values, and by what a parabola through three of them can leave
/// them, along x and along y together, and as much again; by one level at most, for a function with steps is no parabola.
pub(crate) fn range(v: &Nine) -> [f64; 2] {
    let (mut least, mut most, bend) = (f64::INFINITY, f64::NEG_INFINITY, bend(v));
    for &value in v.iter().flatten() {
        least = least.min(value);
        most = most.max(value);
    }
    [(least - 0.5 * bend).max(FRAC_1_SQRT_2 * least), (most + 0.5 * bend).min(SQRT_2 * most)]
}

/// The places beside which the function rises by more than `growth` a unit of length: h is the least of the function and
/// of what grows from them.
///
/// A place that limits h elsewhere is one of these: were the function less steep beside it, the next place on the way would
/// limit h as much.
pub(crate) fn steep_places(
    function: &Asked,
    look: &FirstLook,
    lattice: &NestedLattice,
    growth: f64,
) -> Result<Steep, CloudError> {
    let search =
        |suspects| Search { function, look, lattice, growth, found: Vec::new(), least: f64::INFINITY, suspects };
    let mut seen = search(Some(0));
    seen.visit(lattice.root(), None)?;
    let may_miss_dips = seen.has_too_many_suspects();
    if may_miss_dips {
        // Refined in one corner and not in the other the cloud would follow neither the function nor what is seen of it.
        seen = search(None);
        seen.visit(lattice.root(), None)?;
    }
    let Search { mut found, least, .. } = seen;
    found.sort_unstable_by(|a, b| {
        let [(ay, ax), (by, bx)] = [a, b].map(|source| (source.ends[0][1], source.ends[0][0]));
        ay.total_cmp(&by).then(ax.total_cmp(&bx)).then(a.size.total_cmp(&b.size))
    });
    found.dedup_by_key(|source| source.ends[0]);
    Ok(Steep { sources: found, least, may_miss_dips })
}

/// Where a function is steep.
pub(crate) struct Steep {
    /// The places that the spacing grows from.
    pub sources: Vec<Source>,
    /// The least value of the function that was met.
    pub least: f64,
    /// Whether there were more cells with a dip by the function's lower bound than could be looked into.
    pub may_miss_dips: bool,
}

struct Search<'a> {
    function: &'a Asked,
    look: &'a FirstLook,
    lattice: &'a NestedLattice,
    growth: f64,
    found: Vec<Source>,
    least: f64,
    suspects: Option<usize>, // cells looked into for their lower bound alone; `None` where it is not asked
}

impl Search<'_> {
    /// How small the function may be in a cell whose nine values are `least` at least: that, or much less by its lower bound.
    fn depth_of_dip(&self, cell: Cell, least: f64) -> f64 {
        if self.suspects.is_none() {
            return least;
        }
        let (min, max) =
            (self.lattice.corner(cell), self.lattice.corner(Cell { i: cell.i + 1, j: cell.j + 1, ..cell }));
        let bound = self.function.lower_bound(Bbox { min, max }, least / MUCH);
        bound.filter(|bound| bound * MUCH < least).unwrap_or(least)
    }

    fn has_too_many_suspects(&self) -> bool {
        self.suspects.is_some_and(|n| n >= MOST_SUSPECTED)
    }

    fn visit(&mut self, cell: Cell, corners: Option<[f64; 4]>) -> Result<(), CloudError> {
        if is_beyond(self.lattice, cell) || self.has_too_many_suspects() {
            return Ok(());
        }
        if cell.depth < self.look.depth {
            return cell.children().into_iter().try_for_each(|child| self.visit(child, None));
        }
        let values = match corners {
            Some(corners) => nine(self.lattice, cell, corners, self.function)?,
            None => self.look.nine(cell),
        };
        let half = self.lattice.spacing().map(|s| s * 0.5f64.powi(cell.depth + 1));
        let (mut least, mut most) = (f64::INFINITY, 0.0f64);
        values.iter().flatten().for_each(|&value| (least, most) = (least.min(value), most.max(value)));
        let is_varied = most > MUCH * least;
        let length = |[a, b]: [(usize, usize); 2]| {
            let along = |d: usize, n: usize| half[d] * n as f64;
            along(0, a.1.abs_diff(b.1)).hypot(along(1, a.0.abs_diff(b.0)))
        };
        let value = |(row, column): (usize, usize)| values[row][column];
        let is_steep = |pair: &&[(usize, usize); 2]| {
            (value(pair[0]) - value(pair[1])).abs() > self.growth * length(**pair) * (1.0 + SLOPE_SLACK)
        };
        let is_finer_than = |h: f64| 2.0 * half[0].max(half[1]) <= h;
        let mut steep = NEIGHBOURS.iter().filter(is_steep).peekable();
        let is_uneven = steep.peek().is_some() || is_varied;
        // Cells that are uneven and not fine are looked into in any case.
        let dip = if is_finer_than(least) || !is_uneven { self.depth_of_dip(cell, least) } else { least };
        let (is_fine, has_dip) = (is_finer_than(dip), dip < least);
        // What a formula is beyond the section may be as small as it likes.
        let matters = is_uneven || has_dip || least < self.least;
        if matters {
            let centre = place(self.lattice, cell, 1, 1);
            if self.function.is_outside(centre, half[0].hypot(half[1])) {
                return Ok(());
            }
        }
        self.least = self.least.min(if is_fine { dip } else { least });
        if is_fine && has_dip {
            // Narrower than the spacing that it asks for: nothing but the bound tells of it.
            self.found.push(Source::point(place(self.lattice, cell, 1, 1), dip, self.growth));
        }
        if steep.peek().is_some() && is_fine {
            for &[a, b] in steep {
                let (row, column) = if value(a) < value(b) { a } else { b };
                let at = place(self.lattice, cell, row, column);
                self.found.push(Source::point(at, values[row][column], self.growth));
            }
            if self.found.len() > MOST_SOURCES {
                return Err(CloudError::TooFine { spacing: self.least, limit: MAX_GRID_POINTS, place: "" });
            }
        } else if !is_fine && (is_uneven || has_dip) {
            self.suspects = self.suspects.map(|n| n + usize::from(has_dip));
            for (k, child) in cell.children().into_iter().enumerate() {
                self.visit(child, Some(corners_of_child(&values, k)))?;
            }
        }
        Ok(())
    }
}

/// True for a cell right of the envelope or above it.
pub(crate) fn is_beyond(lattice: &NestedLattice, cell: Cell) -> bool {
    let beyond = |d: usize, i: i64| {
        let n = i64::from(lattice.cells[d]);
        if cell.depth >= 0 { i >= n << cell.depth } else { i << -cell.depth >= n }
    };
    beyond(0, cell.i) || beyond(1, cell.j)
}
