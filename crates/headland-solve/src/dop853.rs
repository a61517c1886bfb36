//! Explicit Runge-Kutta of order 8 with error estimates of orders 5 and 3 and dense output of order 7.
//!
//! ```text
//! k_i = f(t + c_i h, y + h Σ_j a_ij k_j)    i = 0 … 11        y⁺ = y + h Σ_j b_j k_j
//! k_12 = f(t + h, y⁺), which is k_0 of the next step: 12 evaluations an accepted step, 11 a rejected one
//! ```
//! Dense output takes three more evaluations, only in a step where it is asked for. The state is
//! summed with compensation (Kahan): what rounding cuts off an increment goes into the next. It costs
//! nothing that can be measured, and pays where many short steps are taken; on a thousand Kepler
//! orbits at `rtol` 1e-14 the truncation error outweighs it still.
//!
//! # References
//! Hairer, Nørsett, Wanner, *Solving Ordinary Differential Equations I*, 2nd ed. 1993, sections II.4
//! (first step), II.5 and II.6 (the pair, dense output) and II.10 (error estimate); *II*, 2nd ed.
//! 1996, section IV.2 (stiffness).

use crate::dop853_tableau::*;
use crate::driver::Stepper;
use crate::problem::EvalFailure;
use crate::{Function, OdeProblem, Options, SolveError, Stats};

/// Of the factors tried on orbits and pendulums (0.8 to 0.9, with and without a memory of the last
/// error), this one takes the fewest evaluations.
const SAFETY: f64 = 0.85;
/// Bounds of the factor from one step size to the next.
const SHRINK: f64 = 0.333;
const GROW: f64 = 6.0;
/// Factor when a stage could not be evaluated.
const SHRINK_FAILED: f64 = 0.25;
/// Rejections in a row after which the step is given up.
const MAX_REJECTIONS: u32 = 100;

/// Why an attempt at a step came to nothing.
enum Rejection {
    /// Error this many times the tolerance.
    Error(f64),
    /// A value that is not finite, or a recoverable failure.
    Failed(SolveError),
    /// Not to be tried again.
    Fatal(SolveError),
}

pub(crate) struct Dop853 {
    rtol: f64,
    atol: Vec<f64>,
    h_first: Option<f64>,
    h_max: f64,
    /// Errors are measured by this times the tolerance.
    leniency: f64,
    /// Last step: from `(t0, y0)` to `(t1, y1)`. While one is attempted, `t1 = t0`.
    t0: f64,
    t1: f64,
    y0: Vec<f64>,
    y1: Vec<f64>,
    /// What rounding cut off the state `y0`, and `y1`.
    carry: Vec<f64>,
    carry1: Vec<f64>,
    /// Proposal for the next step; `None` before the first.
    h: Option<f64>,
    k: [Vec<f64>; 16],
    /// Argument of the last stage evaluated.
    arg: Vec<f64>,
    /// Dense output: the coefficients of orders 4 to 7.
    poly: [Vec<f64>; 4],
    has_poly: bool,
    stiffness: Stiffness,
    stats: Stats,
}

impl Dop853 {
    pub(crate) fn new(n: usize, options: &Options) -> Self {
        let zeros = || vec![0.0; n];
        Self {
            rtol: options.rtol,
            atol: options.atol.clone(),
            h_first: options.h_first,
            h_max: options.h_max,
            leniency: 1.0,
            t0: 0.0,
            t1: 0.0,
            y0: zeros(),
            y1: zeros(),
            carry: zeros(),
            carry1: zeros(),
            h: None,
            k: std::array::from_fn(|_| zeros()),
            arg: zeros(),
            poly: std::array::from_fn(|_| zeros()),
            has_poly: false,
            stiffness: Stiffness::default(),
            stats: Stats::default(),
        }
    }

