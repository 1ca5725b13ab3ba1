//! Observed orders of every formulation on known solutions of ∇²u = f, fitted and asserted; with a directory as argument
//! it writes a picture of each case there.

use nmt::cloud::{CloudParams, Section, generate};
use nmt::curve::Outline;
use nmt::mfdm::{Formulation, PoissonProblem, SolveParams, solve_poisson};
use nmt::plot::{Caption, ErrorSeries, errors_figure, png};
use nmt::tri::Mesh;
use std::f64::consts::PI;
use std::path::Path;

type Point = [f64; 2];
type Field = fn(Point) -> f64;

/// A section, refined with the spacing h, and a known solution on it.
struct Case {
    name: &'static str,
    title: &'static str,
    section: fn(f64) -> Section,
    u: Field,
    gradient: fn(Point) -> Point,
    laplacian: Field,
    /// The edges with a flux; the others have their value.
    fluxes: &'static [usize],
}

const CASES: [Case; 3] = [
    Case {
        name: "orders-square",
        title: "u = sin πx sin πy on a square",
        section: |_| Section::solid(Outline::rectangle([0.0, 0.0], [1.0, 1.0])),
        u: |[x, y]| (PI * x).sin() * (PI * y).sin(),
        gradient: |[x, y]| [PI * (PI * x).cos() * (PI * y).sin(), PI * (PI * x).sin() * (PI * y).cos()],
        laplacian: |[x, y]| -2.0 * PI * PI * (PI * x).sin() * (PI * y).sin(),
        fluxes: &[],
    },
    Case {
        name: "orders-hole",
        title: "A hole of two spacings’ radius: flux given on it and on one side",
        section: |h| Section {
            contour: Outline::rectangle([0.0, 0.0], [1.0, 1.0]),
            holes: vec![Outline::circle(CENTRE, 2.0 * h)],
        },
        u: |[x, y]| x.exp() * y.cos() + x * x - 0.5 * y * y,
        gradient: |[x, y]| [x.exp() * y.cos() + 2.0 * x, -x.exp() * y.sin() - y],
        laplacian: |_| 1.0,
        fluxes: &[1, 4],
    },
    Case {
        name: "orders-ellipse",
        title: "u = sin 3x cos 2y on an ellipse",
        section: |_| Section::solid(Outline::ellipse([0.0, 0.0], [1.0, 0.6], 0.3)),
        u: |[x, y]| (3.0 * x).sin() * (2.0 * y).cos(),
        gradient: |[x, y]| [3.0 * (3.0 * x).cos() * (2.0 * y).cos(), -2.0 * (3.0 * x).sin() * (2.0 * y).sin()],
        laplacian: |[x, y]| -13.0 * (3.0 * x).sin() * (2.0 * y).cos(),
        fluxes: &[],
    },
];

/// Centre of the small hole, off the lines of the grid.
const CENTRE: Point = [0.437, 0.561];

/// Formulation, order, and the least slope that is promised for smooth solutions.
const METHODS: [(Formulation, usize, f64); 7] = [
    (Formulation::Fem, 1, 1.7),
    (Formulation::Variational, 1, 1.6),
    (Formulation::Variational, 2, 1.8),
    (Formulation::Variational, 3, 2.8),
    (Formulation::Variational, 4, 3.5),
    (Formulation::Local, 2, 1.8),
    (Formulation::Local, 4, 3.5),
];

/// Of the irregular clouds.
const SEEDS: [u64; 3] = [1, 2, 3];

