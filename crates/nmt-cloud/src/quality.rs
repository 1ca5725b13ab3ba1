//! How evenly a cloud fills its section: separation, fill distance, their ratio, variation of the nearest-node distance.

use crate::clearance::{Clearance, SiteSet};
use crate::cloud::Cloud;
use crate::lattice::Lattice;
use crate::nearest::Nearest;
use nmt_geom::point::{cross, distance, distance_squared, dot, lerp, sub};
use nmt_geom::{Location, NodeId, Point, RealBoundary};

/// How evenly nodes are spread; lengths in the user's unit.
///
/// Separation and fill distance as in H. Wendland, *Scattered Data Approximation*, Cambridge 2005, Secs 2.1 and 4.1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CloudQuality {
    /// Half the least distance between two nodes.
    pub separation: f64,
    /// Radius of the largest circle without a node whose centre is in the section.
    pub fill_distance: f64,
    /// Fill distance over separation: √2 for a square grid.
    pub ratio: f64,
    /// Standard deviation of the nearest-node distances over their mean; 0 for a square grid.
    pub nearest_variation: f64,
    /// Nearest-node distances over the spacings asked for; of a graded cloud alone.
    pub achieved: Option<Achieved>,
}

/// Distance of each node from the nearest other one over the spacing asked for there.
///
/// A level of the lattice is 0.84 to 1.19 times what is asked for; where a finer one begins it is 0.6, and beside the
/// boundary half of that.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Achieved {
    /// The least.
    pub min: f64,
    /// The middle one.
    pub median: f64,
    /// The largest.
    pub max: f64,
}

impl Achieved {
    /// Of the ratios of all nodes; `None` for none.
    fn of(mut ratios: Vec<f64>) -> Option<Self> {
        let middle = ratios.len() / 2;
        let min = ratios.iter().copied().min_by(f64::total_cmp)?;
        let max = ratios.iter().copied().max_by(f64::total_cmp)?;
        let (_, median, _) = ratios.select_nth_unstable_by(middle, f64::total_cmp);
        Some(Self { min, median: *median, max })
    }
}

/// Neighbours that a node's Voronoi cell is cut from at first: those of a square grid are the nearest 8, and reach a third
/// as far as these.
const FIRST_NEIGHBOURS: usize = 18;

/// Neighbours that show at once, as a rule, that a cell has no room for a larger circle.
const FEW_NEIGHBOURS: usize = 8;

/// The same as a radius of spacings asked for: on a square lattice of such a spacing the nearest 8 are nearer.
const FEW_REACH: f64 = 1.6;

/// A radius of spacings asked for within which the nearest node is, as a rule.
const NEAREST_REACH: f64 = 1.25;

/// Nodes where the spacing asked for is widest that are looked at first: after them few cells have room for a larger circle.
const WIDEST: usize = 64;

/// A node with more neighbours than this about it stands among much denser ones, as along an edge with a count of its own: its
/// cell is looked at only where none has been nearby.
const DENSE: usize = 256;

/// Nearby is this fraction of the distance that the last such cell reached: the distance from the nearest node changes no faster
/// than the place, so that no circle is missed by more.
const NEARBY: f64 = 0.01;

/// How much farther neighbours are looked for where a cell is not closed yet.
const FARTHER: f64 = 1.6;

/// A bound that exceeds the fill distance by less than this fraction is none to look into.
const BOUND_REL: f64 = 1.0e-9;