    /// One attempt at the step from `t0` by `h` to `t`; returns the error relative to the tolerance.
    fn attempt(&mut self, problem: &mut dyn OdeProblem, h: f64, t: f64) -> Result<f64, Rejection> {
        self.stage(problem, 1, &A1, h, t)?;
        self.stage(problem, 2, &A2, h, t)?;
        self.stage(problem, 3, &A3, h, t)?;
        self.stage(problem, 4, &A4, h, t)?;
        self.stage(problem, 5, &A5, h, t)?;
        self.stage(problem, 6, &A6, h, t)?;
        self.stage(problem, 7, &A7, h, t)?;
        self.stage(problem, 8, &A8, h, t)?;
        self.stage(problem, 9, &A9, h, t)?;
        self.stage(problem, 10, &A10, h, t)?;
        self.stage(problem, 11, &A11, h, t)?;
        let error = self.combine_and_estimate(h) / self.leniency;
        if !error.is_finite() {
            return Err(self.not_finite(problem, h));
        }
        if error > 1.0 {
            return Err(Rejection::Error(error));
        }
        if problem.has_projection() {
            self.project(problem, t)?;
        }
        self.stats.rhs += 1;
        let outcome = problem.rhs(t, &self.y1, &mut self.k[12]);
        evaluated(outcome, Function::Rhs, t)?;
        if !all_finite(&self.k[12]) {
            return Err(self.not_finite(problem, h));
        }
        Ok(error)
    }

    /// `k_s = f(t0 + c_s h, y0 + h Σ_j a_j k_j)`, never beyond `t_last`.
    fn stage<const N: usize>(
        &mut self,
        problem: &mut dyn OdeProblem,
        s: usize,
        a: &Row<N>,
        h: f64,
        t_last: f64,
    ) -> Result<(), Rejection> {
        let n = self.arg.len();
        let k = columns(a, &self.k, n);
        let (arg, y) = (&mut self.arg[..n], &self.y0[..n]);
        for i in 0..n {
            arg[i] = y[i] + h * dot(a, &k, i);
        }
        self.stats.rhs += 1;
        let t = (self.t0 + C[s] * h).min(t_last);
        let outcome = problem.rhs(t, &self.arg, &mut self.k[s]);
        evaluated(outcome, Function::Rhs, t)
    }

    /// `y1 = y0 + h Σ b_j k_j` and the norm of its error.
    ///
    /// ```text
    /// err = max_i h e5_i² / sqrt(e5_i² + 0.01 e3_i²)      e5, e3: the two estimates over the tolerance
    /// ```
    /// The largest component counts, not the root mean square: at the bound of stability (a train in a steady turn) the
    /// mean let the error grow to 90 tolerances, and error against work is better so at every tolerance tried.
    fn combine_and_estimate(&mut self, h: f64) -> f64 {
        let n = self.y0.len();
        let (kb, k5, k3) = (columns(&B, &self.k, n), columns(&E5, &self.k, n), columns(&B3, &self.k, n));
        let (y0, y1) = (&self.y0[..n], &mut self.y1[..n]);
        let (carry, carry1) = (&self.carry[..n], &mut self.carry1[..n]);
        let atol = &self.atol[..n];
        let (mut worst, mut sum_of_all) = (0.0_f64, 0.0);
        for i in 0..n {
            let sum = dot(&B, &kb, i);
            let increment = h * sum + carry[i];
            y1[i] = y0[i] + increment;
            carry1[i] = increment - (y1[i] - y0[i]);
            let scale = atol[i] + self.rtol * larger(y0[i].abs(), y1[i].abs());
            let d5 = dot(&E5, &k5, i) / scale;
            let d3 = (sum - dot(&B3, &k3, i)) / scale;
            let (e5, e3) = (d5 * d5, d3 * d3);
            worst = larger(worst, e5 * e5 / (e5 + 0.01 * e3 + f64::MIN_POSITIVE));
            sum_of_all += e5;
        }
        // A comparison loses a NaN, a sum does not.
        if sum_of_all.is_finite() { h * worst.sqrt() } else { f64::NAN }
    }

    fn project(&mut self, problem: &mut dyn OdeProblem, t: f64) -> Result<(), Rejection> {
        self.stats.projections += 1;
        let function = Function::Projection;
        // k_12 is free until the step is accepted.
        let correction = &mut self.k[12];
        let outcome = problem.project(t, &self.y1, correction);
        evaluated(outcome, function, t)?;
        if let Some(i) = correction.iter().position(|v| !v.is_finite()) {
            let component = problem.component_name(i);
            return Err(Rejection::Failed(SolveError::NotFinite { function, t, component }));
        }
        for (y, c) in self.y1.iter_mut().zip(correction) {
            *y += *c;
        }
        Ok(())
    }

    /// Makes the end of the last step the start of the next.
    fn set_out(&mut self) {
        self.k.swap(0, 12);
        self.y0.copy_from_slice(&self.y1);
        self.t0 = self.t1;
        self.has_poly = false;
    }

    /// As if no attempt had been made.
    fn go_back(&mut self) {
        self.k.swap(0, 12);
        self.y1.copy_from_slice(&self.y0);
    }