/// Grid lines across.
const NODES: [usize; 4] = [11, 21, 41, 81];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let target = std::env::args().nth(1);
    for case in &CASES {
        println!("{}", case.title);
        let mut lines = Vec::new();
        for (formulation, order, least) in METHODS {
            let points = NODES.iter().map(|&n| case.mean_error(n, formulation, order));
            let points = points.collect::<Result<Vec<_>, _>>()?;
            let by_spacing = NODES.iter().zip(&points).map(|(n, p)| [1.0 / (n - 1) as f64, p[1]]);
            let slope = fitted_slope(&by_spacing.collect::<Vec<_>>());
            println!(
                "  {:11} {order}: error {:.1e} … {:.1e}, order {slope:.2}",
                formulation.name(),
                points[0][1],
                points[3][1]
            );
            assert!(slope > least, "{}: order {least} is promised, {slope} observed", formulation.name());
            lines.push((format!("{} {order}: observed {slope:.1}", formulation.name()), points, formulation, order));
        }
        if let Some(directory) = &target {
            let series = lines.iter().map(|(name, points, formulation, order)| {
                let family = Formulation::ALL.iter().rev().position(|f| f == formulation).unwrap_or(0);
                ErrorSeries { name, points, family, order: *order }
            });
            let caption = Caption { title: case.title, units: "" };
            let svg =
                errors_figure(&caption, "unknowns", "largest error at nodes, relative", &series.collect::<Vec<_>>());
            std::fs::write(Path::new(directory).join(format!("{}.png", case.name)), png(&svg)?)?;
        }
    }
    Ok(())
}

impl Case {
    /// Unknowns and errors, geometric means over irregular clouds.
    fn mean_error(
        &self,
        n: usize,
        formulation: Formulation,
        order: usize,
    ) -> Result<Point, Box<dyn std::error::Error>> {
        let mut logs = [0.0; 2];
        for seed in SEEDS {
            let found = self.error(n, seed, formulation, order)?;
            logs = [0, 1].map(|k| logs[k] + found[k].ln() / SEEDS.len() as f64);
        }
        Ok(logs.map(f64::exp))
    }

    /// Unknowns, and the largest error at nodes relative to the largest value.
    fn error(
        &self,
        n: usize,
        seed: u64,
        formulation: Formulation,
        order: usize,
    ) -> Result<Point, Box<dyn std::error::Error>> {
        let section = (self.section)(1.0 / (n - 1) as f64);
        let cloud = CloudParams { nodes: [n, n], irregularity: 0.25, seed, ..CloudParams::default() };
        let mesh = Mesh::constrained(generate(&section, &cloud)?)?;
        let of_edge = |edge: usize| {
            move |p: Point| {
                let (normal, gradient) = (normal(edge, p), (self.gradient)(p));
                normal[0] * gradient[0] + normal[1] * gradient[1]
            }
        };
        let all = [0, 1, 2, 3, 4].map(of_edge);
        let fluxes = (0..section.n_edges())
            .map(|edge| self.fluxes.contains(&edge).then_some(&all[edge] as &(dyn Fn(Point) -> f64 + Sync)))
            .collect();
        let problem = PoissonProblem { source: &self.laplacian, boundary: &self.u, fluxes, section: &section };
        let order = if formulation == Formulation::Fem { 2 } else { order };
        let solution = solve_poisson(&problem, &mesh, &SolveParams { formulation, order, ..SolveParams::default() })?;
        let norms = solution.errors(&mesh, self.u);
        Ok([solution.unknowns as f64, norms.max / norms.scale])
    }
}

/// Normal of the unit square's sides and of the hole, out of the material.
fn normal(edge: usize, p: Point) -> Point {
    match edge {
        0 => [0.0, -1.0],
        1 => [1.0, 0.0],
        2 => [0.0, 1.0],
        3 => [-1.0, 0.0],
        _ => {
            let inwards = [CENTRE[0] - p[0], CENTRE[1] - p[1]];
            inwards.map(|c| c / inwards[0].hypot(inwards[1]))
        }
    }
}

/// Slope of log y over log x by least squares.
fn fitted_slope(points: &[Point]) -> f64 {
    let logs: Vec<Point> = points.iter().map(|p| p.map(f64::ln)).collect();
    let mean = [0, 1].map(|d| logs.iter().map(|p| p[d]).sum::<f64>() / logs.len() as f64);
    let (xy, xx) = logs.iter().fold((0.0, 0.0), |(xy, xx), p| {
        let d = [p[0] - mean[0], p[1] - mean[1]];
        (xy + d[0] * d[1], xx + d[0] * d[0])
    });
    xy / xx
}
