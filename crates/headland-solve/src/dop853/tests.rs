//! The coefficients against the conditions of order, and the method against its orders.

use super::*;
use crate::driver::Driver;
use crate::{Integrator, Step};

const ROWS: [&[(usize, f64)]; 16] =
    [&[], &A1, &A2, &A3, &A4, &A5, &A6, &A7, &A8, &A9, &A10, &A11, &B, &A13, &A14, &A15];

fn sum(row: &[(usize, f64)], value: impl Fn(usize) -> f64) -> f64 {
    row.iter().map(|&(j, a)| a * value(j)).sum()
}

/// Largest intermediate term: what rounding is relative to.
fn size(row: &[(usize, f64)], value: impl Fn(usize) -> f64) -> f64 {
    row.iter().map(|&(j, a)| (a * value(j)).abs()).sum()
}

#[test]
fn every_row_sums_to_its_node() {
    for (row, c) in ROWS.into_iter().zip(C) {
        let error = (sum(row, |_| 1.0) - c).abs();
        assert!(error <= 1e-15 * size(row, |_| 1.0).max(1.0), "{c}: {error}");
    }
}

#[test]
fn weights_meet_the_conditions_of_tall_and_bushy_trees() {
    for q in 0..8 {
        let moment = sum(&B, |j| C[j].powi(q));
        let exact = 1.0 / f64::from(q + 1);
        assert!((moment - exact).abs() < 4e-15, "Σ b c^{q} = {moment}");
    }
    // Σ_i b_i (A^m 1)_i = 1 / (m + 1)!
    let mut chain = [1.0; 16];
    let mut factorial = 1.0;
    for m in 1..8 {
        let previous = chain;
        for (s, row) in ROWS.into_iter().enumerate() {
            chain[s] = sum(row, |j| previous[j]);
        }
        factorial *= f64::from(m + 1);
        let tall = sum(&B, |j| chain[j]);
        assert!((tall * factorial - 1.0).abs() < 1e-12, "m = {m}: {}", tall * factorial);
    }
    // Σ_i b_i c_i^p (Σ_j a_ij c_j^q) = 1 / ((p + q + 2) (q + 1))
    for p in 0..6 {
        for q in 0..(6 - p) {
            let inner = |i: usize| sum(ROWS[i], |j| C[j].powi(q));
            let value = sum(&B, |i| C[i].powi(p) * inner(i));
            let exact = 1.0 / (f64::from(p + q + 2) * f64::from(q + 1));
            assert!((value / exact - 1.0).abs() < 1e-12, "{p} {q}: {value}");
        }
    }
}

#[test]
fn embedded_formulas_have_their_orders() {
    for q in 0..5 {
        let difference = sum(&E5, |j| C[j].powi(q));
        assert!(difference.abs() < 1e-14, "order 5, c^{q}: {difference}");
    }
    assert!(sum(&E5, |j| C[j].powi(5)).abs() > 1e-6);
    for q in 0..3 {
        let moment = sum(&B3, |j| C[j].powi(q));
        assert!((moment * f64::from(q + 1) - 1.0).abs() < 1e-14);
    }
}

/// `θ̈ = −sin θ` from rest at 2, as a system that is not linear, with time made visible.
struct Pendulum;

impl OdeProblem for Pendulum {
    fn len(&self) -> usize {
        3
    }
    fn rhs(&mut self, t: f64, y: &[f64], dy: &mut [f64]) -> Result<(), EvalFailure> {
        dy[0] = y[1];
        dy[1] = -y[0].sin();
        dy[2] = y[2] * t.cos();
        Ok(())
    }
}

/// Ends of `steps` equal steps over [0, 2]: the state there and in the middle of the last step.
fn equal_steps(steps: u32) -> ([f64; 3], [f64; 3]) {
    let h = 2.0 / f64::from(steps);
    let mut options = Options::new(0.99, vec![1e6; 3]);
    options.h_first = Some(h);
    options.h_max = h;
    let mut method = Driver::new(Dop853::new(3, &options), 3, &options);
    method.start(&mut Pendulum, 0.0, &[2.0, 0.0, 1.0]).unwrap();
    while !matches!(method.step(&mut Pendulum, 2.0).unwrap(), Step::End { .. }) {}
    assert_eq!(method.stats().steps, u64::from(steps));
    let mut inside = [0.0; 3];
    let t = 2.0 - 0.37 * h;
    method.interpolate(&mut Pendulum, t, &mut inside).unwrap();
    (method.y().try_into().unwrap(), inside)
}

