//! v′ and λ that belong to a state `[q, v]`, for outputs of a run by IDA.
//!
//! ```text
//! [ H  −Aᵀ ] [v′]     [ −h         ]
//! [ A   0  ] [λ ]  =  [ −A′ v − a′ ]
//! ```
//! IDA's own v′ are the derivative of its formula and its λ are left out of the error test: both are less accurate than the
//! state. What follows from the state is as accurate as that.

use headland_code::{Evaluator, Function, Jacobian, TapeEvaluator, TapeFunction};
use headland_expr::{Graph, NodeId};
use nalgebra::{DMatrix, DVector};

/// A pivot, of rows and columns of size one, below which the constraints count as dependent.
const RANK: f64 = 1e-10;

/// The linear equations, compiled over `x = [t, q, v, v′, λ, ..]`.
pub(crate) struct Rates {
    residual: TapeFunction,
    matrix: Jacobian<TapeFunction>,
    /// Where v′ and λ are in x.
    first: usize,
    velocities: usize,
}

impl Rates {
    /// From the equations `H v′ + h − Aᵀ λ` and `A v′ + A′ v + a′`; v′ begin at `first` in x, λ follow.
    pub(crate) fn new(graph: &Graph, equations: &[NodeId], first: usize, velocities: usize) -> Self {
        let unknowns: Vec<NodeId> = (first..first + equations.len()).map(|i| graph.input_id(i)).collect();
        let matrix = Jacobian::<TapeFunction>::new(graph, equations, &unknowns);
        Self { residual: TapeFunction::compile(graph, equations), matrix, first, velocities }
    }

    /// One thread's scratch.
    pub(crate) fn scratch(&self) -> RatesScratch {
        RatesScratch { residual: self.residual.evaluator(), matrix: self.matrix.function().evaluator() }
    }
}

/// Evaluators of [`Rates`].
pub(crate) struct RatesScratch {
    residual: TapeEvaluator,
    matrix: TapeEvaluator,
}

impl RatesScratch {
    /// Puts v′ and λ into x. Where the constraints are dependent, they stay as they are.
    pub(crate) fn solve(&mut self, rates: &Rates, x: &mut [f64]) {
        let n = rates.residual.outputs();
        let span = rates.first..rates.first + n;
        let before = x[span.clone()].to_vec();
        x[span.clone()].fill(0.0);
        let b = DVector::from_iterator(n, self.residual.eval(x).iter().map(|r| -r));
        let dense = rates.matrix.dense(self.matrix.eval(x));
        let solution = scaled_solution(&DMatrix::from_column_slice(n, n, &dense), &b, rates.velocities);
        match solution {
            Some(found) => x[span].copy_from_slice(found.as_slice()),
            None => x[span].copy_from_slice(&before),
        }
    }
}

/// Solves with rows and columns scaled: velocities by their inertia, constraints by what is left of their rows.
fn scaled_solution(a: &DMatrix<f64>, b: &DVector<f64>, velocities: usize) -> Option<DVector<f64>> {
    let n = b.len();
    let of_size = |x: f64| if x > 0.0 { 1.0 / x } else { 1.0 };
    let mut scale: Vec<f64> = (0..velocities).map(|i| of_size(a[(i, i)].sqrt())).collect();
    for k in velocities..n {
        scale.push(of_size((0..velocities).map(|j| (a[(k, j)] * scale[j]).powi(2)).sum::<f64>().sqrt()));
    }
    let scaled = DMatrix::from_fn(n, n, |i, j| scale[i] * a[(i, j)] * scale[j]);
    let lu = scaled.clone().full_piv_lu();
    let u = lu.u();
    if (0..n).any(|i| u[(i, i)].abs().is_nan() || u[(i, i)].abs() < RANK) {
        return None;
    }
    let b = DVector::from_fn(n, |i, _| scale[i] * b[i]);
    let mut x = lu.solve(&b)?;
    for _ in 0..2 {
        // a small acceleration between large forces is what is left of their difference, without this
        x += lu.solve(&(&b - &scaled * &x))?;
    }
    x.iter_mut().zip(&scale).for_each(|(x, s)| *x *= s);
    x.iter().all(|x| x.is_finite()).then_some(x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_and_redundant_rows() {
        // two masses of very different size held together: (m1 + m2) v′ = F, λ = what moves the second
        let (m1, m2, force) = (1e-6, 1e6, 3.0);
        let a = DMatrix::from_row_slice(3, 3, &[m1, 0.0, -1.0, 0.0, m2, 1.0, 1.0, -1.0, 0.0]);
        let b = DVector::from_row_slice(&[force, 0.0, 0.0]);
        let x = scaled_solution(&a, &b, 2).expect("regular");
        let expected = [force / (m1 + m2), force / (m1 + m2), -force * m2 / (m1 + m2)];
        for (x, e) in x.iter().zip(expected) {
            assert!((x - e).abs() < 1e-13 * e.abs(), "{x} for {e}");
        }
        let twice = DMatrix::from_row_slice(3, 3, &[1.0, -1.0, -1.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0]);
        assert!(scaled_solution(&twice, &b, 1).is_none());
    }
}
