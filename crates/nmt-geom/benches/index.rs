//! Look-ups among the segments of a boundary: `cargo bench -p nmt-geom --bench index`.

use divan::Bencher;
use divan::counter::ItemsCount;
use nmt_geom::{Point, Region, SegmentIndex};

fn main() {
    divan::main();
}

const SIZES: [usize; 3] = [100, 10_000, 100_000];

/// A wavy ring of `n` sides about a hole of as many.
fn ring(n: usize) -> Region {
    let corner = |k: usize, radius: f64| -> Point {
        let t = std::f64::consts::TAU * k as f64 / n as f64;
        let r = radius * (1.0 + 0.1 * (7.0 * t).sin());
        [r * t.cos(), r * t.sin()]
    };
    Region { contour: (0..n).map(|k| corner(k, 1.0)).collect(), holes: vec![(0..n).map(|k| corner(k, 0.4)).collect()] }
}

/// Places all over the envelope.
fn places() -> Vec<Point> {
    (0..10_000).map(|k| [f64::from(k % 100) / 45.0 - 1.1, f64::from(k / 100) / 45.0 - 1.1]).collect()
}

#[divan::bench(args = SIZES)]
fn build(bencher: Bencher, n: usize) {
    let region = ring(n);
    bencher.counter(ItemsCount::new(2 * n)).bench(|| region.segment_index());
}

#[divan::bench(args = SIZES)]
fn faults(bencher: Bencher, n: usize) {
    let region = ring(n);
    bencher.counter(ItemsCount::new(2 * n)).bench(|| region.faults(1e-9).len());
}

#[divan::bench(args = SIZES)]
fn locate(bencher: Bencher, n: usize) {
    let (index, places) = (ring(n).segment_index(), places());
    bencher
        .counter(ItemsCount::new(places.len()))
        .bench(|| places.iter().map(|p| index.locate(*p) as usize).sum::<usize>());
}

#[divan::bench(args = SIZES)]
fn any_within(bencher: Bencher, n: usize) {
    let (index, places) = (ring(n).segment_index(), places());
    let count = |index: &SegmentIndex| places.iter().filter(|p| index.any_within(**p, 0.01)).count();
    bencher.counter(ItemsCount::new(places.len())).bench(|| count(&index));
}
