//! From a scene file to compiled equations, stage by stage, for the article's train of n bogies.
//!
//! Each derivation starts from a fresh model: a graph that has been derived in holds the equations already.

mod train;

use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};
use headland::{DeriveOptions, System, derive};
use train::{CARTESIAN, MINIMAL, Train};

fn stages(c: &mut Criterion, name: &str, text: &str, sizes: &[usize]) {
    for &n in sizes {
        let train = Train::new(n);
        let scene = train.scene(text);
        let fresh = || scene.build().expect("the scene is right");
        let options = DeriveOptions { compare: false, ..DeriveOptions::default() };
        let model = fresh();
        let nodes = model.graph.len();
        let equations = derive(&model, &options).expect("derives");
        let derived = model.graph.len();
        let system = System::new(&model, &equations);
        eprintln!(
            "{name} n = {n}: {nodes} nodes built, {derived} derived; {} operations a right-hand side by {}",
            system.operations(),
            equations.algorithm
        );
        let mut group = c.benchmark_group(format!("{name}_{n}"));
        group.throughput(Throughput::Elements(n as u64));
        group.sample_size(if n > 64 { 10 } else { 30 });
        group.bench_function("parse_build", |b| b.iter(|| train.scene(text).build()));
        group.bench_function("derive", |b| {
            let derived = |model| {
                let equations = derive(&model, &options);
                (model, equations)
            };
            b.iter_batched(fresh, derived, BatchSize::PerIteration);
        });
        group.bench_function("compile", |b| b.iter(|| System::new(&model, &equations)));
        group.finish();
    }
}

fn derivation(c: &mut Criterion) {
    stages(c, "train", MINIMAL, &[1, 3, 8, 64, 256]);
    stages(c, "cartesian", CARTESIAN, &[3, 8]);
}

criterion_group!(benches, derivation);
criterion_main!(benches);
