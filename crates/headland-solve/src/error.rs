//! What can go wrong on the way.

use crate::Function;

/// Why an integrator could not be made, started, or brought further.
///
/// After an error the integrator's `t` and `y` still are the last good state.
#[derive(Clone, PartialEq, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SolveError {
    /// The error estimate asks for steps that no longer move the time.
    #[error("step size fell to {h:.1e} s at t = {t} s; the largest error is in `{worst}`")]
    StepTooSmall {
        /// Time reached, in s.
        t: f64,
        /// Last step size tried, in s.
        h: f64,
        /// Component with the largest error relative to its tolerance.
        worst: String,
    },
    /// As many steps as [`Options::max_steps`](crate::Options::max_steps) allows.
    #[error("{steps} steps taken at t = {t} s, the most that max_steps allows")]
    TooManySteps {
        /// Time reached, in s.
        t: f64,
        /// Steps taken since the integrator was made.
        steps: u64,
    },
    /// NaN or infinity at the start, or in every step however small.
    #[error("{function} at t = {t} s is not finite: `{component}`")]
    NotFinite {
        /// Function that gave it.
        function: Function,
        /// Time of the evaluation, in s.
        t: f64,
        /// First component (event function, for events) that is not finite.
        component: String,
    },
    /// A function failed for good, or in every step however small.
    #[error("{function} could not be evaluated at t = {t} s")]
    EvaluationFailed {
        /// Function that failed.
        function: Function,
        /// Time of the evaluation, in s.
        t: f64,
    },
    /// The equations of an implicit step have no solution that the solver finds.
    #[error("implicit step not solved at t = {t} s with step sizes down to {h:.1e} s")]
    NonlinearFailed {
        /// Time reached, in s.
        t: f64,
        /// Last step size tried, in s.
        h: f64,
    },
    /// The tolerances are below the rounding of the state.
    #[error("tolerances are below rounding at t = {t} s; {factor:.0} times larger would do")]
    ToleranceTooSmall {
        /// Time reached, in s.
        t: f64,
        /// Factor by which to raise them.
        factor: f64,
    },
    /// An option out of its range.
    #[error("option {option} is {value}; expected {expected}")]
    InvalidOption {
        /// Name of the field of [`Options`](crate::Options).
        option: String,
        /// What it is.
        value: String,
        /// What it can be.
        expected: String,
    },
    /// A stop that cannot be reached: not a number, infinite, or in the past.
    #[error("cannot step to t = {t_stop} s from t = {t} s; expected a finite time not before it")]
    InvalidStop {
        /// Time reached, in s.
        t: f64,
        /// Stop asked for, in s.
        t_stop: f64,
    },
    /// A start from a state or time that is not finite.
    #[error("cannot start at t = {t} s: `{component}` is {value}")]
    InvalidStart {
        /// Time of the start, in s.
        t: f64,
        /// Component, or `t`.
        component: String,
        /// Its value.
        value: f64,
    },
    /// The method cannot do what the problem asks for.
    #[error("method {method} cannot {what}; {instead} can")]
    Unsupported {
        /// Name of the method.
        method: &'static str,
        /// What it cannot do.
        what: &'static str,
        /// Methods that can.
        instead: &'static str,
    },
    /// No method of that name.
    #[error("no method `{name}`; there are {known}")]
    UnknownMethod {
        /// Name asked for.
        name: String,
        /// Names that there are.
        known: String,
    },
    /// The method was left out when this library was built.
    #[error("method {method} is not in this build; it needs the feature `{feature}`")]
    NotBuilt {
        /// Name of the method.
        method: &'static str,
        /// Feature of this crate that brings it.
        feature: &'static str,
    },
    /// SUNDIALS failed in a way that should not happen.
    #[error("SUNDIALS failed at t = {t} s while {doing}: {text} (code {code})")]
    Library {
        /// Time reached, in s.
        t: f64,
        /// What was being done.
        doing: &'static str,
        /// Meaning of the code.
        text: &'static str,
        /// Code returned.
        code: i32,
    },
}
