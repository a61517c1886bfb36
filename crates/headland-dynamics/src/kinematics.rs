//! Equations (1) and (2): the rates of all coordinates by the quasi-velocities, `q′ = G(q,t) u + g(q,t)`.
//!
//! Rows in form (2) are taken as they are. Rows in form (1), `A q′ + a = 0`, are solved for dependent rates; the rates
//! left are quasi-velocities. Which rates depend is chosen by numbers, at a state: literal 1 and −1 first, since no
//! parameter can make them vanish, then complete pivoting on columns scaled by `M^(-1/2)`, since m/s and rad/s do not
//! compare.

use std::sync::Arc;

use headland_expr::{Expr, NodeId};
use headland_model::{Model, RowForm};

use crate::eliminate::{Factors, eliminate, linear_rows};
use crate::error::DeriveError;
use crate::structures::Flow;

/// A quasi-velocity of the derived equations.
#[derive(Clone, Debug)]
pub struct Quasi {
    /// Its name; an independent rate is called `x'`.
    pub name: String,
    /// SI unit.
    pub unit: String,
    /// Input u.
    pub u: NodeId,
    /// Input u′.
    pub acceleration: NodeId,
    /// Its position among the velocities.
    pub velocity: usize,
    /// True for an independent rate or a joint's velocity: the program chose it.
    pub chosen: bool,
    /// Typical size.
    pub scale: f64,
}

/// The kinematics by quasi-velocities.
///
/// *Velocities* are the rates of all coordinates, then all named quasi-velocities, those of joints among them.
#[derive(Clone, Debug)]
pub struct Kinematics {
    /// Quasi-velocities: the named ones that are independent, then independent rates.
    pub quasi: Vec<Quasi>,
    /// Rate of each coordinate as an expression of q, u, t.
    pub rates: Vec<NodeId>,
    /// Each velocity as an expression of q, u, t: the rates, then the named ones.
    pub velocities: Vec<NodeId>,
    /// `G′ u + g′`: the rate of each velocity at `u′ = 0`.
    pub drift: Vec<NodeId>,
    /// Velocities that were eliminated, in the order of elimination; empty with form (2) alone.
    pub dependent: Vec<usize>,
    /// Number of velocity constraints: coordinates less quasi-velocities.
    pub constraints: usize,
    /// Mass that each velocity moves: the diagonal of the mass matrix without constraints at the state of derivation; zero
    /// where nothing was chosen by it.
    pub mass: Vec<f64>,
    /// Rows that follow from the others at the state of derivation and were left out, by position.
    pub redundant: Vec<usize>,
    /// What elimination did.
    pub factors: Arc<Factors>,
}

/// Input and rate of each velocity: those of the coordinates, then the named ones.
pub fn velocity_inputs(model: &Model) -> Vec<(NodeId, NodeId)> {
    let rates = model.coordinates.iter().map(|c| (c.rate, c.acceleration));
    rates.chain(model.quasi_velocities.iter().map(|u| (u.u, u.acceleration))).collect()
}

/// Name of a velocity: `x'`, or that of a quasi-velocity.
pub fn velocity_name(model: &Model, velocity: usize) -> String {
    match model.coordinates.get(velocity) {
        Some(c) => format!("{}'", c.name),
        None => model.quasi_velocities[velocity - model.coordinates.len()].name.clone(),
    }
}

