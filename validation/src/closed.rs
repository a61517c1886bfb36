//! Motions in closed form.

use std::f64::consts::PI;

use crate::case::Expected;

/// Integral over `[0, t]` by Gauss' rule with three points on 4000 pieces.
fn integral(t: f64, f: impl Fn(f64) -> f64) -> f64 {
    const N: usize = 4000;
    let h = t / N as f64;
    let d = 0.6_f64.sqrt() / 2.0;
    let piece = |i: usize| {
        let m = (i as f64 + 0.5) * h;
        h * (5.0 * f(m - d * h) + 8.0 * f(m) + 5.0 * f(m + d * h)) / 18.0
    };
    (0..N).map(piece).sum()
}

/// Chaplygin's sleigh; `x`, `y` by quadrature of the closed `v`, `theta`.
///
/// ```text
/// v = V tanh(k t + c),  w = W sech(k t + c),  k = b V m/(J + m b²)
/// θ = (W/k) (gd(k t + c) − gd(c)),  gd(z) = 2 atan(tanh(z/2))
/// ```
pub(crate) fn sleigh() -> Vec<Expected> {
    let (m, j, b, v0, w0): (f64, f64, f64, f64, f64) = (1.0, 0.5, 0.3, -1.0, 0.8);
    let i = j + m * b * b;
    let energy = 0.5 * (m * v0 * v0 + i * w0 * w0);
    let (v_most, w_most) = ((2.0 * energy / m).sqrt(), (2.0 * energy / i).sqrt());
    let k = b * v_most * m / i;
    let c = (v0 / v_most).atanh();
    let v = |t: f64| v_most * (k * t + c).tanh();
    let gd = |z: f64| 2.0 * (z / 2.0).tanh().atan();
    let theta = |t: f64| w_most / k * (gd(k * t + c) - gd(c));
    let mut list = Vec::new();
    for t in [1.0, 3.0, 6.0, 12.0] {
        list.push(Expected::at(t, "v", v(t)));
        list.push(Expected::at(t, "w", w_most / (k * t + c).cosh()));
        list.push(Expected::at(t, "theta", theta(t)));
        list.push(Expected::at(t, "x", integral(t, |t| v(t) * theta(t).cos())));
        list.push(Expected::at(t, "y", integral(t, |t| v(t) * theta(t).sin())));
    }
    list
}

/// `x = g sin α/(2 ω²) sin² ωt`, `y = g sin α/(2 ω) (t − sin 2ωt/(2 ω))`
pub(crate) fn skate() -> Vec<Expected> {
    let (g, alpha, w): (f64, f64, f64) = (9.81, 20.0_f64.to_radians(), 1.3);
    let mut list = Vec::new();
    for t in [1.0, 5.0, 10.0, 20.0] {
        let s = (w * t).sin();
        list.push(Expected::at(t, "x", g * alpha.sin() / (2.0 * w * w) * s * s));
        list.push(Expected::at(t, "y", g * alpha.sin() / (2.0 * w) * (t - (2.0 * w * t).sin() / (2.0 * w))));
        list.push(Expected::at(t, "theta", w * t));
    }
    list
}

/// The centre of a sphere on a turntable runs round a circle with the rate `k/(1 + k) Ω`.
pub(crate) fn turntable(k: f64) -> Vec<Expected> {
    let (x0, v0, rate) = (0.5, 0.4, 3.0 * k / (1.0 + k));
    let mut list = Vec::new();
    for t in [1.0, 5.0, 10.0] {
        list.push(Expected::at(t, "x", x0 + v0 / rate * (rate * t).sin()));
        list.push(Expected::at(t, "y", v0 / rate * (1.0 - (rate * t).cos())));
        list.push(Expected::at(t, "wz", 1.7));
    }
    list
}

