//! Initial values: coordinates as given or as the constraints on positions want them, quasi-velocities from the initial
//! rates and the constraints.

mod conflict;

use headland_expr::NodeId;
use headland_model::Model;
use nalgebra::{DMatrix, DVector};

use crate::error::DeriveError;
use crate::kinematics::{Kinematics, velocity_name};
use crate::sample::{Spread, start_inputs};

/// `G` and `g` as numbers at the given inputs: column k of G is the velocities at `u = e_k` less those at `u = 0`. Rows of
/// states of the first order, which need not be linear, are zero.
pub fn kinematic_matrices(model: &Model, kinematics: &Kinematics, inputs: &[f64]) -> (DMatrix<f64>, DVector<f64>) {
    let mut x = inputs.to_vec();
    let slots: Vec<usize> = kinematics.quasi.iter().map(|u| model.input_index(u.u)).collect();
    for &slot in &slots {
        x[slot] = 0.0;
    }
    let drift = DVector::from_vec(model.graph.eval(&kinematics.velocities, &x));
    let mut g = DMatrix::zeros(drift.len(), slots.len());
    for (k, &slot) in slots.iter().enumerate() {
        x[slot] = 1.0;
        let column = DVector::from_vec(model.graph.eval(&kinematics.velocities, &x)) - &drift;
        g.set_column(k, &column);
        x[slot] = 0.0;
    }
    let mut drift = drift;
    for (i, _) in model.coordinates.iter().enumerate().filter(|(_, c)| c.first_order) {
        g.row_mut(i).fill(0.0);
        drift[i] = 0.0;
    }
    (g, drift)
}

/// A coordinate that was moved to fulfil the constraints at the start.
#[derive(Clone, Debug)]
pub struct Moved {
    /// Its name.
    pub name: String,
    /// As given, or as guessed.
    pub from: f64,
    /// As it is now.
    pub to: f64,
}

/// The inputs of the graph at the start with all constraints on positions fulfilled, and the given coordinates that had
/// to be moved for that. Coordinates that were not given are found; others move only if that does not suffice.
///
/// # Errors
/// [`DeriveError::CannotAssemble`] names the constraints that conflict.
pub fn assemble(model: &Model) -> Result<(Vec<f64>, Vec<Moved>), DeriveError> {
    let start = start_inputs(model);
    let positions = Positions::new(model);
    if positions.rows.is_empty() || positions.residual(&start) <= SMALL {
        return Ok((start, Vec::new()));
    }
    let free: Vec<usize> = (0..model.coordinates.len()).filter(|&i| model.coordinates[i].initial.is_none()).collect();
    let all: Vec<usize> = (0..model.coordinates.len()).collect();
    let mut found = None;
    for columns in [free, all] {
        if columns.is_empty() {
            continue;
        }
        // stretched or folded linkages are stationary places of the search: then it begins a little beside, at several
        found = (0..10).find_map(|attempt: u32| {
            let mut inputs = start.clone();
            let mut spread = Spread::new(attempt);
            for &i in columns.iter().filter(|_| attempt > 1) {
                inputs[model.input_index(model.coordinates[i].q)] += 0.3 * spread.next_number();
            }
            positions.solve(&mut inputs, &columns, attempt != 1).then_some(inputs)
        });
        if found.is_some() {
            break;
        }
    }
    let inputs = match found {
        Some(inputs) => inputs,
        None => conflict::nearest(&positions, &start)?,
    };
    let moved = model.coordinates.iter().filter(|c| c.initial.is_some()).filter_map(|c| {
        let slot = model.input_index(c.q);
        let (from, to) = (start[slot], inputs[slot]);
        ((to - from).abs() > 1e-12 * from.abs().max(1.0)).then(|| Moved { name: c.name.clone(), from, to })
    });
    let moved = moved.collect();
    Ok((inputs, moved))
}

/// A residual of constraints on positions that counts as none.
const SMALL: f64 = 1e-13;

/// Constraints on positions, for Newton's method.
pub struct Positions<'m> {
    model: &'m Model,
    /// `φ(q, t)`
    pub rows: Vec<NodeId>,
    names: Vec<&'m str>,
    /// Entries `(row, coordinate, node)` of `∂φ/∂q`.
    entries: Vec<(usize, usize, NodeId)>,
}

impl<'m> Positions<'m> {
    /// Of a model.
    pub fn new(model: &'m Model) -> Self {
        let holonomic = model.kinematics.iter().filter_map(|r| Some((r.position?, r.name.as_str())));
        let (rows, names): (Vec<NodeId>, Vec<&str>) = holonomic.unzip();
        let wanted: Vec<NodeId> = model.coordinates.iter().map(|c| c.q).collect();
        let entries = model.graph.jacobian(&rows, &wanted).into_iter().map(|(i, j, e)| (i, j, model.graph.id(e)));
        let entries = entries.collect();
        Self { model, rows, names, entries }
    }

