//! Scenes and runs that the tests share.
#![allow(dead_code)]

use headland_model::{Model, Scene};
use headland_sim::{Run, RunOptions, Silent, Status, run};

pub const TRAIN: &str = include_str!("../../../../models/paper_train.toml");
pub const CARTESIAN: &str = include_str!("../../../../models/paper_train_cartesian.toml");
pub const PIVOT: &str = include_str!("../../../../models/pendulum_prescribed_pivot.toml");
pub const DOUBLE: &str = include_str!("../../../../models/double_pendulum.toml");
pub const SLEIGH: &str = include_str!("../../../../models/chaplygin_sleigh.toml");
pub const SNAKEBOARD: &str = include_str!("../../../../models/snakeboard.toml");
pub const ROAD: &str = include_str!("../../../../models/road_train.toml");

pub fn read(text: &str) -> Scene {
    Scene::parse("scene.toml", text).unwrap_or_else(|e| panic!("{e}"))
}

pub fn set(scene: &mut Scene, settings: &[(&str, &str)]) {
    for (name, value) in settings {
        scene.set(name, value).unwrap_or_else(|e| panic!("{e}"));
    }
}

pub fn build(scene: &Scene) -> Model {
    scene.build().unwrap_or_else(|e| panic!("{e}"))
}

/// The run of a model, some options changed.
pub fn run_with(model: &Model, change: impl FnOnce(&mut RunOptions)) -> Run {
    let mut options = RunOptions::of(model);
    change(&mut options);
    run(model, &options, &mut Silent).unwrap_or_else(|e| panic!("{}: {e}", model.title))
}

/// A run that must reach its end.
pub fn done(model: &Model, change: impl FnOnce(&mut RunOptions)) -> Run {
    let result = run_with(model, change);
    assert_eq!(result.report.status, Status::Done, "{}", model.title);
    result
}

/// One coordinate `x` in metres with mass `m` = 2 kg at rest at 0.
pub fn particle() -> Scene {
    let mut s = Scene::new("particle");
    s.entry("parameters", "m", "2 kg")
        .entry("coordinates", "x", "m")
        .entry("initial", "x", 0.0)
        .entry("initial", "x'", 0.0);
    s.element("inertia", &[("name", "m"), ("value", "m"), ("geometric", "x")]);
    s.entry("outputs", "columns", &["x", "x'"][..]);
    s
}

/// The particle with a force along x.
pub fn forced(force: &str) -> Scene {
    let mut s = particle();
    s.element("force", &[("name", "F"), ("value", force), ("geometric", "x")]);
    s
}

/// `n` masses in a row between walls, with springs (one of them stiffening) and dampers.
pub fn chain(n: usize) -> Scene {
    let mut s = Scene::new("chain");
    s.entry("indices", "k", n as f64).entry("indices", "j", n as f64 - 1.0);
    s.entry("coordinates", "x[k]", "m").entry("initial", "x[k]", "0.1*sin(k)").entry(
        "initial",
        "x[k]'",
        "0.2*cos(3*k)",
    );
    s.entry("definitions", "d[j]", "x[j+1] - x[j]");
    s.element("inertia", &[("name", "m[k]"), ("value", "(1 + k/10)*1[kg]"), ("geometric", "x[k]")]);
    s.element("elastic", &[("name", "c[j]"), ("value", "40[N/m]*(1 + j/5)"), ("geometric", "d[j]")]);
    s.element("dissipative", &[("name", "b[j]"), ("value", "0.5[N*s/m]"), ("geometric", "d[j]")]);
    s.element("force", &[("name", "hard[j]"), ("value", "-500[N/m^3]*d[j]^3"), ("geometric", "d[j]")]);
    s.element("elastic", &[("name", "wall"), ("value", "100[N/m]"), ("geometric", "x[1]")]);
    s.element("force", &[("name", "drive"), ("value", "3[N]*sin(2[1/s]*t)"), ("geometric", &format!("x[{n}]"))]);
    s
}

/// `n` pendulums hanging from each other, with damped joints: a full mass matrix of the angles.
pub fn pendulums(n: usize) -> Scene {
    let mut s = Scene::new("pendulums");
    s.entry("indices", "k", n as f64).entry("indices", "j", n as f64 - 1.0);
    s.entry("parameters", "m", "0.5 kg").entry("parameters", "l", "0.3 m").entry("parameters", "g", "9.81 m/s^2");
    s.entry("coordinates", "phi[k]", "rad").entry("initial", "phi[k]", "0.3*cos(2*k)").entry(
        "initial",
        "phi[k]'",
        "0.5*sin(k)",
    );
    s.entry("definitions", "x[1]", "l*sin(phi[1])").entry("definitions", "y[1]", "-l*cos(phi[1])");
    s.entry("definitions", "x[j+1]", "x[j] + l*sin(phi[j+1])").entry("definitions", "y[j+1]", "y[j] - l*cos(phi[j+1])");
    s.element("inertia", &[("name", "m[k], x"), ("value", "m"), ("geometric", "x[k]")]);
    s.element("inertia", &[("name", "m[k], y"), ("value", "m*(1 + 0.1*k)"), ("geometric", "y[k]")]);
    s.element("force", &[("name", "weight[k]"), ("value", "-m*g"), ("geometric", "y[k]")]);
    s.element("dissipative", &[("name", "joint[j]"), ("value", "0.01[N*m*s]"), ("geometric", "phi[j+1] - phi[j]")]);
    s
}
