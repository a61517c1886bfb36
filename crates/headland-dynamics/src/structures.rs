//! Structures by quasi-velocities: rates `d′`, structural matrices `W = ∂d′/∂u` and the accelerations' part without `u′`.
//!
//! ```text
//! geometric  d(q,t):       d′ = (∂d/∂q) q′ + ∂d/∂t
//! implicit   d′(q,q′,t):   q′ put in by (2)
//! explicit   d′(q,u,t):    as it is
//! d″ = W u′ + bias,        bias = d(d′)/dt at u′ = 0
//! ```
//! All structures share one pass a derivative, so the work is linear in the size of the scene for a given number of
//! quasi-velocities.

use headland_expr::{Expr, NodeId};
use headland_model::{Element, ElementKind, Model, StructureForm};

use crate::error::DeriveError;
use crate::kinematics::{Kinematics, depends_on};

/// The structures of all elements, in the order of [`Model::elements`].
#[derive(Clone, Debug)]
pub struct Structures<'g> {
    /// `d′(q, u, t)`
    pub rate: Vec<Expr<'g>>,
    /// `W`, one row an element, one column a quasi-velocity.
    pub w: Vec<Vec<Expr<'g>>>,
    /// `d″` at `u′ = 0`; inertia elements only, zero elsewhere.
    pub bias: Vec<Expr<'g>>,
    /// Force along the structure: the value of a force, `−c d`, `−b d′`; zero for inertia.
    pub force: Vec<Expr<'g>>,
    /// Mass or moment of inertia; zero for others.
    pub inertia: Vec<Expr<'g>>,
}

/// Forms all structures by the quasi-velocities.
///
/// # Errors
/// A structure that is not linear in the quasi-velocities.
pub fn form_structures<'g>(model: &'g Model, kinematics: &Kinematics) -> Result<Structures<'g>, DeriveError> {
    let graph = &model.graph;
    let flow = Flow::new(model, kinematics);
    let elements = &model.elements;
    let nodes: Vec<NodeId> = elements.iter().map(|e| e.structure).collect();

    let geometric = flow.rate_of(&select(elements, &nodes, StructureForm::Geometric));
    let implicit = flow.substitute_rates(&select(elements, &nodes, StructureForm::Implicit));
    let (mut geometric, mut implicit) = (geometric.into_iter(), implicit.into_iter());
    let rate: Vec<Expr<'g>> = elements
        .iter()
        .map(|e| match e.form {
            StructureForm::Geometric => geometric.next(),
            StructureForm::Implicit => implicit.next(),
            StructureForm::Explicit => Some(graph.expr(e.structure)),
        })
        .map(|e| e.unwrap_or(Expr::Const(0.0)))
        .collect();
    let rate_nodes: Vec<NodeId> = rate.iter().map(|e| graph.id(*e)).collect();

    let mut w = vec![Vec::with_capacity(kinematics.quasi.len()); elements.len()];
    for u in &kinematics.quasi {
        let input = model.input_index(u.u);
        let column = graph.tangent(&rate_nodes, |i| (i == input).then_some(Expr::Const(1.0)));
        for (row, entry) in w.iter_mut().zip(column) {
            row.push(entry);
        }
    }
    check_linear(model, kinematics, &w)?;

    let inertial: Vec<NodeId> = of_kind(elements, &rate_nodes, ElementKind::Inertia);
    let mut inertial_bias = flow.rate_of(&inertial).into_iter();
    let zero = Expr::Const(0.0);
    let bias = elements
        .iter()
        .map(|e| if e.kind == ElementKind::Inertia { inertial_bias.next().unwrap_or(zero) } else { zero });
    let bias: Vec<Expr<'g>> = bias.collect();
    let values = flow.substitute_rates(&elements.iter().map(|e| e.value).collect::<Vec<_>>());
    let force = elements.iter().enumerate().map(|(i, e)| match e.kind {
        ElementKind::Inertia => zero,
        ElementKind::Elastic => -(values[i] * graph.expr(e.structure)),
        ElementKind::Dissipative => -(values[i] * rate[i]),
        ElementKind::Force => values[i],
    });
    let force: Vec<Expr<'g>> = force.collect();
    let inertia =
        elements.iter().zip(&values).map(|(e, v)| if e.kind == ElementKind::Inertia { *v } else { zero }).collect();
    Ok(Structures { rate, w, bias, force, inertia })
}

fn select(elements: &[Element], nodes: &[NodeId], form: StructureForm) -> Vec<NodeId> {
    elements.iter().zip(nodes).filter(|(e, _)| e.form == form).map(|(_, n)| *n).collect()
}

fn of_kind(elements: &[Element], nodes: &[NodeId], kind: ElementKind) -> Vec<NodeId> {
    elements.iter().zip(nodes).filter(|(e, _)| e.kind == kind).map(|(_, n)| *n).collect()
}

fn check_linear(model: &Model, kinematics: &Kinematics, w: &[Vec<Expr<'_>>]) -> Result<(), DeriveError> {
    let graph = &model.graph;
    let u_inputs: Vec<usize> = kinematics.quasi.iter().map(|u| model.input_index(u.u)).collect();
    let all: Vec<NodeId> = w.iter().flatten().map(|e| graph.id(*e)).collect();
    let depends = graph.depends(&all, |i| u_inputs.contains(&i));
    let Some(k) = depends.iter().position(|d| *d) else { return Ok(()) };
    let element = &model.elements[k / kinematics.quasi.len().max(1)];
    let input = depends_on(model, all[k], &u_inputs).unwrap_or_default();
    let what = format!("the structure of `{}`", element.name);
    Err(DeriveError::NotLinear { what, variables: "the quasi-velocities", input })
}

/// How coordinates and time move: the seeds of total derivatives at `u′ = 0`.
pub struct Flow<'g> {
    model: &'g Model,
    /// Rate of each input of the graph that is a coordinate or the time.
    seeds: Vec<Option<Expr<'g>>>,
    /// Expression of each input that is a dependent rate.
    rates: Vec<Option<Expr<'g>>>,
}

impl<'g> Flow<'g> {
    /// The flow of `q′ = G u + g`, `t′ = 1`.
    pub fn new(model: &'g Model, kinematics: &Kinematics) -> Self {
        let graph = &model.graph;
        let mut seeds = vec![None; graph.input_count()];
        let mut rates = vec![None; graph.input_count()];
        seeds[model.input_index(model.time)] = Some(Expr::Const(1.0));
        for (c, rate) in model.coordinates.iter().zip(&kinematics.rates) {
            seeds[model.input_index(c.q)] = Some(graph.expr(*rate));
            if *rate != c.rate {
                rates[model.input_index(c.rate)] = Some(graph.expr(*rate));
            }
        }
        Self { model, seeds, rates }
    }

    /// Total derivatives in time at `u′ = 0`.
    pub fn rate_of(&self, nodes: &[NodeId]) -> Vec<Expr<'g>> {
        self.model.graph.tangent(nodes, |i| self.seeds[i])
    }

    /// The nodes with the rates of coordinates put in by (2).
    pub fn substitute_rates(&self, nodes: &[NodeId]) -> Vec<Expr<'g>> {
        self.model.graph.substitute(nodes, |i| self.rates[i])
    }
}
