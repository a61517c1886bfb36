//! What the equations leave out: forces of constraints and joints, and energies and powers by name.
//!
//! An expression of the scene uses them as inputs ([`Model::derived`]); here they are put in. With all velocities v, not
//! only the independent ones, the constraints `A v + a = 0` act by their multipliers:
//!
//! ```text
//! Σ W′ᵀ (J d″ − P) = Aᵀ λ         W′ = ∂d′/∂v
//! ```
//! The columns that elimination made dependent give as many equations as there are independent rows. A row left out as
//! redundant carries nothing. The force in a joint is the same sum for a velocity that the joint forbids.

use headland_expr::{Expr, NodeId};
use headland_model::{Contact, Derived, Mode, Model};

use crate::combine::rows_by_velocities;
use crate::energy::Energies;
use crate::kinematics::{Kinematics, velocity_inputs};
use crate::structures::{Flow, Structures};

/// The values of [`Model::derived`] by t, q, u and u′, in its order.
pub fn form_derived(model: &Model, kinematics: &Kinematics, s: &Structures<'_>, energies: &Energies) -> Vec<NodeId> {
    if model.derived.is_empty() {
        return Vec::new();
    }
    let graph = &model.graph;
    let balance = row_balances(kinematics, model, s);
    let needs = |d: &Derived| matches!(d, Derived::Multiplier(_) | Derived::Reaction(_) | Derived::Contact(..));
    let multipliers = if model.derived.iter().any(|d| needs(&d.what)) {
        multipliers(model, kinematics, &balance)
    } else {
        Vec::new()
    };
    let zero = graph.id(Expr::Const(0.0));
    let power = |name: &str| energies.powers.iter().find(|(n, _)| n == name).map_or(zero, |(_, node)| *node);
    let value = |what: &Derived| match what {
        Derived::Multiplier(row) => multipliers.get(*row).map_or(zero, |e| graph.id(*e)),
        Derived::Kinetic => energies.kinetic,
        Derived::Potential => energies.potential,
        Derived::Power(name) => power(name),
        Derived::Mode(k) => graph.id(Expr::Const(f64::from(model.contacts[*k].mode as u8))),
        Derived::Contact(k, axis) => {
            let contact = &model.contacts[*k];
            let slides = contact.mode == Mode::Sliding;
            if let (None, true, Some(row)) = (axis, slides, contact.gap_row) {
                return multipliers.get(row).map_or(zero, |e| graph.id(*e)); // friction is across the normal
            }
            let force = contact_force(model, kinematics, contact, &multipliers);
            let normal = contact.normal.map(|n| graph.expr(n));
            graph.id(match axis {
                Some(i) => force[*i],
                None => (0..3).fold(Expr::Const(0.0), |sum, i| sum + normal[i] * force[i]),
            })
        }
        Derived::Reaction(reaction) => {
            let own = reaction.rows.iter().map(|(row, w)| graph.expr(*w) * balance[*row]);
            let loops = reaction
                .constraints
                .iter()
                .filter_map(|(row, a)| multipliers.get(*row).map(|lambda| -(graph.expr(*a) * *lambda)));
            graph.id(own.chain(loops).fold(Expr::Const(0.0), |sum, e| sum + e))
        }
    };
    model.derived.iter().map(|d| value(&d.what)).collect()
}

/// The force of a hard contact along the axes of its surface: multipliers of what holds, and friction while it slides.
fn contact_force<'g>(
    model: &'g Model,
    kinematics: &Kinematics,
    contact: &Contact,
    multipliers: &[Expr<'g>],
) -> [Expr<'g>; 3] {
    let graph = &model.graph;
    let lambda = |row: usize| multipliers.get(row).copied().unwrap_or(Expr::Const(0.0));
    let pressing = contact.gap_row.map_or(Expr::Const(0.0), lambda);
    let mut force = contact.normal.map(|n| graph.expr(n) * pressing);
    for &(row, axis) in &contact.slip_rows {
        force[axis] = force[axis] + lambda(row);
    }
    if let Some(friction) = contact.friction.as_ref().filter(|_| contact.mode == Mode::Sliding) {
        let flow = Flow::new(model, kinematics);
        for (f, part) in force.iter_mut().zip(flow.substitute_rates(&friction.force)) {
            *f = *f + part;
        }
    }
    force
}

/// `J d″ − P` of each row, by u′.
pub(crate) fn row_balances<'g>(kinematics: &Kinematics, model: &'g Model, s: &Structures<'g>) -> Vec<Expr<'g>> {
    let graph = &model.graph;
    let acceleration = |e: usize| {
        let terms = s.w[e].iter().zip(&kinematics.quasi).map(|(w, u)| *w * graph.expr(u.acceleration));
        terms.fold(s.bias[e], |sum, term| sum + term)
    };
    let inertial = |e: usize| if s.inertia[e].is(0.0) { s.inertia[e] } else { s.inertia[e] * acceleration(e) };
    let mut balance: Vec<Expr<'g>> = (0..s.rate.len()).map(|e| inertial(e) - s.force[e]).collect();
    for &(a, b, entry) in &s.couplings {
        balance[a] = balance[a] + entry * acceleration(b);
        balance[b] = balance[b] + entry * acceleration(a);
    }
    balance
}

/// λ of all rows of the kinematics.
fn multipliers<'g>(model: &'g Model, kinematics: &Kinematics, balance: &[Expr<'g>]) -> Vec<Expr<'g>> {
    let inputs = velocity_inputs(model);
    let columns: Vec<NodeId> = kinematics.factors.pivots.iter().map(|(_, v)| inputs[*v].0).collect();
    let w = rows_by_velocities(model, &columns);
    let force = |k: usize| {
        let terms = w.iter().zip(balance).filter(|(row, _)| !row[k].is(0.0)).map(|(row, b)| row[k] * *b);
        terms.fold(Expr::Const(0.0), |sum, e| sum + e)
    };
    let r: Vec<Expr<'g>> = (0..columns.len()).map(force).collect();
    kinematics.factors.solve_transposed(model, &r)
}
