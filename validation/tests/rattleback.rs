//! When the rattleback's spin about the vertical changes its sign, against `rolling_and_tops.json`.

use headland::{RunOptions, Scene, Silent, Status};
use serde_json::Value;

const SCENE: &str = include_str!("../../models/rattleback.toml");
const REFERENCE: &str = include_str!("../reference/rolling_and_tops.json");

#[test]
fn turns_round_when_it_should() {
    let model = Scene::parse("rattleback.toml", SCENE).and_then(|s| s.build()).expect("the scene is right");
    let mut options = RunOptions::of(&model);
    (options.tolerance, options.until) = (1e-13, 2.83);
    let run = headland::run(&model, &options, &mut Silent).expect("runs");
    assert_eq!(run.report.status, Status::Done);
    let found: Vec<f64> = run.report.log.iter().filter(|e| e.message.contains("turns round")).map(|e| e.t).collect();

    let file: Value = serde_json::from_str(REFERENCE).expect("JSON");
    let list = file.pointer("/rattleback/values/spin -5/first_zero_crossings").and_then(Value::as_array);
    let times = list.expect("a list").iter().map(|t| t.as_str().and_then(|t| t.parse::<f64>().ok()).expect("a number"));
    // The file's search stepped over a first pair: between 2.6846 s and 2.6850 s the spin is positive by up to 4e-4 rad/s.
    let expected: Vec<f64> = [2.684647045, 2.684958816].into_iter().chain(times).collect();
    assert_eq!(found.len(), expected.len(), "{found:?}");
    for (i, (a, b)) in found.iter().zip(&expected).enumerate() {
        let allowed = if i < 2 { 1e-8 } else { 1e-9 };
        assert!((a - b).abs() < allowed, "{a} for {b}");
    }
}
