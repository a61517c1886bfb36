//! From the steps of a method to the steps the caller sees: stops, events, limits.

use crate::events::Locator;
use crate::problem::EvalFailure;
use crate::{Integrator, OdeProblem, Options, SolveError, Stats, Step};

/// What stops and events need of a problem, whatever its equations.
pub(crate) trait Watched {
    /// Length of the state that the driver keeps: `y`, or `y` and `ẏ` one after the other.
    fn state_len(&self) -> usize;
    fn state_name(&self, i: usize) -> String;
    fn watch_count(&self) -> usize;
    fn watch(&mut self, t: f64, state: &[f64], g: &mut [f64]) -> Result<(), EvalFailure>;
    fn watch_name(&self, i: usize) -> String;
}

impl Watched for dyn OdeProblem + '_ {
    fn state_len(&self) -> usize {
        self.len()
    }
    fn state_name(&self, i: usize) -> String {
        self.component_name(i)
    }
    fn watch_count(&self) -> usize {
        self.event_count()
    }
    fn watch(&mut self, t: f64, state: &[f64], g: &mut [f64]) -> Result<(), EvalFailure> {
        self.events(t, state, g)
    }
    fn watch_name(&self, i: usize) -> String {
        self.event_name(i)
    }
}

/// What a method does: one accepted step after the other, and a look back into the last one.
pub(crate) trait Stepper: Send {
    /// The problem's trait object.
    type Problem<'p>: ?Sized + Watched;
    fn name(&self) -> &'static str;
    fn begin(&mut self, problem: &mut Self::Problem<'_>, t: f64, y: &[f64]) -> Result<(), SolveError>;
    /// One accepted step that evaluates nothing beyond `t_stop`.
    fn advance(&mut self, problem: &mut Self::Problem<'_>, t_stop: f64) -> Result<(), SolveError>;
    /// Start and end of the last step; both the start before there is one.
    fn span(&self) -> (f64, f64);
    fn order(&self) -> u8;
    /// State at the end of the last step.
    fn y_end(&self) -> &[f64];
    /// Dense output in the last step.
    fn dense(&mut self, problem: &mut Self::Problem<'_>, t: f64, y: &mut [f64]) -> Result<(), SolveError>;
    /// The same without evaluations, perhaps less accurate.
    fn sketch(&mut self, t: f64, y: &mut [f64]);
    fn set_h_max(&mut self, h: f64);
    fn proposed_step(&self) -> Option<f64> {
        None
    }
    fn set_leniency(&mut self, factor: f64) {
        let _ = factor;
    }
    fn looks_stiff(&self) -> bool {
        false
    }
    fn stats(&self) -> &Stats;
    fn stats_mut(&mut self) -> &mut Stats;
}

/// An integrator made of a [`Stepper`].
pub(crate) struct Driver<S> {
    stepper: S,
    max_steps: u64,
    t: f64,
    t_previous: f64,
    y: Vec<f64>,
    locator: Locator,
    started: bool,
    n: usize,
}

impl<S: Stepper> Driver<S> {
    /// For states of `n` numbers; `options` have been checked.
    pub(crate) fn new(stepper: S, n: usize, options: &Options) -> Self {
        Self {
            stepper,
            max_steps: options.max_steps,
            t: f64::NAN,
            t_previous: f64::NAN,
            y: vec![0.0; n],
            locator: Locator::new(n, options.event_samples),
            started: false,
            n,
        }
    }

    /// Where the state goes next: to the end of the step, to the stop or to an event.
    fn go_through_step(&mut self, problem: &mut S::Problem<'_>, t_stop: f64) -> Result<Step, SolveError> {
        let (t_begin, t_end) = self.stepper.span();
        let t_next = t_end.min(t_stop);
        if let Some(hit) = self.locator.search(&mut self.stepper, problem, self.t, t_next)? {
            self.move_to(hit.t);
            self.y.copy_from_slice(self.locator.y_hit());
            self.stepper.stats_mut().events += 1;
            return Ok(hit.step());
        }
        if t_next == t_end {
            self.y.copy_from_slice(self.stepper.y_end());
        } else {
            self.stepper.dense(problem, t_next, &mut self.y)?;
        }
        self.move_to(t_next);
        Ok(if t_next == t_stop {
            Step::End { t: t_next }
        } else {
            Step::Advanced { t: t_next, h: t_end - t_begin, order: self.stepper.order() }
        })
    }

    fn move_to(&mut self, t: f64) {
        self.t_previous = self.t;
        self.t = t;
    }

    pub(crate) fn start(&mut self, problem: &mut S::Problem<'_>, t: f64, y: &[f64]) -> Result<(), SolveError> {
        assert_eq!(y.len(), self.n, "state of another length than the method's");
        assert_eq!(problem.state_len(), self.n, "problem of another length");
        let bad = |component: String, value| SolveError::InvalidStart { t, component, value };
        if !t.is_finite() {
            return Err(bad("t".to_owned(), t));
        }
        if let Some(i) = y.iter().position(|v| !v.is_finite()) {
            return Err(bad(problem.state_name(i), y[i]));
        }
        if self.started {
            self.stepper.stats_mut().restarts += 1;
        }
        self.started = true;
        self.t = t;
        self.t_previous = t;
        self.y.copy_from_slice(y);
        self.stepper.begin(problem, t, y)?;
        self.locator.start(problem, t, y, self.stepper.stats_mut())
    }

    pub(crate) fn step(&mut self, problem: &mut S::Problem<'_>, t_stop: f64) -> Result<Step, SolveError> {
        assert!(self.started, "step before the first start");
        let t = self.t;
        if !t_stop.is_finite() || t_stop < t {
            return Err(SolveError::InvalidStop { t, t_stop });
        }
        if let Some(hit) = self.locator.next_waiting() {
            self.t_previous = t;
            self.stepper.stats_mut().events += 1;
            return Ok(hit.step());
        }
        if t_stop - t <= 4.0 * f64::EPSILON * t.abs().max(t_stop.abs()) {
            self.move_to(t_stop);
            return Ok(Step::End { t: t_stop });
        }
        if t >= self.stepper.span().1 {
            let steps = self.stepper.stats().steps;
            if steps >= self.max_steps {
                return Err(SolveError::TooManySteps { t, steps });
            }
            self.stepper.advance(problem, t_stop)?;
            self.stepper.stats_mut().steps += 1;
        }
        self.go_through_step(problem, t_stop)
    }

    pub(crate) fn interpolate(
        &mut self,
        problem: &mut S::Problem<'_>,
        t: f64,
        y: &mut [f64],
    ) -> Result<(), SolveError> {
        assert_eq!(y.len(), self.n, "state of another length than the method's");
        let slack = 1e-9 * (self.t - self.t_previous);
        assert!(
            t >= self.t_previous - slack && t <= self.t + slack,
            "time {t} is outside the last step, {} to {}",
            self.t_previous,
            self.t
        );
        if t >= self.t {
            y.copy_from_slice(&self.y);
            return Ok(());
        }
        self.stepper.dense(problem, t.max(self.t_previous), y)
    }

    pub(crate) fn t(&self) -> f64 {
        self.t
    }

    pub(crate) fn t_previous(&self) -> f64 {
        self.t_previous
    }

    pub(crate) fn state(&self) -> &[f64] {
        &self.y
    }

    pub(crate) fn set_h_max(&mut self, h: f64) {
        assert!(h > 0.0, "longest step {h} must be positive");
        self.stepper.set_h_max(h);
    }

    pub(crate) fn events_waiting(&self) -> usize {
        self.locator.waiting()
    }

    pub(crate) fn stepper(&self) -> &S {
        &self.stepper
    }
}

/// Every method for `ẏ = f(t, y)`.
impl<S> Integrator for Driver<S>
where
    S: for<'p> Stepper<Problem<'p> = dyn OdeProblem + 'p>,
{
    fn name(&self) -> &'static str {
        self.stepper().name()
    }

    fn start(&mut self, problem: &mut dyn OdeProblem, t: f64, y: &[f64]) -> Result<(), SolveError> {
        Self::start(self, problem, t, y)
    }

    fn step(&mut self, problem: &mut dyn OdeProblem, t_stop: f64) -> Result<Step, SolveError> {
        Self::step(self, problem, t_stop)
    }

    fn t(&self) -> f64 {
        Self::t(self)
    }

    fn t_previous(&self) -> f64 {
        Self::t_previous(self)
    }

    fn y(&self) -> &[f64] {
        self.state()
    }

    fn interpolate(&mut self, problem: &mut dyn OdeProblem, t: f64, y: &mut [f64]) -> Result<(), SolveError> {
        Self::interpolate(self, problem, t, y)
    }

    fn set_h_max(&mut self, h: f64) {
        Self::set_h_max(self, h);
    }

    fn proposed_step(&self) -> Option<f64> {
        self.stepper.proposed_step()
    }

    fn set_leniency(&mut self, factor: f64) {
        self.stepper.set_leniency(factor);
    }

    fn events_waiting(&self) -> usize {
        Self::events_waiting(self)
    }

    fn looks_stiff(&self) -> bool {
        self.stepper().looks_stiff()
    }

    fn stats(&self) -> &Stats {
        self.stepper().stats()
    }
}
