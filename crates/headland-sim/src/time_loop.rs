//! [`TimeLoop`]: steps of the method, with everything that a run does between them.

use std::rc::Rc;
use std::time::Instant;

use headland_code::Evaluator;
use headland_dynamics::{Equations, choose_dependent, derive_at};
use headland_model::{Direction, Model, RowForm};
use headland_solve::{Method, Options, SolveError, Stats, Step};
use typed_arena::Arena;

use crate::balance::Balance;
use crate::modes::{Contacts, Form};
use crate::options::{RunError, RunOptions};
use crate::passage::Passage;
use crate::record::Recorder;
use crate::report::{LogEntry, Observer, Status};
use crate::run::Prepared;
use crate::schedule::Schedule;
use crate::stepper::Stepper;
use crate::system::{System, Watch};
use crate::work::{Work, solver_options};

/// Growth of the partition, the largest scaled entry of G, at which better independent rates are looked for.
const GROWTH: f64 = 3.0;

/// Tolerances of error that a step over a place where the constraints lose rank may have: it is no longer than the method
/// proposed, so that what is more than one tolerance is rounding, which a shorter step would only enlarge.
const LENIENCY: f64 = 1e2;

/// A run in progress.
pub(crate) struct TimeLoop<'m> {
    pub(crate) model: &'m Model,
    pub(crate) equations: Equations,
    pub(crate) options: &'m RunOptions,
    schedule: Rc<Schedule>,
    pub(crate) work: Work,
    pub(crate) method: Method,
    why: String,
    integrator: Stepper,
    pub(crate) y: Vec<f64>,
    pub(crate) balance: Option<Balance>,
    growth_limit: f64,
    warned: Vec<bool>,
    passage: Passage,
    /// Passages through places where the constraints lose rank.
    passages: u64,
    /// Equations that were derived before.
    pub(crate) known: Vec<Form<'m>>,
    pub(crate) contacts: Contacts<'m>,
    /// The method begins anew when everything at this time is told.
    corner: bool,
    pub(crate) ending: Ending,
}

/// What is known when the loop has ended.
#[derive(Clone, Debug)]
pub(crate) struct Ending {
    pub(crate) status: Status,
    pub(crate) method: &'static str,
    pub(crate) why: String,
    pub(crate) t: f64,
    pub(crate) stats: Stats,
    pub(crate) operations: usize,
    pub(crate) repartitions: u64,
    pub(crate) mode_changes: u64,
    pub(crate) derive_s: f64,
    pub(crate) compile_s: f64,
    pub(crate) energy_balance: Option<f64>,
    pub(crate) balance_evaluations: u64,
    pub(crate) log: Vec<LogEntry>,
}

impl<'m> TimeLoop<'m> {
    /// Everything ready to start.
    pub(crate) fn new(
        scene: &'m Model,
        prepared: &Prepared<'m>,
        schedule: Rc<Schedule>,
        options: &'m RunOptions,
        arena: &'m Arena<Model>,
    ) -> Result<Self, RunError> {
        let Prepared { model, equations, system, .. } = prepared;
        let model = *model;
        let auto = options.method == "auto";
        let method = if auto { Method::Dop853 } else { Method::parse(&options.method)? };
        let why = match &prepared.why {
            _ if auto => "auto: explicit of order 8, for the motion does not look stiff",
            Some(formulation) => formulation,
            None => "asked for",
        };
        let mut work = Work::new(system.clone(), method);
        let (a, b) = schedule.span(options.from);
        work.problem.set_span(a, b);
        let (y, notes) = prepared.start(model, options.from)?;
        let log = notes.into_iter().map(|message| LogEntry { t: options.from, message }).collect();
        Ok(Self {
            integrator: stepper(method, system, solver_options(model, system, options))?,
            y,
            balance: (options.balance && !system.is_empty()).then(|| Balance::new(system.clone())),
            warned: vec![false; model.guards.len()],
            passage: Passage::default(),
            passages: 0,
            known: vec![Form { model, equations: equations.clone(), system: system.clone() }],
            corner: false,
            contacts: Contacts::new(scene, model, arena, options.tolerance),
            equations: equations.clone(),
            growth_limit: if model.run.independent.is_some() { 10.0 * GROWTH } else { GROWTH },
            why: why.into(),
            ending: Ending {
                status: Status::Done,
                method: method.name(),
                why: String::new(),
                t: options.from,
                stats: Stats::default(),
                operations: 0,
                repartitions: 0,
                mode_changes: 0,
                derive_s: 0.0,
                compile_s: 0.0,
                energy_balance: None,
                balance_evaluations: 0,
                log,
            },
            model,
            options,
            schedule,
            work,
            method,
        })
    }

