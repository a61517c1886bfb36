//! What contacts do, from one mode to the next: a state machine around the steps of [`TimeLoop`].
//!
//! ```text
//! free     gap falls to 0           impact; then free again, rolling or sliding
//! rolling  normal force falls to 0  free          friction at its limit            sliding
//! sliding  normal force falls to 0  free          slip at its end                  rolling, or sliding another way
//! ```
//! After each change all contacts are looked at with the equations that follow from it, until every mode is what its own
//! forces and accelerations allow.

use std::rc::Rc;

use headland_dynamics::kinematics::velocity_inputs;
use headland_dynamics::{Equations, derive_at};
use headland_model::{Mode, Model};
use headland_solve::{OdeProblem, SolveError};
use typed_arena::Arena;

use crate::contact::{ContactState, Impact, SLIDE, dot, impact, length, look, unit};
use crate::options::RunOptions;
use crate::report::{Observer, Status};
use crate::system::{Limit, Problem, System, Watch};
use crate::time_loop::TimeLoop;
use crate::work::Work;

/// A gap that counts as closed at the start, m.
pub(crate) const CLOSED: f64 = 1e-9;

/// A speed that counts as none at the start, m/s.
const AT_REST: f64 = 1e-9;

/// Height of a bounce that rounding of positions does not let see any more, m.
pub(crate) const LOWEST_BOUNCE: f64 = 1e-11;

/// Part of the fastest velocity by which velocities may change where no impact is: what is left of a slip that ends.
const JUMP: f64 = 1e-5;

/// Part of its largest value so far by which a limit may be overstepped.
const OVERLOOKED: f64 = 1e-9;

/// Impacts of a contact that are told one by one.
pub(crate) const TOLD: u32 = 5;

/// Equations of one set of modes and one choice of independent rates, compiled.
#[derive(Clone)]
pub(crate) struct Form<'m> {
    pub(crate) model: &'m Model,
    pub(crate) equations: Equations,
    pub(crate) system: Rc<System>,
}

/// What is kept of the contacts while running.
pub(crate) struct Contacts<'m> {
    pub(crate) scene: &'m Model,
    arena: &'m Arena<Model>,
    models: Vec<(Vec<Mode>, &'m Model)>,
    /// Direction and shift of each contact that slides.
    slides: Vec<[f64; SLIDE]>,
    /// Impacts of each contact since it was last at rest on its surface.
    pub(crate) impacts: Vec<u32>,
    /// Largest normal force of each contact, and what was left of its friction, squared.
    largest: Vec<[f64; 2]>,
    /// Relative size of the shift.
    shift: f64,
    /// A time at which the next step must end: half of a short bounce.
    pub(crate) soon: Option<f64>,
}

/// The model at the start: contacts that the scene leaves open are free until looked at.
pub(crate) fn model_at_start<'m>(scene: &'m Model, arena: &'m Arena<Model>) -> &'m Model {
    if scene.contacts.is_empty() {
        return scene;
    }
    arena.alloc(scene.at_start())
}

impl<'m> Contacts<'m> {
    /// Of a scene that starts with the given model.
    pub(crate) fn new(scene: &'m Model, start: &'m Model, arena: &'m Arena<Model>, tolerance: f64) -> Self {
        let n = scene.contacts.len();
        Self {
            scene,
            arena,
            models: vec![(start.modes(), start)],
            slides: vec![[0.0; SLIDE]; n],
            impacts: vec![0; n],
            largest: vec![[0.0; 2]; n],
            shift: (0.1 * tolerance).max(1e-13),
            soon: None,
        }
    }

    fn model(&mut self, modes: &[Mode]) -> &'m Model {
        if let Some((_, model)) = self.models.iter().find(|(known, _)| known == modes) {
            return model;
        }
        let model: &'m Model = self.arena.alloc(self.scene.in_modes(modes));
        self.models.push((modes.to_vec(), model));
        model
    }

    /// Sets the inputs that say in which direction contacts slide.
    pub(crate) fn aim(&self, problem: &mut Problem) {
        let mut at = problem.system.slides_from;
        for (contact, slide) in self.scene.contacts.iter().zip(&self.slides) {
            if contact.friction.is_some() {
                problem.set_inputs(at, slide);
                at += SLIDE;
            }
        }
    }

    /// A contact slides from now on in a direction, from nothing: a speed of the size of the tolerance is added to its slip,
    /// so that friction has a direction from the first moment on.
    fn begin_slide(&mut self, k: usize, direction: [f64; 3], fastest: f64) {
        let shift = self.shift * fastest.max(1.0);
        for i in 0..3 {
            self.slides[k][i] = direction[i];
            self.slides[k][3 + i] = shift * direction[i];
        }
    }
}

