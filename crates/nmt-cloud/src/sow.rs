//! Interior nodes of a graded cloud: each level's sites sieved by where the spacing asks for that level.
//!
//! A site that first appears at level k is a node where the spacing asks for level k or a finer one. With |∇h| ≤ ½ the sites
//! around it that are of coarser levels are then nodes too, so that the nodes are the corners of right isosceles triangles,
//! each as large as its neighbours or by √2 larger or smaller. Cells of the hierarchy are halved until one level does for
//! all of a cell: most nodes are sown in whole blocks.

use crate::census::Census;
use crate::clearance::Clearance;
use crate::error::CloudError;
use crate::generate::MAX_GRID_POINTS;
use crate::gradual::{Nine, bend, corners_of_child, is_beyond, nine, nine_of_child, range};
use crate::nested::{Cell, Levels, NestedLattice};
use crate::sources::Source;
use crate::spacing::Spacing;
use nmt_geom::point::along;
use nmt_geom::tol::SAME_POINT_REL;
use nmt_geom::{Location, LoopId, Point, RealBoundary, SegmentIndex, segment};

/// The widest lattice spacing about a site is at most so many times what is asked for: a level more than ⁴√2, rounded up.
const WIDEST: f64 = 1.7;

/// Room for rounding about the reach of a clearance, as a fraction of it.
const REACH_ROOM_REL: f64 = 1.0e-9;

/// Levels are looked for within so many spacings of a site: what lies farther away is no neighbour.
const NEARBY: f64 = 1.5;

/// Places along x and along y by which the number of nodes is foretold, and how much more room is made.
const SAMPLES_ACROSS: u32 = 32;
const EXPECTED_ROOM: f64 = 1.1;

/// The most nodes that a place may foretell, were they all over the envelope.
const FINEST_SAMPLE: f64 = 1.0e7;

/// With fewer nodes than this the most that there can be is room for.
const WORTH_EXPECTING: f64 = 1.0e4;

/// A function whose second differences in a cell are at most this part of it is linear there between nine values.
const LINEAR: f64 = 2.0e-3;

/// A cell between levels is halved so often at once.
const MOST_HALVINGS: i64 = 2;

/// Nodes within so many spacings of the boundary are beside it.
const BESIDE: usize = 6;

/// Clearances in units of the local spacing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LocalClearance {
    /// From segments, ⅓ in the paper.
    pub edge: f64,
    /// From boundary nodes, ½ in the paper.
    pub node: f64,
    /// Diagonal of the envelope.
    pub size: f64,
}

impl LocalClearance {
    /// The least distances of a node whose spacing is `h`.
    pub fn at(&self, h: f64) -> Clearance {
        Clearance::of_spacing(h, self.size, self.edge, self.node)
    }
}

/// The nodes of a graded cloud.
#[derive(Debug, Default)]
pub(crate) struct Sown {
    /// Those of the boundary, then the interior ones.
    pub xy: Vec<Point>,
    /// The spacing asked for at each.
    pub asked: Vec<f64>,
    /// Numbers of the interior nodes, the first being 0, that a displacement could bring too near to the boundary, ascending.
    pub exposed: Vec<u32>,
    /// Others within a few spacings of the boundary.
    pub beside: Vec<u32>,
    pub census: Census,
}

/// What nodes are sown by.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Field<'a> {
    pub spacing: &'a Spacing,
    pub boundary: &'a RealBoundary,
    pub clearance: LocalClearance,
    /// How far a node may be displaced, in spacings.
    pub moves: f64,
}

/// Sows the nodes: in the order of the hierarchy's cells, lower left, lower right, upper left, upper right, and rows in
/// each block. O(nodes + cells along the boundary and between levels).
///
/// # Errors
/// [`CloudError::TooFine`] for more than [`MAX_GRID_POINTS`], [`CloudError::NotASpacing`].
pub(crate) fn sow(field: &Field) -> Result<Sown, CloudError> {
    // Many nodes are counted before they are made.
    let (least, lattice) = (field.spacing.finest(), field.spacing.lattice());
    if lattice.extent[0] * lattice.extent[1] > 0.25 * MAX_GRID_POINTS * least * least {
        Sower::new(field, true).run()?;
    }
    let mut sower = Sower::new(field, false);
    let room = field.boundary.xy().len() + expected(field);
    sower.sown.xy.reserve(room);
    sower.sown.asked.reserve(room);
    sower.sown.xy.extend_from_slice(field.boundary.xy());
    for &p in field.boundary.xy() {
        sower.sown.asked.push(field.spacing.at(p)?);
    }
    sower.run()?;
    Ok(sower.sown)
}