    /// From the start to the end, or to what stops it; rows are recorded on the way.
    pub(crate) fn run(&mut self, recorder: &mut Recorder, observer: &mut dyn Observer) {
        if let Err(error) = self.begin(recorder, observer) {
            self.fail(&error);
        }
        while self.ending.status == Status::Done && self.integrator.t() < self.options.until {
            if let Err(error) = self.advance(recorder, observer) {
                self.fail(&error);
            }
        }
        if self.ending.status != Status::Done {
            recorder.last_row(&mut self.work, self.integrator.t(), self.integrator.y());
        }
        self.judge(recorder, observer);
    }

    /// What a run that came to its end should still be warned of.
    fn judge(&mut self, recorder: &Recorder, observer: &mut dyn Observer) {
        let t = self.integrator.t();
        let defect = self.balance.as_ref().map_or(0.0, Balance::defect);
        if defect > self.options.tolerance.sqrt() {
            let message = format!(
                "warning: work and energy disagree by {defect:.1e} of the run's largest energy; a tighter tolerance \
                 helps, unless a function jumps or an inertia element does not mean what it says"
            );
            self.tell(t, &message, observer);
        }
        for (name, first) in recorder.not_finite() {
            self.tell(
                t,
                &format!("warning: the column `{name}` is not finite at t = {first} s and maybe later"),
                observer,
            );
        }
    }

    fn begin(&mut self, recorder: &mut Recorder, observer: &mut dyn Observer) -> Result<(), SolveError> {
        let t = self.options.from;
        for entry in &self.ending.log {
            observer.message(t, &entry.message);
        }
        self.start_contacts(observer)?;
        if self.ending.status != Status::Done {
            return Ok(());
        }
        self.start(t, observer)?;
        if let Some(balance) = &mut self.balance {
            balance.open(&mut self.work.problem, t, &self.y);
        }
        recorder.catch_up(&mut self.work, &mut self.integrator)?;
        self.watch_guards(t, observer);
        Ok(())
    }

    /// One accepted step and what follows from it.
    fn advance(&mut self, recorder: &mut Recorder, observer: &mut dyn Observer) -> Result<(), SolveError> {
        let t = self.integrator.t();
        self.integrator.set_h_max(self.schedule.longest_step(t));
        let mut stop = self.schedule.next_stop(t);
        if let Some(h) = self.integrator.proposed_step().and_then(|h| self.passage.step(t, h))
            && t + h < stop
        {
            stop = t + h;
            self.integrator.set_leniency(LENIENCY);
        }
        if let Some(soon) = self.contacts.soon.take().filter(|soon| *soon > t) {
            stop = stop.min(soon);
        }
        let step = self.integrator.step(&mut self.work.problem, stop)?;
        self.integrator.set_leniency(1.0);
        let t = self.integrator.t();
        self.watch_rank(observer)?;
        if let Some(balance) = &mut self.balance {
            balance.add_step(&mut self.work.problem, &mut self.integrator)?;
        }
        recorder.catch_up(&mut self.work, &mut self.integrator)?;
        observer.step(t, t - self.integrator.t_previous());
        if let Some(reason) = observer.stop() {
            self.ending.status = Status::Stopped(reason);
        }
        self.y.clear();
        self.y.extend_from_slice(self.integrator.y());
        self.watch_guards(t, observer);
        self.aim_slides(t);
        if let Step::Event { index, rising, .. } = step {
            match self.work.system.watches[index] {
                Watch::Contact(k, limit) if !rising => return self.on_limit(t, k, limit, observer),
                watch => self.on_event(watch, t, rising, observer),
            }
        }
        if let Some((k, limit)) = self.overlooked_limit(t)? {
            return self.on_limit(t, k, limit, observer);
        }
        if self.ending.status != Status::Done || t >= self.options.until {
            return Ok(());
        }
        self.corner |= matches!(step, Step::Event { index, .. } if self.is_corner(index));
        let corner = self.corner && self.integrator.events_waiting() == 0; // a restart would drop them
        let breakpoint = matches!(step, Step::End { .. }) && self.schedule.is_breakpoint(t);
        let stiff = self.leave_explicit(t, observer)?;
        let changed = self.repartition(t, observer)?;
        if changed {
            self.passage.forget();
        }
        if breakpoint || stiff || changed || corner {
            let before = self.work.kinetic(t, &self.y);
            let (a, b) = self.schedule.span(t);
            self.work.problem.set_span(a, b);
            if breakpoint && !changed {
                self.warn_of_jump(t, before, observer);
            }
            self.start(t, observer)?;
        }
        Ok(())
    }

