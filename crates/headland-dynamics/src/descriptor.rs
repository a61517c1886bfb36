//! [`Descriptor`]: the equations in all velocities v, nothing eliminated, as methods for differential-algebraic equations
//! want them.
//!
//! ```text
//! q′ = G₀ v + g₀        H v′ + h = Aᵀ λ        A v + a = 0        φ(q, t) = 0
//! H = Σ W′ᵀ J W′,       h = Σ W′ᵀ (J bias′ − P)        W′ = ∂d′/∂v, bias′ = d″ at v′ = 0
//! ```
//! v are the named quasi-velocities, those of joints among them, and the rates that no row of form (2) gives. It is the
//! direct derivation with every velocity its own quasi-velocity, so that outputs, energies and reactions are formed by
//! the same code as with elimination.

use headland_expr::{Expr, NodeId};
use headland_model::{Derived, Model, RowForm};

use crate::derive::Equations;
use crate::energy::{Energies, form_energies};
use crate::error::DeriveError;
use crate::kinematics::{
    Kinematics, Solved, by_quasi_velocities, check_linear, drift, quasi_velocities, velocity_inputs, velocity_name,
};
use crate::reactions::row_balances;
use crate::structures::{Flow, Structures, form_structures};

/// The equations in all velocities, over the model's graph.
#[derive(Clone, Debug)]
pub struct Descriptor {
    /// Rates, energies and structures by q, v and v′: every velocity is a quasi-velocity. `derived` is empty, M and F are
    /// not formed, and `accelerations` are the inputs v′.
    pub equations: Equations,
    /// `H v′ + h`, one entry a velocity.
    pub balance: Vec<NodeId>,
    /// The constraints that carry a multiplier.
    pub constraints: Vec<Constraint>,
    /// Values of the model's derived quantities, in its order.
    pub derived: Vec<ByMultipliers>,
    /// Power of the drives in the constraints, `−λᵀ a`: besides that in [`Energies::drives`].
    pub drives: ByMultipliers,
}

/// A constraint of the un-eliminated equations.
#[derive(Clone, Debug)]
pub struct Constraint {
    /// Its name.
    pub name: String,
    /// Its position among the rows of the kinematics.
    pub row: usize,
    /// `A v + a`
    pub velocity: NodeId,
    /// `A v′ + A′ v + a′`
    pub acceleration: NodeId,
    /// Entries of A: velocity by position in [`Kinematics::quasi`], and node.
    pub entries: Vec<(usize, NodeId)>,
    /// `φ(q, t)` of a holonomic constraint.
    pub position: Option<NodeId>,
}

/// A quantity that the multipliers enter: `own + Σ part λ`.
#[derive(Clone, Debug)]
pub struct ByMultipliers {
    /// What stands without multipliers.
    pub own: NodeId,
    /// Constraints by position in [`Descriptor::constraints`], and their part.
    pub parts: Vec<(usize, NodeId)>,
}

/// Forms the equations in all velocities; `redundant` are rows of the kinematics that follow from the others
/// ([`Kinematics::redundant`]) and get no multiplier.
///
/// # Errors
/// Structures or rows that are not linear.
pub fn form_descriptor(model: &Model, redundant: &[usize]) -> Result<Descriptor, DeriveError> {
    let graph = &model.graph;
    let kinematics = Kinematics { redundant: redundant.to_vec(), ..free_kinematics(model)? };
    let structures = form_structures(model, &kinematics, true)?;
    let energies = form_energies(model, &kinematics, &structures);
    let equations = without_elimination(model, kinematics, &structures, energies);
    let constraints = constraints(model, &equations);
    let row_balance = row_balances(&equations.kinematics, model, &structures);
    let balance = balance(model, &equations.kinematics, &structures, &row_balance);
    let derived = derived(model, &equations.energies, &constraints, &row_balance);
    let drives = drives(model, &equations.kinematics, &constraints);
    let balance = balance.into_iter().map(|e| graph.id(e)).collect();
    Ok(Descriptor { equations, balance, constraints, derived, drives })
}

