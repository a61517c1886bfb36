//! Starts at which the equations hold.
//!
//! ```text
//! least change:  min Σ (Δ_j / s_j)²  so that  c(x + Δ) = 0        Δ = −S Aᵀ (A Aᵀ + μ I)⁻¹ c,  A = ∂c/∂x S
//! ```
//! The rows of `A` are scaled to length 1. `μ` is far below rounding's concern while steps succeed
//! (Gauss-Newton), and grows until they do (Levenberg-Marquardt); each of both loops is bounded.
//! Nothing here is trusted: whoever asks for a start checks with [`Start::violated`] what came out.
//!
//! # References
//! Nocedal, Wright, *Numerical Optimization*, 2nd ed. 2006, section 10.3.

use crate::dae::Unknown;
use crate::dense::{dependent_rows, dot, solve_normal, transposed, transposed_product};
use crate::sundials::first_not_finite;
use crate::{DaeProblem, EquationResidual, EvalFailure, Function, SolveError};

/// Iterations after which a start is given up.
const MAX_ITERATIONS: u32 = 60;
/// Most equations that an error names.
const MAX_NAMED: usize = 6;

/// What [`Ida::make_consistent`](crate::Ida::make_consistent) did.
#[derive(Clone, PartialEq, Default, Debug)]
#[non_exhaustive]
pub struct StartReport {
    /// Everything that was changed by more than its tolerance, components before derivatives.
    pub changes: Vec<Change>,
    /// Iterations of the corrections, the library's own not counted.
    pub iterations: u32,
    /// Sets of equations of a start level that say the same: one of each could go.
    pub redundant: Vec<Vec<String>>,
    /// Algebraic components and derivatives that neither the equations nor the start levels
    /// determine: if there are any, the index is above 1, and constraints that are hidden in the
    /// derivatives of the equations were not checked.
    pub undetermined: Vec<String>,
}

/// A number of the start that was changed.
#[derive(Clone, PartialEq, Debug)]
pub struct Change {
    /// Name of the component, with `d/dt` before it if the derivative was changed.
    pub component: String,
    /// What it was.
    pub before: f64,
    /// What it is.
    pub after: f64,
}

/// Which equations.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Equations<'a> {
    /// `F = 0`
    All,
    /// Those of a start level, with their names.
    Level(usize, &'a [String]),
}

impl Equations<'_> {
    fn function(self) -> Function {
        match self {
            Self::All => Function::Residual,
            Self::Level(..) => Function::StartResidual,
        }
    }

    fn name(self, problem: &dyn DaeProblem, i: usize) -> String {
        match self {
            Self::All => problem.equation_name(i),
            Self::Level(_, names) => names[i].clone(),
        }
    }

    fn count(self, n: usize) -> usize {
        match self {
            Self::All => n,
            Self::Level(_, names) => names.len(),
        }
    }
}

/// A start under inspection.
pub(crate) struct Start<'a> {
    pub t: f64,
    /// `[y; ẏ]`
    pub state: Vec<f64>,
    pub rtol: f64,
    pub atol: &'a [f64],
    pub iterations: u32,
}