/// A ball on a plane tilted by α: `x = ½ g sin α/(1 + k) t²` down the plane, `y = v₀ t` across it.
pub(crate) fn incline(k: f64) -> Vec<Expected> {
    let (g, alpha, r, v0): (f64, f64, f64, f64) = (9.81, 25.0_f64.to_radians(), 0.15, 1.2);
    let mut list = Vec::new();
    for t in [0.5, 1.5, 3.0] {
        let x = g * alpha.sin() / (1.0 + k) * t * t / 2.0;
        list.push(Expected::at(t, "x", x));
        list.push(Expected::at(t, "y", v0 * t));
        list.push(Expected::at(t, "ball.x", x * alpha.cos() + r * alpha.sin()));
        list.push(Expected::at(t, "ball.z", -x * alpha.sin() + r * alpha.cos()));
        list.push(Expected::at(t, "ball.omega_y", g * alpha.sin() / (1.0 + k) * t / r));
    }
    list
}

/// A homogeneous ball inside an upright cylinder: `z = −5 g/(2 Φ²) (1 − cos(√(2/7) Φ t))`, its azimuth grows by Φ.
pub(crate) fn cylinder() -> Vec<Expected> {
    let (g, rho, rate): (f64, f64, f64) = (9.81, 0.6, 5.0);
    let mut list = Vec::new();
    for t in [1.0, 3.0, 10.0] {
        list.push(Expected::at(t, "ball.x", rho * f64::cos(rate * t)));
        list.push(Expected::at(t, "ball.y", rho * f64::sin(rate * t)));
        let swing = f64::sqrt(2.0 / 7.0) * rate * t;
        list.push(Expected::at(t, "ball.z", -5.0 * g / (2.0 * rate * rate) * (1.0 - swing.cos())));
    }
    list
}

/// A disc held upright runs round a circle of radius `r w_spin/w_yaw`.
pub(crate) fn vertical_disc() -> Vec<Expected> {
    let (r, yaw, spin) = (0.25, 0.7, 6.0);
    let radius = r * spin / yaw;
    let mut list = Vec::new();
    for t in [1.0, 5.0, 10.0] {
        list.push(Expected::at(t, "disc.x", radius * f64::sin(yaw * t)));
        list.push(Expected::at(t, "disc.y", radius * (1.0 - f64::cos(yaw * t))));
        list.push(Expected::at(t, "disc.z", r));
        list.push(Expected::at(t, "disc.omega_z", yaw));
        list.push(Expected::at(t, "disc.wy", spin));
    }
    list
}

/// A slider-crank that keeps its energy `½ I(φ) φ′²`: `t = ∫ √(I(φ)/I(0)) dφ/Ω`, solved for φ by Newton's method.
pub(crate) fn slider_crank() -> Vec<Expected> {
    let (m2, m3, l1, l2) = (0.151104, 0.075552, 0.15, 0.30);
    let (j1, j2, omega) = (0.002727, 0.0045339259, 150.0);
    // the rod's inclination ψ, sin ψ = −l1/l2 sin φ, and its derivative by φ
    let rod = |phi: f64| {
        let psi = (-l1 / l2 * phi.sin()).asin();
        (psi, -l1 * phi.cos() / (l2 * psi.cos()))
    };
    // derivatives of places by φ
    let slider = |phi: f64| {
        let (psi, p) = rod(phi);
        -l1 * phi.sin() - l2 * p * psi.sin()
    };
    let inertia = |phi: f64| {
        let (psi, p) = rod(phi);
        let x = -l1 * phi.sin() - l2 / 2.0 * p * psi.sin();
        let y = l1 * phi.cos() + l2 / 2.0 * p * psi.cos();
        let centre = j2 - m2 * l2 * l2 / 4.0;
        j1 + m2 * (x * x + y * y) + centre * p * p + m3 * slider(phi).powi(2)
    };
    let slowness = |phi: f64| (inertia(phi) / inertia(0.0)).sqrt() / omega;
    let mut list = Vec::new();
    for t in [0.01, 0.03, 0.06, 0.1] {
        let mut phi = omega * t;
        for _ in 0..30 {
            phi -= (integral(phi, slowness) - t) / slowness(phi);
        }
        let rate = 1.0 / slowness(phi);
        let (psi, _) = rod(phi);
        list.push(Expected::at(t, "phi", phi));
        list.push(Expected::at(t, "pin", psi - phi));
        list.push(Expected::at(t, "x", l1 * phi.cos() + l2 * psi.cos()));
        list.push(Expected::at(t, "phi'", rate));
        list.push(Expected::at(t, "x'", slider(phi) * rate));
    }
    list
}