/// The quality of a cloud of at least two nodes; `None` for fewer.
///
/// The largest empty circle is looked for about the Voronoi vertices in the section and about the places where sides of Voronoi
/// cells cross the boundary; where an edge has hundreds of nodes to a spacing of the interior, not for all of them, to one
/// per cent. O(n): a tenth of a microsecond for a node amid others of a
/// uniform lattice, a quarter or a third for others, one microsecond where a circle might be the largest.
///
/// ```
/// use nmt_cloud::{CloudParams, Section, generate, quality};
/// use nmt_curve::Outline;
///
/// let plate = Section::solid(Outline::rectangle([0.0, 0.0], [2.0, 1.0]));
/// let cloud = generate(&plate, &CloudParams { nodes: [21, 11], ..CloudParams::default() })?;
/// let q = quality(&cloud).ok_or("no nodes")?;
/// assert!((q.separation - 0.05).abs() < 1e-12 && (q.ratio - 2f64.sqrt()).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn quality(cloud: &Cloud) -> Option<CloudQuality> {
    let xy = cloud.xy();
    if xy.len() < 2 {
        return None;
    }
    let nearest = Nearest::new(xy);
    let boundary = cloud.boundary();
    let mut cells = Cells {
        nearest: &nearest,
        boundary,
        near: Vec::new(),
        corners: Vec::new(),
        next: Vec::new(),
        last_dense: None,
    };
    let inner = Inner::of(cloud);
    let (mut distances, mut fill) = (Distances::default(), 0.0f64);
    let mut ratios = Vec::new();
    let asked = |node: usize| cloud.is_graded().then(|| cloud.local_spacing(NodeId::of(node)));
    for node in widest(cloud) {
        cells.largest_empty_circle(xy[node], &mut fill);
    }
    for (node, &p) in xy.iter().enumerate() {
        let quick = inner.as_ref().and_then(|inner| inner.nearest_distance(node));
        let quick = quick.or_else(|| cells.nearest_among_closer(p, NEAREST_REACH * asked(node)?, fill));
        let quick = quick.or_else(|| {
            let radius = asked(node).map_or_else(|| nearest.first_radius(p, FEW_NEIGHBOURS), |h| FEW_REACH * h);
            cells.nearest_in_narrow_cell(p, radius, fill)
        });
        let distance = quick.or_else(|| cells.largest_empty_circle(p, &mut fill));
        distances.add(distance.unwrap_or(0.0));
        ratios.extend(asked(node).map(|asked| distance.unwrap_or(0.0) / asked));
    }
    for [a, b] in boundary.all_ends() {
        // Between two nodes of the boundary no other is nearer, unless one lies within half a segment of the middle.
        let half = 0.5 * distance(a, b);
        if half > fill {
            fill = fill.max(nearest.distance(lerp(a, b, 0.5)));
        }
    }
    if let Some(inner) = &inner {
        inner.raise(&mut fill, |p, fill| {
            cells.largest_empty_circle(p, fill);
        });
    }
    let Distances { least, .. } = distances;
    Some(CloudQuality {
        separation: 0.5 * least,
        fill_distance: fill,
        ratio: 2.0 * fill / least,
        nearest_variation: distances.variation(),
        achieved: Achieved::of(ratios),
    })
}

/// Some of the nodes of a graded cloud where the spacing asked for is widest; none of others.
fn widest(cloud: &Cloud) -> Vec<usize> {
    if !cloud.is_graded() {
        return Vec::new();
    }
    let asked = |node: usize| cloud.local_spacing(NodeId::of(node));
    let most = (0..cloud.n_nodes()).map(asked).fold(0.0, f64::max);
    let nodes: Vec<usize> = (0..cloud.n_nodes()).filter(|node| asked(*node) >= most).collect();
    nodes.iter().copied().step_by(nodes.len().div_ceil(WIDEST).max(1)).collect()
}

/// Least, sum and sum of squares of distances.
#[derive(Clone, Copy, Debug)]
struct Distances {
    n: f64,
    least: f64,
    sum: f64,
    sum_of_squares: f64,
}

impl Default for Distances {
    fn default() -> Self {
        Self { n: 0.0, least: f64::INFINITY, sum: 0.0, sum_of_squares: 0.0 }
    }
}

impl Distances {
    fn add(&mut self, distance: f64) {
        self.n += 1.0;
        self.least = self.least.min(distance);
        self.sum += distance;
        self.sum_of_squares += distance * distance;
    }

    /// Standard deviation over mean.
    fn variation(&self) -> f64 {
        let mean = self.sum / self.n;
        let variance = (self.sum_of_squares / self.n - mean * mean).max(0.0);
        // What rounding leaves of a difference of equal numbers is none.
        if variance <= 1e-13 * mean * mean { 0.0 } else { variance.sqrt() / mean }
    }
}

