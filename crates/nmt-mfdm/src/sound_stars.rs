//! Sound stars of many nodes: most carry their polynomial at once, and their systems are solved four at a time; the others
//! are enlarged one by one (see [`crate::repair`]).

use crate::basis::{MAX_MONOMIALS, n_monomials, row};
use crate::lanes::WIDTH;
use crate::mwls::Mwls;
use crate::quartet::{CentredStar, Quartet};
use crate::repair::{Demand, SOUND_CONDITION, StarOutcome, find_star, sound_star};
use crate::slopes::Slopes;
use crate::star::{StarChoice, StarFinder};
use crate::surroundings::Surroundings;
use nmt_cloud::Nearest;
use nmt_geom::NodeId;
use std::array::from_fn;

/// What is computed of each star.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Wanted<'a> {
    /// The rows of all derivatives, from that of the value on where the polynomial smooths.
    Rows,
    /// The row of ∇² in stretched coordinates, times the square of the radius; of interpolating polynomials.
    Laplacian,
    /// The coefficients of the interpolating polynomials through the values of each of these fields, one a node of the cloud.
    Polynomials(&'a [&'a [f64]]),
}

/// A star and what was computed of it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SoundStar<'a> {
    pub node: NodeId,
    /// Ascending.
    pub nodes: &'a [NodeId],
    /// User's length unit; 1 where the star is its centre alone.
    pub radius: f64,
    pub outcome: StarOutcome,
    /// Rows, one after another, or coefficients, field after field; those of derivatives that the polynomial does not have
    /// are 0.
    pub values: &'a [f64],
}

/// Finds sound stars; one a thread, with room to be used again.
pub(crate) struct SoundStars<'a> {
    finder: StarFinder<'a>,
    mwls: Mwls,
    quartet: Quartet,
    stars: [Vec<NodeId>; WIDTH],
    fitted: [Vec<f64>; WIDTH], // coefficients of each star, field after field
    star: Vec<NodeId>,
    values: Vec<f64>,
}

/// A star of a quartet.
#[derive(Clone, Copy, Debug)]
struct Member {
    /// Its place in the group, which is its lane.
    lane: usize,
    centre: usize,
    hidden: usize,
}

impl<'a> SoundStars<'a> {
    /// `nearest` is that of `surroundings`.
    pub fn new(surroundings: &'a Surroundings<'a>, nearest: &'a Nearest<'a>, choice: StarChoice) -> Self {
        Self {
            finder: StarFinder::new(surroundings, nearest, choice),
            mwls: Mwls::default(),
            quartet: Quartet::default(),
            stars: Default::default(),
            fitted: Default::default(),
            star: Vec::new(),
            values: Vec::new(),
        }
    }

    /// Hands over the sound stars of nodes in their order, at least one; the demands of all are of one order.
    pub fn each(
        &mut self,
        nodes: impl ExactSizeIterator<Item = NodeId>,
        demand: impl Fn(NodeId) -> Demand,
        wanted: Wanted,
        mut take: impl FnMut(SoundStar),
    ) {
        let mut group = Vec::with_capacity(WIDTH);
        let mut nodes = nodes.map(|node| (node, demand(node)));
        loop {
            group.clear();
            group.extend(nodes.by_ref().take(WIDTH));
            let Some((_, Demand { order, .. })) = group.first() else { return };
            let members = self.members(&group);
            let is_computed = self.solve(&members, *order, wanted);
            for (lane, &(node, demand)) in group.iter().enumerate() {
                let member = members[lane].filter(|_| is_computed);
                match member.and_then(|member| Some((member.centre, self.accepted(member, demand, wanted)?))) {
                    Some((centre, outcome)) => {
                        self.copy(lane, centre, wanted);
                        let radius = self.quartet.radius(lane);
                        take(SoundStar { node, nodes: &self.stars[lane], radius, outcome, values: &self.values });
                    }
                    None => take(self.one(node, demand, wanted)),
                }
            }
        }
    }

