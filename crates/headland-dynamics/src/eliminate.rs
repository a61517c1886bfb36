//! Rows of form (1), `A v + a = 0`, solved for dependent velocities: Gaussian elimination with pivots chosen by numbers.
//!
//! The same elimination solves the rows' rates, `A v′ + A′ v + a′ = 0`, for the dependent rates at `u′ = 0`: that is
//! `G′ u + g′` without differentiating quotients.

use headland_expr::{Expr, NodeId};
use headland_model::{Model, RowForm};

use crate::error::DeriveError;
use crate::kinematics::{Solved, depends_on, velocity_inputs, velocity_name};

/// One entry of a row: column, expression, and its number at the state.
type Entry = (usize, NodeId, f64);

/// A row `Σ a_j v_j + c = 0`, `Σ a_j v′_j + d = 0`, sparse in columns.
pub(crate) struct Row {
    /// Position among the model's rows.
    index: usize,
    entries: Vec<Entry>,
    constant: NodeId,
    drift: NodeId,
    /// The velocity that the row gives, for form (2).
    gives: Option<usize>,
}

/// What elimination did: enough to solve the transposed system, `A_depᵀ λ = r`, for the multipliers.
#[derive(Clone, Debug, Default)]
pub struct Factors {
    /// `row target ← row target − factor · row source`, in their order.
    operations: Vec<(usize, usize, NodeId)>,
    /// Pivots `(row, velocity)`, in their order.
    pub(crate) pivots: Vec<(usize, usize)>,
    /// Rows when they were used as pivots: `(velocity, entry)`.
    rows: Vec<Vec<(usize, NodeId)>>,
}

impl Factors {
    /// Pivots that depend on the state, each with its row: where one goes through zero, the rows lose rank.
    pub fn moving_pivots(&self, model: &Model) -> Vec<(usize, NodeId)> {
        let at =
            |&(row, column): &(usize, usize)| self.rows[row].iter().find(|(v, _)| *v == column).map(|(_, a)| (row, *a));
        let moving = |(_, node): &(usize, NodeId)| model.graph.constant_value(*node).is_none();
        self.pivots.iter().filter_map(at).filter(moving).collect()
    }

