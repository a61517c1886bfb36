//! Energies and powers, for the balance that every run reports.

use headland_expr::{Expr, NodeId, Scalar};
use headland_model::{ElementKind, Model};

use crate::kinematics::Kinematics;
use crate::structures::Structures;

/// Energies and powers as nodes of the model's graph, over t, q, u and (for the drives) u′.
#[derive(Clone, Debug)]
pub struct Energies {
    /// Kinetic energy `½ Σ J d′²`.
    pub kinetic: NodeId,
    /// Energy of the elastic elements `½ Σ c d²`.
    pub potential: NodeId,
    /// Power of forces and dampers, by element: `P d′`.
    pub powers: Vec<(String, NodeId)>,
    /// Power of the drives that enforce prescribed motion; `None` where nothing is prescribed in the structures.
    ///
    /// ```text
    /// d′ = W u + w₀:   Σ J w₀ d″ − Σ w₀ P
    /// ```
    pub drives: Option<NodeId>,
}

/// Forms energies and powers.
pub fn form_energies(model: &Model, kinematics: &Kinematics, s: &Structures<'_>) -> Energies {
    let graph = &model.graph;
    let zero = Expr::Const(0.0);
    let half = Expr::Const(0.5);
    let (mut kinetic, mut potential) = (zero, zero);
    let mut powers = Vec::new();
    for e in 0..s.rate.len() {
        kinetic = kinetic + half * s.inertia[e] * s.rate[e].powi(2);
    }
    for &(a, b, entry) in &s.couplings {
        kinetic = kinetic + entry * (s.rate[a] * s.rate[b]);
    }
    for (e, element) in model.elements.iter().enumerate() {
        match element.kind {
            ElementKind::Inertia => {}
            ElementKind::Elastic => {
                potential = potential + half * graph.expr(element.value) * graph.expr(element.structure).powi(2);
            }
            _ => powers.push((element.name.clone(), graph.id(s.force[e] * s.rate[e]))),
        }
    }
    for body in &model.bodies {
        potential = potential + graph.expr(body.potential);
    }
    let first = s.rate.len() - 3 * model.loads.len();
    for (k, load) in model.loads.iter().enumerate() {
        if let Some(energy) = load.potential {
            potential = potential + graph.expr(energy);
            continue;
        }
        let power = (first + 3 * k..first + 3 * k + 3).fold(zero, |sum, e| sum + s.force[e] * s.rate[e]);
        powers.push((load.name.clone(), graph.id(power)));
    }
    let drives = drive_power(model, kinematics, s).map(|e| graph.id(e));
    Energies { kinetic: graph.id(kinetic), potential: graph.id(potential), powers, drives }
}

fn drive_power<'g>(model: &'g Model, kinematics: &Kinematics, s: &Structures<'g>) -> Option<Expr<'g>> {
    let graph = &model.graph;
    let u_inputs: Vec<usize> = kinematics.quasi.iter().map(|u| model.input_index(u.u)).collect();
    let nodes: Vec<NodeId> = s.rate.iter().map(|e| graph.id(*e)).collect();
    let at_rest = graph.substitute(&nodes, |i| u_inputs.contains(&i).then_some(Expr::Const(0.0)));
    if at_rest.iter().all(|e| e.is(0.0)) {
        return None;
    }
    let acceleration = |e: usize| {
        let terms = s.w[e].iter().zip(&kinematics.quasi).map(|(w, u)| *w * graph.expr(u.acceleration));
        terms.fold(s.bias[e], |sum, term| sum + term)
    };
    let mut power = Expr::Const(0.0);
    for (e, w0) in at_rest.iter().enumerate().filter(|(_, w0)| !w0.is(0.0)) {
        let inertial = if s.inertia[e].is(0.0) { s.inertia[e] } else { s.inertia[e] * acceleration(e) };
        power = power + *w0 * (inertial - s.force[e]);
    }
    for &(a, b, entry) in &s.couplings {
        power = power + entry * (at_rest[a] * acceleration(b) + at_rest[b] * acceleration(a));
    }
    Some(power)
}
