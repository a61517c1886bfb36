use std::time::Instant;

use super::*;
use crate::expr::Expr;
use crate::scalar::Scalar;
use crate::spline::Spline;

fn n<'g>(x: f64) -> Expr<'g> {
    Expr::Const(x)
}

/// The timeline of one function of time over `[0, end]`; it must not take long.
fn of(end: f64, f: impl for<'g> Fn(Expr<'g>) -> Expr<'g>) -> Timeline {
    let graph = Graph::new();
    let root = graph.id(f(graph.input("t")));
    let clock = Instant::now();
    let found = timeline(&graph, &[root], 0, &[0.0], |_| false, 0.0, end);
    println!("{:?}: {} breakpoints, {:?}", clock.elapsed(), found.breakpoints.len(), found.windows);
    assert!(found.windows.len() < 60, "{} windows", found.windows.len());
    found
}

#[track_caller]
fn close(found: &[f64], exact: &[f64], tolerance: f64) {
    assert_eq!(found.len(), exact.len(), "{found:?}");
    for (a, b) in found.iter().zip(exact) {
        assert!((a - b).abs() <= tolerance, "{a} is not {b}");
    }
}

#[test]
fn rectangular_pulse_has_two_breakpoints() {
    let found = of(100.0, |t| Expr::select(t - n(1.0), Expr::select(n(1.005) - t, n(1.0), n(0.0)), n(0.0)));
    assert_eq!(found.breakpoints, [1.0, 1.005]);
    assert!(found.windows.is_empty());
}

#[test]
fn smooth_step_pulse_is_a_window_between_breakpoints() {
    let found = of(100.0, |t| {
        let x = ((t - n(1.0)) / n(0.005)).max(n(0.0)).min(n(1.0));
        x.powi(2) * (n(3.0) - n(2.0) * x) * (n(1.0) - x)
    });
    close(&found.breakpoints, &[1.0, 1.005], 1e-15);
    let [window] = found.windows[..] else { panic!("{:?}", found.windows) };
    assert!((window.start - 1.0).abs() < 1e-3 && (window.end - 1.005).abs() < 1e-3 && window.stop);
    assert!(window.longest_step < 0.0025 && window.longest_step > 0.0002, "{window:?}");
}

#[test]
fn narrow_gaussian_pulse_is_a_window() {
    let found = of(100.0, |t| (-((t - n(50.0)) / n(0.002)).powi(2)).exp());
    assert!(found.breakpoints.is_empty());
    let [window] = found.windows[..] else { panic!("{:?}", found.windows) };
    assert!(window.start > 49.9 && window.start < 49.996 && window.end < 50.1 && window.end > 50.004 && window.stop);
    assert!(window.longest_step > 3e-4 && window.longest_step < 2e-3, "{window:?}");
}

#[test]
fn slow_functions_have_no_windows() {
    let step = of(15.0, |t| n(0.015) * (n(1.0) + (t - n(3.0)).tanh()));
    assert_eq!(step, Timeline::default());
    let sine = of(15.0, |t| (n(std::f64::consts::TAU / 5.0) * t).sin());
    assert_eq!(sine, Timeline::default());
    assert_eq!(of(10.0, |_| n(2.0)), Timeline::default());
    assert_eq!(of(10.0, |t| n(2.0) * t + n(1.0)), Timeline::default());
    assert_eq!(of(10.0, |t| t.sin().powi(2) + (n(2.0) * t).cos() * n(0.5)), Timeline::default());
}

#[test]
fn many_periods_are_a_cap_without_stops() {
    let sine = of(1000.0, |t| (n(std::f64::consts::TAU / 5.0) * t).sin());
    let [cap] = sine.windows[..] else { panic!("{:?}", sine.windows) };
    assert!(!cap.stop && cap.start < 5.0 && cap.end > 995.0);
    assert!(cap.longest_step > 5.0 / 8.0 && cap.longest_step < 5.0 / 4.0, "{cap:?}");
    let fast = of(100.0, |t| (n(1e6) * t).sin());
    assert!(fast.windows.iter().all(|w| w.longest_step > 1e-7));
}

#[test]
fn periodic_switching() {
    use std::f64::consts::PI;
    let found = of(100.0, |t| Expr::select((n(10.0) * t).sin(), n(1.0), n(0.0)));
    let exact: Vec<f64> = (0..=318).map(|k| f64::from(k) * PI / 10.0).collect();
    close(&found.breakpoints, &exact, 3e-14);
    assert!(found.windows.is_empty());
    let found = of(10.0, |t| t.sin().abs());
    close(&found.breakpoints, &[0.0, PI, 2.0 * PI, 3.0 * PI], 4e-15);
    let too_many = of(100.0, |t| (n(1e6) * t).sin().sign());
    assert!(too_many.breakpoints.len() > 1000);
    assert!(too_many.windows.iter().any(|w| w.end == 100.0 && w.longest_step < 1e-5));
}

#[test]
fn knots_of_a_table() {
    let x: Vec<f64> = (0..50).map(|i| 0.2 * f64::from(i)).collect();
    let y: Vec<f64> = x.iter().map(|x| (3.0 * x).sin()).collect();
    let table = Spline::new("road", &x, &y).unwrap();
    close(&of(20.0, |t| t.spline(&table, 0)).breakpoints, &x, 4e-15);
    let scaled: Vec<f64> = x.iter().map(|x| x / 2.0 + 1.0).collect();
    close(&of(20.0, |t| (n(2.0) * t - n(2.0)).spline(&table, 1)).breakpoints, &scaled, 1e-14);
}

#[test]
fn touches_and_poles_end() {
    close(&of(10.0, |t| (t - n(2.0)).powi(2).abs()).breakpoints, &[2.0], 1e-15);
    close(&of(10.0, |t| (t.cos() - n(1.0)).sign() * t).breakpoints, &[0.0, std::f64::consts::TAU], 1e-7);
    let pole = of(10.0, |t| n(1.0) / (t - n(2.0)));
    assert!(pole.windows.len() < 40);
    close(&of(10.0, |t| Expr::select(n(1.0) / (t - n(2.0)), n(0.0), n(1.0))).breakpoints, &[2.0], 1e-14);
    let rest = of(10.0, |t| Expr::select((t - n(3.0)).max(n(0.0)), n(1.0), t));
    assert!(rest.breakpoints.contains(&3.0), "{:?}", rest.breakpoints);
}

#[test]
fn conditions_of_time_before_functions_of_states() {
    let graph = Graph::new();
    let (q, t, p) = (graph.input("q"), graph.input("t"), graph.input("p"));
    let e = Expr::select(t - p, q.sin() * (n(1000.0) * (t - n(7.0))).tanh(), q) + (q - t).abs();
    let found = timeline(&graph, &[graph.id(e)], 1, &[0.0, 0.0, 4.5], |i| i == 0, 0.0, 10.0);
    assert_eq!(found.breakpoints, [4.5]);
    let [window] = found.windows[..] else { panic!("{:?}", found.windows) };
    assert!(window.start > 6.9 && window.end < 7.1 && window.longest_step < 2e-3);
    let angle = graph.id(t.sin().atan2(t.cos()) * q);
    let found = timeline(&graph, &[angle], 1, &[0.0; 3], |i| i == 0, 0.0, 10.0);
    close(&found.breakpoints, &[std::f64::consts::PI, 3.0 * std::f64::consts::PI], 4e-15);
    let still = timeline(&graph, &[graph.id(q.abs())], 1, &[0.0; 3], |i| i == 0, 0.0, 10.0);
    assert_eq!(still, Timeline::default());
}
