//! SUNDIALS IDA: variable-order BDF for differential-algebraic equations `F(t, y, ẏ) = 0`, with
//! Newton's method on dense matrices.
//!
//! The library takes the steps; stops, events and limits are the same code as for every method, with
//! `[y; ẏ]` for the state.
//!
//! # References
//! Hindmarsh et al., *SUNDIALS: Suite of Nonlinear and Differential/Algebraic Equation Solvers*, ACM
//! TOMS 31 (2005); Brown, Hindmarsh, Petzold, *Consistent initial condition calculation for
//! differential-algebraic systems*, SIAM J. Sci. Comput. 19 (1998).

mod ffi;
mod start;

use sundials_sys as sys;

use self::ffi::{Counts, Session};
use crate::consistent::{Equations, Start};
use crate::driver::{Driver, Stepper};
use crate::sundials::{BadEvaluation, Failed, OUT_OF_MEMORY};
use crate::{DaeProblem, Function, Options, SolveError, Stats, Step};

/// How many tolerances an equation may be off at a start that is taken as it is.
const START_SLACK: f64 = 1e3;

/// IDA at work on a [`DaeProblem`], one step a call; the same contract as
/// [`Integrator`](crate::Integrator) has for time, events and errors.
///
/// ```
/// use headland_solve::{DaeProblem, EvalFailure, Ida, Options, Step};
///
/// /// A decay `ẏ₀ = −y₁` through an algebraic `y₁ = y₀`.
/// struct Decay;
///
/// impl DaeProblem for Decay {
///     fn len(&self) -> usize {
///         2
///     }
///     fn differential(&self) -> &[bool] {
///         &[true, false]
///     }
///     fn residual(&mut self, _t: f64, y: &[f64], dy: &[f64], r: &mut [f64]) -> Result<(), EvalFailure> {
///         r.copy_from_slice(&[dy[0] + y[1], y[1] - y[0]]);
///         Ok(())
///     }
/// }
///
/// let mut ida = Ida::new(2, Options::new(1e-8, vec![1e-10; 2]))?;
/// let (mut y, mut dy) = ([1.0, 0.0], [0.0, 0.0]);
/// let report = ida.make_consistent(&mut Decay, 0.0, &mut y, &mut dy)?;
/// assert_eq!(report.changes[0].component, "y[1]");
/// ida.start(&mut Decay, 0.0, &y, &dy)?;
/// while !matches!(ida.step(&mut Decay, 1.0)?, Step::End { .. }) {}
/// assert!((ida.y()[0] - (-1f64).exp()).abs() < 1e-6);
/// # Ok::<(), headland_solve::SolveError>(())
/// ```
pub struct Ida {
    driver: Driver<Stepping>,
    options: Options,
    n: usize,
    /// Both `y` and `ẏ`.
    state: Vec<f64>,
}

impl Ida {
    /// An integrator for `n` components.
    ///
    /// # Errors
    /// [`SolveError::InvalidOption`].
    pub fn new(n: usize, options: Options) -> Result<Self, SolveError> {
        options.check(n)?;
        if let Some(order) = options.max_order.filter(|order| !(1..=5).contains(order)) {
            return Err(SolveError::InvalidOption {
                option: "max_order".to_owned(),
                value: order.to_string(),
                expected: "from 1 to 5".to_owned(),
            });
        }
        let stepping = Stepping::new(n, &options)?;
        Ok(Self { driver: Driver::new(stepping, 2 * n, &options), options, n, state: vec![0.0; 2 * n] })
    }