/// `x = x₀ e^(−δt) (cos ωt + δ/ω sin ωt)`
pub(crate) fn damped() -> Vec<Expected> {
    let (m, c, b, x0): (f64, f64, f64, f64) = (2.0, 50.0, 1.5, 0.1);
    let decay = b / (2.0 * m);
    let w = (c / m - decay * decay).sqrt();
    let mut list = Vec::new();
    for t in [0.5, 2.0, 5.0, 10.0] {
        let envelope = x0 * (-decay * t).exp();
        list.push(Expected::at(t, "x", envelope * ((w * t).cos() + decay / w * (w * t).sin())));
        list.push(Expected::at(t, "x'", -envelope * (w + decay * decay / w) * (w * t).sin()));
    }
    list
}

/// `x = x₀ cos ωt` with 5 kN/m and 2 kg.
pub(crate) fn table_spring() -> Vec<Expected> {
    let (x0, w) = (0.15, 2500.0_f64.sqrt());
    let mut list = Vec::new();
    for t in [0.1, 0.7, 2.0] {
        list.push(Expected::at(t, "x", x0 * (w * t).cos()));
        list.push(Expected::at(t, "x'", -x0 * w * (w * t).sin()));
    }
    list
}

/// After a pulse: the speed is impulse over mass, the path that of a mass hit at the pulse's middle.
fn pulse(middle: f64) -> Vec<Expected> {
    let v = 6.0 / 3.0;
    [70.0, 100.0].iter().flat_map(|&t| [Expected::at(t, "x'", v), Expected::at(t, "x", v * (t - middle))]).collect()
}

/// From 61.803 s on for 5 ms.
pub(crate) fn pulse_rectangular() -> Vec<Expected> {
    pulse(61.803 + 0.0025)
}

/// About 61.803 s.
pub(crate) fn pulse_smooth() -> Vec<Expected> {
    pulse(61.803)
}

/// Two normal modes of 20 masses between springs.
pub(crate) fn spring_chain() -> Vec<Expected> {
    let (n, m, c) = (20, 1.5, 400.0);
    let angle = |j: f64| j * PI / f64::from(n + 1);
    let mode = |a: f64, j: f64, k: i32, t: f64| {
        let w = 2.0 * f64::sqrt(c / m) * (angle(j) / 2.0).sin();
        a * (angle(j) * f64::from(k)).sin() * (w * t).cos()
    };
    let mut list = Vec::new();
    for t in [0.3, 1.0, 5.0] {
        for k in 1..=n {
            list.push(Expected::at(t, format!("x[{k}]"), mode(0.05, 1.0, k, t) + mode(0.02, 7.0, k, t)));
        }
    }
    list
}

/// Radii of the axles in a steady turn: `R_k² = R_(k−1)² + a_(k−1)² − l_k²`, `R_1 = l_1/tan δ`.
pub(crate) fn radii(delta: f64, l: &[f64], a: &[f64], t: f64) -> Vec<Expected> {
    let mut r = l[0] / delta.tan();
    let mut list = Vec::new();
    for k in 0..l.len() {
        if k > 0 {
            r = (r * r + a[k - 1] * a[k - 1] - l[k] * l[k]).sqrt();
        }
        list.push(Expected::at(t, format!("v_B[{0}]/omega[{0}]", k + 1), r));
    }
    list
}

