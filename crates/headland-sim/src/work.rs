//! [`Work`]: the evaluators of one system, and states moved between systems.

use std::rc::Rc;

use headland_code::{Evaluator, Function, TapeEvaluator};
use headland_dynamics::initial::{Moved, assemble, kinematic_matrices};
use headland_dynamics::kinematics::velocity_inputs;
use headland_dynamics::sample::first_not_finite;
use headland_dynamics::solve::solve_crout;
use headland_dynamics::{DeriveError, Equations, initial_velocities};
use headland_model::{Mode, Model};
use headland_solve::{Method, Options};

use crate::options::RunOptions;
use crate::system::{Problem, System};

/// Evaluators of one system.
pub(crate) struct Work {
    pub(crate) system: Rc<System>,
    pub(crate) problem: Problem,
    pub(crate) outputs: TapeEvaluator,
    pub(crate) residuals: TapeEvaluator,
    pub(crate) guards: TapeEvaluator,
    growth: TapeEvaluator,
    slides: TapeEvaluator,
    pivots: TapeEvaluator,
    energies: TapeEvaluator,
    pub(crate) has_residuals: bool,
}

impl Work {
    pub(crate) fn new(system: Rc<System>, method: Method) -> Self {
        Self {
            problem: Problem::new(system.clone(), method.is_implicit()),
            outputs: system.outputs.function.evaluator(),
            residuals: system.residuals.function.evaluator(),
            guards: system.guards.function.evaluator(),
            growth: system.growth.function.evaluator(),
            slides: system.slides.function.evaluator(),
            pivots: system.pivots.function.evaluator(),
            energies: system.energies.function.evaluator(),
            has_residuals: system.residuals.function.outputs() > 0,
            system,
        }
    }

    /// Kinetic energy, J.
    pub(crate) fn kinetic(&mut self, t: f64, y: &[f64]) -> f64 {
        self.energies.eval(self.problem.inputs_for(&self.system.energies, t, y))[0]
    }

    /// Largest scaled entry of G among the eliminated rates; 0 where nothing was chosen.
    pub(crate) fn growth(&mut self, t: f64, y: &[f64]) -> f64 {
        if self.system.growth.function.outputs() == 0 {
            return 0.0;
        }
        let x = self.problem.inputs_for(&self.system.growth, t, y);
        self.growth.eval(x).iter().fold(0.0, |a: f64, g| a.max(g.abs()))
    }

    /// Pivots of the elimination that depend on the state.
    pub(crate) fn pivots(&mut self, t: f64, y: &[f64]) -> &[f64] {
        if self.system.pivot_rows.is_empty() {
            return &[];
        }
        self.pivots.eval(self.problem.inputs_for(&self.system.pivots, t, y))
    }

    /// Slip velocities of the contacts that slide.
    pub(crate) fn slips(&mut self, t: f64, y: &[f64]) -> Vec<[f64; 3]> {
        let count = self.system.modes.iter().filter(|m| **m == Mode::Sliding).count();
        let x = self.problem.inputs_for(&self.system.slides, t, y);
        let out = self.slides.eval(x);
        (0..count).map(|k| [out[3 * k], out[3 * k + 1], out[3 * k + 2]]).collect()
    }

    /// A message where friction of sliding contacts and their normal forces have no single solution.
    pub(crate) fn unsolvable_friction(&mut self, t: f64, y: &[f64]) -> Option<String> {
        let count = self.system.modes.iter().filter(|m| **m == Mode::Sliding).count();
        let x = self.problem.inputs_for(&self.system.slides, t, y);
        let mut matrix = self.slides.eval(x).get(3 * count..)?.to_vec();
        let n = (matrix.len() as f64).sqrt() as usize;
        solve_crout(&mut matrix, &mut vec![0.0; n]);
        (0..n).any(|i| matrix[i * n + i] <= 0.0).then(|| {
            format!(
                "at t = {t} s sliding friction has no solution or more than one: the normal force grows with the friction \
                 that it causes (Painlevé's paradox)"
            )
        })
    }

    /// Largest residual among the constraints that were left out as redundant, beyond what those kept explain, with its
    /// position.
    pub(crate) fn redundant_residual(&mut self, t: f64, y: &[f64]) -> Option<(f64, usize)> {
        if self.system.redundant.is_empty() {
            return None;
        }
        let x = self.problem.inputs_for(&self.system.residuals, t, y);
        let values = self.residuals.eval(x);
        // with multipliers the others are off by a tolerance, and so is what follows from them
        let kept = values.iter().enumerate().filter(|(i, _)| !self.system.redundant.contains(i));
        let allowed = 100.0 * kept.fold(0.0, |a: f64, (_, r)| a.max(r.abs()));
        let left = self.system.redundant.iter().map(|&i| ((values[i].abs() - allowed).max(0.0), i));
        left.max_by(|a, b| a.0.total_cmp(&b.0))
    }

