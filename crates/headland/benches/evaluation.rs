//! One right-hand side of the article's train of n bogies: by tape, by lanes, by the graph, and by the loop somebody
//! would write by hand, which is checked to be equal before anything is timed.
//!
//! The lanes are as wide as the build allows: compare with `RUSTFLAGS="-C target-cpu=native"`.

mod train;

use std::hint::black_box;
use std::rc::Rc;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use headland::code::{Evaluator, Function, TapeFunction};
use headland::expr::NodeId;
use headland::sim::Problem;
use headland::solve::OdeProblem;
use headland::{DeriveOptions, System, derive};
use train::{MINIMAL, Train, difference};

/// The hand-written loop and the derived equations agree to this.
const EQUAL: f64 = 1e-12;

fn system(train: &Train) -> Rc<System> {
    let model = train.scene(MINIMAL).build().expect("the scene is right");
    let equations = derive(&model, &DeriveOptions::default()).expect("derives");
    Rc::new(System::new(&model, &equations))
}

fn right_hand_side(c: &mut Criterion) {
    for n in [1, 3, 8, 64, 256] {
        let mut train = Train::new(n);
        let system = system(&train);
        let (t, y) = (2.9, train.in_the_bend());
        let mut problem = Problem::new(system.clone(), false);
        let (mut derived, mut by_hand) = (vec![0.0; y.len()], vec![0.0; y.len()]);
        problem.rhs(t, &y, &mut derived).expect("evaluates");
        train.rhs(t, &y, &mut by_hand).expect("evaluates");
        let error = difference(&derived, &by_hand);
        assert!(error < EQUAL, "n = {n}: the hand-written loop differs by {error:e}");

        // `x = [t, y, u′]`, as the system compiles it.
        let mut x = vec![0.0; system.graph.input_count()];
        x[0] = t;
        x[1..=y.len()].copy_from_slice(&y);
        let roots: Vec<NodeId> = system.roots().to_vec();
        let function = TapeFunction::compile(&system.graph, &roots);
        let mut evaluator = function.evaluator();
        assert_eq!(evaluator.eval(&x), derived, "the tape of the system");
        eprintln!(
            "rhs n = {n}: {} operations, {} instructions, {} slots; by hand equal to {error:.0e}",
            function.operations(),
            function.instructions(),
            function.slots()
        );

        let mut group = c.benchmark_group(format!("rhs_{n}"));
        group.throughput(Throughput::Elements(1));
        group.bench_function("by_hand", |b| b.iter(|| train.rates(black_box(t), black_box(&y), &mut by_hand)));
        group.bench_function("tape", |b| b.iter(|| evaluator.eval(black_box(&x))[0]));
        group.bench_function("tape_in_problem", |b| b.iter(|| problem.rhs(black_box(t), black_box(&y), &mut derived)));
        group.bench_function("graph", |b| b.iter(|| system.graph.eval(&roots, black_box(&x))));
        for (points, way) in [(4, "lanes4"), (8, "lanes8")] {
            let columns: Vec<Vec<f64>> = x.iter().map(|&x| vec![x; points]).collect();
            let columns: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
            group.throughput(Throughput::Elements(points as u64));
            group.bench_function(way, |b| b.iter(|| evaluator.eval_many(black_box(&columns))[0][0]));
        }
        group.finish();
    }
}

fn jacobian(c: &mut Criterion) {
    let mut group = c.benchmark_group("jacobian");
    for n in [1, 3, 8, 64] {
        let train = Train::new(n);
        let mut problem = Problem::new(system(&train), true);
        let (t, y) = (2.9, train.in_the_bend());
        let entries = problem.pattern().expect("it was asked for").nnz();
        let mut values = vec![0.0; entries];
        problem.jacobian(t, &y, &mut values).expect("evaluates");
        eprintln!("jacobian n = {n}: {entries} of {} entries", y.len() * y.len());
        group.throughput(Throughput::Elements(entries as u64));
        group.bench_function(n.to_string(), |b| b.iter(|| problem.jacobian(black_box(t), black_box(&y), &mut values)));
    }
    group.finish();
    let mut group = c.benchmark_group("jacobian_derive_compile");
    group.sample_size(10);
    for n in [3, 8, 64] {
        let train = Train::new(n);
        let fresh = || Problem::new(system(&train), true);
        let made = |problem: Problem| {
            black_box(problem.pattern());
            problem
        };
        group.bench_function(n.to_string(), |b| b.iter_batched(fresh, made, criterion::BatchSize::PerIteration));
    }
    group.finish();
}

criterion_group!(benches, right_hand_side, jacobian);
criterion_main!(benches);
