//! [`run`]: derive, compile, integrate, record.

use std::rc::Rc;
use std::time::Instant;

use headland_dynamics::initial::Moved;
use headland_dynamics::{DeriveError, Equations, derive};
use headland_model::Model;
#[cfg(feature = "ida")]
use headland_solve::Method;
use typed_arena::Arena;

use crate::modes::{model_at_start, refuse};
use crate::options::{RunError, RunOptions};
use crate::record::Recorder;
use crate::report::{Observer, RunReport, Silent, Trajectory};
use crate::schedule::Schedule;
use crate::system::System;
use crate::time_loop::TimeLoop;
use crate::work::{all_velocities, given_state, start_state};

/// A run's result: what was computed until the end or until it failed.
#[derive(Clone, Debug)]
pub struct Run {
    /// The columns.
    pub trajectory: Trajectory,
    /// What was counted.
    pub report: RunReport,
}

/// Derives, compiles and integrates a model.
///
/// # Errors
/// [`RunError`] if it cannot start; a run that fails on the way gives its report and all that was computed.
pub fn run(model: &Model, options: &RunOptions, observer: &mut dyn Observer) -> Result<Run, RunError> {
    check(options)?;
    if let Some(message) = refuse(model, options) {
        return Err(RunError::Method { message });
    }
    let arena = Arena::new();
    let prepared = Prepared::new(model_at_start(model, &arena), options)?;
    let clock = Instant::now();
    let schedule = Rc::new(Schedule::new(model, options));
    let compile_s = prepared.compile_s + clock.elapsed().as_secs_f64();
    let (derive_s, system) = (prepared.derive_s, &prepared.system);

    let mut times = Vec::new();
    let mut result = None;
    for repeat in 0..options.repeat.max(1) {
        let mut silent = Silent;
        let watcher: &mut dyn Observer = if repeat == 0 { &mut *observer } else { &mut silent };
        let mut recorder = Recorder::new(model, options);
        let clock = Instant::now();
        let mut time_loop = TimeLoop::new(model, &prepared, schedule.clone(), options, &arena)?;
        time_loop.run(&mut recorder, watcher);
        let ending = time_loop.end();
        times.push(clock.elapsed().as_secs_f64() - ending.derive_s - ending.compile_s);
        result.get_or_insert((recorder, ending));
    }
    times.sort_by(f64::total_cmp);
    let Some((recorder, ending)) = result else { unreachable!("repeated at least once") };
    let median = (times.len() > 1).then(|| times[times.len() / 2]);
    let report = RunReport {
        status: ending.status,
        title: model.title.clone(),
        method: ending.method.into(),
        why: ending.why,
        tolerance: options.tolerance,
        t_end: ending.t,
        coordinates: system.nq,
        degrees_of_freedom: prepared.eliminated.kinematics.quasi.len(),
        steps: ending.stats.steps,
        rejected: ending.stats.rejected,
        rhs: ending.stats.rhs,
        rhs_outputs: recorder.evaluations + ending.balance_evaluations,
        jacobians: ending.stats.jacobians,
        factorizations: ending.stats.factorizations,
        events: ending.stats.events,
        repartitions: ending.repartitions,
        mode_changes: ending.mode_changes,
        restarts: ending.stats.restarts,
        derive_s: derive_s + ending.derive_s,
        compile_s: compile_s + ending.compile_s,
        run_s: times[0],
        run_s_median: median,
        operations: ending.operations,
        evaluator: system.evaluator(),
        algorithm: prepared.equations.algorithm,
        algorithm_why: prepared.equations.why.clone(),
        energy_balance: ending.energy_balance,
        constraint_position: recorder.position_residual,
        constraint_velocity: recorder.residual,
        log: ending.log,
    };
    Ok(Run { trajectory: recorder.trajectory, report })
}

/// Equations derived and compiled as the method wants them.
pub(crate) struct Prepared<'m> {
    /// The model, contacts in the modes of the start.
    pub(crate) model: &'m Model,
    /// Those of the system.
    pub(crate) equations: Equations,
    /// Those by elimination, which know the degrees of freedom and the start.
    eliminated: Equations,
    pub(crate) system: Rc<System>,
    /// What the formulation is, where it is another one than elimination.
    pub(crate) why: Option<String>,
    derive_s: f64,
    compile_s: f64,
}