/// Solves the model's kinematics at the state `inputs` (all inputs of the graph, rates ignored).
///
/// `mass` is the diagonal of the mass matrix of the velocities without constraints, for the scaling of columns.
///
/// # Errors
/// Rows that are not linear, singular constraints, a wrong choice of `independent`.
pub fn solve_kinematics(model: &Model, inputs: &[f64], mass: &[f64]) -> Result<Kinematics, DeriveError> {
    let graph = &model.graph;
    let all = velocity_inputs(model);
    let rate_inputs: Vec<usize> = model.coordinates.iter().map(|c| model.input_index(c.rate)).collect();
    let nodes: Vec<NodeId> = model
        .kinematics
        .iter()
        .map(|r| match r.form {
            RowForm::Rate(_, n) | RowForm::Zero(n) => n,
        })
        .collect();
    let uses_rates = graph.depends(&nodes, |i| rate_inputs.contains(&i));
    let explicit = model.kinematics.iter().zip(&uses_rates).all(|(r, uses)| match r.form {
        RowForm::Rate(i, _) => !uses || model.coordinates[i].first_order,
        RowForm::Zero(_) => false,
    });

    let mut solved = Solved { velocities: vec![None; all.len()], drift: vec![None; all.len()], ..Solved::default() };
    if explicit {
        for row in &model.kinematics {
            if let RowForm::Rate(i, node) = row.form {
                solved.velocities[i] = Some(node);
            }
        }
    } else {
        let rows = linear_rows(model, &nodes)?;
        eliminate(model, rows, inputs, mass, &mut solved)?;
    }
    first_order_rates(model, &mut solved);
    let quasi = quasi_velocities(model, &solved.velocities);
    let velocities: Vec<NodeId> =
        solved.velocities.iter().zip(&all).map(|(v, (input, _))| v.unwrap_or(*input)).collect();
    let rates = velocities[..model.coordinates.len()].to_vec();
    check_linear(model, &quasi, &velocities)?;
    if quasi.is_empty() && !is_driven(model, &nodes) {
        return Err(DeriveError::NoFreedom { coordinates: rates.len(), constraints: model.kinematics.len() });
    }
    let drift = drift(model, &velocities, &solved);
    let constraints = rates.len().saturating_sub(quasi.len());
    let (dependent, redundant, factors) = (solved.dependent, solved.redundant, Arc::new(solved.factors));
    Ok(Kinematics { quasi, rates, velocities, drift, dependent, constraints, mass: mass.to_vec(), redundant, factors })
}

/// Puts the solved velocities into the rates of states of the first order, which nothing else depends on.
pub(crate) fn first_order_rates(model: &Model, solved: &mut Solved) {
    let all = velocity_inputs(model);
    let velocities: Vec<NodeId> =
        solved.velocities.iter().zip(&all).map(|(v, (input, _))| v.unwrap_or(*input)).collect();
    let flow = Flow::of_velocities(model, &velocities);
    let rows = model.kinematics.iter().filter_map(|r| match r.form {
        RowForm::Rate(i, node) if model.coordinates[i].first_order => Some((i, node)),
        _ => None,
    });
    let (states, nodes): (Vec<usize>, Vec<NodeId>) = rows.unzip();
    for (i, e) in states.into_iter().zip(flow.substitute_rates(&nodes)) {
        solved.velocities[i] = Some(model.graph.id(e));
        solved.drift[i] = None; // by differentiation
    }
}

/// Whether something is given as a function of time: then there may be motion without freedom.
fn is_driven(model: &Model, rows: &[NodeId]) -> bool {
    let time = model.input_index(model.time);
    !model.prescribed.is_empty() || model.graph.depends(rows, |i| i == time).contains(&true)
}

/// What elimination finds.
#[derive(Default)]
pub(crate) struct Solved {
    pub(crate) velocities: Vec<Option<NodeId>>,
    pub(crate) drift: Vec<Option<NodeId>>,
    pub(crate) dependent: Vec<usize>,
    pub(crate) redundant: Vec<usize>,
    pub(crate) factors: Factors,
}

/// The named quasi-velocities that are independent, then independent rates.
pub(crate) fn quasi_velocities(model: &Model, solved: &[Option<NodeId>]) -> Vec<Quasi> {
    let nq = model.coordinates.len();
    let named = model.quasi_velocities.iter().enumerate().filter(|(k, _)| solved[nq + k].is_none());
    let named = named.map(|(k, u)| Quasi {
        name: u.name.clone(),
        unit: u.unit.clone(),
        u: u.u,
        acceleration: u.acceleration,
        velocity: nq + k,
        chosen: u.of_joint,
        scale: u.scale,
    });
    let rates = model.coordinates.iter().enumerate().filter(|(i, _)| solved[*i].is_none()).map(|(i, c)| Quasi {
        name: format!("{}'", c.name),
        unit: c.rate_unit.clone(),
        u: c.rate,
        acceleration: c.acceleration,
        velocity: i,
        chosen: true,
        scale: c.scale,
    });
    named.chain(rates).collect()
}

