//! What a run tells: [`Trajectory`], [`RunReport`], how it ended, and the [`Observer`] that watches.

use serde::Serialize;

/// How a run ended: a value, not an error.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case", tag = "status", content = "reason")]
pub enum Status {
    /// The end was reached.
    Done,
    /// An event of the scene ended it, or the observer.
    Stopped(String),
    /// It could not go on; what was computed until then is kept.
    Failed(String),
}

/// Something that happened on the way.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LogEntry {
    /// When, in s.
    pub t: f64,
    /// What.
    pub message: String,
}

/// The columns of a run: first the time, then the outputs of the scene.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Trajectory {
    /// Names of the outputs.
    pub names: Vec<String>,
    /// Their units.
    pub units: Vec<String>,
    /// Times, s.
    pub t: Vec<f64>,
    /// One row a time, one value an output.
    pub rows: Vec<Vec<f64>>,
}

impl Trajectory {
    /// The values of one output.
    pub fn column(&self, i: usize) -> Vec<f64> {
        self.rows.iter().map(|r| r[i]).collect()
    }

    /// The values of an output by name.
    pub fn named(&self, name: &str) -> Option<Vec<f64>> {
        self.names.iter().position(|n| n == name).map(|i| self.column(i))
    }
}

/// What was counted and checked. Times are wall-clock seconds and differ from run to run; everything else does not.
#[derive(Clone, Debug, Serialize)]
pub struct RunReport {
    /// How it ended.
    #[serde(flatten)]
    pub status: Status,
    /// Title of the scene.
    pub title: String,
    /// Method that finished the run.
    pub method: String,
    /// Why this method.
    pub why: String,
    /// Relative tolerance.
    pub tolerance: f64,
    /// Time reached, s.
    pub t_end: f64,
    /// Coordinates.
    pub coordinates: usize,
    /// Degrees of freedom: quasi-velocities.
    pub degrees_of_freedom: usize,
    /// Accepted steps.
    pub steps: u64,
    /// Rejected steps.
    pub rejected: u64,
    /// Evaluations of the right-hand side by the integrator.
    pub rhs: u64,
    /// States evaluated for outputs and the energy balance.
    pub rhs_outputs: u64,
    /// Jacobians.
    pub jacobians: u64,
    /// Factorizations.
    pub factorizations: u64,
    /// Events.
    pub events: u64,
    /// Changes of the independent rates.
    pub repartitions: u64,
    /// Changes of contacts between rolling, sliding and free.
    pub mode_changes: u64,
    /// Restarts of the method, those at breakpoints included.
    pub restarts: u64,
    /// Derivation, s.
    pub derive_s: f64,
    /// Compilation, s.
    pub compile_s: f64,
    /// Integration alone, s: the least of the repeats.
    pub run_s: f64,
    /// Median of the repeats, where there are several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub run_s_median: Option<f64>,
    /// Operations of one evaluation of the right-hand side, of the equations that were in use at the end.
    pub operations: usize,
    /// What evaluates.
    pub evaluator: &'static str,
    /// Algorithm of the derivation that was kept.
    pub algorithm: &'static str,
    /// Why that one.
    pub algorithm_why: String,
    /// Largest difference of work and energy, relative to the largest energy and work so far; none if not asked for.
    pub energy_balance: Option<f64>,
    /// Largest residual of position constraints; none where there are none.
    pub constraint_position: Option<f64>,
    /// Largest residual of the velocity constraints in form (1); none where there are none.
    pub constraint_velocity: Option<f64>,
    /// Events, warnings, changes of method and of partition.
    pub log: Vec<LogEntry>,
}

/// Watches a run; the library itself prints nothing.
pub trait Observer {
    /// After each accepted step.
    fn step(&mut self, _t: f64, _h: f64) {}
    /// A warning or an event.
    fn message(&mut self, _t: f64, _message: &str) {}
    /// Asked after each accepted step: a reason ends the run as [`Status::Stopped`], with all that was computed.
    fn stop(&mut self) -> Option<String> {
        None
    }
}

/// Sees nothing.
pub struct Silent;
impl Observer for Silent {}