    /// The multipliers λ of all rows from `r`, one entry a pivot: `A_dep = E⁻¹ U`, so `Uᵀ y = r`, `λ = Eᵀ y`.
    pub(crate) fn solve_transposed<'g>(&self, model: &'g Model, r: &[Expr<'g>]) -> Vec<Expr<'g>> {
        let graph = &model.graph;
        let mut lambda = vec![Expr::Const(0.0); self.rows.len()];
        let at =
            |row: usize, column: usize| self.rows[row].iter().find(|(v, _)| *v == column).map(|(_, a)| graph.expr(*a));
        for (k, &(row, column)) in self.pivots.iter().enumerate() {
            let mut sum = r[k];
            for &(earlier, _) in &self.pivots[..k] {
                if let Some(entry) = at(earlier, column) {
                    sum = sum - entry * lambda[earlier];
                }
            }
            lambda[row] = sum / at(row, column).unwrap_or(Expr::Const(1.0));
        }
        for &(target, source, factor) in self.operations.iter().rev() {
            lambda[source] = lambda[source] - graph.expr(factor) * lambda[target];
        }
        lambda
    }
}

/// A pivot below this part of its row's first size counts as none.
const SINGULAR: f64 = 1e-9;

/// Weight of velocities in the axes of a body: their entries turn with it, so that a pivot that is large now is small
/// soon. A rate takes its place unless that is far smaller.
const BODY_AXES: f64 = 0.25;

/// A row below this part of the largest is measured by it: entries that cancel to rounding are none, whatever their ratio.
const SMALL_ROW: f64 = 1e-4;

/// All rows as `A v + c = 0`; the given nodes are those of the rows.
///
/// # Errors
/// Rows that are not linear.
pub(crate) fn linear_rows(model: &Model, nodes: &[NodeId]) -> Result<Vec<Row>, DeriveError> {
    let graph = &model.graph;
    let columns = columns(model);
    let inputs: Vec<usize> = columns.iter().map(|(_, input)| model.input_index(*input)).collect();
    // the rate of a state of the first order is put in afterwards: here it is nothing
    let zero = graph.id(Expr::Const(0.0));
    let is_state =
        |r: usize| matches!(model.kinematics[r].form, RowForm::Rate(i, _) if model.coordinates[i].first_order);
    let nodes: Vec<NodeId> = (0..nodes.len()).map(|r| if is_state(r) { zero } else { nodes[r] }).collect();
    let nodes = nodes.as_slice();
    let constants = graph.substitute(nodes, |i| inputs.contains(&i).then_some(Expr::Const(0.0)));
    let drifts = row_drifts(model, nodes);
    let mut rows: Vec<Row> = (0..nodes.len())
        .map(|r| {
            let gives = match model.kinematics[r].form {
                RowForm::Rate(i, _) => Some(i),
                RowForm::Zero(_) => None,
            };
            Row { index: r, entries: Vec::new(), constant: graph.id(constants[r]), drift: drifts[r], gives }
        })
        .collect();
    let wanted: Vec<NodeId> = columns.iter().map(|(_, input)| *input).collect();
    for (i, j, a) in graph.jacobian(nodes, &wanted) {
        let node = graph.id(a);
        if let Some(input) = depends_on(model, node, &inputs) {
            let what = format!("the constraint `{}`", model.kinematics[i].name);
            return Err(DeriveError::NotLinear { what, variables: "the rates of the coordinates", input });
        }
        rows[i].entries.push((columns[j].0, node, 0.0));
    }
    for row in &mut rows {
        // q′_i = f(..): -q′_i + f = 0
        if let Some(i) = row.gives {
            let own = row.entries.iter().position(|e| e.0 == i);
            let sum = own.map_or(Expr::Const(0.0), |k| graph.expr(row.entries[k].1)) - Expr::Const(1.0);
            let entry = (i, graph.id(sum), 0.0);
            match own {
                Some(k) => row.entries[k] = entry,
                None => row.entries.push(entry),
            }
        }
    }
    Ok(rows)
}

/// Velocities that may be eliminated: rates of coordinates and velocities of joints; `(velocity, input)`.
fn columns(model: &Model) -> Vec<(usize, NodeId)> {
    let nq = model.coordinates.len();
    let all = velocity_inputs(model).into_iter().enumerate();
    all.filter(|(v, _)| *v < nq || model.quasi_velocities[v - nq].of_joint).map(|(v, (input, _))| (v, input)).collect()
}

/// Each row's rate at v′ = 0, by q and velocities.
fn row_drifts(model: &Model, nodes: &[NodeId]) -> Vec<NodeId> {
    let graph = &model.graph;
    let mut seeds = vec![None; graph.input_count()];
    seeds[model.input_index(model.time)] = Some(Expr::Const(1.0));
    for c in &model.coordinates {
        seeds[model.input_index(c.q)] = Some(graph.expr(c.rate));
    }
    let mut at_rest = vec![false; graph.input_count()];
    for (_, acceleration) in velocity_inputs(model) {
        at_rest[model.input_index(acceleration)] = true;
    }
    let given: Vec<NodeId> = model.kinematics.iter().filter_map(|r| r.rate).collect();
    let mut given = graph.substitute(&given, |i| at_rest[i].then_some(Expr::Const(0.0))).into_iter();
    let other: Vec<NodeId> =
        nodes.iter().zip(&model.kinematics).filter(|(_, r)| r.rate.is_none()).map(|(n, _)| *n).collect();
    let mut other = graph.tangent(&other, |i| seeds[i]).into_iter();
    let pick = |r: &headland_model::KinematicRow| if r.rate.is_some() { given.next() } else { other.next() };
    model.kinematics.iter().map(pick).map(|e| graph.id(e.unwrap_or(Expr::Const(0.0)))).collect()
}

/// Gaussian elimination with pivots chosen by numbers; fills the dependent velocities and their drift.
///
/// # Errors
/// Rows that contradict each other, or that follow from others and must not.
pub(crate) fn eliminate(
    model: &Model,
    mut rows: Vec<Row>,
    inputs: &[f64],
    mass: &[f64],
    solved: &mut Solved,
) -> Result<(), DeriveError> {
    let graph = &model.graph;
    let choice = Choice::new(model, &mut rows, inputs, mass)?;
    let mut order: Vec<(usize, usize)> = Vec::new(); // (row, column)
    let mut open: Vec<usize> = (0..rows.len()).collect();
    let mut operations = Vec::new();
    while !open.is_empty() {
        let Some((row, column)) = choice.pivot(model, &rows, &open) else {
            solved.redundant = choice.redundant(model, &rows, &open, inputs)?;
            break;
        };
        open.retain(|r| *r != row);
        order.push((row, column));
        let pivot_row = std::mem::take(&mut rows[row].entries);
        let (pivot, value) = entry(&pivot_row, column).map_or((Expr::Const(0.0), 0.0), |e| (graph.expr(e.1), e.2));
        for &r in &open {
            let Some(&(_, a, number)) = entry(&rows[r].entries, column) else { continue };
            let (factor, ratio) = (graph.expr(a) / pivot, number / value);
            operations.push((r, row, graph.id(factor)));
            for &(j, a, x) in &pivot_row {
                let (old, y) = entry(&rows[r].entries, j).map_or((Expr::Const(0.0), 0.0), |e| (graph.expr(e.1), e.2));
                let new = if j == column { Expr::Const(0.0) } else { old - factor * graph.expr(a) };
                set(&mut rows[r].entries, (j, graph.id(new), y - ratio * x), new.is(0.0));
            }
            let constant = graph.expr(rows[r].constant) - factor * graph.expr(rows[row].constant);
            rows[r].constant = graph.id(constant);
            let drift = graph.expr(rows[r].drift) - factor * graph.expr(rows[row].drift);
            rows[r].drift = graph.id(drift);
        }
        rows[row].entries = pivot_row;
    }
    substitute_back(model, &rows, &order, solved);
    solved.dependent = order.iter().map(|(_, column)| *column).collect();
    let rows = rows.into_iter().map(|r| r.entries.into_iter().map(|(v, a, _)| (v, a)).collect()).collect();
    solved.factors = Factors { operations, pivots: order, rows };
    Ok(())
}

/// What a row still contains is free or already known.
fn substitute_back(model: &Model, rows: &[Row], order: &[(usize, usize)], solved: &mut Solved) {
    let graph = &model.graph;
    let free = velocity_inputs(model);
    for &(row, column) in order.iter().rev() {
        let (mut sum, mut drift) = (graph.expr(rows[row].constant), graph.expr(rows[row].drift));
        let mut pivot = Expr::Const(1.0);
        for &(j, a, _) in &rows[row].entries {
            if j == column {
                pivot = graph.expr(a);
                continue;
            }
            sum = sum + graph.expr(a) * graph.expr(solved.velocities[j].unwrap_or(free[j].0));
            if let Some(known) = solved.drift[j] {
                drift = drift + graph.expr(a) * graph.expr(known);
            }
        }
        solved.velocities[column] = Some(graph.id(-(sum / pivot)));
        solved.drift[column] = Some(graph.id(-(drift / pivot)));
    }
}

fn entry(row: &[Entry], column: usize) -> Option<&Entry> {
    row.iter().find(|e| e.0 == column)
}

fn set(row: &mut Vec<Entry>, new: Entry, zero: bool) {
    match row.iter().position(|e| e.0 == new.0) {
        Some(k) if zero => {
            row.remove(k);
        }
        Some(k) => row[k] = new,
        None if zero => {}
        None => row.push(new),
    }
}

/// How pivots are chosen: columns scaled by `M^(-1/2)`, rows by their first size.
struct Choice {
    scale: Vec<f64>,
    norms: Vec<f64>,
    allowed: Vec<bool>,
}

impl Choice {
    fn new(model: &Model, rows: &mut [Row], inputs: &[f64], mass: &[f64]) -> Result<Self, DeriveError> {
        let total = velocity_inputs(model).len();
        let mut allowed = vec![true; total];
        if let Some(independent) = &model.run.independent {
            let wanted = total.saturating_sub(rows.len() + named(model));
            if independent.len() != wanted {
                let candidates: Vec<String> = columns(model).iter().map(|(v, _)| velocity_name(model, *v)).collect();
                let (given, candidates) = (independent.len(), candidates.join(", "));
                return Err(DeriveError::WrongIndependent { given, wanted, candidates });
            }
            independent.iter().for_each(|v| allowed[*v] = false);
        }
        let scale: Vec<f64> = mass.iter().map(|m| if *m > 0.0 { 1.0 / m.sqrt() } else { 1.0 }).collect();
        let nodes: Vec<NodeId> = rows.iter().flat_map(|r| r.entries.iter().map(|e| e.1)).collect();
        let mut values = model.graph.eval(&nodes, inputs).into_iter();
        for e in rows.iter_mut().flat_map(|r| &mut r.entries) {
            e.2 = values.next().unwrap_or(f64::NAN);
        }
        let mut choice = Self { scale, norms: Vec::new(), allowed };
        let sizes: Vec<f64> = rows.iter().map(|r| choice.size(r)).collect();
        let least = (SMALL_ROW * sizes.iter().copied().fold(0.0, f64::max)).max(f64::MIN_POSITIVE);
        choice.norms = sizes.into_iter().map(|size| size.max(least)).collect();
        Ok(choice)
    }

