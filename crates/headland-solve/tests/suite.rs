//! What every integrator must do.

mod common;

use approx::assert_abs_diff_eq;
use common::{Problem, run, run_events, tolerance};
use headland_solve::{EvalFailure, Function, Integrator, Method, Options, SolveError, Step};

type Factory = fn(usize, Options) -> Box<dyn Integrator>;

/// `ẍ = −x` from `(1, 0)`.
fn oscillator() -> Problem {
    Problem::new(2, |_, y, dy| {
        dy[0] = y[1];
        dy[1] = -y[0];
    })
    .jacobian(|_, _, j| j.copy_from_slice(&[0.0, -1.0, 1.0, 0.0]))
}

/// A ball under gravity 1, event: height is zero.
fn ball() -> Problem {
    Problem::new(2, |_, y, dy| {
        dy[0] = y[1];
        dy[1] = -1.0;
    })
    .events(1, |_, y, g| g[0] = y[0])
}

fn error_follows_the_tolerance(make: Factory) {
    let mut last = f64::INFINITY;
    for rtol in [1e-4, 1e-6, 1e-8, 1e-10, 1e-12] {
        let mut problem = oscillator();
        let mut integrator = make(2, tolerance(2, rtol));
        integrator.start(&mut problem, 0.0, &[1.0, 0.0]).unwrap();
        run(&mut *integrator, &mut problem, 5.0).unwrap();
        let y = integrator.y();
        let error = (y[0] - 5f64.cos()).abs().max((y[1] + 5f64.sin()).abs());
        assert!(error < 200.0 * rtol, "rtol {rtol:e}: {error:e}");
        assert!(error < 0.3 * last, "rtol {rtol:e}: {error:e} after {last:e}");
        last = error;
    }
}

fn dense_output_is_as_good_as_the_steps(make: Factory) {
    for rtol in [1e-5, 1e-8, 1e-11] {
        let mut problem = oscillator();
        let mut integrator = make(2, tolerance(2, rtol));
        integrator.start(&mut problem, 0.0, &[1.0, 0.0]).unwrap();
        let mut worst = 0f64;
        let mut y = [0.0; 2];
        while integrator.t() < 5.0 {
            integrator.step(&mut problem, 5.0).unwrap();
            let (a, b) = (integrator.t_previous(), integrator.t());
            for i in 0..=6 {
                let t = a + (b - a) * f64::from(i) / 6.0;
                integrator.interpolate(&mut problem, t, &mut y).unwrap();
                worst = worst.max((y[0] - t.cos()).abs().max((y[1] + t.sin()).abs()));
            }
            integrator.interpolate(&mut problem, b, &mut y).unwrap();
            assert_eq!(y, integrator.y());
        }
        assert!(worst < 300.0 * rtol, "rtol {rtol:e}: {worst:e}");
    }
}

fn stops_are_exact_and_nothing_is_evaluated_beyond(make: Factory) {
    let mut problem = oscillator();
    let mut integrator = make(2, tolerance(2, 1e-7));
    integrator.start(&mut problem, 0.0, &[1.0, 0.0]).unwrap();
    let mut reached = 0.0;
    for stop in [1e-9, 0.1, 1.0 / 3.0, 0.7, 0.7000001, 2.5, 10.0] {
        loop {
            let step = integrator.step(&mut problem, stop).unwrap();
            let (a, b) = (integrator.t_previous(), integrator.t());
            assert_eq!(a, reached, "pieces follow each other");
            assert!(b > a && b <= stop);
            assert!(problem.t_latest <= stop, "{} > {stop}", problem.t_latest);
            let mut y = [0.0; 2];
            let middle = 0.5 * (a + b);
            integrator.interpolate(&mut problem, middle, &mut y).unwrap();
            assert!(problem.t_latest <= stop);
            reached = b;
            match step {
                Step::End { t } => {
                    assert_eq!(t, stop);
                    assert_eq!(integrator.t(), stop);
                    break;
                }
                Step::Advanced { t, h, order } => {
                    assert_eq!(t, b);
                    assert!(h > 0.0 && order >= 1);
                }
                Step::Event { .. } => unreachable!(),
            }
        }
        assert_abs_diff_eq!(integrator.y()[0], stop.cos(), epsilon = 5e-5);
    }
}