/// Kinematics in which all velocities that no row of form (2) gives are quasi-velocities. Rates given by other given
/// rates are put in one after the other; those that go around in a circle are constraints.
///
/// # Errors
/// Rates that are not linear in the velocities.
pub fn free_kinematics(model: &Model) -> Result<Kinematics, DeriveError> {
    let graph = &model.graph;
    let all = velocity_inputs(model);
    let mut solved = Solved { velocities: vec![None; all.len()], drift: vec![None; all.len()], ..Solved::default() };
    let mut open: Vec<(usize, NodeId)> = Vec::new();
    for row in &model.kinematics {
        if let RowForm::Rate(i, node) = row.form
            && open.iter().all(|(k, _)| *k != i)
        {
            open.push((i, node));
        }
    }
    loop {
        let waiting: Vec<usize> = open.iter().map(|(i, _)| model.input_index(all[*i].0)).collect();
        let nodes: Vec<NodeId> = open.iter().map(|(_, node)| *node).collect();
        let waits = graph.depends(&nodes, |input| waiting.contains(&input));
        if waits.iter().all(|w| *w) {
            break;
        }
        let flow = Flow::of_velocities(model, &with_inputs(&solved, &all));
        let ready: Vec<(usize, NodeId)> = open.iter().zip(&waits).filter(|(_, w)| !**w).map(|(o, _)| *o).collect();
        let put_in = flow.substitute_rates(&ready.iter().map(|(_, node)| *node).collect::<Vec<_>>());
        for ((i, _), e) in ready.into_iter().zip(put_in) {
            solved.velocities[i] = Some(graph.id(e));
            open.retain(|(k, _)| *k != i);
        }
    }
    let velocities = with_inputs(&solved, &all);
    let quasi = quasi_velocities(model, &solved.velocities);
    check_linear(model, &quasi, &velocities)?;
    let drift = drift(model, &velocities, &solved);
    let rates = velocities[..model.coordinates.len()].to_vec();
    let mass = vec![0.0; velocities.len()];
    let (dependent, redundant, factors) = (Vec::new(), Vec::new(), Default::default());
    Ok(Kinematics { quasi, rates, velocities, drift, dependent, constraints: 0, mass, redundant, factors })
}

fn with_inputs(solved: &Solved, all: &[(NodeId, NodeId)]) -> Vec<NodeId> {
    solved.velocities.iter().zip(all).map(|(v, (input, _))| v.unwrap_or(*input)).collect()
}

/// Everything but the equations of motion.
fn without_elimination(
    model: &Model,
    kinematics: Kinematics,
    structures: &Structures<'_>,
    energies: Energies,
) -> Equations {
    let ids = |es: &[Expr<'_>]| -> Vec<NodeId> { es.iter().map(|e| model.graph.id(*e)).collect() };
    Equations {
        g: by_quasi_velocities(model, &kinematics.quasi, &kinematics.velocities),
        mass: Vec::new(),
        force: Vec::new(),
        accelerations: Some(kinematics.quasi.iter().map(|u| u.acceleration).collect()),
        joint_forces: None,
        structure_rates: ids(&structures.rate),
        structure_matrix: structures.w.iter().map(|row| ids(row)).collect(),
        energies,
        friction_pivots: Vec::new(),
        derived: Vec::new(),
        linear_solver: model.run.linear_solver,
        algorithm: "descriptor",
        why: "nothing is eliminated".into(),
        difference: None,
        kinematics,
    }
}

/// The rows that are not of form (2), less the redundant ones.
fn constraints(model: &Model, equations: &Equations) -> Vec<Constraint> {
    let graph = &model.graph;
    let kinematics = &equations.kinematics;
    let all = velocity_inputs(model);
    let flow = Flow::new(model, kinematics);
    let row_node = |row: usize| match model.kinematics[row].form {
        RowForm::Zero(node) => Some(node),
        RowForm::Rate(i, _) if kinematics.velocities[i] != all[i].0 => None,
        RowForm::Rate(i, node) => Some(graph.id(graph.expr(node) - graph.expr(all[i].0))),
    };
    let kept = (0..model.kinematics.len()).filter(|row| !kinematics.redundant.contains(row));
    let (rows, nodes): (Vec<usize>, Vec<NodeId>) = kept.filter_map(|row| Some((row, row_node(row)?))).unzip();
    let velocity: Vec<NodeId> = flow.substitute_rates(&nodes).into_iter().map(|e| graph.id(e)).collect();
    let columns: Vec<NodeId> = kinematics.quasi.iter().map(|u| u.u).collect();
    let mut entries = vec![Vec::new(); rows.len()];
    for (i, j, a) in graph.jacobian(&velocity, &columns) {
        entries[i].push((j, graph.id(a)));
    }
    let drift = flow.rate_of(&velocity);
    let made = rows.into_iter().enumerate().map(|(k, row)| {
        let of_model = &model.kinematics[row];
        let acceleration = match of_model.rate {
            Some(rate) => equations.by_state(model, &[rate])[0],
            None => {
                let terms = entries[k].iter().map(|(j, a)| (kinematics.quasi[*j].acceleration, *a));
                graph.id(terms.fold(drift[k], |sum, (rate, a)| sum + graph.expr(a) * graph.expr(rate)))
            }
        };
        let name = match of_model.form {
            RowForm::Rate(i, _) => velocity_name(model, i),
            RowForm::Zero(_) => of_model.name.clone(),
        };
        let (velocity, entries, position) = (velocity[k], std::mem::take(&mut entries[k]), of_model.position);
        Constraint { name, row, velocity, acceleration, entries, position }
    });
    made.collect()
}

/// `H v′ + h`.
fn balance<'g>(model: &'g Model, kinematics: &Kinematics, s: &Structures<'g>, rows: &[Expr<'g>]) -> Vec<Expr<'g>> {
    let graph = &model.graph;
    let scalars = model.elements.len();
    let mut sums = vec![Expr::Const(0.0); kinematics.quasi.len()];
    for (e, w) in s.w.iter().enumerate() {
        for i in (0..w.len()).filter(|&i| !w[i].is(0.0)) {
            sums[i] = sums[i] + if e < scalars { scalar_term(graph, kinematics, s, e, i) } else { w[i] * rows[e] };
        }
    }
    sums
}