/// About how many nodes there will be: ∫dA/h² by some places of the section, for room that need not grow node by node.
///
/// What is refined between those places is not seen.
fn expected(field: &Field) -> usize {
    let NestedLattice { origin, extent, .. } = *field.spacing.lattice();
    let [least, most] = [field.spacing.finest(), field.spacing.most()];
    let area = extent[0] * extent[1];
    if area < WORTH_EXPECTING * least * least {
        return (area / (least * least)) as usize;
    }
    let index = field.boundary.index();
    let part = |k: u32| (f64::from(k) + 0.5) / f64::from(SAMPLES_ACROSS);
    let places = (0..SAMPLES_ACROSS).flat_map(|i| (0..SAMPLES_ACROSS).map(move |j| [part(i), part(j)]));
    // A place on a point of refinement does not speak for all around it.
    let believed = (area / FINEST_SAMPLE).sqrt();
    let density = |t: [f64; 2]| {
        let p = [origin[0] + t[0] * extent[0], origin[1] + t[1] * extent[1]];
        let is_inside = index.locate(p) == Location::Inside;
        if is_inside { field.spacing.at(p).unwrap_or(most).max(believed).powi(-2) } else { 0.0 }
    };
    let sum: f64 = places.map(density).sum();
    (EXPECTED_ROOM * sum * area / f64::from(SAMPLES_ACROSS * SAMPLES_ACROSS)) as usize
}

/// Where a cell lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Standing {
    /// In the material, and clear of the boundary with all its nodes, wherever they move.
    Inside,
    /// Inside, but not known to be farther than [`BESIDE`] spacings from the boundary.
    Beside,
    /// Not known to be.
    Near,
}

struct Sower<'a> {
    field: &'a Field<'a>,
    lattice: &'a NestedLattice,
    levels: Levels,
    index: &'a SegmentIndex,
    first_depth: i32,
    counts_only: bool,
    counted: f64,
    candidates: Vec<u32>, // sources that matter in a cell: a stack of lists
    abscissae: Vec<f64>,
    sown: Sown,
}

impl<'a> Sower<'a> {
    fn new(field: &'a Field<'a>, counts_only: bool) -> Self {
        let lattice = field.spacing.lattice();
        Self {
            field,
            lattice,
            levels: lattice.levels(),
            index: field.boundary.index(),
            first_depth: field.spacing.function_and_look().map_or(i32::MIN, |(_, look)| look.depth()),
            counts_only,
            counted: 0.0,
            candidates: (0..field.spacing.sources().len() as u32).collect(),
            abscissae: Vec::new(),
            sown: Sown::default(),
        }
    }

    fn run(&mut self) -> Result<(), CloudError> {
        let all = 0..self.candidates.len();
        self.visit(self.lattice.root(), Standing::Near, all, Given::Nothing)
    }

    fn source(&self, number: u32) -> &Source {
        &self.field.spacing.sources()[number as usize]
    }

    /// Sows a cell: `candidates` are the sources that matter in the cell around it, `given` what is known of the function.
    fn visit(
        &mut self,
        cell: Cell,
        standing: Standing,
        candidates: std::ops::Range<usize>,
        given: Given,
    ) -> Result<(), CloudError> {
        if is_beyond(self.lattice, cell) {
            return Ok(());
        }
        let corner = self.lattice.corner(cell);
        let side = self.lattice.spacing().map(|s| s * 0.5f64.powi(cell.depth));
        let centre = along(corner, 0.5, side);
        let radius = 0.5 * diagonal(side);
        let (mut least, mut most) = (self.field.spacing.most(), self.field.spacing.most());
        let waits = cell.depth < self.first_depth; // the function is not looked at yet
        let mut values: Option<Nine> = None;
        if let (Some((function, look)), false) = (self.field.spacing.function_and_look(), waits) {
            let v = match given {
                Given::Nothing => look.nine(cell),
                Given::Corners(corners) => nine(self.lattice, cell, corners, function)?,
                Given::Nine(nine) => nine,
            };
            let [low, high] = range(&v);
            (least, most) = (low, high.min(most));
            values = Some(v);
        }
        // What a source or the function gives at most bounds them all: sources that give more everywhere do not matter.
        let mut limit = most;
        for k in candidates.clone() {
            let source = self.source(self.candidates[k]);
            limit = limit.min(source.at(centre) + source.growth * radius);
        }
        let own = self.candidates.len();
        for k in candidates {
            let number = self.candidates[k];
            let source = self.source(number);
            let bound = (source.at(centre) - source.growth * radius).max(source.size);
            if bound < limit {
                least = least.min(bound);
                self.candidates.push(number);
            }
        }
        let (own, most) = (own..self.candidates.len(), limit);
        let least = least.max(self.field.spacing.least());
        let known = Known { corner, side, least, most, waits, own: own.clone(), values };
        let done = self.sow_cell(cell, standing, &known);
        self.candidates.truncate(own.start);
        done
    }

