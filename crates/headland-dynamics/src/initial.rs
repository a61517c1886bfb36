//! Initial values: coordinates as given, quasi-velocities from the initial rates and the constraints.

use headland_model::Model;
use nalgebra::{DMatrix, DVector};

use crate::error::DeriveError;
use crate::kinematics::Kinematics;
use crate::sample::start_inputs;

/// `G` and `g` as numbers at the given inputs: column k of G is the velocities at `u = e_k` less those at `u = 0`.
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
    (g, drift)
}

/// Initial quasi-velocities: the named ones as given, independent rates from all initial rates by least squares.
///
/// # Errors
/// Rates that do not determine the motion, or that contradict the constraints or each other.
pub fn initial_velocities(model: &Model, kinematics: &Kinematics) -> Result<Vec<f64>, DeriveError> {
    let inputs = start_inputs(model);
    let (g, drift) = kinematic_matrices(model, kinematics, &inputs);
    let mut u: Vec<f64> = kinematics.quasi.iter().map(|u| inputs[model.input_index(u.u)]).collect();
    let free: Vec<usize> = (0..u.len()).filter(|&k| kinematics.quasi[k].chosen).collect();
    for &k in &free {
        u[k] = 0.0;
    }
    let given: Vec<(usize, f64)> = model
        .coordinates
        .iter()
        .enumerate()
        .filter_map(|(i, c)| c.initial_rate.map(|r| (i, model.graph.eval(&[r], &inputs)[0])))
        .collect();
    let known = |i: usize, u: &[f64]| drift[i] + (0..u.len()).map(|k| g[(i, k)] * u[k]).sum::<f64>();
    if !free.is_empty() {
        let a = DMatrix::from_fn(given.len(), free.len(), |r, c| g[(given[r].0, free[c])]);
        let b = DVector::from_fn(given.len(), |r, _| given[r].1 - known(given[r].0, &u));
        let solution = least_squares(a, b).map_err(|null| {
            let missing = null.iter().enumerate().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs())).map_or(0, |(i, _)| i);
            let names: Vec<&str> = given.iter().map(|(i, _)| model.coordinates[*i].name.as_str()).collect();
            let candidates: Vec<String> = (0..model.coordinates.len())
                .filter(|&i| free.iter().zip(null.iter()).map(|(&k, n)| g[(i, k)] * n).sum::<f64>().abs() > 1e-9)
                .take(8)
                .map(|i| format!("`{}'`", model.coordinates[i].name))
                .collect();
            DeriveError::TooFewInitialRates {
                given: if names.is_empty() {
                    "none".into()
                } else {
                    names.iter().map(|n| format!("`{n}'`")).collect::<Vec<_>>().join(", ")
                },
                missing: format!("`{}`", kinematics.quasi[free[missing]].name),
                candidates: candidates.join(", "),
            }
        })?;
        for (&k, value) in free.iter().zip(solution.iter()) {
            u[k] = *value;
        }
    }
    let size = given.iter().map(|(_, x)| x.abs()).fold(1.0, f64::max);
    for &(i, x) in &given {
        let found = known(i, &u);
        if (found - x).abs() > 1e-8 * size {
            let name = format!("{}'", model.coordinates[i].name);
            return Err(DeriveError::InconsistentStart { name, given: x, found });
        }
    }
    Ok(u)
}

/// The least-squares solution, or a vector that the matrix does not see.
fn least_squares(a: DMatrix<f64>, b: DVector<f64>) -> Result<DVector<f64>, DVector<f64>> {
    let n = a.ncols();
    let mut square = DMatrix::zeros(a.nrows().max(n), n);
    square.view_mut((0, 0), (a.nrows(), n)).copy_from(&a);
    let mut rhs = DVector::zeros(square.nrows());
    rhs.rows_mut(0, b.len()).copy_from(&b);
    let svd = square.svd(true, true);
    let largest = svd.singular_values.max();
    if let Some(k) = svd.singular_values.iter().position(|s| *s <= 1e-10 * largest.max(1e-300))
        && let Some(v_t) = &svd.v_t
    {
        return Err(v_t.row(k).transpose());
    }
    svd.solve(&rhs, 1e-12 * largest).map_err(|_| DVector::zeros(n))
}
