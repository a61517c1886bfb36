//! The reduced equations of a ball that rolls in a fixed spherical recess, integrated here: nothing of headland is in it.
//!
//! ```text
//! n    unit vector from the recess's centre to the ball's, a = R - r,  ν = w·n constant,  w = ν n - (a/r) n × n'
//! a (m + J/r²) (n'' + n'² n) = -m g (z - n_z n) - (J ν/r) n × n'          (Routh, Advanced Part, 1905)
//! ```
//! With the quaternion of the ball, by a Runge-Kutta method of order 4 with so many steps that its error is below 1e-11.

use crate::case::Expected;

/// A start in the words of `models/ball_in_recess.toml`; `k` is the inertia over m r², `polar` in degrees.
pub(crate) struct Ball {
    pub(crate) k: f64,
    pub(crate) r: f64,
    pub(crate) polar: f64,
    pub(crate) speed: f64,
    pub(crate) spin: f64,
}

impl Ball {
    /// What the scene has.
    pub(crate) const USUAL: Self = Self { k: 0.4, r: 0.05, polar: 40.0, speed: 1.2, spin: 5.0 };

    fn angular_velocity(&self, n: [f64; 3], rate: [f64; 3]) -> [f64; 3] {
        let turn = cross(n, rate);
        [0, 1, 2].map(|i| self.spin * n[i] - (ROOM - self.r) / self.r * turn[i])
    }

    /// n, n', quaternion (w, x, y, z).
    fn rate(&self, y: &[f64; 10]) -> [f64; 10] {
        let (n, v) = ([y[0], y[1], y[2]], [y[3], y[4], y[5]]);
        let a = ROOM - self.r;
        let (across, square) = (cross(n, v), v.iter().map(|x| x * x).sum::<f64>());
        let gravity = [n[2] * n[0], n[2] * n[1], n[2] * n[2] - 1.0].map(|x| GRAVITY / (a * (1.0 + self.k)) * x);
        let whirl = self.k * self.r * self.spin / (a * (1.0 + self.k));
        let turn = [0, 1, 2].map(|i| gravity[i] - whirl * across[i] - square * n[i]);
        let ([w1, w2, w3], [q0, q1, q2, q3]) = (self.angular_velocity(n, v), [y[6], y[7], y[8], y[9]]);
        let q = [
            -w1 * q1 - w2 * q2 - w3 * q3,
            w1 * q0 + w2 * q3 - w3 * q2,
            w2 * q0 + w3 * q1 - w1 * q3,
            w3 * q0 + w1 * q2 - w2 * q1,
        ]
        .map(|x| x / 2.0);
        [v[0], v[1], v[2], turn[0], turn[1], turn[2], q[0], q[1], q[2], q[3]]
    }
}

const ROOM: f64 = 0.5;
const GRAVITY: f64 = 9.81;
/// Steps a turn of the ball by one radian, and the least a second.
const STEPS: (f64, f64) = (500.0, 50_000.0);

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Place, velocity, angular velocity and quaternion at a fifth of the time, at half of it and at its end.
pub(crate) fn reduced(ball: &Ball, until: f64) -> Vec<Expected> {
    let a = ROOM - ball.r;
    let (s, c) = ball.polar.to_radians().sin_cos();
    let mut y = [s, 0.0, -c, 0.0, ball.speed / a, 0.0, 1.0, 0.0, 0.0, 0.0];
    // never much faster than at the start, for the integrals hold it
    let fastest = (2.0 * ball.speed + 3.0) / ball.r + ball.spin.abs();
    let steps = 10 * ((until / 10.0) * (STEPS.0 * fastest).max(STEPS.1)).ceil() as usize;
    let h = until / steps as f64;
    let mut list = Vec::new();
    for step in 1..=steps {
        let add = |x: &[f64; 10], by: f64| std::array::from_fn::<f64, 10, _>(|i| y[i] + by * x[i]);
        let k1 = ball.rate(&y);
        let k2 = ball.rate(&add(&k1, h / 2.0));
        let k3 = ball.rate(&add(&k2, h / 2.0));
        let k4 = ball.rate(&add(&k3, h));
        y = std::array::from_fn(|i| y[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]));
        if [steps / 5, steps / 2, steps].contains(&step) {
            let t = until * step as f64 / steps as f64;
            let w = ball.angular_velocity([y[0], y[1], y[2]], [y[3], y[4], y[5]]);
            for (i, axis) in ["x", "y", "z"].iter().enumerate() {
                list.push(Expected::at(t, *axis, a * y[i]));
                list.push(Expected::at(t, format!("v{axis}"), a * y[3 + i]));
                list.push(Expected::at(t, format!("w{axis}"), w[i]));
            }
            let size = y[6..].iter().map(|q| q * q).sum::<f64>().sqrt();
            for (i, name) in ["qw", "qx", "qy", "qz"].iter().enumerate() {
                list.push(Expected::at(t, *name, y[6 + i] / size));
            }
            for drift in ["energy_drift", "spin_drift", "routh_drift"] {
                list.push(Expected { allowed: Some(1e-12), ..Expected::at(t, drift, 0.0) });
            }
        }
    }
    list
}