    /// Largest scaled entry of a row.
    fn size(&self, row: &Row) -> f64 {
        row.entries.iter().map(|e| (e.2 * self.scale[e.0]).abs()).fold(0.0, f64::max)
    }

    /// Rows that give a rate, then literal ±1, then the largest scaled entry.
    fn pivot(&self, model: &Model, rows: &[Row], open: &[usize]) -> Option<(usize, usize)> {
        let literal = |a: NodeId| model.graph.constant_value(a);
        for &r in open {
            if let Some(i) = rows[r].gives.filter(|&i| self.allowed[i])
                && entry(&rows[r].entries, i).and_then(|e| literal(e.1)) == Some(-1.0)
            {
                return Some((r, i));
            }
        }
        for &r in open {
            let is_one = |e: &&Entry| self.allowed[e.0] && matches!(literal(e.1), Some(x) if x.abs() == 1.0);
            if let Some(e) = rows[r].entries.iter().find(is_one) {
                return Some((r, e.0));
            }
        }
        // Complete pivoting over rows measured by their size before elimination; of equal entries the first wins,
        // whatever the last digits say, so that the same file gives the same choice.
        let mut best = (SINGULAR, None);
        for &r in open {
            for e in rows[r].entries.iter().filter(|e| self.allowed[e.0]) {
                let weight = if e.0 < model.coordinates.len() { 1.0 } else { BODY_AXES };
                let merit = weight * (e.2 * self.scale[e.0]).abs() / self.norms[r];
                if merit > best.0 * (1.0 + 1e-9) {
                    best = (merit, Some((r, e.0)));
                }
            }
        }
        best.1
    }

