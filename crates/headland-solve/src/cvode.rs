//! SUNDIALS CVODE as a method: variable-order BDF with Newton's method on dense matrices, and
//! variable-order Adams-Moulton with fixed-point iteration.
//!
//! The library takes the steps; stops, events and limits are the same code as for every method.
//!
//! # References
//! Hindmarsh et al., *SUNDIALS: Suite of Nonlinear and Differential/Algebraic Equation Solvers*, ACM
//! TOMS 31 (2005).

mod ffi;

use sundials_sys as sys;

use self::ffi::{Counts, Session};
use crate::driver::Stepper;
use crate::sundials::{BadEvaluation, Failed};
use crate::{OdeProblem, Options, SolveError, Stats};

pub(crate) struct Cvode {
    session: Session,
    bdf: bool,
    atol: Vec<f64>,
    h_first: Option<f64>,
    h_max: f64,
    /// `h_max` was lowered: the step already planned may be longer.
    h_max_fell: bool,
    /// Whether a step was taken since the start.
    has_step: bool,
    t0: f64,
    t1: f64,
    order: u8,
    stats: Stats,
    /// What was counted before the last start.
    base: Stats,
}

impl Cvode {
    pub(crate) fn new(bdf: bool, n: usize, options: &Options) -> Result<Self, SolveError> {
        let highest = if bdf { 5 } else { 12 };
        if let Some(order) = options.max_order.filter(|order| !(1..=highest).contains(order)) {
            return Err(SolveError::InvalidOption {
                option: "max_order".to_owned(),
                value: order.to_string(),
                expected: format!("from 1 to {highest}"),
            });
        }
        let session = Session::new(bdf, n, options).map_err(|f| unexpected(f, 0.0))?;
        Ok(Self {
            session,
            bdf,
            atol: options.atol.clone(),
            h_first: options.h_first,
            h_max: options.h_max,
            h_max_fell: false,
            has_step: false,
            t0: 0.0,
            t1: 0.0,
            order: 0,
            stats: Stats::default(),
            base: Stats::default(),
        })
    }

    fn update_stats(&mut self) {
        let Counts { error_test_failures, solve_failures, setups, iterations, iteration_failures, jacobians } =
            self.session.counts();
        let (stats, base) = (&mut self.stats, &self.base);
        (stats.rhs, stats.projections) = self.session.evaluations();
        stats.rejected = base.rejected + error_test_failures + solve_failures;
        stats.factorizations = base.factorizations + setups;
        stats.nonlinear_iterations = base.nonlinear_iterations + iterations;
        stats.nonlinear_failures = base.nonlinear_failures + iteration_failures;
        stats.jacobians = base.jacobians + jacobians;
    }

    /// What a failed step means.
    fn step_error(&mut self, problem: &dyn OdeProblem, failed: Failed) -> SolveError {
        let t = self.t1;
        let h = (self.session.t_last_evaluation() - t).abs();
        match failed.code {
            sys::CV_ERR_FAILURE => self.step_too_small(problem, h),
            sys::CV_TOO_MUCH_ACC => SolveError::ToleranceTooSmall { t, factor: self.session.tolerance_factor() },
            sys::CV_CONV_FAILURE if self.session.bad_evaluation().is_none() => SolveError::NonlinearFailed { t, h },
            sys::CV_CONV_FAILURE
            | sys::CV_LSETUP_FAIL
            | sys::CV_RHSFUNC_FAIL
            | sys::CV_FIRST_RHSFUNC_ERR
            | sys::CV_REPTD_RHSFUNC_ERR
            | sys::CV_UNREC_RHSFUNC_ERR
            | sys::CV_PROJFUNC_FAIL
            | sys::CV_REPTD_PROJFUNC_ERR => match self.session.bad_evaluation() {
                None => unexpected(failed, t),
                Some(bad) => evaluation_error(problem, bad),
            },
            _ => unexpected(failed, t),
        }
    }

    /// The error for steps that no longer move the time: a failing evaluation ahead explains them.
    fn step_too_small(&mut self, problem: &dyn OdeProblem, h: f64) -> SolveError {
        if let Some(bad) = self.session.bad_evaluation() {
            return evaluation_error(problem, bad);
        }
        let worst = self.session.worst_component(&self.atol);
        SolveError::StepTooSmall { t: self.t1, h, worst: problem.component_name(worst) }
    }
}

