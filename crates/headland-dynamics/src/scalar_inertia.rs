//! Where a scalar inertia element on a speed gives right equations, and where it is refused.
//!
//! With `T = ½ m ω(q′)²` for a one-form ω, Lagrange's equations have, beside `m d″ ω`, the term `m d′ dω(q′, ·)`. The
//! scalar form `W m d″` is right exactly when that term acts on nothing: when ω is closed (`d′` is the rate of some
//! coordinate), or when one quasi-velocity is left and `d′ = W u` (both arguments of dω are then the same direction).
//! Closedness is tested by numbers: `D_a ω(b) = D_b ω(a)` for directions a, b in the space of (t, q), exact derivatives.

use headland_expr::{Dual, Expr, NodeId};
use headland_model::{ElementKind, Model, StructureForm};

use crate::error::DeriveError;
use crate::kinematics::Kinematics;
use crate::sample::{Spread, spread_inputs};
use crate::structures::Structures;

/// Refuses inertia elements whose equation would silently lose a term.
///
/// # Errors
/// [`DeriveError::ScalarInertia`] names the first one.
pub fn check_scalar_inertia(model: &Model, kinematics: &Kinematics, s: &Structures<'_>) -> Result<(), DeriveError> {
    let homogeneous = are_homogeneous(model, kinematics, s);
    let suspects: Vec<usize> = (0..model.elements.len())
        .filter(|&e| model.elements[e].kind == ElementKind::Inertia)
        .filter(|&e| model.elements[e].form != StructureForm::Geometric)
        .filter(|&e| !(kinematics.quasi.len() == 1 && homogeneous[e]))
        .collect();
    if suspects.is_empty() {
        return Ok(());
    }
    let forms = as_forms(model, kinematics, &suspects);
    let closed = are_closed(model, &forms);
    for (k, &e) in suspects.iter().enumerate() {
        if forms[k].is_none() || !closed[k] {
            let quasi: Vec<&str> = kinematics.quasi.iter().map(|u| u.name.as_str()).collect();
            return Err(DeriveError::ScalarInertia {
                name: model.elements[e].name.clone(),
                count: quasi.len(),
                quasi: quasi.join(", "),
            });
        }
    }
    Ok(())
}

/// For each element, whether `d′ = W u` without a part that is there at `u = 0`.
fn are_homogeneous(model: &Model, kinematics: &Kinematics, s: &Structures<'_>) -> Vec<bool> {
    let quasi: Vec<usize> = kinematics.quasi.iter().map(|u| model.input_index(u.u)).collect();
    let nodes: Vec<NodeId> = s.rate.iter().map(|e| model.graph.id(*e)).collect();
    let at_rest = model.graph.substitute(&nodes, |i| quasi.contains(&i).then_some(Expr::Const(0.0)));
    at_rest.into_iter().map(|e| e.is(0.0)).collect()
}

/// Structures `d′(q, q′, t)`; an explicit one is turned over where each of its quasi-velocities is the rate of a coordinate.
fn as_forms(model: &Model, kinematics: &Kinematics, suspects: &[usize]) -> Vec<Option<NodeId>> {
    let graph = &model.graph;
    let rate_for = |input: usize| {
        let node = graph.input_id(input);
        kinematics.rates.iter().position(|r| *r == node).map(|i| graph.expr(model.coordinates[i].rate))
    };
    let quasi: Vec<usize> = kinematics.quasi.iter().map(|u| model.input_index(u.u)).collect();
    let nodes: Vec<NodeId> = suspects.iter().map(|&e| model.elements[e].structure).collect();
    let forms = graph.substitute(&nodes, |i| if quasi.contains(&i) { rate_for(i) } else { None });
    let named: Vec<usize> = model.quasi_velocities.iter().map(|u| model.input_index(u.u)).collect();
    let nodes: Vec<NodeId> = forms.into_iter().map(|e| graph.id(e)).collect();
    let left = graph.depends(&nodes, |i| named.contains(&i));
    nodes.into_iter().zip(left).map(|(n, left)| (!left).then_some(n)).collect()
}

/// Whether each form is linear in the rates and closed, at a few states.
fn are_closed(model: &Model, forms: &[Option<NodeId>]) -> Vec<bool> {
    let nodes: Vec<NodeId> = forms.iter().flatten().copied().collect();
    let mut good = vec![false; nodes.len()];
    let mut bad = vec![false; nodes.len()];
    for k in 0..6 {
        let inputs = spread_inputs(model, k);
        let mut spread = Spread::new(100 + k);
        let a: Vec<f64> = model.coordinates.iter().map(|_| spread.next_number()).collect();
        let b: Vec<f64> = model.coordinates.iter().map(|_| spread.next_number()).collect();
        let sum: Vec<f64> = a.iter().zip(&b).map(|(a, b)| a + b).collect();
        // ω(b) along a, and ω(a) along b; the time moves with rate 1 along both
        let along = |direction: &[f64], velocity: &[f64]| {
            let mut x: Vec<Dual<f64>> = inputs.iter().map(|v| Dual::new(*v, 0.0)).collect();
            x[model.input_index(model.time)].dot = 1.0;
            for (i, c) in model.coordinates.iter().enumerate() {
                x[model.input_index(c.q)].dot = direction[i];
                x[model.input_index(c.rate)] = Dual::new(velocity[i], 0.0);
            }
            model.graph.eval(&nodes, &x)
        };
        let zero = vec![0.0; a.len()];
        let (ab, ba) = (along(&a, &b), along(&b, &a));
        let (at_sum, at_zero) = (along(&zero, &sum), along(&zero, &zero));
        for i in 0..nodes.len() {
            let close = |x: f64, y: f64, size: f64| (x - y).abs() <= 1e-9 * size.max(1e-300);
            let size = ab[i].dot.abs() + ba[i].dot.abs() + ab[i].value.abs() + ba[i].value.abs();
            if !size.is_finite() || !at_sum[i].value.is_finite() {
                continue; // outside the domain of the structure: another state tells
            }
            let linear =
                close(at_sum[i].value + at_zero[i].value, ab[i].value + ba[i].value, size + at_sum[i].value.abs());
            if linear && close(ab[i].dot, ba[i].dot, size) {
                good[i] = true;
            } else {
                bad[i] = true;
            }
        }
    }
    let mut result = good.into_iter().zip(bad).map(|(good, bad)| good && !bad);
    forms.iter().map(|f| f.is_some() && result.next().unwrap_or(false)).collect()
}