fn a_stop_within_rounding_is_reached_at_once(make: Factory) {
    let mut problem = oscillator();
    let mut integrator = make(2, tolerance(2, 1e-7));
    integrator.start(&mut problem, 1.0, &[1.0, 0.0]).unwrap();
    let near = 1.0 + f64::EPSILON;
    assert_eq!(integrator.step(&mut problem, 1.0), Ok(Step::End { t: 1.0 }));
    assert_eq!(integrator.step(&mut problem, near), Ok(Step::End { t: near }));
    assert_eq!(integrator.y(), [1.0, 0.0]);
    assert_eq!(integrator.stats().steps, 0);
    // A few dozen roundings are a step.
    for k in [6.0, 20.0, 300.0] {
        let stop = integrator.t() + k * f64::EPSILON;
        run(&mut *integrator, &mut problem, stop).unwrap();
        assert_eq!(integrator.t(), stop);
    }
    run(&mut *integrator, &mut problem, 2.0).unwrap();
    assert_abs_diff_eq!(integrator.y()[0], 1f64.cos(), epsilon = 1e-5);

    for stop in [0.5, f64::NAN, f64::INFINITY] {
        let error = integrator.step(&mut problem, stop).unwrap_err();
        assert!(matches!(error, SolveError::InvalidStop { t: 2.0, .. }));
    }
    assert_eq!(integrator.t(), 2.0);
}

fn a_jump_of_the_rhs_at_a_stop_does_no_harm(make: Factory) {
    // ẏ = 0 up to 1, then 1; NaN would come from looking across.
    let mut problem = Problem::new(1, |t, _, dy| dy[0] = if t < 1.0 { 0.0 } else { 1.0 });
    let mut integrator = make(1, tolerance(1, 1e-9));
    integrator.start(&mut problem, 0.0, &[0.0]).unwrap();
    run(&mut *integrator, &mut problem, 1.0 - 1e-15).unwrap();
    assert_eq!(integrator.y()[0], 0.0);
    integrator.start(&mut problem, 1.0, &[0.0]).unwrap();
    run(&mut *integrator, &mut problem, 3.0).unwrap();
    assert_abs_diff_eq!(integrator.y()[0], 2.0, epsilon = 1e-12);
    assert_eq!(integrator.stats().restarts, 1);
    assert_eq!(integrator.stats().rejected, 0);
}

fn events_are_located_as_well_as_the_solution(make: Factory) {
    for rtol in [1e-5, 1e-8, 1e-11] {
        let mut problem = oscillator().events(2, |_, y, g| {
            g[0] = y[0];
            g[1] = y[1];
        });
        let mut integrator = make(2, tolerance(2, rtol));
        integrator.start(&mut problem, 0.0, &[1.0, 0.0]).unwrap();
        let events = run_events(&mut *integrator, &mut problem, 10.0).unwrap();
        // cos and -sin in turn, every quarter turn; the zero of -sin at the start is none.
        assert_eq!(events.len(), 6, "{events:?}");
        for (k, (t, index, rising)) in events.into_iter().enumerate() {
            let exact = std::f64::consts::FRAC_PI_2 * (k + 1) as f64;
            let error = (t - exact).abs();
            assert!(error < 1e3 * rtol, "{k}: {error:e}");
            assert_eq!(index, k % 2);
            assert_eq!(rising, matches!(k % 4, 1 | 2), "{k}");
        }
        assert_eq!(integrator.stats().events, 6);
    }
}

