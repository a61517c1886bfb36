//! Stiff problems of the Test Set for IVP Solvers (Bari/CWI), by BDF with exact Jacobians.
//!
//! References: the published solutions of the test set, release 2.4, F. Mazzia and C. Magherini, 2008.
//! The measure is `mescd`: `-log10 max_i |error_i| / (atol/rtol + |ref_i|)`.
#![cfg(feature = "cvode")]

mod common;

use common::{Eval, Problem, digits, run};
use headland_solve::{EvalFailure, Method, OdeProblem, Options, Pattern, Stats};

/// Runs a problem from 0 to `t_end`, with `atol = floor · rtol`.
fn solve(problem: &mut dyn OdeProblem, y0: &[f64], t_end: f64, rtol: f64, floor: &[f64]) -> (Vec<f64>, Stats) {
    let atol = floor.iter().map(|f| f * rtol).collect();
    let mut options = Options::new(rtol, atol);
    options.max_steps = 100_000;
    let mut integrator = Method::CvodeBdf.create(y0.len(), options).unwrap();
    integrator.start(problem, 0.0, y0).unwrap();
    run(&mut *integrator, problem, t_end).unwrap();
    (integrator.y().to_vec(), *integrator.stats())
}

/// Digits at two tolerances, each at least what is asked for, and the steps of the finer.
fn check(make: impl Fn() -> Problem, y0: &[f64], t_end: f64, floor: f64, reference: &[f64], wanted: [(f64, f64); 2]) {
    let n = y0.len();
    for (rtol, least) in wanted {
        let mut problem = make();
        let (y, stats) = solve(&mut problem, y0, t_end, rtol, &vec![floor; n]);
        let found = digits(&y, reference, floor);
        println!("rtol {rtol:e}: {found:.2} digits, {stats:?}");
        assert!(found > least, "rtol {rtol:e}: {found:.2} digits");
        assert_eq!(stats.jacobians, problem.jacobian_calls);
        assert!(stats.jacobians < stats.steps / 2);
    }
}

#[test]
fn robertson() {
    let make = || {
        Problem::new(3, |_, y, dy| {
            let (a, b, c) = (0.04 * y[0], 3e7 * y[1] * y[1], 1e4 * y[1] * y[2]);
            dy[0] = -a + c;
            dy[1] = a - c - b;
            dy[2] = b;
        })
        .jacobian(|_, y, j| {
            let (b, c, d) = (6e7 * y[1], 1e4 * y[2], 1e4 * y[1]);
            j.copy_from_slice(&[-0.04, 0.04, 0.0, c, -c - b, b, d, -d, 0.0]);
        })
    };
    let reference = [0.2083340149701255e-7, 0.8333360770334713e-13, 0.999999979166505];
    // Components of 1e-8 and 1e-13 count to their own size.
    for (rtol, least) in [(1e-6, 3.5), (1e-8, 5.5)] {
        let floor = [1e-10, 1e-15, 1e-2];
        let mut problem = make();
        let (y, stats) = solve(&mut problem, &[1.0, 0.0, 0.0], 1e11, rtol, &floor);
        let found = digits(&y, &reference, 0.0);
        println!("rtol {rtol:e}: {found:.2} digits, {stats:?}");
        assert!(found > least, "rtol {rtol:e}: {found:.2} digits");
        assert!((y.iter().sum::<f64>() - 1.0).abs() < 1e-10);
    }
}

#[test]
fn van_der_pol() {
    const EPS: f64 = 1e-6;
    let make = || {
        Problem::new(2, |_, y, dy| {
            dy[0] = y[1];
            dy[1] = ((1.0 - y[0] * y[0]) * y[1] - y[0]) / EPS;
        })
        .jacobian(|_, y, j| {
            j[0] = 0.0;
            j[1] = (-2.0 * y[0] * y[1] - 1.0) / EPS;
            j[2] = 1.0;
            j[3] = (1.0 - y[0] * y[0]) / EPS;
        })
    };
    // Published in time scaled by 1000, where y2 is as many times smaller.
    let reference = [0.1706167732170469e1, -0.8928097010248125];
    check(make, &[2.0, 0.0], 2.0, 1.0, &reference, [(1e-6, 4.5), (1e-9, 7.0)]);
}

