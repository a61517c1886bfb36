//! Smooth problems with known solutions, and the work that they take.

mod common;

use common::{Problem, digits, run};
use headland_solve::{Method, OdeProblem, Options, Stats};

fn solve(method: Method, problem: &mut dyn OdeProblem, y0: &[f64], t_end: f64, rtol: f64) -> (Vec<f64>, Stats) {
    let options = Options::new(rtol, vec![rtol; y0.len()]);
    let mut integrator = method.create(y0.len(), options).unwrap();
    integrator.start(problem, 0.0, y0).unwrap();
    run(&mut *integrator, problem, t_end).unwrap();
    assert!(!integrator.looks_stiff());
    (integrator.y().to_vec(), *integrator.stats())
}

/// The restricted three-body problem of Earth, Moon and a satellite.
fn arenstorf() -> Problem {
    Problem::new(4, |_, y, dy| {
        const MU: f64 = 0.012277471;
        const NU: f64 = 1.0 - MU;
        let d1 = ((y[0] + MU).powi(2) + y[1] * y[1]).powf(1.5);
        let d2 = ((y[0] - NU).powi(2) + y[1] * y[1]).powf(1.5);
        dy[0] = y[2];
        dy[1] = y[3];
        dy[2] = y[0] + 2.0 * y[3] - NU * (y[0] + MU) / d1 - MU * (y[0] - NU) / d2;
        dy[3] = y[1] - 2.0 * y[2] - NU * y[1] / d1 - MU * y[1] / d2;
    })
}

/// Kepler's problem with eccentricity `e`, from the pericentre; period 2π.
fn kepler(e: f64) -> (Problem, [f64; 4]) {
    let problem = Problem::new(4, |_, y, dy| {
        let r3 = (y[0] * y[0] + y[1] * y[1]).powf(1.5);
        dy[0] = y[2];
        dy[1] = y[3];
        dy[2] = -y[0] / r3;
        dy[3] = -y[1] / r3;
    });
    let v = ((1.0 + e) / (1.0 - e)).sqrt();
    (problem, [1.0 - e, 0.0, 0.0, v])
}

#[test]
fn arenstorf_orbit_closes() {
    // Hairer, Nørsett, Wanner I, eq. II.0.2.
    let y0 = [0.994, 0.0, 0.0, -2.0015851063790824];
    let period = 17.065216560157964;
    let mut steps = Vec::new();
    for (rtol, least) in [(1e-7, 1.5), (1e-10, 4.5), (1e-13, 7.5)] {
        let (y, stats) = solve(Method::Dop853, &mut arenstorf(), &y0, period, rtol);
        let found = digits(&y, &y0, 1.0);
        println!("rtol {rtol:e}: {found:.2} digits, {stats:?}");
        assert!(found > least, "rtol {rtol:e}: {found:.2} digits");
        steps.push(stats.steps);
    }
    // Order 8: a thousandth of the tolerance takes 10^(3/8) = 2.4 times the steps.
    assert!(steps[2] < 3 * steps[1], "{steps:?}");
    assert!((50..130).contains(&steps[0]), "{steps:?}");
}

#[test]
fn kepler_orbits_close() {
    for (e, least) in [(0.1, 9.5), (0.5, 9.0), (0.9, 7.0)] {
        let (mut problem, y0) = kepler(e);
        let period = 2.0 * std::f64::consts::PI;
        let (y, stats) = solve(Method::Dop853, &mut problem, &y0, 3.0 * period, 1e-12);
        let found = digits(&y, &y0, 1.0);
        println!("e {e}: {found:.2} digits, {stats:?}");
        assert!(found > least, "e {e}: {found:.2} digits");
        assert_eq!(stats.rhs, 2 + 12 * stats.steps + 11 * stats.rejected);
    }
}

#[test]
fn half_an_orbit_ends_at_the_apocentre() {
    let (mut problem, y0) = kepler(0.6);
    let half = std::f64::consts::PI;
    let expected = [-1.6, 0.0, 0.0, -0.5];
    for method in Method::ALL.into_iter().filter(|m| m.is_built() && !m.is_dae()) {
        let name = method.name();
        let (y, stats) = solve(method, &mut problem, &y0, half, 1e-10);
        let found = digits(&y, &expected, 1.0);
        println!("{name}: {found:.2} digits, {stats:?}");
        assert!(found > 6.5, "{name}: {found:.2} digits");
    }
}

#[test]
fn a_closed_form_in_twenty_components() {
    // y_i = sin(t + i), in equations that are not linear.
    let n = 20;
    let mut problem = Problem::new(n, move |t, y, dy| {
        for i in 0..n {
            let target = (t + i as f64).sin();
            dy[i] = (t + i as f64).cos() * (1.0 + y[i] * y[i] - target * target);
        }
    });
    let y0: Vec<f64> = (0..n).map(|i| (i as f64).sin()).collect();
    let expected: Vec<f64> = (0..n).map(|i| (3.0 + i as f64).sin()).collect();
    for (rtol, least) in [(1e-6, 5.0), (1e-9, 8.0), (1e-12, 11.0)] {
        let (y, _) = solve(Method::Dop853, &mut problem, &y0, 3.0, rtol);
        let found = digits(&y, &expected, 1.0);
        assert!(found > least, "rtol {rtol:e}: {found:.2} digits");
    }
}