    /// The sound star of one node, its system solved by itself.
    pub fn one(&mut self, node: NodeId, demand: Demand, wanted: Wanted) -> SoundStar<'_> {
        let Self { finder, mwls, star, values, .. } = self;
        let outcome = sound_star(finder, mwls, node, demand, star);
        values.clear();
        match wanted {
            Wanted::Rows | Wanted::Laplacian => {
                let first_row = usize::from(demand.smoothing == 0.0);
                if outcome.order > 0 {
                    mwls.rows(values);
                }
                values.resize((n_monomials(demand.order) - first_row) * star.len(), 0.0);
                if let Wanted::Laplacian = wanted {
                    let squares = finder.surroundings().metric().stretch().map(|stretch| stretch * stretch);
                    let row = |m: usize| (m - first_row) * star.len();
                    for k in 0..star.len() {
                        values[k] = values[row(XX) + k] * squares[0] + values[row(YY) + k] * squares[1];
                    }
                    values.truncate(star.len());
                }
            }
            Wanted::Polynomials(fields) => {
                for of in fields {
                    let mut fitted = [0.0; MAX_MONOMIALS];
                    fitted[0] = of[node.index()];
                    if outcome.order > 0 {
                        mwls.fit(|k| of[star[k].index()], &mut fitted);
                    }
                    values.extend(&fitted[..n_monomials(demand.order)]);
                }
            }
        }
        let radius = if mwls.radius() > 0.0 { mwls.radius() } else { 1.0 };
        SoundStar { node, nodes: star, radius, outcome, values }
    }

    /// The stars of a group of nodes as they are chosen first, of those that may be solved together.
    fn members(&mut self, group: &[(NodeId, Demand)]) -> [Option<Member>; WIDTH] {
        let mut members = [None; WIDTH];
        for (lane, (node, demand)) in group.iter().enumerate() {
            let Demand { order, size, smoothing, flattening, slopes, .. } = *demand;
            if smoothing != 0.0 || flattening != 0.0 || slopes != Slopes::Free || order == 0 {
                continue;
            }
            let star = &mut self.stars[lane];
            let hidden = find_star(&mut self.finder, *node, size.max(n_monomials(order)), order, star);
            let centre = star.binary_search(node).ok().filter(|_| star.len() >= n_monomials(order));
            members[lane] = centre.map(|centre| Member { lane, centre, hidden });
        }
        members
    }

    /// Computes what is wanted of the members; false where there are none.
    fn solve(&mut self, members: &[Option<Member>; WIDTH], order: usize, wanted: Wanted) -> bool {
        let Some(any) = members.iter().flatten().next() else { return false };
        // Lanes without a member repeat another's star.
        let of = |lane: usize| members[lane].unwrap_or(*any);
        let stars = from_fn(|lane| CentredStar { nodes: &self.stars[of(lane).lane], centre: of(lane).centre });
        let surroundings = self.finder.surroundings();
        self.quartet.factorise(surroundings.stretched(), stars, order);
        match wanted {
            Wanted::Rows => self.quartet.rows(),
            Wanted::Laplacian => {
                self.quartet.laplacian(surroundings.metric().stretch().map(|stretch| stretch * stretch))
            }
            Wanted::Polynomials(fields) => {
                self.fitted.iter_mut().for_each(Vec::clear);
                for values in fields {
                    self.quartet.fit(values, stars);
                    for ((lane, fitted), star) in self.fitted.iter_mut().enumerate().zip(stars) {
                        fitted.push(values[star.nodes[star.centre].index()]);
                        self.quartet.fitted(lane, fitted);
                    }
                }
            }
        }
        true
    }

    /// What a member came to, where it is sound at once.
    fn accepted(&self, Member { lane, hidden, .. }: Member, demand: Demand, wanted: Wanted) -> Option<StarOutcome> {
        let condition = self.quartet.condition(lane);
        // NaN, of a singular system, is not sound.
        let is_sound = condition <= SOUND_CONDITION[demand.order];
        let wrong_sign = demand.negative_diagonal && demand.order == 2 && {
            let own = |m: usize| self.quartet.own(lane, m);
            let [s_x, s_y] = self.finder.surroundings().metric().stretch();
            match wanted {
                Wanted::Rows => own(XX - 1) * s_x * s_x + own(YY - 1) * s_y * s_y >= 0.0,
                Wanted::Laplacian => own(0) >= 0.0,
                Wanted::Polynomials(_) => true, // it has no rows to tell
            }
        };
        let outcome = StarOutcome { order: demand.order, hidden, condition, wrong_sign, ..StarOutcome::default() };
        let is_clumped = self.finder.surroundings().is_clumped(&self.stars[lane], self.quartet.radius(lane));
        (is_sound && !wrong_sign && !is_clumped).then_some(outcome)
    }

    /// Copies what was computed of a member into `values`.
    fn copy(&mut self, lane: usize, centre: usize, wanted: Wanted) {
        let star = CentredStar { nodes: &self.stars[lane], centre };
        match wanted {
            Wanted::Rows | Wanted::Laplacian => self.quartet.copy_rows(lane, star, &mut self.values),
            Wanted::Polynomials(_) => self.values.clone_from(&self.fitted[lane]),
        }
    }
}

const XX: usize = row(2, 0);
const YY: usize = row(0, 2);
