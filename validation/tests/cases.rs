//! All reference problems pass, and each notices when its scene is changed by one per cent.

use approx::assert_relative_eq;
use headland_validation::{CaseResult, cases, linear_cases, names, run, to_json, to_table};

#[test]
fn all_pass() {
    let results = run(&[]);
    let failed: Vec<CaseResult> = results.iter().filter(|r| !r.passed()).cloned().collect();
    assert!(failed.is_empty(), "{}", to_table(&failed));
    assert_eq!(results.len(), names().len());
    println!("{}", to_table(&results));
}

#[test]
fn a_changed_scene_fails() {
    for case in cases() {
        let result = case.run_with(&[case.bite]);
        assert_eq!(result.failure, None, "{}: {:?}", case.name, case.bite);
        let worst = result.worst.as_ref().expect("compared");
        assert!(worst.ratio() > 2.0, "{} does not notice {:?}: {worst:?}", case.name, case.bite);
        assert!(!result.passed());
    }
}

#[test]
fn a_changed_linear_scene_fails() {
    for case in linear_cases() {
        let result = case.run_with(&[case.bite]);
        assert_eq!(result.failure, None, "{}: {:?}", case.name, case.bite);
        assert!(result.ratio > 2.0, "{} does not notice {:?}", case.name, case.bite);
    }
}

#[test]
fn names_are_unique_and_select() {
    let mut sorted = names();
    sorted.sort_unstable();
    sorted.dedup();
    assert_eq!(sorted.len(), names().len());
    assert!(run(&["no such problem".into()]).is_empty());
    let chosen = run(&["sleigh".into()]);
    assert_eq!(
        chosen.iter().map(|r| r.name).collect::<Vec<_>>(),
        ["chaplygin_sleigh", "sleigh_constraint", "body_sleigh"]
    );
}

#[test]
fn report_names_the_worst() {
    let case = cases().find(|c| c.name == "damped_oscillator").expect("in the table");
    let good = case.run();
    let bad = case.run_with(&[case.bite]);
    let table = to_table(&[good.clone(), bad]);
    let lines: Vec<&str> = table.lines().collect();
    assert!(lines[1].ends_with("ok"), "{table}");
    assert!(lines[2].contains("FAILED: x' at t = "), "{table}");
    assert!(lines[3].contains("2 problems, 16 values, 1 failed"), "{table}");

    let json: serde_json::Value = serde_json::from_str(&to_json(std::slice::from_ref(&good))).expect("JSON");
    assert_eq!(json[0]["name"], "damped_oscillator");
    assert_eq!(json[0]["passed"], true);
    assert_relative_eq!(json[0]["ratio"].as_f64().expect("a number"), good.ratio, max_relative = 1e-12);
}

#[test]
fn a_broken_scene_is_a_failure_not_a_panic() {
    let case = cases().next().expect("a case");
    let result = case.run_with(&[("no_such_parameter", "1")]);
    assert!(!result.passed());
    assert!(result.failure.expect("said why").contains("no_such_parameter"));
}