    /// The rows left without a pivot, if they may be left out.
    fn redundant(
        &self,
        model: &Model,
        rows: &[Row],
        open: &[usize],
        inputs: &[f64],
    ) -> Result<Vec<usize>, DeriveError> {
        let mut found = Vec::new();
        for &r in open {
            let (row, index) = (&rows[r], rows[r].index);
            let residue = self.size(row) / self.norms[r];
            let constant = model.graph.eval(&[row.constant], inputs)[0];
            let consistent = constant.abs() <= 1e-7 * self.norms[r].max(constant.abs() * 1e-3);
            if model.kinematics[index].may_be_redundant && consistent && model.run.independent.is_none() {
                found.push(index);
                continue;
            }
            let how = match (row.entries.is_empty(), model.graph.constant_value(row.constant)) {
                (true, Some(0.0)) => "redundant (it follows from the others)",
                (true, _) => "contradictory (the others leave nothing that could fulfil it)",
                (false, _) => "singular (it follows from the others there, or does not act)",
            };
            return Err(DeriveError::SingularConstraint { name: model.kinematics[index].name.clone(), how, residue });
        }
        Ok(found)
    }
}

/// Named quasi-velocities that are always independent.
fn named(model: &Model) -> usize {
    model.quasi_velocities.iter().filter(|u| !u.of_joint).count()
}
