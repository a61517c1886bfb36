//! States of the first order: coordinates that enter forces only, whose rates need not be linear in the velocities.

use headland_expr::NodeId;

use crate::build::Builder;
use crate::model::RowForm;

impl Builder<'_, '_> {
    /// Marks coordinates whose rate in form (2) is not linear in the velocities, if nothing but forces, outputs and other such
    /// rates depends on them. A coordinate on which a structure or a constraint depends stays one of form (2), and the
    /// derivation refuses its rate.
    pub(crate) fn states_of_first_order(&mut self) {
        let graph = self.low.graph;
        let rates: Vec<(usize, NodeId)> = self.parts.kinematics.iter().filter_map(|r| rate_of(r.form)).collect();
        let open = |(i, _): &&(usize, NodeId)| {
            let c = &self.low.coordinates[*i];
            !c.first_order && c.guess.is_none()
        };
        let candidates: Vec<(usize, NodeId)> = rates.iter().filter(open).copied().collect();
        if candidates.is_empty() {
            return;
        }
        let slot = |node: NodeId| graph.node(node).args[0] as usize;
        let mut is_velocity = vec![false; graph.input_count()];
        let rates_of_coordinates = self.low.coordinates.iter().map(|c| c.rate);
        let velocities: Vec<NodeId> =
            rates_of_coordinates.chain(self.low.quasi_velocities.iter().map(|u| u.u)).collect();
        for v in &velocities {
            is_velocity[slot(*v)] = true;
        }
        let nodes: Vec<NodeId> = candidates.iter().map(|(_, node)| *node).collect();
        let mut states = vec![false; self.low.coordinates.len()];
        let entries = graph.jacobian(&nodes, &velocities);
        let parts: Vec<NodeId> = entries.iter().map(|(.., e)| graph.id(*e)).collect();
        for ((row, ..), depends) in entries.iter().zip(graph.depends(&parts, |i| is_velocity[i])) {
            states[candidates[*row].0] |= depends;
        }
        let needed = graph.needed(&self.what_binds(&states));
        for (c, _) in self.low.coordinates.iter_mut().zip(&states).filter(|(_, is_state)| **is_state) {
            let inputs = [c.q, c.rate, c.acceleration];
            c.first_order = !inputs.iter().any(|n| needed.get(n.index()).copied().unwrap_or(false));
        }
    }

    /// Structures and constraints, and rates that are not among the states.
    fn what_binds(&self, states: &[bool]) -> Vec<NodeId> {
        let parts = &*self.parts;
        let elements = parts.elements.iter().flat_map(|e| [e.structure].into_iter().chain(e.rate));
        let bodies = parts.bodies.iter().flat_map(|b| b.velocity.rate.into_iter().chain(b.spin.rate));
        let loads = parts.loads.iter().flat_map(|l| l.rate);
        let rows = parts.kinematics.iter().filter(|r| !rate_of(r.form).is_some_and(|(i, _)| states[i]));
        let rows = rows.flat_map(|r| {
            let (RowForm::Rate(_, node) | RowForm::Zero(node)) = r.form;
            [node].into_iter().chain(r.position)
        });
        elements.chain(bodies).chain(loads).chain(rows).collect()
    }
}

fn rate_of(form: RowForm) -> Option<(usize, NodeId)> {
    match form {
        RowForm::Rate(i, node) => Some((i, node)),
        RowForm::Zero(_) => None,
    }
}
