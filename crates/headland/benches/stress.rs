//! What strains the numbers: long chains, extreme ratios of masses, nearly singular mass matrices, a long run. Each row
//! prints its error before its time: against closed forms and quad precision where there are such, else the drift of the
//! energy and the difference to a run at 1e-13.

use std::time::Duration;

use criterion::{Criterion, criterion_group, criterion_main};
use headland::{Model, Run, RunOptions, Scene, Silent, run};
use serde_json::Value;

fn build(text: &str, settings: &[(&str, &str)]) -> Model {
    let mut scene = Scene::parse("stress", text).expect("reads");
    settings.iter().for_each(|(name, value)| scene.set(name, value).expect("is set"));
    scene.build().unwrap_or_else(|e| panic!("{e}"))
}

fn options(model: &Model, until: f64, tolerance: f64) -> RunOptions {
    let mut options = RunOptions::of(model);
    (options.until, options.tolerance, options.points, options.balance) = (until, tolerance, 50, false);
    options
}

fn result(model: &Model, options: &RunOptions) -> Run {
    run(model, options, &mut Silent).expect("starts")
}

/// Prints what `errors` finds in the run's result, then times the integration.
fn row(c: &mut Criterion, name: &str, model: &Model, options: &RunOptions, errors: impl Fn(&Run) -> String) {
    let first = result(model, options);
    let r = &first.report;
    eprintln!("stress/{name}: {} steps, {} right-hand sides, {}", r.steps, r.rhs, errors(&first));
    let mut group = c.benchmark_group("stress");
    group.sample_size(10).warm_up_time(Duration::from_millis(300)).measurement_time(Duration::from_secs(1));
    group.bench_function(name, |b| {
        b.iter_custom(|iterations| {
            let options = RunOptions { repeat: iterations as usize, ..options.clone() };
            let report = result(model, &options).report;
            Duration::from_secs_f64(report.run_s_median.unwrap_or(report.run_s)) * iterations as u32
        });
    });
    group.finish();
}

/// A chain of `n` links stretched out level, hinges in turn about y and z, at rest; masses from `mass`.
fn chain(n: usize, mass: impl Fn(usize) -> f64) -> String {
    let mut s = String::from("[world]\ngravity = [0, 0, -9.81]\n");
    for k in 1..=n {
        let (m, axis) = (mass(k), ["y", "z"][(k - 1) % 2]);
        s += &format!("[[body]]\nname = \"b{k}\"\nmass = {m:e}\ncenter = [0.5, 0, 0]\n");
        s += &format!("inertia = [{:e}, {:e}, {:e}]\n", 0.01 * m, 0.09 * m, 0.09 * m);
        s += &format!("[[joint]]\nname = \"q{k}\"\nkind = \"revolute\"\naxis = \"{axis}\"\nto = \"b{k}\"\n");
        if k > 1 {
            s += &format!("from = \"b{}\"\nat = [1, 0, 0]\n", k - 1);
        }
    }
    s += "[initial]\n";
    (1..=n).for_each(|k| s += &format!("q{k} = {}\n", 0.02 * (k as f64).sin()));
    let end = format!("\"b{n}.x\", \"b{n}.y\", \"b{n}.z\"");
    s + &format!("[outputs]\ncolumns = [\"system.kinetic_energy\", \"system.potential_energy\", {end}]\n")
}

/// Drift of the energy relative to the largest kinetic energy, and the largest difference of the end's place.
fn drift_and_place(found: &Run, fine: &Run) -> String {
    let rows = &found.trajectory.rows;
    let largest = rows.iter().map(|r| r[0]).fold(0.0, f64::max);
    let drift = rows.iter().map(|r| (r[0] + r[1] - rows[0][0] - rows[0][1]).abs()).fold(0.0, f64::max) / largest;
    let pairs = rows.iter().zip(&fine.trajectory.rows);
    let place = pairs.flat_map(|(a, b)| (2..5).map(|i| (a[i] - b[i]).abs())).fold(0.0, f64::max);
    format!("energy {drift:.1e}, end {place:.1e} m")
}

fn chains(c: &mut Criterion) {
    for n in [10, 30, 100, 300] {
        let model = build(&chain(n, |_| 1.0), &[]);
        let fine = result(&model, &options(&model, 0.5, 1e-13));
        let name = format!("chain of {n}, 0.5 s");
        row(c, &name, &model, &options(&model, 0.5, 1e-10), |r| drift_and_place(r, &fine));
    }
    for (ratio, odd) in [(1e-6, 3), (1e-6, 6), (1e6, 3), (1e6, 6)] {
        let model = build(&chain(6, |k| if k == odd { ratio } else { 1.0 }), &[]);
        let fine = result(&model, &options(&model, 2.0, 1e-13));
        let name = format!("6 links, {ratio:e} kg at {odd}, 2 s");
        row(c, &name, &model, &options(&model, 2.0, 1e-10), |r| drift_and_place(r, &fine));
    }
}

/// Point masses on rods, against quad precision.
fn point_chains(c: &mut Criterion) {
    let file: Value = serde_json::from_str(include_str!("../../../validation/reference/stress.json")).expect("JSON");
    let number = |v: &Value| v.as_str().and_then(|s| s.parse::<f64>().ok()).expect("a number");
    let scene = include_str!("../../../validation/scenes/point_chain.toml");
    let ones = format!("[{}]", ["1"; 10].join(", "));
    for (name, pointer, masses, n, t) in [
        ("10 equal points, 3 s", "/chain_point_masses/N10/3", ones.as_str(), 10, 3.0),
        ("1 kg then 1e6 kg, 5 s", "/mass_ratio_1e6_heavy_end/values/5", "[1, 1e6]", 2, 5.0),
        ("1 kg then 1e6 kg, 2 s", "/mass_ratio_1e6_heavy_end/values/2", "[1, 1e6]", 2, 2.0),
    ] {
        let model = build(scene, &[("m", masses)]);
        let at = file.pointer(pointer).expect("is there");
        let options = RunOptions { at: Some(vec![t]), ..options(&model, t, 1e-10) };
        row(c, name, &model, &options, |r| {
            let last = &r.trajectory.rows[0];
            let error = (last[n - 1] - number(&at["x"])).abs().max((last[2 * n - 1] - number(&at["y"])).abs());
            format!("end {error:.1e} m")
        });
    }
}

