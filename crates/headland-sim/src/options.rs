//! [`RunOptions`]: what is asked of a run; the scene's `[run]` gives what is left open.

use headland_dynamics::{DeriveError, DeriveOptions};
use headland_model::Model;
use headland_solve::SolveError;

/// What is asked of a run.
#[derive(Clone, Debug)]
pub struct RunOptions {
    /// Start, s.
    pub from: f64,
    /// End, s.
    pub until: f64,
    /// Relative tolerance; a state's absolute one is this times its scale.
    pub tolerance: f64,
    /// Method by name, or `auto`.
    pub method: String,
    /// Exactly these output times; steps end there. Without them `points` intervals by dense output.
    pub at: Option<Vec<f64>>,
    /// Output intervals.
    pub points: usize,
    /// Longest step, s.
    pub max_step: f64,
    /// Whether the energy balance is kept.
    pub balance: bool,
    /// How often the integration is run, for timing.
    pub repeat: usize,
    /// Most accepted steps.
    pub max_steps: u64,
    /// The derivation.
    pub derive: DeriveOptions,
}

impl RunOptions {
    /// As the scene says.
    pub fn of(model: &Model) -> Self {
        let run = &model.run;
        Self {
            from: run.from,
            until: run.until,
            tolerance: run.tolerance,
            method: run.method.clone(),
            at: None,
            points: run.points,
            max_step: run.max_step,
            balance: true,
            repeat: 1,
            max_steps: 50_000_000,
            derive: DeriveOptions::default(),
        }
    }
}

/// Why a run could not start. A run that started always gives a report.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RunError {
    /// No equations.
    #[error(transparent)]
    Derive(#[from] DeriveError),
    /// A method or an option is wrong.
    #[error(transparent)]
    Solve(#[from] SolveError),
    /// The method does not suit the scene.
    #[error("{message}")]
    Method {
        /// Why, and which do.
        message: String,
    },
    /// An output time outside the run.
    #[error("output time {t} s lies outside the run from {from} s to {until} s")]
    OutputTime {
        /// The time.
        t: f64,
        /// Start.
        from: f64,
        /// End.
        until: f64,
    },
    /// The run has no length.
    #[error("the run ends at {until} s but starts at {from} s")]
    Empty {
        /// Start.
        from: f64,
        /// End.
        until: f64,
    },
}
