//! Sections that the tests share, and strategies that draw random ones. Each can be built in any unit of length.
//! The shapes are those of the tests of nmt-cloud; what is drawn here becomes a mesh that has passed its own check.

use nmt_cloud::{CloudParams, Section, generate};
use nmt_curve::{Curve, Expression, Outline, Turn};
use nmt_geom::Point;
use nmt_tri::Mesh;
use proptest::prelude::*;
use std::f64::consts::{PI, TAU};

/// A section by its shape, to be built in any unit.
#[derive(Clone, Debug)]
pub enum Shape {
    /// A polygon that the origin sees all of, with a hole about the origin.
    Star { radii: Vec<f64>, turn: f64, stretch: f64, hole: Hole },
    /// A plate 4 × 2 with a notch from above, `width` wide at its bottom and twice that at its mouth.
    Slotted { width: f64 },
    /// A plate 4 × 2 with a round, a square and an elliptic hole.
    Perforated,
    /// A plate with an arched top, a wavy bottom, a round left and a straight right side.
    Arch,
}

#[derive(Clone, Copy, Debug)]
pub enum Hole {
    None,
    Round,
    Triangular,
}

impl Shape {
    /// The section with `unit` user's units of length for each unit of the shape.
    pub fn section(&self, unit: f64) -> Section {
        let at = |p: Point| [p[0] * unit, p[1] * unit];
        let polygon = |corners: &[Point]| Outline::polygon(corners.iter().map(|p| at(*p)));
        match self {
            Self::Star { radii, turn, stretch, hole } => {
                let corner = |(k, r): (usize, &f64)| {
                    let t = turn + TAU * k as f64 / radii.len() as f64;
                    [stretch * r * t.cos(), r * t.sin()]
                };
                let corners: Vec<Point> = radii.iter().enumerate().map(corner).collect();
                let holes = match hole {
                    Hole::None => vec![],
                    Hole::Round => vec![Outline::circle([0.0, 0.0], 0.2 * unit)],
                    Hole::Triangular => vec![polygon(&[[0.2, 0.0], [-0.1, -0.2], [-0.1, 0.2]])],
                };
                Section { contour: polygon(&corners), holes }
            }
            Self::Slotted { width } => Section::solid(polygon(&[
                [0.0, 0.0],
                [4.0, 0.0],
                [4.0, 2.0],
                [1.7 + width, 2.0],
                [1.7 + width / 2.0, 0.6],
                [1.7 - width / 2.0, 0.6],
                [1.7 - width, 2.0],
                [0.0, 2.0],
            ])),
            Self::Perforated => Section {
                contour: polygon(&[[0.0, 0.0], [4.0, 0.0], [4.0, 2.0], [0.0, 2.0]]),
                holes: vec![
                    Outline::circle(at([0.8, 1.1]), 0.4 * unit),
                    polygon(&[[1.8, 0.5], [1.8, 1.5], [2.4, 1.5], [2.4, 0.5]]),
                    Outline::ellipse(at([3.2, 1.0]), [0.5 * unit, 0.3 * unit], 0.4),
                ],
            },
            Self::Arch => {
                let mut contour = polygon(&[[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [0.0, 1.0]]);
                let graph = |text: &str, from_x: f64, to_x: f64| {
                    let y = Expression::parse(&text.replace("unit", &format!("{unit:e}")), &["x"]).expect("a formula");
                    Curve::Graph { y, from_x: from_x * unit, to_x: to_x * unit }
                };
                contour.edges[0].curve = graph("unit*0.1*sin(2*pi*x/unit)", 0.0, 3.0);
                contour.edges[2].curve = graph("unit*(1 + 0.4*sin(pi*x/(3*unit))^2)", 3.0, 0.0);
                contour.edges[3].curve =
                    Curve::arc(at([0.0, 0.5]), at([0.0, 1.0]), at([0.0, 0.0]), Turn::CounterClockwise);
                Section { contour, holes: vec![Outline::circle(at([1.5, 0.7]), 0.25 * unit)] }
            }
        }
    }
}

/// Any of the shapes; slots down to 1e-6 of their depth.
pub fn any_shape() -> impl Strategy<Value = Shape> {
    prop_oneof![
        4 => star(),
        1 => prop_oneof![0.1..0.8f64, Just(1e-6), Just(0.02)].prop_map(|width| Shape::Slotted { width }),
        1 => Just(Shape::Perforated),
        1 => Just(Shape::Arch),
    ]
}

fn star() -> impl Strategy<Value = Shape> {
    let hole = prop_oneof![Just(Hole::None), Just(Hole::Round), Just(Hole::Triangular)];
    // Six corners at least and radii from 0.5: the sides keep 0.43 away from the origin, the holes are within 0.23.
    (prop::collection::vec(0.5..1.2f64, 6..14), 0.0..PI, 1.0..2.5f64, hole)
        .prop_map(|(radii, turn, stretch, hole)| Shape::Star { radii, turn, stretch, hole })
}

/// Densities that leave interior nodes in every shape.
pub fn any_density() -> impl Strategy<Value = [usize; 2]> {
    prop::array::uniform2(14usize..28)
}

pub fn params(nodes: [usize; 2], irregularity: f64) -> CloudParams {
    CloudParams { nodes, irregularity, ..CloudParams::default() }
}

/// A mesh that has passed its own check.
pub fn mesh(section: &Section, params: &CloudParams) -> Mesh {
    let cloud = generate(section, params).expect("a sound section with room for interior nodes");
    let mesh = Mesh::constrained(cloud).expect("every generated cloud has a mesh");
    assert_eq!(mesh.check(), Ok(()));
    mesh
}
