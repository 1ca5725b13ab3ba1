//! Triangles as half-edges in flat arrays: three slots a triangle, in order, so that only origin and twin are stored.

use nmt_geom::Point;

/// Says that there is no half-edge, or no node.
pub(super) const NONE: u32 = u32::MAX;

/// Twins from here on are borders: one that waits for the next row of cells, with its column, or none at all.
const BORDER: u32 = 1 << 31;

/// Slots that half-edges may take: as many as are no border.
pub(super) const MOST_SLOTS: usize = BORDER as usize;

/// The half-edge after `h` around its triangle.
#[inline]
pub(super) fn next(h: u32) -> u32 {
    if h % 3 == 2 { h - 2 } else { h + 1 }
}

/// The half-edge before `h` around its triangle.
#[inline]
pub(super) fn prev(h: u32) -> u32 {
    if h.is_multiple_of(3) { h + 2 } else { h - 1 }
}

/// The three half-edges of the triangle that `h` belongs to.
#[inline]
pub(super) fn sides(h: u32) -> [u32; 3] {
    let first = h - h % 3;
    [first, first + 1, first + 2]
}

/// What the corner of a triangle opposite to a side tells of that side: the cotangent of its angle is dot / twice_area.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    pub twice_area: f64,
    pub dot: f64, // of the two sides that meet there
}

impl Corner {
    /// Opposite to a side that has no triangle: legal with every other.
    pub const OPEN: Self = Self { twice_area: 0.0, dot: f64::MAX };
    /// Opposite to a side that has to be looked at again: no comparison with it is true.
    pub const UNKNOWN: Self = Self { twice_area: f64::NAN, dot: f64::NAN };

    /// The in-circle determinant of a side and the two corners opposite to it: positive where the side is Delaunay.
    #[inline]
    pub fn legality(self, other: Self) -> f64 {
        self.twice_area * other.dot + self.dot * other.twice_area
    }
}

/// An upper side of the newest row of cells, which waits for the next row.
#[derive(Clone, Copy, Debug)]
pub(super) struct FrontEdge {
    pub slot: u32, // NONE where there is no cell
    pub corner: Corner,
}

impl FrontEdge {
    pub const OPEN: Self = Self { slot: NONE, corner: Corner::OPEN };
}

/// A triangulation of the nodes of a cloud and of ghosts, which are numbered after them.
pub(super) struct Triangulation<'a> {
    pub xy: &'a [Point],
    pub ghosts: Vec<Point>,
    /// Brings coordinates near 1 for predicates of the fourth degree; a power of two.
    pub scale: f64,
    /// The end of the segment of the real boundary that begins at a boundary node.
    pub leads_to: Vec<u32>,
    /// Where each half-edge begins; the first of a triangle that is no more has [`NONE`].
    pub origins: Vec<u32>,
    /// The same side seen from the other triangle; at least `BORDER` where there is none.
    pub twins: Vec<u32>,
    /// A half-edge that begins at each boundary node; for a node that is not inserted yet, one nearby.
    pub leaving_boundary: Vec<u32>,
    /// A half-edge that begins at each ghost.
    pub leaving_ghost: Vec<u32>,
    /// Upper sides of the newest row of cells, by column.
    pub front: Vec<FrontEdge>,
    /// Half-edges whose sides may not be Delaunay.
    pub unsettled: Vec<u32>,
    /// Half-edges whose sides may be diagonals of four nodes on one circle.
    pub suspects: Vec<u32>,
}

impl Triangulation<'_> {
    /// The nodes of the triangles, three each; memory for the rest is given back.
    pub fn into_origins(self) -> Vec<u32> {
        self.origins
    }

    /// Where a node or ghost is.
    #[inline]
    pub fn at(&self, node: u32) -> Point {
        let node = node as usize;
        if node < self.xy.len() { self.xy[node] } else { self.ghosts[node - self.xy.len()] }
    }

    #[inline]
    pub fn origin(&self, h: u32) -> u32 {
        self.origins[h as usize]
    }

    /// The other triangle's half-edge of the same side; `None` at the border.
    #[inline]
    pub fn twin(&self, h: u32) -> Option<u32> {
        let twin = self.twins[h as usize];
        (twin < BORDER).then_some(twin)
    }

    /// True where the triangle of `h` has been taken away.
    #[inline]
    pub fn is_dead(&self, h: u32) -> bool {
        self.origin(h - h % 3) == NONE
    }

    /// True for a segment of the real boundary, which no flip may remove.
    #[inline]
    pub fn is_segment(&self, a: u32, b: u32) -> bool {
        let leads = |from: u32, to: u32| self.leads_to.get(from as usize) == Some(&to);
        leads(a, b) || leads(b, a)
    }

    /// True for a node of the real boundary or a ghost: those that something is looked up around.
    fn leaving(&mut self, node: u32) -> Option<&mut u32> {
        let (node, n_nodes) = (node as usize, self.xy.len());
        if node >= n_nodes { self.leaving_ghost.get_mut(node - n_nodes) } else { self.leaving_boundary.get_mut(node) }
    }

    /// Notes that `h` begins at its origin.
    #[inline]
    pub fn note_leaving(&mut self, h: u32) {
        if let Some(leaving) = self.leaving(self.origins[h as usize]) {
            *leaving = h;
        }
    }

    /// Makes `h` and `twin` two halves of one side; `twin` may be a border.
    #[inline]
    pub fn link(&mut self, h: u32, twin: u32) {
        self.twins[h as usize] = twin;
        if twin < BORDER {
            self.twins[twin as usize] = h;
        } else if twin != NONE {
            self.front[(twin - BORDER) as usize] = FrontEdge { slot: h, corner: Corner::UNKNOWN };
        }
    }

    /// The twin of an upper side in column `col` of the newest row.
    #[inline]
    pub fn front_twin(col: usize) -> u32 {
        BORDER + col as u32
    }

    /// The half-edges at `node`, counter-clockwise from `first`, until `visit` returns something.
    ///
    /// `None` where nothing is found all around, or the border is met.
    pub fn around<T>(&self, first: u32, mut visit: impl FnMut(u32) -> Option<T>) -> Option<T> {
        let mut h = first;
        loop {
            if let Some(found) = visit(h) {
                return Some(found);
            }
            h = self.twin(prev(h))?;
            if h == first {
                return None;
            }
        }
    }

    /// Replaces the diagonal `h` = a → b of the triangles (a, b, c) and (b, a, d) by c d.
    ///
    /// Afterwards `h` is a → d, `twin` is b → c, and `next(h)` is d → c: those two sides have changed their slots. The
    /// caller knows that both new triangles are counter-clockwise.
    pub fn flip(&mut self, h: u32, twin: u32) {
        let (h_next, twin_next) = (next(h), next(twin));
        let (c, d) = (self.origin(prev(h)), self.origin(prev(twin)));
        let (ad, bc) = (self.twins[twin_next as usize], self.twins[h_next as usize]);
        self.origins[h_next as usize] = d;
        self.origins[twin_next as usize] = c;
        self.link(h, ad);
        self.link(twin, bc);
        self.link(h_next, twin_next);
        for outer in [prev(h), prev(twin)] {
            let beyond = self.twins[outer as usize];
            if beyond >= BORDER {
                self.link(outer, beyond); // says that its triangle has changed
            }
        }
        self.note_leaving(h);
        self.note_leaving(twin);
    }
}

