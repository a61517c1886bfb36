//! The article's train derived a second time, by hand and otherwise: energy form `M v′ + ½ M′ v² = P`, velocities of
//! the bogies as vectors handed from hinge to hinge, no angles psi, no square roots, `M′` by a dual number along the
//! motion. Compared with the scene for 1 to 8 bogies with random parameters and three steering laws.

use std::f64::consts::PI;
use std::ops::{Add, Div, Mul, Neg, Sub};

use approx::assert_relative_eq;
use headland::solve::{EvalFailure, Method, OdeProblem, Options, Step};
use headland::{RunOptions, Scene, Silent, Status};

const SCENE: &str = include_str!("../../models/paper_train.toml");
const UNTIL: f64 = 12.0;

/// A value and its rate.
#[derive(Clone, Copy)]
struct D(f64, f64);

impl Add for D {
    type Output = D;
    fn add(self, b: D) -> D {
        D(self.0 + b.0, self.1 + b.1)
    }
}
impl Sub for D {
    type Output = D;
    fn sub(self, b: D) -> D {
        D(self.0 - b.0, self.1 - b.1)
    }
}
impl Mul for D {
    type Output = D;
    fn mul(self, b: D) -> D {
        D(self.0 * b.0, self.1 * b.0 + self.0 * b.1)
    }
}
impl Div for D {
    type Output = D;
    fn div(self, b: D) -> D {
        D(self.0 / b.0, (self.1 * b.0 - self.0 * b.1) / (b.0 * b.0))
    }
}
impl Neg for D {
    type Output = D;
    fn neg(self) -> D {
        D(-self.0, -self.1)
    }
}
impl D {
    fn sin_cos(self) -> (D, D) {
        let (s, c) = self.0.sin_cos();
        (D(s, c * self.1), D(c, -s * self.1))
    }
    fn exp(self) -> D {
        let e = self.0.exp();
        D(e, e * self.1)
    }
}

/// A steering law: the angle with its rate, and its text for the scene.
#[derive(Clone, Copy, Debug)]
enum Steering {
    SmoothStep { amp: f64, t0: f64, tau: f64 },
    Sine { amp: f64, period: f64 },
    TwoBends { amp: [f64; 2], t0: [f64; 2], tau: [f64; 2] },
}

impl Steering {
    fn at(self, t: f64) -> D {
        let t = D(t, 1.0);
        let c = |x: f64| D(x, 0.0);
        match self {
            // amp/2 (1 + tanh z) = amp/(1 + exp(-2 z))
            Self::SmoothStep { amp, t0, tau } => c(amp) / (c(1.0) + ((c(t0) - t) * c(2.0 / tau)).exp()),
            Self::Sine { amp, period } => c(amp) * (t * c(2.0 * PI / period)).sin_cos().0,
            Self::TwoBends { amp, t0, tau } => (0..2).fold(c(0.0), |sum, i| {
                let z = (t - c(t0[i])) / c(tau[i]);
                sum + c(amp[i]) * (-(z * z)).exp()
            }),
        }
    }

    fn text(self) -> String {
        match self {
            Self::SmoothStep { amp, t0, tau } => format!("{amp:?}/2*(1 + tanh((t - {t0:?})/{tau:?}))"),
            Self::Sine { amp, period } => format!("{amp:?}*sin(2*pi*t/{period:?})"),
            Self::TwoBends { amp, t0, tau } => {
                let bend = |i: usize| format!("({:?})*exp(-((t - {:?})/{:?})^2)", amp[i], t0[i], tau[i]);
                format!("{} + {}", bend(0), bend(1))
            }
        }
    }
}

/// xorshift64*
struct Random(u64);

impl Random {
    fn between(&mut self, a: f64, b: f64) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        let bits = self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 11;
        a + (b - a) * bits as f64 / (1_u64 << 53) as f64
    }

    fn array(&mut self, n: usize, a: f64, b: f64) -> Vec<f64> {
        (0..n).map(|_| self.between(a, b)).collect()
    }
}

