//! Equations (1) and (2): the rates of all coordinates by the quasi-velocities, `q′ = G(q,t) u + g(q,t)`.
//!
//! Rows in form (2) are taken as they are. Rows in form (1), `A q′ + a = 0`, are solved for dependent rates; the rates
//! left are quasi-velocities. Which rates depend is chosen by numbers, at a state: literal 1 and −1 first, since no
//! parameter can make them vanish, then complete pivoting on columns scaled by `M^(-1/2)`, since m/s and rad/s do not
//! compare.

use headland_expr::{Expr, NodeId};
use headland_model::{Model, RowForm};

use crate::error::DeriveError;

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
    /// The coordinate of which it is the rate, if the program chose it.
    pub rate_of: Option<usize>,
    /// Typical size.
    pub scale: f64,
}

/// The kinematics by quasi-velocities.
#[derive(Clone, Debug)]
pub struct Kinematics {
    /// Quasi-velocities: the named ones, then independent rates.
    pub quasi: Vec<Quasi>,
    /// Rate of each coordinate as an expression of q, u, t.
    pub rates: Vec<NodeId>,
    /// Coordinates whose rates were eliminated, in the order of elimination; empty with form (2) alone.
    pub dependent: Vec<usize>,
    /// Number of velocity constraints: coordinates less quasi-velocities.
    pub constraints: usize,
}

/// A row `Σ a_j q′_j + c = 0`, sparse in columns.
struct Row {
    name: String,
    coefficients: Vec<(usize, NodeId)>,
    constant: NodeId,
    /// The coordinate whose rate the row gives, for form (2).
    gives: Option<usize>,
}

/// Solves the model's kinematics at the state `inputs` (all inputs of the graph, rates ignored).
///
/// `mass` is the diagonal of the unconstrained mass matrix, for the scaling of columns.
///
/// # Errors
/// Rows that are not linear, singular constraints, a wrong choice of `independent`.
pub fn solve_kinematics(model: &Model, inputs: &[f64], mass: &[f64]) -> Result<Kinematics, DeriveError> {
    let graph = &model.graph;
    let rate_inputs: Vec<usize> = model.coordinates.iter().map(|c| model.input_index(c.rate)).collect();
    let is_rate = |i: usize| rate_inputs.contains(&i);
    let nodes: Vec<NodeId> = model
        .kinematics
        .iter()
        .map(|r| match r.form {
            RowForm::Rate(_, n) | RowForm::Zero(n) => n,
        })
        .collect();
    let uses_rates = graph.depends(&nodes, is_rate);
    let explicit =
        model.kinematics.iter().zip(&uses_rates).all(|(r, uses)| matches!(r.form, RowForm::Rate(..)) && !uses);

    let mut rates: Vec<Option<NodeId>> = vec![None; model.coordinates.len()];
    let mut dependent = Vec::new();
    if explicit {
        for row in &model.kinematics {
            if let RowForm::Rate(i, node) = row.form {
                rates[i] = Some(node);
            }
        }
    } else {
        let rows = linear_rows(model, &nodes, &rate_inputs)?;
        dependent = eliminate(model, rows, inputs, mass, &mut rates)?;
    }

    let mut quasi: Vec<Quasi> = model
        .quasi_velocities
        .iter()
        .map(|u| Quasi {
            name: u.name.clone(),
            unit: u.unit.clone(),
            u: u.u,
            acceleration: u.acceleration,
            rate_of: None,
            scale: u.scale,
        })
        .collect();
    for (i, c) in model.coordinates.iter().enumerate() {
        if rates[i].is_none() {
            rates[i] = Some(c.rate);
            quasi.push(Quasi {
                name: format!("{}'", c.name),
                unit: c.rate_unit.clone(),
                u: c.rate,
                acceleration: c.acceleration,
                rate_of: Some(i),
                scale: c.scale,
            });
        }
    }
    let rates: Vec<NodeId> = rates.into_iter().flatten().collect();
    check_linear(model, &quasi, &rates)?;
    if quasi.is_empty() {
        return Err(DeriveError::NoFreedom { coordinates: rates.len(), constraints: model.kinematics.len() });
    }
    let constraints = rates.len().saturating_sub(quasi.len());
    Ok(Kinematics { quasi, rates, dependent, constraints })
}

