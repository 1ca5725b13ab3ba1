//! Neighbours made alike beside the boundary, where nodes of the lattice and nodes of edges meet as they happen to lie.
//!
//! Where a node is less than half as far from its nearest node as a neighbour is from its own, one of the two nodes that lie
//! close together goes, if it is of the lattice and the other one of the boundary; else a node comes between the neighbours.

use crate::nearest::{Nearest, Scratch, TIE_REL};
use crate::sow::{Field, Sown};
use nmt_geom::point::{distance, distance_squared};
use nmt_geom::tol::SAME_POINT_REL;
use nmt_geom::{Location, Point};

/// Nearest-node distances of neighbours shall differ by this factor at most, up to rounding: 2 is that of two levels.
const MOST_RATIO: f64 = 2.0 * (1.0 + ROOM_REL);
const ROOM_REL: f64 = 1.0e-6;

/// Neighbours are looked for within so many spacings.
const REACH: f64 = 3.0;

/// What the nearest-node distance of a node can be at most, and of one away from the boundary at least, as parts of its spacing.
const FARTHEST: f64 = 1.5;
const NEAREST: f64 = 0.6;

/// A new node is no nearer to another than this part of its spacing.
const LEAST_DISTANCE: f64 = 0.4;

/// New nodes nearer to each other than this part of their spacing are made one.
const APART: f64 = 0.6;

/// Changes are looked over again so often: what a new node is too near to is seen then.
const PASSES: usize = 3;

/// Evens out the nodes beside the boundary; `sown.exposed` and `sown.beside` must hold all interior ones within a few
/// spacings of it. O(nodes beside the boundary), and O(nodes) where one goes.
///
/// Decided for all nodes at once, by lengths alone, so that what is symmetric stays so. New nodes come last.
pub(crate) fn even_out(sown: &mut Sown, field: &Field) {
    for _ in 0..PASSES {
        let changes = changes(sown, field);
        if changes.deleted.is_empty() && changes.inserted.is_empty() {
            break;
        }
        changes.make(sown, field.boundary.xy().len());
    }
}

/// What is changed in one pass.
struct Changes {
    /// Numbers of interior nodes, the first being 0, that go; ascending.
    deleted: Vec<u32>,
    /// Nodes that come, and the spacing asked for at each.
    inserted: Vec<(Point, f64)>,
    /// Interior nodes that get a new neighbour; ascending.
    touched: Vec<u32>,
}

impl Changes {
    fn make(self, sown: &mut Sown, n_boundary: usize) {
        let Self { deleted, inserted, touched } = self;
        sown.beside.retain(|k| touched.binary_search(k).is_err());
        sown.exposed.extend(touched);
        sown.exposed.sort_unstable();
        sown.exposed.dedup();
        if !deleted.is_empty() {
            let is_kept =
                |k: usize| k.checked_sub(n_boundary).is_none_or(|k| deleted.binary_search(&(k as u32)).is_err());
            let (mut number, mut same_number) = (0.., 0..);
            sown.xy.retain(|_| number.next().is_none_or(is_kept));
            sown.asked.retain(|_| same_number.next().is_none_or(is_kept));
            for list in [&mut sown.exposed, &mut sown.beside] {
                list.retain(|k| deleted.binary_search(k).is_err());
                list.iter_mut().for_each(|k| *k -= deleted.partition_point(|gone| gone < k) as u32);
            }
            sown.census.kept -= deleted.len();
            sown.census.near_node += deleted.len();
        }
        for (p, asked) in inserted {
            sown.exposed.push((sown.xy.len() - n_boundary) as u32);
            sown.xy.push(p);
            sown.asked.push(asked);
            sown.census.grid += 1;
            sown.census.kept += 1;
        }
    }
}