    /// `φ` at the given inputs.
    fn values(&self, inputs: &[f64]) -> Vec<f64> {
        self.model.graph.eval(&self.rows, inputs)
    }

    /// Largest residual.
    pub fn residual(&self, inputs: &[f64]) -> f64 {
        self.values(inputs).into_iter().fold(0.0, |worst, x| if x.is_nan() { x } else { worst.max(x.abs()) })
    }

    /// Newton's method with least changes of the given coordinates; false if it does not converge.
    ///
    /// Away from their solutions, constraints of which some are redundant seem to determine also what moves freely. Damped by
    /// their residual, the search does not run off along that; it still converges quadratically (Yamashita & Fukushima, *On
    /// the rate of convergence of the Levenberg-Marquardt method*, 2001).
    fn solve(&self, inputs: &mut Vec<f64>, columns: &[usize], damped: bool) -> bool {
        let slots: Vec<usize> = columns.iter().map(|&i| self.model.input_index(self.model.coordinates[i].q)).collect();
        let mut residual = self.residual(inputs);
        for _ in 0..60 {
            let phi = DVector::from_vec(self.model.graph.eval(&self.rows, inputs));
            let jacobian = self.jacobian(inputs, columns);
            let largest = jacobian.amax();
            let damping = if damped { phi.norm() * largest } else { 0.0 };
            let Some(step) = damped_solution(jacobian, &phi, 1e-9 * largest.max(1e-300), damping) else { return false };
            let mut factor = 1.0;
            loop {
                let mut trial = inputs.clone();
                slots.iter().zip(step.iter()).for_each(|(&slot, d)| trial[slot] -= factor * d);
                let next = self.residual(&trial);
                if next < residual || (factor == 1.0 && next <= SMALL) {
                    (*inputs, residual) = (trial, next);
                    break;
                }
                factor *= 0.5;
                if factor < 1e-6 {
                    return residual <= 1e-10;
                }
            }
            if residual <= 1e-16 {
                return true;
            }
        }
        residual <= 1e-10
    }

    fn jacobian(&self, inputs: &[f64], columns: &[usize]) -> DMatrix<f64> {
        let values = self.model.graph.eval(&self.entries.iter().map(|(.., n)| *n).collect::<Vec<_>>(), inputs);
        let mut jacobian = DMatrix::zeros(self.rows.len(), columns.len());
        for (&(i, j, _), x) in self.entries.iter().zip(values) {
            if let Some(c) = columns.iter().position(|k| *k == j) {
                jacobian[(i, c)] = x;
            }
        }
        jacobian
    }
}

/// `Σ v σ/(σ² + damping) u·b` over the singular values above the limit.
fn damped_solution(a: DMatrix<f64>, b: &DVector<f64>, limit: f64, damping: f64) -> Option<DVector<f64>> {
    if a.iter().chain(b.iter()).any(|x| !x.is_finite()) {
        return None;
    }
    let svd = a.svd(true, true);
    let (u, v_t) = (svd.u.as_ref()?, svd.v_t.as_ref()?);
    let mut x = DVector::zeros(v_t.ncols());
    for (k, s) in svd.singular_values.iter().enumerate().filter(|(_, s)| **s > limit) {
        x += v_t.row(k).transpose() * (u.column(k).dot(b) * s / (s * s + damping));
    }
    Some(x)
}

