//! Closed paths of curves.

use std::f64::consts::{PI, TAU};

use nmt_geom::point::{cross, dot, sub};
use nmt_geom::{Bbox, Point};

use crate::{Curve, CurveError};

/// A closed path: edge i leads from vertex i to the next, the last one back to vertex 0.
///
/// A circle or an ellipse has one vertex, at angle 0, and one closed edge; so may a parametric curve that ends where it
/// begins.
#[derive(Clone, Debug, PartialEq)]
pub struct Outline {
    /// Vertices, shape (n_edges, 2), in the user's length unit.
    pub vertices: Vec<Point>,
    /// Edges, as many as vertices.
    pub edges: Vec<OutlineEdge>,
}

/// An edge of an outline.
#[derive(Clone, Debug, PartialEq)]
pub struct OutlineEdge {
    /// What reports and files call it.
    pub name: String,
    /// The way from its vertex to the next.
    pub curve: Curve,
    /// Its own number of nodes, ends included; by default [`node_count`](crate::node_count).
    pub nodes: Option<usize>,
}

/// A fault of one edge.
#[derive(Clone, Debug, PartialEq)]
pub struct OutlineFault {
    /// The edge, row of [`Outline::edges`].
    pub edge: usize,
    /// What is wrong with it.
    pub error: CurveError,
}

impl Outline {
    /// Straight edges `e1`, `e2`, … between the vertices.
    pub fn polygon(vertices: impl IntoIterator<Item = Point>) -> Self {
        let vertices: Vec<Point> = vertices.into_iter().collect();
        let next = vertices.iter().cycle().skip(1);
        let line = |(from, to): (&Point, &Point)| Curve::Line { from: *from, to: *to };
        let edges = vertices.iter().zip(next).map(line).enumerate().map(|(i, curve)| unnamed(i, curve)).collect();
        Self { vertices, edges }
    }

    /// The rectangle between two opposite corners, counter-clockwise from its lower left one.
    pub fn rectangle(from: Point, to: Point) -> Self {
        let low = [from[0].min(to[0]), from[1].min(to[1])];
        let high = [from[0].max(to[0]), from[1].max(to[1])];
        Self::polygon([low, [high[0], low[1]], high, [low[0], high[1]]])
    }

    /// A circle, counter-clockwise from angle 0.
    pub fn circle(centre: Point, radius: f64) -> Self {
        Self::ellipse(centre, [radius, radius], 0.0)
    }

    /// An ellipse, counter-clockwise from the end of its first semi-axis, which is turned by `rotation` (radians) from
    /// the x-axis.
    pub fn ellipse(centre: Point, semi_axes: [f64; 2], rotation: f64) -> Self {
        let curve = Curve::Ellipse { centre, semi_axes, rotation };
        Self { vertices: vec![curve.point(0.0)], edges: vec![unnamed(0, curve)] }
    }

    /// The vertices that an edge leads from and to; `None` beyond the last edge.
    fn ends(&self, edge: usize) -> Option<[Point; 2]> {
        let from = *self.vertices.get(edge)?;
        let to = *self.vertices.get(edge + 1).or(self.vertices.first())?;
        Some([from, to])
    }

    /// The envelope, curves included \[D5\].
    pub fn envelope(&self) -> Bbox {
        let curves = self.edges.iter().map(|edge| edge.curve.envelope());
        curves.fold(Bbox::of(self.vertices.iter().copied()), Bbox::union)
    }

    /// A polygon along the outline: its vertices exactly, chords within `tolerance` (a length) of the curves, the first
    /// point not repeated.
    pub fn flatten(&self, tolerance: f64) -> Vec<Point> {
        let mut ring = Vec::new();
        for (vertex, edge) in self.vertices.iter().zip(&self.edges) {
            ring.push(*vertex);
            let along = edge.curve.flatten(tolerance);
            ring.extend(along.get(1..along.len().saturating_sub(1)).unwrap_or_default());
        }
        ring
    }

