//! Sections with an exact stress function (Gθ = 1), and how the tests solve them.

use nmt_cloud::{CloudParams, Section, generate};
use nmt_curve::{Curve, Expression, Outline, OutlineEdge, Turn};
use nmt_geom::Point;
use nmt_mfdm::{Formulation, SolveParams, TorsionProblem, TorsionSolution, exact, solve};
use nmt_tri::Mesh;
use std::f64::consts::TAU;

/// A section whose stress function is known.
pub struct Case {
    pub name: &'static str,
    pub section: Section,
    /// Extent along x and y in units of the longer one: N_x and N_y of square spacing follow it.
    pub aspect: [f64; 2],
    pub f: fn(Point) -> f64,
    pub j: f64,
}

impl Case {
    /// N_x and N_y for `across` nodes along the longer extent.
    pub fn nodes(&self, across: usize) -> [usize; 2] {
        self.aspect.map(|a| (a * (across - 1) as f64).round() as usize + 1)
    }
}

pub fn square() -> Case {
    Case {
        name: "square",
        section: Section::solid(Outline::rectangle([0.0, 0.0], [1.0, 1.0])),
        aspect: [1.0, 1.0],
        f: |p| exact::rectangle_f(1.0, 1.0, p),
        j: exact::rectangle(1.0, 1.0).j,
    }
}

pub fn rectangle() -> Case {
    Case {
        name: "rectangle",
        section: Section::solid(Outline::rectangle([0.0, 0.0], [2.0, 1.0])),
        aspect: [1.0, 0.5],
        f: |p| exact::rectangle_f(2.0, 1.0, p),
        j: exact::rectangle(2.0, 1.0).j,
    }
}

pub fn circle() -> Case {
    Case {
        name: "circle",
        section: Section::solid(Outline::circle([0.0, 0.0], 1.0)),
        aspect: [1.0, 1.0],
        f: |[x, y]| (1.0 - x * x - y * y) / 2.0,
        j: exact::ellipse(1.0, 1.0).j,
    }
}

pub fn ellipse() -> Case {
    Case {
        name: "ellipse",
        section: Section::solid(Outline::ellipse([0.0, 0.0], [2.0, 1.0], 0.0)),
        aspect: [1.0, 0.5],
        f: |[x, y]| 0.8 * (1.0 - x * x / 4.0 - y * y),
        j: exact::ellipse(2.0, 1.0).j,
    }
}

/// Side 1. F is twice the product of the distances from the sides, over the height.
pub fn triangle() -> Case {
    let height = 0.75f64.sqrt();
    Case {
        name: "triangle",
        section: Section::solid(Outline::polygon([[0.0, 0.0], [1.0, 0.0], [0.5, height]])),
        aspect: [1.0, height],
        f: |[x, y]| {
            let root3 = 3f64.sqrt();
            let product = y * (root3 * x - y) / 2.0 * (root3 * (1.0 - x) - y) / 2.0;
            2.0 * product / 0.75f64.sqrt()
        },
        j: exact::equilateral_triangle(1.0).j,
    }
}

/// A ring of radii 1/2 and 1, in which F is that of the full circle.
pub fn ring() -> Case {
    let disc = |r: f64| Outline::circle([0.0, 0.0], r);
    Case {
        name: "ring",
        section: Section { contour: disc(1.0), holes: vec![disc(0.5)] },
        j: exact::ring(0.5, 1.0).j,
        ..circle()
    }
}

/// A square with rounded sides and corners: F = (1 − r²)/2 + r⁴·cos 4t/20, which vanishes at
/// r² = 2/(1 + √(1 − 0.4·cos 4t)); no corner, and no quadratic.
pub fn rounded_square() -> Case {
    let formula = |ending: &str| {
        let text = format!("sqrt(2/(1 + sqrt(1 - 0.4*cos(4*t))))*{ending}");
        Expression::parse(&text, &["t"]).expect("a formula")
    };
    let curve = Curve::Parametric { x: formula("cos(t)"), y: formula("sin(t)"), from_t: 0.0, to_t: TAU };
    let edge = OutlineEdge { name: "e1".into(), curve: curve.clone(), nodes: None };
    // J = 2∫F by the trapezoidal rule around, which converges faster than any power of the number of points.
    let n = 256;
    let slice = |k: i32| {
        let cosine = (4.0 * TAU * f64::from(k) / f64::from(n)).cos();
        let s = 2.0 / (1.0 + (1.0 - 0.4 * cosine).sqrt()); // r² of the outline
        s / 4.0 - s * s / 8.0 + cosine * s.powi(3) / 120.0
    };
    Case {
        name: "rounded square",
        section: Section::solid(Outline { vertices: vec![curve.point(0.0)], edges: vec![edge] }),
        aspect: [1.0, 1.0],
        f: |[x, y]| (1.0 - x * x - y * y) / 2.0 + (x.powi(4) - 6.0 * x * x * y * y + y.powi(4)) / 20.0,
        j: 2.0 * TAU / f64::from(n) * (0..n).map(slice).sum::<f64>(),
    }
}

