//! Algorithm [10], direct: structures differentiated with respect to the quasi-velocities, equations (3) and (9).

use headland_expr::Expr;

use crate::kinematics::Kinematics;
use crate::solve::packed;
use crate::structures::Structures;

/// `M u′ = F`: M as a packed lower triangle.
#[derive(Clone, Debug)]
pub struct MassForm<'g> {
    /// Lower triangle of M, row by row.
    pub m: Vec<Expr<'g>>,
    /// F
    pub f: Vec<Expr<'g>>,
}

/// ```text
/// M = Σ J Wᵀ W        F = Σ Wᵀ P − Σ J Wᵀ bias        (7), (9)
/// ```
/// Nothing that cancels is formed: M is not differentiated from an energy, F not by setting u′ = 0 in U.
pub fn derive_direct<'g>(kinematics: &Kinematics, s: &Structures<'g>) -> MassForm<'g> {
    let n = kinematics.quasi.len();
    let mut m = vec![Expr::Const(0.0); n * (n + 1) / 2];
    let mut f = vec![Expr::Const(0.0); n];
    let acts: Vec<Vec<usize>> = s.w.iter().map(|row| (0..n).filter(|&i| !row[i].is(0.0)).collect()).collect();
    for (e, acts) in acts.iter().enumerate() {
        for (k, &i) in acts.iter().enumerate() {
            let w = s.w[e][i];
            // w bias first: where W is a square root, the bias has it as its denominator
            f[i] = f[i] + (w * s.force[e] - s.inertia[e] * (w * s.bias[e]));
            if s.inertia[e].is(0.0) {
                continue;
            }
            let jw = s.inertia[e] * w;
            for &j in &acts[..=k] {
                // J W² keeps its square: (√x)² = x there
                let term = if i == j { s.inertia[e] * (w * w) } else { jw * s.w[e][j] };
                m[packed(i, j)] = m[packed(i, j)] + term;
            }
        }
    }
    for &(a, b, entry) in &s.couplings {
        for (a, b) in [(a, b), (b, a)] {
            for &i in &acts[a] {
                let jw = entry * s.w[a][i];
                f[i] = f[i] - jw * s.bias[b];
                for &j in acts[b].iter().filter(|j| **j <= i) {
                    m[packed(i, j)] = m[packed(i, j)] + jw * s.w[b][j];
                }
            }
        }
    }
    MassForm { m, f }
}
