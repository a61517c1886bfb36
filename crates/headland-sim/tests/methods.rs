//! The methods agree, output is where it was asked for, and the same run gives the same bits.

mod common;

use common::{CARTESIAN, DOUBLE, PIVOT, SLEIGH, build, chain, done, forced, particle, pendulums, read, run_with, set};
use headland_model::Scene;
use headland_sim::{RunError, RunOptions, Silent, Status, run};

fn damped() -> Scene {
    let mut s = read(DOUBLE);
    s.element("dissipative", &[("name", "joint"), ("value", "0.8[N*m*s]"), ("implicit", "phi_2' - phi_1'")]);
    s.element("dissipative", &[("name", "bearing"), ("value", "0.5[N*m*s]"), ("implicit", "phi_1'")]);
    s
}

#[cfg(feature = "cvode")]
#[test]
fn three_methods_agree() {
    for scene in [damped(), chain(12), pendulums(3)] {
        let model = build(&scene);
        let at: Vec<f64> = (0..=20).map(|i| 0.2 * f64::from(i)).collect();
        let [a, b, c] = ["dop853", "cvode-bdf", "cvode-adams"].map(|method| {
            done(&model, |o| {
                o.method = method.into();
                o.tolerance = 1e-11;
                o.until = 4.0;
                o.at = Some(at.clone());
            })
        });
        assert_eq!([&a, &b, &c].map(|r| r.report.method.as_str()), ["dop853", "cvode-bdf", "cvode-adams"]);
        for other in [&b, &c] {
            for (row, (x, y)) in a.trajectory.rows.iter().zip(&other.trajectory.rows).enumerate() {
                for (x, y) in x.iter().zip(y) {
                    assert!((x - y).abs() < 2e-7, "{}, {}, row {row}: {x} {y}", model.title, other.report.method);
                }
            }
        }
        assert!(b.report.jacobians > 0 && b.report.factorizations > 0 && a.report.jacobians == 0);
    }
}

/// Unrolled LDL, unrolled Crout and LDL by numbers are one motion.
#[test]
fn linear_solvers_agree() {
    let mut crout = pendulums(4);
    set(&mut crout, &[("run.linear_solver", "crout")]);
    let model = build(&pendulums(4));
    let run = |model: &headland_model::Model, unroll: usize| {
        done(model, |o| {
            o.until = 1.0;
            o.tolerance = 1e-12;
            o.derive.unroll = unroll;
        })
    };
    let (a, b, c, d) = (run(&model, 8), run(&build(&crout), 8), run(&model, 0), run(&build(&crout), 0));
    for other in [b, c, d] {
        for (x, y) in a.trajectory.rows.iter().flatten().zip(other.trajectory.rows.iter().flatten()) {
            assert!((x - y).abs() < 1e-9, "{x} {y}");
        }
    }
}

fn stiff() -> Scene {
    let mut s = forced("10[N]*sin(3[1/s]*t)");
    set(&mut s, &[("x", "0.001"), ("m", "1")]);
    s.element("elastic", &[("name", "c"), ("value", "1e8[N/m]"), ("geometric", "x")]);
    s.element("dissipative", &[("name", "b"), ("value", "1e6[N*s/m]"), ("geometric", "x")]);
    s
}

#[cfg(feature = "cvode")]
#[test]
fn a_stiff_scene_goes_over_to_bdf_and_says_so() {
    let run = done(&build(&stiff()), |o| o.until = 20.0);
    let r = &run.report;
    assert_eq!(r.method, "cvode-bdf");
    assert!(r.why.contains("auto: stiff") && r.why.contains("until t ="), "{}", r.why);
    assert!(r.log.iter().any(|l| l.message.contains("cvode-bdf") && l.t < 1.0), "{:?}", r.log);
    assert!(r.steps < 20_000 && r.jacobians > 0, "{} steps", r.steps);
    // quasi-static: c x + b x' = F
    let (t, x) = (run.trajectory.t.last(), run.trajectory.rows.last());
    let (Some(t), Some(row)) = (t, x) else { panic!("no rows") };
    let w = 3.0;
    let (c, b) = (1e8_f64, 1e6_f64);
    let exact = 10.0 * (c * (w * t).sin() - b * w * (w * t).cos()) / (c * c + b * b * w * w);
    assert!((row[0] - exact).abs() < 3e-10, "{} for {exact}", row[0]); // the tolerance is 1e-8 m
}

#[test]
fn what_is_not_stiff_stays_explicit() {
    for scene in [read(SLEIGH), read(DOUBLE), damped(), particle()] {
        let run = done(&build(&scene), |o| o.until = 5.0);
        assert_eq!(run.report.method, "dop853", "{}", run.report.title);
    }
}

#[test]
fn output_is_exactly_where_it_was_asked_for() {
    let model = build(&read(PIVOT));
    let at = vec![0.2, 0.0, 1.0 / 3.0, 0.1 + 0.2, 0.123456789012345, 1.0, 0.2];
    let run = done(&model, |o| {
        o.at = Some(at.clone());
        o.until = 1.0;
    });
    let mut sorted = at;
    sorted.sort_by(f64::total_cmp);
    sorted.dedup();
    assert_eq!(run.trajectory.t, sorted);
    assert_eq!(run.trajectory.rows.len(), sorted.len());
    // a step ends there, so the values are those of a run that ends there
    let short = done(&model, |o| {
        o.at = Some(vec![1.0 / 3.0]);
        o.until = 1.0 / 3.0;
    });
    let i = sorted.iter().position(|t| *t == 1.0 / 3.0).unwrap_or_default();
    for (x, y) in run.trajectory.rows[i].iter().zip(&short.trajectory.rows[0]) {
        assert!((x - y).abs() < 1e-7, "{x} {y}");
    }

    let run = done(&model, |o| {
        o.until = 1.0;
        o.points = 7;
    });
    assert_eq!(run.trajectory.t.len(), 8);
    assert_eq!((run.trajectory.t[0], run.trajectory.t[7]), (0.0, 1.0));
}

