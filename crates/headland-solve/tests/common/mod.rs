//! Problems made of closures, and the loops that tests share.
#![allow(dead_code)]

use headland_solve::{EvalFailure, Integrator, OdeProblem, Options, Pattern, SolveError, Step};

pub type Eval = Result<(), EvalFailure>;
type Fun = Box<dyn FnMut(f64, &[f64], &mut [f64]) -> Eval>;

/// A problem of closures that counts its calls and remembers the latest time it was asked for.
pub struct Problem {
    n: usize,
    rhs: Fun,
    events: Option<(usize, Fun)>,
    jacobian: Option<(Pattern, Fun)>,
    projection: Option<Fun>,
    pub rhs_calls: u64,
    pub event_calls: u64,
    pub jacobian_calls: u64,
    pub projection_calls: u64,
    pub t_latest: f64,
}

impl Problem {
    pub fn new(n: usize, mut rhs: impl FnMut(f64, &[f64], &mut [f64]) + 'static) -> Self {
        Self::fallible(n, move |t, y, dy| {
            rhs(t, y, dy);
            Ok(())
        })
    }

    pub fn fallible(n: usize, rhs: impl FnMut(f64, &[f64], &mut [f64]) -> Eval + 'static) -> Self {
        Self {
            n,
            rhs: Box::new(rhs),
            events: None,
            jacobian: None,
            projection: None,
            rhs_calls: 0,
            event_calls: 0,
            jacobian_calls: 0,
            projection_calls: 0,
            t_latest: f64::NEG_INFINITY,
        }
    }

    pub fn events(mut self, count: usize, mut g: impl FnMut(f64, &[f64], &mut [f64]) + 'static) -> Self {
        let f: Fun = Box::new(move |t, y, out| {
            g(t, y, out);
            Ok(())
        });
        self.events = Some((count, f));
        self
    }

    /// Dense Jacobian, written by columns.
    pub fn jacobian(mut self, mut j: impl FnMut(f64, &[f64], &mut [f64]) + 'static) -> Self {
        let f: Fun = Box::new(move |t, y, out| {
            j(t, y, out);
            Ok(())
        });
        self.jacobian = Some((Pattern::dense(self.n, self.n), f));
        self
    }

    pub fn projection(mut self, p: impl FnMut(f64, &[f64], &mut [f64]) -> Eval + 'static) -> Self {
        self.projection = Some(Box::new(p));
        self
    }
}

impl OdeProblem for Problem {
    fn len(&self) -> usize {
        self.n
    }
    fn rhs(&mut self, t: f64, y: &[f64], dy: &mut [f64]) -> Eval {
        self.rhs_calls += 1;
        self.t_latest = self.t_latest.max(t);
        (self.rhs)(t, y, dy)
    }
    fn pattern(&self) -> Option<&Pattern> {
        self.jacobian.as_ref().map(|(pattern, _)| pattern)
    }
    fn jacobian(&mut self, t: f64, y: &[f64], values: &mut [f64]) -> Eval {
        self.jacobian_calls += 1;
        self.t_latest = self.t_latest.max(t);
        self.jacobian.as_mut().unwrap().1(t, y, values)
    }
    fn event_count(&self) -> usize {
        self.events.as_ref().map_or(0, |(count, _)| *count)
    }
    fn events(&mut self, t: f64, y: &[f64], g: &mut [f64]) -> Eval {
        self.event_calls += 1;
        self.t_latest = self.t_latest.max(t);
        self.events.as_mut().unwrap().1(t, y, g)
    }
    fn has_projection(&self) -> bool {
        self.projection.is_some()
    }
    fn project(&mut self, t: f64, y: &[f64], correction: &mut [f64]) -> Eval {
        self.projection_calls += 1;
        self.t_latest = self.t_latest.max(t);
        (self.projection.as_mut().unwrap())(t, y, correction)
    }
    fn component_name(&self, i: usize) -> String {
        format!("x{i}")
    }
}

pub fn tolerance(n: usize, rtol: f64) -> Options {
    Options::new(rtol, vec![rtol; n])
}

/// Goes to `t_stop`; events are a failure of the test.
pub fn run(integrator: &mut dyn Integrator, problem: &mut dyn OdeProblem, t_stop: f64) -> Result<(), SolveError> {
    loop {
        match integrator.step(problem, t_stop)? {
            Step::Advanced { .. } => {}
            Step::End { .. } => return Ok(()),
            Step::Event { t, index, .. } => panic!("event {index} at {t}"),
        }
    }
}

/// Goes to `t_stop` and collects the events.
pub fn run_events(
    integrator: &mut dyn Integrator,
    problem: &mut dyn OdeProblem,
    t_stop: f64,
) -> Result<Vec<(f64, usize, bool)>, SolveError> {
    let mut events = Vec::new();
    loop {
        match integrator.step(problem, t_stop)? {
            Step::Advanced { .. } => {}
            Step::End { .. } => return Ok(events),
            Step::Event { t, index, rising } => events.push((t, index, rising)),
        }
    }
}

/// `-log10` of the largest error relative to `floor + |reference|`.
pub fn digits(y: &[f64], reference: &[f64], floor: f64) -> f64 {
    let worst = y.iter().zip(reference).map(|(a, r)| (a - r).abs() / (floor + r.abs())).fold(0.0, f64::max);
    -worst.log10()
}