fn the_state_of_an_event_is_on_its_far_side(make: Factory) {
    let mut problem = oscillator().events(1, |_, y, g| g[0] = y[0] - 0.3);
    let mut integrator = make(2, tolerance(2, 1e-8));
    integrator.start(&mut problem, 0.0, &[1.0, 0.0]).unwrap();
    loop {
        match integrator.step(&mut problem, 10.0).unwrap() {
            Step::Advanced { .. } => {}
            Step::Event { t, rising, .. } => {
                assert_eq!(t, integrator.t());
                let g = integrator.y()[0] - 0.3;
                assert!(if rising { g >= 0.0 } else { g <= 0.0 });
                assert!(g.abs() < 1e-14);
            }
            Step::End { .. } => break,
        }
    }
    assert_eq!(integrator.stats().events, 3);
}

fn close_and_simultaneous_events_all_come(make: Factory) {
    let times = [0.5, 0.5, 0.5 + 1e-9, 0.500001, 0.7];
    let mut problem = Problem::new(1, |_, _, dy| dy[0] = 1.0).events(5, move |t, _, g| {
        for i in 0..5 {
            g[i] = if i == 1 { times[i] - t } else { t - times[i] };
        }
    });
    let mut integrator = make(1, tolerance(1, 1e-6));
    integrator.start(&mut problem, 0.0, &[0.0]).unwrap();
    let mut seen = Vec::new();
    loop {
        let before = integrator.t();
        match integrator.step(&mut problem, 2.0).unwrap() {
            Step::Advanced { .. } => {}
            Step::Event { t, index, rising } => {
                assert_eq!(rising, index != 1);
                assert_abs_diff_eq!(t, times[index], epsilon = 4e-16);
                assert_abs_diff_eq!(integrator.y()[0], t, epsilon = 1e-14);
                assert_eq!(integrator.events_waiting(), usize::from(index == 0));
                assert!(t >= before);
                seen.push(index);
            }
            Step::End { .. } => break,
        }
    }
    assert_eq!(seen, [0, 1, 2, 3, 4]);
}

fn none_of_many_events_is_lost(make: Factory) {
    // sin(w_i t + p_i), of half periods down to 0.6.
    let wave = |i: usize| (0.7 + 0.45 * i as f64, 0.1 + 0.37 * i as f64);
    let (count, t_end) = (11, 20.0);
    let mut problem = oscillator().events(count, move |t, _, g| {
        for (i, g) in g.iter_mut().enumerate() {
            let (w, p) = wave(i);
            *g = (w * t + p).sin();
        }
    });
    let mut integrator = make(2, tolerance(2, 1e-6));
    integrator.start(&mut problem, 0.0, &[1.0, 0.0]).unwrap();
    let events = run_events(&mut *integrator, &mut problem, t_end).unwrap();
    let mut expected = Vec::new();
    for i in 0..count {
        let (w, p) = wave(i);
        let times = (1..).map(|k| (std::f64::consts::PI * f64::from(k) - p) / w);
        expected.extend(times.take_while(|&t| t < t_end).filter(|&t| t > 0.0).map(|t| (t, i)));
    }
    expected.sort_by(|a, b| a.0.total_cmp(&b.0));
    assert_eq!(events.len(), expected.len());
    for (event, (t, index)) in events.into_iter().zip(expected) {
        assert_abs_diff_eq!(event.0, t, epsilon = 1e-13);
        assert_eq!(event.1, index);
    }
}

fn a_bump_within_one_step_is_seen(make: Factory) {
    let mut problem = Problem::new(1, |_, _, dy| dy[0] = 1.0).events(1, |t, _, g| g[0] = (t - 0.3) * (t - 0.6));
    let mut options = tolerance(1, 1e-6);
    options.h_first = Some(1.0);
    let mut integrator = make(1, options);
    integrator.start(&mut problem, 0.0, &[0.0]).unwrap();
    let events = run_events(&mut *integrator, &mut problem, 1.0).unwrap();
    assert_eq!(events.len(), 2, "{events:?}");
    assert_abs_diff_eq!(events[0].0, 0.3, epsilon = 1e-15);
    assert_abs_diff_eq!(events[1].0, 0.6, epsilon = 1e-15);
    assert!(!events[0].2 && events[1].2);
}

