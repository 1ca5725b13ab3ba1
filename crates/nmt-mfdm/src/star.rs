//! Stars: the nearest visible nodes of a point, or as near as they come from all sides \[D10\].

use crate::surroundings::Surroundings;
use nmt_cloud::{Nearest, Scratch};
use nmt_geom::point::{distance_squared, sub};
use nmt_geom::{NodeId, Point};
use std::f64::consts::FRAC_PI_8;

/// How the nodes of a star are chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum StarChoice {
    /// The nearest visible nodes.
    #[default]
    Nearest,
    /// The nearest visible nodes of each of eight sectors alike: for clouds whose density changes within a star, where
    /// the nearest nodes lie on the dense side.
    Balanced,
}

impl StarChoice {
    /// Both, in the order of the documentation.
    pub const ALL: [Self; 2] = [Self::Nearest, Self::Balanced];

    /// The word of the problem file and of the reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Nearest => "nearest",
            Self::Balanced => "balanced",
        }
    }
}

/// Sectors of a balanced star: their middles are the axes and the diagonals, so that rounding of a regular cloud moves no
/// node from one to another.
const SECTORS: usize = 8;

/// A balanced star is chosen among so many times its size of nearest nodes.
const CANDIDATES: usize = 4;

/// Nodes of a square grid at one distance, within 7 spacings; of other grids there are fewer.
const LARGEST_SHELL: usize = 12;

/// Nodes in a star by default, the centre included: 6, 9, 20, 30 for orders 1 to 4.
pub fn default_star(order: usize) -> usize {
    match order {
        1 => 6,
        2 => 9,
        3 => 20,
        _ => 30,
    }
}

/// Chooses stars; one a thread, with room to be used again.
pub struct StarFinder<'a> {
    surroundings: &'a Surroundings<'a>,
    nearest: &'a Nearest<'a>,
    choice: StarChoice,
    scratch: Scratch,
    clear: Clear,
    hidden: Vec<f64>, // distance² of the hidden nodes met
    candidates: Vec<NodeId>,
    distances: Vec<f64>, // squared
}

impl<'a> StarFinder<'a> {
    /// `nearest` is that of `surroundings`.
    pub fn new(surroundings: &'a Surroundings<'a>, nearest: &'a Nearest<'a>, choice: StarChoice) -> Self {
        Self {
            surroundings,
            nearest,
            choice,
            scratch: Scratch::default(),
            clear: Clear::default(),
            hidden: Vec::new(),
            candidates: Vec::new(),
            distances: Vec::new(),
        }
    }

    pub(crate) fn surroundings(&self) -> &'a Surroundings<'a> {
        self.surroundings
    }

    pub(crate) fn choice(&self) -> StarChoice {
        self.choice
    }

    pub(crate) fn choose(&mut self, choice: StarChoice) {
        self.choice = choice;
    }

    /// The star of `size` visible nodes of `node`, itself included, by number into `out` (fewer where there are no more);
    /// returns how many hidden nodes were passed over.
    pub fn find(&mut self, node: NodeId, size: usize, out: &mut Vec<NodeId>) -> usize {
        let surroundings = self.surroundings;
        let centre = surroundings.stretched()[node.index()];
        let at = surroundings.xy()[node.index()];
        let all_visible = |clear: &mut Clear, radius: f64| clear.all_visible(surroundings, at, radius);
        self.find_seen(centre, size, all_visible, |other| surroundings.sees(node, other), out)
    }

    /// As [`Self::find`], with all nodes that are as far away as the farthest: the star of an interior node of a regular
    /// grid is then as symmetric as the grid \[D16\].
    pub(crate) fn find_shells(&mut self, node: NodeId, size: usize, out: &mut Vec<NodeId>) -> usize {
        if self.choice == StarChoice::Balanced {
            return self.find(node, size, out);
        }
        let hidden = self.find(node, size + LARGEST_SHELL, out);
        if out.len() <= size {
            return hidden;
        }
        let places = self.surroundings.stretched();
        let distance = |other: &NodeId| distance_squared(places[other.index()], places[node.index()]);
        let distances = &mut self.distances;
        distances.clear();
        distances.extend(out.iter().map(distance));
        let (_, rim, _) = distances.select_nth_unstable_by(size - 1, f64::total_cmp);
        let limit = *rim * (1.0 + SAME_DISTANCE_REL);
        out.retain(|other| distance(other) <= limit);
        self.hidden.iter().filter(|d2| **d2 < *rim).count()
    }

