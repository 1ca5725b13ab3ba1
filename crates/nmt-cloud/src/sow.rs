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
use crate::gradual::{Nine, corners_of_child, first_depth, is_beyond, nine, range};
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
    sower.sown.xy.extend_from_slice(field.boundary.xy());
    for &p in field.boundary.xy() {
        sower.sown.asked.push(field.spacing.at(p)?);
    }
    sower.run()?;
    Ok(sower.sown)
}

/// Where a cell lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Standing {
    /// In the material, and clear of the boundary with all its nodes, wherever they move.
    Inside,
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
            first_depth: field.spacing.function().map_or(i32::MIN, |_| first_depth(lattice)),
            counts_only,
            counted: 0.0,
            candidates: (0..field.spacing.sources().len() as u32).collect(),
            abscissae: Vec::new(),
            sown: Sown::default(),
        }
    }

    fn run(&mut self) -> Result<(), CloudError> {
        let all = 0..self.candidates.len();
        self.visit(self.lattice.root(), Standing::Near, all, None)
    }

    fn source(&self, number: u32) -> &Source {
        &self.field.spacing.sources()[number as usize]
    }

    /// Sows a cell: `candidates` are the sources that matter in the cell around it, `corners` the function's values.
    fn visit(
        &mut self,
        cell: Cell,
        standing: Standing,
        candidates: std::ops::Range<usize>,
        corners: Option<[f64; 4]>,
    ) -> Result<(), CloudError> {
        if is_beyond(self.lattice, cell) {
            return Ok(());
        }
        let corner = self.lattice.corner(cell);
        let side = self.lattice.spacing().map(|s| s * 0.5f64.powi(cell.depth));
        let centre = along(corner, 0.5, side);
        let radius = 0.5 * side[0].hypot(side[1]);
        let (mut least, mut most) = (self.field.spacing.most(), self.field.spacing.most());
        let waits = cell.depth < self.first_depth; // the function is not looked at yet
        let mut values: Option<Nine> = None;
        if let (Some(function), false) = (self.field.spacing.function(), waits) {
            let v = nine(self.lattice, cell, corners, function)?;
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
        let &Known { corner, side, least, most, waits, ref own, ref values } = known;
        let standing = match standing {
            Standing::Inside => standing,
            Standing::Near => {
                let clearance = self.field.clearance;
                let widest = (WIDEST * most).min(self.field.spacing.most());
                let reach = widest * clearance.edge.max(clearance.node) + most * self.field.moves;
                let room = SAME_POINT_REL * clearance.size;
                let (centre, radius) = (along(corner, 0.5, side), 0.5 * side[0].hypot(side[1]));
                if self.index.any_within(centre, radius + reach * (1.0 + REACH_ROOM_REL) + room) {
                    standing
                } else if self.index.locate(centre) == Location::Inside {
                    Standing::Inside
                } else {
                    return Ok(());
                }
            }
        };
        let [coarsest, finest] = [most, least].map(|h| self.levels.level_of(h));
        // Twice the depth is the level that the cell is a cell of.
        let own_level = 2 * i64::from(cell.depth);
        let even = coarsest == finest && (standing == Standing::Inside || own_level + 2 >= coarsest as i64);
        if !waits && even && coarsest as i64 >= own_level {
            return self.sow_block(cell, coarsest, standing, known);
        }
        if !waits && own_level >= finest as i64 {
            let from_function = values.as_ref().map_or(self.field.spacing.most(), |v| v[0][0]);
            let h = self.asked(corner, own.clone(), from_function);
            if cell.level_of_corner() <= self.levels.level_of(h) {
                self.count(1.0)?;
                self.sow_site(corner, h, standing)?;
            }
            return Ok(());
        }
        for (k, child) in cell.children().into_iter().enumerate() {
            let corners = values.as_ref().map(|v| corners_of_child(v, k));
            self.visit(child, standing, own.clone(), corners)?;
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

    fn sow_row(&mut self, abscissae: &[f64], y: f64, standing: Standing, known: &Known) -> Result<(), CloudError> {
        let Known { own, values, .. } = known;
        let most = self.field.spacing.most();
        if standing == Standing::Inside && own.is_empty() && values.is_none() {
            self.sown.xy.extend(abscissae.iter().map(|&x| [x, y]));
            self.sown.asked.resize(self.sown.xy.len(), most);
            self.sown.census.grid += abscissae.len();
            self.sown.census.kept += abscissae.len();
            return Ok(());
        }
        for &x in abscissae {
            // Clearances are decided by the function itself: the same whichever way cells lie.
            let from_function = match (values, self.field.spacing.function(), standing) {
                (Some(v), _, Standing::Inside) => known.interpolated(v, [x, y]),
                (_, Some(function), Standing::Near) => function.at([x, y])?,
                _ => most,
            };
            let h = self.asked([x, y], own.clone(), from_function);
            self.sow_site([x, y], h, standing)?;
        }
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
    /// The function at `p`, linear along x and along y between the nine values.
    fn interpolated(&self, v: &Nine, p: Point) -> f64 {
        let u: [f64; 2] = std::array::from_fn(|d| 2.0 * (p[d] - self.corner[d]) / self.side[d]);
        let [column, row] = u.map(|u| usize::from(u >= 1.0));
        let [s, t] = [u[0] - column as f64, u[1] - row as f64];
        let along_row = |row: usize| v[row][column] + s * (v[row][column + 1] - v[row][column]);
        along_row(row) + t * (along_row(row + 1) - along_row(row))
    }
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