    /// Takes the step that was attempted, and proposes the next.
    fn accept(&mut self, h: f64, t: f64, error: f64, was_rejected: bool, proposed: f64) {
        std::mem::swap(&mut self.carry, &mut self.carry1);
        self.stiffness.look(h, [&self.k[11], &self.k[12]], [&self.arg, &self.y1]);
        self.t1 = t;
        let next = h * factor(error, if was_rejected { 1.0 } else { GROW });
        // A step cut short by the stop says nothing against the longer one proposed.
        let cut = !was_rejected && h < proposed;
        self.h = Some(if cut { next.max(proposed) } else { next });
    }

    /// The first step, from the size of `f` and of its change over a short Euler step.
    fn guess_step(&mut self, problem: &mut dyn OdeProblem, t_stop: f64) -> Result<f64, SolveError> {
        let n = self.y0.len();
        let (rtol, atol, y, f) = (self.rtol, &self.atol, &self.y0, &self.k[0]);
        let scale = |i: usize| atol[i] + rtol * y[i].abs();
        let norm = |v: &dyn Fn(usize) -> f64| {
            let sum: f64 = (0..n).map(|i| (v(i) / scale(i)).powi(2)).sum();
            (sum / n.max(1) as f64).sqrt()
        };
        let (size, slope) = (norm(&|i| y[i]), norm(&|i| f[i]));
        let longest = self.h_max.min(t_stop - self.t0);
        let h0 = if size < 1e-5 || slope < 1e-5 { 1e-6 } else { 0.01 * size / slope }.min(longest);
        for i in 0..n {
            self.arg[i] = y[i] + h0 * f[i];
        }
        self.stats.rhs += 1;
        let t = self.t0 + h0;
        match problem.rhs(t.min(t_stop), &self.arg, &mut self.k[1]) {
            Ok(()) if all_finite(&self.k[1]) => {}
            Err(EvalFailure::Fatal) => {
                let function = Function::Rhs;
                return Err(SolveError::EvaluationFailed { function, t });
            }
            _ => return Ok(SHRINK_FAILED * h0),
        }
        let f1 = &self.k[1];
        let curvature = norm(&|i| f1[i] - self.k[0][i]) / h0;
        let largest = slope.max(curvature);
        let h1 = if largest <= 1e-15 { (1e-3 * h0).max(1e-6) } else { (0.01 / largest).powf(1.0 / 8.0) };
        Ok((100.0 * h0).min(h1).min(longest))
    }

    /// Size and end of the step to try: the stop is hit exactly, and no sliver is left before it.
    fn fit_to_stop(&self, h: f64, t_stop: f64) -> (f64, f64) {
        let left = t_stop - self.t0;
        let h = h.min(self.h_max);
        if left <= (1.01 * h).min(self.h_max) {
            return (left, t_stop);
        }
        let h = if 2.0 * h > left { 0.5 * left } else { h };
        // The difference of the two times as they are, so that their rounding does not add up.
        let t = self.t0 + h;
        (t - self.t0, t)
    }

    fn not_finite(&self, problem: &dyn OdeProblem, h: f64) -> Rejection {
        let stages = self.k[..13].iter().enumerate();
        let (c, i) = stages
            .filter_map(|(s, k)| k.iter().position(|v| !v.is_finite()).map(|i| (C[s], i)))
            .next()
            .or_else(|| self.y1.iter().position(|v| !v.is_finite()).map(|i| (1.0, i)))
            .unwrap_or((0.0, 0));
        Rejection::Failed(SolveError::NotFinite {
            function: Function::Rhs,
            t: self.t0 + c * h,
            component: problem.component_name(i),
        })
    }

    fn step_too_small(&self, problem: &dyn OdeProblem, h: f64) -> SolveError {
        let n = self.y0.len();
        let k = columns(&E5, &self.k, n);
        let error = |i: usize| {
            let scale = self.atol[i] + self.rtol * self.y0[i].abs().max(self.y1[i].abs());
            dot(&E5, &k, i).abs() / scale
        };
        let worst = (0..n).max_by(|&i, &j| error(i).total_cmp(&error(j)));
        SolveError::StepTooSmall { t: self.t0, h, worst: problem.component_name(worst.unwrap_or(0)) }
    }

