//! The Cartesian pendulum over 100 s: index 1 with projection by CVODE and dop853, the stabilised
//! index-2 form by IDA. What does keeping the constraint cost, in which form?
//!
//! `cargo bench -p headland-solve --features ida --bench pendulum_forms`. The table comes first; `length` and
//! `energy` are the largest drifts of `√(x² + y²)` from 1 and of the energy, relative to `g`.

use std::hint::black_box;
use std::time::Duration;

use criterion::{BenchmarkId, Criterion, criterion_group, criterion_main};
use headland_solve::{DaeProblem, EvalFailure, Ida, Method, OdeProblem, Options, Pattern, Stats, Step};

type Eval = Result<(), EvalFailure>;

const G: f64 = 9.81;
const T_END: f64 = 100.0;

/// `v̇ = −λ q − g e_y` with `λ` from the constraint differentiated twice, and projection.
struct Projected(Pattern);

impl OdeProblem for Projected {
    fn len(&self) -> usize {
        4
    }
    fn rhs(&mut self, _t: f64, s: &[f64], ds: &mut [f64]) -> Eval {
        let [x, y, u, v] = s.try_into().unwrap();
        let lambda = (u * u + v * v - G * y) / (x * x + y * y);
        ds.copy_from_slice(&[u, v, -lambda * x, -lambda * y - G]);
        Ok(())
    }
    fn pattern(&self) -> Option<&Pattern> {
        Some(&self.0)
    }
    fn jacobian(&mut self, _t: f64, s: &[f64], j: &mut [f64]) -> Eval {
        let [x, y, u, v] = s.try_into().unwrap();
        let r2: f64 = x * x + y * y;
        let lambda = (u * u + v * v - G * y) / r2;
        let d = [-2.0 * lambda * x / r2, (-G - 2.0 * lambda * y) / r2, 2.0 * u / r2, 2.0 * v / r2];
        for c in 0..4 {
            j[4 * c] = f64::from(u8::from(c == 2));
            j[4 * c + 1] = f64::from(u8::from(c == 3));
            j[4 * c + 2] = -d[c] * x - if c == 0 { lambda } else { 0.0 };
            j[4 * c + 3] = -d[c] * y - if c == 1 { lambda } else { 0.0 };
        }
        Ok(())
    }
    fn has_projection(&self) -> bool {
        true
    }
    fn project(&mut self, _t: f64, s: &[f64], correction: &mut [f64]) -> Eval {
        let [x, y, u, v] = s.try_into().unwrap();
        let r = f64::hypot(x, y);
        let (a, b) = (x / r, y / r);
        let radial = a * u + b * v;
        correction.copy_from_slice(&[a - x, b - y, -radial * a, -radial * b]);
        Ok(())
    }
}

/// `q̇ = v − q μ, v̇ = −q λ − g e_y, 0 = q·v, 0 = ½ (q·q − 1)`
struct Stabilised(Pattern);

impl DaeProblem for Stabilised {
    fn len(&self) -> usize {
        6
    }
    fn differential(&self) -> &[bool] {
        &[true, true, true, true, false, false]
    }
    fn residual(&mut self, _t: f64, s: &[f64], ds: &[f64], r: &mut [f64]) -> Eval {
        let [x, y, u, v, lambda, mu] = s.try_into().unwrap();
        r[0] = ds[0] - u + x * mu;
        r[1] = ds[1] - v + y * mu;
        r[2] = ds[2] + x * lambda;
        r[3] = ds[3] + y * lambda + G;
        r[4] = x * u + y * v;
        r[5] = 0.5 * (x * x + y * y - 1.0);
        Ok(())
    }
    fn pattern(&self) -> Option<&Pattern> {
        Some(&self.0)
    }
    fn jacobian(&mut self, _t: f64, s: &[f64], _ds: &[f64], c: f64, j: &mut [f64]) -> Eval {
        let [x, y, u, v, lambda, mu] = s.try_into().unwrap();
        let columns = [
            [c + mu, 0.0, lambda, 0.0, u, x],
            [0.0, c + mu, 0.0, lambda, v, y],
            [-1.0, 0.0, c, 0.0, x, 0.0],
            [0.0, -1.0, 0.0, c, y, 0.0],
            [0.0, 0.0, x, y, 0.0, 0.0],
            [x, y, 0.0, 0.0, 0.0, 0.0],
        ];
        j.copy_from_slice(columns.as_flattened());
        Ok(())
    }
}

#[derive(Default)]
struct Drift {
    length: f64,
    energy: f64,
}

impl Drift {
    fn look(&mut self, s: &[f64]) {
        self.length = self.length.max((s[0].hypot(s[1]) - 1.0).abs());
        self.energy = self.energy.max((0.5 * (s[2] * s[2] + s[3] * s[3]) / G + s[1]).abs());
    }
}

fn projected(method: Method, rtol: f64) -> (Drift, Stats) {
    let mut problem = Projected(Pattern::dense(4, 4));
    let mut integrator = method.create(4, Options::new(rtol, vec![1e-2 * rtol; 4])).unwrap();
    integrator.start(&mut problem, 0.0, &[1.0, 0.0, 0.0, 0.0]).unwrap();
    let mut drift = Drift::default();
    while !matches!(integrator.step(&mut problem, T_END).unwrap(), Step::End { .. }) {
        drift.look(integrator.y());
    }
    (drift, *integrator.stats())
}

fn stabilised(rtol: f64) -> (Drift, Stats) {
    let mut problem = Stabilised(Pattern::dense(6, 6));
    let mut options = Options::new(rtol, vec![1e-2 * rtol; 6]);
    options.suppress_algebraic = true;
    let mut ida = Ida::new(6, options).unwrap();
    ida.start(&mut problem, 0.0, &[1.0, 0.0, 0.0, 0.0, 0.0, 0.0], &[0.0, 0.0, 0.0, -G, 0.0, 0.0]).unwrap();
    let mut drift = Drift::default();
    while !matches!(ida.step(&mut problem, T_END).unwrap(), Step::End { .. }) {
        drift.look(ida.y());
    }
    (drift, *ida.stats())
}

fn forms(criterion: &mut Criterion) {
    println!("method       rtol     steps     rhs   length  energy");
    let mut group = criterion.benchmark_group("pendulum forms");
    group.sample_size(20).warm_up_time(Duration::from_millis(200)).measurement_time(Duration::from_millis(800));
    let methods = [("cvode-bdf", Some(Method::CvodeBdf)), ("dop853", Some(Method::Dop853)), ("ida", None)];
    for rtol in [1e-6, 1e-9] {
        for (name, method) in methods {
            let solve = || method.map_or_else(|| stabilised(rtol), |method| projected(method, rtol));
            let (drift, stats) = solve();
            let Drift { length, energy } = drift;
            println!("{name:12} {rtol:.0e} {:8} {:7} {length:.1e} {energy:.1e}", stats.steps, stats.rhs);
            group.bench_function(BenchmarkId::new(name, rtol), |bencher| {
                bencher.iter(|| black_box(solve().1.steps));
            });
        }
    }
    group.finish();
}

criterion_group!(benches, forms);
criterion_main!(benches);
