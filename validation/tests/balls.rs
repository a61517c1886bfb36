//! What the run of the spinning ball costs, in numbers that do not depend on the machine.

use headland::{RunOptions, Scene, Silent};

const SCENE: &str = include_str!("../../models/ball_in_recess.toml");
const REFERENCE: &str = include_str!("../reference/ball_recess_spinning.json");

/// 10 s at an error of 1e-8 m: 190 steps, 2300 evaluations of 123 operations. Angular velocities along the ball's own axes,
/// which turn with 25 rad/s, would need twice as many steps of twice as many operations.
#[test]
fn ten_seconds_take_few_operations() {
    let model = Scene::parse("ball_in_recess.toml", SCENE).and_then(|s| s.build()).unwrap_or_else(|e| panic!("{e}"));
    let mut options = RunOptions::of(&model);
    (options.tolerance, options.until, options.at) = (1e-7, 10.0, Some(vec![10.0]));
    (options.balance, options.repeat) = (false, 5);
    let run = headland::run(&model, &options, &mut Silent).unwrap_or_else(|e| panic!("{e}"));
    let file: serde_json::Value = serde_json::from_str(REFERENCE).expect("JSON");
    let position = &file["trajectory"][4]["position"];
    let error = (0..3)
        .map(|i| (run.trajectory.rows[0][i] - position[i].as_f64().expect("a number")).powi(2))
        .sum::<f64>()
        .sqrt();
    let report = &run.report;
    println!(
        "error {error:e} m, {} steps, {} evaluations of {} operations, {} s",
        report.steps, report.rhs, report.operations, report.run_s
    );
    assert!(error < 1e-8, "{error:e}");
    assert!(report.rhs * report.operations as u64 <= 320_000, "{} of {}", report.rhs, report.operations);
}
