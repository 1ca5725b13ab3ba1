//! Pairs of subdomains to common edges, with the nodes of both sides in order.

use crate::coincide::{Part, VERTEX_SLACK, common_parts, same_point};
use crate::track::Track;
use nmt_cloud::{Cloud, Section};
use nmt_geom::point::distance;
use nmt_geom::{EdgeId, NodeId, Point, SubdomainId};

/// One subdomain of the problem, borrowed.
#[derive(Clone, Copy, Debug)]
pub struct Side<'a> {
    /// Its outlines, with the names of their edges.
    pub section: &'a Section,
    /// The cloud generated on it.
    pub cloud: &'a Cloud,
}

/// A piece of boundary that two subdomains share; of every pair the first is the subdomain with the smaller number.
#[derive(Clone, Debug, PartialEq)]
pub struct CommonEdge {
    /// The two subdomains.
    pub between: [SubdomainId; 2],
    /// The edge of each side's outlines that it lies on.
    pub edges: [EdgeId; 2],
    /// The names of these edges.
    pub names: [String; 2],
    /// Where it begins, following the first side's edge; user's length unit.
    pub from: Point,
    /// Where it ends; where it begins for a whole circle between two subdomains.
    pub to: Point,
    /// Each side's boundary nodes on it, ends included, from `from` to `to`. An end that is a vertex of the other side
    /// alone has no node on this side. Where it closes, the node there comes once, first.
    pub nodes: [Vec<NodeId>; 2],
    /// What two nodes may differ by and still be at one place, kept since finding it takes a look at every outline.
    tolerance: f64,
}

impl CommonEdge {
    /// True where it leads once around, back to where it begins.
    pub fn is_closed(&self) -> bool {
        self.from == self.to
    }

    /// True where the nodes of both sides are the same places, to 1e-9 of the size of the whole problem.
    pub fn is_conforming(&self, sides: &[Side]) -> bool {
        self.first_apart(sides).is_none()
    }

    /// The first node along it that has none of the other side at its place: which side's, and the node.
    pub(crate) fn first_apart(&self, sides: &[Side]) -> Option<Unmatched> {
        let at = |side: usize, node: NodeId| sides[self.between[side].index()].cloud.xy()[node.index()];
        let n_nodes = self.nodes.each_ref().map(Vec::len);
        for k in 0..n_nodes[0].max(n_nodes[1]) {
            match [0, 1].map(|side| self.nodes[side].get(k).map(|&node| (node, at(side, node)))) {
                [Some((_, p)), Some((_, q))] if distance(p, q) <= self.tolerance => {}
                [Some((node, p)), Some((other, q))] => {
                    // The one that comes first along the edge has no partner.
                    let [p_ahead, q_ahead] = [p, q].map(|at| distance(at, self.from));
                    let (side, node, at) = if p_ahead <= q_ahead { (0, node, p) } else { (1, other, q) };
                    return Some(Unmatched { side, node, at });
                }
                [Some((node, at)), None] => return Some(Unmatched { side: 0, node, at }),
                [None, Some((node, at))] => return Some(Unmatched { side: 1, node, at }),
                [None, None] => {}
            }
        }
        None
    }
}

/// A node on a common edge without a node of the other side at its place.
pub(crate) struct Unmatched {
    pub side: usize,
    pub node: NodeId,
    pub at: Point,
}

