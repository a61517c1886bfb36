//! [`Positions`]: constraints on positions compiled, and the projection of a state onto them.
//!
//! ```text
//! φ(q, t) = 0,   J = ∂φ/∂q:     q ← q − Jᵀ (J Jᵀ)⁺ φ,   until φ is rounding
//! ```
//! The shortest correction. `J Jᵀ` is factored with pivoting and cut off at its rank, so that redundant constraints do no
//! harm. Drift within a step is far below the step's error: the correction is of that size.

use headland_code::{Evaluator, Function, Jacobian, TapeEvaluator, TapeFunction};
use headland_expr::{Graph, NodeId};

/// Relative size of a pivot of `J Jᵀ`, rows of length one, that counts as none.
const RANK: f64 = 1e-11;

/// Constraints on positions and their derivatives as functions of `x = [t, y, u′]`.
pub struct Positions {
    rows: usize,
    residual: TapeFunction,
    jacobian: Jacobian<TapeFunction>,
}

impl Positions {
    /// Compiles the rows, nodes over `x`.
    pub fn new(graph: &Graph, rows: &[NodeId], coordinates: usize) -> Self {
        let q: Vec<NodeId> = (1..=coordinates).map(|i| graph.input_id(i)).collect();
        let jacobian = Jacobian::<TapeFunction>::new(graph, rows, &q);
        Self { rows: rows.len(), residual: TapeFunction::compile(graph, rows), jacobian }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.rows == 0
    }

    /// One thread's scratch.
    pub fn projector(&self) -> Projector {
        let m = self.rows;
        Projector {
            residual: self.residual.evaluator(),
            jacobian: self.jacobian.function().evaluator(),
            dense: vec![0.0; m * (self.jacobian.col_ptr().len() - 1)],
            gram: vec![0.0; m * m],
            phi: vec![0.0; m],
            length: vec![0.0; m],
            order: (0..m).collect(),
        }
    }
}

/// Scratch of a projection.
pub struct Projector {
    residual: TapeEvaluator,
    jacobian: TapeEvaluator,
    /// J, row by row.
    dense: Vec<f64>,
    gram: Vec<f64>,
    phi: Vec<f64>,
    length: Vec<f64>,
    order: Vec<usize>,
}

impl Projector {
    /// Largest residual at `x`.
    pub fn worst(&mut self, x: &[f64]) -> f64 {
        let phi = self.residual.eval(x).iter();
        phi.fold(0.0, |worst: f64, p| if p.is_nan() { f64::NAN } else { worst.max(p.abs()) })
    }

    /// Moves the coordinates in `x = [t, q, ..]` onto the constraints; false if that fails.
    pub fn project(&mut self, positions: &Positions, x: &mut [f64]) -> bool {
        let mut worst = self.worst(x);
        for _ in 0..4 {
            if worst.is_nan() {
                return false;
            }
            if worst <= 1e-16 {
                return true;
            }
            let before: Vec<f64> = x.to_vec();
            self.correct(positions, x);
            let next = self.worst(x);
            if next.is_nan() || next >= worst {
                x.copy_from_slice(&before);
                return worst < 1e-6; // as near as numbers come, or hopeless
            }
            worst = next;
        }
        true
    }

