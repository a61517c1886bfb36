//! Which constraints on positions cannot hold together.
//!
//! ```text
//! min Σ (φ_i/s_i)²:   Jᵀ φ = 0        J, φ: rows divided by their first lengths s
//! ```
//! Where the sum of squares is least, what is left of the constraints is itself a combination of rows that no motion
//! changes: by Fredholm's alternative it proves that they contradict each other there, and rows with nothing left have no
//! part in it. Sets that share no coordinate are conflicts of their own.

use headland_model::Model;
use nalgebra::{DMatrix, DVector};

use super::{Positions, damped_solution};
use crate::error::DeriveError;

/// Part of the largest residual below which a constraint has none.
const NONE_LEFT: f64 = 1e-5;

/// The state with the least squares of residuals, if that fulfils the constraints after all.
///
/// # Errors
/// [`DeriveError::CannotAssemble`] with what is left and of which.
pub(super) fn nearest(positions: &Positions<'_>, start: &[f64]) -> Result<Vec<f64>, DeriveError> {
    let all: Vec<usize> = (0..positions.model.coordinates.len()).collect();
    let mut inputs = start.to_vec();
    let jacobian = positions.jacobian(&inputs, &all);
    let largest = jacobian.amax().max(f64::MIN_POSITIVE);
    let scale: Vec<f64> = jacobian.row_iter().map(|row| 1.0 / row.norm().max(1e-6 * largest)).collect();
    let at = |inputs: &[f64]| -> (DMatrix<f64>, DVector<f64>) {
        let (mut jacobian, phi) = (positions.jacobian(inputs, &all), positions.values(inputs));
        jacobian.row_iter_mut().zip(&scale).for_each(|(mut row, s)| row *= *s);
        (jacobian, DVector::from_fn(phi.len(), |i, _| phi[i] * scale[i]))
    };
    descend(positions.model, &mut inputs, &at);
    let (jacobian, phi) = at(&inputs);
    if phi.amax() <= 1e-6 && positions.solve(&mut inputs, &all, true) {
        return Ok(inputs);
    }
    let part = |i: usize| phi[i].is_nan() || phi[i].abs() > NONE_LEFT * phi.amax();
    let rows: Vec<usize> = (0..phi.len()).filter(|&i| part(i)).collect();
    let say = |&i: &usize| format!("`{}` by {:.3}", positions.names[i], phi[i].abs() / scale[i]);
    let sets = connected(&jacobian, &rows);
    let sets: Vec<String> = sets.iter().map(|set| set.iter().map(say).collect::<Vec<_>>().join(" with ")).collect();
    Err(DeriveError::CannotAssemble { rows: sets.join("; ") })
}

/// Levenberg's and Marquardt's method until the gradient is none.
fn descend(model: &Model, inputs: &mut Vec<f64>, at: &impl Fn(&[f64]) -> (DMatrix<f64>, DVector<f64>)) {
    let slots: Vec<usize> = model.coordinates.iter().map(|c| model.input_index(c.q)).collect();
    let (mut jacobian, mut phi) = at(inputs);
    let mut damping = 1e-3;
    for _ in 0..500 {
        if jacobian.tr_mul(&phi).norm() <= 1e-10 * jacobian.norm() * phi.norm() || phi.norm() < 1e-14 {
            return;
        }
        let Some(step) = damped_solution(jacobian.clone(), &phi, 0.0, damping) else { return };
        let mut trial = inputs.clone();
        slots.iter().zip(step.iter()).for_each(|(&slot, d)| trial[slot] -= d);
        let (next_jacobian, next) = at(&trial);
        if next.norm() < phi.norm() {
            (*inputs, jacobian, phi) = (trial, next_jacobian, next);
            damping = (0.2 * damping).max(1e-12);
        } else {
            damping *= 4.0;
            if damping > 1e12 {
                return;
            }
        }
    }
}

/// The rows in sets that have coordinates in common.
fn connected(jacobian: &DMatrix<f64>, rows: &[usize]) -> Vec<Vec<usize>> {
    let mut sets: Vec<Vec<usize>> = Vec::new();
    for &row in rows {
        let shares = |set: &Vec<usize>| {
            set.iter().any(|&other| (0..jacobian.ncols()).any(|j| jacobian[(row, j)] * jacobian[(other, j)] != 0.0))
        };
        let (joined, mut apart): (Vec<_>, Vec<_>) = sets.into_iter().partition(|set| shares(set));
        apart.push(joined.into_iter().flatten().chain([row]).collect());
        sets = apart;
    }
    sets
}
