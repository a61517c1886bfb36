//! What was counted.

/// Work of an [`Integrator`](crate::Integrator) since it was created; a restart does not clear it.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
#[non_exhaustive]
pub struct Stats {
    /// Accepted steps.
    pub steps: u64,
    /// Step attempts given up because of the error estimate or of a failed evaluation.
    pub rejected: u64,
    /// Evaluations of the right-hand side, those for dense output and differences included.
    pub rhs: u64,
    /// Jacobians, exact or by differences.
    pub jacobians: u64,
    /// Factorizations of the iteration matrix.
    pub factorizations: u64,
    /// Iterations of the nonlinear solver.
    pub nonlinear_iterations: u64,
    /// Times that the nonlinear solver did not converge.
    pub nonlinear_failures: u64,
    /// Evaluations of the event functions.
    pub event_evaluations: u64,
    /// Events reported.
    pub events: u64,
    /// Evaluations of the projection.
    pub projections: u64,
    /// Calls of `start` after the first.
    pub restarts: u64,
}
