//! Time of one evaluation: the graph, the tape (scalar and lanes, per point) and, for two known formulas, the loop
//! somebody would write by hand.
//!
//! The lanes are as wide as the build allows: compare with `RUSTFLAGS="-C target-cpu=native"`.

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use headland_code::suite::{Mix, Random, RandomGraph};
use headland_code::{Evaluator, Function, TapeFunction};
use headland_expr::{Graph, NodeId, Scalar};

/// Points of one `eval_many`.
const POINTS: usize = 64;

/// All ways to evaluate one function; throughput counts operations.
fn every_way(c: &mut Criterion, name: &str, graph: &Graph, outputs: &[NodeId], x: &[f64]) {
    let f = TapeFunction::compile(graph, outputs);
    let operations = f.operations() as u64;
    eprintln!("{name}: {operations} operations, {} instructions, {} slots", f.instructions(), f.slots());
    let mut group = c.benchmark_group(name);
    group.throughput(Throughput::Elements(operations));
    group.bench_function("graph", |b| b.iter(|| graph.eval(outputs, black_box(x))));
    let mut evaluator = f.evaluator();
    group.bench_function("tape", |b| b.iter(|| evaluator.eval(black_box(x))[0]));
    for points in [4, POINTS] {
        let columns: Vec<Vec<f64>> = x.iter().map(|&x| vec![x; points]).collect();
        let columns: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
        group.throughput(Throughput::Elements(operations * points as u64));
        let way = if points == 4 { "lanes4" } else { "lanes8" };
        group.bench_function(way, |b| b.iter(|| evaluator.eval_many(black_box(&columns))[0][0]));
    }
    group.finish();
}

fn random_graphs(c: &mut Criterion) {
    for (mix, mix_name) in [(Mix::Arithmetic, "arithmetic"), (Mix::Smooth, "smooth")] {
        for size in [100, 1000, 10_000] {
            let g = RandomGraph::new(1, mix, 10, size);
            let x = g.near(&mut Random(1));
            every_way(c, &format!("{mix_name}_{size}"), &g.graph, &g.outputs, &x);
        }
    }
}

/// Kinematics of a car with `n` trailers hitched on axle: angles `θ_0 … θ_n` and speed `v`, rates of the angles and
/// of the position.
///
/// ```text
/// θ̇_i = v_(i−1) sin(θ_(i−1) − θ_i) / L_i,   v_i = v_(i−1) cos(θ_(i−1) − θ_i)
/// ```
fn n_trailer<S: Scalar>(theta: &[S], v: S, rates: &mut Vec<S>) {
    rates.clear();
    let mut v = v;
    for (i, pair) in theta.windows(2).enumerate() {
        let (sin, cos) = (pair[0] - pair[1]).sin_cos();
        rates.push(v * sin / S::constant(1.0 + 0.1 * i as f64));
        v = v * cos;
    }
    let (sin, cos) = theta[theta.len() - 1].sin_cos();
    rates.push(v * cos);
    rates.push(v * sin);
}

/// Forces of a chain of springs with a cubic term, ends fixed (Fermi, Pasta, Ulam, Tsingou).
///
/// ```text
/// f_i = s(x_(i+1) − x_i) − s(x_i − x_(i−1)),   s(d) = d + β d³
/// ```
fn spring_chain<S: Scalar>(x: &[S], beta: S, forces: &mut Vec<S>) {
    forces.clear();
    let spring = |d: S| d + beta * d.powi(3);
    let mut left = spring(x[0]);
    for i in 0..x.len() {
        let next = if i + 1 < x.len() { x[i + 1] - x[i] } else { -x[i] };
        let right = spring(next);
        forces.push(right - left);
        left = right;
    }
}

fn known_formulas(c: &mut Criterion) {
    for n in [8, 64] {
        let x: Vec<f64> = (0..n + 1).map(|i| 0.3 * f64::from(i).sin()).chain([1.3]).collect();
        let inputs = x.len();
        type Formula<S> = fn(&[S], S, &mut Vec<S>);
        let formulas: [(&str, Formula<f64>); 2] = [("n_trailer", n_trailer), ("spring_chain", spring_chain)];
        for (name, by_hand) in formulas {
            let graph = Graph::new();
            let e: Vec<_> = (0..inputs).map(|i| graph.input(&format!("x{i}"))).collect();
            let mut y = Vec::new();
            match name {
                "n_trailer" => n_trailer(&e[..inputs - 1], e[inputs - 1], &mut y),
                _ => spring_chain(&e[..inputs - 1], e[inputs - 1], &mut y),
            }
            let outputs: Vec<NodeId> = y.into_iter().map(|e| graph.id(e)).collect();
            let name = format!("{name}_{n}");
            every_way(c, &name, &graph, &outputs, &x);
            let mut y = Vec::with_capacity(inputs);
            let mut group = c.benchmark_group(&name);
            group.throughput(Throughput::Elements(graph.operations(&outputs) as u64));
            group.bench_function("by_hand", |b| {
                b.iter(|| {
                    let x = black_box(x.as_slice());
                    by_hand(&x[..inputs - 1], x[inputs - 1], &mut y);
                    y[0]
                });
            });
            group.finish();
        }
    }
}

fn compiling(c: &mut Criterion) {
    let mut group = c.benchmark_group("compile");
    for size in [1000, 10_000] {
        let g = RandomGraph::new(1, Mix::Smooth, 10, size);
        group.throughput(Throughput::Elements(size as u64));
        group.bench_function(size.to_string(), |b| b.iter(|| TapeFunction::compile(&g.graph, &g.outputs)));
    }
    group.finish();
}

criterion_group!(benches, random_graphs, known_formulas, compiling);
criterion_main!(benches);