    /// The model's inputs at a state: parameters, time, coordinates, named quasi-velocities and all rates.
    pub(crate) fn model_inputs(&self, model: &Model, t: f64, y: &[f64]) -> Vec<f64> {
        let mut inputs = model.inputs();
        inputs[model.input_index(model.time)] = t;
        for (c, q) in model.coordinates.iter().zip(y) {
            inputs[model.input_index(c.q)] = *q;
        }
        let kinematics = &self.system.kinematics;
        for (u, value) in kinematics.quasi.iter().zip(&y[self.system.nq..]) {
            inputs[model.input_index(u.u)] = *value;
        }
        let (g, drift) = kinematic_matrices(model, kinematics, &inputs);
        for (v, (input, _)) in velocity_inputs(model).into_iter().enumerate() {
            let rate = drift[v] + (0..self.system.nu).map(|k| g[(v, k)] * y[self.system.nq + k]).sum::<f64>();
            inputs[model.input_index(input)] = rate;
        }
        inputs
    }

    /// The state that this system has at the given inputs of the model.
    pub(crate) fn state_from(&self, model: &Model, inputs: &[f64]) -> Vec<f64> {
        let q = model.coordinates.iter().map(|c| inputs[model.input_index(c.q)]);
        let u = self.system.kinematics.quasi.iter().map(|u| inputs[model.input_index(u.u)]);
        q.chain(u).collect()
    }

    /// Names the first definition or element that is not finite where the right-hand side was not.
    pub(crate) fn blame(&self, model: &Model, equations: &Equations) -> Option<String> {
        let (t, y) = self.problem.not_finite.as_ref()?;
        let inputs = self.model_inputs(model, *t, y);
        let found = first_not_finite(model, &equations.structure_rates, &inputs)?;
        Some(format!("{found} at t = {t} s"))
    }
}

/// The state at the start, and the given coordinates that were moved to fulfil the constraints.
pub(crate) fn start_state(
    model: &Model,
    equations: &Equations,
    from: f64,
) -> Result<(Vec<f64>, Vec<Moved>), DeriveError> {
    let (mut inputs, moved) = assemble(model)?;
    inputs[model.input_index(model.time)] = from;
    let q = model.coordinates.iter().map(|c| inputs[model.input_index(c.q)]);
    let u = initial_velocities(model, &equations.kinematics)?;
    Ok((q.chain(u).collect(), moved))
}

/// The state `[q, v]` of equations in which nothing is eliminated, from the state `[q, u]` of those in which it is.
pub(crate) fn all_velocities(
    model: &Model,
    eliminated: &Equations,
    free: &Equations,
    from: f64,
    y: &[f64],
) -> Vec<f64> {
    let nq = model.coordinates.len();
    let mut inputs = model.inputs();
    inputs[model.input_index(model.time)] = from;
    model.coordinates.iter().zip(y).for_each(|(c, q)| inputs[model.input_index(c.q)] = *q);
    let (g, drift) = kinematic_matrices(model, &eliminated.kinematics, &inputs);
    let velocity = |v: usize| drift[v] + (0..g.ncols()).map(|k| g[(v, k)] * y[nq + k]).sum::<f64>();
    y[..nq].iter().copied().chain(free.kinematics.quasi.iter().map(|u| velocity(u.velocity))).collect()
}

/// The state `[q, v]` with the velocities as they are given, zero where they are not: to be made consistent.
pub(crate) fn given_state(model: &Model, free: &Equations) -> Result<(Vec<f64>, Vec<Moved>), DeriveError> {
    let (inputs, moved) = assemble(model)?;
    let nq = model.coordinates.len();
    let given = |velocity: usize| match model.coordinates.get(velocity) {
        Some(c) => c.initial_rate.map_or(0.0, |node| model.graph.eval(&[node], &inputs)[0]),
        None => match model.quasi_velocities[velocity - nq].initial {
            Some(node) => model.graph.eval(&[node], &inputs)[0],
            None => inputs[model.input_index(model.quasi_velocities[velocity - nq].u)],
        },
    };
    let q = model.coordinates.iter().map(|c| inputs[model.input_index(c.q)]);
    let y = q.chain(free.kinematics.quasi.iter().map(|u| given(u.velocity))).collect();
    Ok((y, moved))
}

/// Tolerances by the states' scales.
pub(crate) fn solver_options(model: &Model, system: &System, options: &RunOptions) -> Options {
    let coordinates = model.coordinates.iter().map(|c| c.scale);
    let scales = coordinates.chain(system.kinematics.quasi.iter().map(|u| u.scale));
    let mut solver = Options::new(options.tolerance, scales.map(|s| s * options.tolerance).collect());
    solver.max_steps = options.max_steps;
    solver.h_max = options.max_step;
    solver.event_samples = 9; // places inside a step at which events and guards are looked at
    solver
}