impl<'m> TimeLoop<'m> {
    /// Modes of contacts that the scene leaves open, by gap and slip at the start.
    pub(crate) fn start_contacts(&mut self, observer: &mut dyn Observer) -> Result<(), SolveError> {
        if self.contacts.scene.contacts.is_empty() {
            return Ok(());
        }
        let t = self.options.from;
        let scene = self.contacts.scene;
        let mut modes = self.model.modes();
        let system = self.work.system.clone();
        let states = look(&system, &mut self.work.problem, t, &self.y);
        let mut hits = None;
        for (k, (contact, state)) in scene.contacts.iter().zip(&states).enumerate() {
            let [gap, rate, _] = state.gap;
            if contact.start.is_some() {
                // friction has no direction where nothing slips
                let rests = modes[k] == Mode::Sliding && length(state.across(state.slip)) <= AT_REST;
                if rests {
                    modes[k] = self.touching(k, state, AT_REST);
                }
                continue;
            }
            if gap < -CLOSED {
                self.ending.status = Status::Failed(format!(
                    "the contact `{}` starts {:.3e} m inside its surface; move the body, or give `start = \"rolling\"` \
                     and leave a coordinate open",
                    contact.name, -gap
                ));
                return Ok(());
            }
            if gap > CLOSED || rate > AT_REST {
                continue;
            }
            if rate < -AT_REST {
                hits.get_or_insert(k);
                continue;
            }
            let slip = length(state.across(state.slip));
            if contact.friction.is_none() && slip > AT_REST {
                self.ending.status = Status::Failed(format!(
                    "the contact `{}` starts with a slip of {slip:.3e} m/s, but without `friction` it never slips; give \
                     velocities that roll, leave them open with `start = \"rolling\"`, or give `friction`",
                    contact.name
                ));
                return Ok(());
            }
            modes[k] = self.touching(k, state, AT_REST);
        }
        let inputs = self.work.model_inputs(self.model, t, &self.y);
        self.settle(t, modes, inputs, observer)?;
        if let (Some(k), Status::Done) = (hits, &self.ending.status) {
            self.hit(t, k, observer)?;
        }
        Ok(())
    }

    /// Sliding or rolling, of a contact that touches.
    pub(crate) fn touching(&mut self, k: usize, state: &ContactState, at_rest: f64) -> Mode {
        let slip = state.across(state.slip);
        let Some(friction) = &self.contacts.scene.contacts[k].friction else { return Mode::Rolling };
        if length(slip) <= at_rest && !friction.viscous && state.limit > 0.0 {
            return Mode::Rolling;
        }
        let direction = unit(slip);
        self.contacts.slides[k] = [direction[0], direction[1], direction[2], 0.0, 0.0, 0.0];
        if length(slip) <= at_rest && !friction.viscous && state.kinetic > 0.0 {
            self.contacts.begin_slide(k, unit(state.across(state.slip_rate)), 1.0);
        }
        Mode::Sliding
    }

    /// The mode of a contact has come to its limit.
    pub(crate) fn on_limit(
        &mut self,
        t: f64,
        k: usize,
        limit: Limit,
        observer: &mut dyn Observer,
    ) -> Result<(), SolveError> {
        let system = self.work.system.clone();
        if limit == Limit::Gap {
            return self.hit(t, k, observer);
        }
        let states = look(&system, &mut self.work.problem, t, &self.y);
        let state = &states[k];
        let mut modes = system.modes.clone();
        match limit {
            Limit::Gap => {}
            Limit::Normal => modes[k] = Mode::Free,
            Limit::Cone => {
                let push = unit(state.across(state.force)).map(|x| -x);
                self.contacts.begin_slide(k, push, self.fastest());
                modes[k] = Mode::Sliding;
            }
            Limit::Slip => {
                let slip = length(state.across(state.slip));
                if slip > 1e-7 * self.fastest() {
                    // it turned by a right angle and goes on
                    self.aim_slides(t);
                    return self.restart(t, observer);
                }
                modes[k] = Mode::Rolling;
            }
        }
        let inputs = self.work.model_inputs(self.model, t, &self.y);
        self.settle(t, modes, inputs, observer)
    }

