//! Scenes built in code and pseudo-random states of them.
#![allow(dead_code)]

use headland_dynamics::{DeriveOptions, Equations, derive};
use headland_expr::{Dual, NodeId};
use headland_model::{Model, Scene};

/// Numbers of a fixed seed (splitmix64).
pub struct Random(pub u64);

impl Random {
    pub fn between(&mut self, a: f64, b: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        a + (b - a) * ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }
}

pub fn build(scene: &Scene) -> Model {
    scene.build().unwrap_or_else(|e| panic!("{e}"))
}

pub fn derived(model: &Model) -> Equations {
    derive(model, &DeriveOptions::default()).unwrap_or_else(|e| panic!("{}: {e}", model.title))
}

fn structure(scene: &mut Scene, section: &str, name: &str, value: &str, form: &str, text: &str) {
    scene.element(section, &[("name", name), ("value", value), (form, text)]);
}

pub fn double_pendulum() -> Scene {
    let mut s = Scene::new("double pendulum with a spring and dampers");
    for (name, value) in [("m1", "1.5 kg"), ("m2", "1 kg"), ("l1", "1 m"), ("l2", "0.7 m"), ("g", "9.81 m/s^2")] {
        s.entry("parameters", name, value);
    }
    s.entry("parameters", "c", "3 N*m").entry("parameters", "b", "0.2 N*m*s");
    s.entry("coordinates", "a", "rad").entry("coordinates", "b1", "rad");
    s.entry("definitions", "x1", "l1*sin(a)").entry("definitions", "y1", "-l1*cos(a)");
    s.entry("definitions", "x2", "x1 + l2*sin(b1)").entry("definitions", "y2", "y1 - l2*cos(b1)");
    for (name, value) in [("x1", "m1"), ("y1", "m1"), ("x2", "m2"), ("y2", "m2")] {
        structure(&mut s, "inertia", name, value, "geometric", name);
    }
    structure(&mut s, "force", "weight 1", "-m1*g", "geometric", "y1");
    structure(&mut s, "force", "weight 2", "-m2*g", "geometric", "y2");
    structure(&mut s, "elastic", "spring", "c", "geometric", "a - b1");
    structure(&mut s, "dissipative", "damper", "b", "implicit", "a' - b1'");
    structure(&mut s, "dissipative", "bearing", "b", "geometric", "a");
    s.entry("initial", "a", 1.0).entry("initial", "b1", -0.4).entry("initial", "a'", 0.3).entry("initial", "b1'", 0.1);
    s
}

/// Chaplygin's sleigh; the mass by geometric structures, by closed one-forms of the rates, or wrongly by body velocities.
pub fn sleigh(how: &str) -> Scene {
    let mut s = Scene::new("sleigh");
    s.entry("parameters", "m", "1 kg").entry("parameters", "J", "0.5 kg*m^2").entry("parameters", "b", "0.3 m");
    s.entry("coordinates", "x", "m").entry("coordinates", "y", "m").entry("coordinates", "theta", "rad");
    s.entry("quasi_velocities", "v", "m/s").entry("quasi_velocities", "w", "rad/s");
    s.entry("kinematics", "x'", "v*cos(theta)").entry("kinematics", "y'", "v*sin(theta)").entry(
        "kinematics",
        "theta'",
        "w",
    );
    let (long, lat) = match how {
        "geometric" => (("geometric", "x + b*cos(theta)"), ("geometric", "y + b*sin(theta)")),
        "rates" => (("implicit", "x' - b*theta'*sin(theta)"), ("implicit", "y' + b*theta'*cos(theta)")),
        "explicit" => (("explicit", "v"), ("explicit", "b*w")),
        "implicit" => {
            (("implicit", "x'*cos(theta) + y'*sin(theta)"), ("implicit", "y'*cos(theta) - x'*sin(theta) + b*theta'"))
        }
        "world by u" => (("explicit", "v*cos(theta) - b*w*sin(theta)"), ("explicit", "v*sin(theta) + b*w*cos(theta)")),
        _ => panic!("{how}"),
    };
    structure(&mut s, "inertia", "m, long", "m", long.0, long.1);
    structure(&mut s, "inertia", "m, lat", "m", lat.0, lat.1);
    structure(&mut s, "inertia", "J", "J", "geometric", "theta");
    structure(&mut s, "force", "drive", "2 N", "explicit", "v");
    for name in ["x", "y", "theta"] {
        s.entry("initial", name, 0.1);
    }
    s.entry("initial", "v", -1.0).entry("initial", "w", 0.8);
    s
}