#[test]
fn hires() {
    let make = || {
        Problem::new(8, |_, y, dy| {
            let r = 280.0 * y[5] * y[7];
            dy[0] = -1.71 * y[0] + 0.43 * y[1] + 8.32 * y[2] + 0.0007;
            dy[1] = 1.71 * y[0] - 8.75 * y[1];
            dy[2] = -10.03 * y[2] + 0.43 * y[3] + 0.035 * y[4];
            dy[3] = 8.32 * y[1] + 1.71 * y[2] - 1.12 * y[3];
            dy[4] = -1.745 * y[4] + 0.43 * y[5] + 0.43 * y[6];
            dy[5] = -r + 0.69 * y[3] + 1.71 * y[4] - 0.43 * y[5] + 0.69 * y[6];
            dy[6] = r - 1.81 * y[6];
            dy[7] = -r + 1.81 * y[6];
        })
        .jacobian(|_, y, j| {
            j.fill(0.0);
            let mut set = |row: usize, column: usize, value| j[8 * column + row] = value;
            for (row, column, value) in [
                (0, 0, -1.71),
                (0, 1, 0.43),
                (0, 2, 8.32),
                (1, 0, 1.71),
                (1, 1, -8.75),
                (2, 2, -10.03),
                (2, 3, 0.43),
                (2, 4, 0.035),
                (3, 1, 8.32),
                (3, 2, 1.71),
                (3, 3, -1.12),
                (4, 4, -1.745),
                (4, 5, 0.43),
                (4, 6, 0.43),
                (5, 3, 0.69),
                (5, 4, 1.71),
                (5, 5, -280.0 * y[7] - 0.43),
                (5, 6, 0.69),
                (5, 7, -280.0 * y[5]),
                (6, 5, 280.0 * y[7]),
                (6, 6, -1.81),
                (6, 7, 280.0 * y[5]),
                (7, 5, -280.0 * y[7]),
                (7, 6, 1.81),
                (7, 7, -280.0 * y[5]),
            ] {
                set(row, column, value);
            }
        })
    };
    let y0 = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0057];
    let reference = [
        0.7371312573325668e-3,
        0.1442485726316185e-3,
        0.5888729740967575e-4,
        0.1175651343283149e-2,
        0.2386356198831331e-2,
        0.6238968252742796e-2,
        0.2849998395185769e-2,
        0.2850001604814231e-2,
    ];
    check(make, &y0, 321.8122, 1e-4, &reference, [(1e-6, 3.5), (1e-9, 6.0)]);
}

#[test]
fn oregonator() {
    const S: f64 = 77.27;
    const W: f64 = 0.161;
    const Q: f64 = 8.375e-6;
    let make = || {
        Problem::new(3, |_, y, dy| {
            dy[0] = S * (y[1] + y[0] * (1.0 - Q * y[0] - y[1]));
            dy[1] = (y[2] - (1.0 + y[0]) * y[1]) / S;
            dy[2] = W * (y[0] - y[2]);
        })
        .jacobian(|_, y, j| {
            j[0] = S * (1.0 - 2.0 * Q * y[0] - y[1]);
            j[1] = -y[1] / S;
            j[2] = W;
            j[3] = S * (1.0 - y[0]);
            j[4] = -(1.0 + y[0]) / S;
            j[5] = 0.0;
            j[6] = 0.0;
            j[7] = 1.0 / S;
            j[8] = -W;
        })
    };
    let reference = [0.1000814870318523e1, 0.1228178521549917e4, 0.1320554942846706e3];
    check(make, &[1.0, 2.0, 3.0], 360.0, 1e-2, &reference, [(1e-6, 3.0), (1e-9, 5.5)]);
}

/// The transistor amplifier `C ẏ = f(t, y)`, index 1, as an ODE of the five voltages under a
/// derivative, `x = (y1 − y2, y3, y4 − y5, y6, y7 − y8)`.
///
/// ```text
/// the sums of the equations that a capacitor joins hold no derivative:
/// s_1 = f_1 + f_2 = 0    s_2 = f_4 + f_5 = 0    s_3 = f_7 + f_8 = 0
/// ```
/// They are solved for `y2, y5, y8` by Newton's method; each is a function of `x` and of one or two
/// of the unknowns.
struct Amplifier {
    pattern: Pattern,
    /// Start of the inner iteration: `y2, y5, y8`.
    z: [f64; 3],
}

