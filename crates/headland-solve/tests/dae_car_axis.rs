//! The car axis problem of the Test Set for IVP Solvers, in the form of Gear, Gupta and Leimkuhler.
//!
//! A bar of length 1 on two springs, its left end held in a slot that turns: `ε = 0.01`.
//! Reference: index-1 form integrated in quadruple precision by extrapolation for this project, two
//! runs of order 24 and 18 that agree to 20 digits.
#![cfg(feature = "ida")]

use headland_solve::{DaeProblem, EvalFailure, Ida, Options, StartLevel, Stats, Step, Unknown};

type Eval = Result<(), EvalFailure>;

const M: f64 = 10.0;
const EPS: f64 = 0.01;
const MASS: f64 = 0.5 * M * EPS * EPS;

/// `q` (left and right end), `v`, `λ` and `μ` at the end, as far as they are known.
const REFERENCE: [f64; 10] = [
    4.934_557_842_752_409_e-2,
    4.969_894_602_300_081e-1,
    1.041_742_524_885_426,
    3.739_110_272_652_664e-1,
    -7.705_836_840_359_208e-2,
    7.446_866_592_068_417e-3,
    1.755_681_575_354_174e-2,
    7.703_410_437_796_011e-1,
    -4.736_886_590_853_327e-3,
    -1.104_680_331_259_561e-3,
];

/// The slot: its direction and how that changes.
fn slot(t: f64) -> [f64; 6] {
    const A: f64 = 0.1;
    const W: f64 = 10.0;
    let (s, c) = (W * t).sin_cos();
    let (yb, dyb, ddyb) = (A * s, A * W * c, -A * W * W * s);
    let xb = (1.0 - yb * yb).sqrt();
    let dxb = -yb * dyb / xb;
    let ddxb = -(dyb * dyb + yb * ddyb + dxb * dxb) / xb;
    [xb, yb, dxb, dyb, ddxb, ddyb]
}

/// ```text
/// q̇ = v + Gᵀ μ    m v̇ = f + Gᵀ λ    0 = G v + ∂g/∂t    0 = g(t, q)
/// ```
struct CarAxis;

impl CarAxis {
    /// `G` by rows.
    fn rows(t: f64, q: &[f64]) -> [[f64; 4]; 2] {
        let [xb, yb, ..] = slot(t);
        let (dx, dy) = (2.0 * (q[0] - q[2]), 2.0 * (q[1] - q[3]));
        [[xb, yb, 0.0, 0.0], [dx, dy, -dx, -dy]]
    }

    fn forces(t: f64, q: &[f64]) -> [f64; 4] {
        let [xb, yb, ..] = slot(t);
        let (left, right) = (q[0].hypot(q[1]), (q[2] - xb).hypot(q[3] - yb));
        let (a, b) = ((0.5 - left) / left, (0.5 - right) / right);
        [a * q[0], a * q[1] - MASS, b * (q[2] - xb), b * (q[3] - yb) - MASS]
    }

    fn position(t: f64, q: &[f64]) -> [f64; 2] {
        let [xb, yb, ..] = slot(t);
        let (dx, dy) = (q[0] - q[2], q[1] - q[3]);
        [q[0] * xb + q[1] * yb, dx * dx + dy * dy - 1.0]
    }

    fn velocity(t: f64, q: &[f64], v: &[f64]) -> [f64; 2] {
        let [_, _, dxb, dyb, ..] = slot(t);
        let g = Self::rows(t, q).map(|row| row.iter().zip(v).map(|(g, v)| g * v).sum::<f64>());
        [g[0] + q[0] * dxb + q[1] * dyb, g[1]]
    }

    fn acceleration(t: f64, q: &[f64], v: &[f64], a: &[f64]) -> [f64; 2] {
        let [_, _, dxb, dyb, ddxb, ddyb] = slot(t);
        let g = Self::rows(t, q).map(|row| row.iter().zip(a).map(|(g, a)| g * a).sum::<f64>());
        let (du, dv) = (v[0] - v[2], v[1] - v[3]);
        [g[0] + 2.0 * (v[0] * dxb + v[1] * dyb) + q[0] * ddxb + q[1] * ddyb, g[1] + 2.0 * (du * du + dv * dv)]
    }
}