impl Stepper for Cvode {
    type Problem<'p> = dyn OdeProblem + 'p;

    fn name(&self) -> &'static str {
        if self.bdf { "cvode-bdf" } else { "cvode-adams" }
    }

    fn begin(&mut self, problem: &mut (dyn OdeProblem + '_), t: f64, y: &[f64]) -> Result<(), SolveError> {
        if !self.bdf && problem.has_projection() {
            return Err(SolveError::Unsupported {
                method: self.name(),
                what: "project onto constraints",
                instead: "cvode-bdf and dop853",
            });
        }
        (self.t0, self.t1) = (t, t);
        self.has_step = false;
        self.h_max_fell = false;
        self.base = self.stats;
        self.session.start(problem, t, y, self.h_first, self.h_max).map_err(|failed| unexpected(failed, t))
    }

    fn advance(&mut self, problem: &mut (dyn OdeProblem + '_), t_stop: f64) -> Result<(), SolveError> {
        let mut stop = t_stop;
        if std::mem::take(&mut self.h_max_fell) && self.has_step && self.session.next_step_size() > self.h_max {
            stop = t_stop.min(self.t1 + self.h_max);
        }
        let outcome = self.session.step(problem, stop, t_stop);
        self.update_stats();
        let t = outcome.map_err(|failed| self.step_error(problem, failed))?;
        if t <= self.t1 {
            let h = self.session.next_step_size();
            return Err(self.step_too_small(problem, h));
        }
        (self.t0, self.t1) = (self.t1, t);
        self.has_step = true;
        self.order = self.session.last_order();
        Ok(())
    }

    fn span(&self) -> (f64, f64) {
        (self.t0, self.t1)
    }

    fn order(&self) -> u8 {
        self.order
    }

    fn y_end(&self) -> &[f64] {
        self.session.y()
    }

    fn dense(&mut self, _problem: &mut (dyn OdeProblem + '_), t: f64, y: &mut [f64]) -> Result<(), SolveError> {
        if !self.has_step {
            y.copy_from_slice(self.session.y());
            return Ok(());
        }
        self.session.interpolate(t, y).map_err(|failed| unexpected(failed, t))
    }

    fn sketch(&mut self, t: f64, y: &mut [f64]) {
        if self.session.interpolate(t, y).is_err() {
            y.copy_from_slice(self.session.y());
        }
    }

    fn set_h_max(&mut self, h: f64) {
        self.h_max_fell |= h < self.h_max;
        self.h_max = h;
        // Fails for a negative step only, and the driver has looked.
        let set = self.session.set_h_max(h);
        debug_assert!(set.is_ok());
    }

    fn stats(&self) -> &Stats {
        &self.stats
    }

    fn stats_mut(&mut self) -> &mut Stats {
        &mut self.stats
    }
}

fn evaluation_error(problem: &dyn OdeProblem, bad: BadEvaluation) -> SolveError {
    let BadEvaluation { function, t, .. } = bad;
    match bad.component {
        Some(i) => SolveError::NotFinite { function, t, component: problem.component_name(i) },
        None => SolveError::EvaluationFailed { function, t },
    }
}

/// A failure that no model should be able to cause, in words.
fn unexpected(failed: Failed, t: f64) -> SolveError {
    let text = match failed.code {
        sys::CV_MEM_FAIL => "out of memory",
        sys::CV_MEM_NULL | sys::CV_NO_MALLOC => "the solver is not there",
        sys::CV_ILL_INPUT => "an argument is out of its range",
        sys::CV_LINIT_FAIL => "the linear solver could not be prepared",
        sys::CV_LSETUP_FAIL => "the iteration matrix could not be set up",
        sys::CV_LSOLVE_FAIL => "the linear solver failed",
        sys::CV_NLS_INIT_FAIL | sys::CV_NLS_SETUP_FAIL => "the nonlinear solver could not be prepared",
        sys::CV_NLS_FAIL => "the nonlinear solver failed",
        sys::CV_VECTOROP_ERR => "a vector operation failed",
        sys::CV_BAD_T => "the time is outside the last step",
        sys::CV_TOO_CLOSE => "the stop is too close to the start",
        _ => "an unknown failure",
    };
    SolveError::Library { t, doing: failed.doing, text, code: failed.code }
}
