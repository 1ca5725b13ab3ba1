//! Time of a mesh by way of the lattice and by the general way: `cargo bench -p nmt-tri`.
//!
//! A U of 4 × 3 with a hole of 64 corners, h_x = h_y, about as many nodes as the argument says.

use divan::Bencher;
use divan::counter::ItemsCount;
use nmt_cloud::{Cloud, CloudParams, Section, generate};
use nmt_curve::Outline;
use nmt_tri::Mesh;
use std::f64::consts::TAU;

/// Number of nodes, and irregularity: none, the most before a first flip inside, the most there can be.
const CLOUDS: [(usize, f64); 9] = [
    (10_000, 0.0),
    (10_000, 0.25),
    (10_000, 0.49),
    (100_000, 0.0),
    (100_000, 0.25),
    (100_000, 0.49),
    (1_000_000, 0.0),
    (1_000_000, 0.25),
    (1_000_000, 0.49),
];

/// Area of the U without its hole.
const AREA: f64 = 7.804;

fn cloud(n_nodes: usize, irregularity: f64) -> Cloud {
    let corner = |k: u32| {
        let t = TAU * f64::from(k) / 64.0;
        [2.0 + 0.25 * t.cos(), 0.5 + 0.25 * t.sin()]
    };
    let u = [[0.0, 0.0], [4.0, 0.0], [4.0, 3.0], [3.0, 3.0], [3.0, 1.0], [1.0, 1.0], [1.0, 3.0], [0.0, 3.0]];
    let section = Section { contour: Outline::polygon(u), holes: vec![Outline::polygon((0..64).map(corner))] };
    let per_length = (n_nodes as f64 / AREA).sqrt().round() as usize;
    let nodes = [4 * per_length + 1, 3 * per_length + 1];
    generate(&section, &CloudParams { nodes, irregularity, ..CloudParams::default() }).expect("a sound section")
}

fn time(bencher: Bencher, n_nodes: usize, irregularity: f64, mesh: impl Fn(Cloud) -> Option<Mesh> + Sync) {
    let cloud = cloud(n_nodes, irregularity);
    let bencher = bencher.counter(ItemsCount::new(cloud.n_nodes()));
    bencher.with_inputs(|| cloud.clone()).bench_values(|cloud| mesh(cloud).expect("a mesh"));
}

#[divan::bench(args = CLOUDS, max_time = 2)]
fn by_lattice(bencher: Bencher, (n_nodes, irregularity): (usize, f64)) {
    time(bencher, n_nodes, irregularity, Mesh::constrained_on_lattice);
}

#[divan::bench(args = CLOUDS, max_time = 2)]
fn general(bencher: Bencher, (n_nodes, irregularity): (usize, f64)) {
    time(bencher, n_nodes, irregularity, |cloud| Mesh::constrained_general(cloud).ok());
}

fn main() {
    divan::main();
}