impl DaeProblem for CarAxis {
    fn len(&self) -> usize {
        12
    }
    fn differential(&self) -> &[bool] {
        const KINDS: [bool; 12] = [true, true, true, true, true, true, true, true, false, false, false, false];
        &KINDS
    }
    fn residual(&mut self, t: f64, y: &[f64], dy: &[f64], r: &mut [f64]) -> Eval {
        let (q, v, lambda, mu) = (&y[..4], &y[4..8], &y[8..10], &y[10..]);
        let (g, f) = (Self::rows(t, q), Self::forces(t, q));
        for i in 0..4 {
            r[i] = dy[i] - v[i] - g[0][i] * mu[0] - g[1][i] * mu[1];
            r[4 + i] = MASS * dy[4 + i] - f[i] - g[0][i] * lambda[0] - g[1][i] * lambda[1];
        }
        r[8..10].copy_from_slice(&Self::velocity(t, q, v));
        r[10..].copy_from_slice(&Self::position(t, q));
        Ok(())
    }
    fn start_levels(&self) -> Vec<StartLevel> {
        let names = |what: &str| vec![format!("{what} in the slot"), format!("{what} of the bar")];
        let mut dynamics: Vec<String> = (0..8).map(|i| self.equation_name(i)).collect();
        dynamics.extend(names("acceleration"));
        dynamics.extend(names("correction"));
        let unknowns = (0..8).map(Unknown::Dy).chain((8..12).map(Unknown::Y));
        vec![
            StartLevel::new(names("position"), (0..4).map(Unknown::Y).collect()),
            StartLevel::new(names("velocity"), (4..8).map(Unknown::Y).collect()),
            StartLevel::new(dynamics, unknowns.collect()),
        ]
    }
    fn start_residual(&mut self, level: usize, t: f64, y: &[f64], dy: &[f64], r: &mut [f64]) -> Eval {
        let (q, v) = (&y[..4], &y[4..8]);
        match level {
            0 => r.copy_from_slice(&Self::position(t, q)),
            1 => r.copy_from_slice(&Self::velocity(t, q, v)),
            _ => {
                self.residual(t, y, dy, r)?;
                r[8..10].copy_from_slice(&Self::acceleration(t, q, v, &dy[4..8]));
                r[10..].copy_from_slice(&y[10..]);
            }
        }
        Ok(())
    }
}

/// Errors of positions and velocities, and of `λ`; the constraint residuals at the end.
fn solve(rtol: f64) -> (f64, f64, f64, Stats) {
    let mut options = Options::new(rtol, vec![rtol; 12]);
    options.suppress_algebraic = true;
    options.max_steps = 200_000;
    let mut ida = Ida::new(12, options).unwrap();
    let (mut y, mut dy) = ([0.0; 12], [0.0; 12]);
    y[..8].copy_from_slice(&[0.0, 0.5, 1.0, 0.5, -0.5, 0.0, -0.5, 0.0]);
    let report = ida.make_consistent(&mut CarAxis, 0.0, &mut y, &mut dy).unwrap();
    assert!(report.redundant.is_empty() && report.undetermined.is_empty(), "{report:?}");
    assert!(report.changes.iter().all(|c| c.component.starts_with("d/dt")), "{report:?}");
    ida.start(&mut CarAxis, 0.0, &y, &dy).unwrap();
    while !matches!(ida.step(&mut CarAxis, 3.0).unwrap(), Step::End { .. }) {}
    let y = ida.y();
    let error = |range: std::ops::Range<usize>| range.map(|i| (y[i] - REFERENCE[i]).abs()).fold(0.0, f64::max);
    let (q, v) = (&y[..4], &y[4..8]);
    let kept = CarAxis::position(3.0, q).into_iter().chain(CarAxis::velocity(3.0, q, v));
    (error(0..8), error(8..10), kept.fold(0.0, |s, r| s.max(r.abs())), *ida.stats())
}

#[test]
fn car_axis() {
    for (rtol, error, multiplier, kept) in
        [(1e-6, 1e-3, 1e-3, 1e-5), (1e-8, 1e-4, 1e-6, 1e-7), (1e-10, 1e-6, 1e-8, 1e-9)]
    {
        let (state, lambda, residual, stats) = solve(rtol);
        println!("rtol {rtol:e}: error {state:.1e}, multipliers {lambda:.1e}, constraints {residual:.1e}, {stats:?}");
        assert!(state < error && lambda < multiplier && residual < kept, "rtol {rtol:e}");
    }
}

#[test]
fn a_start_off_the_constraints_is_moved_to_them() {
    let ida = Ida::new(12, Options::new(1e-10, vec![1e-10; 12])).unwrap();
    let (mut y, mut dy) = ([0.0; 12], [0.0; 12]);
    y[..8].copy_from_slice(&[0.01, 0.49, 1.02, 0.52, -0.4, 0.1, -0.6, 0.0]);
    let report = ida.make_consistent(&mut CarAxis, 0.7, &mut y, &mut dy).unwrap();
    println!("{report:?}");
    let (q, v, a) = (&y[..4], &y[4..8], &dy[4..8]);
    let all = [CarAxis::position(0.7, q), CarAxis::velocity(0.7, q, v), CarAxis::acceleration(0.7, q, v, a)];
    assert!(all.as_flattened().iter().all(|r| r.abs() < 1e-12), "{all:?}");
    assert!(y.iter().zip([0.01, 0.49, 1.02, 0.52]).all(|(y, guess)| (y - guess).abs() < 0.1));
}