/// A train; `y = [x, y, v, θ_1, ..]`.
#[derive(Debug)]
struct Train {
    l: Vec<f64>,
    a: Vec<f64>,
    b: Vec<f64>,
    m: Vec<f64>,
    j: Vec<f64>,
    resistance: Vec<f64>,
    f0: f64,
    kp: f64,
    v_ref: f64,
    v0: f64,
    theta0: Vec<f64>,
    steering: Steering,
}

impl Train {
    fn random(n: usize, random: &mut Random) -> Self {
        let l = random.array(n, 3.0, 7.0);
        let steering = match n % 3 {
            0 => Steering::SmoothStep {
                amp: random.between(-0.05, 0.05),
                t0: random.between(2.0, 5.0),
                tau: random.between(0.5, 2.0),
            },
            1 => Steering::Sine { amp: random.between(0.02, 0.06), period: random.between(5.0, 9.0) },
            _ => Steering::TwoBends {
                amp: [random.between(0.02, 0.06), random.between(-0.06, -0.02)],
                t0: [random.between(2.0, 4.0), random.between(6.0, 8.0)],
                tau: [random.between(0.7, 1.5), random.between(0.7, 1.5)],
            },
        };
        Self {
            a: random.array(n, -0.8, 1.5),
            b: l.iter().map(|l| l * random.between(0.1, 0.9)).collect(),
            m: random.array(n, 3000.0, 15000.0),
            j: random.array(n, 1e4, 6e4),
            resistance: random.array(n, 1000.0, 4000.0),
            f0: random.between(5000.0, 12000.0),
            kp: random.between(500.0, 4000.0),
            v_ref: random.between(12.0, 20.0),
            v0: random.between(12.0, 20.0),
            theta0: random.array(n, -0.15, 0.15),
            l,
            steering,
        }
    }

    /// The energy form: rates of the state.
    fn rates(&self, t: f64, y: &[f64], dy: &mut [f64]) {
        let n = self.l.len();
        let (v, theta) = (y[2], &y[3..]);
        // First the turn rates per unit speed, as numbers; then all of it along the motion.
        let gamma = self.steering.at(t);
        let mut rates = vec![0.0; n];
        let still = self.sweep(D(gamma.0, 0.0), theta, &rates);
        for (rate, omega) in rates.iter_mut().zip(&still.omega) {
            *rate = omega.0 * v;
        }
        let s = self.sweep(gamma, theta, &rates);
        let drive = self.f0 + self.kp * (self.v_ref - v);
        let resistance: f64 = self.resistance.iter().zip(&s.v_b).map(|(f, v_b)| f * v_b.0).sum();
        let (sin, cos) = (theta[0] + gamma.0).sin_cos();
        dy[0] = v * cos;
        dy[1] = v * sin;
        dy[2] = (drive - resistance - 0.5 * s.mass.1 * v) / s.mass.0;
        dy[3..].copy_from_slice(&rates);
    }

    /// From the first hinge to the last bogie at unit speed of A_1: `T = ½ mass v²`.
    fn sweep(&self, gamma: D, theta: &[f64], rates: &[f64]) -> Sweep {
        let c = |x: f64| D(x, 0.0);
        let heading = D(theta[0], rates[0]) + gamma;
        let (sin, cos) = heading.sin_cos();
        let mut hinge = [cos, sin];
        let mut s = Sweep { mass: c(0.0), v_b: Vec::new(), omega: Vec::new() };
        for k in 0..self.l.len() {
            let (sin, cos) = D(theta[k], rates[k]).sin_cos();
            let along = hinge[0] * cos + hinge[1] * sin;
            let across = hinge[1] * cos - hinge[0] * sin;
            let omega = across / c(self.l[k]);
            let side = omega * c(self.b[k]);
            s.mass = s.mass + c(self.m[k]) * (along * along + side * side) + c(self.j[k]) * omega * omega;
            let back = -(omega * c(self.a[k]));
            hinge = [along * cos - back * sin, along * sin + back * cos];
            s.v_b.push(along);
            s.omega.push(omega);
        }
        s
    }

