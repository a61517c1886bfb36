//! Structures by quasi-velocities: rates `d′`, structural matrices `W = ∂d′/∂u` and the accelerations' part without `u′`.
//!
//! ```text
//! geometric  d(q,t):       d′ = (∂d/∂q) q′ + ∂d/∂t
//! implicit   d′(q,q′,t):   q′ put in by (2)
//! explicit   d′(q,u,t):    as it is
//! d″ = W u′ + bias,        bias = d(d′)/dt at u′ = 0
//! ```
//! A rigid body has six rows: the velocity of its mass centre and its angular velocity, equation (7); a force at a point
//! and a torque have three. Gyroscopic moments `ω × J ω` stand with the forces.
//!
//! All structures share one pass a derivative, so the work is linear in the size of the scene for a given number of
//! quasi-velocities.

use headland_expr::{Expr, NodeId};
use headland_model::{Body, Element, ElementKind, Model, StructureForm};

use crate::error::DeriveError;
use crate::kinematics::{Kinematics, depends_on, velocity_inputs};

/// The structures as rows: one a scalar element, in the order of [`Model::elements`]; six a body; three a load.
#[derive(Clone, Debug)]
pub struct Structures<'g> {
    /// `d′(q, u, t)`
    pub rate: Vec<Expr<'g>>,
    /// `W`, one row a structure, one column a quasi-velocity.
    pub w: Vec<Vec<Expr<'g>>>,
    /// `d″` at `u′ = 0`; rows of inertia only, zero elsewhere.
    pub bias: Vec<Expr<'g>>,
    /// Force along the structure: the value of a force, `−c d`, `−b d′`; weight and gyroscopic moment of a body.
    pub force: Vec<Expr<'g>>,
    /// Mass or moment of inertia; zero for others.
    pub inertia: Vec<Expr<'g>>,
    /// Entries of tensors that couple two rows.
    pub couplings: Vec<(usize, usize, Expr<'g>)>,
}

/// Name of the element to which a row belongs.
pub fn row_name(model: &Model, row: usize) -> &str {
    let after = row.saturating_sub(model.elements.len());
    match model.elements.get(row) {
        Some(e) => &e.name,
        None => match model.bodies.get(after / 6) {
            Some(body) => &body.name,
            None => &model.loads[(after - 6 * model.bodies.len()) / 3].name,
        },
    }
}

/// Forms all structures by the quasi-velocities. Without `bodies`, their rows of W and biases are left out: the recursive
/// algorithms do not need them, and they are what grows with the square of a chain.
///
/// # Errors
/// A structure that is not linear in the quasi-velocities.
pub fn form_structures<'g>(
    model: &'g Model,
    kinematics: &Kinematics,
    bodies: bool,
) -> Result<Structures<'g>, DeriveError> {
    let graph = &model.graph;
    let flow = Flow::new(model, kinematics);
    let rate = rates(model, &flow);
    let rate_nodes: Vec<NodeId> = rate.iter().map(|e| graph.id(*e)).collect();

    let first = model.elements.len();
    let left_out = if bodies { first..first } else { first..first + 6 * model.bodies.len() };
    let wanted: Vec<usize> = (0..rate.len()).filter(|e| !left_out.contains(e)).collect();
    let nodes: Vec<NodeId> = wanted.iter().map(|&e| rate_nodes[e]).collect();
    let mut w = vec![Vec::new(); rate.len()];
    for u in kinematics.quasi.iter().filter(|_| !nodes.is_empty()) {
        let input = model.input_index(u.u);
        let column = graph.tangent(&nodes, |i| (i == input).then_some(Expr::Const(1.0)));
        for (&e, entry) in wanted.iter().zip(column) {
            w[e].push(entry);
        }
    }
    check_linear(model, kinematics, &w)?;

    let bias = if bodies { biases(model, &flow, &rate_nodes) } else { vec![Expr::Const(0.0); rate.len()] };
    let mut s = Structures { force: vec![Expr::Const(0.0); rate.len()], rate, w, bias, ..Structures::default() };
    scalar_values(model, &flow, &mut s);
    for body in &model.bodies {
        body_values(body, &flow, &mut s);
    }
    let loads: Vec<NodeId> = model.loads.iter().flat_map(|l| l.force).collect();
    let first = s.rate.len() - loads.len();
    s.force.splice(first.., flow.substitute_rates(&loads));
    s.inertia.resize(s.rate.len(), Expr::Const(0.0));
    Ok(s)
}