impl Start<'_> {
    fn n(&self) -> usize {
        self.atol.len()
    }

    /// Tolerance of a number.
    pub(crate) fn weight(&self, slot: usize) -> f64 {
        self.atol[slot % self.n()] + self.rtol * self.state[slot].abs()
    }

    /// Size of a number, not below what its tolerance says of its scale.
    pub(crate) fn magnitude(&self, slot: usize) -> f64 {
        self.state[slot].abs().max(self.atol[slot % self.n()] / self.rtol)
    }

    fn residual(&self, problem: &mut dyn DaeProblem, eqs: Equations) -> Result<Vec<f64>, SolveError> {
        let mut r = vec![0.0; eqs.count(self.n())];
        let (y, dy) = self.state.split_at(self.n());
        let outcome = match eqs {
            Equations::All => problem.residual(self.t, y, dy, &mut r),
            Equations::Level(k, _) => problem.start_residual(k, self.t, y, dy, &mut r),
        };
        self.evaluated(problem, eqs.function(), outcome, eqs, first_not_finite(&r))?;
        Ok(r)
    }

    fn evaluated(
        &self,
        problem: &dyn DaeProblem,
        function: Function,
        outcome: Result<(), EvalFailure>,
        eqs: Equations,
        bad: Option<usize>,
    ) -> Result<(), SolveError> {
        let t = self.t;
        if outcome.is_err() {
            return Err(SolveError::EvaluationFailed { function, t });
        }
        bad.map_or(Ok(()), |i| Err(SolveError::NotFinite { function, t, component: eqs.name(problem, i) }))
    }

    /// `∂c/∂[y; ẏ]` by rows: exact if the problem can, else by central differences.
    fn jacobian(&mut self, problem: &mut dyn DaeProblem, eqs: Equations) -> Result<Vec<f64>, SolveError> {
        if eqs == Equations::All && problem.pattern().is_some() {
            return self.exact_jacobian(problem);
        }
        let width = self.state.len();
        let mut a = vec![0.0; eqs.count(self.n()) * width];
        for slot in 0..width {
            let x = self.state[slot];
            let d = f64::EPSILON.cbrt() * self.magnitude(slot);
            self.state[slot] = x + d;
            let above = self.residual(problem, eqs);
            self.state[slot] = x - d;
            let below = self.residual(problem, eqs);
            self.state[slot] = x;
            for (i, (above, below)) in above?.iter().zip(below?).enumerate() {
                a[i * width + slot] = (above - below) / (2.0 * d);
            }
        }
        Ok(a)
    }

    fn exact_jacobian(&self, problem: &mut dyn DaeProblem) -> Result<Vec<f64>, SolveError> {
        let n = self.n();
        let (y, dy) = self.state.split_at(n);
        let entries: Vec<_> = problem.pattern().map_or_else(Vec::new, |p| p.entries().collect());
        let mut at = [vec![0.0; entries.len()], vec![0.0; entries.len()]];
        for (c, values) in [0.0, 1.0].into_iter().zip(&mut at) {
            let outcome = problem.jacobian(self.t, y, dy, c, values);
            let bad = first_not_finite(values).map(|e| entries[e].0);
            self.evaluated(problem, Function::Jacobian, outcome, Equations::All, bad)?;
        }
        let mut a = vec![0.0; n * 2 * n];
        for (e, &(i, j)) in entries.iter().enumerate() {
            a[i * 2 * n + j] = at[0][e];
            a[i * 2 * n + n + j] = at[1][e] - at[0][e];
        }
        Ok(a)
    }

    /// The equations that do not hold to `factor` times what the tolerances of the numbers in them
    /// allow, the worst first.
    pub(crate) fn violated(
        &mut self,
        problem: &mut dyn DaeProblem,
        eqs: Equations,
        factor: f64,
    ) -> Result<Vec<EquationResidual>, SolveError> {
        let r = self.residual(problem, eqs)?;
        if r.iter().all(|&r| r == 0.0) {
            return Ok(Vec::new());
        }
        let a = self.jacobian(problem, eqs)?;
        let width = self.state.len();
        let allowed = |i: usize| -> f64 {
            let row = a[i * width..(i + 1) * width].iter().enumerate();
            let rounding = 1e3 * f64::EPSILON;
            row.map(|(j, a)| a.abs() * (factor * self.weight(j) + rounding * self.state[j].abs())).sum()
        };
        let mut found: Vec<(f64, usize)> = (0..r.len())
            .map(|i| (r[i].abs() / allowed(i).max(f64::MIN_POSITIVE), i))
            .filter(|&(excess, _)| excess > 1.0)
            .collect();
        found.sort_by(|a, b| b.0.total_cmp(&a.0));
        found.truncate(MAX_NAMED);
        let name = |&(_, i): &(f64, usize)| EquationResidual { equation: eqs.name(problem, i), residual: r[i] };
        Ok(found.iter().map(name).collect())
    }

    /// Moves the unknowns, as little as possible, to where the equations hold, or as close as it gets.
    pub(crate) fn solve(
        &mut self,
        problem: &mut dyn DaeProblem,
        eqs: Equations,
        slots: &[usize],
        scales: &[f64],
    ) -> Result<(), SolveError> {
        let n = slots.len();
        let mut r = self.residual(problem, eqs)?;
        let m = r.len();
        let mut mu = 1e-12;
        let mut slow = 0;
        for _ in 0..MAX_ITERATIONS {
            let full = self.jacobian(problem, eqs)?;
            let (a, lengths) = self.scaled_rows(&full, m, slots, scales);
            let b: Vec<f64> = r.iter().zip(&lengths).map(|(r, l)| -r / l).collect();
            let before = dot(&b, &b);
            if before == 0.0 || slow > 5 {
                return Ok(());
            }
            self.iterations += 1;
            let Some((after, trial)) = self.try_steps(problem, eqs, (&a, &b, &lengths), slots, scales, &mut mu, n)
            else {
                return Ok(());
            };
            r = trial;
            slow = if after > 0.5 * before { slow + 1 } else { 0 };
            mu = (0.1 * mu).max(1e-14);
        }
        Ok(())
    }

    /// Raises `mu` until a step lowers the residual; leaves the state there. `None`: nothing does.
    #[allow(clippy::type_complexity)]
    fn try_steps(
        &mut self,
        problem: &mut dyn DaeProblem,
        eqs: Equations,
        (a, b, lengths): (&[f64], &[f64], &[f64]),
        slots: &[usize],
        scales: &[f64],
        mu: &mut f64,
        n: usize,
    ) -> Option<(f64, Vec<f64>)> {
        let before = dot(b, b);
        let old: Vec<f64> = slots.iter().map(|&s| self.state[s]).collect();
        while *mu < 1e10 {
            if let Some(z) = solve_normal(a, b.len(), n, *mu, b) {
                let step = transposed_product(a, n, &z);
                for (k, &s) in slots.iter().enumerate() {
                    self.state[s] = old[k] + scales[k] * step[k];
                }
                if let Ok(r) = self.residual(problem, eqs) {
                    let after: f64 = r.iter().zip(lengths).map(|(r, l)| (r / l) * (r / l)).sum();
                    if after < before {
                        return Some((after, r));
                    }
                }
            }
            *mu *= 10.0;
        }
        for (k, &s) in slots.iter().enumerate() {
            self.state[s] = old[k];
        }
        None
    }

    /// The columns of some unknowns, scaled, with rows of length 1; and the lengths that they had. A
    /// row far shorter than the others keeps its direction only as far as it is known.
    fn scaled_rows(&self, full: &[f64], m: usize, slots: &[usize], scales: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let width = self.state.len();
        let mut a = Vec::with_capacity(m * slots.len());
        let mut lengths = Vec::with_capacity(m);
        for row in full.chunks_exact(width.max(1)) {
            let scaled: Vec<f64> = slots.iter().zip(scales).map(|(&s, scale)| row[s] * scale).collect();
            // What the equation is made of at all, whether it may be changed or not.
            let size = (0..width).map(|j| row[j].abs() * self.magnitude(j)).fold(0.0, f64::max);
            let length = dot(&scaled, &scaled).sqrt().max(1e-6 * size);
            let length = if length > 0.0 { length } else { 1.0 };
            a.extend(scaled.iter().map(|v| v / length));
            lengths.push(length);
        }
        (a, lengths)
    }

    /// Sets of equations that depend on each other in these unknowns.
    pub(crate) fn redundant(
        &mut self,
        problem: &mut dyn DaeProblem,
        eqs: Equations,
        slots: &[usize],
        scales: &[f64],
    ) -> Result<Vec<Vec<String>>, SolveError> {
        let full = self.jacobian(problem, eqs)?;
        let m = eqs.count(self.n());
        let (a, _) = self.scaled_rows(&full, m, slots, scales);
        let sets = dependent_rows(&a, m, slots.len(), 1e-7);
        let named = sets.iter().map(|set| set.iter().map(|&i| eqs.name(problem, i)).collect());
        Ok(named.collect())
    }

    /// What the equations alone, without their derivatives, leave open among the algebraic components
    /// and the derivatives of the differential ones. None: the index is 1, or 0.
    pub(crate) fn undetermined(&mut self, problem: &mut dyn DaeProblem) -> Result<Vec<Unknown>, SolveError> {
        let n = self.n();
        let full = self.jacobian(problem, Equations::All)?;
        let unknowns = free_unknowns(problem);
        let slots: Vec<usize> = unknowns.iter().map(|u| u.slot(n)).collect();
        let scales: Vec<f64> = slots.iter().map(|&s| self.magnitude(s)).collect();
        let (a, _) = self.scaled_rows(&full, n, &slots, &scales);
        let sets = dependent_rows(&transposed(&a, n, n), n, n, 1e-7);
        let mut open: Vec<Unknown> = sets.into_iter().flatten().map(|k| unknowns[k]).collect();
        open.sort_unstable();
        open.dedup();
        Ok(open)
    }

    /// An error if `∂F/∂y + c ∂F/∂ẏ` is singular whatever `c`: then no step can be solved.
    pub(crate) fn check_regular(&mut self, problem: &mut dyn DaeProblem) -> Result<(), SolveError> {
        let n = self.n();
        let full = self.jacobian(problem, Equations::All)?;
        let largest = |from: usize| {
            full.iter()
                .enumerate()
                .filter(|(k, _)| (k / n.max(1)) % 2 == from)
                .fold(0.0, |s: f64, (_, v)| s.max(v.abs()))
        };
        let (by, bdy) = (largest(0), largest(1));
        // Any number will do, but for unlucky ones.
        let c = if by > 0.0 && bdy > 0.0 { 1.372_81 * by / bdy } else { 1.0 };
        let a: Vec<f64> = (0..n * n)
            .map(|k| (k / n, k % n))
            .map(|(i, j)| full[i * 2 * n + j] + c * full[i * 2 * n + n + j])
            .collect();
        let tolerance = if problem.pattern().is_some() { 1e-12 } else { 1e-8 };
        let equations = dependent_rows(&a, n, n, tolerance);
        if equations.is_empty() {
            return Ok(());
        }
        let unknowns = dependent_rows(&transposed(&a, n, n), n, n, tolerance);
        let mut unknowns: Vec<usize> = unknowns.into_iter().flatten().collect();
        unknowns.sort_unstable();
        unknowns.dedup();
        Err(SolveError::SingularEquations {
            t: self.t,
            equations: equations.iter().map(|set| set.iter().map(|&i| problem.equation_name(i)).collect()).collect(),
            unknowns: unknowns.iter().map(|&i| problem.component_name(i)).collect(),
        })
    }
}

/// The algebraic components, and the derivatives of the others.
pub(crate) fn free_unknowns(problem: &dyn DaeProblem) -> Vec<Unknown> {
    let kinds = problem.differential().iter().enumerate();
    kinds.map(|(i, &differential)| if differential { Unknown::Dy(i) } else { Unknown::Y(i) }).collect()
}
