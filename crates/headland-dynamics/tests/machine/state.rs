//! States of a machine's model: places that fulfil the constraints, any velocities, what the equations say there.

use std::collections::HashMap;

use headland_dynamics::initial::assemble;
use headland_dynamics::kinematics::velocity_name;
use headland_dynamics::{DeriveOptions, Equations, derive};
use headland_expr::NodeId;
use headland_model::{Model, Scene};
use headland_spatial::{Pose, Rotation, Vector};

use super::{Machine, Random, Style};

/// A machine's model with its equations.
pub struct Derived {
    pub model: Model,
    /// Before anything was derived, for other places.
    plain: Model,
    pub equations: Equations,
    outputs: Vec<NodeId>,
    pub names: Vec<String>,
}

/// How a body moves.
#[derive(Clone, Copy, Debug)]
pub struct Moving {
    pub pose: Pose<f64>,
    /// Angular velocity, axes of the body.
    pub w: Vector<f64>,
    /// Of the origin, axes of the world.
    pub v: Vector<f64>,
    pub w_rate: Vector<f64>,
    pub a: Vector<f64>,
}

/// What the equations say at a state.
pub struct Moment {
    pub t: f64,
    pub bodies: Vec<Moving>,
    /// Outputs by name.
    pub of: HashMap<String, f64>,
    /// Coordinates with first and second rates by name.
    pub q: HashMap<String, [f64; 3]>,
}

pub fn read(text: &str) -> Scene {
    Scene::parse("machine.toml", text).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

impl Derived {
    pub fn new(machine: &Machine, style: &Style) -> Self {
        Self::with(machine, style, &DeriveOptions::default())
    }

    pub fn with(machine: &Machine, style: &Style, options: &DeriveOptions) -> Self {
        let text = machine.text(style);
        let model = read(&text).build().unwrap_or_else(|e| panic!("{e}\n{text}"));
        let plain = model.clone();
        let equations = derive(&model, options).unwrap_or_else(|e| panic!("{}: {e}", machine.title));
        let nodes: Vec<NodeId> = model.outputs.iter().map(|o| o.node).collect();
        let outputs = equations.by_state(&model, &nodes);
        Self { plain, outputs, names: machine.columns(), model, equations }
    }

    /// Inputs at a state near the start whose coordinates fulfil the constraints; velocities as the constraints let them.
    pub fn state(&self, r: &mut Random, size: f64) -> Vec<f64> {
        let mut model = self.plain.clone();
        for _ in 0..20 {
            for (c, own) in model.coordinates.iter_mut().zip(&self.plain.coordinates) {
                c.guess = Some(own.guess.unwrap_or(0.0) + size * r.number());
                c.initial = None;
            }
            model.run.from = 2.0 * r.number();
            let Ok((mut x, _)) = assemble(&model) else { continue };
            let m = &self.model;
            for u in &self.equations.kinematics.quasi {
                x[m.input_index(u.u)] = r.number();
            }
            return x;
        }
        panic!("{}: no state found", self.model.title);
    }

    /// All coordinates and velocities by name.
    pub fn values(&self, x: &[f64]) -> HashMap<String, f64> {
        let m = &self.model;
        let velocities = m.graph.eval(&self.equations.kinematics.velocities, x);
        let named = velocities.into_iter().enumerate().map(|(v, value)| (velocity_name(m, v), value));
        let places = m.coordinates.iter().map(|c| (c.name.clone(), x[m.input_index(c.q)]));
        named.chain(places).chain([("t".to_string(), x[m.input_index(m.time)])]).collect()
    }

    /// Inputs at coordinates and velocities of another model's state.
    pub fn put(&self, values: &HashMap<String, f64>) -> Vec<f64> {
        let m = &self.model;
        let mut x = headland_dynamics::sample::start_inputs(m);
        x[m.input_index(m.time)] = values["t"];
        for c in &m.coordinates {
            x[m.input_index(c.q)] = values[&c.name];
        }
        for u in &self.equations.kinematics.quasi {
            x[m.input_index(u.u)] = values[&u.name];
        }
        x
    }

    /// Writes rates, accelerations and second rates; gives what the outputs are.
    pub fn moment(&self, x: &mut [f64]) -> Moment {
        let (model, e) = (&self.model, &self.equations);
        for (c, rate) in model.coordinates.iter().zip(model.graph.eval(&e.kinematics.rates, x)) {
            x[model.input_index(c.rate)] = rate;
        }
        let a = match &e.accelerations {
            Some(a) => model.graph.eval(a, x),
            None => {
                let (mut m, mut f) = (model.graph.eval(&e.mass, x), model.graph.eval(&e.force, x));
                headland_dynamics::solve::solve_ldl(&mut m, &mut f);
                f
            }
        };
        for (u, a) in e.kinematics.quasi.iter().zip(&a) {
            x[model.input_index(u.acceleration)] = *a;
        }
        let drift = model.graph.eval(&e.kinematics.drift, x);
        for (i, c) in model.coordinates.iter().enumerate() {
            let g = model.graph.eval(&e.g[i], x);
            x[model.input_index(c.acceleration)] = drift[i] + g.iter().zip(&a).map(|(g, a)| g * a).sum::<f64>();
        }
        let values = model.graph.eval(&self.outputs, x);
        let bodies = values.chunks(24).take_while(|c| c.len() == 24);
        let count = self.names.iter().filter(|n| n.ends_with(".exx")).count();
        let bodies = bodies.take(count).map(|c| {
            let v = |i: usize| Vector([c[i], c[i + 1], c[i + 2]]);
            let rotation = Rotation([v(3).0, v(6).0, v(9).0]);
            Moving { pose: Pose::new(rotation, v(0)), w: v(12), v: v(15), w_rate: v(18), a: v(21) }
        });
        let q = model.coordinates.iter().map(|c| {
            let at = |n| x[model.input_index(n)];
            (c.name.clone(), [at(c.q), at(c.rate), at(c.acceleration)])
        });
        Moment {
            t: x[model.input_index(model.time)],
            bodies: bodies.collect(),
            q: q.collect(),
            of: self.names.iter().cloned().zip(values.iter().copied()).collect(),
        }
    }
}
