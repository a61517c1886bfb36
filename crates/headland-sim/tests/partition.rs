//! Constraints in form (1) through full turns: the independent rates change on the way and the motion does not notice.

mod common;

use common::{CARTESIAN, TRAIN, build, done, read, run_with, set};
use headland_model::Scene;
use headland_sim::{Run, Status};

/// Turns with constant steering: more than four times around in 15 s.
fn turning(text: &str, pinned: Option<&str>) -> Scene {
    let mut s = read(text);
    s.elements.retain(|section, _| section != "plot");
    set(&mut s, &[("gamma", "0.4"), ("outputs.columns", "[x_A1, y_A1, theta[k], psi[k], v]")]);
    if let Some(rate) = pinned {
        s.entry("run", "independent", &[rate][..]);
    }
    s
}

fn at() -> Vec<f64> {
    (0..=60).map(|i| 0.25 * f64::from(i)).collect()
}

fn run(scene: &Scene) -> Run {
    run_with(&build(scene), |o| {
        o.tolerance = 1e-12;
        o.at = Some(at());
    })
}

fn heading(run: &Run) -> f64 {
    run.trajectory.named("theta[1]").and_then(|c| c.last().copied()).unwrap_or(f64::NAN)
}

#[test]
fn full_turns_change_the_independent_rates() {
    let cartesian = run(&turning(CARTESIAN, None));
    assert_eq!(cartesian.report.status, Status::Done);
    assert!(heading(&cartesian) > 4.0 * std::f64::consts::TAU, "{}", heading(&cartesian));
    assert!(cartesian.report.repartitions >= 4, "{} changes", cartesian.report.repartitions);
    let told = cartesian.report.log.iter().filter(|l| l.message.contains("independent rates are now")).count();
    assert_eq!(told as u64, cartesian.report.repartitions);
    assert!(
        cartesian.report.constraint_velocity.is_some_and(|r| r < 1e-11),
        "{:?}",
        cartesian.report.constraint_velocity
    );
    assert!(cartesian.report.energy_balance.is_some_and(|b| b < 1e-9), "{:?}", cartesian.report.energy_balance);

    let train = run(&turning(TRAIN, None));
    assert_eq!(train.report.status, Status::Done);
    assert_eq!(cartesian.trajectory.names, train.trajectory.names);
    for (t, (a, b)) in at().iter().zip(cartesian.trajectory.rows.iter().zip(&train.trajectory.rows)) {
        for (name, (a, b)) in train.trajectory.names.iter().zip(a.iter().zip(b)) {
            assert!((a - b).abs() < 1e-9, "t = {t}, {name}: {a} against {b}");
        }
    }
}

#[test]
fn pinned_rates_fail_with_a_message_or_keep_the_constraints() {
    for rate in ["x_A1'", "y_A1'", "theta[1]'", "theta[3]'"] {
        let pinned = match std::panic::catch_unwind(|| run(&turning(CARTESIAN, Some(rate)))) {
            Ok(run) => run,
            Err(_) => panic!("{rate}: a panic"),
        };
        assert_eq!(pinned.report.repartitions, 0, "{rate}");
        let finite = pinned.trajectory.rows.iter().flatten().all(|x| x.is_finite());
        assert!(finite, "{rate}: a row that is not finite");
        match &pinned.report.status {
            Status::Done => {
                assert!(pinned.report.constraint_velocity.is_some_and(|r| r < 1e-6), "{rate}");
            }
            Status::Failed(why) => {
                assert!(why.contains("t =") && why.len() > 40, "{rate}: {why}");
                assert!(pinned.report.t_end < 15.0);
            }
            other => panic!("{rate}: {other:?}"),
        }
    }
}

/// A pinned rate that dies within the first quarter turn: the motion until then is right.
#[test]
fn a_pinned_rate_is_right_until_it_fails() {
    let train = run(&turning(TRAIN, None));
    let pinned = run(&turning(CARTESIAN, Some("x_A1'")));
    let good = pinned.trajectory.t.iter().filter(|t| **t < 0.5).count();
    assert!(good >= 2);
    for (a, b) in pinned.trajectory.rows.iter().zip(&train.trajectory.rows).take(good) {
        for (a, b) in a.iter().zip(b) {
            assert!((a - b).abs() < 1e-9, "{a} against {b}");
        }
    }
    // it steps over the singular place, no longer right, but not without a word
    let warning = pinned.report.log.iter().find(|l| l.message.contains("`independent`"));
    assert!(warning.is_some_and(|l| l.t < 1.0), "{:?}: {:?}", pinned.report.status, pinned.report.log);
    // and the balance says so too
    assert!(pinned.report.log.len() == 2, "{:?}", pinned.report.log);
    assert!(pinned.report.log[1].message.contains("work and energy disagree"), "{:?}", pinned.report.log);
    let well = run(&turning(CARTESIAN, Some("theta[1]'")));
    assert!(well.report.log.is_empty() && well.report.status == Status::Done, "{:?}", well.report.log);
}

/// The same change of partition with other methods.
#[cfg(feature = "cvode")]
#[test]
fn multistep_methods_change_the_partition_too() {
    for method in ["cvode-bdf", "cvode-adams"] {
        let result = done(&build(&turning(CARTESIAN, None)), |o| {
            o.method = method.into();
            o.tolerance = 1e-9;
            o.until = 6.0;
        });
        assert!(result.report.repartitions >= 2 && result.report.method == method, "{method}");
        assert!(result.report.constraint_velocity.is_some_and(|r| r < 1e-9));
    }
}
