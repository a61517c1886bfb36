//! A consistent start: the levels of the problem, then the library's correction, then our own.

use super::ffi::Session;
use super::{Ida, unexpected};
use crate::consistent::{Change, Equations, Start, StartReport, free_unknowns};
use crate::dae::Unknown;
use crate::{DaeProblem, SolveError};

impl Ida {
    /// Moves `(y, ẏ)` to a start at which the equations hold, and tells what was changed.
    ///
    /// 1. Each of the problem's [`start_levels`](DaeProblem::start_levels) in turn, with the least
    ///    change of its unknowns. Redundant equations are reported, contradicting ones an error.
    /// 2. `F = 0`: where it does not hold yet, by the algebraic components and the derivatives of the
    ///    differential ones (`IDACalcIC`, and where that fails the step of least change).
    /// 3. All equations are checked again: whatever comes back as `Ok` satisfies them to the
    ///    tolerances. Constraints that are hidden in the derivatives of the equations can be checked
    ///    only as far as the levels hold them: see [`StartReport::undetermined`].
    ///
    /// A run under way is not touched; [`start`](Self::start) begins one there.
    ///
    /// # Errors
    /// [`SolveError::InconsistentStart`] with the equations that cannot be satisfied,
    /// [`SolveError::SingularEquations`] with those that determine nothing, or what evaluating them
    /// led to. `y` and `dy` then are as they were.
    /// # Panics
    /// If a length is not the `n` that this was made for.
    pub fn make_consistent(
        &self,
        problem: &mut dyn DaeProblem,
        t: f64,
        y: &mut [f64],
        dy: &mut [f64],
    ) -> Result<StartReport, SolveError> {
        let n = self.n;
        assert_eq!([y.len(), dy.len(), problem.len()], [n; 3], "state of another length than the method's");
        check_finite(problem, t, y, dy)?;
        let before = [&*y, &*dy].concat();
        let Self { options, .. } = self;
        let mut start = Start { t, state: before.clone(), rtol: options.rtol, atol: &options.atol, iterations: 0 };
        let mut report = StartReport::default();

        let levels = problem.start_levels();
        for (k, level) in levels.iter().enumerate() {
            let eqs = Equations::Level(k, &level.equations);
            let slots: Vec<usize> = level.unknowns.iter().map(|u| u.slot(n)).collect();
            if !start.violated(problem, eqs, 1e-3)?.is_empty() {
                start.solve(problem, eqs, &slots, &level.scales)?;
            }
            must_hold(&mut start, problem, eqs)?;
            report.redundant.extend(start.redundant(problem, eqs, &slots, &level.scales)?);
        }

        if !start.violated(problem, Equations::All, 1e-3)?.is_empty() {
            start.check_regular(problem)?;
            let (mut y, mut dy) = (start.state[..n].to_vec(), start.state[n..].to_vec());
            let t_towards = t + options.h_max.min(1.0);
            let mut session = Session::new(n, options).map_err(|failed| unexpected(failed, t))?;
            if session.correct_start(problem, t, [&mut y, &mut dy], t_towards).is_ok()
                && y.iter().chain(&dy).all(|v| v.is_finite())
            {
                start.state = [y, dy].concat();
            }
            let slots: Vec<usize> = free_unknowns(problem).iter().map(|u| u.slot(n)).collect();
            let scales: Vec<f64> = slots.iter().map(|&s| start.magnitude(s)).collect();
            start.solve(problem, Equations::All, &slots, &scales)?;
            must_hold(&mut start, problem, Equations::All)?;
            for (k, level) in levels.iter().enumerate() {
                must_hold(&mut start, problem, Equations::Level(k, &level.equations))?;
            }
        }
        start.check_regular(problem)?;

        let open = start.undetermined(problem)?;
        let open = open.into_iter().filter(|u| !levels.iter().any(|level| level.unknowns.contains(u)));
        report.undetermined = open.map(|u| u.name(problem)).collect();
        report.iterations = start.iterations;
        report.changes = changes(problem, &before, &start);
        y.copy_from_slice(&start.state[..n]);
        dy.copy_from_slice(&start.state[n..]);
        Ok(report)
    }
}

fn check_finite(problem: &dyn DaeProblem, t: f64, y: &[f64], dy: &[f64]) -> Result<(), SolveError> {
    if !t.is_finite() {
        return Err(SolveError::InvalidStart { t, component: "t".to_owned(), value: t });
    }
    let all = (0..y.len()).map(|i| (Unknown::Y(i), y[i])).chain((0..dy.len()).map(|i| (Unknown::Dy(i), dy[i])));
    match all.into_iter().find(|(_, value)| !value.is_finite()) {
        None => Ok(()),
        Some((unknown, value)) => Err(SolveError::InvalidStart { t, component: unknown.name(problem), value }),
    }
}

fn must_hold(start: &mut Start, problem: &mut dyn DaeProblem, eqs: Equations) -> Result<(), SolveError> {
    let equations = start.violated(problem, eqs, 1.0)?;
    if equations.is_empty() {
        return Ok(());
    }
    Err(SolveError::InconsistentStart { t: start.t, equations, iterations: start.iterations })
}

fn changes(problem: &dyn DaeProblem, before: &[f64], start: &Start) -> Vec<Change> {
    let n = before.len() / 2;
    let changed = (0..2 * n).filter(|&s| (start.state[s] - before[s]).abs() > start.weight(s));
    changed
        .map(|s| {
            let unknown = if s < n { Unknown::Y(s) } else { Unknown::Dy(s - n) };
            Change { component: unknown.name(problem), before: before[s], after: start.state[s] }
        })
        .collect()
}
