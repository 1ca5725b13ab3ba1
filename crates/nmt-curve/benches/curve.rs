//! Formulas, lengths and divisions: `cargo bench -p nmt-curve --bench curve`.

use divan::Bencher;
use divan::counter::ItemsCount;
use nmt_curve::{ArcLengthParams, Curve, Expression, arc_length, divide, divide_by_chords};

fn main() {
    divan::main();
}

const CURVES: [&str; 3] = ["wave", "half a circle", "ellipse"];

fn graph(text: &str, from_x: f64, to_x: f64) -> Curve {
    Curve::Graph { y: Expression::parse(text, &["x"]).expect("a formula"), from_x, to_x }
}

fn curve(name: &str) -> Curve {
    match name {
        "wave" => graph("0.25*sin(2*pi*x)", 0.0, 2.0),
        "half a circle" => graph("sqrt(1 - x^2)", -1.0, 1.0),
        _ => Curve::Ellipse { centre: [0.0, 0.0], semi_axes: [2.0, 1.0], rotation: 0.3 },
    }
}

#[divan::bench(args = ["x", "0.25*sin(2*pi*x)", "1/(1 + 25*x^2)"])]
fn value(bencher: Bencher, text: &str) {
    let f = Expression::parse(text, &["x"]).expect("a formula");
    let xs: Vec<f64> = (0..1000).map(|k| f64::from(k) * 1e-3).collect();
    bencher.counter(ItemsCount::new(xs.len())).bench(|| xs.iter().map(|x| f.at(*x)).sum::<f64>());
}

#[divan::bench(args = ["x", "0.25*sin(2*pi*x)", "1/(1 + 25*x^2)"])]
fn value_and_two_derivatives(bencher: Bencher, text: &str) {
    let f = Expression::parse(text, &["x"]).expect("a formula");
    let xs: Vec<f64> = (0..1000).map(|k| f64::from(k) * 1e-3).collect();
    bencher.counter(ItemsCount::new(xs.len())).bench(|| xs.iter().map(|x| f.jet(*x).d2).sum::<f64>());
}

#[divan::bench(args = CURVES)]
fn length(bencher: Bencher, name: &str) {
    let curve = curve(name);
    bencher.bench(|| arc_length(&curve, &ArcLengthParams::default()));
}

#[divan::bench(args = CURVES, consts = [100, 100_000])]
fn equal_arcs<const N: usize>(bencher: Bencher, name: &str) {
    let curve = curve(name);
    bencher.counter(ItemsCount::new(N)).bench(|| divide(&curve, N));
}

#[divan::bench(args = CURVES, consts = [100, 10_000])]
fn equal_chords<const N: usize>(bencher: Bencher, name: &str) {
    let curve = curve(name);
    bencher.counter(ItemsCount::new(N)).bench(|| divide_by_chords(&curve, N));
}
