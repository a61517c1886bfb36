//! [`crba`]: the mass matrix by composite bodies.

use headland_expr::Scalar;
use headland_spatial::{Twist, Wrench};

use super::bodies::Tree;
use super::products::{Products, with_joint};
use super::workspace::Workspace;
use crate::solve::packed;

/// Mass matrix `M(q)` of the tree: packed lower triangle, row by row, as [`solve_ldl`](crate::solve::solve_ldl) takes it.
///
/// ```text
/// T = ½ uᵀ M u        M_ij = S_iᵀ I_j^c S_j,  I_j^c: inertia of all that hangs from j, i on the way to the root
/// ```
/// O(nu · depth). SI units follow u.
///
/// # Panics
/// If a length is wrong.
/// # References
/// Featherstone, *Rigid Body Dynamics Algorithms*, 2008, ch. 6.
pub fn crba<S: Scalar>(tree: &Tree<S>, q: &[S], work: &mut Workspace<S>, m: &mut [S]) {
    let nu = tree.nu();
    assert!(q.len() == tree.nq() && m.len() == nu * (nu + 1) / 2, "a length is wrong");
    m.fill(S::constant(0.0));
    for b in 0..tree.len() {
        work.place(tree, b, q);
        work.composite[b] = tree.links[b].rigid;
    }
    for b in (0..tree.len()).rev() {
        let composite = work.composite[b];
        for k in tree.u_range(b) {
            let momentum = composite.momentum(column(tree, work, b, k));
            project_upward(tree, work, b, k, momentum, m);
        }
        if let Some(parent) = tree.bodies()[b].parent {
            let moved = with_joint!(tree, work, b, |joint| joint.rigid_out(&composite));
            work.composite[parent] = work.composite[parent] + moved;
        }
    }
}

/// `S e_k`: the motion of body `b` in its parent by its quasi-velocity `k` of the whole tree.
pub(super) fn column<S: Scalar>(tree: &Tree<S>, work: &Workspace<S>, b: usize, k: usize) -> Twist<S> {
    let range = tree.u_range(b);
    let mut unit = [S::constant(0.0); 6];
    unit[k - range.start] = S::constant(1.0);
    with_joint!(tree, work, b, |joint| joint.motion(&unit[..range.len()]))
}

/// Row `k` of M: the momentum of column `k` projected on the joints from `b` to the root.
fn project_upward<S: Scalar>(
    tree: &Tree<S>,
    work: &Workspace<S>,
    b: usize,
    k: usize,
    momentum: Wrench<S>,
    m: &mut [S],
) {
    let (mut at, mut momentum) = (b, momentum);
    loop {
        let range = tree.u_range(at);
        let mut entries = [S::constant(0.0); 6];
        with_joint!(tree, work, at, |joint| joint.project(momentum, &mut entries[..range.len()]));
        for (i, entry) in range.zip(entries).take_while(|(i, _)| *i <= k) {
            m[packed(k, i)] = entry;
        }
        let Some(parent) = tree.bodies()[at].parent else { return };
        momentum = with_joint!(tree, work, at, |joint| joint.wrench_out(momentum));
        at = parent;
    }
}