/// `G` must not contain velocities.
fn check_linear(model: &Model, quasi: &[Quasi], rates: &[NodeId]) -> Result<(), DeriveError> {
    let graph = &model.graph;
    let u_inputs: Vec<usize> = quasi.iter().map(|u| model.input_index(u.u)).collect();
    for u in &u_inputs {
        let column = graph.tangent(rates, |i| (i == *u).then_some(Expr::Const(1.0)));
        let nodes: Vec<NodeId> = column.into_iter().map(|g| graph.id(g)).collect();
        let depends = graph.depends(&nodes, |i| u_inputs.contains(&i));
        if let Some(i) = depends.iter().position(|d| *d) {
            let what = format!("the rate of `{}`", model.coordinates[i].name);
            let input = depends_on(model, nodes[i], &u_inputs).unwrap_or_default();
            return Err(DeriveError::NotLinear { what, variables: "the quasi-velocities", input });
        }
    }
    Ok(())
}

/// The name of one of the inputs on which a node depends.
pub(crate) fn depends_on(model: &Model, node: NodeId, inputs: &[usize]) -> Option<String> {
    let needed = model.graph.needed(&[node]);
    inputs
        .iter()
        .find(|&&i| needed.get(model.graph.input_id(i).index()).copied().unwrap_or(false))
        .map(|&i| model.graph.input_name(i))
}

/// All rows as `A q′ + c = 0`.
fn linear_rows(model: &Model, nodes: &[NodeId], rate_inputs: &[usize]) -> Result<Vec<Row>, DeriveError> {
    let graph = &model.graph;
    let rate_nodes: Vec<NodeId> = model.coordinates.iter().map(|c| c.rate).collect();
    let constants = graph.substitute(nodes, |i| rate_inputs.contains(&i).then_some(Expr::Const(0.0)));
    let mut rows: Vec<Row> = model
        .kinematics
        .iter()
        .zip(constants)
        .map(|(row, constant)| {
            let gives = match row.form {
                RowForm::Rate(i, _) => Some(i),
                RowForm::Zero(_) => None,
            };
            Row { name: row.name.clone(), coefficients: Vec::new(), constant: graph.id(constant), gives }
        })
        .collect();
    for (i, j, a) in graph.jacobian(nodes, &rate_nodes) {
        let node = graph.id(a);
        if let Some(input) = depends_on(model, node, rate_inputs) {
            let what = format!("the constraint `{}`", rows[i].name);
            return Err(DeriveError::NotLinear { what, variables: "the rates of the coordinates", input });
        }
        rows[i].coefficients.push((j, node));
    }
    for row in &mut rows {
        // q′_i = f(..): -q′_i + f = 0
        if let Some(i) = row.gives {
            let own = row.coefficients.iter().position(|(j, _)| *j == i);
            let sum = own.map_or(Expr::Const(0.0), |k| graph.expr(row.coefficients[k].1)) - Expr::Const(1.0);
            let entry = (i, graph.id(sum));
            match own {
                Some(k) => row.coefficients[k] = entry,
                None => row.coefficients.push(entry),
            }
        }
    }
    Ok(rows)
}

/// Gaussian elimination with pivots chosen by numbers; fills the dependent rates and gives their order.
fn eliminate(
    model: &Model,
    mut rows: Vec<Row>,
    inputs: &[f64],
    mass: &[f64],
    rates: &mut [Option<NodeId>],
) -> Result<Vec<usize>, DeriveError> {
    let graph = &model.graph;
    let count = rows.len();
    let independent = model.run.independent.clone().unwrap_or_default();
    if model.run.independent.is_some() && independent.len() + count != rates.len() {
        let candidates: Vec<String> = model.coordinates.iter().map(|c| format!("{}'", c.name)).collect();
        return Err(DeriveError::WrongIndependent {
            given: independent.len(),
            wanted: rates.len().saturating_sub(count),
            candidates: candidates.join(", "),
        });
    }
    let scale: Vec<f64> = mass.iter().map(|m| if *m > 0.0 { 1.0 / m.sqrt() } else { 1.0 }).collect();
    let norms: Vec<f64> = rows
        .iter()
        .map(|r| scaled_entries(model, &r.coefficients, inputs, &scale).into_iter().fold(f64::MIN_POSITIVE, f64::max))
        .collect();
    let mut order: Vec<(usize, usize)> = Vec::new(); // (row, column)
    let mut open: Vec<usize> = (0..count).collect();
    while !open.is_empty() {
        let (row, column) = choose_pivot(model, &rows, &open, inputs, &scale, &norms, &independent)?;
        open.retain(|r| *r != row);
        order.push((row, column));
        let pivot_row = rows[row].coefficients.clone();
        let pivot = find(&pivot_row, column).map_or(Expr::Const(0.0), |id| graph.expr(id));
        for &r in &open {
            let Some(entry) = find(&rows[r].coefficients, column) else { continue };
            let factor = graph.expr(entry) / pivot;
            for &(j, a) in &pivot_row {
                let old = find(&rows[r].coefficients, j).map_or(Expr::Const(0.0), |id| graph.expr(id));
                let new = if j == column { Expr::Const(0.0) } else { old - factor * graph.expr(a) };
                set(&mut rows[r].coefficients, j, graph.id(new), new.is(0.0));
            }
            let constant = graph.expr(rows[r].constant) - factor * graph.expr(rows[row].constant);
            rows[r].constant = graph.id(constant);
        }
    }
    // Back substitution: what a row still contains is free or already known.
    for &(row, column) in order.iter().rev() {
        let mut sum = graph.expr(rows[row].constant);
        let mut pivot = Expr::Const(1.0);
        for &(j, a) in &rows[row].coefficients {
            if j == column {
                pivot = graph.expr(a);
            } else {
                sum = sum + graph.expr(a) * graph.expr(rates[j].unwrap_or(model.coordinates[j].rate));
            }
        }
        rates[column] = Some(graph.id(-(sum / pivot)));
    }
    Ok(order.into_iter().map(|(_, column)| column).collect())
}