    fn sow_cell(&mut self, cell: Cell, standing: Standing, known: &Known) -> Result<(), CloudError> {
        let &Known { corner, least, most, waits, ref own, ref values, .. } = known;
        let Some(standing) = self.standing_in(standing, known) else { return Ok(()) };
        let [coarsest, finest] = [most, least].map(|h| self.levels.level_of(h));
        // Twice the depth is the level that the cell is a cell of.
        let own_level = 2 * i64::from(cell.depth);
        let even = coarsest == finest && (standing != Standing::Near || own_level + 2 >= coarsest as i64);
        if !waits && even && coarsest as i64 >= own_level {
            return self.sow_block(cell, coarsest, standing, known);
        }
        if !waits && own_level >= finest as i64 {
            let from_function = match (self.field.spacing.function(), values) {
                (Some(function), _) if standing == Standing::Near => function.at(corner)?,
                (_, Some(v)) => v[0][0],
                _ => self.field.spacing.most(),
            };
            let h = self.asked(corner, own.clone(), from_function);
            if cell.level_of_corner() <= self.levels.level_of(h) {
                self.count(1.0)?;
                self.note_beside(standing, 1, 1);
                self.sow_site(corner, h, standing)?;
            }
            return Ok(());
        }
        let is_linear = values.as_ref().is_none_or(|v| bend(v) <= LINEAR * v[1][1]);
        let is_small = !waits && own_level + 2 * MOST_HALVINGS >= finest as i64;
        if is_small && is_linear && standing != Standing::Near {
            return self.sow_sites(cell, [coarsest, finest], standing, known);
        }
        for (k, child) in cell.children().into_iter().enumerate() {
            let given = match values {
                Some(v) if is_linear => Given::Nine(nine_of_child(v, k)),
                Some(v) => Given::Corners(corners_of_child(v, k)),
                None => Given::Nothing,
            };
            self.visit(child, standing, own.clone(), given)?;
        }
        Ok(())
    }

    /// Where a cell lies in a larger one that lies so; `None` outside.
    fn standing_in(&self, standing: Standing, known: &Known) -> Option<Standing> {
        let &Known { corner, side, most, .. } = known;
        let (centre, radius) = (along(corner, 0.5, side), 0.5 * diagonal(side));
        let beside = || {
            let is_beside = self.index.any_within(centre, radius + BESIDE as f64 * most);
            if is_beside { Standing::Beside } else { Standing::Inside }
        };
        match standing {
            Standing::Inside => Some(standing),
            Standing::Beside => Some(beside()),
            Standing::Near => {
                let clearance = self.field.clearance;
                let widest = (WIDEST * most).min(self.field.spacing.most());
                let reach = widest * clearance.edge.max(clearance.node) + most * self.field.moves;
                let room = SAME_POINT_REL * clearance.size;
                if self.index.any_within(centre, radius + reach * (1.0 + REACH_ROOM_REL) + room) {
                    Some(standing)
                } else {
                    (self.index.locate(centre) == Location::Inside).then(beside)
                }
            }
        }
    }

    /// Sows the sites of a small cell between levels, each by the spacing there, in the order of its cells.
    fn sow_sites(
        &mut self,
        cell: Cell,
        [coarsest, finest]: [usize; 2],
        standing: Standing,
        known: &Known,
    ) -> Result<(), CloudError> {
        let shift = finest.div_ceil(2) as i32 - cell.depth;
        let most = self.field.spacing.most();
        for k in 0..1i64 << (2 * shift) {
            // Every other digit of the number is one of the column.
            let place = |k: i64| (0..shift).fold(0, |sum, digit| sum | (k >> digit & 1 << digit));
            let (i, j) = ((cell.i << shift) + place(k), (cell.j << shift) + place(k >> 1));
            let site = Cell { depth: cell.depth + shift, i, j };
            let level = site.level_of_corner();
            if level > finest {
                continue;
            }
            let p = self.lattice.corner(site);
            let from_function = known.values.as_ref().map_or(most, |v| known.interpolated(&known.row(v, p[1]), p[0]));
            let h = self.asked(p, known.own.clone(), from_function);
            if level <= coarsest || level <= self.levels.level_of(h) {
                self.count(1.0)?;
                self.note_beside(standing, 1, 1);
                self.sow_site(p, h, standing)?;
            }
        }
        Ok(())
    }

