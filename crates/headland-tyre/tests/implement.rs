//! A tractor with an implement on linear tyres that relax, against its reference solution of 23 digits.
//!
//! Planar; the tractor's forward speed is kept. By virtual velocities of `(v_y, r_1, r_2)`, with `e_x`, `e_y` the tractor's axes
//! and `n_x`, `n_y` the implement's:
//!
//! ```text
//! v_1 = v_x e_x + v_y e_y      v_H = v_1 − h r_1 e_y      v_2 = v_H − c r_2 n_y
//! ```

mod common;

use common::reference;
use headland_tyre::{Forces, Linear, Slip, SlipLaw, relax_towards};

const M: [f64; 2] = [7200.0, 4200.0];
const J: [f64; 2] = [12000.0, 6500.0];
/// Mass centre to front axle, rear axle, hitch; hitch to the implement's mass centre, to its axle.
const FRONT: f64 = 1.55;
const REAR: f64 = 1.31;
const HITCH: f64 = 1.31 + 0.95;
const CENTRE: f64 = 2.6;
const AXLE: f64 = 2.6 + 0.5;
const STIFFNESS: [f64; 3] = [1.1e5, 2.4e5, 1.3e5];
const RELAXATION: [f64; 3] = [0.55, 0.8, 0.6];
const SPEED: f64 = 6.0;

fn side_force(axle: usize, alpha: f64) -> f64 {
    let law = Linear { longitudinal: 0.0, cornering: STIFFNESS[axle], camber: 0.0, trail: 0.0, load: None };
    let Forces { fy, .. } = law.forces(0.0, 1.0, &Slip::forward(0.0, alpha));
    fy
}

/// `X Y ψ1 ψ2 v_y r1 r2 α_f α_r α_i`, rates.
fn rates(y: &[f64; 10], delta: f64) -> [f64; 10] {
    let [_, _, psi1, psi2, vy, r1, r2, front, rear, implement] = *y;
    // implement's lateral axis in the tractor's axes
    let (sin, cos) = (psi2 - psi1).sin_cos();
    let n_y = [-sin, cos];
    let v_h = [SPEED, vy - HITCH * r1];
    let kinematic = |v: [f64; 2], turn: f64| (v[1] / v[0]).atan() - turn;
    let axle = [v_h[0] * cos + v_h[1] * sin, -v_h[0] * sin + v_h[1] * cos - AXLE * r2];
    let alpha = [
        relax_towards(front, kinematic([SPEED, vy + FRONT * r1], delta), SPEED, RELAXATION[0]),
        relax_towards(rear, kinematic([SPEED, vy - REAR * r1], 0.0), SPEED, RELAXATION[1]),
        relax_towards(implement, kinematic(axle, 0.0), axle[0], RELAXATION[2]),
    ];
    let (f, b, i) = (side_force(0, front), side_force(1, rear), side_force(2, implement));

    // partial velocities of the two mass centres by v_y, r_1, r_2, in the tractor's axes
    let p1 = [[0.0, 1.0], [0.0, 0.0], [0.0, 0.0]];
    let p2 = [[0.0, 1.0], [0.0, -HITCH], [-CENTRE * n_y[0], -CENTRE * n_y[1]]];
    // accelerations without the rates of the quasi-velocities
    let a1 = [-r1 * vy, r1 * SPEED];
    let n_x = [cos, sin];
    let a2 = [-r1 * v_h[1] + CENTRE * r2 * r2 * n_x[0], r1 * v_h[0] + CENTRE * r2 * r2 * n_x[1]];
    let dot = |a: [f64; 2], b: [f64; 2]| a[0] * b[0] + a[1] * b[1];
    let mut m = [[0.0; 3]; 3];
    let mut force = [0.0; 3];
    for k in 0..3 {
        for l in 0..3 {
            m[k][l] = M[0] * dot(p1[k], p1[l]) + M[1] * dot(p2[k], p2[l]);
        }
        force[k] = -M[0] * dot(p1[k], a1) - M[1] * dot(p2[k], a2);
    }
    m[1][1] += J[0];
    m[2][2] += J[1];
    // generalised forces of the three axles
    let across = f * delta.cos();
    force[0] += across + b + i * n_y[1];
    force[1] += FRONT * across - REAR * b - HITCH * i * n_y[1];
    force[2] += -AXLE * i;
    let u = solve(m, force);
    let (s1, c1) = psi1.sin_cos();
    [SPEED * c1 - vy * s1, SPEED * s1 + vy * c1, r1, r2, u[0], u[1], u[2], alpha[0], alpha[1], alpha[2]]
}

/// Cramer's rule.
fn solve(m: [[f64; 3]; 3], b: [f64; 3]) -> [f64; 3] {
    let det = |m: [[f64; 3]; 3]| {
        m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0])
            + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0])
    };
    std::array::from_fn(|column| {
        let mut with = m;
        for row in 0..3 {
            with[row][column] = b[row];
        }
        det(with) / det(m)
    })
}

/// Runge and Kutta's step of order four.
fn step(y: &mut [f64; 10], t: f64, h: f64, delta: impl Fn(f64) -> f64) {
    let add = |y: &[f64; 10], k: &[f64; 10], h: f64| std::array::from_fn(|i| y[i] + h * k[i]);
    let k1 = rates(y, delta(t));
    let k2 = rates(&add(y, &k1, 0.5 * h), delta(t + 0.5 * h));
    let k3 = rates(&add(y, &k2, 0.5 * h), delta(t + 0.5 * h));
    let k4 = rates(&add(y, &k3, h), delta(t + h));
    for i in 0..10 {
        y[i] += h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
    }
}

#[test]
fn the_reference_solution_is_met() {
    let data = reference("trains.json");
    let values = &data["tractor_implement_relaxation_tyres"]["values"];
    let mut y = [0.0; 10];
    let n = 2000;
    for second in 0..10 {
        // steps end at the kinks of the steering, and do not see across them
        let steers = (1..3).contains(&second);
        let delta = |t: f64| if steers { 0.08 * (std::f64::consts::PI * (t - 1.0)).sin() } else { 0.0 };
        for k in 0..n {
            let h = 1.0 / f64::from(n);
            step(&mut y, f64::from(second) + f64::from(k) * h, h, delta);
        }
        let Some(expected) = values.get((second + 1).to_string()) else { continue };
        for (i, found) in y.iter().enumerate() {
            let expected: f64 = expected[i].as_str().unwrap().parse().unwrap();
            assert!((found - expected).abs() < 1e-10, "t = {}, {i}: {found:e} {expected:e}", second + 1);
        }
    }
}
