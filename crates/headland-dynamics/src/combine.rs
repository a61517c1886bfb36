//! Algorithm [9], combine: the holonomic equations in q, then their linear combination with G, equation (8).
//!
//! ```text
//! H = Σ J W′ᵀ W′,   h = Σ J W′ᵀ bias′ − Σ W′ᵀ P        W′ = ∂d′/∂q′, bias′ = d″ at q″ = 0
//! M = Gᵀ H G,       F = −Gᵀ (h + H (G′ u + g′))
//! ```

use headland_expr::{Expr, NodeId};
use headland_model::{Model, StructureForm};

use crate::direct::MassForm;
use crate::kinematics::Kinematics;
use crate::solve::packed;
use crate::structures::{Flow, Structures};

/// Most coordinates for which the full matrix H is formed.
pub const MOST_COORDINATES: usize = 24;

/// Why algorithm [9] does not apply to a model, if it does not.
pub fn does_not_apply(model: &Model) -> Option<String> {
    let explicit = model.elements.iter().find(|e| e.form == StructureForm::Explicit);
    if let Some(e) = explicit {
        return Some(format!("the structure of `{}` is given by quasi-velocities, not by q or q'", e.name));
    }
    let s = model.coordinates.len();
    (s > MOST_COORDINATES).then(|| {
        format!("{s} coordinates are more than {MOST_COORDINATES}: its full matrix would cost more than it tells")
    })
}

/// The equations by algorithm [9]; the caller asks [`does_not_apply`] first.
pub fn derive_combined<'g>(model: &'g Model, kinematics: &Kinematics, s: &Structures<'g>) -> MassForm<'g> {
    let graph = &model.graph;
    let (nq, nu) = (model.coordinates.len(), kinematics.quasi.len());
    let zero = Expr::Const(0.0);
    let flow = Flow::new(model, kinematics);

    // Structures by q and q′ alone
    let time = model.input_index(model.time);
    let mut seeds = vec![None; graph.input_count()];
    seeds[time] = Some(Expr::Const(1.0));
    for c in &model.coordinates {
        seeds[model.input_index(c.q)] = Some(graph.expr(c.rate));
    }
    let given: Vec<NodeId> = model.elements.iter().map(|e| e.structure).collect();
    let differentiated = graph.tangent(&given, |i| seeds[i]);
    let rate: Vec<NodeId> = model
        .elements
        .iter()
        .zip(&differentiated)
        .map(|(e, d)| if e.form == StructureForm::Geometric { graph.id(*d) } else { e.structure })
        .collect();
    let bias =
        flow.substitute_rates(&graph.tangent(&rate, |i| seeds[i]).into_iter().map(|e| graph.id(e)).collect::<Vec<_>>());
    let rate_inputs: Vec<NodeId> = model.coordinates.iter().map(|c| c.rate).collect();
    let mut w = vec![vec![zero; nq]; model.elements.len()];
    for (e, j, entry) in graph.jacobian(&rate, &rate_inputs) {
        w[e][j] = entry;
    }

    // Holonomic equations
    let mut h_matrix = vec![zero; nq * (nq + 1) / 2];
    let mut h = vec![zero; nq];
    for e in 0..model.elements.len() {
        let p = s.inertia[e] * bias[e] - s.force[e];
        for i in 0..nq {
            h[i] = h[i] + w[e][i] * p;
            for j in 0..=i {
                h_matrix[packed(i, j)] = h_matrix[packed(i, j)] + s.inertia[e] * w[e][i] * w[e][j];
            }
        }
    }
    let entry = |i: usize, j: usize| h_matrix[packed(i.max(j), i.min(j))];

    // Their combination
    let drift = flow.rate_of(&kinematics.rates); // G′ u + g′
    let mut g = vec![vec![zero; nu]; nq];
    for (k, u) in kinematics.quasi.iter().enumerate() {
        let input = model.input_index(u.u);
        for (i, e) in
            graph.tangent(&kinematics.rates, |i| (i == input).then_some(Expr::Const(1.0))).into_iter().enumerate()
        {
            g[i][k] = e;
        }
    }
    let sum = |terms: &mut dyn Iterator<Item = Expr<'g>>| terms.fold(zero, |a, b| a + b);
    let residual: Vec<Expr<'g>> = (0..nq).map(|i| h[i] + sum(&mut (0..nq).map(|j| entry(i, j) * drift[j]))).collect();
    let hg: Vec<Vec<Expr<'g>>> =
        (0..nq).map(|i| (0..nu).map(|k| sum(&mut (0..nq).map(|j| entry(i, j) * g[j][k]))).collect()).collect();
    let mut m = vec![zero; nu * (nu + 1) / 2];
    for k in 0..nu {
        for l in 0..=k {
            m[packed(k, l)] = sum(&mut (0..nq).map(|i| g[i][k] * hg[i][l]));
        }
    }
    let f = (0..nu).map(|k| -sum(&mut (0..nq).map(|i| g[i][k] * residual[i]))).collect();
    MassForm { m, f }
}