impl<'m> Prepared<'m> {
    fn new(model: &'m Model, options: &RunOptions) -> Result<Self, RunError> {
        let clock = Instant::now();
        let eliminated = derive(model, &options.derive)?;
        let derive_s = clock.elapsed().as_secs_f64();
        #[cfg(feature = "ida")]
        if let Some(method) = Method::parse(&options.method).ok().filter(|m| m.is_dae()) {
            return Self::descriptor(model, eliminated, method, derive_s);
        }
        let clock = Instant::now();
        let system = Rc::new(System::new(model, &eliminated));
        let compile_s = clock.elapsed().as_secs_f64();
        Ok(Self { model, equations: eliminated.clone(), eliminated, system, why: None, derive_s, compile_s })
    }

    /// Nothing eliminated: for IDA.
    #[cfg(feature = "ida")]
    fn descriptor(model: &'m Model, eliminated: Equations, method: Method, derive_s: f64) -> Result<Self, RunError> {
        use crate::dae::Form;
        let clock = Instant::now();
        let descriptor = headland_dynamics::form_descriptor(model, &eliminated.kinematics.redundant)?;
        let derive_s = derive_s + clock.elapsed().as_secs_f64();
        let clock = Instant::now();
        let form = if method == Method::IdaIndex1 { Form::Index1 } else { Form::Stabilised };
        let system = Rc::new(System::of_descriptor(model, &descriptor, form));
        let (constraints, holonomic) = system.dae.as_ref().map_or((0, 0), crate::dae::DaeFunctions::constraints);
        let why = match form {
            _ if constraints == 0 => {
                "asked for; there are no constraints, so this is an implicit method like others".into()
            }
            Form::Stabilised => format!(
                "asked for; stabilised index 2: {constraints} multipliers, {holonomic} corrections of positions"
            ),
            Form::Index1 => format!("asked for; index 1: {constraints} multipliers, positions and velocities drift"),
        };
        let compile_s = clock.elapsed().as_secs_f64();
        Ok(Self { model, equations: descriptor.equations, eliminated, system, why: Some(why), derive_s, compile_s })
    }

    /// The state at the start, and what was done to get there.
    pub(crate) fn start(&self, model: &Model, from: f64) -> Result<(Vec<f64>, Vec<String>), RunError> {
        let free = self.why.is_some();
        let mut notes = Vec::new();
        let (y, moved) = match start_state(model, &self.eliminated, from) {
            Ok(found) if !free => found,
            Ok((y, moved)) => (all_velocities(model, &self.eliminated, &self.equations, from, &y), moved),
            Err(DeriveError::InconsistentStart { name, given, found }) if free => {
                notes.push(format!(
                    "start: the given {name} = {given} contradicts what else is given, by which it is {found}; the given \
                     rates are changed as little as the constraints want"
                ));
                given_state(model, &self.equations)?
            }
            Err(error) => return Err(error.into()),
        };
        let say = |m: &Moved| {
            let unit = model.coordinates.iter().find(|c| c.name == m.name).map(|c| format!(" {}", c.unit));
            let (name, from, to, unit) = (&m.name, m.from, m.to, unit.filter(|u| u != " 1").unwrap_or_default());
            format!("start: `{name}` moved from {from:.6}{unit} to {to:.6}{unit} to fulfil the constraints")
        };
        notes.extend(moved.iter().map(say));
        Ok((y, notes))
    }
}

fn check(options: &RunOptions) -> Result<(), RunError> {
    let (from, until) = (options.from, options.until);
    let single = options.at.is_some() && until == from; // the start alone
    if until.is_nan() || from.is_nan() || (until <= from && !single) {
        return Err(RunError::Empty { from, until });
    }
    match options.at.iter().flatten().find(|t| !(from..=until).contains(*t)) {
        Some(&t) => Err(RunError::OutputTime { t, from, until }),
        None => Ok(()),
    }
}