    /// Starts the method again at the state `y`, after something jumped.
    pub(crate) fn restart(&mut self, t: f64, observer: &mut dyn Observer) -> Result<(), SolveError> {
        let (a, b) = self.schedule.span(t);
        self.work.problem.set_span(a, b);
        self.passage.forget();
        self.start(t, observer)
    }

    /// Starts the method at the state `y`, and tells what it changed there.
    fn start(&mut self, t: f64, observer: &mut dyn Observer) -> Result<(), SolveError> {
        self.corner = false;
        self.integrator.start(&mut self.work.problem, t, &self.y)?;
        self.y.clear();
        self.y.extend_from_slice(self.integrator.y());
        for note in self.integrator.take_notes() {
            self.tell(t, &note, observer);
        }
        Ok(())
    }

    /// Whether an event function is zero where forces have a corner.
    fn is_corner(&self, index: usize) -> bool {
        match self.work.system.watches.get(index) {
            Some(Watch::Switch(i)) => self.model.switches[*i].restarts,
            _ => false,
        }
    }

    /// A prescribed motion or a constraint that jumps would need an impulse, which is not computed.
    fn warn_of_jump(&mut self, t: f64, before: f64, observer: &mut dyn Observer) {
        let after = self.work.kinetic(t, &self.y);
        if (after - before).abs() > 1e-9 * (after.abs() + before.abs()) {
            let message = format!(
                "warning: the kinetic energy jumps from {before:.6} to {after:.6} J: a prescribed motion or a constraint \
                 jumps or has a corner, which would need an impulse; none is computed, smooth the function of time"
            );
            self.tell(t, &message, observer);
        }
    }

    /// `auto` goes over to BDF when the explicit method's steps stay at the bound of stability.
    fn leave_explicit(&mut self, t: f64, observer: &mut dyn Observer) -> Result<bool, SolveError> {
        let auto = self.options.method == "auto" && self.method == Method::Dop853;
        if !auto || !self.integrator.looks_stiff() || !Method::CvodeBdf.is_built() || self.begins_to_slide(t) {
            return Ok(false);
        }
        self.method = Method::CvodeBdf;
        self.why = format!(
            "auto: stiff; explicit of order 8 until t = {t} s, where its steps stayed at the bound of stability"
        );
        self.tell(t, "the motion looks stiff: going on with cvode-bdf", observer);
        self.use_system(self.work.system.clone())?;
        Ok(true)
    }

    /// `auto` tries the explicit method again: what was stiff in one mode of the contacts need not be in the next.
    pub(crate) fn explicit_again(&mut self) {
        if self.options.method == "auto" {
            self.method = Method::Dop853;
        }
    }

    /// Looks for better independent rates when the entries of G have grown.
    fn repartition(&mut self, t: f64, observer: &mut dyn Observer) -> Result<bool, SolveError> {
        if let Some(changed) = self.watch_redundant(t, observer)? {
            return Ok(changed);
        }
        let growth = self.work.growth(t, &self.y);
        if growth < self.growth_limit {
            return Ok(false);
        }
        if self.model.run.independent.is_some() {
            self.growth_limit = f64::INFINITY; // said once
            let message = format!(
                "warning: the rates named by `independent` are close to singular: others are up to {growth:.0} times as \
                 large; without `independent` they are changed in time"
            );
            self.tell(t, &message, observer);
            return Ok(false);
        }
        self.growth_limit = 2.0 * growth; // if nothing better is found
        let inputs = self.work.model_inputs(self.model, t, &self.y);
        let Some((equations, system)) = self.derive_again(&inputs) else { return Ok(false) };
        let mut better = Work::new(system.clone(), self.method);
        let y = better.state_from(self.model, &inputs);
        if better.growth(t, &y) > 0.7 * growth {
            return Ok(false);
        }
        let names: Vec<&str> = system.kinematics.quasi.iter().map(|u| u.name.as_str()).collect();
        let message = format!("independent rates are now {} (growth of the old ones: {growth:.1})", names.join(", "));
        match self.ending.repartitions {
            0..5 => observer.message(t, &message),
            5 => observer.message(t, "further changes of the independent rates are only noted in the report"),
            _ => {}
        }
        self.ending.log.push(LogEntry { t, message });
        self.ending.repartitions += 1;
        self.growth_limit = GROWTH;
        self.equations = equations;
        self.y = y;
        self.use_system(system)?;
        Ok(true)
    }