fn a_zero_at_the_start_is_no_event(make: Factory) {
    // Leaves zero, and comes back.
    let mut problem = ball();
    let mut integrator = make(2, tolerance(2, 1e-8));
    integrator.start(&mut problem, 0.0, &[0.0, 1.0]).unwrap();
    let events = run_events(&mut *integrator, &mut problem, 3.0).unwrap();
    assert_eq!(events.len(), 1);
    assert_abs_diff_eq!(events[0].0, 2.0, epsilon = 1e-7);
    // Stays zero for ever.
    let mut problem = oscillator().events(1, |_, _, g| g[0] = 0.0);
    integrator.start(&mut problem, 0.0, &[1.0, 0.0]).unwrap();
    run(&mut *integrator, &mut problem, 3.0).unwrap();
}

fn an_event_at_the_stop_comes_before_the_end(make: Factory) {
    let mut problem = Problem::new(1, |_, _, dy| dy[0] = 1.0).events(1, |t, _, g| g[0] = t - 1.0);
    let mut integrator = make(1, tolerance(1, 1e-6));
    integrator.start(&mut problem, 0.0, &[0.0]).unwrap();
    let events = run_events(&mut *integrator, &mut problem, 1.0).unwrap();
    assert_eq!(events, [(1.0, 0, true)]);
    run(&mut *integrator, &mut problem, 2.0).unwrap();
}

fn a_ball_bounces_until_it_rests(make: Factory) {
    // Speed falls by 0.8 a bounce: bounce k comes 2 · 0.8^(k-1) after the one before.
    let mut problem = ball();
    let mut integrator = make(2, tolerance(2, 1e-10));
    integrator.start(&mut problem, 0.0, &[0.0, 1.0]).unwrap();
    let (mut bounces, mut expected, mut flight) = (0, 0.0, 2.0);
    while bounces < 25 {
        match integrator.step(&mut problem, 20.0).unwrap() {
            Step::Advanced { .. } => {}
            Step::Event { t, rising, .. } => {
                assert!(!rising);
                expected += flight;
                flight *= 0.8;
                bounces += 1;
                assert_abs_diff_eq!(t, expected, epsilon = 1e-6);
                let y = [integrator.y()[0], -0.8 * integrator.y()[1]];
                integrator.start(&mut problem, t, &y).unwrap();
            }
            Step::End { t } => panic!("fell through the floor, {bounces} bounces, {t}"),
        }
    }
    assert_eq!(integrator.stats().restarts, 25);
}

fn after_an_event_the_stop_may_come_nearer(make: Factory) {
    let mut problem = oscillator().events(1, |t, _, g| g[0] = t - 1e-3);
    let mut options = tolerance(2, 1e-4);
    options.h_first = Some(0.02);
    let mut integrator = make(2, options);
    integrator.start(&mut problem, 0.0, &[1.0, 0.0]).unwrap();
    let step = integrator.step(&mut problem, 1.0).unwrap();
    assert!(matches!(step, Step::Event { .. }), "{step:?}");
    assert_eq!(integrator.t_previous(), 0.0);
    let step = integrator.step(&mut problem, 2e-3).unwrap();
    assert_eq!(step, Step::End { t: 2e-3 });
    assert_abs_diff_eq!(integrator.y()[1], -(2e-3f64.sin()), epsilon = 1e-5);
    run(&mut *integrator, &mut problem, 1.0).unwrap();
    assert_abs_diff_eq!(integrator.y()[0], 1f64.cos(), epsilon = 1e-2);
}