    /// A limit that lies behind the state although no event was seen: it was there when the mode began.
    pub(crate) fn overlooked_limit(&mut self, t: f64) -> Result<Option<(usize, Limit)>, SolveError> {
        if self.contacts.scene.contacts.is_empty() {
            return Ok(None);
        }
        let mut values = vec![0.0; self.work.system.watches.len()];
        let failed = SolveError::EvaluationFailed { function: headland_solve::Function::Events, t };
        self.work.problem.events(t, &self.y, &mut values).map_err(|_| failed)?;
        for (watch, value) in self.work.system.watches.iter().zip(values) {
            let Watch::Contact(k, limit) = *watch else { continue };
            let largest = match limit {
                Limit::Gap => &mut 1.0,
                Limit::Normal => &mut self.contacts.largest[k][0],
                Limit::Cone => &mut self.contacts.largest[k][1],
                Limit::Slip => continue,
            };
            *largest = largest.max(value);
            if value < -OVERLOOKED * *largest {
                return Ok(Some((k, limit)));
            }
        }
        Ok(None)
    }

    /// A contact hits its surface.
    fn hit(&mut self, t: f64, k: usize, observer: &mut dyn Observer) -> Result<(), SolveError> {
        let system = self.work.system.clone();
        let contact = &self.contacts.scene.contacts[k];
        let slips = contact.friction.is_some();
        let before = look(&system, &mut self.work.problem, t, &self.y)[k].clone();
        if before.gap[1] >= 0.0 {
            // grazing: it goes apart again, unless it is pressed on
            let inputs = self.work.model_inputs(self.model, t, &self.y);
            return self.settle(t, system.modes.clone(), inputs, observer);
        }
        let together = self.touching_together(t, k);
        if together.len() > 1 {
            return self.hit_together(t, k, &together, observer);
        }
        let stuck = |time_loop: &mut Self| {
            let message = format!(
                "the impact of `{}` at t = {t} s has no solution: friction presses the bodies together whatever the impulse \
                 (Painlevé's paradox)",
                contact.name
            );
            time_loop.ending.status = Status::Failed(message);
            Ok(())
        };
        let Some(mut found) = impact(&system, &mut self.work.problem, k, t, &self.y, slips, None) else {
            return stuck(self);
        };
        let kinetic = self.work.kinetic(t, &self.y);
        let after = moved(&self.y, system.nq, &found);
        let pull = -look(&system, &mut self.work.problem, t, &after)[k].gap[2];
        let lowest = (2.0 * pull.max(0.0) * LOWEST_BOUNCE).sqrt();
        let rests = found.rebound <= lowest;
        self.contacts.impacts[k] += 1;
        let number = self.contacts.impacts[k];
        if rests {
            let rest_time = 2.0 * found.rebound / (pull * (1.0 - before.restitution).max(1e-3));
            let Some(soft) = impact(&system, &mut self.work.problem, k, t, &self.y, slips, Some(0.0)) else {
                return stuck(self);
            };
            found = soft;
            if before.restitution > 0.0 && rest_time.is_finite() {
                let rest = t + rest_time;
                self.tell(
                    t,
                    &format!("`{}` comes to rest after {number} impacts at t = {rest} s", contact.name),
                    observer,
                );
            }
            self.contacts.impacts[k] = 0;
        }
        self.y = moved(&self.y, system.nq, &found);
        let lost = kinetic - self.work.kinetic(t, &self.y);
        if let Some(balance) = &mut self.balance {
            balance.add_work(-lost);
        }
        if (number <= TOLD && before.restitution > 0.0) || (rests && number == 1) {
            let (name, speed) = (&contact.name, -before.gap[1]);
            let end = if number == TOLD { "; further ones are not told" } else { "" };
            self.tell(t, &format!("`{name}` hits at {speed:.6} m/s, {lost:.6} J are lost{end}"), observer);
        }
        let mut modes = system.modes.clone();
        let mut bounce = None;
        if rests {
            let state = look(&system, &mut self.work.problem, t, &self.y)[k].clone();
            modes[k] = if found.sticks { Mode::Rolling } else { self.touching(k, &state, 0.0) };
        } else if pull > 0.0 {
            bounce = Some(t + found.rebound / pull);
        }
        let inputs = self.work.model_inputs(self.model, t, &self.y);
        self.settle(t, modes, inputs, observer)?;
        self.contacts.soon = bounce;
        Ok(())
    }

