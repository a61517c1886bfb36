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
    /// The equations do not hold at the start, and no start near it is found where they do.
    #[error(
        "no consistent start at t = {t} s after {iterations} iterations: {}; \
         equations that contradict each other, or a guess too far away",
        list_residuals(.equations)
    )]
    InconsistentStart {
        /// Time of the start, in s.
        t: f64,
        /// What is left of the equations, the largest relative to its tolerance first.
        equations: Vec<EquationResidual>,
        /// Iterations made; 0 if none was asked for.
        iterations: u32,
    },
    /// The equations do not hold at a start that was to be taken as it is.
    #[error("the equations do not hold at the start, t = {t} s: {}; make_consistent finds a start where they do",
        list_residuals(.equations))]
    StartNotConsistent {
        /// Time of the start, in s.
        t: f64,
        /// The equations that do not hold, the largest relative to its tolerance first.
        equations: Vec<EquationResidual>,
    },
    /// Equations that say the same, or nothing, about the unknowns, so that others stay open.
    #[error("the equations are singular at t = {t} s: {}", list_singular(.equations, .unknowns))]
    SingularEquations {
        /// Time reached, in s.
        t: f64,
        /// Sets of equations that depend on each other; one alone contains none of the unknowns.
        equations: Vec<Vec<String>>,
        /// Components that the equations do not determine.
        unknowns: Vec<String>,
    },
    /// The first step fails however small: the start breaks a constraint that is hidden in the
    /// derivatives of the equations.
    #[error(
        "the first step from t = {t} s fails with step sizes down to {h:.1e} s; the largest error is in `{worst}`. \
         The equations alone do not determine {} (index above 1): the start must satisfy their derivatives too, \
         see start_levels", list_names(.undetermined)
    )]
    HiddenConstraint {
        /// Time of the start, in s.
        t: f64,
        /// Last step size tried, in s.
        h: f64,
        /// Component with the largest error relative to its tolerance.
        worst: String,
        /// Algebraic components and derivatives that the equations alone do not determine.
        undetermined: Vec<String>,
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
    /// The method is for another kind of problem.
    #[error("method {method} is for differential-algebraic problems; `Ida::new` makes it")]
    ForDae {
        /// Name of the method.
        method: &'static str,
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

/// What is left of an equation that should be zero.
#[derive(Clone, PartialEq, Debug)]
pub struct EquationResidual {
    /// Name of the equation.
    pub equation: String,
    /// Its residual, in its unit.
    pub residual: f64,
}

fn list_names(names: &[String]) -> String {
    let names: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
    names.join(", ")
}

fn list_residuals(equations: &[EquationResidual]) -> String {
    let one = |e: &EquationResidual| format!("`{}` is left at {:.1e}", e.equation, e.residual);
    equations.iter().map(one).collect::<Vec<_>>().join(", ")
}

fn list_singular(equations: &[Vec<String>], unknowns: &[String]) -> String {
    let mut parts: Vec<String> = equations
        .iter()
        .map(|set| match set.as_slice() {
            [one] => format!("`{one}` contains none of the unknowns"),
            set => format!("{} depend on each other", list_names(set)),
        })
        .collect();
    if !unknowns.is_empty() {
        parts.push(format!("nothing determines {}", list_names(unknowns)));
    }
    parts.join("; ")
}