fn a_step_out_of_the_domain_is_tried_again_smaller(make: Factory) {
    for nan in [true, false] {
        // y stays positive, trial states of long steps do not.
        let mut problem = Problem::fallible(1, move |_, y, dy| {
            if y[0] < 0.0 {
                dy[0] = f64::NAN;
                return if nan { Ok(()) } else { Err(EvalFailure::Recoverable) };
            }
            dy[0] = -10.0 * y[0];
            Ok(())
        });
        let mut options = Options::new(1e-6, vec![1e-12]);
        options.h_first = Some(1.0);
        let mut integrator = make(1, options);
        integrator.start(&mut problem, 0.0, &[1.0]).unwrap();
        run(&mut *integrator, &mut problem, 1.0).unwrap();
        assert_abs_diff_eq!(integrator.y()[0], (-10f64).exp(), epsilon = 1e-8);
        assert!(integrator.stats().rejected > 0);
    }
}

fn a_wall_of_nan_is_an_error_with_the_last_good_state(make: Factory) {
    let mut problem = Problem::new(2, |t, _, dy| {
        dy[0] = 1.0;
        dy[1] = if t > 0.5 { f64::NAN } else { 2.0 };
    });
    let mut integrator = make(2, tolerance(2, 1e-6));
    integrator.start(&mut problem, 0.0, &[0.0, 0.0]).unwrap();
    let error = run(&mut *integrator, &mut problem, 1.0).unwrap_err();
    let SolveError::NotFinite { function: Function::Rhs, t, component } = &error else {
        panic!("{error}");
    };
    assert!(*t > 0.5 && *t < 0.50001, "{t}");
    assert_eq!(component, "x1");
    assert!(error.to_string().ends_with("s is not finite: `x1`"));
    assert!(integrator.t() <= 0.5 && integrator.t() > 0.49);
    assert_abs_diff_eq!(integrator.y()[0], integrator.t(), epsilon = 1e-6);
    assert_eq!(integrator.stats().rhs, problem.rhs_calls);
    // A restart goes on.
    let mut problem = oscillator();
    integrator.start(&mut problem, 0.0, &[1.0, 0.0]).unwrap();
    run(&mut *integrator, &mut problem, 1.0).unwrap();
}

fn nan_at_the_start_is_an_error(make: Factory) {
    let mut problem = Problem::new(1, |_, _, dy| dy[0] = f64::NAN);
    let mut integrator = make(1, tolerance(1, 1e-6));
    let error = integrator
        .start(&mut problem, 0.0, &[1.0])
        .and_then(|()| run(&mut *integrator, &mut problem, 1.0))
        .unwrap_err();
    assert!(matches!(error, SolveError::NotFinite { t: 0.0, .. }));
    assert_eq!((integrator.t(), integrator.y()), (0.0, &[1.0][..]));

    let error = integrator.start(&mut problem, 0.0, &[f64::INFINITY]);
    let message = error.unwrap_err().to_string();
    assert_eq!(message, "cannot start at t = 0 s: `x0` is inf");
}

fn a_fatal_failure_ends_the_run(make: Factory) {
    let mut problem = Problem::fallible(1, |t, _, dy| {
        dy[0] = 1.0;
        if t > 0.25 { Err(EvalFailure::Fatal) } else { Ok(()) }
    });
    let mut integrator = make(1, tolerance(1, 1e-6));
    integrator.start(&mut problem, 0.0, &[0.0]).unwrap();
    let error = run(&mut *integrator, &mut problem, 1.0).unwrap_err();
    let calls_beyond = problem.rhs_calls;
    assert!(matches!(
        error,
        SolveError::EvaluationFailed { function: Function::Rhs, t } if t > 0.25
    ));
    assert_eq!(integrator.stats().rhs, calls_beyond);
    assert_abs_diff_eq!(integrator.y()[0], integrator.t(), epsilon = 1e-9);
}