#[test]
fn dense_output_is_as_good_as_steps() {
    let model = build(&read(DOUBLE));
    let dense = done(&model, |o| o.points = 100);
    let exact = done(&model, |o| o.at = Some(dense.trajectory.t.clone()));
    for (x, y) in dense.trajectory.rows.iter().flatten().zip(exact.trajectory.rows.iter().flatten()) {
        assert!((x - y).abs() < 1e-5, "{x} {y}"); // chaotic: 10 s magnify 1e-10
    }
}

#[test]
fn two_runs_give_the_same_bits() {
    let methods: &[&str] = if cfg!(feature = "cvode") { &["auto", "cvode-bdf", "cvode-adams"] } else { &["auto"] };
    for scene in [read(CARTESIAN), read(PIVOT), damped(), chain(12)] {
        for method in methods {
            let once = || {
                let model = build(&scene);
                let run = done(&model, |o| {
                    o.method = (*method).into();
                    o.until = 2.0;
                });
                let bits: Vec<u64> = run.trajectory.rows.iter().flatten().map(|x| x.to_bits()).collect();
                (bits, run.report.steps, run.report.rhs, run.report.energy_balance.map(f64::to_bits))
            };
            assert_eq!(once(), once(), "{method}");
        }
    }
}

#[test]
fn repeats_change_nothing_but_the_time() {
    let model = build(&read(CARTESIAN));
    let once = done(&model, |o| o.until = 3.0);
    let thrice = done(&model, |o| {
        o.until = 3.0;
        o.repeat = 3;
    });
    assert_eq!(once.trajectory, thrice.trajectory);
    assert_eq!((once.report.steps, once.report.rhs), (thrice.report.steps, thrice.report.rhs));
    assert!(thrice.report.run_s_median >= Some(thrice.report.run_s) && once.report.run_s_median.is_none());
}

#[test]
fn wrong_options_are_told() {
    let model = build(&particle());
    let wrong = |change: &dyn Fn(&mut RunOptions)| {
        let mut options = RunOptions::of(&model);
        change(&mut options);
        run(&model, &options, &mut Silent).map(|_| ()).unwrap_err()
    };
    assert!(matches!(wrong(&|o| o.until = 0.0), RunError::Empty { .. }));
    assert!(matches!(wrong(&|o| o.until = -1.0), RunError::Empty { .. }));
    assert!(matches!(wrong(&|o| o.until = f64::NAN), RunError::Empty { .. }));
    assert!(matches!(wrong(&|o| o.at = Some(vec![1.0, 11.0])), RunError::OutputTime { t: 11.0, .. }));
    assert!(matches!(wrong(&|o| o.at = Some(vec![-1.0])), RunError::OutputTime { .. }));
    assert!(matches!(wrong(&|o| o.at = Some(vec![f64::NAN])), RunError::OutputTime { .. }));
    let unknown = wrong(&|o| o.method = "euler".into());
    assert!(unknown.to_string().contains("euler") && unknown.to_string().contains("dop853"), "{unknown}");
    for tolerance in [0.0, -1e-8, f64::NAN, 1e-17, 2.0] {
        let error = wrong(&|o| o.tolerance = tolerance);
        assert!(matches!(error, RunError::Solve(_)), "{tolerance}: {error}");
    }
    for step in [0.0, -1.0, f64::NAN] {
        let result = std::panic::catch_unwind(|| {
            let model = build(&particle());
            let mut options = RunOptions::of(&model);
            options.max_step = step;
            run(&model, &options, &mut Silent).map(|r| r.report.status)
        });
        let refused = matches!(&result, Ok(Err(_)) | Ok(Ok(Status::Failed(_))));
        assert!(refused, "max_step = {step}: {:?}", result.map_err(|_| "a panic"));
    }
}

#[test]
fn the_longest_step_and_the_most_steps_are_kept() {
    let model = build(&read(SLEIGH));
    let run = done(&model, |o| o.max_step = 0.01);
    assert!(run.report.steps >= 1200, "{}", run.report.steps);
    let run = run_with(&model, |o| {
        o.max_step = 0.01;
        o.max_steps = 100;
    });
    assert!(matches!(&run.report.status, Status::Failed(why) if why.contains("100")), "{:?}", run.report.status);
    assert!(run.report.t_end > 0.9 && run.report.t_end < 1.1);
    assert_eq!(run.trajectory.rows.len(), run.trajectory.t.iter().filter(|t| **t <= run.report.t_end).count());
    assert!(run.trajectory.rows.len() > 20);
}

/// Time goes on from `from`; functions of time are not moved.
#[test]
fn a_run_may_start_late() {
    let run = done(&build(&forced("2[N]*cos(t/1[s])")), |o| {
        o.from = 5.0;
        o.until = 7.0;
        o.tolerance = 1e-12;
    });
    let v = run.trajectory.rows.last().map_or(f64::NAN, |r| r[1]);
    assert!((v - (7.0_f64.sin() - 5.0_f64.sin())).abs() < 1e-10, "{v}");
    assert_eq!(run.trajectory.t.first(), Some(&5.0));
}
