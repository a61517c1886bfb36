//! IDA on the constraints gives what elimination gives.
#![cfg(feature = "ida")]

mod common;

use common::{build, done, read, run_with, set};
use headland_model::Model;
use headland_sim::{Run, RunOptions, Silent, Status, run};

const PENDULUM: &str = include_str!("scenes/pendulum.toml");
const FOUR_BAR: &str = include_str!("scenes/four_bar.toml");
const DISC: &str = include_str!("scenes/disc.toml");
const BRICARD: &str = include_str!("scenes/bricard.toml");
const ANDREWS: &str = include_str!("scenes/andrews.toml");

fn by(model: &Model, method: &str, tolerance: f64) -> Run {
    let from_to = |i: usize| model.run.until * i as f64 / 40.0;
    done(model, |o| {
        o.method = method.into();
        o.tolerance = tolerance;
        o.at = Some((0..=40).map(from_to).collect());
    })
}

/// Largest difference of each column, relative to its largest value or one, whichever is larger.
fn differences(a: &Run, b: &Run) -> Vec<(String, f64)> {
    assert_eq!(a.trajectory.names, b.trajectory.names);
    let column = |i: usize| {
        let (x, y) = (a.trajectory.column(i), b.trajectory.column(i));
        let size = x.iter().fold(1.0, |m: f64, v| m.max(v.abs()));
        x.iter().zip(&y).map(|(x, y)| (x - y).abs()).fold(0.0, |m, d| if d.is_nan() { d } else { f64::max(m, d) })
            / size
    };
    a.trajectory.names.iter().cloned().enumerate().map(|(i, name)| (name, column(i))).collect()
}

/// States, accelerations, reactions at tolerances of 1e-9 and 1e-12, residuals and energy of both formulations against
/// elimination with projection.
fn agrees(text: &str, allowed: [f64; 2], [positions, velocities]: [f64; 2]) {
    let model = build(&read(text));
    let eliminated = by(&model, "dop853", 1e-12);
    for method in ["ida", "ida-index1"] {
        let free = by(&model, method, 1e-9);
        let report = &free.report;
        assert_eq!(report.method, method);
        assert_eq!(report.degrees_of_freedom, eliminated.report.degrees_of_freedom);
        let fine = by(&model, method, 1e-12);
        for (run, limit) in [(&free, allowed[0]), (&fine, allowed[1])] {
            for (name, d) in differences(&eliminated, run) {
                let tolerance = run.report.tolerance;
                assert!(d < limit, "{}, {method} at {tolerance:e}: {name} differs by {d:.1e}", model.title);
            }
        }
        let slack = if method == "ida" { 1.0 } else { 1000.0 };
        for (residual, limit) in [(report.constraint_position, positions), (report.constraint_velocity, velocities)] {
            assert!(residual.is_none_or(|r| r < slack * limit), "{}, {method}: residual {residual:?}", model.title);
        }
        assert!(report.energy_balance.is_some_and(|b| b < 1e-5), "{:?}", report.energy_balance);
    }
}

#[test]
fn cartesian_pendulum() {
    agrees(PENDULUM, [3e-7, 1e-9], [1e-9, 1e-8]);
}

#[test]
fn four_bar() {
    agrees(FOUR_BAR, [1e-5, 3e-8], [1e-9, 1e-8]);
}

#[test]
fn rolling_disc() {
    agrees(DISC, [3e-7, 2e-9], [1e-9, 1e-8]);
}

#[test]
fn bricard_has_a_redundant_row() {
    agrees(BRICARD, [3e-7, 2e-9], [1e-9, 1e-8]);
}

#[test]
fn squeezer() {
    agrees(ANDREWS, [3e-6, 2e-8], [1e-9, 1e-7]);
}

/// What IDA itself has for v' and the multipliers is a hundred times less accurate than its states.
#[test]
fn reactions_are_as_accurate_as_states() {
    for text in [PENDULUM, FOUR_BAR, ANDREWS] {
        let model = build(&read(text));
        let errors = differences(&by(&model, "dop853", 1e-13), &by(&model, "ida", 1e-6));
        let of_state = |name: &str| !name.contains("''") && !name.contains(".f") && !name.contains(".t");
        let worst = |state: bool| errors.iter().filter(|(n, _)| of_state(n) == state).fold(0.0, |m: f64, e| m.max(e.1));
        let (states, reactions) = (worst(true), worst(false));
        assert!(reactions > 0.0 && reactions < 5.0 * states, "{}: {reactions:.1e} of {states:.1e}", model.title);
    }
}