    /// The star of `size` visible nodes of the place `at` (user's coordinates), which need not be a node.
    pub fn find_at(&mut self, at: Point, size: usize, out: &mut Vec<NodeId>) -> usize {
        let surroundings = self.surroundings;
        let centre = surroundings.metric().stretched(at);
        let all_visible = |clear: &mut Clear, radius: f64| clear.all_visible(surroundings, at, radius);
        self.find_seen(centre, size, all_visible, |other| surroundings.sees_from(at, other), out)
    }

    fn find_seen(
        &mut self,
        centre: Point,
        size: usize,
        all_visible: impl Fn(&mut Clear, f64) -> bool,
        sees: impl Fn(NodeId) -> bool,
        out: &mut Vec<NodeId>,
    ) -> usize {
        let places = self.surroundings.stretched();
        let wanted = match self.choice {
            StarChoice::Nearest => size,
            StarChoice::Balanced => CANDIDATES * size,
        };
        let distance = |other: &NodeId| distance_squared(places[other.index()], centre);
        let farthest = self.nearest.nearest_of_all(centre, wanted, &mut self.scratch, out);
        self.hidden.clear();
        if !all_visible(&mut self.clear, farthest) {
            let hidden = &mut self.hidden;
            let accept = |other: NodeId| {
                let visible = sees(other);
                if !visible {
                    hidden.push(distance(&other));
                }
                visible
            };
            self.nearest.nearest(centre, wanted, accept, &mut self.scratch, out);
        }
        if self.choice == StarChoice::Balanced {
            self.balance(centre, size, out);
        }
        if self.hidden.is_empty() {
            return 0;
        }
        let limit = out.iter().map(distance).fold(0.0f64, f64::max);
        self.hidden.iter().filter(|d2| **d2 < limit).count()
    }

    /// Of the nodes `out`, keeps `size`: from the nearest on those whose sector has not its share yet, then, where sectors
    /// are empty, the nearest of the rest; by number.
    fn balance(&mut self, centre: Point, size: usize, out: &mut Vec<NodeId>) {
        let places = self.surroundings.stretched();
        let distance = |node: &NodeId| distance_squared(places[node.index()], centre);
        let candidates = &mut self.candidates;
        candidates.clear();
        candidates.append(out);
        // Distances that differ by rounding alone are equal: then the number decides.
        let same = |a: f64, b: f64| (a - b).abs() <= SAME_DISTANCE_REL * a.max(b);
        candidates.sort_by(|a, b| distance(a).total_cmp(&distance(b)).then(a.cmp(b)));
        candidates.chunk_by_mut(|a, b| same(distance(a), distance(b))).for_each(|tied| tied.sort_unstable());
        let share = size.saturating_sub(1).div_ceil(SECTORS);
        let mut counts = [0; SECTORS];
        candidates.retain(|node| {
            let offset = sub(places[node.index()], centre);
            let takes = out.len() < size && (offset == [0.0, 0.0] || counts[sector(offset)] < share);
            if takes {
                if offset != [0.0, 0.0] {
                    counts[sector(offset)] += 1;
                }
                out.push(*node);
            }
            !takes
        });
        let missing = size.saturating_sub(out.len());
        out.extend(candidates.iter().take(missing));
        out.sort_unstable();
    }
}

/// A disc without a segment in it, to be asked before the index of the segments is: the next star is beside the last one.
#[derive(Clone, Copy, Debug, Default)]
struct Clear {
    at: Point,
    radius: f64,
    crowded: u32, // how many more stars are looked at by themselves
}

impl Clear {
    /// The disc has so many times the radius of a star.
    const LARGER: f64 = 12.0;

    /// Stars that are looked at by themselves after a large disc had a segment in it.
    const PAUSE: u32 = 6;

    /// [`Surroundings::all_visible`].
    fn all_visible(&mut self, surroundings: &Surroundings, at: Point, radius: f64) -> bool {
        let room = self.radius * (1.0 - SAME_DISTANCE_REL) - radius;
        if room > 0.0 && distance_squared(at, self.at) < room * room {
            return true;
        }
        if self.crowded == 0 {
            let larger = Self::LARGER * radius;
            if surroundings.all_visible(at, larger) {
                (self.at, self.radius) = (at, larger);
                return true;
            }
            self.crowded = Self::PAUSE;
        }
        self.crowded -= 1;
        surroundings.all_visible(at, radius)
    }
}

/// Squared distances within this fraction are equal, as in the search for nearest nodes.
const SAME_DISTANCE_REL: f64 = 2.0e-9;

/// Which of the eight sectors a direction lies in; sector 0 has the x-axis in its middle.
fn sector([x, y]: Point) -> usize {
    let eighths = (y.atan2(x) + FRAC_PI_8) / (2.0 * FRAC_PI_8);
    (eighths.floor() as i64).rem_euclid(SECTORS as i64) as usize
}
