//! **headland**: multibody dynamics for wheeled, rolling and coupled machines.
//!
//! List the inertia and force elements of a machine with their structures; headland derives the equations of motion,
//! checks the derivation against itself, compiles them, picks an integrator and gives trajectories, energies and plots.
//!
//! # Ten minutes
//!
//! A scene is a TOML file, or is built in Rust:
//!
//! ```
//! use headland::{RunOptions, Scene, Silent, Status};
//!
//! let mut scene = Scene::parse("sleigh.toml", r#"
//! title = "Chaplygin's sleigh"
//! [parameters]
//! m = "1 kg"
//! J = "0.5 kg*m^2"
//! b = "0.3 m"          # knife edge to mass centre
//! [coordinates]
//! x = "m"              # of the knife edge
//! y = "m"
//! theta = "rad"
//! [quasi_velocities]
//! v = "m/s"
//! w = "rad/s"
//! [kinematics]         # form (2): the edge does not slip sideways
//! "x'" = "v*cos(theta)"
//! "y'" = "v*sin(theta)"
//! "theta'" = "w"
//! [[inertia]]
//! name = "m, x"
//! value = "m"
//! geometric = "x + b*cos(theta)"
//! [[inertia]]
//! name = "m, y"
//! value = "m"
//! geometric = "y + b*sin(theta)"
//! [[inertia]]
//! name = "J"
//! value = "J"
//! geometric = "theta"
//! [initial]
//! x = 0
//! y = 0
//! theta = 0
//! v = "1 m/s"
//! w = "2 rad/s"
//! "#)?;
//! scene.set("b", "0.4")?;                                  // still metres
//! let model = scene.build()?;                              // names, units, families: all errors in one go
//! let result = headland::run(&model, &RunOptions::of(&model), &mut Silent)?;
//! assert_eq!(result.report.status, Status::Done);
//! assert!(result.report.energy_balance.unwrap() < 1e-7);   // no force does work
//! # Ok::<(), headland::Error>(())
//! ```
//!
//! The steps one by one: [`Scene`] says what there is, [`Scene::build`] makes a [`Model`], [`derive()`] its
//! [`Equations`], [`equations_text`] prints them, [`System`] compiles them, [`run()`] does all of it.

pub use headland_code as code;
pub use headland_dynamics as dynamics;
pub use headland_expr as expr;
pub use headland_model as model;
pub use headland_sim as sim;
pub use headland_solve as solve;

pub use headland_dynamics::linearise::{LinearState, LineariseError, Linearised, Mode, linearise};
pub use headland_dynamics::present::{Form, equations_text};
pub use headland_dynamics::{Algorithm, DeriveError, DeriveOptions, Equations, derive};
pub use headland_model::{Model, ModelError, Scene};
pub use headland_sim::{
    Observer, Run, RunError, RunOptions, RunReport, Silent, StateFunction, StateFunctions, Status, System, Trajectory,
    initial_state, run,
};
pub use headland_solve::{Method, SolveError, method_names};

/// The report with the versions of what made it: what `summary.json` holds.
pub fn summary(report: &RunReport) -> serde_json::Value {
    let mut summary = serde_json::to_value(report).unwrap_or_default();
    if let Some(object) = summary.as_object_mut() {
        let versions = serde_json::json!({ "headland": env!("CARGO_PKG_VERSION"), "methods": method_names() });
        object.insert("versions".into(), versions);
    }
    summary
}

/// A linear system with its eigenvalues and the versions of what made it: what `linear.json` holds.
///
/// Matrices row by row, SI units. `a` and `b` are of `states`; `full` has the cyclic displacements as well.
pub fn linear_summary(title: &str, linear: &Linearised, modes: &[Mode]) -> serde_json::Value {
    use serde_json::{Value, json};
    let state = |s: &LinearState| json!({ "name": s.name, "unit": s.unit, "value": s.value });
    let names = |cyclic: bool| linear.states.iter().filter(move |s| s.cyclic == cyclic);
    let kept = linear.kept();
    let all: Vec<usize> = (0..linear.states.len()).collect();
    let inputs: Vec<usize> = (0..linear.inputs.len()).collect();
    let velocities: Vec<usize> = (0..linear.mass.nrows()).collect();
    let matrix = |rows: &[usize], columns: &[usize], value: &dyn Fn(usize, usize) -> f64| -> Value {
        rows.iter().map(|&i| columns.iter().map(|&j| value(i, j)).collect::<Vec<f64>>()).collect::<Vec<_>>().into()
    };
    let mode = |m: &Mode| {
        let of: Vec<&str> = m.states.iter().map(|&i| linear.states[kept[i]].name.as_str()).collect();
        json!({
            "eigenvalue": [m.re, m.im], "frequency_hz": m.frequency(), "damping": m.damping(),
            "half_life_s": m.half_life(), "states": of,
        })
    };
    json!({
        "title": title,
        "about": if linear.at_rest { "equilibrium" } else { "steady motion" },
        "t": linear.t,
        "states": names(false).map(state).collect::<Vec<_>>(),
        "cyclic": names(true).map(state).collect::<Vec<_>>(),
        "inputs": linear.inputs.iter().map(state).collect::<Vec<_>>(),
        "a": matrix(&kept, &kept, &|i, j| linear.a[(i, j)]),
        "b": matrix(&kept, &inputs, &|i, j| linear.b[(i, j)]),
        "modes": modes.iter().map(mode).collect::<Vec<_>>(),
        "full": {
            "states": linear.states.iter().map(|s| s.name.as_str()).collect::<Vec<_>>(),
            "a": matrix(&all, &all, &|i, j| linear.a[(i, j)]),
            "b": matrix(&all, &inputs, &|i, j| linear.b[(i, j)]),
            "mass": matrix(&velocities, &velocities, &|i, j| linear.mass[(i, j)]),
        },
        "versions": { "headland": env!("CARGO_PKG_VERSION") },
    })
}

/// Whatever can go wrong between a scene and a run; each stage has its own error.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The scene.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The derivation.
    #[error(transparent)]
    Derive(#[from] DeriveError),
    /// The linearisation.
    #[error(transparent)]
    Linearise(#[from] LineariseError),
    /// The run.
    #[error(transparent)]
    Run(#[from] RunError),
    /// An integrator.
    #[error(transparent)]
    Solve(#[from] SolveError),
}