/// The part of a cloud amid its lattice, far from the boundary: each node has all its neighbours there.
struct Inner<'a> {
    cloud: &'a Cloud,
    lattice: &'a Lattice,
    sites: &'a [u32],
    nodes: Vec<u32>, // of each site of the part, shape (N_y, N_x)
}

/// Says that a site has no node, or is too near to the boundary.
const NO_NODE: u32 = u32::MAX;

impl<'a> Inner<'a> {
    /// `None` for a cloud that is not from a lattice.
    fn of(cloud: &'a Cloud) -> Option<Self> {
        let (lattice, sites) = (cloud.lattice()?, cloud.sites()?);
        let [h_x, h_y] = lattice.spacing();
        // Farther than this from the boundary all sites within two rows and columns have nodes, and no boundary passes.
        let Clearance { stretch, .. } = *cloud.clearance();
        let reach = cloud.clearance().reach() * stretch[0].max(stretch[1]) + 3.0 * h_x.hypot(h_y);
        let near = SiteSet::near(lattice, cloud.boundary(), &Clearance::NONE, reach);
        let mut nodes = vec![NO_NODE; lattice.shape[0] * lattice.shape[1]];
        for (&site, node) in sites.iter().zip(cloud.n_boundary() as u32..) {
            if !near.contains(site) {
                nodes[site as usize] = node;
            }
        }
        Some(Self { cloud, lattice, sites, nodes })
    }

    /// Distance from an interior node to the nearest other one, where its eight neighbours on the lattice tell it.
    fn nearest_distance(&self, node: usize) -> Option<f64> {
        let site = *self.sites.get(node.checked_sub(self.cloud.n_boundary())?)?;
        if self.nodes[site as usize] == NO_NODE {
            return None;
        }
        let xy = self.cloud.xy();
        let p = xy[node];
        let [i, j] = self.lattice.site_of(site);
        let mut least = f64::INFINITY;
        for row in [j.wrapping_sub(1), j, j + 1] {
            let first = row.wrapping_mul(self.lattice.shape[0]).wrapping_add(i).wrapping_sub(1);
            let row = self.nodes.get(first..first.wrapping_add(3))?;
            for &other in row {
                if other as usize != node {
                    least = least.min(distance_squared(p, *xy.get(other as usize)?));
                }
            }
        }
        // All others are in boxes beyond these: at least a spacing and what is left of the own box away.
        let (h, own) = (self.lattice.spacing(), self.lattice.site(i, j));
        let beyond = (0..2).fold(f64::INFINITY, |most, d| most.min(1.5 * h[d] - (p[d] - own[d]).abs()));
        let least = least.sqrt();
        (least <= beyond).then_some(least)
    }

    /// Raises `fill` by what lies between four neighbours of the lattice: where they leave room for a larger empty circle,
    /// `look` is asked about them and the nodes around.
    fn raise(&self, fill: &mut f64, mut look: impl FnMut(Point, &mut f64)) {
        let columns = self.lattice.shape[0];
        let xy = self.cloud.xy();
        let bounds = self.nodes.windows(columns + 2).enumerate().filter_map(|(first, w)| {
            // In a window of a row and two more: lower left and right, upper left and right.
            let corners = [w[0], w[1], w[columns + 1], w[columns]];
            let ends_a_row = first % columns == columns - 1;
            if ends_a_row || corners.contains(&NO_NODE) {
                return None;
            }
            Some((first, room_between(corners.map(|node| xy[node as usize]))))
        });
        let mut look_around = |first: usize, fill: &mut f64| {
            let block = (0..4).flat_map(|row| (0..4).map(move |column| first + row * columns + column));
            for slot in block.filter_map(|slot| slot.checked_sub(columns + 1)) {
                if let Some(&p) = self.nodes.get(slot).and_then(|node| xy.get(*node as usize)) {
                    look(p, fill);
                }
            }
        };
        // The widest room first: it makes most of the others too narrow.
        if let Some((first, _)) = bounds.clone().max_by(|a, b| a.1.total_cmp(&b.1)) {
            look_around(first, fill);
        }
        for (first, squared) in bounds {
            if squared > *fill * *fill * (1.0 + 2.0 * BOUND_REL) {
                look_around(first, fill);
            }
        }
    }
}