fn train_parameters(s: &mut Scene, n: usize) {
    let list = |f: &dyn Fn(usize) -> String| -> Vec<String> { (0..n).map(f).collect() };
    let mut put = |name: &str, values: Vec<String>| {
        let values: Vec<&str> = values.iter().map(String::as_str).collect();
        s.entry("parameters", name, &values[..]);
    };
    put("l", list(&|k| format!("{} m", 4 + k % 3)));
    put("a", list(&|k| format!("{} m", 0.5 + 0.25 * (k % 4) as f64)));
    put("b", list(&|k| format!("{} m", 2 + k % 2)));
    put("m", list(&|k| format!("{} kg", 8000 + 1000 * (k % 5))));
    put("J", list(&|k| format!("{} kg*m^2", 20000 + 10000 * (k % 3))));
    put("F_B", list(&|_| "3000 N".into()));
    s.entry("indices", "k", "len(l)").entry("parameters", "F0", "9600 N").entry("parameters", "kp", "2000 N*s/m");
    s.entry("coordinates", "x_A1", "m").entry("coordinates", "y_A1", "m").entry("coordinates", "theta[k]", "rad");
    s.entry("coordinates", "gamma", "rad").entry("prescribed", "gamma", "0.1*(1 + tanh((t - 3)/1.0))");
    s.entry("initial", "x_A1", 0.0).entry("initial", "y_A1", 0.0).entry("initial", "theta[k]", "0.05*k");
}

/// The article's train: form (2), explicit structures.
pub fn train(n: usize) -> Scene {
    let mut s = Scene::new("train");
    train_parameters(&mut s, n);
    s.entry("quasi_velocities", "v", "m/s").entry("initial", "v", 18.0);
    for (name, text) in [
        ("psi[1]", "gamma"),
        ("psi[k+1]", "theta[k] - theta[k+1] - atan(a[k]/l[k]*tan(psi[k]))"),
        ("v_A[1]", "v"),
        ("v_A[k+1]", "v_A[k]*sqrt(cos(psi[k])^2 + (a[k]/l[k])^2*sin(psi[k])^2)"),
        ("v_C[k]", "v_A[k]*sqrt(cos(psi[k])^2 + (b[k]/l[k])^2*sin(psi[k])^2)"),
        ("v_B[k]", "v_A[k]*cos(psi[k])"),
    ] {
        s.entry("definitions", name, text);
    }
    s.entry("kinematics", "x_A1'", "v*cos(theta[1] + psi[1])").entry("kinematics", "y_A1'", "v*sin(theta[1] + psi[1])");
    s.entry("kinematics", "theta[k]'", "v_A[k]*sin(psi[k])/l[k]");
    structure(&mut s, "inertia", "m[k]", "m[k]", "explicit", "v_C[k]");
    structure(&mut s, "inertia", "J[k]", "J[k]", "geometric", "theta[k]");
    structure(&mut s, "force", "F_A1", "F0 + kp*(18 - v)", "explicit", "v");
    structure(&mut s, "force", "F_B[k]", "-F_B[k]", "explicit", "v_B[k]");
    s
}

/// The same train in Cartesian coordinates: form (1), geometric structures.
pub fn cartesian_train(n: usize) -> Scene {
    let mut s = Scene::new("cartesian train");
    train_parameters(&mut s, n);
    for (name, text) in [
        ("x_A[1]", "x_A1"),
        ("y_A[1]", "y_A1"),
        ("x_A[k+1]", "x_A[k] - (l[k] + a[k])*cos(theta[k])"),
        ("y_A[k+1]", "y_A[k] - (l[k] + a[k])*sin(theta[k])"),
        ("x_B[k]", "x_A[k] - l[k]*cos(theta[k])"),
        ("y_B[k]", "y_A[k] - l[k]*sin(theta[k])"),
        ("heading", "theta[1] + gamma"),
        ("v", "x_A1'*cos(heading) + y_A1'*sin(heading)"),
        ("v_B[k]", "x_B[k]'*cos(theta[k]) + y_B[k]'*sin(theta[k])"),
    ] {
        s.entry("definitions", name, text);
    }
    s.element("constraint", &[("name", "steered"), ("equation", "x_A1'*sin(heading) = y_A1'*cos(heading)")]);
    s.element("constraint", &[("name", "axle[k]"), ("equation", "x_B[k]'*sin(theta[k]) = y_B[k]'*cos(theta[k])")]);
    structure(&mut s, "inertia", "m_x[k]", "m[k]", "geometric", "x_B[k] + b[k]*cos(theta[k])");
    structure(&mut s, "inertia", "m_y[k]", "m[k]", "geometric", "y_B[k] + b[k]*sin(theta[k])");
    structure(&mut s, "inertia", "J[k]", "J[k]", "geometric", "theta[k]");
    structure(&mut s, "force", "F_A1", "F0 + kp*(18 - v)", "implicit", "v");
    structure(&mut s, "force", "F_B[k]", "-F_B[k]", "implicit", "v_B[k]");
    s.entry("initial", "x_A1'", "18*cos(heading)").entry("initial", "y_A1'", "18*sin(heading)");
    s
}