/// Compares the nodes of the boundary and the exposed ones with their neighbours.
fn changes(sown: &Sown, field: &Field) -> Changes {
    let n_boundary = field.boundary.xy().len();
    let interior: Vec<u32> = sown.exposed.iter().chain(&sown.beside).copied().collect();
    let numbers = || (0..n_boundary).chain(interior.iter().map(|&k| n_boundary + k as usize));
    let xy: Vec<Point> = numbers().map(|k| sown.xy[k]).collect();
    let mut view = View {
        field,
        n_looked_at: n_boundary + sown.exposed.len(),
        xy: &xy,
        asked: numbers().map(|k| sown.asked[k]).collect(),
        index: Nearest::new(&xy),
        nearest: vec![None; xy.len()],
        scratch: Scratch::default(),
        going: Vec::new(),
        gaps: Vec::new(),
    };
    let mut suspects = Vec::new();
    for k in 0..view.n_looked_at {
        view.look_around(k, &mut suspects);
    }
    for (k, o) in suspects {
        view.compare(k, o);
    }
    let View { going, mut gaps, index, .. } = view;
    gaps.sort_unstable_by(|(o, p), (e, q)| o.cmp(e).then(p[1].total_cmp(&q[1])).then(p[0].total_cmp(&q[0])));
    let interior = |k: usize| k.checked_sub(n_boundary).map(|k| interior[k]);
    let touched = gaps.iter().filter_map(|(o, _)| interior(*o));
    // Of several nodes that one neighbour is too far from, a node before them all.
    let new = gaps.chunk_by(|(o, _), (e, _)| o == e).map(|middles| mean(middles.iter().map(|(_, p)| *p)));
    let new = new.filter_map(|p| Some((p, field.spacing.at(p).ok()?))).collect();
    Changes {
        deleted: ascending(going.into_iter().filter_map(interior)),
        touched: ascending(touched),
        inserted: joined(new).into_iter().filter(|(p, asked)| may_lie(*p, *asked, field, &index)).collect(),
    }
}

fn ascending(numbers: impl Iterator<Item = u32>) -> Vec<u32> {
    let mut numbers: Vec<u32> = numbers.collect();
    numbers.sort_unstable();
    numbers.dedup();
    numbers
}

/// The nodes of the boundary, the exposed ones, and others beside the boundary, numbered in this order.
struct View<'a> {
    field: &'a Field<'a>,
    /// The number of those of the boundary and exposed.
    n_looked_at: usize,
    xy: &'a [Point],
    asked: Vec<f64>,
    index: Nearest<'a>,
    /// The nearest other node of each, and its distance, as soon as it is asked for.
    nearest: Vec<Option<(usize, f64)>>,
    scratch: Scratch,
    /// Nodes that go.
    going: Vec<usize>,
    /// Nodes that are too far from a neighbour, and the middles between them.
    gaps: Vec<(usize, Point)>,
}