/// Rates of the velocities at `u′ = 0`: zero for independent ones, from elimination where it gives them, else by
/// differentiation.
pub(crate) fn drift(model: &Model, velocities: &[NodeId], solved: &Solved) -> Vec<NodeId> {
    let graph = &model.graph;
    let flow = Flow::of_velocities(model, velocities);
    let eliminated: Vec<NodeId> = solved.drift.iter().flatten().copied().collect();
    let mut eliminated = flow.substitute_rates(&eliminated).into_iter();
    let rest: Vec<NodeId> = (0..velocities.len())
        .filter(|&v| solved.drift[v].is_none() && solved.velocities[v].is_some())
        .map(|v| velocities[v])
        .collect();
    let mut rest = flow.rate_of(&rest).into_iter();
    let zero = Expr::Const(0.0);
    (0..velocities.len())
        .map(|v| match (solved.drift[v], solved.velocities[v]) {
            (Some(_), _) => eliminated.next().unwrap_or(zero),
            (None, Some(_)) => rest.next().unwrap_or(zero),
            (None, None) => zero,
        })
        .map(|e| graph.id(e))
        .collect()
}

/// `∂nodes/∂u`, one row a node. What is a quasi-velocity itself costs nothing.
pub(crate) fn by_quasi_velocities(model: &Model, quasi: &[Quasi], nodes: &[NodeId]) -> Vec<Vec<NodeId>> {
    let graph = &model.graph;
    let (zero, one) = (graph.id(Expr::Const(0.0)), graph.id(Expr::Const(1.0)));
    let mut rows = vec![vec![zero; quasi.len()]; nodes.len()];
    let itself = |node: &NodeId| quasi.iter().position(|u| u.u == *node);
    let rest: Vec<usize> = (0..nodes.len()).filter(|&v| itself(&nodes[v]).is_none()).collect();
    for (v, row) in rows.iter_mut().enumerate() {
        if let Some(k) = itself(&nodes[v]) {
            row[k] = one;
        }
    }
    let others: Vec<NodeId> = rest.iter().map(|&v| nodes[v]).collect();
    let wanted: Vec<NodeId> = quasi.iter().map(|u| u.u).collect();
    for (i, k, e) in graph.jacobian(&others, &wanted) {
        rows[rest[i]][k] = graph.id(e);
    }
    rows
}

/// `G` must not contain velocities, but for the rows of states of the first order.
pub(crate) fn check_linear(model: &Model, quasi: &[Quasi], velocities: &[NodeId]) -> Result<(), DeriveError> {
    let graph = &model.graph;
    let u_inputs: Vec<usize> = quasi.iter().map(|u| model.input_index(u.u)).collect();
    let rows = by_quasi_velocities(model, quasi, velocities);
    let mut entries: Vec<(usize, NodeId)> = Vec::new();
    let bound = |v: &usize| !model.coordinates.get(*v).is_some_and(|c| c.first_order);
    for (v, row) in rows.iter().enumerate().filter(|(v, _)| bound(v)) {
        entries.extend(row.iter().filter(|e| graph.constant_value(**e).is_none()).map(|e| (v, *e)));
    }
    let nodes: Vec<NodeId> = entries.iter().map(|(_, e)| *e).collect();
    let depends = graph.depends(&nodes, |i| u_inputs.contains(&i));
    let Some(k) = depends.iter().position(|d| *d) else { return Ok(()) };
    let (i, node) = entries[k];
    let what = match model.coordinates.get(i) {
        Some(c) => format!("the rate of `{}`", c.name),
        None => format!("`{}`", velocity_name(model, i)),
    };
    let input = depends_on(model, node, &u_inputs).unwrap_or_default();
    Err(DeriveError::NotLinear { what, variables: "the quasi-velocities", input })
}

/// The name of one of the inputs on which a node depends.
pub(crate) fn depends_on(model: &Model, node: NodeId, inputs: &[usize]) -> Option<String> {
    let needed = model.graph.needed(&[node]);
    inputs
        .iter()
        .find(|&&i| needed.get(model.graph.input_id(i).index()).copied().unwrap_or(false))
        .map(|&i| model.graph.input_name(i))
}