    fn scene(&self) -> Scene {
        let mut scene = Scene::parse("paper_train.toml", SCENE).expect("the scene parses");
        let list = |x: &[f64]| format!("{x:?}");
        let number = |x: f64| format!("{x:?}");
        for (name, value) in [
            ("l", list(&self.l)),
            ("a", list(&self.a)),
            ("b", list(&self.b)),
            ("m", list(&self.m)),
            ("J", list(&self.j)),
            ("F_B", list(&self.resistance)),
            ("theta0", list(&self.theta0)),
            ("F0", number(self.f0)),
            ("kp", number(self.kp)),
            ("v_ref", number(self.v_ref)),
            ("v0", number(self.v0)),
            ("gamma", self.steering.text()),
        ] {
            scene.set(name, &value).expect("settable");
        }
        scene
    }
}

struct Sweep {
    mass: D,
    v_b: Vec<D>,
    omega: Vec<D>,
}

impl OdeProblem for Train {
    fn len(&self) -> usize {
        3 + self.l.len()
    }
    fn rhs(&mut self, t: f64, y: &[f64], dy: &mut [f64]) -> Result<(), EvalFailure> {
        self.rates(t, y, dy);
        Ok(())
    }
}

fn integrate(train: &mut Train) -> Vec<f64> {
    let n = OdeProblem::len(train);
    let mut y = vec![0.0, 0.0, train.v0];
    y.extend(&train.theta0);
    let options = Options::new(1e-13, vec![1e-13; n]);
    let mut integrator = Method::Dop853.create(n, options).expect("options are right");
    integrator.start(train, 0.0, &y).expect("starts");
    while !matches!(integrator.step(train, UNTIL).expect("goes on"), Step::End { .. }) {}
    integrator.y().to_vec()
}

#[test]
fn energy_form_agrees() {
    let mut random = Random(20_150_921);
    for n in 1..=8 {
        for _ in 0..3 {
            let mut train = Train::random(n, &mut random);
            let reference = integrate(&mut train);
            let model = train.scene().build().expect("the scene is right");
            let mut options = RunOptions::of(&model);
            (options.tolerance, options.until, options.at) = (1e-12, UNTIL, Some(vec![UNTIL]));
            let run = headland::run(&model, &options, &mut Silent).expect("runs");
            assert_eq!(run.report.status, Status::Done, "{train:?}");
            let value = |name: &str| run.trajectory.named(name).expect("a column")[0];
            let mut pairs = vec![("x_A1".to_string(), reference[0]), ("y_A1".into(), reference[1])];
            pairs.push(("v".into(), reference[2]));
            pairs.extend((0..n).map(|k| (format!("theta[{}]", k + 1), reference[3 + k])));
            for (name, expected) in pairs {
                assert_relative_eq!(value(&name), expected, epsilon = 1e-9, max_relative = 1e-9);
            }
            assert!(run.report.energy_balance.expect("kept") < 1e-10);
        }
    }
}

/// The comparison bites: without `½ M′ v²` the speed differs visibly.
#[test]
fn the_mass_of_the_train_changes() {
    let train = Train::random(5, &mut Random(7));
    let y: Vec<f64> = [0.0, 0.0, 15.0].into_iter().chain(train.theta0.iter().copied()).collect();
    let rates: Vec<f64> = {
        let mut dy = vec![0.0; y.len()];
        train.rates(3.0, &y, &mut dy);
        dy[3..].to_vec()
    };
    let along = train.sweep(train.steering.at(3.0), &y[3..], &rates).mass;
    let mut moved = y[3..].to_vec();
    let h = 1e-6;
    moved.iter_mut().zip(&rates).for_each(|(theta, rate)| *theta += h * rate);
    let later = train.sweep(train.steering.at(3.0 + h), &moved, &rates).mass;
    assert_relative_eq!((later.0 - along.0) / h, along.1, max_relative = 1e-4);
    assert!(along.1.abs() > 1.0);
}
