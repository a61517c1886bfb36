//! Algorithm [9], combine: the equations in all velocities v, then their linear combination with G, equation (8).
//!
//! ```text
//! H = Σ W′ᵀ J W′,   h = Σ W′ᵀ (J bias′ − P)            W′ = ∂d′/∂v, bias′ = d″ at v′ = 0
//! M = Gᵀ H G,       F = −Gᵀ (h + H (G′ u + g′))        v = G u + g
//! ```
//! v are the rates of the coordinates and the velocities of joints.

use headland_expr::{Expr, NodeId};
use headland_model::{ElementKind, KinematicRow, Model, RowForm, StructureForm};

use crate::direct::MassForm;
use crate::kinematics::{Kinematics, velocity_inputs};
use crate::solve::packed;
use crate::structures::{Flow, Structures, raw_rates};

/// Most velocities for which the full matrix H is formed.
pub const MOST_VELOCITIES: usize = 24;

/// Why algorithm [9] does not apply to a model, if it does not.
pub fn does_not_apply(model: &Model) -> Option<String> {
    let explicit = model.elements.iter().find(|e| e.form == StructureForm::Explicit);
    if let Some(e) = explicit {
        return Some(format!("the structure of `{}` is given by quasi-velocities, not by q or q'", e.name));
    }
    let free = model.quasi_velocities.iter().find(|u| !u.of_joint);
    if let Some(u) = free.filter(|_| !model.bodies.is_empty()) {
        return Some(format!("bodies move by `{}`, which is neither a rate nor a joint's velocity", u.name));
    }
    let s = columns(model).len();
    (s > MOST_VELOCITIES).then(|| {
        format!("{s} velocities are more than {MOST_VELOCITIES}: its full matrix would cost more than it tells")
    })
}

/// Velocities on which structures depend: positions, inputs and inputs of their rates.
fn columns(model: &Model) -> Vec<(usize, NodeId, NodeId)> {
    let nq = model.coordinates.len();
    // the rates of a joint's quaternion follow from its angular velocity; nothing depends on them
    let given = |v: usize| v < nq && model.coordinates[v].guess.is_some() && is_given(model, v);
    let all = velocity_inputs(model).into_iter().enumerate();
    all.filter(|(v, _)| !given(*v) && (*v < nq || model.quasi_velocities[v - nq].of_joint))
        .map(|(v, (input, rate))| (v, input, rate))
        .collect()
}

fn is_given(model: &Model, coordinate: usize) -> bool {
    let gives = |r: &KinematicRow| matches!(r.form, RowForm::Rate(i, _) if i == coordinate);
    model.kinematics.iter().any(gives)
}

/// The equations by algorithm [9]; the caller asks [`does_not_apply`] first.
pub fn derive_combined<'g>(model: &'g Model, kinematics: &Kinematics, s: &Structures<'g>) -> MassForm<'g> {
    let graph = &model.graph;
    let columns = columns(model);
    let (nv, nu) = (columns.len(), kinematics.quasi.len());
    let zero = Expr::Const(0.0);
    let (w, bias) = by_velocities(model, kinematics, &columns);

    // Equations in v
    let mut h_matrix = vec![zero; nv * (nv + 1) / 2];
    let mut h = vec![zero; nv];
    for e in 0..w.len() {
        let p = s.inertia[e] * bias[e] - s.force[e];
        for i in (0..nv).filter(|&i| !w[e][i].is(0.0)) {
            h[i] = h[i] + w[e][i] * p;
            for j in 0..=i {
                h_matrix[packed(i, j)] = h_matrix[packed(i, j)] + s.inertia[e] * w[e][i] * w[e][j];
            }
        }
    }
    for &(a, b, entry) in &s.couplings {
        for (a, b) in [(a, b), (b, a)] {
            for i in 0..nv {
                h[i] = h[i] + w[a][i] * (entry * bias[b]);
                for j in 0..=i {
                    h_matrix[packed(i, j)] = h_matrix[packed(i, j)] + entry * w[a][i] * w[b][j];
                }
            }
        }
    }
    let entry = |i: usize, j: usize| h_matrix[packed(i.max(j), i.min(j))];

    // Their combination
    let solved: Vec<NodeId> = columns.iter().map(|(v, ..)| kinematics.velocities[*v]).collect();
    let drift: Vec<Expr<'g>> = columns.iter().map(|(v, ..)| graph.expr(kinematics.drift[*v])).collect();
    let mut g = vec![vec![zero; nu]; nv];
    for (k, u) in kinematics.quasi.iter().enumerate() {
        let input = model.input_index(u.u);
        for (i, e) in graph.tangent(&solved, |i| (i == input).then_some(Expr::Const(1.0))).into_iter().enumerate() {
            g[i][k] = e;
        }
    }
    let sum = |terms: &mut dyn Iterator<Item = Expr<'g>>| terms.fold(zero, |a, b| a + b);
    let residual: Vec<Expr<'g>> = (0..nv).map(|i| h[i] + sum(&mut (0..nv).map(|j| entry(i, j) * drift[j]))).collect();
    let hg: Vec<Vec<Expr<'g>>> =
        (0..nv).map(|i| (0..nu).map(|k| sum(&mut (0..nv).map(|j| entry(i, j) * g[j][k]))).collect()).collect();
    let mut m = vec![zero; nu * (nu + 1) / 2];
    for k in 0..nu {
        for l in 0..=k {
            m[packed(k, l)] = sum(&mut (0..nv).map(|i| g[i][k] * hg[i][l]));
        }
    }
    let f = (0..nu).map(|k| -sum(&mut (0..nv).map(|i| g[i][k] * residual[i]))).collect();
    MassForm { m, f }
}

