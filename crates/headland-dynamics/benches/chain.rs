//! Chains of revolute bodies about x, y, z in turn, with offsets and full tensors: time of the recursions (throughput
//! counts bodies, and states for lanes) and the operations of their symbolic form.

use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use headland_code::{Lanes, Lanes4, Lanes8};
use headland_dynamics::tree::{
    JacobianWorkspace, Jacobians, Joint, LaneJacobian, Loads, Tree, Workspace, aba, aba_jacobian, crba, rnea,
};
use headland_expr::{Expr, Graph, Scalar};
use headland_spatial::{Axis, Inertia, Pose, Rotation, Symmetric, Vector};

/// `n` bodies; with `turned`, every joint is mounted with a rotation.
fn chain(n: usize, turned: bool) -> Tree<f64> {
    let mut tree = Tree::new();
    for b in 0..n {
        let k = b as f64;
        let tensor = Symmetric::new(1.0 + 0.1 * k.sin(), 1.2, 0.9, 0.05, -0.03, 0.02);
        let body = Inertia::new(1.5 + 0.3 * k.cos(), Vector([0.1, 0.2, -0.15]), tensor);
        let position = Vector([0.4, 0.1 * (2.0 * k).sin(), -0.2]);
        let joint = Joint::Revolute(Axis::ALL[b % 3]);
        let parent = b.checked_sub(1);
        match turned {
            true => tree.push(parent, Pose::new(Rotation::from_roll_pitch_yaw(0.1, 0.2, 0.3), position), joint, body),
            false => tree.push(parent, position, joint, body),
        };
    }
    tree
}

fn state<S: Scalar>(n: usize, phase: f64) -> Vec<S> {
    (0..n).map(|i| S::constant((i as f64 * 0.7 + phase).sin())).collect()
}

fn accelerations<S: Scalar>(c: &mut Criterion, name: &str, states: u64, turned: bool) {
    let mut group = c.benchmark_group(name);
    for n in [4, 16, 64, 256, 1024] {
        let tree = chain(n, turned).map(S::constant);
        let (q, u, tau): (Vec<S>, Vec<S>, Vec<S>) = (state(n, 0.0), state(n, 1.0), state(n, 2.0));
        let (mut work, mut a) = (Workspace::new(&tree), state(n, 0.0));
        let loads = Loads::gravity(Vector::constant([0.0, 0.0, -9.81]));
        group.throughput(Throughput::Elements(n as u64 * states));
        group.bench_function(BenchmarkId::from_parameter(n), |b| {
            b.iter(|| {
                aba(&tree, black_box(&q), black_box(&u), black_box(&tau), &loads, &mut work, &mut a);
                black_box(a[0])
            });
        });
    }
    group.finish();
}

fn recursions(c: &mut Criterion) {
    accelerations::<f64>(c, "aba", 1, false);
    accelerations::<f64>(c, "aba_turned_mounts", 1, true);
    accelerations::<Lanes4>(c, "aba_x4", Lanes4::WIDTH as u64, false);
    accelerations::<Lanes8>(c, "aba_x8", Lanes8::WIDTH as u64, false);
    let loads = Loads::gravity(Vector([0.0, 0.0, -9.81]));
    for n in [8, 32, 128] {
        let tree = chain(n, false);
        let (q, u, a): (Vec<f64>, Vec<f64>, Vec<f64>) = (state(n, 0.0), state(n, 1.0), state(n, 2.0));
        let (mut work, mut tau, mut m) = (Workspace::new(&tree), vec![0.0; n], vec![0.0; n * (n + 1) / 2]);
        let mut group = c.benchmark_group("others");
        group.throughput(Throughput::Elements(n as u64));
        group.bench_function(BenchmarkId::new("rnea", n), |b| {
            b.iter(|| rnea(&tree, black_box(&q), &u, &a, &loads, &mut work, &mut tau));
        });
        group.bench_function(BenchmarkId::new("crba", n), |b| {
            b.iter(|| crba(&tree, black_box(&q), &mut work, &mut m));
        });
        group.finish();
    }
}

/// All of `∂u̇/∂(q, u, τ)`: by recursion, and by dual numbers.
fn jacobians(c: &mut Criterion) {
    let loads = Loads::gravity(Vector([0.0, 0.0, -9.81]));
    let mut group = c.benchmark_group("jacobian");
    for n in [4, 8, 16, 32] {
        let tree = chain(n, false);
        let (q, u, tau): (Vec<f64>, Vec<f64>, Vec<f64>) = (state(n, 0.0), state(n, 1.0), state(n, 2.0));
        let (mut work, mut a, mut all) = (JacobianWorkspace::new(&tree), q.clone(), Jacobians::new(&tree));
        group.bench_function(BenchmarkId::new("recursion", n), |b| {
            b.iter(|| aba_jacobian(&tree, black_box(&q), &u, &tau, &loads, &mut work, &mut a, &mut all));
        });
        let mut lanes = LaneJacobian::<Lanes8>::new(&tree);
        group.bench_function(BenchmarkId::new("dual_x8", n), |b| {
            b.iter(|| lanes.eval(black_box(&q), &u, &tau, &loads, &mut all));
        });
    }
    group.finish();
}

/// Operations of the symbolic form, printed; not timed.
fn operations(_: &mut Criterion) {
    for n in [4, 8, 16, 32] {
        let count = |turned: bool| {
            let graph = Graph::new();
            let tree = chain(n, turned).map(Expr::constant);
            let inputs = |_: &str| -> Vec<Expr<'_>> { (0..n).map(|_| graph.input("x")).collect() };
            let (q, u, tau) = (inputs("q"), inputs("u"), inputs("tau"));
            let mut a = q.clone();
            let loads = Loads::gravity(Vector([0.0, 0.0, -9.81].map(Expr::Const)));
            aba(&tree, &q, &u, &tau, &loads, &mut Workspace::new(&tree), &mut a);
            graph.operations(&a.into_iter().map(|e| graph.id(e)).collect::<Vec<_>>())
        };
        eprintln!("aba of {n} bodies: {} operations, with turned mounts {}", count(false), count(true));
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(20).measurement_time(std::time::Duration::from_millis(500))
        .warm_up_time(std::time::Duration::from_millis(200));
    targets = operations, recursions, jacobians
}
criterion_main!(benches);