    /// One step of Newton's method.
    fn correct(&mut self, positions: &Positions, x: &mut [f64]) {
        let (m, pattern) = (positions.rows, &positions.jacobian);
        let n = pattern.col_ptr().len() - 1;
        self.dense.fill(0.0);
        for (j, ends) in pattern.col_ptr().windows(2).enumerate() {
            let values = &self.jacobian.eval(x)[ends[0]..ends[1]];
            for (&i, value) in pattern.row_index()[ends[0]..ends[1]].iter().zip(values) {
                self.dense[i * n + j] = *value;
            }
        }
        self.phi.copy_from_slice(self.residual.eval(x));
        for (length, row) in self.length.iter_mut().zip(self.dense.chunks(n)) {
            *length = row.iter().map(|a| a * a).sum::<f64>().sqrt();
        }
        // a row that is rounding whatever the place, as of parallel axes, stays small and is beyond the rank
        let least = 1e-9 * self.length.iter().fold(f64::MIN_POSITIVE, |a, b| a.max(*b));
        for i in 0..m {
            let row = &mut self.dense[i * n..(i + 1) * n];
            let length = self.length[i].max(least);
            row.iter_mut().for_each(|a| *a /= length);
            self.length[i] = length;
            self.phi[i] /= length;
        }
        for i in 0..m {
            for k in 0..=i {
                let dot = (0..n).map(|j| self.dense[i * n + j] * self.dense[k * n + j]).sum::<f64>();
                (self.gram[i * m + k], self.gram[k * m + i]) = (dot, dot);
            }
        }
        solve_semidefinite(&mut self.gram, &mut self.phi, &mut self.order);
        for j in 0..n {
            x[1 + j] -= (0..m).map(|i| self.dense[i * n + j] * self.phi[i]).sum::<f64>();
        }
    }
}

/// Solves `S x = b` for a positive semidefinite S by Cholesky's method with complete pivoting; unknowns beyond the rank
/// are zero. S is overwritten, b by x.
///
/// # References
/// Higham, *Analysis of the Cholesky decomposition of a semi-definite matrix*, 1990.
fn solve_semidefinite(s: &mut [f64], b: &mut [f64], order: &mut [usize]) {
    let m = b.len();
    order.iter_mut().enumerate().for_each(|(i, o)| *o = i);
    let mut rank = 0;
    while rank < m {
        let r = rank;
        let best = (r..m).max_by(|&i, &k| s[order[i] * m + order[i]].total_cmp(&s[order[k] * m + order[k]]));
        let Some(best) = best.filter(|&i| s[order[i] * m + order[i]] > RANK) else { break };
        order.swap(r, best);
        let p = order[r];
        let root = s[p * m + p].sqrt();
        s[p * m + p] = root;
        for &i in &order[r + 1..] {
            s[i * m + p] /= root;
        }
        for a in r + 1..m {
            for c in r + 1..=a {
                let (i, k) = (order[a], order[c]);
                let value = s[i * m + k] - s[i * m + p] * s[k * m + p];
                (s[i * m + k], s[k * m + i]) = (value, value);
            }
        }
        rank += 1;
    }
    for a in 0..rank {
        let p = order[a];
        for &k in &order[..a] {
            b[p] -= s[p * m + k] * b[k];
        }
        b[p] /= s[p * m + p];
    }
    for a in (0..rank).rev() {
        let p = order[a];
        for &i in &order[a + 1..rank] {
            b[p] -= s[i * m + p] * b[i];
        }
        b[p] /= s[p * m + p];
    }
    for &p in &order[rank..] {
        b[p] = 0.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn semidefinite_systems_are_solved_up_to_their_rank() {
        // S = A Aᵀ with a repeated row; b in its range
        let rows = [[1.0, 2.0, 0.0], [0.5, -1.0, 3.0], [1.0, 2.0, 0.0]];
        let dot = |i: usize, k: usize| (0..3).map(|j| rows[i][j] * rows[k][j]).sum::<f64>();
        let s: Vec<f64> = (0..9).map(|e| dot(e / 3, e % 3)).collect();
        let x = [0.3, -0.7, 0.2];
        let b: Vec<f64> = (0..3).map(|i| (0..3).map(|k| s[3 * i + k] * x[k]).sum()).collect();
        let (mut factor, mut found, mut order) = (s.clone(), b.clone(), vec![0; 3]);
        solve_semidefinite(&mut factor, &mut found, &mut order);
        for i in 0..3 {
            let back: f64 = (0..3).map(|k| s[3 * i + k] * found[k]).sum();
            assert!((back - b[i]).abs() < 1e-13, "row {i}: {back} for {}", b[i]);
        }
    }
}