/// `W′` and `bias′` of all rows.
#[allow(clippy::type_complexity)]
fn by_velocities<'g>(
    model: &'g Model,
    kinematics: &Kinematics,
    columns: &[(usize, NodeId, NodeId)],
) -> (Vec<Vec<Expr<'g>>>, Vec<Expr<'g>>) {
    let graph = &model.graph;
    let flow = Flow::new(model, kinematics);
    let mut seeds = vec![None; graph.input_count()];
    seeds[model.input_index(model.time)] = Some(Expr::Const(1.0));
    for c in &model.coordinates {
        seeds[model.input_index(c.q)] = Some(graph.expr(c.rate));
    }
    let rate = raw_by_velocities(model);
    let inputs: Vec<NodeId> = columns.iter().map(|(_, input, _)| *input).collect();
    let w = rows_by_velocities(model, &inputs);
    // d″ at v′ = 0: given for bodies whose axes turn, else the rate's derivative
    let mut at_rest = vec![false; graph.input_count()];
    for (_, rate) in velocity_inputs(model) {
        at_rest[model.input_index(rate)] = true;
    }
    let mut second: Vec<NodeId> = graph.tangent(&rate, |i| seeds[i]).into_iter().map(|e| graph.id(e)).collect();
    for (b, body) in model.bodies.iter().enumerate() {
        for (half, structure) in [body.velocity, body.spin].into_iter().enumerate() {
            if let Some(nodes) = structure.acceleration {
                let first = model.elements.len() + 6 * b + 3 * half;
                let nodes = graph.substitute(&nodes, |i| at_rest[i].then_some(Expr::Const(0.0)));
                second.splice(first..first + 3, nodes.into_iter().map(|e| graph.id(e)));
            }
        }
    }
    let inertial = |e: usize| match model.elements.get(e) {
        Some(element) => element.kind == ElementKind::Inertia,
        None => e < model.elements.len() + 6 * model.bodies.len(),
    };
    for e in (0..second.len()).filter(|e| !inertial(*e)) {
        second[e] = graph.id(Expr::Const(0.0));
    }
    (w, flow.substitute_rates(&second))
}

/// The structures' rates by q and velocities, the rates of joints' quaternions put in.
fn raw_by_velocities(model: &Model) -> Vec<NodeId> {
    let graph = &model.graph;
    let mut seeds = vec![None; graph.input_count()];
    seeds[model.input_index(model.time)] = Some(Expr::Const(1.0));
    for c in &model.coordinates {
        seeds[model.input_index(c.q)] = Some(graph.expr(c.rate));
    }
    let rate = raw_rates(model, |nodes| graph.tangent(nodes, |i| seeds[i]));
    let mut of_joints = vec![None; graph.input_count()];
    for row in &model.kinematics {
        if let RowForm::Rate(i, node) = row.form
            && model.coordinates[i].guess.is_some()
        {
            of_joints[model.input_index(model.coordinates[i].rate)] = Some(graph.expr(node));
        }
    }
    graph.substitute(&rate, |i| of_joints[i]).into_iter().map(|e| graph.id(e)).collect()
}

/// `W′`: one row a structure, one column a velocity, given by its input.
pub(crate) fn rows_by_velocities<'g>(model: &'g Model, inputs: &[NodeId]) -> Vec<Vec<Expr<'g>>> {
    let graph = &model.graph;
    let rate = raw_by_velocities(model);
    let mut w = vec![vec![Expr::Const(0.0); inputs.len()]; rate.len()];
    for (e, j, entry) in graph.jacobian(&rate, inputs) {
        w[e][j] = entry;
    }
    w
}
