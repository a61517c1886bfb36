//! Names by which outputs, guards and events can ask how well a single constraint is fulfilled.

use crate::build::Builder;
use crate::dimension::Dimension;
use crate::lower::{Typed, per_time};
use crate::model::RowForm;

impl Builder<'_, '_> {
    /// `NAME.residual` of constraints on positions, `NAME.rate_residual` of all: what must be zero, as the state has it.
    ///
    /// A joint on the tree has the same names as one that closes a loop: its coordinates hold it, and they are zero.
    pub(crate) fn publish_residuals(&mut self) {
        let graph = self.low.graph;
        let typed = |expr, dimension: Dimension| Typed { expr, ..Typed::number(0.0, dimension) };
        let mut names = Vec::new();
        for row in &self.parts.kinematics {
            let RowForm::Zero(velocity) = row.form else { continue };
            let name = row.name.replace(' ', "_");
            if let Some(position) = row.position {
                let dimension = &row.dimension + &Dimension::time();
                names.push((format!("{name}.residual"), typed(graph.expr(position), dimension)));
            }
            names.push((format!("{name}.rate_residual"), typed(graph.expr(velocity), row.dimension.clone())));
        }
        for (name, is_turn) in self.rows_of_joints() {
            let dimension = Dimension::of(0, if is_turn { 0 } else { 1 }, 0);
            names.push((format!("{name}.rate_residual"), Typed::number(0.0, per_time(&dimension, 1))));
            names.push((format!("{name}.residual"), Typed::number(0.0, dimension)));
        }
        for (name, residual) in names {
            self.low.totals.entry(name).or_insert(residual);
        }
    }
}
