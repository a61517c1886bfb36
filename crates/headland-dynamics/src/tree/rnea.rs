//! [`rnea`]: the joint forces that a motion takes; [`mass_times`]: `M a` without M.

use headland_expr::Scalar;
use headland_spatial::{Twist, Vector};

use super::bodies::Tree;
use super::products::{Products, with_joint};
use super::workspace::{Loads, Workspace};

/// `τ = M(q) u̇ + h(q, u)`, with gravity and wrenches on bodies in h.
///
/// Two passes, O(number of bodies): outward twists and accelerations, inward wrenches.
///
/// # Panics
/// If a length is wrong.
/// # References
/// Featherstone, *Rigid Body Dynamics Algorithms*, 2008, ch. 5 (Luh, Walker & Paul 1980).
pub fn rnea<S: Scalar>(
    tree: &Tree<S>,
    q: &[S],
    u: &[S],
    acceleration: &[S],
    loads: &Loads<'_, S>,
    work: &mut Workspace<S>,
    tau: &mut [S],
) {
    assert!(q.len() == tree.nq() && u.len() == tree.nu(), "a length is wrong");
    assert!(acceleration.len() == tree.nu() && tau.len() == tree.nu(), "a length is wrong");
    work.set_world(loads.gravity);
    for b in 0..tree.len() {
        work.place(tree, b, q);
        with_joint!(tree, work, b, |joint| outward(&joint, tree, b, u, acceleration, loads, work));
    }
    inward(tree, work, tau);
}

#[inline]
fn outward<S: Scalar>(
    joint: &impl Products<S>,
    tree: &Tree<S>,
    b: usize,
    u: &[S],
    acceleration: &[S],
    loads: &Loads<'_, S>,
    work: &mut Workspace<S>,
) {
    let (link, range) = (&tree.links[b], tree.u_range(b));
    let (parent, u) = (work.slots[link.parent], &u[range.clone()]);
    let twist = joint.add_motion(joint.motion_into(parent.twist), u);
    let given = joint.motion_into(parent.acceleration) + joint.bias(twist, u);
    let slot = &mut work.slots[b + 1];
    slot.twist = twist;
    slot.acceleration = joint.add_motion(given, &acceleration[range]);
    let wrench = link.rigid.rate_of_momentum(twist, slot.acceleration);
    slot.wrench = match loads.wrenches {
        [] => wrench,
        wrenches => wrench - wrenches[b],
    };
}

/// Wrenches summed towards the root, each projected on its joint.
fn inward<S: Scalar>(tree: &Tree<S>, work: &mut Workspace<S>, tau: &mut [S]) {
    for b in (0..tree.len()).rev() {
        let (parent, range) = (tree.links[b].parent, tree.u_range(b));
        let wrench = work.slots[b + 1].wrench;
        with_joint!(tree, work, b, |joint| {
            joint.project(wrench, &mut tau[range]);
            if parent > 0 {
                let slot = &mut work.slots[parent];
                slot.wrench = slot.wrench + joint.wrench_out(wrench);
            }
        });
    }
}

/// `M(q) a`, with the positions that the workspace holds from the last evaluation.
///
/// # Panics
/// If a length is wrong.
pub fn mass_times<S: Scalar>(tree: &Tree<S>, a: &[S], work: &mut Workspace<S>, product: &mut [S]) {
    assert!(a.len() == tree.nu() && product.len() == tree.nu(), "a length is wrong");
    work.set_world(Vector::zero());
    for b in 0..tree.len() {
        let (link, range) = (&tree.links[b], tree.u_range(b));
        let parent = work.slots[link.parent].acceleration;
        let given: Twist<S> =
            with_joint!(tree, work, b, |joint| joint.add_motion(joint.motion_into(parent), &a[range]));
        let slot = &mut work.slots[b + 1];
        slot.acceleration = given;
        slot.wrench = link.rigid.momentum(given);
    }
    inward(tree, work, product);
}