    /// All that is wrong with the edges one by one; `size` is the diagonal of the envelope of the whole problem.
    ///
    /// See [`Curve::faults`]. Whether edges cross one another is a question about the polygon of [`Outline::flatten`].
    pub fn faults(&self, size: f64) -> Vec<OutlineFault> {
        let faults_of = |(number, edge): (usize, &OutlineEdge)| {
            let [from, to] = self.ends(number).unwrap_or([[f64::NAN; 2]; 2]);
            let faults = edge.curve.faults(from, to, size);
            faults.into_iter().map(move |error| OutlineFault { edge: number, error })
        };
        self.edges.iter().enumerate().flat_map(faults_of).collect()
    }

    /// Angle at a vertex between the edges before and after it, on the left of the path as given; radians, from 0 to
    /// 2π.
    ///
    /// It is the interior angle of a counter-clockwise outline; π where the path is smooth, more where it turns right.
    /// Numbers beyond the last vertex count round again.
    pub fn interior_angle(&self, vertex: usize) -> f64 {
        let n = self.edges.len().min(self.vertices.len());
        if n == 0 {
            return PI;
        }
        let vertex = vertex % n;
        let (before, after) = (&self.edges[(vertex + n - 1) % n].curve, &self.edges[vertex].curve);
        let [out, back] = [after.start_direction(), before.end_direction().map(|c| -c)];
        if out == [0.0, 0.0] || back == [0.0, 0.0] {
            return PI;
        }
        let angle = cross(out, back).atan2(dot(out, back));
        let angle = if angle < 0.0 { angle + TAU } else { angle };
        // Two edges that touch: which of them is on the left shows a little further on.
        const TOUCHING: f64 = 1e-6; // the accuracy of the directions
        if angle > TOUCHING && angle < TAU - TOUCHING {
            return angle;
        }
        const FURTHER: f64 = 1.0 / 64.0;
        let corner = self.vertices[vertex];
        let (out, back) = (sub(after.point(FURTHER), corner), sub(before.point(1.0 - FURTHER), corner));
        if cross(out, back) >= 0.0 { 0.0 } else { TAU }
    }
}

