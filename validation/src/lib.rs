//! Reference problems of headland: scenes whose motion is known by other mathematics (closed forms, integrations in
//! more than double precision of equations derived independently, other programs' published numbers).
//!
//! ```
//! let results = headland_validation::run(&["damped_oscillator".into()]);
//! assert!(results.iter().all(|r| r.passed()));
//! println!("{}", headland_validation::to_table(&results));
//! ```
//!
//! # Pipeline
//! 1. [`cases()`]: the table, one [`Case`] a row, from `cases/*.rs`; scenes and reference files are compiled in.
//! 2. [`Case::run`] builds the scene, changes what the case sets, integrates and compares.
//!    [`linear_cases()`] are scenes linearised about their start, by [`LinearCase::run`].
//! 3. [`CaseResult`] has the worst comparison; [`to_table`] and [`to_json`] show it.
//!
//! The error of a value is absolute relative to `max(1, |reference|)`; beside the values, the largest defect of work
//! against energy of the run is held below a bound. Scenes are in `models/` and `validation/scenes/`, reference values
//! with their sources in `validation/reference/`.

mod case;
pub mod cases;
mod closed;
mod linear;
mod reduced;
mod reference;
mod report;

pub use case::{Case, CaseResult, Comparison, Expected, Moment, value_of};
pub use cases::{cases, linear_cases};
pub use linear::LinearCase;
pub use report::{to_json, to_table};

/// Names of all problems.
#[must_use]
pub fn names() -> Vec<&'static str> {
    cases().map(|c| c.name).chain(linear_cases().map(|c| c.name)).collect()
}

/// Runs the problems whose names contain one of the given ones; all of them if none is given.
#[must_use]
pub fn run(names: &[String]) -> Vec<CaseResult> {
    let wanted = |name: &str| names.is_empty() || names.iter().any(|n| name.contains(n.as_str()));
    let runs = cases().filter(|c| wanted(c.name)).map(Case::run);
    runs.chain(linear_cases().filter(|c| wanted(c.name)).map(LinearCase::run)).collect()
}
