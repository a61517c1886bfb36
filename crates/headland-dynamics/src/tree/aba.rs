//! [`aba`]: accelerations by articulated bodies.

use headland_expr::Scalar;
use headland_spatial::Wrench;

use super::articulated::Articulated;
use super::bodies::Tree;
use super::products::{Bias, Products, with_joint};
use super::workspace::{Loads, Workspace};

/// `u̇` under the joint forces `tau`, gravity and wrenches on bodies.
///
/// ```text
/// M(q) u̇ + h(q, u) = τ
/// ```
/// Three passes, O(number of bodies): outward twists and bias wrenches, inward articulated inertias with each joint's freedoms
/// eliminated, outward accelerations.
///
/// # Panics
/// If a length is wrong.
/// # References
/// Featherstone, *Rigid Body Dynamics Algorithms*, 2008, ch. 7.
pub fn aba<S: Scalar>(
    tree: &Tree<S>,
    q: &[S],
    u: &[S],
    tau: &[S],
    loads: &Loads<'_, S>,
    work: &mut Workspace<S>,
    acceleration: &mut [S],
) {
    assert!(q.len() == tree.nq() && u.len() == tree.nu() && tau.len() == tree.nu(), "a length is wrong");
    assert!(acceleration.len() == tree.nu(), "one acceleration a quasi-velocity");
    work.set_world(loads.gravity);
    for b in 0..tree.len() {
        work.place(tree, b, q);
        with_joint!(tree, work, b, |joint| outward(&joint, tree, b, u, loads, work));
    }
    for b in (0..tree.len()).rev() {
        with_joint!(tree, work, b, |joint| inward(&joint, tree, b, u, tau, work));
    }
    for b in 0..tree.len() {
        with_joint!(tree, work, b, |joint| accelerate(&joint, tree, b, u, work, acceleration));
    }
}

/// Twist and bias wrench of the body alone.
#[inline]
fn outward<S: Scalar>(
    joint: &impl Products<S>,
    tree: &Tree<S>,
    b: usize,
    u: &[S],
    loads: &Loads<'_, S>,
    work: &mut Workspace<S>,
) {
    let link = &tree.links[b];
    let twist = joint.add_motion(joint.motion_into(work.slots[link.parent].twist), &u[tree.u_range(b)]);
    let gyroscopic = link.rigid.gyroscopic(twist);
    let slot = &mut work.slots[b + 1];
    slot.twist = twist;
    slot.wrench = match loads.wrenches {
        [] => gyroscopic,
        wrenches => gyroscopic - wrenches[b],
    };
}

/// Eliminates the joint's freedoms and hands the rest to the parent.
#[inline]
fn inward<S: Scalar>(joint: &impl Products<S>, tree: &Tree<S>, b: usize, u: &[S], tau: &[S], work: &mut Workspace<S>) {
    let (link, range) = (&tree.links[b], tree.u_range(b));
    let (before, own) = work.articulated.split_at_mut(b + 1);
    let inertia = &mut own[0];
    if link.leaf {
        *inertia = Articulated::rigid(&link.rigid);
    }
    let mut wrench: Wrench<S> = work.slots[b + 1].wrench;
    let bias = Bias { twist: work.slots[b + 1].twist, u: &u[range.clone()] };
    joint.eliminate(inertia, &mut wrench, bias, &tau[range.clone()], &mut work.pivots[range]);
    if link.parent > 0 {
        let reduced = joint.reduced_out(inertia);
        match link.last {
            true => before[link.parent] = reduced.and_rigid(&tree.links[link.parent - 1].rigid),
            false => before[link.parent].add(&reduced),
        }
        let parent = &mut work.slots[link.parent];
        parent.wrench = parent.wrench + joint.wrench_out(wrench);
    }
}

/// Accelerations from the parent's.
#[inline]
fn accelerate<S: Scalar>(
    joint: &impl Products<S>,
    tree: &Tree<S>,
    b: usize,
    u: &[S],
    work: &mut Workspace<S>,
    acceleration: &mut [S],
) {
    let (link, range) = (&tree.links[b], tree.u_range(b));
    let twist = work.slots[b + 1].twist;
    let given = joint.motion_into(work.slots[link.parent].acceleration) + joint.bias(twist, &u[range.clone()]);
    work.slots[b + 1].acceleration = joint.solve(given, &work.pivots[range.clone()], &mut acceleration[range]);
}
