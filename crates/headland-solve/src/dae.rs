//! Differential-algebraic problems: what [`Ida`](crate::Ida) is handed.

use crate::driver::Watched;
use crate::{EvalFailure, Pattern};

/// An initial value problem `F(t, y, ẏ) = 0` with events and conditions on its start.
///
/// ```text
/// F(t, y, ẏ) = 0        J = ∂F/∂y + c ∂F/∂ẏ        event i: g_i(t, y, ẏ) changes sign
/// ```
/// Component `i` is *differential* if `ẏ_i` appears in `F`, else *algebraic* (a multiplier, say).
/// The index should be 1, or 2 with the algebraic components of index 2 left out of the error test
/// ([`in_error_test`](Self::in_error_test), [`Options::suppress_algebraic`](crate::Options::suppress_algebraic)):
/// constraints on positions go in with those on velocities, as in the form of Gear, Gupta and
/// Leimkuhler.
///
/// A value that is NaN or infinite counts as [`EvalFailure::Recoverable`].
///
/// # References
/// Brenan, Campbell, Petzold, *Numerical Solution of Initial-Value Problems in Differential-Algebraic
/// Equations*, SIAM 1996; Gear, Gupta, Leimkuhler, *Automatic integration of Euler-Lagrange equations
/// with constraints*, J. Comput. Appl. Math. 12 (1985).
pub trait DaeProblem {
    /// Number of components of `y`, and of equations.
    fn len(&self) -> usize;

    /// Whether there are no components at all.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// For each component, whether its derivative appears. Must not change between two starts.
    fn differential(&self) -> &[bool];

    /// Writes `r = F(t, y, ẏ)`.
    ///
    /// # Errors
    /// If `F` cannot be evaluated there.
    fn residual(&mut self, t: f64, y: &[f64], dy: &[f64], r: &mut [f64]) -> Result<(), EvalFailure>;

    /// Where `∂F/∂y` or `∂F/∂ẏ` may differ from zero; `None` means that there is no exact Jacobian,
    /// and that differences of [`residual`](Self::residual) are taken. Must not change between two
    /// starts.
    fn pattern(&self) -> Option<&Pattern> {
        None
    }

    /// Writes the values of `∂F/∂y + c ∂F/∂ẏ` in the order of [`pattern`](Self::pattern).
    ///
    /// # Errors
    /// If the Jacobian cannot be evaluated there.
    fn jacobian(&mut self, t: f64, y: &[f64], dy: &[f64], c: f64, values: &mut [f64]) -> Result<(), EvalFailure> {
        let _ = (t, y, dy, c, values);
        Err(EvalFailure::Fatal)
    }

    /// Whether component `i` counts in the error test of a step.
    fn in_error_test(&self, i: usize) -> bool {
        let _ = i;
        true
    }

    /// Number of event functions. Must not change between two starts.
    fn event_count(&self) -> usize {
        0
    }

    /// Writes the event functions `g(t, y, ẏ)`.
    ///
    /// # Errors
    /// If they cannot be evaluated there; as the step is accepted by then, this ends the run.
    fn events(&mut self, t: f64, y: &[f64], dy: &[f64], g: &mut [f64]) -> Result<(), EvalFailure> {
        let _ = (t, y, dy, g);
        Ok(())
    }

    /// Conditions on a start beyond `F = 0`, solved one level after the other by
    /// [`Ida::make_consistent`](crate::Ida::make_consistent): for a mechanism the positions, then the
    /// velocities, then accelerations and multipliers (the hidden constraints).
    fn start_levels(&self) -> Vec<StartLevel> {
        Vec::new()
    }

    /// Writes the residuals of the equations of one of the [`start_levels`](Self::start_levels).
    ///
    /// # Errors
    /// If they cannot be evaluated there.
    fn start_residual(
        &mut self,
        level: usize,
        t: f64,
        y: &[f64],
        dy: &[f64],
        r: &mut [f64],
    ) -> Result<(), EvalFailure> {
        let _ = (level, t, y, dy, r);
        Err(EvalFailure::Fatal)
    }

    /// Name of a component, for messages.
    fn component_name(&self, i: usize) -> String {
        format!("y[{i}]")
    }

    /// Name of an equation, for messages.
    fn equation_name(&self, i: usize) -> String {
        format!("equation[{i}]")
    }

    /// Name of an event function, for messages.
    fn event_name(&self, i: usize) -> String {
        format!("event[{i}]")
    }
}

/// A number of the start that may be changed.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub enum Unknown {
    /// Component `y_i`.
    Y(usize),
    /// Derivative `ẏ_i`.
    Dy(usize),
}

impl Unknown {
    /// Its place in `y` and `ẏ` put one after the other.
    pub(crate) fn slot(self, n: usize) -> usize {
        match self {
            Self::Y(i) => i,
            Self::Dy(i) => n + i,
        }
    }

    pub(crate) fn name(self, problem: &dyn DaeProblem) -> String {
        match self {
            Self::Y(i) => problem.component_name(i),
            Self::Dy(i) => format!("d/dt {}", problem.component_name(i)),
        }
    }
}

/// Equations that a start must satisfy, and the numbers that are changed to that end, as little as
/// possible: the step of Gauss and Newton of least `Σ (Δ_j / scale_j)²`, damped where it must be.
#[derive(Clone, PartialEq, Debug)]
pub struct StartLevel {
    /// Names of the equations, for messages; as many as [`DaeProblem::start_residual`] writes.
    pub equations: Vec<String>,
    /// What may be changed.
    pub unknowns: Vec<Unknown>,
    /// How easily each is changed, in its unit.
    pub scales: Vec<f64>,
}

impl StartLevel {
    /// A level with all scales 1.
    #[must_use]
    pub fn new(equations: Vec<String>, unknowns: Vec<Unknown>) -> Self {
        let scales = vec![1.0; unknowns.len()];
        Self { equations, unknowns, scales }
    }
}

/// The driver's state is `[y; ẏ]`.
impl Watched for dyn DaeProblem + '_ {
    fn state_len(&self) -> usize {
        2 * self.len()
    }
    fn state_name(&self, i: usize) -> String {
        let n = self.len();
        let unknown = if i < n { Unknown::Y(i) } else { Unknown::Dy(i - n) };
        match unknown {
            Unknown::Y(i) => self.component_name(i),
            Unknown::Dy(i) => format!("d/dt {}", self.component_name(i)),
        }
    }
    fn watch_count(&self) -> usize {
        self.event_count()
    }
    fn watch(&mut self, t: f64, state: &[f64], g: &mut [f64]) -> Result<(), EvalFailure> {
        let (y, dy) = state.split_at(state.len() / 2);
        self.events(t, y, dy, g)
    }
    fn watch_name(&self, i: usize) -> String {
        self.event_name(i)
    }
}
