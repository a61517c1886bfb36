//! The balance of work and energy: small where the motion is right, and not small where it is not.

mod common;

use common::{CARTESIAN, DOUBLE, PIVOT, ROAD, SLEIGH, SNAKEBOARD, TRAIN, build, chain, done, pendulums, read};
use headland_model::{Model, Scene};

fn balance(model: &Model, tolerance: f64, until: f64) -> f64 {
    let run = done(model, |o| {
        o.tolerance = tolerance;
        o.until = until;
    });
    run.report.energy_balance.unwrap_or(f64::NAN)
}

#[test]
fn small_when_the_motion_is_right() {
    let scenes: Vec<(Scene, f64)> = [(DOUBLE, 5.0), (PIVOT, 1.0), (SLEIGH, 12.0), (SNAKEBOARD, 8.0), (TRAIN, 15.0)]
        .into_iter()
        .chain([(CARTESIAN, 10.0), (ROAD, 10.0)])
        .map(|(text, until)| (read(text), until))
        .chain([(chain(6), 5.0), (chain(12), 3.0), (pendulums(3), 2.0)])
        .collect();
    for (scene, until) in scenes {
        let model = build(&scene);
        let found = balance(&model, 1e-11, until);
        assert!(found < 3e-9, "{}: {found:e}", model.title);
    }
}

/// The measure bites: it follows the tolerance.
#[test]
fn not_small_when_the_tolerance_is_loose() {
    // (the quick pivot is left out: its window holds the steps short whatever the tolerance)
    for (scene, until) in [(read(DOUBLE), 5.0), (read(SNAKEBOARD), 8.0), (chain(6), 5.0), (pendulums(3), 2.0)] {
        let model = build(&scene);
        let [loose, tight] = [1e-3, 1e-10].map(|tolerance| balance(&model, tolerance, until));
        assert!(loose > 1e-6, "{}: {loose:e} at tolerance 1e-3", model.title);
        assert!(tight < 1e-3 * loose, "{}: {tight:e} against {loose:e}", model.title);
    }
}

#[test]
fn none_when_it_is_not_wanted() {
    let run = done(&build(&read(SLEIGH)), |o| o.balance = false);
    assert_eq!(run.report.energy_balance, None);
}

#[test]
fn constraints_are_kept_and_told() {
    let run = done(&build(&read(CARTESIAN)), |_| {});
    assert!(run.report.constraint_velocity.is_some_and(|r| r < 1e-11), "{:?}", run.report.constraint_velocity);
    let run = done(&build(&read(SLEIGH)), |_| {});
    assert_eq!(run.report.constraint_velocity, None);
}