    /// Where a pivot went through zero, the constraints were dependent on the way, and the motion could have branched. It
    /// goes on smoothly, along the same branch.
    fn watch_rank(&mut self, observer: &mut dyn Observer) -> Result<(), SolveError> {
        let t = self.integrator.t();
        let Some(k) = self.passage.look(&mut self.work, &mut self.integrator)? else { return Ok(()) };
        self.passages += 1;
        let name = &self.model.kinematics[self.work.system.pivot_rows[k]].name;
        let message = format!(
            "within the last step the constraints lost rank for a moment (`{name}` followed from the others): the motion \
             went on along the same branch; some digits are lost at such a place"
        );
        if self.passages <= 3 {
            observer.message(t, &message);
        }
        self.ending.log.push(LogEntry { t, message });
        Ok(())
    }

    /// Constraints left out as redundant must go on to follow from the others; where one does not any more, the choice is
    /// made again.
    fn watch_redundant(&mut self, t: f64, observer: &mut dyn Observer) -> Result<Option<bool>, SolveError> {
        let fastest = self.y[self.work.system.nq..self.work.system.len()].iter().fold(0.0_f64, |a, u| a.max(u.abs()));
        let Some((residual, row)) = self.work.redundant_residual(t, &self.y) else { return Ok(None) };
        if residual <= 1e-6 * fastest.max(1e-3) {
            return Ok(None);
        }
        let rows = self.model.kinematics.iter().filter(|r| matches!(r.form, RowForm::Zero(_)));
        let name = rows.map(|r| r.name.as_str()).nth(row).unwrap_or_default().to_string();
        let inputs = self.work.model_inputs(self.model, t, &self.y);
        let again = if self.method.is_dae() { None } else { self.derive_again(&inputs) };
        let Some((equations, system)) = again else {
            let reason = format!(
                "the constraint `{name}` followed from the others at the start but does not at t = {t} s: \
                 there is more than one way on"
            );
            self.ending.status = Status::Failed(reason);
            return Ok(Some(false));
        };
        self.y = Work::new(system.clone(), self.method).state_from(self.model, &inputs);
        self.tell(t, &format!("the constraint `{name}` does not follow from the others any more"), observer);
        self.ending.repartitions += 1;
        self.equations = equations;
        self.use_system(system)?;
        Ok(Some(true))
    }

    /// The equations for the independent rates that suit the given state, derived or fetched; none if they are the present ones.
    fn derive_again(&mut self, inputs: &[f64]) -> Option<(Equations, Rc<System>)> {
        let clock = Instant::now();
        let dependent = choose_dependent(self.model, inputs).ok()?;
        self.ending.derive_s += clock.elapsed().as_secs_f64();
        if dependent == self.work.system.kinematics.dependent {
            return None;
        }
        let modes = &self.work.system.modes;
        let is_wanted = |f: &&Form<'_>| f.system.modes == *modes && f.equations.kinematics.dependent == dependent;
        if let Some(known) = self.known.iter().find(is_wanted) {
            return Some((known.equations.clone(), known.system.clone()));
        }
        let clock = Instant::now();
        let equations = derive_at(self.model, inputs, &self.options.derive).ok()?;
        self.ending.derive_s += clock.elapsed().as_secs_f64();
        let clock = Instant::now();
        let system = Rc::new(System::new(self.model, &equations));
        self.ending.compile_s += clock.elapsed().as_secs_f64();
        self.known.push(Form { model: self.model, equations: equations.clone(), system: system.clone() });
        Some((equations, system))
    }

    /// Goes over to another system or method; the caller restarts the integrator.
    pub(crate) fn use_system(&mut self, system: Rc<System>) -> Result<(), SolveError> {
        add(&mut self.ending.stats, self.integrator.stats());
        self.ending.stats.restarts += 1; // the new integrator does not count its first start
        let mut options = solver_options(self.model, &system, self.options);
        options.max_steps = self.options.max_steps.saturating_sub(self.ending.stats.steps); // of the whole run
        self.integrator = stepper(self.method, &system, options)?;
        if let Some(balance) = &mut self.balance {
            balance.change_system(system.clone());
        }
        self.work = Work::new(system, self.method);
        self.contacts.aim(&mut self.work.problem);
        Ok(())
    }

    fn watch_guards(&mut self, t: f64, observer: &mut dyn Observer) {
        if self.model.guards.is_empty() {
            return;
        }
        let work = &mut self.work;
        let values = work.guards.eval(work.problem.inputs_for(&work.system.guards, t, &self.y)).to_vec();
        for (i, (guard, value)) in self.model.guards.iter().zip(values).enumerate() {
            let below = guard.warn_below.is_some_and(|limit| value < limit);
            if below && !self.warned[i] {
                self.warn_of_guard(t, i, value, observer);
            }
            self.warned[i] = below;
            if let Some(limit) = guard.stop_below.filter(|limit| value < *limit) {
                self.stop_by_guard(t, i, value, limit);
            }
        }
    }

