//! From equations to a run.
//!
//! ```
//! use headland_model::Scene;
//! use headland_sim::{RunOptions, Silent, run};
//!
//! let mut scene = Scene::new("oscillator");
//! scene.entry("coordinates", "x", "m").entry("initial", "x", 1.0).entry("initial", "x'", 0.0);
//! scene.element("inertia", &[("name", "m"), ("value", "1"), ("geometric", "x")]);
//! scene.element("elastic", &[("name", "c"), ("value", "4"), ("geometric", "x")]);
//! let model = scene.build()?;
//! let mut options = RunOptions::of(&model);
//! options.at = Some(vec![1.0]);
//! let result = run(&model, &options, &mut Silent)?;
//! assert!((result.trajectory.rows[0][0] - 2.0_f64.cos()).abs() < 1e-6);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! In order: [`system`] compiles the equations, `schedule` knows at which times a method must stop, `time_loop` steps,
//! watches and changes the partition, `modes` lets contacts roll, slide and leave with the numbers of `contact`, `record` writes rows, [`balance`] keeps the energy's account, [`report`] tells,
//! and [`run`](mod@run) does it all. Beside them, [`functions`] gives M, F, q′, u′ and their Jacobian to whoever steps himself; [`stepper`] is what
//! steps, and `dae` the other formulation: constraints with multipliers, for IDA.

pub mod balance;
mod contact;
#[cfg(feature = "ida")]
pub mod dae;
pub mod functions;
pub mod loops;
mod modes;
pub mod options;
mod passage;
pub mod project;
#[cfg(feature = "ida")]
mod rates;
mod record;
pub mod report;
pub mod run;
mod schedule;
pub mod stepper;
pub mod system;
mod time_loop;
mod together;
mod work;

pub use functions::{StateEvaluator, StateFunction, StateFunctions, initial_state};
pub use options::{RunError, RunOptions};
pub use report::{LogEntry, Observer, RunReport, Silent, Status, Trajectory};
pub use run::{Run, run};
pub use system::{Problem, System};
