//! [`run`]: derive, compile, integrate, record.

use std::rc::Rc;
use std::time::Instant;

use headland_dynamics::derive;
use headland_model::Model;

use crate::options::{RunError, RunOptions};
use crate::record::Recorder;
use crate::report::{Observer, RunReport, Silent, Trajectory};
use crate::schedule::Schedule;
use crate::system::System;
use crate::time_loop::TimeLoop;

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
    let clock = Instant::now();
    let equations = derive(model, &options.derive)?;
    let derive_s = clock.elapsed().as_secs_f64();
    let clock = Instant::now();
    let system = Rc::new(System::new(model, &equations));
    let schedule = Rc::new(Schedule::new(model, options));
    let compile_s = clock.elapsed().as_secs_f64();

    let mut times = Vec::new();
    let mut result = None;
    for repeat in 0..options.repeat.max(1) {
        let mut silent = Silent;
        let watcher: &mut dyn Observer = if repeat == 0 { &mut *observer } else { &mut silent };
        let mut recorder = Recorder::new(model, options);
        let clock = Instant::now();
        let mut time_loop = TimeLoop::new(model, &equations, system.clone(), schedule.clone(), options)?;
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
        degrees_of_freedom: system.nu,
        steps: ending.stats.steps,
        rejected: ending.stats.rejected,
        rhs: ending.stats.rhs,
        rhs_outputs: recorder.evaluations + ending.balance_evaluations,
        jacobians: ending.stats.jacobians,
        factorizations: ending.stats.factorizations,
        events: ending.stats.events,
        repartitions: ending.repartitions,
        restarts: ending.stats.restarts,
        derive_s: derive_s + ending.derive_s,
        compile_s: compile_s + ending.compile_s,
        run_s: times[0],
        run_s_median: median,
        operations: system.operations(),
        evaluator: system.evaluator(),
        algorithm: equations.algorithm,
        algorithm_why: equations.why.clone(),
        energy_balance: ending.energy_balance,
        constraint_position: recorder.position_residual,
        constraint_velocity: recorder.residual,
        log: ending.log,
    };
    Ok(Run { trajectory: recorder.trajectory, report })
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