/// A needle driven about its own axis on an arm that turns: both turn as if alone.
fn needles(c: &mut Criterion) {
    for inertia in [1e-6, 1e-9, 1e-12, 1e-15] {
        let text = format!(
            "[[body]]\nname = \"arm\"\nmass = 1\ncenter = [0.5, 0, 0]\ninertia = [0.1, 0.2, 0.25]\n\
             [[body]]\nname = \"needle\"\nmass = 1e-3\ninertia = [{inertia:e}, 1e-6, 1e-6]\n\
             [[joint]]\nname = \"a\"\nkind = \"revolute\"\nto = \"arm\"\n\
             [[joint]]\nname = \"s\"\nkind = \"revolute\"\naxis = \"x\"\nfrom = \"arm\"\nat = [1, 0, 0]\nto = \"needle\"\n\
             [[force]]\nname = \"twist\"\nvalue = \"{:e}[N*m]\"\ngeometric = \"s\"\n\
             [initial]\n\"a'\" = 3\n[outputs]\ncolumns = [\"a\", \"s\"]\n",
            2.0 * inertia
        );
        let model = build(&text, &[]);
        row(c, &format!("needle of {inertia:e} kg m^2"), &model, &options(&model, 2.0, 1e-10), |r| {
            let last = r.trajectory.rows.last().expect("rows");
            format!("angles {:.1e}", (last[0] - 6.0).abs().max((last[1] - 4.0).abs()))
        });
    }
}

/// `sn, cn, dn` of u by the complementary parameter `1 − k²` (Bulirsch, *Numerical calculation of elliptic integrals and
/// elliptic functions*, Numer. Math. 7, 1965).
fn jacobi(u: f64, complement: f64) -> [f64; 3] {
    let (mut a, mut c, mut means) = (1.0, complement.sqrt(), Vec::new());
    while means.len() < 40 {
        means.push((a, c));
        let mean = 0.5 * (a + c);
        if (a - c).abs() <= 1e-9 * a {
            a = mean;
            break;
        }
        c = (a * c).sqrt();
        a = mean;
    }
    let last = a;
    let (mut sn, cn) = (last * u).sin_cos();
    if sn == 0.0 {
        return [0.0, cn, 1.0];
    }
    let (mut a, mut dn) = (cn / sn, 1.0);
    let mut c = a * last;
    for &(m, n) in means.iter().rev() {
        a *= c;
        c *= dn;
        dn = (n + a) / (m + a);
        a = c / m;
    }
    let size = 1.0 / (c * c + 1.0).sqrt();
    sn = if sn < 0.0 { -size } else { size };
    [sn, c * sn, dn]
}

/// A body that turns about its middle axis flips over and over: 146 times in 1000 s, against Euler's solution.
fn free_body(c: &mut Criterion) {
    let text = "[[body]]\nname = \"b\"\nmass = 1\ninertia = [1, 2, 3]\n[initial]\n\"b.wx\" = 0.001\n\"b.wy\" = 5\n\
                [outputs]\ncolumns = [\"b.wx\", \"b.wy\", \"b.wz\", \"system.lx\", \"system.ly\", \"system.lz\"]\n";
    let model = build(text, &[]);
    let (j, e, w) = ([1.0, 2.0, 3.0], 1e-3_f64, 5.0_f64);
    let fast = e * e * j[0] * (j[2] - j[0]) + w * w * j[1] * (j[2] - j[1]); // 2 T J₃ − L²
    let complement = e * e * j[0] * (j[2] - j[0]) / fast;
    let rate = ((j[1] - j[0]) * fast / (j[0] * j[1] * j[2])).sqrt();
    let third = w * (j[1] * (j[1] - j[0]) / (j[2] * (j[2] - j[0]))).sqrt();
    // a quarter of a period from where cn = 1: sn(u + K) = cn/dn, cn(u + K) = −k′ sn/dn, dn(u + K) = k′/dn
    let spin = |t: f64| {
        let [sn, cn, dn] = jacobi(rate * t, complement);
        [e / dn, w * cn / dn, -third * complement.sqrt() * sn / dn]
    };
    for tolerance in [1e-8, 1e-10, 1e-12] {
        let name = format!("middle axis, 1000 s, {tolerance:e}");
        row(c, &name, &model, &options(&model, 1000.0, tolerance), |r| {
            let rows = r.trajectory.t.iter().zip(&r.trajectory.rows);
            let of_spin = |(t, row): (&f64, &Vec<f64>)| {
                let exact = spin(*t);
                (0..3).map(|i| (row[i] - exact[i]).abs()).fold(0.0, f64::max)
            };
            let momentum =
                |row: &Vec<f64>| (0..3).map(|i| (row[3 + i] - [j[0] * e, j[1] * w, 0.0][i]).abs()).fold(0.0, f64::max);
            let of_momentum = r.trajectory.rows.iter().map(momentum).fold(0.0, f64::max);
            format!("spin {:.1e} 1/s, momentum {of_momentum:.1e} kg m^2/s", rows.map(of_spin).fold(0.0, f64::max))
        });
    }
}

criterion_group!(benches, chains, point_chains, needles, free_body);
criterion_main!(benches);