fn an_event_function_that_is_nan_is_named(make: Factory) {
    let mut problem = oscillator().events(2, |t, _, g| {
        g[0] = 1.0;
        g[1] = if t > 0.5 { f64::NAN } else { 1.0 };
    });
    let mut integrator = make(2, tolerance(2, 1e-6));
    integrator.start(&mut problem, 0.0, &[1.0, 0.0]).unwrap();
    let error = run(&mut *integrator, &mut problem, 1.0).unwrap_err();
    let message = error.to_string();
    assert!(message.starts_with("event functions at t = 0."), "{message}");
    assert!(message.ends_with("`event[1]`"), "{message}");
}

fn a_singularity_makes_the_step_too_small(make: Factory) {
    // y = 1 / (1 - t)
    let mut problem = Problem::new(2, |_, y, dy| {
        dy[0] = 0.0;
        dy[1] = y[1] * y[1];
    });
    let mut integrator = make(2, tolerance(2, 1e-8));
    integrator.start(&mut problem, 0.0, &[0.0, 1.0]).unwrap();
    let error = run(&mut *integrator, &mut problem, 2.0).unwrap_err();
    match &error {
        SolveError::StepTooSmall { t, worst, .. } => {
            assert_abs_diff_eq!(*t, 1.0, epsilon = 1e-5);
            assert_eq!(worst, "x1");
        }
        SolveError::NotFinite { .. } | SolveError::NonlinearFailed { .. } => {}
        _ => panic!("{error}"),
    }
    assert_abs_diff_eq!(integrator.t(), 1.0, epsilon = 1e-5);
    assert!(integrator.y()[1] > 1e4);
}

fn too_many_steps_is_an_error_at_the_last_of_them(make: Factory) {
    let mut problem = oscillator();
    let mut options = tolerance(2, 1e-8);
    options.max_steps = 7;
    options.h_max = 0.1;
    let mut integrator = make(2, options);
    integrator.start(&mut problem, 0.0, &[1.0, 0.0]).unwrap();
    let error = run(&mut *integrator, &mut problem, 5.0).unwrap_err();
    let t = integrator.t();
    assert_eq!(error, SolveError::TooManySteps { t, steps: 7 });
    assert_eq!(integrator.stats().steps, 7);
    assert_abs_diff_eq!(integrator.y()[0], t.cos(), epsilon = 1e-6);
}

fn the_longest_step_is_kept_and_can_change(make: Factory) {
    let mut problem = oscillator();
    let mut options = tolerance(2, 1e-3);
    options.h_max = 0.05;
    let mut integrator = make(2, options);
    integrator.start(&mut problem, 0.0, &[1.0, 0.0]).unwrap();
    let mut longest = |integrator: &mut dyn Integrator, t_stop| {
        let mut longest = 0f64;
        while integrator.t() < t_stop {
            integrator.step(&mut problem, t_stop).unwrap();
            longest = longest.max(integrator.t() - integrator.t_previous());
        }
        longest
    };
    for (h_max, t_stop) in [(0.05, 2.0), (0.2, 6.0), (0.01, 6.5)] {
        integrator.set_h_max(h_max);
        let longest = longest(&mut *integrator, t_stop);
        assert!(longest <= h_max + 1e-12, "{longest} > {h_max}");
        assert!(longest > 0.7 * h_max, "{longest} of {h_max}");
    }
}

fn statistics_agree_with_the_calls(make: Factory) {
    let mut problem = oscillator().events(1, |_, y, g| g[0] = y[0]);
    let mut integrator = make(2, tolerance(2, 1e-7));
    let mut pieces = 0;
    for restart in 0..3 {
        let t = f64::from(restart);
        integrator.start(&mut problem, t, &[t.cos(), -t.sin()]).unwrap();
        loop {
            match integrator.step(&mut problem, t + 1.0).unwrap() {
                Step::Event { .. } => {}
                Step::Advanced { .. } => pieces += 1,
                Step::End { .. } => {
                    pieces += 1;
                    break;
                }
            }
        }
    }
    let stats = integrator.stats();
    assert_eq!(stats.steps, pieces);
    assert_eq!(stats.rhs, problem.rhs_calls);
    assert_eq!(stats.event_evaluations, problem.event_calls);
    assert_eq!(stats.jacobians, problem.jacobian_calls);
    assert_eq!(stats.events, 1);
    assert_eq!(stats.restarts, 2);
    assert_eq!(stats.projections, 0);
    let implicit = Method::parse(integrator.name()).unwrap().is_implicit();
    assert_eq!(stats.jacobians > 0, implicit);
    assert_eq!(stats.factorizations > 0, implicit);
}