impl Amplifier {
    const UB: f64 = 6.0;
    const R0: f64 = 1000.0;
    const R: f64 = 9000.0;
    const ALPHA: f64 = 0.99;

    fn new() -> Self {
        Self { pattern: Pattern::dense(5, 5), z: [3.0, 3.0, 0.0] }
    }

    /// `g(v) = β (e^{v / U_F} − 1)` and its derivative.
    fn diode(v: f64) -> (f64, f64) {
        const BETA: f64 = 1e-6;
        const UF: f64 = 0.026;
        let e = BETA * (v / UF).exp();
        (e - BETA, e / UF)
    }

    fn voltages(x: &[f64], z: &[f64; 3]) -> [f64; 8] {
        [x[0] + z[0], z[0], x[1], x[2] + z[1], z[1], x[3], x[4] + z[2], z[2]]
    }

    /// `f(t, y)` and `∂f/∂y`.
    fn currents(t: f64, y: &[f64; 8]) -> ([f64; 8], [[f64; 8]; 8]) {
        let (ub, r0, r, a) = (Self::UB, Self::R0, Self::R, Self::ALPHA);
        let ue = 0.1 * (200.0 * std::f64::consts::PI * t).sin();
        let (g1, d1) = Self::diode(y[1] - y[2]);
        let (g2, d2) = Self::diode(y[4] - y[5]);
        let f = [
            (y[0] - ue) / r0,
            2.0 * y[1] / r - ub / r + (1.0 - a) * g1,
            y[2] / r - g1,
            (y[3] - ub) / r + a * g1,
            2.0 * y[4] / r - ub / r + (1.0 - a) * g2,
            y[5] / r - g2,
            (y[6] - ub) / r + a * g2,
            y[7] / r,
        ];
        let mut d = [[0.0; 8]; 8];
        d[0][0] = 1.0 / r0;
        d[1][1] = 2.0 / r + (1.0 - a) * d1;
        d[1][2] = -(1.0 - a) * d1;
        d[2][1] = -d1;
        d[2][2] = 1.0 / r + d1;
        d[3][3] = 1.0 / r;
        d[3][1] = a * d1;
        d[3][2] = -a * d1;
        d[4][4] = 2.0 / r + (1.0 - a) * d2;
        d[4][5] = -(1.0 - a) * d2;
        d[5][4] = -d2;
        d[5][5] = 1.0 / r + d2;
        d[6][6] = 1.0 / r;
        d[6][4] = a * d2;
        d[6][5] = -a * d2;
        d[7][7] = 1.0 / r;
        (f, d)
    }

    /// The voltages that belong to `x`.
    fn solve(&mut self, t: f64, x: &[f64]) -> Result<[f64; 8], EvalFailure> {
        const PAIRS: [(usize, usize); 3] = [(0, 1), (3, 4), (6, 7)];
        for _ in 0..50 {
            let y = Self::voltages(x, &self.z);
            let (f, d) = Self::currents(t, &y);
            // The sums are lower triangular in (y2, y5, y8).
            let mut change = [0.0f64; 3];
            for (i, &(p, q)) in PAIRS.iter().enumerate() {
                let slope = |k: usize| {
                    let (a, b) = PAIRS[k];
                    d[p][a] + d[p][b] + d[q][a] + d[q][b]
                };
                let known: f64 = (0..i).map(|k| slope(k) * change[k]).sum();
                change[i] = -(f[p] + f[q] + known) / slope(i);
            }
            // The exponentials allow no long strides upwards.
            let largest = change.iter().fold(0f64, |m, c| m.max(c.abs()));
            let damping = (0.1 / largest).min(1.0);
            for i in 0..3 {
                self.z[i] += damping * change[i];
            }
            if !largest.is_finite() {
                self.z = [3.0, 3.0, 0.0];
                return Err(EvalFailure::Recoverable);
            }
            if largest < 1e-13 {
                return Ok(Self::voltages(x, &self.z));
            }
        }
        Err(EvalFailure::Recoverable)
    }
}

