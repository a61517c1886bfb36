//! Work against precision: the article's train over 15 s by every method, errors against a reference computed otherwise
//! (energy form, Taylor series in 80-bit arithmetic). Prints a Markdown table.
//!
//! The integration is bare: outputs at the four reference times, no energy balance. The time is the median of many.

mod train;

use headland::solve::{Integrator, Method, OdeProblem, Options, Step};
use headland::{Model, RunOptions, Scene, Silent, Status, run};
use serde_json::Value;
use train::{MINIMAL, Train, difference};

const REFERENCE: &str = include_str!("../../../validation/reference/paper_train.json");
const REPEATS: usize = 101;

/// `[x, y, θ_1, θ_2, θ_3, v]` at the reference times.
fn reference() -> (Vec<f64>, Vec<Vec<f64>>) {
    let json: Value = serde_json::from_str(REFERENCE).expect("JSON");
    let number = |v: &Value| v.as_str().and_then(|s| s.parse().ok()).or(v.as_f64()).expect("a number");
    let rows = json["values"].as_array().expect("rows");
    let state = |row: &Value| -> Vec<f64> {
        let theta = row["theta"].as_array().expect("angles");
        [&row["x_A1"], &row["y_A1"]].into_iter().chain(theta).chain([&row["v"]]).map(number).collect()
    };
    (rows.iter().map(|r| number(&r["t"])).collect(), rows.iter().map(state).collect())
}

fn row(method: &str, tolerance: f64, error: f64, counts: [u64; 4], seconds: f64) {
    let [steps, rejected, rhs, jacobians] = counts;
    println!(
        "| {method} | {tolerance:.0e} | {error:.1e} | {steps} | {rejected} | {rhs} | {jacobians} | {:.0} |",
        seconds * 1e6
    );
}

fn by_headland(model: &Model, method: Method, tolerance: f64, times: &[f64], expected: &[Vec<f64>]) {
    let mut options = RunOptions::of(model);
    (options.method, options.tolerance) = (method.name().into(), tolerance);
    (options.at, options.balance, options.repeat) = (Some(times.to_vec()), false, REPEATS);
    let result = run(model, &options, &mut Silent).expect("starts");
    let r = result.report;
    if let Status::Failed(reason) = r.status {
        println!("| {} | {tolerance:.0e} | {reason} |", method.name());
        return;
    }
    // columns x_A1, y_A1, v, θ_1 ..
    let error = result.trajectory.rows.iter().zip(expected).map(|(row, expected)| {
        let state = [&row[..2], &row[3..6], &row[2..3]].concat();
        difference(&state, expected)
    });
    let error = error.fold(0.0, f64::max);
    let counts = [r.steps, r.rejected, r.rhs, r.jacobians];
    row(method.name(), tolerance, error, counts, r.run_s_median.unwrap_or(r.run_s));
}

/// The hand-written loop under the same integrator: what the derived equations and the time loop cost beside it.
fn by_hand(train: &mut Train, tolerance: f64, times: &[f64], expected: &[Vec<f64>]) {
    let y = train.start();
    let mut seconds = Vec::new();
    let (mut error, mut counts) = (0.0_f64, [0; 4]);
    for _ in 0..REPEATS {
        let clock = std::time::Instant::now();
        let n = train.len();
        let options = Options::new(tolerance, vec![tolerance; n]);
        let mut integrator: Box<dyn Integrator> = Method::Dop853.create(n, options).expect("options are right");
        integrator.start(train, 0.0, &y).expect("starts");
        for (t, expected) in times.iter().zip(expected) {
            while !matches!(integrator.step(train, *t).expect("goes on"), Step::End { .. }) {}
            error = error.max(difference(integrator.y(), expected));
        }
        seconds.push(clock.elapsed().as_secs_f64());
        let s = integrator.stats();
        counts = [s.steps, s.rejected, s.rhs, s.jacobians];
    }
    seconds.sort_by(f64::total_cmp);
    row("dop853, hand-written rhs", tolerance, error, counts, seconds[seconds.len() / 2]);
}

fn main() {
    if !std::env::args().any(|a| a == "--bench") {
        return; // run as a test: it is enough that it builds
    }
    let (times, expected) = reference();
    let model = Scene::parse("paper_train.toml", MINIMAL).and_then(|s| s.build()).expect("the scene is right");
    println!("| method | tolerance | largest error | steps | rejected | rhs | Jacobians | time, us |");
    println!("|---|---|---|---|---|---|---|---|");
    let tolerances: Vec<f64> = (4..=13).map(|k| 10_f64.powi(-k)).collect();
    for method in Method::ALL.into_iter().filter(|m| m.is_built()) {
        for &tolerance in &tolerances {
            by_headland(&model, method, tolerance, &times, &expected);
        }
    }
    let mut train = Train::of_the_scene();
    for &tolerance in &tolerances {
        by_hand(&mut train, tolerance, &times, &expected);
    }
}
