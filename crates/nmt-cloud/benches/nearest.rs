//! The k nearest nodes: `cargo bench -p nmt-cloud --bench nearest`.
//!
//! Every node of a cloud asks for its nine nearest. The graded cloud's spacing grows 1000-fold from its corner.

use divan::Bencher;
use divan::counter::ItemsCount;
use nmt_cloud::{Displacements, Nearest, Scratch};
use nmt_geom::Point;

fn main() {
    divan::main();
}

/// n nodes on [0, 1]², a lattice displaced by 0.3 spacings.
fn even(n: usize) -> Vec<Point> {
    let side = (n as f64).sqrt() as usize;
    let h = 1.0 / side as f64;
    let mut random = Displacements::new(1);
    let mut place = |k: usize| {
        let [r, s] = random.draw(k, 0);
        [((k % side) as f64 + 0.5 + 0.3 * r) * h, ((k / side) as f64 + 0.5 + 0.3 * s) * h]
    };
    (0..side * side).map(&mut place).collect()
}

/// The same, pulled towards the corner at the origin: spacing is proportional to the distance from it, 1 : 1000.
fn graded(n: usize) -> Vec<Point> {
    let smallest = 1e-3_f64;
    let pull = |v: f64| (smallest.ln() * (1.0 - v)).exp();
    even(n).into_iter().map(|p| [pull(p[0]) * p[1].cos(), pull(p[0]) * p[1].sin()]).collect()
}

fn all_nearest(bencher: Bencher, xy: &[Point]) {
    let nearest = Nearest::new(xy);
    bencher.counter(ItemsCount::new(xy.len())).bench_local(|| {
        let (mut scratch, mut out, mut sum) = (Scratch::default(), Vec::new(), 0u64);
        for p in xy {
            nearest.nearest_of_all(*p, 9, &mut scratch, &mut out);
            sum += u64::from(out[8].0);
        }
        sum
    });
}

#[divan::bench(args = [10_000, 100_000, 1_000_000])]
fn nine_of_an_even_cloud(bencher: Bencher, n: usize) {
    all_nearest(bencher, &even(n));
}

#[divan::bench(args = [10_000, 100_000, 1_000_000])]
fn nine_of_a_graded_cloud(bencher: Bencher, n: usize) {
    all_nearest(bencher, &graded(n));
}

#[divan::bench(args = [10_000, 100_000, 1_000_000])]
fn index(bencher: Bencher, n: usize) {
    let xy = even(n);
    bencher.counter(ItemsCount::new(n)).bench_local(|| Nearest::new(&xy));
}
