//! Where event functions change sign within an accepted step.
//!
//! Signs are compared at the end of the step and at a few places inside, on the method's cheap
//! interpolant; where one has changed, the same is done on the dense output, and the first interval
//! with a change is narrowed down by the Illinois method on whichever function's secant crosses zero
//! first. What is still between the two ends at the last rounding happens at the same time.
//!
//! # References
//! Hindmarsh et al., *SUNDIALS*, ACM TOMS 31 (2005), and Hiebert, Shampine, *Implicitly defined output
//! points for solutions of ODEs*, SAND80-0180 (1980): the rules for zeros at the start.

use std::collections::VecDeque;

use crate::driver::{Stepper, Watched};
use crate::problem::EvalFailure;
use crate::{Function, SolveError, Stats, Step};

/// Fractions of a step looked at while a function is zero and has to show where it goes.
const LEAVING: [f64; 3] = [1e-3, 1e-2, 0.1];

/// An event found.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hit {
    pub t: f64,
    pub index: usize,
    pub rising: bool,
}

impl Hit {
    pub(crate) fn step(self) -> Step {
        let Self { t, index, rising } = self;
        Step::Event { t, index, rising }
    }
}

/// Signs of the event functions at the time reached, and the events found there.
pub(crate) struct Locator {
    samples: u32,
    /// Values at the time reached. Zero: ignored until it is not.
    g: Vec<f64>,
    /// Values at the two ends of the interval under inspection, and between.
    g_a: Vec<f64>,
    g_b: Vec<f64>,
    g_m: Vec<f64>,
    y: Vec<f64>,
    waiting: VecDeque<Hit>,
    /// Events reported or waiting at the time of the last hit.
    latest: Vec<Hit>,
}

/// Whether a function with these two values had an event between them.
fn changed(from: f64, to: f64) -> bool {
    (from < 0.0 && to >= 0.0) || (from > 0.0 && to <= 0.0)
}

fn any_changed(from: &[f64], to: &[f64]) -> bool {
    from.iter().zip(to).any(|(&a, &b)| changed(a, b))
}

impl Locator {
    pub(crate) fn new(n: usize, samples: u32) -> Self {
        Self {
            samples,
            g: Vec::new(),
            g_a: Vec::new(),
            g_b: Vec::new(),
            g_m: Vec::new(),
            y: vec![0.0; n],
            waiting: VecDeque::new(),
            latest: Vec::new(),
        }
    }

    pub(crate) fn waiting(&self) -> usize {
        self.waiting.len()
    }

    pub(crate) fn next_waiting(&mut self) -> Option<Hit> {
        self.waiting.pop_front()
    }

    /// State at the event that [`search`](Self::search) found.
    pub(crate) fn y_hit(&self) -> &[f64] {
        &self.y
    }

    pub(crate) fn start(
        &mut self,
        problem: &mut (impl Watched + ?Sized),
        t: f64,
        y: &[f64],
        stats: &mut Stats,
    ) -> Result<(), SolveError> {
        let count = problem.watch_count();
        for g in [&mut self.g, &mut self.g_a, &mut self.g_b, &mut self.g_m] {
            g.resize(count, 0.0);
        }
        let reported: Vec<usize> = self
            .latest
            .iter()
            .filter(|hit| hit.t == t && !self.waiting.iter().any(|w| w.index == hit.index))
            .map(|hit| hit.index)
            .collect();
        self.waiting.clear();
        self.latest.clear();
        if count == 0 {
            return Ok(());
        }
        eval(problem, t, y, &mut self.g, stats)?;
        for index in reported.into_iter().filter(|&i| i < count) {
            self.g[index] = 0.0;
        }
        Ok(())
    }

    /// The first event in `(t, t_end]` of the stepper's last step, or none: then `t_end` is reached.
    pub(crate) fn search<S: Stepper>(
        &mut self,
        stepper: &mut S,
        problem: &mut S::Problem<'_>,
        t: f64,
        t_end: f64,
    ) -> Result<Option<Hit>, SolveError> {
        if self.g.is_empty() {
            return Ok(None);
        }
        if !self.scan(stepper, problem, t, t_end, false)?.1 {
            self.g.copy_from_slice(&self.g_b);
            return Ok(None);
        }
        let (interval, found) = self.scan(stepper, problem, t, t_end, true)?;
        if !found {
            self.g.copy_from_slice(&self.g_b);
            return Ok(None);
        }
        let t_hit = self.narrow(stepper, problem, interval)?;
        let hits = (0..self.g.len()).filter(|&i| changed(self.g_a[i], self.g_b[i]));
        self.waiting = hits.map(|index| Hit { t: t_hit, index, rising: self.g_a[index] < 0.0 }).collect();
        self.latest.clear();
        self.latest.extend(&self.waiting);
        self.g.copy_from_slice(&self.g_b);
        Ok(self.waiting.pop_front())
    }