impl Default for Structures<'_> {
    fn default() -> Self {
        let (rate, w, bias, force) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        Self { rate, w, bias, force, inertia: Vec::new(), couplings: Vec::new() }
    }
}

/// The structures' rates by q, q′ and u, before (2) is put in; in the order of the rows.
pub(crate) fn raw_rates<'g>(model: &'g Model, rate_of: impl Fn(&[NodeId]) -> Vec<Expr<'g>>) -> Vec<NodeId> {
    let graph = &model.graph;
    let is_differentiated = |e: &&Element| e.form == StructureForm::Geometric && e.rate.is_none();
    let geometric: Vec<NodeId> = model.elements.iter().filter(is_differentiated).map(|e| e.structure).collect();
    let mut geometric = rate_of(&geometric).into_iter();
    let scalars = model.elements.iter().map(|e| match e.rate {
        Some(rate) => rate,
        None if e.form == StructureForm::Geometric => graph.id(geometric.next().unwrap_or(Expr::Const(0.0))),
        None => e.structure,
    });
    let scalars: Vec<NodeId> = scalars.collect();
    let bodies = model.bodies.iter().flat_map(|b| b.velocity.rate.into_iter().chain(b.spin.rate));
    scalars.into_iter().chain(bodies).chain(model.loads.iter().flat_map(|l| l.rate)).collect()
}

fn rates<'g>(model: &'g Model, flow: &Flow<'g>) -> Vec<Expr<'g>> {
    let raw = raw_rates(model, |nodes| flow.rate_of(nodes));
    flow.substitute_rates(&raw)
}

/// `d″` at `u′ = 0` of the rows of inertia.
fn biases<'g>(model: &'g Model, flow: &Flow<'g>, rate: &[NodeId]) -> Vec<Expr<'g>> {
    let scalars = model.elements.len();
    let mut bias = vec![Expr::Const(0.0); rate.len()];
    let mut differentiated: Vec<usize> =
        (0..scalars).filter(|&i| model.elements[i].kind == ElementKind::Inertia).collect();
    let mut given: (Vec<usize>, Vec<NodeId>) = (Vec::new(), Vec::new());
    for (b, body) in model.bodies.iter().enumerate() {
        for (half, structure) in [body.velocity, body.spin].into_iter().enumerate() {
            let rows = (0..3).map(|i| scalars + 6 * b + 3 * half + i);
            match structure.acceleration {
                Some(nodes) => {
                    given.0.extend(rows);
                    given.1.extend(nodes);
                }
                None => differentiated.extend(rows),
            }
        }
    }
    let nodes: Vec<NodeId> = differentiated.iter().map(|&i| rate[i]).collect();
    for (i, e) in differentiated.into_iter().zip(flow.rate_of(&nodes)) {
        bias[i] = e;
    }
    for (i, e) in given.0.into_iter().zip(flow.accelerations_at_rest(&given.1)) {
        bias[i] = e;
    }
    bias
}

fn scalar_values<'g>(model: &'g Model, flow: &Flow<'g>, s: &mut Structures<'g>) {
    let graph = &model.graph;
    let values = flow.substitute_rates(&model.elements.iter().map(|e| e.value).collect::<Vec<_>>());
    for (i, (e, value)) in model.elements.iter().zip(values).enumerate() {
        let zero = Expr::Const(0.0);
        let (inertia, force) = match e.kind {
            ElementKind::Inertia => (value, zero),
            ElementKind::Elastic => (zero, -(value * graph.expr(e.structure))),
            ElementKind::Dissipative => (zero, -(value * s.rate[i])),
            ElementKind::Force => (zero, value),
        };
        s.inertia.push(inertia);
        s.force[i] = force;
    }
}