    /// The three further stages of dense output and its coefficients.
    fn prepare_dense(&mut self, problem: &mut dyn OdeProblem) -> Result<(), SolveError> {
        let (h, t) = (self.t1 - self.t0, self.t1);
        let error = |r| match r {
            Rejection::Failed(e) | Rejection::Fatal(e) => e,
            Rejection::Error(_) => unreachable!("a stage has no error estimate"),
        };
        self.stage(problem, 13, &A13, h, t).map_err(error)?;
        self.stage(problem, 14, &A14, h, t).map_err(error)?;
        self.stage(problem, 15, &A15, h, t).map_err(error)?;
        if !self.k[13..].iter().all(|k| all_finite(k)) {
            let stage = (13..16).find(|&s| !all_finite(&self.k[s])).unwrap_or(13);
            let i = self.k[stage].iter().position(|v| !v.is_finite());
            return Err(SolveError::NotFinite {
                function: Function::Rhs,
                t: self.t0 + C[stage] * h,
                component: problem.component_name(i.unwrap_or(0)),
            });
        }
        fill(&mut self.poly[0], h, &D4, &self.k);
        fill(&mut self.poly[1], h, &D5, &self.k);
        fill(&mut self.poly[2], h, &D6, &self.k);
        fill(&mut self.poly[3], h, &D7, &self.k);
        self.has_poly = true;
        Ok(())
    }

    /// The interpolant: cubic Hermite, plus the terms of order 4 to 7 where they are there.
    ///
    /// ```text
    /// y(t0 + s h) = y0 + s (Δ + r (p + s (Δ − h k_12 − p + r (d4 + s (d5 + r (d6 + s d7))))))
    /// r = 1 − s        Δ = y1 − y0        p = h k_0 − Δ
    /// ```
    fn evaluate(&self, t: f64, y: &mut [f64]) {
        let n = y.len();
        let h = self.t1 - self.t0;
        if h <= 0.0 {
            return y.copy_from_slice(&self.y0);
        }
        let s = (t - self.t0) / h;
        let r = 1.0 - s;
        let (y0, y1) = (&self.y0[..n], &self.y1[..n]);
        let (f0, f1) = (&self.k[0][..n], &self.k[12][..n]);
        for i in 0..n {
            let delta = y1[i] - y0[i];
            let p = h * f0[i] - delta;
            y[i] = y0[i] + s * (delta + r * (p + s * (delta - h * f1[i] - p)));
        }
        if self.has_poly {
            let [d4, d5, d6, d7] = self.poly.each_ref().map(|d| &d[..n]);
            let sr = s * r;
            for i in 0..n {
                y[i] += sr * sr * (d4[i] + s * (d5[i] + r * (d6[i] + s * d7[i])));
            }
        }
    }
}

impl Stepper for Dop853 {
    type Problem<'p> = dyn OdeProblem + 'p;

