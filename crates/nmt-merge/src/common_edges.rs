//! Pairs of subdomains to common edges, with the nodes of both sides in order.

use crate::overlap::{CommonPart, common_part};
use nmt_cloud::{Cloud, Section};
use nmt_curve::Curve;
use nmt_geom::point::{dot, sub};
use nmt_geom::tol::SAME_POINT_REL;
use nmt_geom::{Bbox, EdgeId, NodeId, Point, SegmentIndex, SubdomainId};

/// One subdomain of the problem, borrowed.
#[derive(Clone, Copy, Debug)]
pub struct Side<'a> {
    /// Its outlines, with the names of their edges.
    pub section: &'a Section,
    /// The cloud generated on it.
    pub cloud: &'a Cloud,
}

/// A straight piece of boundary that two subdomains share; of every pair the first is the subdomain with the smaller
/// number.
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
    /// Where it ends.
    pub to: Point,
    /// Each side's boundary nodes on it, ends included, from `from` to `to`. An end that is a vertex of the other side
    /// alone has no node on this side.
    pub nodes: [Vec<NodeId>; 2],
}

/// The common edges of all pairs of subdomains, ordered by the numbers of the subdomains, then of the edges.
///
/// Two straight edges have in common where they run along each other within 1e-9 of the size of the whole problem,
/// over a length of more than that: entirely or in part, the boundaries of holes included. Edges that are not
/// [`Curve::Line`] are left out, even where two of them are the same curve.
///
/// Takes O(n log n) for n edges of about equal length, and time for the nodes on the edges found.
pub fn common_edges(sides: &[Side]) -> Vec<CommonEdge> {
    let envelope = sides.iter().fold(Bbox::EMPTY, |all, side| all.union(side.section.contour.envelope()));
    let tolerance = SAME_POINT_REL * envelope.size();
    let lines: Vec<StraightEdge> = sides.iter().enumerate().flat_map(|(k, side)| straight_edges(k, side)).collect();
    let index = SegmentIndex::new(lines.iter().map(|line| line.ends));
    let mut found = Vec::new();
    for [i, j] in index.close_pairs(tolerance) {
        let (a, b) = (&lines[i], &lines[j]);
        if a.subdomain == b.subdomain {
            continue;
        }
        if let Some(part) = common_part(a.ends, b.ends, tolerance) {
            let nodes_of = |line: &StraightEdge| nodes_on(sides[line.subdomain].cloud, line.edge, &part, tolerance);
            found.push(CommonEdge {
                between: [a, b].map(|line| SubdomainId::of(line.subdomain)),
                edges: [a.edge, b.edge],
                names: [a.name.to_owned(), b.name.to_owned()],
                from: part.from,
                to: part.to,
                nodes: [nodes_of(a), nodes_of(b)],
            });
        }
    }
    found.sort_by_key(|common| (common.between, common.edges));
    found
}

/// A straight edge of an outline and whose it is.
struct StraightEdge<'a> {
    subdomain: usize,
    edge: EdgeId,
    name: &'a str,
    ends: [Point; 2],
}

fn straight_edges<'a>(subdomain: usize, side: &Side<'a>) -> Vec<StraightEdge<'a>> {
    let section: &'a Section = side.section;
    let edges = section.loops().flat_map(|outline| &outline.edges);
    let straight = edges.enumerate().filter_map(|(number, edge)| match edge.curve {
        Curve::Line { from, to } => {
            Some(StraightEdge { subdomain, edge: EdgeId::of(number), name: &edge.name, ends: [from, to] })
        }
        _ => None,
    });
    straight.collect()
}

/// The boundary nodes of `cloud` on `edge` between the ends of `part`, in its direction.
fn nodes_on(cloud: &Cloud, edge: EdgeId, part: &CommonPart, tolerance: f64) -> Vec<NodeId> {
    let direction = sub(part.to, part.from);
    let length = dot(direction, direction).sqrt();
    let along = |node: NodeId| dot(sub(cloud.xy()[node.index()], part.from), direction) / length;
    let lies_on = |node: &NodeId| cloud.edges(*node).is_some_and(|edges| edges.first == edge || edges.second == edge);
    let mut nodes: Vec<(f64, NodeId)> = (0..cloud.n_boundary())
        .map(NodeId::of)
        .filter(lies_on)
        .map(|node| (along(node), node))
        .filter(|(s, _)| (-tolerance..=length + tolerance).contains(s))
        .collect();
    nodes.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    nodes.into_iter().map(|(_, node)| node).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use nmt_cloud::{CloudError, CloudParams, generate};
    use nmt_curve::Outline;
    use nmt_geom::point::distance;

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

    #[test]
    fn a_common_arc_is_left_out_and_the_straight_parts_are_found() -> Result<(), CloudError> {
        // A disc filling the round hole of a plate, beside another plate.
        let disc = Outline::circle([1.0, 1.0], 0.5);
        let plate = Section { contour: Outline::rectangle([0.0, 0.0], [2.0, 2.0]), holes: vec![disc.clone()] };
        let beside = Section::solid(Outline::rectangle([2.0, 0.0], [3.0, 2.0]));
        let subdomains = [plate, Section::solid(disc), beside]
            .into_iter()
            .map(|section| subdomain(section, [13, 13], 0.0))
            .collect::<Result<Vec<_>, _>>()?;
        let pairs: Vec<_> = common(&subdomains).iter().map(|common| common.between.map(|s| s.0)).collect();
        assert_eq!(pairs, [[0, 2]]);
        Ok(())
    }
}