/// The common edges of all pairs of subdomains, ordered by the numbers of the subdomains, then of the edges, then along
/// the first side's edge; paper, Sec. 6.
///
/// Two edges have in common where they run along each other within 1e-9 of the size of the whole problem, over a length
/// of more than that: entirely or in part, the boundaries of holes included, and whatever form each side gives its curve
/// in. A common edge ends at vertices, of one side or of both; where a vertex of either lies on it there are two. Curves
/// that touch, cross or come together where neither has a vertex have nothing in common.
///
/// Takes O(n log n) for n edges of about equal length (of a curve: the pieces of little bend that it is looked at in), and
/// time for the nodes on the edges found.
pub fn common_edges(sides: &[Side]) -> Vec<CommonEdge> {
    let sections: Vec<&Section> = sides.iter().map(|side| side.section).collect();
    let tolerance = same_point(&sections);
    let parts = common_parts(&sections, tolerance);
    let mut on_edges: Vec<Option<Vec<Vec<NodeId>>>> = vec![None; sides.len()];
    let common = |part: &Part| {
        let curve = edge_of(sides[part.subdomains[0]].section, part.edges[0])?.curve.clone();
        let track = Track::new(&curve);
        let nodes = [0, 1].map(|side| {
            let (subdomain, edge) = (part.subdomains[side], part.edges[side]);
            let cloud = sides[subdomain].cloud;
            let on_edges = on_edges[subdomain].get_or_insert_with(|| nodes_on_edges(cloud));
            let on_edge = on_edges.get(edge.index()).map_or(&[][..], Vec::as_slice);
            along(part, &track, cloud, on_edge, tolerance)
        });
        let name = |side: usize| {
            let edge = edge_of(sides[part.subdomains[side]].section, part.edges[side]);
            edge.map(|edge| edge.name.clone()).unwrap_or_default()
        };
        Some(CommonEdge {
            between: part.subdomains.map(SubdomainId::of),
            edges: part.edges,
            names: [name(0), name(1)],
            from: part.from,
            to: part.to,
            nodes,
            tolerance,
        })
    };
    parts.iter().filter_map(common).collect()
}

fn edge_of(section: &Section, edge: EdgeId) -> Option<&nmt_curve::OutlineEdge> {
    section.loops().flat_map(|outline| &outline.edges).nth(edge.index())
}

/// The boundary nodes on each edge, by number.
fn nodes_on_edges(cloud: &Cloud) -> Vec<Vec<NodeId>> {
    let segments = cloud.boundary().segments();
    let n_edges = segments.iter().map(|segment| segment.edge.index() + 1).max().unwrap_or(0);
    let mut nodes = vec![Vec::new(); n_edges];
    for segment in segments {
        nodes[segment.edge.index()].extend([segment.from, segment.to]);
    }
    for on_edge in &mut nodes {
        on_edge.sort_unstable();
        on_edge.dedup();
    }
    nodes
}