fn a_problem_without_components_only_lets_time_pass(make: Factory) {
    let mut problem = Problem::new(0, |_, _, _| {}).events(1, |t, _, g| g[0] = t - 0.25);
    let mut integrator = make(0, tolerance(0, 1e-6));
    integrator.start(&mut problem, 0.0, &[]).unwrap();
    let events = run_events(&mut *integrator, &mut problem, 1.0).unwrap();
    assert_eq!(events.len(), 1);
    assert_abs_diff_eq!(events[0].0, 0.25, epsilon = 1e-15);
    assert_eq!(integrator.t(), 1.0);
}

fn a_panic_in_the_problem_comes_through(make: Factory) {
    let outcome = std::panic::catch_unwind(|| {
        let mut problem = Problem::new(1, |t, _, dy| {
            dy[0] = 1.0;
            if t > 0.1 {
                std::panic::panic_any("from inside");
            }
        });
        let mut integrator = make(1, tolerance(1, 1e-6));
        integrator.start(&mut problem, 0.0, &[0.0]).unwrap();
        run(&mut *integrator, &mut problem, 1.0)
    });
    let payload = outcome.unwrap_err();
    assert_eq!(*payload.downcast::<&str>().unwrap(), "from inside");
}

fn tight_tolerances_work(make: Factory) {
    let mut problem = oscillator();
    let mut integrator = make(2, Options::new(1e-14, vec![1e-14; 2]));
    integrator.start(&mut problem, 0.0, &[1.0, 0.0]).unwrap();
    run(&mut *integrator, &mut problem, 1.0).unwrap();
    assert_abs_diff_eq!(integrator.y()[0], 1f64.cos(), epsilon = 1e-12);
}

fn an_integrator_can_move_to_another_thread(make: Factory) {
    let mut integrator = make(2, tolerance(2, 1e-7));
    integrator.start(&mut oscillator(), 0.0, &[1.0, 0.0]).unwrap();
    let integrator = std::thread::spawn(move || {
        run(&mut *integrator, &mut oscillator(), 1.0).unwrap();
        integrator
    });
    assert_eq!(integrator.join().unwrap().t(), 1.0);
}

macro_rules! integrator_tests {
    ($module:ident, $method:expr; $($test:ident),* $(,)?) => {
        mod $module {
            use super::*;

            fn make(n: usize, options: Options) -> Box<dyn Integrator> {
                let made = $method.create(n, options).unwrap();
                assert_eq!(made.name(), $method.name());
                made
            }
            $(
                #[test]
                fn $test() {
                    super::$test(make);
                }
            )*
        }
    };
    ($($module:ident: $method:expr;)*) => {
        $(integrator_tests!($module, $method;
            error_follows_the_tolerance,
            dense_output_is_as_good_as_the_steps,
            stops_are_exact_and_nothing_is_evaluated_beyond,
            a_stop_within_rounding_is_reached_at_once,
            a_jump_of_the_rhs_at_a_stop_does_no_harm,
            events_are_located_as_well_as_the_solution,
            the_state_of_an_event_is_on_its_far_side,
            close_and_simultaneous_events_all_come,
            none_of_many_events_is_lost,
            a_bump_within_one_step_is_seen,
            a_zero_at_the_start_is_no_event,
            an_event_at_the_stop_comes_before_the_end,
            a_ball_bounces_until_it_rests,
            after_an_event_the_stop_may_come_nearer,
            a_step_out_of_the_domain_is_tried_again_smaller,
            a_wall_of_nan_is_an_error_with_the_last_good_state,
            nan_at_the_start_is_an_error,
            a_fatal_failure_ends_the_run,
            an_event_function_that_is_nan_is_named,
            a_singularity_makes_the_step_too_small,
            too_many_steps_is_an_error_at_the_last_of_them,
            the_longest_step_is_kept_and_can_change,
            statistics_agree_with_the_calls,
            a_problem_without_components_only_lets_time_pass,
            a_panic_in_the_problem_comes_through,
            tight_tolerances_work,
            an_integrator_can_move_to_another_thread,
        );)*
    };
}

