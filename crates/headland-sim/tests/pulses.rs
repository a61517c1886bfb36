//! Short pulses in long runs: none is stepped over, and the impulse is right.

mod common;

use approx::assert_relative_eq;
use common::{build, done, forced};
use headland_expr::Spline;
use headland_model::{Scene, Value};

/// Velocity at the end of 100 s.
fn velocity(scene: &Scene, method: &str) -> f64 {
    let run = done(&build(scene), |o| {
        o.until = 100.0;
        o.tolerance = 1e-10;
        o.method = method.into();
        o.points = 10;
    });
    run.trajectory.rows.last().map_or(f64::NAN, |r| r[1])
}

fn methods() -> Vec<&'static str> {
    if cfg!(feature = "cvode") { vec!["auto", "dop853", "cvode-bdf", "cvode-adams"] } else { vec!["auto", "dop853"] }
}

fn check(scene: &Scene, velocity_change: f64) {
    for method in methods() {
        let found = velocity(scene, method);
        let tolerance = if method.starts_with("cvode") { 1e-7 } else { 1e-9 };
        assert!(
            (found / velocity_change - 1.0).abs() < tolerance,
            "{method}: {found} for {velocity_change}, {:?}",
            scene.section_elements("force")[0].get("value")
        );
    }
}

#[test]
fn a_rectangular_pulse() {
    // 5 ms of 200 N on 2 kg
    for force in [
        "if(t > 50.0017[s] and t < 50.0067[s], 200[N], 0[N])",
        "if(abs(t - 50.0042[s]) < 0.0025[s], 200[N], 0[N])",
        "200[N]*step(t - 50.0017[s])*step(50.0067[s] - t)",
        "200[N]*(if(t >= 50.0017[s], 1, 0) - if(t >= 50.0067[s], 1, 0))",
    ] {
        check(&forced(force), 0.5);
    }
}

#[test]
fn a_gaussian_pulse() {
    let impulse = 200.0 * 0.002 * std::f64::consts::PI.sqrt();
    for force in ["200[N]*exp(-((t - 61.803[s])/0.002[s])^2)", "200[N]/exp(((t - 61.803[s])^2)/(4e-6[s^2]))"] {
        check(&forced(force), impulse / 2.0);
    }
}

#[test]
fn a_sharp_tanh_pulse() {
    // ∫ (tanh((t-a)/w) - tanh((t-b)/w))/2 dt = b - a
    check(&forced("100[N]*(tanh((t - 33.1[s])/1e-4[s]) - tanh((t - 33.104[s])/1e-4[s]))/2"), 0.2);
}

#[test]
fn a_table_with_a_sharp_bump() {
    let x = [0.0, 40.0, 70.0, 70.01, 70.02, 70.03, 70.04, 90.0, 100.0];
    let y = [0.0, 0.0, 0.0, 10.0, 80.0, 20.0, 0.0, 0.0, 0.0];
    let spline = Spline::new("bump", &x, &y).unwrap_or_else(|e| panic!("{e}"));
    // cubic between points: Simpson's rule is exact
    let f = |t: f64| headland_expr::Scalar::spline(t, &spline, 0);
    let integral = |a: f64, b: f64| (b - a) / 6.0 * (f(a) + 4.0 * f((a + b) / 2.0) + f(b));
    let impulse: f64 = x.windows(2).map(|w| integral(w[0], w[1])).sum();
    let mut scene = forced("bump(t)");
    let array = |x: &[f64]| Value::from(x);
    let entry =
        |key: &str, value: Value| headland_model::Entry { key: key.into(), key_place: Default::default(), value };
    let table = headland_model::Data::Table(vec![
        entry("x", array(&x)),
        entry("y", array(&y)),
        entry("x_unit", "s".into()),
        entry("y_unit", "N".into()),
    ]);
    scene.entry("tables", "bump", Value { data: table, place: Default::default() });
    check(&scene, impulse / 2.0);
}

#[test]
fn many_pulses_at_odd_times() {
    let times = [0.3, 7.77, 20.0, 20.02, 55.5, 99.9];
    let terms: Vec<String> = times.iter().map(|t| format!("if(abs(t - {t}[s]) < 0.001[s], 300[N], 0[N])")).collect();
    check(&forced(&terms.join(" + ")), times.len() as f64 * 0.3);
}

#[test]
fn a_pulse_through_a_definition_and_a_prescribed_motion() {
    // the base jerks by 1 cm within 4 ms; a mass on a damper feels b Δx
    let mut scene = common::particle();
    scene.entry("coordinates", "p", "m").entry("prescribed", "p", "0.01[m]*smoothstep(t, 44.4[s], 44.404[s])");
    scene.element("dissipative", &[("name", "b"), ("value", "1e-6[N*s/m]"), ("geometric", "x - p")]);
    let run = done(&build(&scene), |o| {
        o.until = 100.0;
        o.tolerance = 1e-10;
    });
    let (m, b) = (2.0, 1e-6);
    let last = run.trajectory.rows.last().map_or([f64::NAN; 2], |r| [r[0], r[1]]);
    // m v' = -b (v - p'): momentum m v = b (p - x)
    assert_relative_eq!(m * last[1], b * (0.01 - last[0]), max_relative = 1e-9);
}

#[test]
fn a_force_that_switches_for_ever() {
    // ±3 N on 2 kg with period 0.8 s: v is a triangle between 0 and 0.6, x grows by its mean
    let run = done(&build(&forced("if(sin(2*pi*t/0.8[s]) >= 0, 3[N], -3[N])")), |o| {
        o.until = 100.0;
        o.at = Some((0..=250).map(|i| 0.4 * f64::from(i)).collect());
    });
    for (t, row) in run.trajectory.t.iter().zip(&run.trajectory.rows) {
        let k = (t / 0.4).round() as u32;
        let v = if k % 2 == 1 { 0.6 } else { 0.0 };
        assert!((row[1] - v).abs() < 1e-9, "t = {t}: {} for {v}", row[1]);
        assert!((row[0] - 0.3 * t).abs() < 1e-8, "t = {t}: {} for {}", row[0], 0.3 * t);
    }
    assert!(run.report.steps < 10_000, "{}", run.report.steps);
}

/// A run that starts inside a pulse or on its edge.
#[test]
fn starts_at_an_edge() {
    for (from, expected) in [(1.0, 0.5), (1.0025, 0.25), (1.005, 0.0), (0.0, 0.5)] {
        let run = done(&build(&forced("if(t > 1[s] and t < 1.005[s], 200[N], 0[N])")), |o| {
            o.from = from;
            o.until = 3.0;
        });
        let v = run.trajectory.rows.last().map_or(f64::NAN, |r| r[1]);
        assert!((v - expected).abs() < 1e-9, "from {from}: {v} for {expected}");
    }
}