fn distance(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    (0..3).map(|i| (a[i] - b[i]).abs()).fold(0.0, f64::max)
}

#[test]
fn steps_converge_with_order_8_and_dense_output_with_order_7() {
    let (reference, _) = equal_steps(256);
    let error = |steps| distance(&equal_steps(steps).0, &reference);
    let order = (error(4) / error(8)).log2();
    assert!((7.4..9.2).contains(&order), "order {order}");

    // The interpolant within the last step against a run that ends there.
    let error = |steps: u32| {
        let h = 2.0 / f64::from(steps);
        let t = 2.0 - 0.37 * h;
        let mut options = Options::new(1e-14, vec![1e-15; 3]);
        options.h_max = 1.0 / 64.0;
        let mut method = Driver::new(Dop853::new(3, &options), 3, &options);
        method.start(&mut Pendulum, 0.0, &[2.0, 0.0, 1.0]).unwrap();
        while !matches!(method.step(&mut Pendulum, t).unwrap(), Step::End { .. }) {}
        distance(&equal_steps(steps).1, &method.y().try_into().unwrap())
    };
    let order = (error(4) / error(8)).log2();
    assert!((6.9..9.5).contains(&order), "dense order {order}");
}

#[test]
fn dense_output_is_exact_for_polynomials_of_degree_7() {
    struct Power;
    impl OdeProblem for Power {
        fn len(&self) -> usize {
            1
        }
        fn rhs(&mut self, t: f64, _y: &[f64], dy: &mut [f64]) -> Result<(), EvalFailure> {
            dy[0] = 7.0 * t.powi(6);
            Ok(())
        }
    }
    let mut options = Options::new(0.5, vec![1e6]);
    options.h_first = Some(1.0);
    let mut method = Driver::new(Dop853::new(1, &options), 1, &options);
    method.start(&mut Power, 0.0, &[0.0]).unwrap();
    method.step(&mut Power, 1.0).unwrap();
    assert_eq!(method.stats().rhs, 13);
    for i in 0..=20 {
        let t = f64::from(i) / 20.0;
        let mut y = [0.0];
        method.interpolate(&mut Power, t, &mut y).unwrap();
        assert!((y[0] - t.powi(7)).abs() < 2e-13, "{t}: {}", y[0]);
    }
    assert_eq!(method.stats().rhs, 16, "three more, once a step");
}

#[test]
fn stiffness_is_seen_and_forgotten() {
    /// Fast decay onto `cos t` while `t` is below 20, none after.
    struct Decay;
    impl OdeProblem for Decay {
        fn len(&self) -> usize {
            1
        }
        fn rhs(&mut self, t: f64, y: &[f64], dy: &mut [f64]) -> Result<(), EvalFailure> {
            let rate = if t < 20.0 { 1e3 } else { 0.1 };
            dy[0] = -rate * (y[0] - t.cos()) - t.sin();
            Ok(())
        }
    }
    let options = Options::new(1e-5, vec![1e-5]);
    let mut method = Driver::new(Dop853::new(1, &options), 1, &options);
    method.start(&mut Decay, 0.0, &[1.0]).unwrap();
    while !matches!(method.step(&mut Decay, 20.0).unwrap(), Step::End { .. }) {}
    assert!(method.looks_stiff());
    let y = method.y().to_vec();
    method.start(&mut Decay, 20.0, &y).unwrap();
    while !matches!(method.step(&mut Decay, 60.0).unwrap(), Step::End { .. }) {}
    assert!(!method.looks_stiff());
}

#[test]
fn compensation_keeps_the_sum_of_many_small_steps() {
    struct Constant;
    impl OdeProblem for Constant {
        fn len(&self) -> usize {
            1
        }
        fn rhs(&mut self, _t: f64, _y: &[f64], dy: &mut [f64]) -> Result<(), EvalFailure> {
            dy[0] = 1.0;
            Ok(())
        }
    }
    let mut options = Options::new(1e-13, vec![1e-13]);
    options.h_max = 1.234e-4;
    let mut method = Driver::new(Dop853::new(1, &options), 1, &options);
    method.start(&mut Constant, 0.0, &[1e3]).unwrap();
    while !matches!(method.step(&mut Constant, 1.0).unwrap(), Step::End { .. }) {}
    assert!(method.stats().steps > 8000);
    assert!((method.y()[0] - 1001.0).abs() <= f64::EPSILON * 1001.0);
}
