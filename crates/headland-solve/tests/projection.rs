//! The pendulum in Cartesian coordinates, index reduced to 1, with and without projection.

mod common;

use common::{Problem, run, tolerance};
use headland_solve::{EvalFailure, Integrator, Method, Options, SolveError, Stats};

const G: f64 = 9.81;

/// `x² + y² = 1`, `x ẋ + y ẏ = 0`.
fn pendulum() -> Problem {
    Problem::new(4, |_, s, ds| {
        let [x, y, u, v] = s.try_into().unwrap();
        let lambda = (u * u + v * v - G * y) / (x * x + y * y);
        ds.copy_from_slice(&[u, v, -lambda * x, -lambda * y - G]);
    })
    .jacobian(|_, s, j| {
        let [x, y, u, v] = s.try_into().unwrap();
        let r2: f64 = x * x + y * y;
        let lambda = (u * u + v * v - G * y) / r2;
        let d = [-2.0 * lambda * x / r2, (-G - 2.0 * lambda * y) / r2, 2.0 * u / r2, 2.0 * v / r2];
        for c in 0..4 {
            j[4 * c] = f64::from(u8::from(c == 2));
            j[4 * c + 1] = f64::from(u8::from(c == 3));
            j[4 * c + 2] = -d[c] * x - if c == 0 { lambda } else { 0.0 };
            j[4 * c + 3] = -d[c] * y - if c == 1 { lambda } else { 0.0 };
        }
    })
}

/// Nearest point of the circle, and the velocity along it.
fn with_projection() -> Problem {
    pendulum().projection(|_, s, correction| {
        let [x, y, u, v] = s.try_into().unwrap();
        let r = f64::hypot(x, y);
        let (a, b) = (x / r, y / r);
        let radial = a * u + b * v;
        correction.copy_from_slice(&[a - x, b - y, -radial * a, -radial * b]);
        Ok(())
    })
}

/// Largest errors of position and energy over 100 s from the horizontal.
fn drift(method: Method, problem: &mut Problem, rtol: f64) -> (f64, f64, Stats) {
    let mut integrator: Box<dyn Integrator> = method.create(4, Options::new(rtol, vec![1e-2 * rtol; 4])).unwrap();
    integrator.start(problem, 0.0, &[1.0, 0.0, 0.0, 0.0]).unwrap();
    let (mut position, mut energy) = (0f64, 0f64);
    while integrator.t() < 100.0 {
        integrator.step(problem, 100.0).unwrap();
        let [x, y, u, v] = integrator.y().try_into().unwrap();
        position = position.max((f64::hypot(x, y) - 1.0).abs());
        energy = energy.max((0.5 * (u * u + v * v) + G * y).abs());
    }
    assert_eq!(integrator.stats().projections, problem.projection_calls);
    (position, energy, *integrator.stats())
}

#[test]
#[cfg(feature = "cvode")]
fn projection_keeps_bdf_on_the_circle() {
    let (free, free_energy, _) = drift(Method::CvodeBdf, &mut pendulum(), 1e-6);
    let (kept, energy, stats) = drift(Method::CvodeBdf, &mut with_projection(), 1e-6);
    println!("free {free:.1e} {free_energy:.1e}, projected {kept:.1e} {energy:.1e}, {stats:?}");
    assert!(free > 1e-4, "{free:e}");
    assert!(kept < 1e-6, "{kept:e}");
    assert!(energy < 0.3 * free_energy, "{energy:e}");
    assert!(stats.projections >= stats.steps);
}

#[test]
fn projection_keeps_the_explicit_method_on_the_circle() {
    let (free, free_energy, _) = drift(Method::Dop853, &mut pendulum(), 1e-6);
    let (kept, energy, stats) = drift(Method::Dop853, &mut with_projection(), 1e-6);
    println!("free {free:.1e} {free_energy:.1e}, projected {kept:.1e} {energy:.1e}, {stats:?}");
    assert!(free > 1e-6, "{free:e}");
    assert!(kept < 1e-15, "{kept:e}");
    assert!(energy < free_energy, "{energy:e}");
    assert_eq!(stats.projections, stats.steps);
}

#[test]
#[cfg(feature = "cvode")]
fn adams_says_that_it_cannot_project() {
    let mut integrator = Method::CvodeAdams.create(4, tolerance(4, 1e-6)).unwrap();
    let error = integrator.start(&mut with_projection(), 0.0, &[1.0, 0.0, 0.0, 0.0]).unwrap_err();
    let message = "method cvode-adams cannot project onto constraints; cvode-bdf and dop853 can";
    assert_eq!(error.to_string(), message);
}

#[test]
fn a_projection_that_fails_for_good_is_an_error() {
    for name in ["dop853", "cvode-bdf"] {
        let Some(method) = Method::parse(name).ok().filter(|m| m.is_built()) else {
            continue;
        };
        let mut problem = pendulum().projection(|_, _, _| Err(EvalFailure::Fatal));
        let mut integrator = method.create(4, tolerance(4, 1e-6)).unwrap();
        integrator.start(&mut problem, 0.0, &[1.0, 0.0, 0.0, 0.0]).unwrap();
        let error = run(&mut *integrator, &mut problem, 1.0).unwrap_err();
        assert!(matches!(error, SolveError::EvaluationFailed { .. }));
        let message = error.to_string();
        assert!(message.starts_with("projection onto the constraints could not be evaluated"), "{message}");
        assert_eq!(integrator.y(), [1.0, 0.0, 0.0, 0.0]);
    }
}