fn find(row: &[(usize, NodeId)], column: usize) -> Option<NodeId> {
    row.iter().find(|(j, _)| *j == column).map(|(_, a)| *a)
}

fn set(row: &mut Vec<(usize, NodeId)>, column: usize, a: NodeId, zero: bool) {
    match row.iter().position(|(j, _)| *j == column) {
        Some(k) if zero => {
            row.remove(k);
        }
        Some(k) => row[k].1 = a,
        None if zero => {}
        None => row.push((column, a)),
    }
}

/// Rows that give a rate, then literal ±1, then the largest scaled entry.
fn choose_pivot(
    model: &Model,
    rows: &[Row],
    open: &[usize],
    inputs: &[f64],
    scale: &[f64],
    norms: &[f64],
    independent: &[usize],
) -> Result<(usize, usize), DeriveError> {
    let graph = &model.graph;
    let allowed = |j: usize| !independent.contains(&j);
    for &r in open {
        if let Some(i) = rows[r].gives.filter(|&i| allowed(i))
            && find(&rows[r].coefficients, i).and_then(|a| graph.constant_value(a)) == Some(-1.0)
        {
            return Ok((r, i));
        }
    }
    let literal = |a: NodeId| matches!(graph.constant_value(a), Some(x) if x.abs() == 1.0);
    for &r in open {
        if let Some((j, _)) = rows[r].coefficients.iter().find(|(j, a)| allowed(*j) && literal(*a)) {
            return Ok((r, *j));
        }
    }
    // Complete pivoting over rows measured by their size before elimination; of equal entries the first wins, whatever
    // the last digits say, so that the same file gives the same choice.
    let mut best = (1e-10, None);
    for &r in open {
        for (k, size) in scaled_entries(model, &rows[r].coefficients, inputs, scale).into_iter().enumerate() {
            let (merit, j) = (size / norms[r], rows[r].coefficients[k].0);
            if allowed(j) && merit > best.0 * (1.0 + 1e-9) {
                best = (merit, Some((r, j)));
            }
        }
    }
    if let (_, Some(pivot)) = best {
        return Ok(pivot);
    }
    let r = open[0];
    let residue = scaled_entries(model, &rows[r].coefficients, inputs, scale).into_iter().fold(0.0, f64::max);
    let how = match (rows[r].coefficients.is_empty(), graph.constant_value(rows[r].constant)) {
        (true, Some(0.0)) => "redundant (it follows from the others)",
        (true, _) => "contradictory (the others leave nothing that could fulfil it)",
        (false, _) => "singular (it follows from the others there, or does not act)",
    };
    Err(DeriveError::SingularConstraint { name: rows[r].name.clone(), how, residue: residue / norms[r] })
}

/// `|a_j|` times the column's scale.
fn scaled_entries(model: &Model, row: &[(usize, NodeId)], inputs: &[f64], scale: &[f64]) -> Vec<f64> {
    let nodes: Vec<NodeId> = row.iter().map(|(_, a)| *a).collect();
    let values = model.graph.eval(&nodes, inputs);
    values.iter().zip(row).map(|(a, (j, _))| (a * scale[*j]).abs()).collect()
}