/// A pendulum on a spring whose pivot is moved: drift in the structures.
pub fn prescribed_pivot() -> Scene {
    let mut s = Scene::new("pendulum with a prescribed pivot");
    s.entry("parameters", "m", "0.4 kg").entry("parameters", "c", "20 N/m").entry("parameters", "g", "9.81 m/s^2");
    s.entry("coordinates", "phi", "rad").entry("coordinates", "r", "m").entry("coordinates", "p", "m");
    s.entry("prescribed", "p", "0.1*cos(3*t) + 0.02*t^2");
    s.entry("definitions", "x", "p + r*sin(phi)").entry("definitions", "y", "-r*cos(phi)");
    structure(&mut s, "inertia", "x", "m", "geometric", "x");
    structure(&mut s, "inertia", "y", "m", "geometric", "y");
    structure(&mut s, "force", "weight", "-m*g", "geometric", "y");
    structure(&mut s, "elastic", "spring", "c", "geometric", "r - 0.3");
    structure(&mut s, "dissipative", "air", "0.1", "geometric", "x");
    s.entry("initial", "phi", 0.5).entry("initial", "r", 0.5).entry("initial", "phi'", 0.0).entry("initial", "r'", 0.2);
    s
}

/// A particle on rails that turn and slide by functions of time: rheonomic rows in form (1), with drift.
pub fn turning_rails() -> Scene {
    let mut s = Scene::new("two particles on turning rails");
    s.entry("parameters", "w", "1 rad/s").entry("parameters", "l", "1 m");
    for name in ["x", "y", "z", "s"] {
        s.entry("coordinates", name, "m").entry("initial", name, 0.3);
        structure(&mut s, "inertia", &format!("m, {name}"), "2 kg", "geometric", name);
        structure(&mut s, "elastic", &format!("c, {name}"), "30 N/m", "geometric", name);
    }
    structure(&mut s, "inertia", "both", "1 kg", "geometric", "x + 2*z*s/l");
    s.element(
        "constraint",
        &[("name", "rail"), ("equation", "x'*sin(w*t + 1) - y'*cos(w*t + 1)*(2 + x*s/l^2) = l*w*cos(2*w*t)")],
    );
    s.element("constraint", &[("name", "link"), ("equation", "x*x'/l + y'*exp(s/l) + z' = s' + 0.2*l*w^2*t")]);
    s.entry("initial", "x'", 0.4).entry("initial", "z'", -0.1);
    s
}

/// Inputs of the graph at a pseudo-random state: time, coordinates, quasi-velocities, and all rates by (2).
pub fn state(model: &Model, equations: &Equations, random: &mut Random) -> Vec<f64> {
    let mut x = headland_dynamics::sample::start_inputs(model);
    x[model.input_index(model.time)] += random.between(0.0, 5.0);
    for c in &model.coordinates {
        x[model.input_index(c.q)] += random.between(-0.5, 0.5);
    }
    for u in &equations.kinematics.quasi {
        x[model.input_index(u.u)] = random.between(-2.0, 2.0);
    }
    put_rates(model, equations, &mut x);
    x
}

/// Writes `q′ = G u + g` into the inputs, and `u′`, `q″`.
pub fn put_rates(model: &Model, equations: &Equations, x: &mut [f64]) {
    for (c, rate) in model.coordinates.iter().zip(model.graph.eval(&equations.kinematics.rates, x)) {
        x[model.input_index(c.rate)] = rate;
    }
    let a = accelerations(model, equations, x);
    for (u, a) in equations.kinematics.quasi.iter().zip(&a) {
        x[model.input_index(u.acceleration)] = *a;
    }
    let drift = model.graph.eval(&equations.kinematics.drift, x);
    for (i, c) in model.coordinates.iter().enumerate() {
        let g = model.graph.eval(&equations.g[i], x);
        x[model.input_index(c.acceleration)] = drift[i] + g.iter().zip(&a).map(|(g, a)| g * a).sum::<f64>();
    }
}

/// `u′` by the unrolled solution, or by numbers.
pub fn accelerations(model: &Model, equations: &Equations, x: &[f64]) -> Vec<f64> {
    if let Some(a) = &equations.accelerations {
        return model.graph.eval(a, x);
    }
    let (mut m, mut f) = (model.graph.eval(&equations.mass, x), model.graph.eval(&equations.force, x));
    headland_dynamics::solve::solve_ldl(&mut m, &mut f);
    f
}

/// Values and derivatives in time along the motion.
pub fn along(model: &Model, nodes: &[NodeId], x: &[f64]) -> Vec<Dual<f64>> {
    let mut duals: Vec<Dual<f64>> = x.iter().map(|x| Dual::new(*x, 0.0)).collect();
    duals[model.input_index(model.time)].dot = 1.0;
    for c in &model.coordinates {
        duals[model.input_index(c.q)].dot = x[model.input_index(c.rate)];
        duals[model.input_index(c.rate)].dot = x[model.input_index(c.acceleration)];
    }
    for u in &model.quasi_velocities {
        duals[model.input_index(u.u)].dot = x[model.input_index(u.acceleration)];
    }
    model.graph.eval(nodes, &duals)
}