    /// Goes over to the given modes, corrected until all forces and accelerations agree with them.
    pub(crate) fn settle(
        &mut self,
        t: f64,
        mut modes: Vec<Mode>,
        mut inputs: Vec<f64>,
        observer: &mut dyn Observer,
    ) -> Result<(), SolveError> {
        let before = self.work.system.modes.clone();
        for _ in 0..100 + 10 * modes.len() {
            let Some(form) = self.form(&modes, &inputs, t) else { return Ok(()) };
            let mut work = Work::new(form.system.clone(), self.method);
            let y = work.state_from(form.model, &inputs);
            self.contacts.aim(&mut work.problem);
            let states = look(&form.system, &mut work.problem, t, &y);
            if let Some(message) = work.unsolvable_friction(t, &y) {
                self.ending.status = Status::Failed(message);
                return Ok(());
            }
            let fastest = self.fastest();
            let correction =
                states.iter().enumerate().find_map(|(k, s)| Some((k, self.correct(k, modes[k], s, fastest)?)));
            if let Some((k, mode)) = correction {
                if modes[k] == Mode::Rolling {
                    // from no slip at all: what was left of an earlier slide would turn the new one
                    inputs = work.model_inputs(form.model, t, &y);
                }
                modes[k] = mode;
                continue;
            }
            let jump = velocity_jump(self.model, &inputs, &work.model_inputs(form.model, t, &y));
            if jump > JUMP * fastest.max(AT_REST) {
                self.ending.status = Status::Failed(format!(
                    "at t = {t} s velocities would have to jump by {jump:.3e} for the contacts to go on as {}, which \
                     wants an impulse that no impact gives",
                    modes.iter().map(|m| m.name()).collect::<Vec<_>>().join(", ")
                ));
                return Ok(());
            }
            self.tell_modes(t, &before, &modes, observer);
            let changed = !Rc::ptr_eq(&form.system, &self.work.system);
            self.y = y;
            self.model = form.model;
            self.equations = form.equations;
            if changed {
                self.explicit_again();
                self.use_system(form.system)?;
            }
            self.contacts.aim(&mut self.work.problem);
            return self.restart(t, observer);
        }
        let names: Vec<&str> = self.contacts.scene.contacts.iter().map(|c| c.name.as_str()).collect();
        self.ending.status = Status::Failed(format!(
            "at t = {t} s no combination of rolling, sliding and free agrees with its own forces (contacts: {})",
            names.join(", ")
        ));
        Ok(())
    }

    /// What a contact has to do instead, where its forces or accelerations contradict its mode.
    fn correct(&mut self, k: usize, mode: Mode, state: &ContactState, fastest: f64) -> Option<Mode> {
        let friction = self.contacts.scene.contacts[k].friction.as_ref();
        let size = length(state.force);
        let touches = state.gap[0].abs() <= 1e-8 && state.gap[1].abs() <= 1e-8 * fastest.max(1.0);
        match mode {
            Mode::Free if touches && state.gap[2] < -1e-12 && state.gap[1] <= 0.0 => {
                Some(self.touching(k, state, 1e-9 * fastest))
            }
            Mode::Free => None,
            _ if state.normal_force < -1e-13 * size => Some(Mode::Free),
            Mode::Rolling => {
                let across = state.across(state.force);
                let over = length(across) - state.limit * state.normal_force;
                if friction.is_none() || over <= 1e-12 * size {
                    return None;
                }
                self.contacts.begin_slide(k, unit(across).map(|x| -x), fastest);
                Some(Mode::Sliding)
            }
            Mode::Sliding => {
                // a slide that begins goes where it is accelerated to, which depends on where it goes
                let slide = self.contacts.slides[k];
                let begins = slide[3..].iter().any(|x| *x != 0.0) && length(state.across(state.slip)) < 1e-9 * fastest;
                let ahead = unit(state.across(state.slip_rate));
                let direction = [slide[0], slide[1], slide[2]];
                let turned = length([0, 1, 2].map(|i| ahead[i] - direction[i]));
                // where friction does not drop, it goes on as it was, and there is no acceleration yet
                let drops = state.kinetic < (1.0 - 1e-9) * state.limit;
                if !begins || !drops || ahead == [0.0; 3] || turned < 1e-9 || dot(ahead, direction) <= 0.0 {
                    return None;
                }
                self.contacts.begin_slide(k, ahead, fastest);
                Some(Mode::Sliding)
            }
        }
    }