impl View<'_> {
    /// The nearest other node of node k, and its distance.
    fn nearest_of(&mut self, k: usize) -> (usize, f64) {
        let Self { xy, index, nearest, scratch, .. } = self;
        *nearest[k].get_or_insert_with(|| {
            let mut out = Vec::with_capacity(1);
            index.nearest(xy[k], 1, |other| other.index() != k, scratch, &mut out);
            out.first().map_or((k, f64::INFINITY), |other| (other.index(), distance(xy[k], xy[other.index()])))
        })
    }

    /// Looks for the nearest node of node k, and for pairs of a node and a neighbour of which the first may be less than half as
    /// far from its nearest node: `k` is one of them.
    fn look_around(&mut self, k: usize, suspects: &mut Vec<(usize, usize)>) {
        let (p, reach) = (self.xy[k], REACH * self.asked[k]);
        let mut nearest = (f64::INFINITY, k);
        let first = suspects.len();
        self.index.visit_all(p, reach, &mut |o, q| {
            let (o, d) = (o as usize, distance_squared(p, q));
            if o == k || d >= reach * reach {
                return;
            }
            suspects.push((k, o));
            // Of equal distances that of the lower number.
            let is_nearer = d < nearest.0 * (1.0 - TIE_REL) || d < nearest.0 * (1.0 + TIE_REL) && o < nearest.1;
            if is_nearer {
                nearest = (d, o);
            }
        });
        let near = nearest.0.sqrt();
        if near < reach {
            self.nearest[k] = Some((nearest.1, near));
        }
        let mut to = first;
        for at in first..suspects.len() {
            let (_, o) = suspects[at];
            let asked = self.asked[o];
            if FARTHEST * asked > MOST_RATIO * near {
                suspects[to] = (k, o);
                to += 1;
            } else if o >= self.n_looked_at && near > MOST_RATIO * NEAREST * asked {
                suspects[to] = (o, k);
                to += 1;
            }
        }
        suspects.truncate(to);
    }

    /// Notes what is to be changed where o is a neighbour of k and more than twice as far from its nearest node.
    fn compare(&mut self, k: usize, o: usize) {
        let (n, near) = self.nearest_of(k);
        if self.nearest_of(o).1 <= MOST_RATIO * near || !self.are_neighbours(k, o) {
            return;
        }
        let is_boundary = |k: usize| k < self.field.boundary.xy().len();
        match (is_boundary(k), is_boundary(n)) {
            (true, false) => self.going.push(n),
            (false, true) => self.going.push(k),
            (true, true) if self.is_across_outside(k, n) => {}
            _ => self.gaps.push((o, middle(self.xy[k], self.xy[o]))),
        }
    }

    /// True for two nodes of the boundary that lie on two sides of what is no material, as the walls of a slit.
    fn is_across_outside(&self, k: usize, n: usize) -> bool {
        let middle = middle(self.xy[k], self.xy[n]);
        let index = self.field.boundary.index();
        // The middle of a segment is on it up to rounding.
        !index.any_within(middle, SAME_POINT_REL * self.field.clearance.size)
            && index.locate(middle) == Location::Outside
    }

    /// True for two nodes with no other in the circle about the line between them, whose middle is in the material (Gabriel
    /// neighbours, which share a side in every Delaunay triangulation).
    fn are_neighbours(&self, k: usize, o: usize) -> bool {
        let [p, q] = [self.xy[k], self.xy[o]];
        let middle = middle(p, q);
        self.index.distance(middle) >= 0.5 * distance(p, q) * (1.0 - ROOM_REL)
            && self.field.boundary.index().locate(middle) != Location::Outside
    }
}

/// True where a node keeps its clearances, and its distance from other nodes.
fn may_lie(p: Point, asked: f64, field: &Field, nodes: &Nearest) -> bool {
    if nodes.distance(p) < LEAST_DISTANCE * asked {
        return false;
    }
    let index = field.boundary.index();
    field.clearance.at(asked).holds(p, index) && index.locate(p) == Location::Inside
}

/// The same to the bit whichever is first.
fn middle(p: Point, q: Point) -> Point {
    mean([p, q].into_iter())
}

fn mean(points: impl ExactSizeIterator<Item = Point>) -> Point {
    let n = points.len() as f64;
    points.fold([0.0; 2], |sum, p| [0, 1].map(|d| sum[d] + p[d] / n))
}

/// Places with their spacings, where two that are in each other's way become one; of more those stay that are in the way of fewer
/// than all they are in the way of.
fn joined(places: Vec<(Point, f64)>) -> Vec<(Point, f64)> {
    let xy: Vec<Point> = places.iter().map(|(p, _)| *p).collect();
    let index = Nearest::new(&xy);
    let rivals: Vec<Vec<usize>> = places
        .iter()
        .enumerate()
        .map(|(k, &(p, asked))| {
            let (reach, mut rivals) = (APART * asked, Vec::new());
            index.visit_all(p, reach, &mut |other, q| {
                if other as usize != k && distance(p, q) < reach {
                    rivals.push(other as usize);
                }
            });
            rivals
        })
        .collect();
    let join = |(k, own): (usize, &Vec<usize>)| match own[..] {
        [] => Some(places[k]),
        [other] if rivals[other] == [k] => (k < other).then(|| {
            let [(p, a), (q, b)] = [places[k], places[other]];
            (middle(p, q), 0.5 * (a + b))
        }),
        _ => rivals[k].iter().all(|&other| rivals[other].len() > rivals[k].len()).then_some(places[k]),
    };
    rivals.iter().enumerate().filter_map(join).collect()
}