fn unnamed(number: usize, curve: Curve) -> OutlineEdge {
    OutlineEdge { name: format!("e{}", number + 1), curve, nodes: None }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Turn;
    use crate::curve::samples::{graph, parametric};
    use nmt_geom::point::distance;

    /// A square of side 2 with its upper side an arch.
    fn arch() -> Outline {
        let mut outline = Outline::polygon([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]]);
        outline.edges[2].curve = graph("1 + 0.2*sin(pi*x/2)", 2.0, 0.0);
        outline
    }

    #[test]
    fn shapes_have_named_edges_between_their_vertices() {
        let rectangle = Outline::rectangle([2.0, 1.0], [0.0, 0.0]);
        assert_eq!(rectangle.vertices, [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]]);
        let names: Vec<&str> = rectangle.edges.iter().map(|edge| edge.name.as_str()).collect();
        assert_eq!(names, ["e1", "e2", "e3", "e4"]);
        assert_eq!(rectangle.faults(2.0), []);
        let circle = Outline::circle([1.0, 1.0], 0.5);
        assert_eq!((circle.vertices.as_slice(), circle.edges.len()), (&[[1.5, 1.0]][..], 1));
        assert_eq!(circle.faults(2.0), []);
    }

    #[test]
    fn the_envelope_takes_in_the_bulge() {
        let envelope = arch().envelope();
        assert_eq!((envelope.min, envelope.max[0]), ([0.0, 0.0], 2.0));
        assert!((envelope.max[1] - 1.2).abs() < 1e-12); // the promise of Curve::envelope
    }

    #[test]
    fn the_polygon_has_the_vertices_and_stays_near_the_curves() {
        let ring = arch().flatten(1e-3);
        assert!(arch().vertices.iter().all(|vertex| ring.contains(vertex)));
        assert!(ring.len() > 10 && ring.len() < 200);
        assert!(ring[0] != ring[ring.len() - 1]);
        let circle = Outline::circle([0.0, 0.0], 1.0).flatten(1e-4);
        assert!(circle.iter().all(|p| (distance(*p, [0.0, 0.0]) - 1.0).abs() < 1e-15)); // rounding
        let nearest = circle.windows(2).map(|pair| distance(nmt_geom::point::lerp(pair[0], pair[1], 0.5), [0.0, 0.0]));
        assert!(nearest.fold(1.0, f64::min) >= 1.0 - 1e-4);
    }

    #[test]
    fn faults_name_their_edge() {
        let mut outline = arch();
        outline.edges[2].curve = graph("1.1 + 0.2*sin(pi*x/2)", 2.0, 0.0);
        outline.edges[1].curve = graph("x", 2.0, 2.0);
        let edges: Vec<usize> = outline.faults(2.2).iter().map(|fault| fault.edge).collect();
        assert_eq!(edges, [1, 2, 2]);
    }

    #[test]
    fn interior_angles_of_corners_and_seams() {
        let square = Outline::rectangle([0.0, 0.0], [1.0, 1.0]);
        assert!((0..4).all(|v| (square.interior_angle(v) - PI / 2.0).abs() < 1e-15)); // rounding
        let notch = Outline::polygon([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, 1.0], [0.0, 2.0]]);
        assert!((notch.interior_angle(3) - 1.5 * PI).abs() < 1e-15);
        assert!((Outline::circle([3.0, 1.0], 2.0).interior_angle(0) - PI).abs() < 1e-15);
        let clockwise = Outline::polygon([[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]]);
        assert!((clockwise.interior_angle(0) - 1.5 * PI).abs() < 1e-15);
        // Half a disc: the vertical tangents of the root meet the diameter at right angles.
        let mut half = Outline::polygon([[-1.0, 0.0], [1.0, 0.0]]);
        half.edges[1].curve = graph("sqrt(1-x^2)", 1.0, -1.0);
        assert_eq!(half.faults(2.0), []);
        assert!((half.interior_angle(0) - PI / 2.0).abs() < 1e-7); // a secant of relative length 1.5e-8
        assert!((half.interior_angle(1) - PI / 2.0).abs() < 1e-7);
    }

    #[test]
    fn touching_edges_enclose_nothing_or_all() {
        // A horn between the arc below and the line along its tangent, at the vertex 0.
        let horn = |path: [Point; 2], low: usize| {
            let mut outline = Outline::polygon(path);
            let turn = if low == 0 { Turn::CounterClockwise } else { Turn::Clockwise };
            outline.edges[low].curve = Curve::arc([0.0, 1.0], path[low], path[1 - low], turn);
            outline
        };
        let mut thin = horn([[0.0, 0.0], [1.0, 1.0]], 0);
        thin.edges[1].curve = parametric("t", "t^4", 1.0, 0.0);
        // x⁴ is below the arc, whose ordinate begins as x²/2: the region is on the right.
        assert_eq!(thin.interior_angle(0), TAU);
    }

    #[test]
    fn a_closed_parametric_curve_is_an_outline() {
        let curve = parametric("cos(t)*(1+0.2*cos(3*t))", "sin(t)*(1+0.2*cos(3*t))", 0.0, TAU);
        let outline = Outline { vertices: vec![[1.2, 0.0]], edges: vec![unnamed(0, curve)] };
        assert_eq!(outline.faults(2.0), []);
        assert!((outline.interior_angle(0) - PI).abs() < 1e-12); // rounding of the derivatives
    }

    #[test]
    fn an_empty_outline_does_no_harm() {
        let none = Outline::polygon([]);
        assert_eq!((none.faults(1.0).len(), none.flatten(1.0).len(), none.interior_angle(3)), (0, 0, PI));
    }
}