    /// The spacing at `p`, where the function gives `most`.
    fn asked(&self, p: Point, candidates: std::ops::Range<usize>, most: f64) -> f64 {
        let of_sources = self.candidates[candidates].iter().map(|&number| self.source(number).at(p));
        of_sources.fold(most, f64::min).max(self.field.spacing.least())
    }

    fn count(&mut self, sites: f64) -> Result<(), CloudError> {
        self.counted += sites;
        if self.counted > MAX_GRID_POINTS {
            return Err(CloudError::TooFine {
                spacing: self.field.spacing.finest(),
                limit: MAX_GRID_POINTS,
                place: "",
            });
        }
        Ok(())
    }

    /// Sows all sites of a level in a cell, without its upper and right side.
    fn sow_block(&mut self, cell: Cell, level: usize, standing: Standing, known: &Known) -> Result<(), CloudError> {
        let depth = (level / 2) as i32;
        let shift = (depth - cell.depth) as u32;
        let n = 1i64 << shift;
        let turned = level % 2 == 1;
        self.count((n as f64).powi(2) * if turned { 2.0 } else { 1.0 })?;
        if self.counts_only {
            return Ok(());
        }
        self.note_beside(standing, n as usize, if turned { 2 } else { 1 });
        let (i, j) = (cell.i << shift, cell.j << shift);
        for row in 0..n {
            let mut abscissae = std::mem::take(&mut self.abscissae);
            for centres in 0..=i64::from(turned) {
                abscissae.clear();
                let (depth, step) = (depth + centres as i32, 1 + centres);
                abscissae.extend((0..n).map(|k| self.lattice.coordinate(0, depth, step * (i + k) + centres)));
                let y = self.lattice.coordinate(1, depth, step * (j + row) + centres);
                self.sow_row(&abscissae, y, standing, known)?;
            }
            self.abscissae = abscissae;
        }
        Ok(())
    }

    /// Notes which of the sites that a block is about to get may be beside the boundary: the outer ones of rows of n sites,
    /// n such rows or, with the centres of cells, twice as many.
    fn note_beside(&mut self, standing: Standing, n: usize, rows_a_level: usize) {
        if standing != Standing::Beside || self.counts_only {
            return;
        }
        let first = self.sown.xy.len() - self.field.boundary.xy().len();
        let rows = n * rows_a_level;
        let is_outer = |k: usize, n: usize, by: usize| k < by || k + by >= n;
        for row in 0..rows {
            let start = (first + row * n) as u32;
            let columns = 0..n as u32;
            if is_outer(row, rows, BESIDE * rows_a_level) {
                self.sown.beside.extend(columns.map(|k| start + k));
            } else {
                let outer = columns.filter(|&k| is_outer(k as usize, n, BESIDE));
                self.sown.beside.extend(outer.map(|k| start + k));
            }
        }
    }

    fn sow_row(&mut self, abscissae: &[f64], y: f64, standing: Standing, known: &Known) -> Result<(), CloudError> {
        let most = self.field.spacing.most();
        if standing == Standing::Near {
            for &x in abscissae {
                // Clearances are decided by the function itself: the same whichever way cells lie.
                let from_function = self.field.spacing.function().map_or(Ok(most), |function| function.at([x, y]))?;
                let h = self.asked([x, y], known.own.clone(), from_function);
                self.sow_site([x, y], h, standing)?;
            }
            return Ok(());
        }
        let Sown { xy, asked, census, .. } = &mut self.sown;
        let first = asked.len();
        xy.extend(abscissae.iter().map(|&x| [x, y]));
        match &known.values {
            Some(values) => {
                let row = known.row(values, y);
                asked.extend(abscissae.iter().map(|&x| known.interpolated(&row, x)));
            }
            None => asked.resize(xy.len(), most),
        }
        for &number in &self.candidates[known.own.clone()] {
            let source = &self.field.spacing.sources()[number as usize];
            let at_sites = abscissae.iter().zip(&mut asked[first..]);
            at_sites.for_each(|(&x, asked)| *asked = asked.min(source.at([x, y])));
        }
        let least = self.field.spacing.least();
        asked[first..].iter_mut().for_each(|asked| *asked = asked.max(least));
        census.grid += abscissae.len();
        census.kept += abscissae.len();
        Ok(())
    }

