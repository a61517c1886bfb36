//! Time of the methods on small problems, where their own overhead counts.
//!
//! `cargo bench -p headland-solve`. The first lines are a work-precision table (steps, evaluations,
//! error); the timings follow.

use std::hint::black_box;
use std::time::Duration;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use headland_solve::{EvalFailure, Integrator, Method, OdeProblem, Options, Pattern, Step, method_names};

/// One problem of closed form or known end.
struct Case {
    name: &'static str,
    y0: Vec<f64>,
    t_end: f64,
    expected: Vec<f64>,
    make: fn() -> Box<dyn OdeProblem>,
    methods: fn(Method) -> bool,
}

/// `ẍ_i = −x_i` for each of `n / 2` pairs.
struct Oscillators(usize, Pattern);

impl Oscillators {
    fn new(n: usize) -> Self {
        let entries = (0..n).map(|i| (i, i ^ 1));
        Self(n, Pattern::from_entries(n, n, entries))
    }
}

impl OdeProblem for Oscillators {
    fn len(&self) -> usize {
        self.0
    }
    fn rhs(&mut self, _t: f64, y: &[f64], dy: &mut [f64]) -> Result<(), EvalFailure> {
        for (y, dy) in y.chunks_exact(2).zip(dy.chunks_exact_mut(2)) {
            dy[0] = y[1];
            dy[1] = -y[0];
        }
        Ok(())
    }
    fn pattern(&self) -> Option<&Pattern> {
        Some(&self.1)
    }
    fn jacobian(&mut self, _t: f64, _y: &[f64], values: &mut [f64]) -> Result<(), EvalFailure> {
        for pair in values.chunks_exact_mut(2) {
            pair.copy_from_slice(&[-1.0, 1.0]);
        }
        Ok(())
    }
}

/// Kepler's problem.
struct Kepler;

impl OdeProblem for Kepler {
    fn len(&self) -> usize {
        4
    }
    fn rhs(&mut self, _t: f64, y: &[f64], dy: &mut [f64]) -> Result<(), EvalFailure> {
        let r2 = y[0] * y[0] + y[1] * y[1];
        let r3 = r2 * r2.sqrt();
        dy.copy_from_slice(&[y[2], y[3], -y[0] / r3, -y[1] / r3]);
        Ok(())
    }
}

/// Robertson's reactions.
struct Robertson(Pattern);

impl OdeProblem for Robertson {
    fn len(&self) -> usize {
        3
    }
    fn rhs(&mut self, _t: f64, y: &[f64], dy: &mut [f64]) -> Result<(), EvalFailure> {
        let (a, b, c) = (0.04 * y[0], 3e7 * y[1] * y[1], 1e4 * y[1] * y[2]);
        dy.copy_from_slice(&[-a + c, a - c - b, b]);
        Ok(())
    }
    fn pattern(&self) -> Option<&Pattern> {
        Some(&self.0)
    }
    fn jacobian(&mut self, _t: f64, y: &[f64], values: &mut [f64]) -> Result<(), EvalFailure> {
        let (b, c, d) = (6e7 * y[1], 1e4 * y[2], 1e4 * y[1]);
        values.copy_from_slice(&[-0.04, 0.04, 0.0, c, -c - b, b, d, -d, 0.0]);
        Ok(())
    }
}

fn cases() -> Vec<Case> {
    let turn = 2.0 * std::f64::consts::PI;
    let pairs = |n: usize| [1.0, 0.0].repeat(n / 2);
    let orbit = vec![0.5, 0.0, 0.0, 3f64.sqrt()];
    vec![
        Case {
            name: "oscillator 2",
            y0: pairs(2),
            t_end: 10.0 * turn,
            expected: pairs(2),
            make: || Box::new(Oscillators::new(2)),
            methods: |_| true,
        },
        Case {
            name: "oscillators 40",
            y0: pairs(40),
            t_end: 10.0 * turn,
            expected: pairs(40),
            make: || Box::new(Oscillators::new(40)),
            methods: |_| true,
        },
        Case {
            name: "kepler 0.5",
            y0: orbit.clone(),
            t_end: 10.0 * turn,
            expected: orbit,
            make: || Box::new(Kepler),
            methods: |_| true,
        },
        Case {
            name: "robertson",
            y0: vec![1.0, 0.0, 0.0],
            t_end: 1e11,
            expected: vec![0.2083340149701255e-7, 0.8333360770334713e-13, 0.999999979166505],
            make: || Box::new(Robertson(Pattern::dense(3, 3))),
            methods: Method::is_implicit,
        },
    ]
}

/// From the start to the end; returns the integrator for its state and counts.
fn solve(case: &Case, method: Method, rtol: f64) -> Box<dyn Integrator> {
    let n = case.y0.len();
    let mut problem = (case.make)();
    let options = Options::new(rtol, vec![1e-2 * rtol; n]);
    let mut integrator = method.create(n, options).unwrap();
    integrator.start(&mut *problem, 0.0, &case.y0).unwrap();
    while !matches!(integrator.step(&mut *problem, case.t_end).unwrap(), Step::End { .. }) {}
    integrator
}

fn solvers(criterion: &mut Criterion) {
    println!("problem          method       rtol     steps     rhs   error");
    for case in cases() {
        let mut group = criterion.benchmark_group(case.name);
        group.sample_size(20).warm_up_time(Duration::from_millis(200)).measurement_time(Duration::from_millis(800));
        for name in method_names() {
            let method = Method::parse(name).unwrap();
            if method.is_dae() || !(case.methods)(method) {
                continue;
            }
            for rtol in [1e-6, 1e-10] {
                let done = solve(&case, method, rtol);
                let errors = done.y().iter().zip(&case.expected);
                let error = errors.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                println!(
                    "{:16} {name:12} {rtol:.0e} {:8} {:7} {error:.1e}",
                    case.name,
                    done.stats().steps,
                    done.stats().rhs
                );
                group.bench_function(BenchmarkId::new(name, rtol), |bencher| {
                    bencher.iter(|| black_box(solve(&case, method, rtol).y()[0]));
                });
            }
        }
        group.finish();
    }
}

criterion_group!(benches, solvers);
criterion_main!(benches);