    fn name(&self) -> &'static str {
        "dop853"
    }

    fn begin(&mut self, problem: &mut (dyn OdeProblem + '_), t: f64, y: &[f64]) -> Result<(), SolveError> {
        (self.t0, self.t1) = (t, t);
        self.y0.copy_from_slice(y);
        self.y1.copy_from_slice(y);
        self.carry.fill(0.0);
        self.h = self.h_first;
        self.has_poly = false;
        self.stiffness = Stiffness::default();
        self.stats.rhs += 1;
        let function = Function::Rhs;
        // Into k_12, from where the first step fetches it like every other.
        problem.rhs(t, y, &mut self.k[12]).map_err(|_| SolveError::EvaluationFailed { function, t })?;
        match self.k[12].iter().position(|v| !v.is_finite()) {
            None => Ok(()),
            Some(i) => Err(SolveError::NotFinite { function, t, component: problem.component_name(i) }),
        }
    }

    fn advance(&mut self, problem: &mut (dyn OdeProblem + '_), t_stop: f64) -> Result<(), SolveError> {
        self.set_out();
        let guess = match self.h {
            Some(h) => Ok(h),
            None => self.guess_step(problem, t_stop),
        };
        let proposed = guess.inspect_err(|_| self.go_back())?;
        let mut h = proposed;
        for rejections in 0..MAX_REJECTIONS {
            let (h_try, t) = self.fit_to_stop(h, t_stop);
            let rejection = match self.attempt(problem, h_try, t) {
                Ok(error) => {
                    self.accept(h_try, t, error, rejections > 0, proposed);
                    return Ok(());
                }
                Err(rejection) => rejection,
            };
            self.stats.rejected += 1;
            h = match &rejection {
                Rejection::Error(error) => h_try * factor(*error, SAFETY),
                Rejection::Failed(_) => h_try * SHRINK_FAILED,
                Rejection::Fatal(_) => 0.0,
            };
            if h <= 10.0 * f64::EPSILON * self.t0.abs() || rejections + 1 == MAX_REJECTIONS {
                let error = match rejection {
                    Rejection::Error(_) => self.step_too_small(problem, h_try),
                    Rejection::Failed(error) | Rejection::Fatal(error) => error,
                };
                self.go_back();
                return Err(error);
            }
        }
        unreachable!("the last rejection returns")
    }

    fn span(&self) -> (f64, f64) {
        (self.t0, self.t1)
    }

    fn order(&self) -> u8 {
        8
    }

    fn y_end(&self) -> &[f64] {
        &self.y1
    }

    fn dense(&mut self, problem: &mut (dyn OdeProblem + '_), t: f64, y: &mut [f64]) -> Result<(), SolveError> {
        if !self.has_poly && self.t1 > self.t0 {
            self.prepare_dense(problem)?;
        }
        self.evaluate(t, y);
        Ok(())
    }

    fn sketch(&mut self, t: f64, y: &mut [f64]) {
        self.evaluate(t, y);
    }

    fn set_h_max(&mut self, h: f64) {
        self.h_max = h;
    }

    fn proposed_step(&self) -> Option<f64> {
        self.h
    }

    fn set_leniency(&mut self, factor: f64) {
        self.leniency = factor;
    }

    fn looks_stiff(&self) -> bool {
        self.stiffness.found
    }

    fn stats(&self) -> &Stats {
        &self.stats
    }

    fn stats_mut(&mut self) -> &mut Stats {
        &mut self.stats
    }
}

/// Watches the dominant eigenvalue `λ`, from two evaluations at the end of each step.
#[derive(Default)]
struct Stiffness {
    at_bound: u32,
    inside: u32,
    found: bool,
}

impl Stiffness {
    /// `h |λ|` at which the stability region of the method ends, nearly.
    const BOUND: f64 = 6.1;

    fn look(&mut self, h: f64, f: [&[f64]; 2], y: [&[f64]; 2]) {
        let distance2 = |[a, b]: [&[f64]; 2]| -> f64 {
            let b = &b[..a.len()];
            let mut sum = 0.0;
            for i in 0..a.len() {
                sum += (a[i] - b[i]) * (a[i] - b[i]);
            }
            sum
        };
        let (df2, dy2) = (distance2(f), distance2(y));
        if h * h * df2 > Self::BOUND * Self::BOUND * dy2 && dy2 > 0.0 {
            self.inside = 0;
            self.at_bound += 1;
            self.found |= self.at_bound >= 15;
        } else {
            self.inside += 1;
            if self.inside >= 6 {
                *self = Self::default();
            }
        }
    }
}

/// From one step size to the next, for an error relative to the tolerance.
fn factor(error: f64, most: f64) -> f64 {
    (SAFETY * error.powf(-1.0 / 8.0)).clamp(SHRINK, most)
}

/// The stages that a row of the tableau names.
#[inline]
fn columns<'k, const N: usize>(row: &Row<N>, k: &'k [Vec<f64>; 16], n: usize) -> [&'k [f64]; N] {
    std::array::from_fn(|j| &k[row[j].0][..n])
}

/// `Σ_j a_j k_j` of component `i`; the loop over the row is unrolled, the one over `i` vectorised.
#[inline(always)]
fn dot<const N: usize>(row: &Row<N>, k: &[&[f64]; N], i: usize) -> f64 {
    let mut sum = row[0].1 * k[0][i];
    for j in 1..N {
        sum += row[j].1 * k[j][i];
    }
    sum
}

/// `out = h Σ_j a_j k_j`
fn fill<const N: usize>(out: &mut [f64], h: f64, row: &Row<N>, k: &[Vec<f64>; 16]) {
    let k = columns(row, k, out.len());
    for i in 0..out.len() {
        out[i] = h * dot(row, &k, i);
    }
}

/// The larger of two numbers of which none is NaN, or it does not matter.
#[inline(always)]
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

fn all_finite(v: &[f64]) -> bool {
    let mut sum = 0.0;
    for x in v {
        sum += x * 0.0;
    }
    sum == 0.0
}

fn evaluated(outcome: Result<(), EvalFailure>, function: Function, t: f64) -> Result<(), Rejection> {
    outcome.map_err(|failure| {
        let error = SolveError::EvaluationFailed { function, t };
        match failure {
            EvalFailure::Recoverable => Rejection::Failed(error),
            EvalFailure::Fatal => Rejection::Fatal(error),
        }
    })
}

#[cfg(test)]
mod tests;