/// A planetary gear with a standing ring turns with constant acceleration. With `i = w_c/w_s = z_s/(z_s + z_r)`, a planet
/// turns by `−(z_s/z_p)(w_s − w_c)` on the arm.
///
/// ```text
/// w_s′ = (M − L i)/(J_s + i² (J_c + 3 m a²) + 3 J_p w_p²/w_s²)
/// ```
pub(crate) fn planetary() -> Vec<Expected> {
    let (m, l, z_s, z_p): (f64, f64, f64, f64) = (0.4, 0.9, 18.0, 27.0);
    let (m_p, j_s, j_p, j_c) = (0.15, 1e-4, 2e-4, 3e-3);
    let a = 2e-3 * (z_s + z_p) / 2.0;
    let i = z_s / (2.0 * z_s + 2.0 * z_p);
    let relative = -z_s / z_p * (1.0 - i);
    let planet = i + relative;
    let inertia = j_s + i * i * (j_c + 3.0 * m_p * a * a) + 3.0 * j_p * planet * planet;
    let w = (m - l * i) / inertia;
    let mut list = Vec::new();
    for t in [0.5, 1.0, 2.0] {
        let turned = 0.5 * w * t * t;
        list.push(Expected::at(t, "s", 0.3 + turned));
        list.push(Expected::at(t, "c", i * turned));
        list.push(Expected::at(t, "p[1] - 0.1", relative * turned));
        list.push(Expected::at(t, "p[2] - 0.2", relative * turned));
        list.push(Expected::at(t, "planet[3].omega_z", planet * w * t));
        // a planet that only the sun's teeth drive
        list.push(Expected::at(t, "inner[2].torque", j_p * planet * w));
    }
    list
}

/// `x = x_0 (1 − cos w t)`, `x_0 = M (r_1/r_2)/(r k)`, `w² = k/(m + (J_2 + J_1 (r_2/r_1)²)/r²)`
pub(crate) fn rack() -> Vec<Expected> {
    let (m, r_1, r_2, r, k): (f64, f64, f64, f64, f64) = (2.0, 0.12, 0.04, 0.05, 200.0);
    let (j_1, j_2, mass) = (0.02, 0.003, 1.5);
    let i = r_2 / r_1; // of the large wheel by the small one
    let w = (k / (mass + (j_2 + j_1 * i * i) / (r * r))).sqrt();
    let rest = m * i / (r * k);
    let mut list = Vec::new();
    for t in [0.5, 1.0, 3.0] {
        let x = rest * (1.0 - (w * t).cos());
        let acceleration = rest * w * w * (w * t).cos();
        let tooth = mass * acceleration + k * x;
        let torque = j_2 * acceleration / r + r * tooth;
        list.push(Expected::at(t, "x", x));
        list.push(Expected::at(t, "psi + 0.4", x / r));
        list.push(Expected::at(t, "phi - 1", -i * x / r));
        list.push(Expected::at(t, "mesh.force", tooth));
        list.push(Expected::at(t, "pair.torque", torque));
        list.push(Expected::at(t, "pair.force", torque / r_2));
    }
    list
}

/// A disc of radius r that runs round inside a sphere at a constant lean α, its contact at `P_x = R sin θ` from the middle,
/// its centre at `c_x = P_x − r sin α`:
///
/// ```text
/// Ω² [ r m c_x cos α + J_t cos α sin α − J_a cos α (sin α − P_x/r) ] = r m g sin α
/// F = m (−Ω² c_x, 0, g),    n = (−sin θ, 0, cos θ)
/// ```
pub(crate) fn bowl() -> Vec<Expected> {
    let (m, r, radius, theta, alpha, g): (f64, f64, f64, f64, f64, f64) = (1.3, 0.3, 2.0, 0.8, 0.5, 9.81);
    let (sin, cos) = alpha.sin_cos();
    let p = radius * theta.sin();
    let c = p - r * sin;
    let turn = r * m * c * cos + m * r * r / 4.0 * cos * sin - m * r * r / 2.0 * cos * (sin - p / r);
    let rate = (r * m * g * sin / turn).sqrt();
    let mut list = Vec::new();
    for t in [1.0, 2.0, 5.0] {
        let (y, x) = (rate * t).sin_cos();
        list.push(Expected::at(t, "disc.x", c * x));
        list.push(Expected::at(t, "disc.y", c * y));
        list.push(Expected::at(t, "disc.z", r * cos - radius * theta.cos()));
        list.push(Expected::at(t, "disc.eyz", sin));
        list.push(Expected::at(t, "contact.x", p * x));
        list.push(Expected::at(t, "contact.y", p * y));
        list.push(Expected::at(t, "contact.along", 0.0));
        list.push(Expected::at(t, "contact.fz", m * g));
        list.push(Expected::at(t, "contact.normal", m * (rate * rate * c * theta.sin() + g * theta.cos())));
    }
    list
}