#[cfg(test)]
pub(super) mod samples {
    use super::*;

    impl<'a> Triangulation<'a> {
        /// Triangles on `xy` and `ghosts`, with `segments` among the first nodes, a loop each.
        pub fn sample(xy: &'a [Point], ghosts: &[Point], segments: &[[u32; 2]], triangles: &[[u32; 3]]) -> Self {
            let n_boundary = segments.iter().flatten().max().map_or(0, |n| n + 1) as usize;
            let mut leads_to = vec![NONE; n_boundary];
            segments.iter().for_each(|[from, to]| leads_to[*from as usize] = *to);
            let origins = triangles.concat();
            let mut sample = Self {
                xy,
                ghosts: ghosts.to_vec(),
                scale: 1.0,
                leads_to,
                twins: vec![NONE; origins.len()],
                origins,
                leaving_boundary: vec![NONE; n_boundary],
                leaving_ghost: vec![NONE; ghosts.len()],
                front: Vec::new(),
                unsettled: Vec::new(),
                suspects: Vec::new(),
            };
            for h in 0..sample.origins.len() as u32 {
                let ends = |h: u32| [sample.origin(h), sample.origin(next(h))];
                let [from, to] = ends(h);
                let twin = (0..sample.origins.len() as u32).find(|g| ends(*g) == [to, from]);
                sample.twins[h as usize] = twin.unwrap_or(NONE);
                sample.note_leaving(h);
            }
            sample
        }

        /// The triangles there are, in order; asserts that they are counter-clockwise and that twins are twins.
        pub fn triangles(&self) -> Vec<[u32; 3]> {
            for h in (0..self.origins.len() as u32).filter(|h| !self.is_dead(*h)) {
                if let Some(twin) = self.twin(h) {
                    assert_eq!(self.twin(twin), Some(h));
                    assert_eq!((self.origin(h), self.origin(next(h))), (self.origin(next(twin)), self.origin(twin)));
                }
                let [a, b, c] = sides(h).map(|s| self.at(self.origin(s)));
                assert_eq!(nmt_geom::side(a, b, c), std::cmp::Ordering::Greater);
            }
            let alive = self.origins.as_chunks::<3>().0.iter().filter(|nodes| nodes[0] != NONE);
            crate::order::in_order(self.xy.len() + self.ghosts.len(), || alive.clone().copied())
                .iter()
                .map(|nodes| nodes.map(|node| node.0))
                .collect()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: [Point; 4] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];

    #[test]
    fn a_flip_replaces_one_diagonal_by_the_other_and_two_flips_turn_it_round() {
        let mut two = Triangulation::sample(&SQUARE, &[], &[], &[[0, 1, 2], [0, 2, 3]]);
        for expected in [[[0, 1, 3], [1, 2, 3]], [[0, 1, 2], [0, 2, 3]]] {
            let h = (0..6).find(|h| two.twin(*h).is_some()).expect("a diagonal");
            two.flip(h, two.twins[h as usize]);
            assert_eq!(two.triangles(), expected);
        }
    }

    #[test]
    fn what_leaves_a_boundary_node_is_known_after_every_flip() {
        let segments = [[0, 1], [1, 2], [2, 3], [3, 0]];
        let mut two = Triangulation::sample(&SQUARE, &[], &segments, &[[0, 1, 2], [0, 2, 3]]);
        for _ in 0..4 {
            let h = (0..6).find(|h| two.twin(*h).is_some()).expect("a diagonal");
            two.flip(h, two.twins[h as usize]);
            assert!((0..4).all(|node| two.origin(two.leaving_boundary[node]) == node as u32));
        }
    }
}