#[test]
fn an_inconsistent_start_is_cured_and_told() {
    let mut scene = read(PENDULUM);
    set(&mut scene, &[("initial.y'", "0[m/s]")]);
    let model = build(&scene);
    let refused = run(&model, &RunOptions::of(&model), &mut Silent);
    assert!(refused.is_err(), "elimination takes given rates at their word");
    let cured = by(&model, "ida", 1e-8);
    let told: Vec<&str> = cured.report.log.iter().map(|l| l.message.as_str()).collect();
    assert!(told.iter().any(|m| m.contains("contradicts")), "{told:?}");
    assert!(told.iter().any(|m| m.contains("`x'` changed from")), "{told:?}");
    assert!(cured.report.constraint_velocity.is_some_and(|r| r < 1e-7));
}

#[test]
fn conflicting_constraints_are_named() {
    let mut scene = read(PENDULUM);
    scene.element("constraint", &[("name", "wire"), ("equation", "y = -3[m]")]);
    let model = build(&scene);
    let error = run(&model, &RunOptions { method: "ida".into(), ..RunOptions::of(&model) }, &mut Silent);
    let message = error.err().map(|e| e.to_string()).unwrap_or_default();
    assert!(message.contains("cannot be assembled") && message.contains("`rod` by"), "{message}");
}

#[test]
fn without_constraints_it_is_one_more_implicit_method() {
    let model = build(&common::pendulums(2));
    let [a, b] = ["dop853", "ida"].map(|m| by(&model, m, 1e-9));
    assert!(differences(&a, &b).iter().all(|(_, d)| *d < 1e-6));
    assert!(b.report.why.contains("no constraints"), "{}", b.report.why);
}

#[test]
fn events_stop_it_where_they_stop_elimination() {
    let text = format!("{PENDULUM}\n[[event]]\nname = \"middle\"\nquantity = \"x\"\nstop = true\n");
    let model = build(&read(&text));
    let [a, b] = ["dop853", "ida"].map(|method| {
        run_with(&model, |o| {
            o.method = method.into();
            o.tolerance = 1e-10;
        })
    });
    assert!(matches!(b.report.status, Status::Stopped(_)), "{:?}", b.report.status);
    assert!((a.report.t_end - b.report.t_end).abs() < 1e-7, "{} {}", a.report.t_end, b.report.t_end);
}

/// The table of `docs/benchmarks.md`: `cargo test -p headland-sim --test dae -- --ignored --nocapture table`.
#[test]
#[ignore = "a measurement"]
fn table() {
    for (name, text) in
        [("pendulum", PENDULUM), ("four-bar", FOUR_BAR), ("disc", DISC), ("Bricard", BRICARD), ("squeezer", ANDREWS)]
    {
        let model = build(&read(text));
        let exact = by(&model, "dop853", 1e-13);
        for method in ["dop853", "cvode-bdf", "ida", "ida-index1"] {
            for tolerance in [1e-6, 1e-9] {
                let run = run_with(&model, |o| {
                    o.method = method.into();
                    o.tolerance = tolerance;
                    o.at = Some((0..=40).map(|i| model.run.until * f64::from(i) / 40.0).collect());
                    o.repeat = 5;
                    o.balance = false;
                });
                let error = differences(&exact, &run);
                let is_state = |n: &str| !n.contains("''") && !n.contains(".f") && !n.contains(".t");
                let worst =
                    |state: bool| error.iter().filter(|(n, _)| is_state(n) == state).fold(0.0, |m: f64, e| m.max(e.1));
                let r = &run.report;
                println!(
                    "| {name} | {method} | {tolerance:.0e} | {:.1e} | {:.1e} | {} | {} | {:.2} |",
                    worst(true),
                    worst(false),
                    r.steps,
                    r.rhs,
                    1e3 * r.run_s
                );
            }
        }
    }
}