    fn warn_of_guard(&mut self, t: f64, i: usize, value: f64, observer: &mut dyn Observer) {
        let guard = &self.model.guards[i];
        let (name, unit, limit) = (&guard.name, &guard.unit, guard.warn_below.unwrap_or_default());
        let why = if guard.message.is_empty() { String::new() } else { format!(": {}", guard.message) };
        let message = if value < limit {
            format!("warning: {name} = {value:.6}{unit} is below {limit:.6}{unit}{why}")
        } else {
            format!("warning: {name} fell below {limit:.6}{unit}{why}")
        };
        self.tell(t, &message, observer);
    }

    fn stop_by_guard(&mut self, t: f64, i: usize, value: f64, limit: f64) {
        let guard = &self.model.guards[i];
        let (name, unit) = (&guard.name, &guard.unit);
        let why = if guard.message.is_empty() { String::new() } else { format!(": {}", guard.message) };
        let reason = format!("{name} = {value:.6}{unit} fell below {limit:.6}{unit} at t = {t} s{why}");
        self.ending.status = Status::Failed(reason);
    }

    fn on_event(&mut self, watch: Watch, t: f64, rising: bool, observer: &mut dyn Observer) {
        match watch {
            Watch::Guard(i) if !rising => {
                let limit = self.model.guards[i].stop_below.unwrap_or_default();
                self.stop_by_guard(t, i, limit, limit);
            }
            Watch::Guard(_) | Watch::Contact(..) | Watch::Switch(_) | Watch::Nearest => {}
            Watch::Warning(i) => {
                if !rising && !self.warned[i] {
                    self.warn_of_guard(t, i, self.model.guards[i].warn_below.unwrap_or_default(), observer);
                }
                self.warned[i] = !rising;
            }
            Watch::Event(i) => {
                let event = &self.model.events[i];
                let wanted = match event.direction {
                    Direction::Both => true,
                    Direction::Rising => rising,
                    Direction::Falling => !rising,
                };
                if wanted {
                    self.tell(t, &format!("event `{}`", event.name), observer);
                    if event.stop {
                        self.ending.status = Status::Stopped(format!("event `{}` at t = {t} s", event.name));
                    }
                }
            }
        }
    }

    pub(crate) fn tell(&mut self, t: f64, message: &str, observer: &mut dyn Observer) {
        observer.message(t, message);
        self.ending.log.push(LogEntry { t, message: message.into() });
    }

    fn fail(&mut self, error: &SolveError) {
        let blame = self.work.blame(self.model, &self.equations).map_or(String::new(), |b| format!("; {b}"));
        let t = self.integrator.t();
        self.ending.status = Status::Failed(format!("{error}{blame}; the last good state is at t = {t} s"));
    }

    /// What the loop has found out.
    pub(crate) fn end(mut self) -> Ending {
        add(&mut self.ending.stats, self.integrator.stats());
        let t = self.integrator.t();
        self.ending.t = if t.is_finite() { t } else { self.options.from }; // it never began
        self.ending.operations = self.work.system.operations();
        self.ending.method = self.method.name();
        self.ending.why = self.why;
        self.ending.energy_balance = self.balance.as_ref().map(|b| b.defect());
        self.ending.balance_evaluations = self.balance.as_ref().map_or(0, |b| b.evaluations);
        self.ending
    }
}

/// The method at work on a system.
fn stepper(method: Method, system: &System, options: Options) -> Result<Stepper, SolveError> {
    #[cfg(feature = "ida")]
    if let Some(functions) = &system.dae {
        return Ok(Stepper::Dae(Box::new(crate::dae::DaeStepper::new(functions, options)?)));
    }
    Ok(Stepper::Ode(method.create(system.len(), options)?))
}

/// Adds the counts of an integrator that is left.
fn add(total: &mut Stats, part: &Stats) {
    total.steps += part.steps;
    total.rejected += part.rejected;
    total.rhs += part.rhs;
    total.jacobians += part.jacobians;
    total.factorizations += part.factorizations;
    total.nonlinear_iterations += part.nonlinear_iterations;
    total.nonlinear_failures += part.nonlinear_failures;
    total.event_evaluations += part.event_evaluations;
    total.events += part.events;
    total.projections += part.projections;
    total.restarts += part.restarts;
}