/// `W_i (J d″ − P)` of a scalar element; W by bias first: where W is a square root, the bias has it as its denominator.
fn scalar_term<'g>(
    graph: &'g headland_expr::Graph,
    kinematics: &Kinematics,
    s: &Structures<'g>,
    e: usize,
    i: usize,
) -> Expr<'g> {
    let w = s.w[e][i];
    let force = -(w * s.force[e]);
    if s.inertia[e].is(0.0) {
        return force;
    }
    let along = s.w[e].iter().zip(&kinematics.quasi).filter(|(wj, _)| !wj.is(0.0));
    let acceleration = along.fold(w * s.bias[e], |sum, (wj, u)| sum + w * *wj * graph.expr(u.acceleration));
    force + s.inertia[e] * acceleration
}

/// The model's derived quantities with multipliers apart.
fn derived<'g>(
    model: &'g Model,
    energies: &Energies,
    constraints: &[Constraint],
    row_balance: &[Expr<'g>],
) -> Vec<ByMultipliers> {
    let graph = &model.graph;
    let zero = graph.id(Expr::Const(0.0));
    let alone = |own: NodeId| ByMultipliers { own, parts: Vec::new() };
    let place = |row: usize| constraints.iter().position(|c| c.row == row);
    let value = |what: &Derived| match what {
        Derived::Multiplier(row) => {
            let part = place(*row).map(|k| (k, graph.id(Expr::Const(1.0))));
            ByMultipliers { own: zero, parts: part.into_iter().collect() }
        }
        Derived::Kinetic => alone(energies.kinetic),
        Derived::Potential => alone(energies.potential),
        Derived::Power(name) => alone(energies.powers.iter().find(|(n, _)| n == name).map_or(zero, |(_, node)| *node)),
        Derived::Mode(k) => alone(graph.id(Expr::Const(f64::from(model.contacts[*k].mode as u8)))),
        Derived::Contact(k, axis) => {
            let contact = &model.contacts[*k];
            let along = |i: usize| match axis {
                Some(axis) => Expr::Const(if i == *axis { 1.0 } else { 0.0 }),
                None => graph.expr(contact.normal[i]),
            };
            let normal = contact.normal.map(|n| graph.expr(n));
            let pressing = (0..3).fold(Expr::Const(0.0), |sum, i| sum + along(i) * normal[i]);
            let rows = contact.gap_row.map(|row| (row, pressing)).into_iter();
            let rows = rows.chain(contact.slip_rows.iter().map(|(row, i)| (*row, along(*i))));
            ByMultipliers { own: zero, parts: rows.filter_map(|(row, a)| Some((place(row)?, graph.id(a)))).collect() }
        }
        Derived::Reaction(reaction) => {
            let own = reaction.rows.iter().map(|(row, w)| graph.expr(*w) * row_balance[*row]);
            let own = graph.id(own.fold(Expr::Const(0.0), |sum, e| sum + e));
            let loops = reaction.constraints.iter();
            let parts = loops.filter_map(|(row, a)| Some((place(*row)?, graph.id(-graph.expr(*a))))).collect();
            ByMultipliers { own, parts }
        }
    };
    model.derived.iter().map(|d| value(&d.what)).collect()
}

/// `−λᵀ a`, a the constraints at v = 0.
fn drives(model: &Model, kinematics: &Kinematics, constraints: &[Constraint]) -> ByMultipliers {
    let graph = &model.graph;
    let inputs: Vec<usize> = kinematics.quasi.iter().map(|u| model.input_index(u.u)).collect();
    let nodes: Vec<NodeId> = constraints.iter().map(|c| c.velocity).collect();
    let at_rest = graph.substitute(&nodes, |i| inputs.contains(&i).then_some(Expr::Const(0.0)));
    let parts = at_rest.into_iter().enumerate().filter(|(_, a)| !a.is(0.0)).map(|(k, a)| (k, graph.id(-a)));
    ByMultipliers { own: graph.id(Expr::Const(0.0)), parts: parts.collect() }
}
