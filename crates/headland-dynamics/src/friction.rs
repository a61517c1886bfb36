//! The normal forces of contacts that slide: friction depends on them, and they on friction.
//!
//! Accelerations and the multipliers λ of the gaps are affine in the normal forces N:
//!
//! ```text
//! u′ = M⁻¹ F(N),    N = λ(u′(N), N) = a + C N,    (1 − C) N = a
//! ```
//! With one contact and friction μ, `1 − C = (A_nn − μ A_ns)/A_nn`, A the inverse inertia at the contact: where it is not
//! positive, no motion or more than one is possible (Painlevé 1895). The program watches the determinant.

use headland_expr::{Expr, NodeId};
use headland_model::{Derived, Mode, Model};

use crate::derive::Equations;
use crate::solve::solve_crout;

/// Puts the normal forces of sliding contacts into the equations. Accelerations must be unrolled.
pub(crate) fn close_friction(model: &Model, equations: &mut Equations) {
    let graph = &model.graph;
    let sliding: Vec<(usize, NodeId)> = (0..model.contacts.len())
        .filter(|k| model.contacts[*k].mode == Mode::Sliding)
        .filter_map(|k| Some((k, model.contacts[k].friction.as_ref()?.normal_force)))
        .collect();
    if sliding.is_empty() {
        return;
    }
    let slots: Vec<usize> = sliding.iter().map(|(_, input)| model.input_index(*input)).collect();
    let n = sliding.len();
    let mut replaced: Vec<Option<Expr<'_>>> = vec![None; graph.input_count()];
    let accelerations = equations.accelerations.clone().unwrap_or_default();
    for (u, a) in equations.kinematics.quasi.iter().zip(&accelerations) {
        replaced[model.input_index(u.acceleration)] = Some(graph.expr(*a));
    }
    let normal = |contact: usize| {
        let position = model.derived.iter().position(|d| matches!(d.what, Derived::Contact(k, None) if k == contact));
        position.map_or(graph.id(Expr::Const(0.0)), |p| equations.derived[p])
    };
    let normals: Vec<NodeId> = sliding.iter().map(|(k, _)| normal(*k)).collect();
    let normals: Vec<NodeId> = graph.substitute(&normals, |i| replaced[i]).into_iter().map(|e| graph.id(e)).collect();

    let is_normal = |i: usize| slots.contains(&i).then_some(Expr::Const(0.0));
    let mut solution = graph.substitute(&normals, is_normal);
    let mut matrix = vec![Expr::Const(0.0); n * n];
    for (j, slot) in slots.iter().enumerate() {
        let column = graph.tangent(&normals, |i| (i == *slot).then_some(Expr::Const(1.0)));
        for (i, entry) in column.into_iter().enumerate() {
            let own = Expr::Const(if i == j { 1.0 } else { 0.0 });
            matrix[i * n + j] = own - entry;
        }
    }
    // affine: what is left of N in the slopes is nothing but rounding of the form
    let ids: Vec<NodeId> = matrix.iter().map(|e| graph.id(*e)).collect();
    let mut matrix = graph.substitute(&ids, is_normal);
    equations.friction_pivots = if n == 1 { vec![graph.id(matrix[0])] } else { ids };
    solve_crout(&mut matrix, &mut solution);

    let put = |nodes: &[NodeId]| -> Vec<NodeId> {
        let found = graph.substitute(nodes, |i| slots.iter().position(|s| *s == i).map(|k| solution[k]));
        found.into_iter().map(|e| graph.id(e)).collect()
    };
    equations.accelerations = Some(put(&accelerations));
    equations.force = put(&equations.force);
    equations.joint_forces = None; // the recursions do not know friction that depends on reactions
    equations.derived = put(&equations.derived);
    let (names, powers): (Vec<String>, Vec<NodeId>) = equations.energies.powers.drain(..).unzip();
    equations.energies.powers = names.into_iter().zip(put(&powers)).collect();
    equations.energies.drives = equations.energies.drives.map(|e| put(&[e])[0]);
}