    /// `ida`
    #[must_use]
    pub fn name(&self) -> &'static str {
        self.driver.stepper().name()
    }

    /// Starts at `(t, y, ẏ)`, or restarts after a discontinuity; the statistics go on.
    ///
    /// # Errors
    /// [`SolveError::StartNotConsistent`] if the equations do not hold there to a thousand times the
    /// tolerances: see [`make_consistent`](Self::make_consistent). Otherwise if the state is not
    /// finite, or a function cannot be evaluated there.
    /// # Panics
    /// If a length is not the `n` that this was made for.
    pub fn start(&mut self, problem: &mut dyn DaeProblem, t: f64, y: &[f64], dy: &[f64]) -> Result<(), SolveError> {
        assert_eq!([y.len(), dy.len()], [self.n; 2], "state of another length than the method's");
        let (first, second) = self.state.split_at_mut(self.n);
        first.copy_from_slice(y);
        second.copy_from_slice(dy);
        self.driver.start(problem, t, &self.state)
    }

    /// Goes one accepted step towards `t_stop`, which is hit exactly and beyond which this call
    /// evaluates nothing.
    ///
    /// # Errors
    /// See [`SolveError`]. `t`, `y` and `dy` stay the last good state; go on with
    /// [`start`](Self::start).
    /// # Panics
    /// Before the first [`start`](Self::start).
    pub fn step(&mut self, problem: &mut dyn DaeProblem, t_stop: f64) -> Result<Step, SolveError> {
        self.driver.step(problem, t_stop)
    }

    /// Time reached.
    #[must_use]
    pub fn t(&self) -> f64 {
        self.driver.t()
    }

    /// Time at which the last call of [`step`](Self::step) set out.
    #[must_use]
    pub fn t_previous(&self) -> f64 {
        self.driver.t_previous()
    }

    /// State at [`t`](Self::t).
    #[must_use]
    pub fn y(&self) -> &[f64] {
        &self.driver.state()[..self.n]
    }

    /// Its derivative.
    #[must_use]
    pub fn dy(&self) -> &[f64] {
        &self.driver.state()[self.n..]
    }

    /// The solution and its derivative at a time between [`t_previous`](Self::t_previous) and
    /// [`t`](Self::t), of the current order.
    ///
    /// # Errors
    /// If the library fails.
    /// # Panics
    /// If the time is outside, by more than rounding.
    pub fn interpolate(
        &mut self,
        problem: &mut dyn DaeProblem,
        t: f64,
        y: &mut [f64],
        dy: &mut [f64],
    ) -> Result<(), SolveError> {
        self.driver.interpolate(problem, t, &mut self.state)?;
        y.copy_from_slice(&self.state[..self.n]);
        dy.copy_from_slice(&self.state[self.n..]);
        Ok(())
    }

    /// Changes the longest step, from the next step of the method on.
    ///
    /// # Panics
    /// If `h` is not positive.
    pub fn set_h_max(&mut self, h: f64) {
        self.driver.set_h_max(h);
    }

    /// Events at the same time that the next calls of [`step`](Self::step) will report.
    #[must_use]
    pub fn events_waiting(&self) -> usize {
        self.driver.events_waiting()
    }

    /// What was counted so far: `rhs` are evaluations of the residual.
    #[must_use]
    pub fn stats(&self) -> &Stats {
        self.driver.stepper().stats()
    }
}

/// The method behind the driver.
struct Stepping {
    session: Session,
    rtol: f64,
    atol: Vec<f64>,
    suppress_algebraic: bool,
    h_first: Option<f64>,
    h_max: f64,
    /// `h_max` was lowered: the step already planned may be longer.
    h_max_fell: bool,
    /// Whether a step was taken since the start.
    has_step: bool,
    t0: f64,
    t1: f64,
    /// `[y; ẏ]` at `t1`.
    end: Vec<f64>,
    order: u8,
    stats: Stats,
    /// What was counted before the last start.
    base: Stats,
}

impl Stepping {
    fn new(n: usize, options: &Options) -> Result<Self, SolveError> {
        Ok(Self {
            session: Session::new(n, options).map_err(|f| unexpected(f, 0.0))?,
            rtol: options.rtol,
            atol: options.atol.clone(),
            suppress_algebraic: options.suppress_algebraic,
            h_first: options.h_first,
            h_max: options.h_max,
            h_max_fell: false,
            has_step: false,
            t0: 0.0,
            t1: 0.0,
            end: vec![0.0; 2 * n],
            order: 0,
            stats: Stats::default(),
            base: Stats::default(),
        })
    }