/// Square of the distance that a point within a quadrilateral can have from its nearest corner, at most, by the better of
/// the two diagonals; corners in order around.
fn room_between([a, b, c, d]: [Point; 4]) -> f64 {
    let by_ac = room_in_triangle([a, b, c]).max(room_in_triangle([a, c, d]));
    let by_bd = room_in_triangle([a, b, d]).max(room_in_triangle([b, c, d]));
    by_ac.min(by_bd)
}

/// Square of the distance that a point within a triangle can have from its nearest corner, at most: the circumradius, or
/// where an angle is obtuse, the distance from the ends of the longest side to where the bisectors of the others meet it.
fn room_in_triangle([a, b, c]: [Point; 3]) -> f64 {
    let (ab, ac, bc) = (sub(b, a), sub(c, a), sub(c, b));
    let (l_ab, l_ac, l_bc) = (dot(ab, ab), dot(ac, ac), dot(bc, bc));
    let (at_a, at_b, at_c) = (dot(ab, ac), -dot(ab, bc), dot(ac, bc));
    // On the side between the corners with scalar products s and t: l²·m/(4 s²) from the end with the side l beside it.
    let obtuse = |longest: f64, l: f64, s: f64, m: f64, t: f64| 0.25 * longest * (l * l / (s * s)).max(m * m / (t * t));
    if at_a <= 0.0 {
        obtuse(l_bc, l_ab, at_b, l_ac, at_c)
    } else if at_b <= 0.0 {
        obtuse(l_ac, l_ab, at_a, l_bc, at_c)
    } else if at_c <= 0.0 {
        obtuse(l_ab, l_ac, at_a, l_bc, at_b)
    } else {
        let twice_area = cross(ab, ac);
        0.25 * l_ab * l_ac * l_bc / (twice_area * twice_area)
    }
}

/// What nodes around a node leave of its Voronoi cell, by eight sectors of directions: found without a branch.
///
/// The cell ends at 1/(2g) in the direction u, g the largest u·q/q² of all offsets q of nodes. In a sector between the directions
/// v and w that is at least the lesser of v·q/q² and w·q/q², be q what it may.
struct Sectors {
    least: f64,         // q² of the nearest
    ahead: [f64; 4],    // at least g in each of the sectors from 22.5° on
    opposite: [f64; 4], // at most −g in those opposite
}

impl Sectors {
    /// Of a node with no other around.
    const EMPTY: Self = Self { least: f64::INFINITY, ahead: [0.0; 4], opposite: [0.0; 4] };

    /// The directions between which sectors lie, and the opposite ones.
    const LIMITS: [[f64; 4]; 2] = {
        let (cos, sin) = (0.923_879_532_511_286_7, 0.382_683_432_365_089_8); // of 22.5°
        [[cos, sin, -sin, -cos], [sin, cos, cos, sin]]
    };

    /// Takes in a node by its offset; the node itself, whose offset is 0, changes nothing.
    #[inline(always)]
    fn add(&mut self, q: Point) {
        let square = dot(q, q);
        let square = if square > 0.0 { square } else { f64::INFINITY };
        let [x, y] = q.map(|c| c / square);
        let least = |a: f64, b: f64| if a < b { a } else { b };
        let largest = |a: f64, b: f64| if a > b { a } else { b };
        self.least = least(self.least, square);
        let [by_x, by_y] = Self::LIMITS;
        let at: [f64; 4] = std::array::from_fn(|k| by_x[k] * x + by_y[k] * y);
        let next = [at[1], at[2], at[3], -at[0]];
        for k in 0..4 {
            self.ahead[k] = largest(self.ahead[k], least(at[k], next[k]));
            self.opposite[k] = least(self.opposite[k], largest(at[k], next[k]));
        }
    }