/// Radius of the groove of [`keyway`].
const GROOVE: f64 = 0.3;

/// A shaft of radius 1 with a round groove of radius 0.3 about a point of its surface, the origin.
///
/// C. Weber's solution; Timoshenko and Goodier, Theory of Elasticity, Art. 108: F = (r² − b²)(2·cos t/r − 1)/2.
pub fn keyway() -> Case {
    let x = GROOVE * GROOVE / 2.0;
    let y = (GROOVE * GROOVE - x * x).sqrt();
    let edge = |curve| OutlineEdge { name: String::new(), curve, nodes: None };
    let contour = Outline {
        vertices: vec![[x, -y], [x, y]],
        edges: vec![
            edge(Curve::arc([1.0, 0.0], [x, -y], [x, y], Turn::CounterClockwise)),
            edge(Curve::arc([0.0, 0.0], [x, y], [x, -y], Turn::Clockwise)),
        ],
    };
    Case {
        name: "keyway",
        section: Section::solid(contour),
        aspect: [1.0, 1.0],
        f: |[x, y]| {
            let r2 = x * x + y * y;
            (r2 - GROOVE * GROOVE) * (2.0 * x / r2 - 1.0) / 2.0
        },
        j: f64::NAN, // not compared
    }
}

/// Half a disc of radius 1; Timoshenko and Goodier, Art. 108 (circular sectors): J = π/2 − 4/π.
pub fn semicircle() -> Section {
    let mut contour = Outline::polygon([[-1.0, 0.0], [1.0, 0.0]]);
    contour.edges[1].curve = Curve::arc([0.0, 0.0], [1.0, 0.0], [-1.0, 0.0], Turn::CounterClockwise);
    Section::solid(contour)
}

/// An L with a round and a square hole, `unit` user's units of length for each unit of it, moved by `shift`.
pub fn holed_l(unit: f64, shift: Point) -> Section {
    let at = |p: Point| [unit * (p[0] + shift[0]), unit * (p[1] + shift[1])];
    let contour = [[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];
    Section {
        contour: Outline::polygon(contour.map(at)),
        holes: vec![Outline::circle(at([0.5, 1.3]), 0.2 * unit), Outline::rectangle(at([1.5, 0.3]), at([2.0, 0.7]))],
    }
}

pub fn mesh(section: &Section, params: &CloudParams) -> Mesh {
    let cloud = generate(section, params).expect("a sound section with room for interior nodes");
    cloud.check().expect("every generated cloud passes its own check");
    let mesh = Mesh::constrained(cloud).expect("every generated cloud has a mesh");
    assert_eq!(mesh.check(), Ok(()));
    mesh
}

pub fn params(nodes: [usize; 2], irregularity: f64, seed: u64) -> CloudParams {
    CloudParams { nodes, irregularity, seed, ..CloudParams::default() }
}

/// The solution for Gθ = 1 with default parameters.
pub fn solved(mesh: &Mesh, formulation: Formulation) -> TorsionSolution {
    let params = SolveParams { formulation, ..SolveParams::default() };
    solve(&TorsionProblem::default(), mesh, &params).expect("a sound problem")
}

/// Largest error of F at the nodes.
pub fn error_of_f(mesh: &Mesh, solution: &TorsionSolution, exact: fn(Point) -> f64) -> f64 {
    mesh.xy().iter().zip(&solution.f).map(|(p, f)| (f - exact(*p)).abs()).fold(0.0, f64::max)
}
