//! The article's train for any number of bogies, and its right-hand side as somebody would write it by hand.
#![allow(dead_code)] // each bench uses its part

use headland::Scene;
use headland::solve::{EvalFailure, OdeProblem};

/// Quasi-velocity, structures explicit.
pub const MINIMAL: &str = include_str!("../../../../models/paper_train.toml");
/// Rates and one row an axle; the program chooses the independent rate.
pub const CARTESIAN: &str = include_str!("../../../../models/paper_train_cartesian.toml");

/// A tractor, then trailers, the last without a hinge behind its axle.
#[derive(Clone, Debug)]
pub struct Train {
    pub l: Vec<f64>,
    pub a: Vec<f64>,
    pub b: Vec<f64>,
    pub m: Vec<f64>,
    pub j: Vec<f64>,
    pub resistance: Vec<f64>,
    pub f0: f64,
    pub kp: f64,
    pub v_ref: f64,
    pub v0: f64,
}

impl Train {
    pub fn new(n: usize) -> Self {
        let row = |first: f64, next: f64| (0..n).map(|k| if k == 0 { first } else { next }).collect::<Vec<f64>>();
        let mut a = row(1.0, 1.2);
        a[n - 1] = 0.0;
        let resistance = row(3000.0, 3400.0);
        Self {
            l: row(4.0, 6.0),
            a,
            b: row(2.0, 3.0),
            m: row(8000.0, 12_000.0),
            j: row(20_000.0, 60_000.0),
            f0: resistance.iter().sum(),
            resistance,
            kp: 2000.0,
            v_ref: 18.0,
            v0: 18.0,
        }
    }

    /// The three bogies as the scene has them.
    pub fn of_the_scene() -> Self {
        Self {
            m: vec![8000.0, 12_000.0, 10_000.0],
            j: vec![20_000.0, 60_000.0, 50_000.0],
            resistance: vec![3000.0, 3400.0, 3200.0],
            f0: 9600.0,
            ..Self::new(3)
        }
    }

    /// The scene, one of [`MINIMAL`] and [`CARTESIAN`], with these numbers set.
    pub fn scene(&self, text: &str) -> Scene {
        let mut scene = Scene::parse("train.toml", text).expect("the scene parses");
        let theta0 = vec![0.0; self.l.len()];
        let arrays = [
            ("l", &self.l),
            ("a", &self.a),
            ("b", &self.b),
            ("m", &self.m),
            ("J", &self.j),
            ("F_B", &self.resistance),
            ("theta0", &theta0),
        ];
        for (name, values) in arrays {
            scene.set(name, &format!("{values:?}")).expect("an array of the scene");
        }
        scene.set("F0", &format!("{:?}", self.f0)).expect("a parameter of the scene");
        scene
    }

    /// `y = [x_A1, y_A1, θ_1 .. θ_n, v]` at the start.
    pub fn start(&self) -> Vec<f64> {
        let mut y = vec![0.0; self.l.len() + 3];
        y[self.l.len() + 2] = self.v0;
        y
    }

    /// A state in the bend, every bogie at another angle.
    pub fn in_the_bend(&self) -> Vec<f64> {
        let n = self.l.len();
        let mut y = self.start();
        (y[0], y[1], y[n + 2]) = (50.0, 2.0, 17.5);
        for k in 0..n {
            y[2 + k] = 0.1 * (0.7 * k as f64).cos();
        }
        y
    }

    /// `ẏ` by (12)-(16) in one loop from the first bogie to the last. With `r_k = v_Ak/v`, `g_k = cos²ψ_k + β_k² sin²ψ_k`:
    ///
    /// ```text
    /// M v′ = F_A1 − Σ F_Bk r_k cos ψ_k − ½ M′ v,    M = Σ m_k r_k² g_k + J_k (r_k sin ψ_k/l_k)²
    /// ```
    /// and `M′` by handing `r_k′` and `ψ_k′` down the train beside `r_k` and `ψ_k`.
    pub fn rates(&self, t: f64, y: &[f64], dy: &mut [f64]) {
        let n = self.l.len();
        let (theta, v) = (&y[2..n + 2], y[n + 2]);
        let tanh = (t - 3.0).tanh();
        let gamma = 0.015 * (1.0 + tanh);
        let (mut psi, mut psi_rate) = (gamma, 0.015 * (1.0 - tanh * tanh));
        let (mut r, mut r_rate) = (1.0, 0.0);
        let (mut mass, mut half_mass_rate, mut resistance) = (0.0, 0.0, 0.0);
        let (sin, cos) = (theta[0] + gamma).sin_cos();
        dy[0] = v * cos;
        dy[1] = v * sin;
        for k in 0..n {
            let (s, c) = psi.sin_cos();
            let (alpha, beta) = (self.a[k] / self.l[k], self.b[k] / self.l[k]);
            let turn = r * s / self.l[k]; // per unit speed
            let turn_rate = (r_rate * s + r * c * psi_rate) / self.l[k];
            let g = c * c + beta * beta * s * s;
            let half_g_rate = (beta * beta - 1.0) * s * c * psi_rate;
            mass += self.m[k] * r * r * g + self.j[k] * turn * turn;
            half_mass_rate += self.m[k] * r * (r_rate * g + r * half_g_rate) + self.j[k] * turn * turn_rate;
            resistance += self.resistance[k] * r * c;
            let omega = v * turn;
            dy[2 + k] = omega;
            if k + 1 < n {
                let h2 = c * c + alpha * alpha * s * s;
                let h = h2.sqrt();
                let delta_rate = alpha * psi_rate / h2;
                r_rate = r_rate * h + r * (alpha * alpha - 1.0) * s * c * psi_rate / h;
                r *= h;
                psi = theta[k] - theta[k + 1] - (alpha * s).atan2(c);
                psi_rate = omega - v * r * psi.sin() / self.l[k + 1] - delta_rate;
            }
        }
        let drive = self.f0 + self.kp * (self.v_ref - v);
        dy[n + 2] = (drive - resistance - half_mass_rate * v) / mass;
    }
}

impl OdeProblem for Train {
    fn len(&self) -> usize {
        self.l.len() + 3
    }
    fn rhs(&mut self, t: f64, y: &[f64], dy: &mut [f64]) -> Result<(), EvalFailure> {
        self.rates(t, y, dy);
        Ok(())
    }
}

/// Largest difference, relative to the size of each number, or absolute where that is less than one.
pub fn difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs() / b.abs().max(1.0)).fold(0.0, f64::max)
}