    /// Whether no point of the cell is farther than `reach`.
    fn are_within(&self, reach: f64) -> bool {
        let enough = 0.5 / reach;
        self.ahead.iter().all(|g| *g >= enough) && self.opposite.iter().all(|g| -g >= enough)
    }
}

/// Voronoi cells of the nodes, one at a time.
struct Cells<'a> {
    nearest: &'a Nearest<'a>,
    boundary: &'a RealBoundary,
    near: Vec<(f64, Point)>, // distance², offset from the node
    corners: Vec<Point>,     // of the cell, offsets from the node, counter-clockwise
    next: Vec<Point>,
    last_dense: Option<(Point, f64)>, // the last node among many that was looked at, and how far
}

impl Cells<'_> {
    /// Raises `fill` to the distance of `p` from the corners of its cell that lie in the section; returns the distance from
    /// `p` to the nearest other node, `None` where there is no other.
    ///
    /// A corner is right where all nodes within twice its distance are known. Others count only if they are in the section:
    /// then nodes farther away are looked at.
    fn largest_empty_circle(&mut self, p: Point, fill: &mut f64) -> Option<f64> {
        let mut radius = self.nearest.first_radius(p, FIRST_NEIGHBOURS);
        loop {
            let all = self.nearest.reaches_all(p, radius);
            self.find_neighbours(p, if all { f64::INFINITY } else { radius });
            self.near.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
            self.cut_cell(radius, 0.0);
            let right = if all { f64::INFINITY } else { 0.5 * radius };
            let open = self.corners.iter().any(|&c| dot(c, c) > right * right && self.is_inside(p, c));
            if open || (self.near.is_empty() && !all) {
                let looked_at = self.last_dense.is_some_and(|(q, reach)| distance(p, q) < NEARBY * reach);
                if self.near.len() > DENSE && looked_at {
                    return self.near.first().map(|(d2, _)| d2.sqrt());
                }
                radius *= FARTHER;
                continue;
            }
            if self.near.len() > DENSE {
                self.last_dense = Some((p, radius));
            }
            for k in 0..self.corners.len() {
                let c = self.corners[k];
                let d2 = dot(c, c);
                if d2 > *fill * *fill && d2 <= right * right && self.is_inside(p, c) {
                    *fill = d2.sqrt();
                }
            }
            self.meet_boundary(p, right, fill);
            return self.near.first().map(|(d2, _)| d2.sqrt());
        }
    }

    /// The distance from `p` to the nearest other node, where it is within `radius` and nodes about that near show that no point
    /// of the cell of `p` is farther from it than `fill`: so it is where nodes are much closer than elsewhere.
    fn nearest_among_closer(&self, p: Point, radius: f64, fill: f64) -> Option<f64> {
        let mut sectors = Sectors::EMPTY;
        self.nearest.visit_all(p, radius, &mut |_, q| sectors.add(sub(q, p)));
        (sectors.least <= radius * radius && sectors.are_within(fill)).then(|| sectors.least.sqrt())
    }

    /// The distance from `p` to the nearest other node, where the nodes within `radius` show that no point of its cell is farther
    /// from it than `fill`: they cut a cell that is no smaller than its own.
    fn nearest_in_narrow_cell(&mut self, p: Point, radius: f64, fill: f64) -> Option<f64> {
        self.find_neighbours(p, radius);
        let least = self.near.iter().map(|(d2, _)| *d2).min_by(f64::total_cmp)?;
        // The nearer ones first: they cut off most.
        let mut n_nearer = 0;
        for k in 0..self.near.len() {
            if self.near[k].0 <= 0.5 * radius * radius {
                self.near.swap(n_nearer, k);
                n_nearer += 1;
            }
        }
        // The square that they are cut from reaches beyond `fill`, so that none of its own sides is left where all is nearer.
        (fill > 0.0 && self.cut_cell(2.0 * fill, fill * fill) <= fill * fill).then(|| least.sqrt())
    }

    /// Raises `fill` to the distance of `p` from where the sides of its cell cross the boundary: circles about places of the
    /// boundary itself.
    fn meet_boundary(&self, p: Point, right: f64, fill: &mut f64) {
        let index = self.boundary.index();
        for (k, &c) in self.corners.iter().enumerate() {
            let d = self.corners[(k + 1) % self.corners.len()];
            if dot(c, c).max(dot(d, d)) <= *fill * *fill {
                continue;
            }
            let (from, side) = ([p[0] + c[0], p[1] + c[1]], sub(d, c));
            index.candidates(from, [p[0] + d[0], p[1] + d[1]], 0.0, |s| {
                let [a, b] = index.segment(s);
                let (along, to_a) = (sub(b, a), sub(a, from));
                let denominator = cross(side, along);
                let (t, u) = (cross(to_a, along) / denominator, cross(to_a, side) / denominator);
                if (0.0..=1.0).contains(&t) && (0.0..=1.0).contains(&u) {
                    let reach = dot(lerp(c, d, t), lerp(c, d, t)).sqrt();
                    if reach <= right {
                        *fill = fill.max(reach);
                    }
                }
            });
        }
    }

    fn is_inside(&self, p: Point, offset: Point) -> bool {
        self.boundary.index().locate([p[0] + offset[0], p[1] + offset[1]]) != Location::Outside
    }

    fn find_neighbours(&mut self, p: Point, radius: f64) {
        let near = &mut self.near;
        near.clear();
        let within = radius * radius;
        self.nearest.visit_all(p, radius, &mut |_, q| {
            let d2 = distance_squared(p, q);
            if d2 > 0.0 && d2 <= within {
                near.push((d2, sub(q, p)));
            }
        });
    }

    /// The square of half side `half`, cut by the bisectors of the neighbours; the square of the distance of its farthest corner. It
    /// may be larger than the cell where that is `enough` or less.
    fn cut_cell(&mut self, half: f64, enough: f64) -> f64 {
        let r = half;
        self.corners.clear();
        self.corners.extend([[-r, -r], [r, -r], [r, r], [-r, r]]);
        let mut farthest = 2.0 * r * r;
        for &(d2, q) in &self.near {
            // Beyond twice the farthest corner a bisector cuts nothing.
            if d2 > 4.0 * farthest {
                continue;
            }
            let beyond = |c: Point| dot(c, q) - 0.5 * d2;
            if self.corners.iter().all(|&c| beyond(c) <= 0.0) {
                continue;
            }
            self.next.clear();
            for (k, &c) in self.corners.iter().enumerate() {
                let following = self.corners[(k + 1) % self.corners.len()];
                let (s, t) = (beyond(c), beyond(following));
                if s <= 0.0 {
                    self.next.push(c);
                }
                if (s < 0.0 && t > 0.0) || (s > 0.0 && t < 0.0) {
                    self.next.push(lerp(c, following, s / (s - t)));
                }
            }
            std::mem::swap(&mut self.corners, &mut self.next);
            farthest = self.corners.iter().fold(0.0, |most, &c| dot(c, c).max(most));
            if farthest <= enough {
                break;
            }
        }
        farthest
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::section::{CloudParams, Section};
    use crate::{Census, Grading, generate};
    use nmt_curve::Outline;
    use nmt_geom::{BoundaryLoop, EdgeId, NodeId};
    use proptest::prelude::*;

    fn square_cloud(interior: Vec<Point>) -> Cloud {
        let corners = vec![[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]];
        let ring = BoundaryLoop { nodes: (0..4).map(NodeId).collect(), edges: (0..4).map(EdgeId).collect() };
        let boundary = RealBoundary::new(corners, vec![ring]).expect("a square");
        Cloud::from_parts(boundary, 4, interior, [1.0, 1.0], Census::default())
    }

    #[test]
    fn sectors_reach_as_far_as_the_cell_and_not_much_farther() {
        // A square lattice: its corners are 1/√2 away, and the sectors about them see that but for cos 22.5°.
        let mut sectors = Sectors::EMPTY;
        for q in (0..9).map(|k| [f64::from(k % 3) - 1.0, f64::from(k / 3) - 1.0]) {
            sectors.add(q);
        }
        let reach = 0.5f64.sqrt() / (std::f64::consts::PI / 8.0).cos();
        assert!(sectors.least == 1.0 && sectors.are_within(1.0001 * reach) && !sectors.are_within(0.9999 * reach));
        // Without the nodes on one side it is open there.
        let mut sectors = Sectors::EMPTY;
        (0..6).for_each(|k| sectors.add([f64::from(k % 3) - 1.0, f64::from(k / 3) - 1.0]));
        assert!(!sectors.are_within(1e9));
    }

    proptest! {
        #[test]
        fn what_sectors_cut_off_is_beyond_a_bisector(
            offsets in prop::collection::vec(prop::array::uniform2(-2.0..2.0f64), 3..25),
            reach in 0.5..20.0f64,
        ) {
            let mut sectors = Sectors::EMPTY;
            offsets.iter().for_each(|q| sectors.add(*q));
            let least = offsets.iter().map(|q| dot(*q, *q)).fold(f64::INFINITY, f64::min);
            prop_assert_eq!(sectors.least, least);
            if sectors.are_within(reach) {
                for k in 0..720 {
                    let (sin, cos) = (f64::from(k) * std::f64::consts::PI / 360.0).sin_cos();
                    let is_beyond = |q: &Point| 2.0 * dot([reach * cos, reach * sin], *q) > dot(*q, *q) * (1.0 - 1e-12);
                    prop_assert!(offsets.iter().any(is_beyond), "{} half degrees", k);
                }
            }
        }
    }

    #[test]
    fn a_few_nodes_have_the_circles_of_a_compass() {
        // Four corners: the largest empty circle is about the middle.
        let q = quality(&square_cloud(vec![])).unwrap();
        assert_eq!((q.separation, q.nearest_variation), (2.0, 0.0));
        assert!((q.fill_distance - 8f64.sqrt()).abs() < 1e-12);
        // With a node in the middle it is about the middles of the sides.
        let q = quality(&square_cloud(vec![[2.0, 2.0]])).unwrap();
        assert!((q.fill_distance - 2.0).abs() < 1e-12 && (q.separation - 2f64.sqrt()).abs() < 1e-12);
    }

    #[test]
    fn the_fill_distance_is_that_of_a_fine_sampling() {
        let section = Section {
            contour: Outline::polygon([[0.0, 0.0], [4.0, 0.0], [4.0, 3.0], [3.0, 3.0], [3.0, 1.0], [0.5, 1.2]]),
            holes: vec![Outline::circle([3.5, 1.0], 0.2)],
        };
        let graded = || Some(Grading::default().near([3.0, 1.0], 0.01, 0.3).near([0.0, 0.0], 0.05, 0.2));
        let even =
            [(0.0, [21, 16]), (0.4, [21, 16]), (0.3, [9, 25])].map(|(irregularity, nodes)| (irregularity, nodes, None));
        let uneven = [0.0, 0.3, 0.49].map(|irregularity| (irregularity, [21, 16], graded()));
        for (irregularity, nodes, grading) in even.into_iter().chain(uneven) {
            let params = CloudParams { nodes, irregularity, grading, ..CloudParams::default() };
            let cloud = generate(&section, &params).unwrap();
            let q = quality(&cloud).unwrap();
            let nearest = Nearest::new(cloud.xy());
            let n = 600;
            let sampled = (0..n * n)
                .map(|k| [4.0 * (k % n) as f64 / n as f64, 3.0 * (k / n) as f64 / n as f64])
                .filter(|p| cloud.boundary().index().locate(*p) == Location::Inside)
                .fold(0.0f64, |most, p| most.max(nearest.distance(p)));
            // The sampling misses the centre by half of its own spacing at most, 0.0042.
            assert!(q.fill_distance >= sampled && q.fill_distance < sampled + 5e-3, "{q:?}, sampled {sampled}");
            let closest =
                cloud.xy().iter().enumerate().flat_map(|(i, p)| cloud.xy()[..i].iter().map(move |q| distance(*p, *q)));
            assert!((2.0 * q.separation - closest.fold(f64::INFINITY, f64::min)).abs() < 1e-12);
        }
    }

    #[test]
    fn the_lattice_is_a_short_cut_to_the_same_numbers() {
        let section = Section {
            contour: Outline::rectangle([0.0, 0.0], [4.0, 3.0]),
            holes: vec![Outline::circle([2.0, 1.3], 0.4)],
        };
        for (irregularity, nodes) in [(0.0, [41, 31]), (0.25, [41, 31]), (0.49, [61, 61]), (0.4, [25, 60])] {
            for seed in 0..4 {
                let cloud =
                    generate(&section, &CloudParams { nodes, irregularity, seed, ..CloudParams::default() }).unwrap();
                let interior = cloud.xy()[cloud.n_boundary()..].to_vec();
                let plain = Cloud::from_parts(
                    cloud.boundary().clone(),
                    cloud.n_vertices(),
                    interior,
                    cloud.spacing(),
                    cloud.census(),
                );
                let (short, long) = (quality(&cloud).unwrap(), quality(&plain).unwrap());
                let same = |a: f64, b: f64| (a - b).abs() <= 1e-9 * b; // the bound that ends the search
                assert!(same(short.separation, long.separation) && same(short.fill_distance, long.fill_distance));
                assert!(same(short.nearest_variation, long.nearest_variation), "{short:?}, {long:?}");
            }
        }
    }

    #[test]
    fn the_room_in_a_triangle_is_that_of_a_fine_sampling() {
        for [a, b, c] in [
            [[0.0, 0.0], [1.0, 0.0], [0.4, 0.8]],
            [[0.0, 0.0], [1.0, 0.0], [0.3, 0.1]],
            [[0.2, 0.1], [0.0, 0.0], [1.0, 0.0]],
            [[1.0, 0.0], [0.6, 0.05], [0.0, 0.0]],
        ] {
            let mut most = 0.0f64;
            for i in 0..400 {
                for j in 0..400 - i {
                    let (s, t) = (f64::from(i) / 399.0, f64::from(j) / 399.0);
                    let p = [0, 1].map(|d: usize| a[d] + s * (b[d] - a[d]) + t * (c[d] - a[d]));
                    most = most.max([a, b, c].iter().map(|q| distance(p, *q)).fold(f64::INFINITY, f64::min));
                }
            }
            let room = room_in_triangle([a, b, c]).sqrt();
            assert!(room >= most - 1e-12 && room < most + 5e-3, "{room}, sampled {most}"); // the sampling's spacing
        }
    }

    #[test]
    fn a_circle_about_a_place_of_the_boundary_is_found() {
        // A side of two segments, and clearances that leave a strip along it: the circle about (1.13, 0), not about its middle.
        let mut contour = Outline::polygon([[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]]);
        contour.edges[0].nodes = Some(3);
        let params = CloudParams {
            nodes: [6, 6],
            clearance: crate::ClearanceUnit::Scaled,
            edge_clearance: 0.9,
            ..CloudParams::default()
        };
        let cloud = generate(&Section::solid(contour), &params).unwrap();
        let nearest = Nearest::new(cloud.xy());
        let sampled = (0..4000).map(|k| nearest.distance([f64::from(k) * 1e-3, 0.0])).fold(0.0, f64::max);
        let q = quality(&cloud).unwrap();
        assert!(q.fill_distance >= sampled && q.fill_distance < sampled + 1e-3, "{q:?}, sampled {sampled}");
    }

    #[test]
    fn a_cloud_with_a_large_void_tells_it() {
        // Nodes along the sides alone: the circle about the middle touches all of them.
        let mut interior = Vec::new();
        for k in 1..8 {
            let s = f64::from(k) * 0.5;
            interior.extend([[s, 0.25], [s, 3.75], [0.25, s], [3.75, s]]);
        }
        let q = quality(&square_cloud(interior)).unwrap();
        assert!((q.fill_distance - 1.75).abs() < 1e-9, "{q:?}");
    }
}
