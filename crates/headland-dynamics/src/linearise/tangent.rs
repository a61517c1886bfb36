//! [`Tangent`]: the displacements that the constraints on positions leave, `δq = T(q, t) s`.
//!
//! T is the matrix G of the same model with nothing but its joints and its constraints on positions: those are solved by
//! the elimination that solves all others.

use headland_expr::{Dual, Expr, NodeId};
use headland_model::{Model, RowForm};
use nalgebra::DMatrix;

use crate::error::DeriveError;
use crate::kinematics::{Kinematics, solve_kinematics, velocity_name};

/// T as nodes over its own copy of the model's graph, which has the same inputs.
pub(super) struct Tangent {
    model: Model,
    /// `[coordinate][displacement]`
    columns: Vec<Vec<NodeId>>,
    rows: usize,
    /// Names and units of the displacements, and their coordinates; a turn has none.
    pub(super) displacements: Vec<(String, String, Option<usize>)>,
}

impl Tangent {
    /// Chooses the displacements at the given inputs of the graph.
    pub(super) fn new(model: &Model, kinematics: &Kinematics, inputs: &[f64]) -> Result<Self, DeriveError> {
        let (model, mass) = holonomic_part(model, &kinematics.mass);
        let rows = model.coordinates.len();
        let solved = match solve_kinematics(&model, inputs, &mass) {
            Ok(solved) => solved,
            Err(DeriveError::NoFreedom { .. }) => {
                return Ok(Self { model, columns: Vec::new(), rows, displacements: Vec::new() });
            }
            Err(error) => return Err(error),
        };
        let column = |u: NodeId| {
            let input = model.input_index(u);
            let column = model.graph.tangent(&solved.rates, |i| (i == input).then_some(Expr::Const(1.0)));
            column.into_iter().map(|e| model.graph.id(e)).collect()
        };
        let columns = solved.quasi.iter().map(|u| column(u.u)).collect();
        let displacements = solved.quasi.iter().map(|u| match model.coordinates.get(u.velocity) {
            Some(c) => (c.name.clone(), c.unit.clone(), Some(u.velocity)),
            None => (format!("∫{}", velocity_name(&model, u.velocity)), "rad".to_string(), None),
        });
        let displacements = displacements.collect();
        Ok(Self { model, columns, rows, displacements })
    }

    /// T at the inputs, and its derivative along the duals' direction.
    pub(super) fn eval(&self, inputs: &[Dual<f64>]) -> (DMatrix<f64>, DMatrix<f64>) {
        let nodes: Vec<NodeId> = self.columns.iter().flatten().copied().collect();
        let values = self.model.graph.eval(&nodes, inputs);
        let part =
            |f: fn(&Dual<f64>) -> f64| DMatrix::from_iterator(self.rows, self.columns.len(), values.iter().map(f));
        (part(|x| x.value), part(|x| x.dot))
    }

    /// Whether a constraint on positions, or T, depends on an input of the graph.
    pub(super) fn depends_on(&self, input: usize) -> bool {
        let rows = self.model.kinematics.iter().filter_map(|r| r.position);
        let nodes: Vec<NodeId> = self.columns.iter().flatten().copied().chain(rows).collect();
        self.model.graph.depends(&nodes, |i| i == input).contains(&true)
    }
}

/// The model with joints and constraints on positions alone, and the masses of its velocities.
fn holonomic_part(model: &Model, mass: &[f64]) -> (Model, Vec<f64>) {
    let mut part = model.clone();
    let nq = part.coordinates.len();
    let own: Vec<bool> = model.quasi_velocities.iter().map(|u| u.of_joint).collect();
    let named: Vec<usize> = model.quasi_velocities.iter().map(|u| model.input_index(u.u)).collect();
    let mass = (0..mass.len()).filter(|&v| v < nq || own[v - nq]).map(|v| mass[v]).collect();
    part.quasi_velocities.retain(|u| u.of_joint);
    part.run.independent = None;
    // The rates of a ball's quaternion follow from its angular velocity; what the scene writes in form (2) may as well
    // be rolling: it binds no displacement.
    let of_ball = |node: NodeId| {
        let used = |wanted: bool| {
            let is = |i: usize| named.iter().zip(&own).any(|(n, own)| *n == i && *own == wanted);
            model.graph.depends(&[node], is).contains(&true)
        };
        used(true) && !used(false)
    };
    part.kinematics.retain(|row| match row.form {
        RowForm::Rate(i, node) => !model.coordinates[i].first_order && of_ball(node),
        RowForm::Zero(_) => row.position.is_some(),
    });
    (part, mass)
}
