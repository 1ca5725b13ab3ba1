//! Generation of clouds: `cargo bench -p nmt-cloud --bench cloud`.
//!
//! The section is a U with a 64-gon hole, [0, 4] × [0, 3], the one that the comparisons of docs/performance.md use.

use divan::Bencher;
use divan::counter::ItemsCount;
use nmt_cloud::{Cloud, CloudParams, Grading, Section, generate, quality};
use nmt_curve::{Expression, Outline};
use nmt_geom::Point;

fn main() {
    divan::main();
}

/// The U with a polygon of `sides` sides for a hole.
fn u_with_hole(sides: usize) -> Section {
    let corner = |k: usize| -> Point {
        let t = std::f64::consts::TAU * k as f64 / sides as f64;
        [2.0 + 0.25 * t.cos(), 0.5 + 0.25 * t.sin()]
    };
    let u = [[0.0, 0.0], [4.0, 0.0], [4.0, 3.0], [3.0, 3.0], [3.0, 1.0], [1.0, 1.0], [1.0, 3.0], [0.0, 3.0]];
    Section { contour: Outline::polygon(u), holes: vec![Outline::polygon((0..sides).map(corner))] }
}

/// Densities that leave about `n` nodes of the grid of 12 square units in the 7.8 of the section.
fn params(n: usize, irregularity: f64) -> CloudParams {
    let h = (7.804 / n as f64).sqrt();
    let nodes = [4.0, 3.0].map(|extent| (extent / h).round() as usize + 1);
    CloudParams { nodes, irregularity, ..CloudParams::default() }
}

fn cloud(section: &Section, params: &CloudParams) -> Cloud {
    generate(section, params).expect("a sound section")
}

#[divan::bench(args = [10_000, 100_000, 1_000_000])]
fn regular(bencher: Bencher, n: usize) {
    let (section, params) = (u_with_hole(64), params(n, 0.0));
    bencher.counter(ItemsCount::new(n)).bench_local(|| cloud(&section, &params));
}

#[divan::bench(args = [10_000, 100_000, 1_000_000])]
fn irregular(bencher: Bencher, n: usize) {
    let (section, params) = (u_with_hole(64), params(n, 0.25));
    bencher.counter(ItemsCount::new(n)).bench_local(|| cloud(&section, &params));
}

/// Refined towards both re-entrant corners, where the spacing is 1e-6 and grows by 0.3.
#[divan::bench(args = [10_000, 100_000, 1_000_000])]
fn refined_at_two_corners(bencher: Bencher, n: usize) {
    let grading = Grading::default().near([1.0, 1.0], 1e-6, 0.3).near([3.0, 1.0], 1e-6, 0.3);
    let (section, params) = (u_with_hole(64), CloudParams { grading: Some(grading), ..params(n, 0.25) });
    bencher.counter(ItemsCount::new(n)).bench_local(|| cloud(&section, &params));
}

/// Spacings of a formula, from one to seven.
#[divan::bench(args = [10_000, 100_000, 1_000_000])]
fn graded_by_a_formula(bencher: Bencher, n: usize) {
    let f = Expression::parse("0.0009 + 0.0013*x", &["x", "y"]).expect("a formula");
    let finer = (1.87e6 / n as f64).sqrt();
    let grading = Grading::by(move |p| finer * f.eval(&p));
    let section = u_with_hole(64);
    let params =
        CloudParams { nodes: [201, 151], irregularity: 0.25, grading: Some(grading), ..CloudParams::default() };
    bencher.counter(ItemsCount::new(n)).bench_local(|| cloud(&section, &params));
}

/// 10⁵ refined points, as from an error indicator.
#[divan::bench]
fn refined_at_many_points(bencher: Bencher) {
    let mut grading = Grading::default();
    for k in 0..100_000u32 {
        let t = f64::from(k) * 2.399_963_229_728_653; // the golden angle
        let r = 2.0 * (f64::from(k) / 1e5).sqrt();
        grading = grading.near([2.0 + r * t.cos(), 1.5 + r * t.sin()], 0.001 + 0.002 * r, 0.3);
    }
    let section = u_with_hole(64);
    let params = CloudParams { nodes: [201, 151], grading: Some(grading), ..CloudParams::default() };
    let n = cloud(&section, &params).n_nodes();
    bencher.counter(ItemsCount::new(n)).bench_local(|| cloud(&section, &params));
}

/// 10⁶ nodes, the hole a polygon of so many sides.
#[divan::bench(args = [100, 1_000, 10_000, 100_000])]
fn boundary_segments(bencher: Bencher, sides: usize) {
    let (section, params) = (u_with_hole(sides), params(1_000_000, 0.25));
    bencher.counter(ItemsCount::new(1_000_000usize)).bench_local(|| cloud(&section, &params));
}

/// Separation, fill distance and variation of a finished cloud.
#[divan::bench(args = [10_000, 100_000, 1_000_000])]
fn quality_of_an_irregular_cloud(bencher: Bencher, n: usize) {
    let cloud = cloud(&u_with_hole(64), &params(n, 0.25));
    bencher.counter(ItemsCount::new(n)).bench_local(|| quality(&cloud));
}