    /// A site of a level that is asked for: a node where it is inside and clear of the boundary.
    fn sow_site(&mut self, p: Point, h: f64, standing: Standing) -> Result<(), CloudError> {
        if self.counts_only {
            return Ok(());
        }
        if standing == Standing::Near {
            let NestedLattice { origin, extent, .. } = self.lattice;
            if (0..2).any(|d| p[d] <= origin[d] || p[d] >= origin[d] + extent[d]) {
                return Ok(());
            }
        }
        let around = if standing == Standing::Near { self.widest_around(p, h)? } else { h };
        let census = &mut self.sown.census;
        census.grid += 1;
        if standing == Standing::Near {
            let clearance = self.field.clearance.at(around);
            if self.index.locate(p) != Location::Inside {
                let cause = if nearest_is_hole(self.field, p, h) { &mut census.in_hole } else { &mut census.outside };
                *cause += 1;
                return Ok(());
            }
            if !clearance.holds(p, self.index) {
                let by_edge = !Clearance { node: 0.0, ..clearance }.holds(p, self.index);
                *(if by_edge { &mut census.near_edge } else { &mut census.near_node }) += 1;
                return Ok(());
            }
            let n_boundary = self.field.boundary.xy().len();
            self.sown.exposed.push((self.sown.xy.len() - n_boundary) as u32);
        }
        census.kept += 1;
        self.sown.xy.push(p);
        self.sown.asked.push(h);
        Ok(())
    }

    /// The widest lattice spacing about `p`, where `h` is asked for: that of its own level, or of the next coarser one where
    /// that begins nearby, and at least `h`.
    ///
    /// A node half of its own spacing away from the boundary would be less than half as far from its nearest node as a
    /// neighbour on a coarser lattice is.
    fn widest_around(&self, p: Point, h: f64) -> Result<f64, CloudError> {
        let own = self.levels.level_of(h);
        if own == 0 {
            return Ok(self.levels.spacing(0));
        }
        let mut widest = h;
        for [dx, dy] in [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]] {
            let q = [p[0] + NEARBY * h * dx, p[1] + NEARBY * h * dy];
            widest = widest.max(self.field.spacing.at(q)?);
        }
        let level = self.levels.level_of(widest).max(own.saturating_sub(1));
        Ok(h.max(self.levels.spacing(level)))
    }
}

/// What is known of the function in a cell before it is looked at.
enum Given {
    Nothing,
    Corners([f64; 4]),
    Nine(Nine),
}

/// What is known of a cell.
struct Known {
    corner: Point,
    side: [f64; 2],
    least: f64, // spacing in the cell
    most: f64,
    waits: bool,
    own: std::ops::Range<usize>, // its candidates
    values: Option<Nine>,
}

impl Known {
    /// The function at height `y`, linear between the nine values: at the left side, in the middle, and at the right side.
    fn row(&self, v: &Nine, y: f64) -> [f64; 3] {
        let u = 2.0 * (y - self.corner[1]) / self.side[1];
        let row = usize::from(u >= 1.0);
        let t = u - row as f64;
        std::array::from_fn(|column| v[row][column] + t * (v[row + 1][column] - v[row][column]))
    }

    /// The function at abscissa `x` of such a row, linear between its three values.
    #[inline]
    fn interpolated(&self, row: &[f64; 3], x: f64) -> f64 {
        let u = 2.0 * (x - self.corner[0]) / self.side[0];
        let [left, middle, right] = *row;
        if u < 1.0 { left + u * (middle - left) } else { middle + (u - 1.0) * (right - middle) }
    }
}

fn diagonal([x, y]: [f64; 2]) -> f64 {
    (x * x + y * y).sqrt()
}

/// True where the segment nearest to a point outside the material is of a hole.
fn nearest_is_hole(field: &Field, p: Point, h: f64) -> bool {
    let boundary = field.boundary;
    if boundary.n_loops() == 1 {
        return false;
    }
    let index = boundary.index();
    let (mut radius, mut nearest) = (h, None::<(f64, usize)>);
    while nearest.is_none() && radius < 4.0 * field.clearance.size {
        index.candidates(p, p, radius, |k| {
            let [a, b] = index.segment(k);
            let distance = segment::distance_to(p, a, b);
            if distance <= radius && nearest.is_none_or(|(best, _)| distance < best) {
                nearest = Some((distance, k));
            }
        });
        radius *= 4.0;
    }
    nearest.is_some_and(|(_, k)| boundary.loop_of_segment(k) != LoopId::of(0))
}
