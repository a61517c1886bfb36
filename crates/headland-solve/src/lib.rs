//! Integrators for initial value problems `ẏ = f(t, y)` and `F(t, y, ẏ) = 0`, one step at a time.
//!
//! This crate knows functions, not mechanics. A problem implements [`OdeProblem`]; a [`Method`] makes
//! an [`Integrator`], which takes accepted steps, stops exactly where it is told to, finds events,
//! interpolates inside its last step, projects onto constraints and counts its work.
//!
//! ```
//! use headland_solve::{EvalFailure, Method, OdeProblem, Options, Step};
//!
//! /// A ball thrown upwards at 10 m/s: height and speed.
//! struct Ball;
//!
//! impl OdeProblem for Ball {
//!     fn len(&self) -> usize {
//!         2
//!     }
//!     fn rhs(&mut self, _t: f64, y: &[f64], dy: &mut [f64]) -> Result<(), EvalFailure> {
//!         dy.copy_from_slice(&[y[1], -9.81]);
//!         Ok(())
//!     }
//!     fn event_count(&self) -> usize {
//!         1
//!     }
//!     fn events(&mut self, _t: f64, y: &[f64], g: &mut [f64]) -> Result<(), EvalFailure> {
//!         g[0] = y[0];
//!         Ok(())
//!     }
//! }
//!
//! let options = Options::new(1e-9, vec![1e-9; 2]);
//! let mut integrator = Method::parse("dop853")?.create(2, options)?;
//! integrator.start(&mut Ball, 0.0, &[0.0, 10.0])?;
//! let landing = loop {
//!     match integrator.step(&mut Ball, 5.0)? {
//!         Step::Advanced { .. } => {}
//!         Step::Event { t, .. } => break t,
//!         Step::End { .. } => panic!("it never came down"),
//!     }
//! };
//! assert!((landing - 2.0 * 10.0 / 9.81).abs() < 1e-12);
//! assert!((integrator.y()[1] + 10.0).abs() < 1e-11);
//! # Ok::<(), headland_solve::SolveError>(())
//! ```
//!
//! # Pipeline
//! 1. [`Options`]: what is asked; [`Method::create`] checks them and makes the integrator.
//! 2. [`Integrator::start`] at `(t, y)`, again after every discontinuity.
//! 3. [`Integrator::step`] until [`Step::End`]. Behind it the driver (`driver.rs`) asks the method for
//!    an accepted step and goes through it piece by piece: events (`events.rs`), stops, limits.
//! 4. The methods: `dop853.rs` is explicit Runge-Kutta of order 8; `cvode.rs` is SUNDIALS CVODE with
//!    BDF and Adams formulas; `ida.rs` is SUNDIALS IDA for differential-algebraic problems
//!    (`DaeProblem`), with consistent starts in `consistent.rs` and `ida/start.rs`. The C library
//!    stands behind `sundials.rs`, `cvode/ffi.rs` and `ida/ffi.rs`, the only places with unsafe code.
//! 5. [`Stats`] count, a [`SolveError`] tells what went wrong. Nothing is ever printed.
//!
//! # Features
//! `cvode` (default) and `ida` link the system's SUNDIALS, version 6 or 7; `static` builds it from
//! source instead. Without them, `dop853` alone is left, and no C at all.

mod dop853;
mod dop853_tableau;
mod driver;
mod error;
mod events;
mod integrator;
mod method;
mod options;
mod problem;
mod stats;

#[cfg(feature = "ida")]
mod consistent;
#[cfg(feature = "cvode")]
mod cvode;
#[cfg(feature = "ida")]
mod dae;
#[cfg(feature = "ida")]
mod dense;
#[cfg(feature = "ida")]
mod ida;
#[cfg(any(feature = "cvode", feature = "ida"))]
mod sundials;

#[cfg(feature = "ida")]
pub use consistent::{Change, StartReport};
#[cfg(feature = "ida")]
pub use dae::{DaeProblem, StartLevel, Unknown};
pub use error::{EquationResidual, SolveError};
#[cfg(feature = "ida")]
pub use ida::Ida;
pub use integrator::{Integrator, Step};
pub use method::{Method, method_names};
pub use options::Options;
pub use problem::{EvalFailure, Function, OdeProblem, Pattern};
pub use stats::Stats;