    fn update_stats(&mut self) {
        let Counts { error_test_failures, solve_failures, setups, iterations, iteration_failures, jacobians } =
            self.session.counts();
        let (stats, base) = (&mut self.stats, &self.base);
        stats.rhs = self.session.evaluations();
        stats.rejected = base.rejected + error_test_failures + solve_failures;
        stats.factorizations = base.factorizations + setups;
        stats.nonlinear_iterations = base.nonlinear_iterations + iterations;
        stats.nonlinear_failures = base.nonlinear_failures + iteration_failures;
        stats.jacobians = base.jacobians + jacobians;
    }

    /// The state at `t` for a look at its equations.
    fn inspect(&self, t: f64, state: &[f64]) -> Start<'_> {
        Start { t, state: state.to_vec(), rtol: self.rtol, atol: &self.atol, iterations: 0 }
    }

    /// What a failed step means.
    fn step_error(&mut self, problem: &mut dyn DaeProblem, failed: Failed) -> SolveError {
        let t = self.t1;
        let h = (self.session.t_last_evaluation() - t).abs();
        match failed.code {
            sys::IDA_ERR_FAIL | sys::IDA_CONV_FAIL | sys::IDA_LSETUP_FAIL | sys::IDA_LSOLVE_FAIL => {
                self.explain(problem, h, failed)
            }
            sys::IDA_TOO_MUCH_ACC => SolveError::ToleranceTooSmall { t, factor: self.session.tolerance_factor() },
            sys::IDA_RES_FAIL | sys::IDA_REP_RES_ERR | sys::IDA_FIRST_RES_FAIL => match self.session.bad_evaluation() {
                None => unexpected(failed, t),
                Some(bad) => evaluation_error(problem, bad),
            },
            _ => unexpected(failed, t),
        }
    }

    /// The error for a step that fails however small: by an evaluation ahead, by equations that are
    /// singular, by a start that breaks a hidden constraint, or by none of them.
    fn explain(&mut self, problem: &mut dyn DaeProblem, h: f64, failed: Failed) -> SolveError {
        if let Some(bad) = self.session.bad_evaluation() {
            return evaluation_error(problem, bad);
        }
        let t = self.t1;
        let worst = problem.component_name(self.session.worst_component());
        let mut here = self.inspect(t, &self.end);
        if let Err(singular) = here.check_regular(problem) {
            return singular;
        }
        if !self.has_step
            && let Ok(open) = here.undetermined(problem)
            && !open.is_empty()
        {
            let undetermined = open.iter().map(|u| u.name(problem)).collect();
            return SolveError::HiddenConstraint { t, h, worst, undetermined };
        }
        match failed.code {
            sys::IDA_ERR_FAIL => SolveError::StepTooSmall { t, h, worst },
            sys::IDA_CONV_FAIL => SolveError::NonlinearFailed { t, h },
            _ => unexpected(failed, t),
        }
    }
}

impl Stepper for Stepping {
    type Problem<'p> = dyn DaeProblem + 'p;