/// Initial quasi-velocities: the named ones as given; independent rates and velocities of joints from all that is given
/// by least squares. What the given ones leave open must be given too, or is as slow as possible where joints have it:
/// the smallest `Σ m v²` over all velocities with the masses that they move.
///
/// # Errors
/// Rates that do not determine the motion, or that contradict the constraints or each other.
pub fn initial_velocities(model: &Model, kinematics: &Kinematics) -> Result<Vec<f64>, DeriveError> {
    let inputs = &assemble(model)?.0;
    check_defined(model, inputs)?;
    let (g, drift) = kinematic_matrices(model, kinematics, inputs);
    let mut u: Vec<f64> = kinematics.quasi.iter().map(|u| inputs[model.input_index(u.u)]).collect();
    let free: Vec<usize> = (0..u.len()).filter(|&k| kinematics.quasi[k].chosen).collect();
    for &k in &free {
        u[k] = 0.0;
    }
    let given = given_velocities(model, inputs);
    let known = |i: usize, u: &[f64]| drift[i] + (0..u.len()).map(|k| g[(i, k)] * u[k]).sum::<f64>();
    if !free.is_empty() {
        let a = DMatrix::from_fn(given.len(), free.len(), |r, c| g[(given[r].0, free[c])]);
        let b = DVector::from_fn(given.len(), |r, _| given[r].1 - known(given[r].0, &u));
        let (mut solution, null) = least_squares(a, b);
        if null.ncols() > 0 {
            if !model.coordinates.iter().any(|c| c.guess.is_some()) {
                return Err(too_few(model, kinematics, &g, &given, &free, &null));
            }
            // u + N z with the least weighted velocities
            let weight = |v: usize| kinematics.mass[v].max(1e-12).sqrt();
            let all = DMatrix::from_fn(g.nrows(), free.len(), |v, c| weight(v) * g[(v, free[c])]);
            let rest = DVector::from_fn(g.nrows(), |v, _| weight(v) * known(v, &u)) + &all * &solution;
            let reduced = &all * &null;
            let largest = reduced.amax().max(1e-300);
            if let Ok(z) = reduced.svd(true, true).solve(&(-rest), 1e-12 * largest) {
                solution += null * z;
            }
        }
        for (&k, value) in free.iter().zip(solution.iter()) {
            u[k] = *value;
        }
    }
    let size = given.iter().map(|(_, x)| x.abs()).fold(1.0, f64::max);
    for &(i, x) in &given {
        let found = known(i, &u);
        if (found - x).abs() > 1e-8 * size {
            return Err(DeriveError::InconsistentStart { name: velocity_name(model, i), given: x, found });
        }
    }
    Ok(u)
}

/// Refuses a state at which the equations are not defined.
pub(crate) fn check_defined(model: &Model, inputs: &[f64]) -> Result<(), DeriveError> {
    match model.hazard(inputs) {
        None => Ok(()),
        Some(h) => Err(DeriveError::Undefined { message: h.message.clone(), place: h.place.clone() }),
    }
}

/// Velocities that the start gives: rates of coordinates and velocities of joints.
fn given_velocities(model: &Model, inputs: &[f64]) -> Vec<(usize, f64)> {
    let nq = model.coordinates.len();
    let rates = model.coordinates.iter().enumerate().filter_map(|(i, c)| Some((i, c.initial_rate?)));
    let joints = model.quasi_velocities.iter().enumerate().filter(|(_, u)| u.of_joint);
    let joints = joints.filter_map(|(k, u)| Some((nq + k, u.initial?)));
    rates.chain(joints).map(|(v, node)| (v, model.graph.eval(&[node], inputs)[0])).collect()
}

fn too_few(
    model: &Model,
    kinematics: &Kinematics,
    g: &DMatrix<f64>,
    given: &[(usize, f64)],
    free: &[usize],
    null: &DMatrix<f64>,
) -> DeriveError {
    let null = null.column(0);
    let missing = null.iter().enumerate().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs())).map_or(0, |(i, _)| i);
    let names: Vec<String> = given.iter().map(|(i, _)| format!("`{}`", velocity_name(model, *i))).collect();
    let candidates: Vec<String> = (0..model.coordinates.len())
        .filter(|&i| free.iter().zip(null.iter()).map(|(&k, n)| g[(i, k)] * n).sum::<f64>().abs() > 1e-9)
        .take(8)
        .map(|i| format!("`{}`", velocity_name(model, i)))
        .collect();
    DeriveError::TooFewInitialRates {
        given: if names.is_empty() { "none".into() } else { names.join(", ") },
        missing: format!("`{}`", kinematics.quasi[free[missing]].name),
        candidates: candidates.join(", "),
    }
}

/// The shortest least-squares solution, and what the matrix does not see, as columns.
fn least_squares(a: DMatrix<f64>, b: DVector<f64>) -> (DVector<f64>, DMatrix<f64>) {
    let n = a.ncols();
    let mut square = DMatrix::zeros(a.nrows().max(n), n);
    square.view_mut((0, 0), (a.nrows(), n)).copy_from(&a);
    let mut rhs = DVector::zeros(square.nrows());
    rhs.rows_mut(0, b.len()).copy_from(&b);
    let svd = square.svd(true, true);
    let largest = svd.singular_values.max();
    let limit = 1e-10 * largest.max(1e-300);
    let unseen: Vec<usize> = (0..n).filter(|&k| svd.singular_values[k] <= limit).collect();
    let null = match &svd.v_t {
        Some(v_t) => DMatrix::from_fn(n, unseen.len(), |i, k| v_t[(unseen[k], i)]),
        None => DMatrix::zeros(n, 0),
    };
    (svd.solve(&rhs, limit).unwrap_or_else(|_| DVector::zeros(n)), null)
}