integrator_tests! {
    dop853: Method::Dop853;
}
#[cfg(feature = "cvode")]
integrator_tests! {
    cvode_bdf: Method::CvodeBdf;
    cvode_adams: Method::CvodeAdams;
}

#[test]
fn invalid_options_name_the_field_the_value_and_what_would_do() {
    type Change = fn(&mut Options);
    let create = |change: Change| {
        let mut options = tolerance(2, 1e-6);
        change(&mut options);
        let made = Method::Dop853.create(2, options);
        made.err().unwrap().to_string()
    };
    let cases: [(Change, &str); 7] = [
        (|o| o.rtol = 1e-16, "option rtol is 1e-16; expected from 2.3e-15 to below 1"),
        (|o| o.rtol = f64::NAN, "option rtol is NaN; expected from 2.3e-15 to below 1"),
        (|o| o.atol.truncate(1), "option atol is 1 values; expected one for each of 2 components"),
        (|o| o.atol[1] = 0.0, "option atol[1] is 0e0; expected positive, finite"),
        (|o| o.h_first = Some(-1.0), "option h_first is -1e0; expected positive, finite"),
        (|o| o.h_max = 0.0, "option h_max is 0e0; expected positive"),
        (|o| o.h_max = f64::NAN, "option h_max is NaN; expected positive"),
    ];
    for (change, message) in cases {
        assert_eq!(create(change), message);
    }
}

#[test]
#[cfg(feature = "cvode")]
fn options_of_the_multistep_methods_are_checked() {
    let mut options = tolerance(1, 1e-6);
    options.max_order = Some(6);
    let message = Method::CvodeBdf.create(1, options.clone()).err().unwrap();
    let expected = "option max_order is 6; expected from 1 to 5";
    assert_eq!(message.to_string(), expected);
    assert!(Method::CvodeAdams.create(1, options).is_ok());

    let mut options = tolerance(2, 1e-8);
    options.max_order = Some(2);
    options.stability_limit_detection = true;
    let mut integrator = Method::CvodeBdf.create(2, options).unwrap();
    let mut problem = oscillator();
    integrator.start(&mut problem, 0.0, &[1.0, 0.0]).unwrap();
    while let Step::Advanced { order, .. } = integrator.step(&mut problem, 1.0).unwrap() {
        assert!(order <= 2);
    }
}

/// The C library writes past the capture of the test harness, so the failing tests run in a process
/// of their own.
#[test]
#[cfg(feature = "cvode")]
fn failures_print_nothing() {
    for test in [
        "a_wall_of_nan_is_an_error_with_the_last_good_state",
        "a_singularity_makes_the_step_too_small",
        "a_fatal_failure_ends_the_run",
        "nan_at_the_start_is_an_error",
    ] {
        for module in ["cvode_bdf", "cvode_adams"] {
            let output = std::process::Command::new(std::env::current_exe().unwrap())
                .args(["--exact", "--test-threads=1", "--nocapture"])
                .arg(format!("{module}::{test}"))
                .output()
                .unwrap();
            assert!(output.status.success());
            assert_eq!(String::from_utf8(output.stderr).unwrap(), "");
            let stdout = String::from_utf8(output.stdout).unwrap();
            assert!(stdout.contains("1 passed"), "{stdout}");
            assert!(!stdout.contains("CVODE") && !stdout.contains(".c:"), "{stdout}");
        }
    }
}
