//! [`project`]: the tree's dynamics on fewer quasi-velocities.

use headland_expr::Scalar;

use super::bodies::Tree;
use super::rnea::{mass_times, rnea};
use super::workspace::{Loads, Workspace};
use crate::solve::packed;

/// Quasi-velocities `w` of a tree under constraints: `u = G w + g`, `u̇ = G ẇ + d`.
#[derive(Clone, Copy, Debug)]
pub struct Reduction<'a, S> {
    /// G by columns, one of length `nu` a quasi-velocity w.
    pub columns: &'a [Vec<S>],
    /// `d = Ġ w + ġ`.
    pub drift: &'a [S],
}

/// `M′ = Gᵀ M G` (packed lower triangle) and `F′ = Gᵀ (τ − h − M d)`, so that `M′ ẇ = F′`.
///
/// The matrix M is never formed: each column of `M G` is one recursion, O(bodies · nw + nu · nw²).
///
/// # Panics
/// If a length is wrong.
pub fn project<S: Scalar>(
    tree: &Tree<S>,
    q: &[S],
    u: &[S],
    tau: &[S],
    loads: &Loads<'_, S>,
    reduction: &Reduction<'_, S>,
    work: &mut Workspace<S>,
    mass: &mut [S],
    force: &mut [S],
) {
    let columns = reduction.columns;
    let n = columns.len();
    assert!(mass.len() == n * (n + 1) / 2 && force.len() == n, "a length is wrong");
    let mut needed = std::mem::take(&mut work.force);
    rnea(tree, q, u, reduction.drift, loads, work, &mut needed);
    for (needed, tau) in needed.iter_mut().zip(tau) {
        *needed = *tau - *needed;
    }
    for (f, g) in force.iter_mut().zip(columns) {
        *f = dot(g, &needed);
    }
    work.force = needed;
    let mut product = std::mem::take(&mut work.column);
    for (i, g) in columns.iter().enumerate() {
        mass_times(tree, g, work, &mut product);
        for j in 0..=i {
            mass[packed(i, j)] = dot(&columns[j], &product);
        }
    }
    work.column = product;
}

fn dot<S: Scalar>(a: &[S], b: &[S]) -> S {
    a.iter().zip(b).fold(S::constant(0.0), |sum, (a, b)| sum + *a * *b)
}