    fn name(&self) -> &'static str {
        "ida"
    }

    fn begin(&mut self, problem: &mut (dyn DaeProblem + '_), t: f64, state: &[f64]) -> Result<(), SolveError> {
        let n = self.atol.len();
        assert_eq!(problem.differential().len(), n, "differential() of another length than the problem");
        let equations = self.inspect(t, state).violated(problem, Equations::All, START_SLACK)?;
        if !equations.is_empty() {
            return Err(SolveError::StartNotConsistent { t, equations });
        }
        (self.t0, self.t1) = (t, t);
        self.end.copy_from_slice(state);
        self.has_step = false;
        self.h_max_fell = false;
        self.base = self.stats;
        let suppress = self.suppress_algebraic;
        let tested = |i: usize| problem.in_error_test(i) && (problem.differential()[i] || !suppress);
        let (y, dy) = state.split_at(n);
        let started = self.session.start(problem, t, [y, dy], tested, self.h_first, self.h_max);
        started.map_err(|failed| unexpected(failed, t))
    }

    fn advance(&mut self, problem: &mut (dyn DaeProblem + '_), t_stop: f64) -> Result<(), SolveError> {
        let mut stop = t_stop;
        if std::mem::take(&mut self.h_max_fell) && self.has_step && self.session.next_step_size() > self.h_max {
            stop = t_stop.min(self.t1 + self.h_max);
        }
        let outcome = self.session.step(problem, stop, t_stop);
        self.update_stats();
        let t = outcome.map_err(|failed| self.step_error(problem, failed))?;
        if t <= self.t1 {
            let h = self.session.next_step_size();
            return Err(self.explain(problem, h, Failed { doing: "stepping", code: sys::IDA_ERR_FAIL }));
        }
        (self.t0, self.t1) = (self.t1, t);
        let (y, dy) = self.end.split_at_mut(self.atol.len());
        y.copy_from_slice(self.session.y());
        dy.copy_from_slice(self.session.dy());
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
        &self.end
    }

    fn dense(&mut self, _problem: &mut (dyn DaeProblem + '_), t: f64, state: &mut [f64]) -> Result<(), SolveError> {
        if !self.has_step {
            state.copy_from_slice(&self.end);
            return Ok(());
        }
        let (y, dy) = state.split_at_mut(self.atol.len());
        let got = self.session.interpolate(t, 0, y).and_then(|()| self.session.interpolate(t, 1, dy));
        got.map_err(|failed| unexpected(failed, t))
    }

    fn sketch(&mut self, t: f64, state: &mut [f64]) {
        let (y, dy) = state.split_at_mut(self.atol.len());
        if self.session.interpolate(t, 0, y).and_then(|()| self.session.interpolate(t, 1, dy)).is_err() {
            state.copy_from_slice(&self.end);
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

fn evaluation_error(problem: &dyn DaeProblem, bad: BadEvaluation) -> SolveError {
    let BadEvaluation { function, t, .. } = bad;
    match (bad.component, function) {
        (Some(i), Function::Residual | Function::Jacobian) => {
            SolveError::NotFinite { function, t, component: problem.equation_name(i) }
        }
        (Some(i), _) => SolveError::NotFinite { function, t, component: problem.component_name(i) },
        (None, _) => SolveError::EvaluationFailed { function, t },
    }
}

/// A failure that no model should be able to cause, in words.
fn unexpected(failed: Failed, t: f64) -> SolveError {
    let text = match failed.code {
        OUT_OF_MEMORY | sys::IDA_MEM_FAIL | sys::IDA_NO_MALLOC => "out of memory, or the solver is not there",
        sys::IDA_TOO_MUCH_WORK => "too many steps in one call",
        sys::IDA_ILL_INPUT => "an argument is out of its range",
        sys::IDA_LINIT_FAIL => "the linear solver could not be prepared",
        sys::IDA_LSETUP_FAIL => "the iteration matrix could not be set up",
        sys::IDA_LSOLVE_FAIL => "the linear solver failed",
        sys::IDA_RES_FAIL | sys::IDA_REP_RES_ERR | sys::IDA_FIRST_RES_FAIL => "the residual could not be evaluated",
        sys::IDA_CONSTR_FAIL => "an inequality constraint could not be met",
        sys::IDA_LINESEARCH_FAIL => "the line search for a start failed",
        sys::IDA_NO_RECOVERY => "no start could be evaluated",
        sys::IDA_NLS_INIT_FAIL | sys::IDA_NLS_SETUP_FAIL => "the nonlinear solver could not be prepared",
        sys::IDA_NLS_FAIL => "the nonlinear solver failed",
        sys::IDA_BAD_EWT => "an error weight is not positive",
        sys::IDA_BAD_K => "no derivative of that order",
        sys::IDA_BAD_T => "the time is outside the last step",
        sys::IDA_BAD_DKY => "no vector to write to",
        sys::IDA_VECTOROP_ERR => "a vector operation failed",
        _ => "an unknown failure",
    };
    SolveError::Library { t, doing: failed.doing, text, code: failed.code }
}