/// Mass, tensor and gyroscopic moment of a body, whose rows begin where those of inertia end so far.
fn body_values<'g>(body: &Body, flow: &Flow<'g>, s: &mut Structures<'g>) {
    let graph = &flow.model.graph;
    let first = s.inertia.len();
    let [xx, yy, zz, xy, xz, yz] = body.tensor.map(|n| graph.expr(n));
    s.inertia.extend([graph.expr(body.mass); 3]);
    s.inertia.extend([xx, yy, zz]);
    for (a, b, entry) in [(3, 4, xy), (3, 5, xz), (4, 5, yz)] {
        if !entry.is(0.0) {
            s.couplings.push((first + a, first + b, entry));
        }
    }
    let w = [s.rate[first + 3], s.rate[first + 4], s.rate[first + 5]];
    let h = [xx * w[0] + xy * w[1] + xz * w[2], xy * w[0] + yy * w[1] + yz * w[2], xz * w[0] + yz * w[1] + zz * w[2]];
    for i in 0..3 {
        s.force[first + i] = graph.expr(body.weight[i]);
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        // (J_k − J_j) w_j w_k where the tensor is diagonal: equal moments leave nothing
        let moment = if [xy, xz, yz].iter().all(|e| e.is(0.0)) {
            (s.inertia[first + 3 + k] - s.inertia[first + 3 + j]) * (w[j] * w[k])
        } else {
            w[j] * h[k] - w[k] * h[j]
        };
        s.force[first + 3 + i] = -moment;
    }
}

fn check_linear(model: &Model, kinematics: &Kinematics, w: &[Vec<Expr<'_>>]) -> Result<(), DeriveError> {
    let graph = &model.graph;
    let u_inputs: Vec<usize> = kinematics.quasi.iter().map(|u| model.input_index(u.u)).collect();
    let rows = w.iter().enumerate().flat_map(|(e, row)| row.iter().map(move |entry| (e, graph.id(*entry))));
    let (rows, all): (Vec<usize>, Vec<NodeId>) = rows.unzip();
    let depends = graph.depends(&all, |i| u_inputs.contains(&i));
    let Some(k) = depends.iter().position(|d| *d) else { return Ok(()) };
    let input = depends_on(model, all[k], &u_inputs).unwrap_or_default();
    let what = format!("the structure of `{}`", row_name(model, rows[k]));
    Err(DeriveError::NotLinear { what, variables: "the quasi-velocities", input })
}

/// How coordinates, velocities and time move: the seeds of total derivatives at `u′ = 0`.
pub struct Flow<'g> {
    model: &'g Model,
    /// Rate of each input of the graph that is a coordinate or the time.
    seeds: Vec<Option<Expr<'g>>>,
    /// Expression of each input that is a dependent velocity.
    rates: Vec<Option<Expr<'g>>>,
    /// The same, and the velocities' rates at `u′ = 0`.
    accelerations: Vec<Option<Expr<'g>>>,
}

impl<'g> Flow<'g> {
    /// The flow of `q′ = G u + g`, `t′ = 1`.
    pub fn new(model: &'g Model, kinematics: &Kinematics) -> Self {
        let mut flow = Self::of_velocities(model, &kinematics.velocities);
        flow.accelerations = flow.rates.clone();
        for ((_, acceleration), drift) in velocity_inputs(model).into_iter().zip(&kinematics.drift) {
            flow.accelerations[model.input_index(acceleration)] = Some(model.graph.expr(*drift));
        }
        flow
    }

    /// The flow by the velocities alone; their rates are not known yet.
    pub(crate) fn of_velocities(model: &'g Model, velocities: &[NodeId]) -> Self {
        let graph = &model.graph;
        let mut seeds = vec![None; graph.input_count()];
        let mut rates = vec![None; graph.input_count()];
        seeds[model.input_index(model.time)] = Some(Expr::Const(1.0));
        for (c, rate) in model.coordinates.iter().zip(velocities) {
            seeds[model.input_index(c.q)] = Some(graph.expr(*rate));
        }
        for ((input, _), solved) in velocity_inputs(model).into_iter().zip(velocities) {
            if *solved != input {
                rates[model.input_index(input)] = Some(graph.expr(*solved));
            }
        }
        Self { model, seeds, rates, accelerations: Vec::new() }
    }

    /// Total derivatives in time at `u′ = 0`.
    pub fn rate_of(&self, nodes: &[NodeId]) -> Vec<Expr<'g>> {
        self.model.graph.tangent(nodes, |i| self.seeds[i])
    }

    /// The nodes with the dependent velocities put in by (2).
    pub fn substitute_rates(&self, nodes: &[NodeId]) -> Vec<Expr<'g>> {
        self.model.graph.substitute(nodes, |i| self.rates[i])
    }

    /// The nodes with velocities and their rates put in by (2), at `u′ = 0`.
    pub fn accelerations_at_rest(&self, nodes: &[NodeId]) -> Vec<Expr<'g>> {
        self.model.graph.substitute(nodes, |i| self.accelerations[i])
    }
}
