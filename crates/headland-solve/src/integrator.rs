//! The interface of every method.

use crate::{OdeProblem, SolveError, Stats};

/// How a call of [`Integrator::step`] ended.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Step {
    /// A step was accepted; the stop is still ahead.
    Advanced {
        /// Time reached.
        t: f64,
        /// Size of the method's step that ends there.
        h: f64,
        /// Order of the formula.
        order: u8,
    },
    /// An event function changed sign; `t` and `y` are at the event, on its far side.
    Event {
        /// Time of the event.
        t: f64,
        /// Index of the event function.
        index: usize,
        /// Whether it changed from negative to positive.
        rising: bool,
    },
    /// The stop was reached: `t` is `t_stop` to the last bit.
    End {
        /// Time reached.
        t: f64,
    },
}

/// An integration method at work on a problem, one step a call.
///
/// The same problem is handed to every call. Lengths that differ from the `n` the integrator was
/// made for are a panic, and so is a step before the first [`start`](Self::start).
///
/// # Time
/// Each call of [`step`](Self::step) covers the piece from [`t_previous`](Self::t_previous) to
/// [`t`](Self::t), and the pieces follow each other without gap. After an event inside a step of the
/// method, or after a stop nearer than the one asked for before, the next calls go through what is
/// left of that step, without evaluating the right-hand side again.
///
/// # Events
/// An event is a change of sign of an event function, located on the dense output to a few roundings
/// of `t`; the state is that of the far side, where the function has its new sign or is zero. Events
/// are reported in the order of time. Those at the same time come one a call, at the same `t`;
/// [`events_waiting`](Self::events_waiting) tells how many are left, and a restart drops them.
/// A function that is zero at the start is ignored until it has left zero, and so is at a restart
/// one whose event was reported at that very time: the ball that has just bounced does not bounce
/// again, though rounding may have left it below the floor.
pub trait Integrator: Send {
    /// Name of the method, as [`Method::parse`](crate::Method::parse) reads it.
    fn name(&self) -> &'static str;

    /// Starts at `(t, y)`, or restarts after a discontinuity; the statistics go on.
    ///
    /// # Errors
    /// If the state is not finite, a function cannot be evaluated there, or the method cannot do
    /// what the problem asks for.
    fn start(&mut self, problem: &mut dyn OdeProblem, t: f64, y: &[f64]) -> Result<(), SolveError>;

    /// Goes one accepted step towards `t_stop`, which is hit exactly and beyond which this call
    /// evaluates nothing. A `t_stop` within four roundings of `t` is reached at once.
    ///
    /// # Errors
    /// See [`SolveError`]. `t` and `y` stay the last good state; go on with
    /// [`start`](Self::start).
    fn step(&mut self, problem: &mut dyn OdeProblem, t_stop: f64) -> Result<Step, SolveError>;

    /// Time reached.
    fn t(&self) -> f64;

    /// Time at which the last call of [`step`](Self::step) set out.
    fn t_previous(&self) -> f64;

    /// State at [`t`](Self::t).
    fn y(&self) -> &[f64];

    /// The solution at a time between [`t_previous`](Self::t_previous) and [`t`](Self::t): of order
    /// 7 for `dop853` (three more evaluations of the right-hand side in a step where it is used), of
    /// the current order for the multistep methods (none).
    ///
    /// # Errors
    /// If the right-hand side cannot be evaluated.
    /// # Panics
    /// If the time is outside, by more than rounding.
    fn interpolate(&mut self, problem: &mut dyn OdeProblem, t: f64, y: &mut [f64]) -> Result<(), SolveError>;

    /// Changes the longest step, from the next step of the method on.
    ///
    /// # Panics
    /// If `h` is not positive.
    fn set_h_max(&mut self, h: f64);

    /// The step that the method would take next, where it says so beforehand (explicit Runge-Kutta only).
    fn proposed_step(&self) -> Option<f64> {
        None
    }

    /// From here on takes errors of a step up to `factor` tolerances, 1 at first: for places where rounding is larger than
    /// the tolerance and shorter steps do not help. Explicit Runge-Kutta only; others go on as they are.
    fn set_leniency(&mut self, factor: f64) {
        let _ = factor;
    }

    /// Events at the same time that the next calls of [`step`](Self::step) will report.
    fn events_waiting(&self) -> usize;

    /// Whether steps have stayed at the bound of stability for a while (explicit Runge-Kutta only):
    /// an implicit method would take longer ones.
    fn looks_stiff(&self) -> bool {
        false
    }

    /// What was counted so far.
    fn stats(&self) -> &Stats;
}