/// Those of `nodes` that lie on a common part, along the first side's curve.
fn along(part: &Part, track: &Track, cloud: &Cloud, nodes: &[NodeId], tolerance: f64) -> Vec<NodeId> {
    let [low, high] = part.u[0];
    let position = |&node: &NodeId| {
        let at = cloud.xy()[node.index()];
        let u = if distance(at, part.from) <= tolerance {
            low
        } else if distance(at, part.to) <= tolerance {
            high
        } else {
            track.foot(at, VERTEX_SLACK * tolerance).map(|foot| foot.u).filter(|&u| low < u && u < high)?
        };
        Some((u, node))
    };
    let mut nodes: Vec<(f64, NodeId)> = nodes.iter().filter_map(position).collect();
    nodes.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    nodes.into_iter().map(|(_, node)| node).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use nmt_cloud::{CloudError, CloudParams, generate};
    use nmt_curve::{Curve, Expression, Outline, OutlineEdge, Turn};
    use nmt_geom::point::{cross, dot};
    use std::f64::consts::{FRAC_PI_2, TAU};

    struct Subdomain {
        section: Section,
        cloud: Cloud,
    }

    fn subdomain(section: Section, nodes: [usize; 2], irregularity: f64) -> Result<Subdomain, CloudError> {
        let cloud = generate(&section, &CloudParams { nodes, irregularity, ..CloudParams::default() })?;
        cloud.check()?;
        Ok(Subdomain { section, cloud })
    }

    fn polygon(corners: &[Point]) -> Section {
        Section::solid(Outline::polygon(corners.iter().copied()))
    }

    fn common(subdomains: &[Subdomain]) -> Vec<CommonEdge> {
        let sides: Vec<Side> = subdomains.iter().map(|s| Side { section: &s.section, cloud: &s.cloud }).collect();
        common_edges(&sides)
    }

    fn places(subdomain: &Subdomain, nodes: &[NodeId]) -> Vec<Point> {
        nodes.iter().map(|node| subdomain.cloud.xy()[node.index()]).collect()
    }

    /// Square (0,0)–(2,2) and the triangle on its right side: the first example of the paper.
    fn square_and_triangle(irregularity: f64) -> Result<[Subdomain; 2], CloudError> {
        Ok([
            subdomain(polygon(&[[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]]), [11, 11], irregularity)?,
            subdomain(polygon(&[[2.0, 0.0], [4.0, 0.0], [2.0, 2.0]]), [9, 9], irregularity)?,
        ])
    }

    #[test]
    fn the_square_and_the_triangle_share_the_side_between_them() -> Result<(), CloudError> {
        for irregularity in [0.0, 0.3] {
            let both = square_and_triangle(irregularity)?;
            let found = common(&both);
            assert_eq!(found.len(), 1);
            let edge = &found[0];
            assert_eq!(edge.between, [SubdomainId(0), SubdomainId(1)]);
            assert_eq!((edge.edges, edge.names.each_ref().map(String::as_str)), ([EdgeId(1), EdgeId(2)], ["e2", "e3"]));
            assert_eq!([edge.from, edge.to], [[2.0, 0.0], [2.0, 2.0]]);
            for (side, n) in [(0, 11), (1, 9)] {
                let at = places(&both[side], &edge.nodes[side]);
                assert_eq!(at.len(), n);
                assert_eq!((at[0], at[n - 1]), ([2.0, 0.0], [2.0, 2.0]));
                assert!(at.windows(2).all(|pair| pair[0][0] == 2.0 && pair[0][1] < pair[1][1]), "{at:?}");
            }
        }
        Ok(())
    }

    #[test]
    fn the_order_of_the_subdomains_turns_the_pair_and_follows_the_new_first_edge() -> Result<(), CloudError> {
        let [square, triangle] = square_and_triangle(0.0)?;
        let found = common(&[triangle, square]);
        assert_eq!((found[0].edges, found.len()), ([EdgeId(2), EdgeId(1)], 1));
        assert_eq!([found[0].from, found[0].to], [[2.0, 2.0], [2.0, 0.0]]);
        assert_eq!(found[0].nodes.each_ref().map(Vec::len), [9, 11]);
        Ok(())
    }

    #[test]
    fn edges_that_overlap_in_part_share_that_part_with_the_nodes_on_it() -> Result<(), CloudError> {
        // Two squares of side 2, the second one higher by 0.75: no node of the first lies at (2, 0.75).
        let low = subdomain(Section::solid(Outline::rectangle([0.0, 0.0], [2.0, 2.0])), [9, 9], 0.0)?;
        let high = subdomain(Section::solid(Outline::rectangle([2.0, 0.7], [4.0, 2.7])), [9, 9], 0.0)?;
        let both = [low, high];
        let found = common(&both);
        assert_eq!(found.len(), 1);
        assert_eq!([found[0].from, found[0].to], [[2.0, 0.7], [2.0, 2.0]]);
        assert_eq!(found[0].edges, [EdgeId(1), EdgeId(3)]);
        let ys =
            |side: usize| -> Vec<f64> { places(&both[side], &found[0].nodes[side]).iter().map(|p| p[1]).collect() };
        assert_eq!(ys(0), [0.75, 1.0, 1.25, 1.5, 1.75, 2.0]);
        assert_eq!(ys(1).len(), 6); // 0.7, 0.95, …, 1.95
        assert_eq!(ys(1)[0], 0.7);
        Ok(())
    }

    #[test]
    fn a_long_side_is_shared_with_each_of_two_neighbours_along_it() -> Result<(), CloudError> {
        let table = subdomain(Section::solid(Outline::rectangle([0.0, 0.0], [4.0, 1.0])), [17, 5], 0.0)?;
        let left = subdomain(Section::solid(Outline::rectangle([0.0, 1.0], [1.0, 2.0])), [5, 5], 0.0)?;
        let right = subdomain(Section::solid(Outline::rectangle([2.5, 1.0], [4.0, 2.0])), [7, 5], 0.0)?;
        let found = common(&[table, left, right]);
        let of = |k: usize| (found[k].between.map(|s| s.0), found[k].from, found[k].to);
        assert_eq!(found.len(), 2);
        assert_eq!(of(0), ([0, 1], [1.0, 1.0], [0.0, 1.0])); // the table's upper side leads to the left
        assert_eq!(of(1), ([0, 2], [4.0, 1.0], [2.5, 1.0]));
        assert_eq!(found[0].nodes.each_ref().map(Vec::len), [5, 5]);
        Ok(())
    }

    #[test]
    fn a_subdomain_that_fills_a_hole_shares_all_of_its_edges() -> Result<(), CloudError> {
        let mut hole = Outline::rectangle([1.0, 1.0], [3.0, 2.0]);
        hole.edges.iter_mut().for_each(|edge| edge.name = format!("h1/{}", edge.name));
        let matrix = Section { contour: Outline::rectangle([0.0, 0.0], [4.0, 3.0]), holes: vec![hole] };
        let inclusion = Section::solid(Outline::rectangle([1.0, 1.0], [3.0, 2.0]));
        let both = [subdomain(matrix, [17, 13], 0.0)?, subdomain(inclusion, [9, 5], 0.0)?];
        let found = common(&both);
        let edges: Vec<[u32; 2]> = found.iter().map(|common| common.edges.map(|edge| edge.0)).collect();
        assert_eq!(edges, [[4, 0], [5, 1], [6, 2], [7, 3]]);
        assert_eq!(found[0].names, ["h1/e1", "e1"]);
        let length: f64 = found.iter().map(|common| distance(common.from, common.to)).sum();
        assert_eq!(length, 6.0);
        for common in &found {
            // (2) with N/W of the whole section at the hole: ⌈17·2/4⌉ and ⌈13/3⌉ nodes; 9 and 5 of the inclusion's own.
            let expected = if common.from[1] == common.to[1] { [9, 9] } else { [5, 5] };
            assert_eq!(common.nodes.each_ref().map(Vec::len), expected);
        }
        Ok(())
    }

    #[test]
    fn three_subdomains_that_meet_in_a_point_share_three_edges_and_no_fourth() -> Result<(), CloudError> {
        // Sectors of the square (−1,−1)–(1,1) between (1,0), (−1,1) and (−1,−1), all with a corner at the origin.
        let sectors = [
            polygon(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [-1.0, 1.0]]),
            polygon(&[[0.0, 0.0], [-1.0, 1.0], [-1.0, -1.0]]),
            polygon(&[[0.0, 0.0], [-1.0, -1.0], [1.0, -1.0], [1.0, 0.0]]),
        ];
        let subdomains =
            sectors.into_iter().map(|section| subdomain(section, [13, 13], 0.1)).collect::<Result<Vec<_>, _>>()?;
        let found = common(&subdomains);
        let ends: Vec<_> = found.iter().map(|common| (common.between.map(|s| s.0), common.from, common.to)).collect();
        let origin = [0.0, 0.0];
        assert_eq!(ends, [([0, 1], [-1.0, 1.0], origin), ([0, 2], origin, [1.0, 0.0]), ([1, 2], [-1.0, -1.0], origin)]);
        Ok(())
    }

    #[test]
    fn subdomains_apart_in_one_line_or_at_a_corner_share_nothing() -> Result<(), CloudError> {
        let square = |x: f64, y: f64| Section::solid(Outline::rectangle([x, y], [x + 1.0, y + 1.0]));
        // In a row with gaps of 1e-6 and 1, and two that touch at corners alone.
        let sections =
            [square(0.0, 0.0), square(1.0 + 1e-6, 0.0), square(3.0, 0.0), square(4.0, 1.0), square(5.0, 0.0)];
        let subdomains =
            sections.into_iter().map(|section| subdomain(section, [5, 5], 0.0)).collect::<Result<Vec<_>, _>>()?;
        assert_eq!(common(&subdomains), []);
        assert_eq!(common(&[]), []);
        Ok(())
    }

    #[test]
    fn a_gap_of_rounding_does_not_part_two_subdomains() -> Result<(), CloudError> {
        // 0.1 + 0.2 is not 0.3; and the size of the whole sets the tolerance.
        let left = subdomain(Section::solid(Outline::rectangle([0.0, 0.0], [0.1 + 0.2, 1.0])), [5, 9], 0.0)?;
        let right = subdomain(Section::solid(Outline::rectangle([0.3, 0.0], [1.0, 1.0])), [7, 9], 0.0)?;
        let found = common(&[left, right]);
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].nodes.each_ref().map(Vec::len), [9, 9]);
        Ok(())
    }

    #[test]
    fn common_edges_are_the_same_in_millimetres_and_in_kilometres() -> Result<(), CloudError> {
        for scale in [1.0, 1e-6, 1e3] {
            let corner = |x: f64, y: f64| [x * scale, y * scale];
            let skew = subdomain(polygon(&[corner(0.1, 0.0), corner(1.7, 0.3), corner(0.4, 1.1)]), [15, 15], 0.2)?;
            let other = polygon(&[corner(1.7, 0.3), corner(1.9, 1.3), corner(0.4, 1.1)]);
            let found = common(&[skew, subdomain(other, [9, 9], 0.2)?]);
            assert_eq!(found.len(), 1, "scale {scale}");
            assert_eq!(found[0].nodes.each_ref().map(Vec::len), [13, 8], "scale {scale}");
        }
        Ok(())
    }

    fn graph(text: &str, from_x: f64, to_x: f64) -> Curve {
        Curve::Graph { y: Expression::parse(text, &["x"]).expect("a formula"), from_x, to_x }
    }

    fn parametric(x: &str, y: &str, from_t: f64, to_t: f64) -> Curve {
        let [x, y] = [x, y].map(|text| Expression::parse(text, &["t"]).expect("a formula"));
        Curve::Parametric { x, y, from_t, to_t }
    }

    /// A polygon with one of its edges curved.
    fn with_curve(corners: &[Point], edge: usize, curve: Curve) -> Section {
        let mut outline = Outline::polygon(corners.iter().copied());
        outline.edges[edge].curve = curve;
        Section::solid(outline)
    }

    /// Plate (−2,−2)–(2,2) with a round hole of radius 1 about the origin.
    fn pierced() -> Section {
        let mut hole = Outline::circle([0.0, 0.0], 1.0);
        hole.edges[0].name = "h1/e1".into();
        Section { contour: Outline::rectangle([-2.0, -2.0], [2.0, 2.0]), holes: vec![hole] }
    }

    /// Nodes of both sides begin and end with those of the ends, and lie on the unit circle in one direction.
    fn assert_along_the_unit_circle(all: &[Subdomain], common: &CommonEdge) {
        for side in 0..2 {
            let at = places(&all[common.between[side].index()], &common.nodes[side]);
            assert!(at.iter().all(|p| (p[0].hypot(p[1]) - 1.0).abs() < 1e-9), "{at:?}");
            let turns = at.windows(2).map(|pair| cross(pair[0], pair[1]).signum());
            assert!(turns.clone().all(|turn| turn == 1.0) || turns.clone().all(|turn| turn == -1.0), "{at:?}");
        }
        // Every end is a vertex of one side at least.
        for end in [common.from, common.to] {
            let is_at = |side: usize| {
                let at = places(&all[common.between[side].index()], &common.nodes[side]);
                at.iter().any(|p| distance(*p, end) < 1e-9)
            };
            assert!(is_at(0) || is_at(1), "{end:?}");
        }
    }

    #[test]
    fn a_round_hole_and_the_disc_that_fills_it_share_the_circle_once_around() -> Result<(), CloudError> {
        for irregularity in [0.0, 0.3] {
            let disc = Section::solid(Outline::circle([0.0, 0.0], 1.0));
            let all = [subdomain(pierced(), [21, 21], irregularity)?, subdomain(disc, [15, 15], irregularity)?];
            let found = common(&all);
            assert_eq!(found.len(), 1);
            assert_eq!(found[0].names, ["h1/e1", "e1"]);
            assert_eq!((found[0].is_closed(), found[0].from), (true, [1.0, 0.0]));
            let around =
                |k: usize| all[k].cloud.boundary().segments().iter().filter(|s| k == 1 || s.edge.0 == 4).count();
            assert_eq!(found[0].nodes.each_ref().map(Vec::len), [around(0), around(1)]);
            assert_along_the_unit_circle(&all, &found[0]);
        }
        Ok(())
    }

    #[test]
    fn a_circle_with_its_seam_elsewhere_is_shared_in_two_parts() -> Result<(), CloudError> {
        let curve = parametric("cos(t)", "sin(t)", 2.0, 2.0 - TAU);
        let vertices = vec![[2.0_f64.cos(), 2.0_f64.sin()]];
        let clockwise = Outline { vertices, edges: vec![OutlineEdge { name: "rim".into(), curve, nodes: None }] };
        let all = [subdomain(pierced(), [21, 21], 0.0)?, subdomain(Section::solid(clockwise), [15, 15], 0.0)?];
        let found = common(&all);
        assert_eq!(found.len(), 2);
        assert_eq!((found[0].from, found[1].to), ([1.0, 0.0], [1.0, 0.0]));
        assert_eq!((found[0].to, found[1].from), (found[1].from, [2.0_f64.cos(), 2.0_f64.sin()]));
        for part in &found {
            for side in 0..2 {
                let at = places(&all[side], &part.nodes[side]);
                assert!(at.windows(2).all(|pair| cross(pair[0], pair[1]) > 0.0), "{at:?}"); // the hole's direction
            }
        }
        Ok(())
    }

    #[test]
    fn two_half_discs_fill_a_round_hole_whichever_way_they_are_cut_and_given() -> Result<(), CloudError> {
        let half = |text: &str, from: f64| with_curve(&[[-from, 0.0], [from, 0.0]], 1, graph(text, from, -from));
        let arcs = |angle: f64| {
            let (sine, cosine) = angle.sin_cos();
            let ends = [[-cosine, -sine], [cosine, sine]];
            let turned =
                |from: Point, to: Point, turn| with_curve(&[to, from], 1, Curve::arc([0.0; 2], from, to, turn));
            [turned(ends[0], ends[1], Turn::CounterClockwise), turned(ends[1], ends[0], Turn::CounterClockwise)]
        };
        let [right, left] = arcs(FRAC_PI_2);
        let [skew_right, skew_left] = arcs(0.7);
        for (halves, n_on_circle) in [
            ([half("sqrt(1-x^2)", 1.0), half("-sqrt(1-x^2)", -1.0)], 2),
            ([right, left], 3), // the seam of the circle is a vertex
            ([skew_right, skew_left], 3),
        ] {
            let [first, second] = halves;
            let all = [
                subdomain(pierced(), [21, 21], 0.2)?,
                subdomain(first, [9, 15], 0.2)?,
                subdomain(second, [13, 11], 0.2)?,
            ];
            let found = common(&all);
            let on_circle: Vec<_> = found.iter().filter(|edge| edge.between[0].0 == 0).collect();
            assert_eq!(on_circle.len(), n_on_circle);
            assert_eq!(found.len(), n_on_circle + 1); // and the diameter
            let mut turned = 0.0;
            for edge in &on_circle {
                assert_along_the_unit_circle(&all, edge);
                turned += cross(edge.from, edge.to).atan2(dot(edge.from, edge.to)).rem_euclid(TAU);
            }
            assert!((turned - TAU).abs() < 1e-9);
        }
        Ok(())
    }

    #[test]
    fn one_curve_in_five_forms_is_one_curve() -> Result<(), CloudError> {
        // The quarter of the unit circle from (1,0) to (0,1), above it a block, below it a sector.
        let forms = |backwards: bool| {
            let r = if backwards { [0.0, 1.0] } else { [1.0, 0.0] };
            let (from, to) = (r, [r[1], r[0]]);
            let turn = if backwards { Turn::Clockwise } else { Turn::CounterClockwise };
            [
                Curve::arc([0.0, 0.0], from, to, turn),
                graph("sqrt(1-x^2)", from[0], to[0]),
                parametric("cos(t)", "sin(t)", FRAC_PI_2 * from[1], FRAC_PI_2 * to[1]),
                parametric("(1-t^2)/(1+t^2)", "2*t/(1+t^2)", from[1], to[1]),
                parametric("sqrt(1-t^2)", "t", from[1], to[1]),
            ]
        };
        for below in forms(false) {
            let sector = with_curve(&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], 1, below);
            for above in forms(true) {
                let block = with_curve(&[[0.0, 1.0], [1.0, 0.0], [1.0, 1.0]], 0, above.clone());
                let all = [subdomain(sector.clone(), [11, 11], 0.0)?, subdomain(block, [15, 15], 0.0)?];
                let found = common(&all);
                assert_eq!(found.len(), 1, "{above:?}");
                assert_eq!(
                    (found[0].edges, found[0].from, found[0].to),
                    ([EdgeId(1), EdgeId(0)], [1.0, 0.0], [0.0, 1.0])
                );
                assert_along_the_unit_circle(&all, &found[0]);
            }
        }
        Ok(())
    }

    #[test]
    fn curves_that_overlap_in_part_share_that_part() -> Result<(), CloudError> {
        // A wave from x = 0 to 3 below, from 1 to 5 above: common from 1 to 3.
        let wave = "sin(2*x)/4";
        let low =
            with_curve(&[[0.0, -1.0], [3.0, -1.0], [3.0, 6.0_f64.sin() / 4.0], [0.0, 0.0]], 2, graph(wave, 3.0, 0.0));
        let [y_1, y_5] = [1.0_f64, 5.0].map(|x| (2.0 * x).sin() / 4.0);
        let high = with_curve(&[[1.0, y_1], [5.0, y_5], [5.0, 2.0], [1.0, 2.0]], 0, graph(wave, 1.0, 5.0));
        let all = [subdomain(low, [31, 15], 0.1)?, subdomain(high, [21, 15], 0.1)?];
        let found = common(&all);
        assert_eq!(found.len(), 1);
        assert_eq!((found[0].from, found[0].to), ([3.0, 6.0_f64.sin() / 4.0], [1.0, y_1]));
        let xs = |side: usize| -> Vec<f64> { places(&all[side], &found[0].nodes[side]).iter().map(|p| p[0]).collect() };
        assert!(xs(0).windows(2).all(|pair| pair[0] > pair[1]) && xs(1).windows(2).all(|pair| pair[0] > pair[1]));
        assert_eq!((xs(0)[0], xs(1).last().copied()), (3.0, Some(1.0)));
        Ok(())
    }

    #[test]
    fn a_straight_graph_and_a_line_are_one_curve() -> Result<(), CloudError> {
        let low = with_curve(&[[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 1.0]], 2, graph("1 + x/2", 2.0, 0.0));
        let high = polygon(&[[0.0, 1.0], [2.0, 2.0], [0.0, 3.0]]);
        let found = common(&[subdomain(low, [9, 9], 0.0)?, subdomain(high, [9, 9], 0.0)?]);
        assert_eq!((found.len(), found[0].edges), (1, [EdgeId(2), EdgeId(0)]));
        Ok(())
    }

    #[test]
    fn curves_that_touch_cross_or_nearly_coincide_share_nothing() {
        let tolerance = 1e-9;
        let arc = || with_curve(&[[-1.0, 0.0], [1.0, 0.0]], 1, graph("sqrt(1-x^2)", 1.0, -1.0));
        for other in [
            Section::solid(Outline::circle([0.0, 2.0], 1.0)), // touches from outside
            Section::solid(Outline::circle([0.0, 0.5], 0.5)), // from inside
            Section::solid(Outline::circle([0.0, 0.0], 1.0 + 1e-7)),
            Section::solid(Outline::circle([1e-8, 0.0], 1.0)),
            Section::solid(Outline::circle([1.0, 0.0], 1.0)), // crosses
            with_curve(&[[-1.0, 2.0], [-1.0, 1.0], [1.0, 1.0], [1.0, 2.0]], 1, graph("1 + x^6", -1.0, 1.0)),
            with_curve(&[[1.0, 0.0], [3.0, 0.0]], 1, graph("sqrt(1-(x-2)^2)", 3.0, 1.0)), // a common vertex
        ] {
            let parts = common_parts(&[&arc(), &other], tolerance);
            assert_eq!(parts, [], "{other:?}");
        }
    }

    #[test]
    fn many_curved_edges_are_found_in_time_that_grows_little_faster_than_they() {
        // Two rows of arches, one above the other.
        let row = |n: usize, below: bool| {
            let joints: Vec<Point> = (0..=n).map(|k| [k as f64, 0.0]).collect();
            let (mut corners, height) = (joints, if below { -1.0 } else { 2.0 });
            if !below {
                corners.reverse();
            }
            let [first, last] = [corners[0], corners[n]];
            corners.extend([[last[0], height], [first[0], height]]);
            let mut outline = Outline::polygon(corners);
            for edge in outline.edges.iter_mut().take(n) {
                let Curve::Line { from, to } = edge.curve else { continue };
                let centre = [0.5 * (from[0] + to[0]), -0.25];
                let turn = if below { Turn::Clockwise } else { Turn::CounterClockwise };
                edge.curve = Curve::arc(centre, from, to, turn);
            }
            Section::solid(outline)
        };
        let n = 2000;
        let (low, high) = (row(n, true), row(n, false));
        let parts = common_parts(&[&low, &high], 1e-9 * n as f64);
        assert_eq!(parts.len(), n);
        assert!(parts.iter().all(|part| part.edges[0].0 + part.edges[1].0 == n as u32 - 1));
    }
}