    fn tell_modes(&mut self, t: f64, before: &[Mode], after: &[Mode], observer: &mut dyn Observer) {
        for k in (0..before.len()).filter(|&k| before[k] != after[k]) {
            let name = self.contacts.scene.contacts[k].name.clone();
            let message = if t == self.options.from {
                format!("`{name}` starts {}", after[k].name())
            } else {
                self.ending.mode_changes += 1;
                format!("`{name}`: {}, was {}", after[k].name(), before[k].name())
            };
            self.tell(t, &message, observer);
        }
    }

    /// Equations for the modes, with independent rates that suit the state; fetched where they are known.
    pub(crate) fn form(&mut self, modes: &[Mode], inputs: &[f64], t: f64) -> Option<Form<'m>> {
        if let Some(form) = self.known.iter().find(|f| f.system.modes == modes) {
            return Some(form.clone());
        }
        let model = self.contacts.model(modes);
        let clock = std::time::Instant::now();
        match derive_at(model, inputs, &self.options.derive) {
            Ok(equations) => {
                self.ending.derive_s += clock.elapsed().as_secs_f64();
                let clock = std::time::Instant::now();
                let system = Rc::new(System::new(model, &equations));
                self.ending.compile_s += clock.elapsed().as_secs_f64();
                let form = Form { model, equations, system };
                self.known.push(form.clone());
                Some(form)
            }
            Err(error) => {
                let what: Vec<&str> = modes.iter().map(|m| m.name()).collect();
                self.ending.status =
                    Status::Failed(format!("at t = {t} s no equations for contacts {}: {error}", what.join(", ")));
                None
            }
        }
    }

    /// Keeps the directions in which contacts slide up to date: what they are compared with at the end of a slide.
    pub(crate) fn aim_slides(&mut self, t: f64) {
        let system = self.work.system.clone();
        let slides: Vec<usize> = (0..system.modes.len()).filter(|&k| system.modes[k] == Mode::Sliding).collect();
        if slides.is_empty() {
            return;
        }
        let slips = self.work.slips(t, &self.y);
        for (k, slip) in slides.into_iter().zip(slips) {
            let slide = &mut self.contacts.slides[k];
            let moved = [0, 1, 2].map(|i| slip[i] + slide[3 + i]);
            let direction = unit(moved);
            if direction != [0.0; 3] {
                slide[..3].copy_from_slice(&direction);
            }
        }
        self.contacts.aim(&mut self.work.problem);
        if let Some(message) = self.work.unsolvable_friction(t, &self.y) {
            self.ending.status = Status::Failed(message);
        }
    }

    /// Whether a contact slides so slowly that friction turns with the least of errors: that looks stiff, but an implicit
    /// method, which lets errors of a tolerance be, loses the direction of the slip.
    pub(crate) fn begins_to_slide(&mut self, t: f64) -> bool {
        let small = 1e-3 * self.fastest();
        let dry = |k: usize| self.contacts.scene.contacts[k].friction.as_ref().is_some_and(|f| !f.viscous);
        let modes = &self.work.system.modes;
        let slides: Vec<bool> = (0..modes.len()).filter(|&k| modes[k] == Mode::Sliding).map(dry).collect();
        !slides.is_empty() && self.work.slips(t, &self.y).iter().zip(slides).any(|(s, dry)| dry && length(*s) < small)
    }

    fn fastest(&self) -> f64 {
        let system = &self.work.system;
        self.y[system.nq..].iter().fold(0.0_f64, |a, u| a.max(u.abs()))
    }
}

/// Largest difference of the velocities between two states.
fn velocity_jump(model: &Model, a: &[f64], b: &[f64]) -> f64 {
    let slots = velocity_inputs(model).into_iter().map(|(input, _)| model.input_index(input));
    slots.map(|i| (a[i] - b[i]).abs()).fold(0.0, f64::max)
}

fn moved(y: &[f64], nq: usize, impact: &Impact) -> Vec<f64> {
    let mut y = y.to_vec();
    y[nq..].iter_mut().zip(&impact.change).for_each(|(u, d)| *u += d);
    y
}

/// Why a method cannot run a scene with contacts.
pub(crate) fn refuse(scene: &Model, options: &RunOptions) -> Option<String> {
    let dae = options.method.starts_with("ida");
    (dae && !scene.contacts.is_empty()).then(|| {
        format!(
            "contacts that may slide or leave need a method that eliminates constraints, not `{}`: `auto`, `dop853`, `cvode-bdf`",
            options.method
        )
    })
}