    /// Goes through the places to look at, up to the first change of sign: leaves the values before
    /// it in `g_a` and after it in `g_b`, and returns its interval.
    fn scan<S: Stepper>(
        &mut self,
        stepper: &mut S,
        problem: &mut S::Problem<'_>,
        t: f64,
        t_end: f64,
        exact: bool,
    ) -> Result<([f64; 2], bool), SolveError> {
        let leaving = if self.g.contains(&0.0) { &LEAVING[..] } else { &[] };
        let parts = f64::from(self.samples) + 1.0;
        let inside = (1..=self.samples).map(|i| f64::from(i) / parts);
        self.g_a.copy_from_slice(&self.g);
        let mut a = t;
        for fraction in leaving.iter().copied().chain(inside).chain([1.0]) {
            let b = if fraction == 1.0 { t_end } else { t + fraction * (t_end - t) };
            if b <= a {
                continue;
            }
            if b == stepper.span().1 {
                self.y.copy_from_slice(stepper.y_end());
            } else if exact || b == t_end {
                stepper.dense(problem, b, &mut self.y)?;
            } else {
                stepper.sketch(b, &mut self.y);
            }
            eval(problem, b, &self.y, &mut self.g_b, stepper.stats_mut())?;
            if any_changed(&self.g_a, &self.g_b) {
                return Ok(([a, b], true));
            }
            self.g_a.copy_from_slice(&self.g_b);
            a = b;
        }
        Ok(([t, t_end], false))
    }

    /// Narrows `[a, b]`, with values `g_a` and `g_b`, around its first change of sign, to a few
    /// roundings, and returns `b`. The state there goes to `y`.
    fn narrow<S: Stepper>(
        &mut self,
        stepper: &mut S,
        problem: &mut S::Problem<'_>,
        [mut a, mut b]: [f64; 2],
    ) -> Result<f64, SolveError> {
        let resolution = 2.0 * f64::EPSILON * a.abs().max(b.abs());
        // Weight of the values at `a` in the secant; doubles or halves while one end stays.
        let mut weight = 1.0;
        let mut moved_b = None;
        let (mut width, mut slow) = (b - a, 0);
        while b - a > resolution {
            let m = if slow >= 2 {
                slow = 0;
                a + 0.5 * (b - a)
            } else {
                let m = a + (b - a) * self.secant(weight);
                m.clamp(a + 0.5 * resolution, b - 0.5 * resolution)
            };
            if m <= a || m >= b {
                break;
            }
            stepper.dense(problem, m, &mut self.y)?;
            eval(problem, m, &self.y, &mut self.g_m, stepper.stats_mut())?;
            let left = any_changed(&self.g_a, &self.g_m);
            weight = match moved_b {
                Some(true) if left => 0.5 * weight,
                Some(false) if !left => 2.0 * weight,
                _ => 1.0,
            };
            moved_b = Some(left);
            if left {
                b = m;
                std::mem::swap(&mut self.g_b, &mut self.g_m);
            } else {
                a = m;
                std::mem::swap(&mut self.g_a, &mut self.g_m);
            }
            slow = if b - a > 0.5 * width { slow + 1 } else { 0 };
            width = b - a;
        }
        if b == stepper.span().1 {
            self.y.copy_from_slice(stepper.y_end());
        } else {
            stepper.dense(problem, b, &mut self.y)?;
        }
        Ok(b)
    }

    /// Where in `[a, b]`, as a fraction, the first of the functions' secants crosses zero.
    fn secant(&self, weight: f64) -> f64 {
        self.g_a
            .iter()
            .zip(&self.g_b)
            .filter(|&(&a, &b)| changed(a, b))
            .map(|(&a, &b)| weight * a / (weight * a - b))
            .fold(1.0, f64::min)
    }
}

/// Evaluates the event functions, checks and counts.
fn eval(
    problem: &mut (impl Watched + ?Sized),
    t: f64,
    state: &[f64],
    g: &mut [f64],
    stats: &mut Stats,
) -> Result<(), SolveError> {
    stats.event_evaluations += 1;
    let function = Function::Events;
    match problem.watch(t, state, g) {
        Ok(()) => {}
        Err(EvalFailure::Recoverable | EvalFailure::Fatal) => {
            return Err(SolveError::EvaluationFailed { function, t });
        }
    }
    match g.iter().position(|v| !v.is_finite()) {
        None => Ok(()),
        Some(i) => Err(SolveError::NotFinite { function, t, component: problem.watch_name(i) }),
    }
}