/// Capacities over which the five voltages stand.
const CAPACITIES: [f64; 5] = [1e-6, 2e-6, 3e-6, 4e-6, 5e-6];

impl OdeProblem for Amplifier {
    fn len(&self) -> usize {
        5
    }
    fn rhs(&mut self, t: f64, x: &[f64], dx: &mut [f64]) -> Eval {
        let y = self.solve(t, x)?;
        let (f, _) = Self::currents(t, &y);
        // Rows 1, 3, 4, 6, 7 of C ẏ = f, with C of entries ∓C_k.
        for (k, row) in [0, 2, 3, 5, 6].into_iter().enumerate() {
            dx[k] = -f[row] / CAPACITIES[k];
        }
        Ok(())
    }
    fn pattern(&self) -> Option<&Pattern> {
        Some(&self.pattern)
    }
    /// `dy/dx = Y_x + Y_z dz/dx`, with `dz/dx` from the derivative of the three sums.
    fn jacobian(&mut self, t: f64, x: &[f64], values: &mut [f64]) -> Eval {
        let y = self.solve(t, x)?;
        let (_, d) = Self::currents(t, &y);
        const PAIRS: [(usize, usize); 3] = [(0, 1), (3, 4), (6, 7)];
        for column in 0..5 {
            let mut dy = [0.0; 8];
            dy[[0, 2, 3, 5, 6][column]] = 1.0;
            let mut dz = [0.0; 3];
            for (i, &(p, q)) in PAIRS.iter().enumerate() {
                let known: f64 = (0..8).map(|k| (d[p][k] + d[q][k]) * dy[k]).sum();
                let (a, b) = PAIRS[i];
                dz[i] = -known / (d[p][a] + d[p][b] + d[q][a] + d[q][b]);
                dy[a] += dz[i];
                dy[b] += dz[i];
            }
            for (k, row) in [0, 2, 3, 5, 6].into_iter().enumerate() {
                let df: f64 = (0..8).map(|j| d[row][j] * dy[j]).sum();
                values[5 * column + k] = -df / CAPACITIES[k];
            }
        }
        Ok(())
    }
}

#[test]
fn transistor_amplifier() {
    let reference = [
        -0.5562145012262709e-2,
        0.3006522471903042e1,
        0.2849958788608128e1,
        0.2926422536206241e1,
        0.2704617865010554e1,
        0.2761837778393145e1,
        0.4770927631616772e1,
        0.1236995868091548e1,
    ];
    // y(0) = (0, U_B/2, U_B/2, U_B, U_B/2, U_B/2, U_B, 0)
    let x0 = [-3.0, 3.0, 3.0, 3.0, 6.0];
    for (rtol, least) in [(1e-6, 4.0), (1e-9, 7.0)] {
        let mut problem = Amplifier::new();
        let (x, stats) = solve(&mut problem, &x0, 0.2, rtol, &[1.0; 5]);
        let y = problem.solve(0.2, &x).unwrap();
        let found = digits(&y, &reference, 1.0);
        println!("rtol {rtol:e}: {found:.2} digits, {stats:?}");
        assert!(found > least, "rtol {rtol:e}: {found:.2} digits");
    }
}

#[test]
fn the_jacobian_of_the_amplifier_agrees_with_differences() {
    let mut problem = Amplifier::new();
    let x = [-2.9, 2.95, 3.1, 2.9, 4.0];
    let mut exact = [0.0; 25];
    problem.jacobian(0.003, &x, &mut exact).unwrap();
    for column in 0..5 {
        let h = 1e-5;
        let mut side = |h: f64| {
            let mut x = x;
            x[column] += h;
            let mut dx = [0.0; 5];
            problem.rhs(0.003, &x, &mut dx).unwrap();
            dx
        };
        let (up, down) = (side(h), side(-h));
        for row in 0..5 {
            let difference = (up[row] - down[row]) / (2.0 * h);
            let value = exact[5 * column + row];
            assert!((difference - value).abs() < 1e-4 * (1.0 + value.abs()));
        }
    }
}
