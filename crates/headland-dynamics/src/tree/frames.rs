//! [`Frames`]: where the bodies are and how they move; energies; [`body_jacobian`].

use headland_expr::Scalar;
use headland_spatial::{Axis, Pose, Rotation, Twist, Vector};

use super::bodies::{Kernel, Tree};
use super::crba::column;
use super::products::{Products, with_joint};
use super::workspace::Workspace;

/// Poses and twists of all bodies.
#[derive(Clone, Debug)]
pub struct Frames<S> {
    /// `X_WB` of each body.
    pub poses: Vec<Pose<S>>,
    /// `V_WB_B` of each body: at its origin, in its axes.
    pub twists: Vec<Twist<S>>,
}

impl<S: Scalar> Frames<S> {
    /// Room for a tree's bodies.
    pub fn new(tree: &Tree<S>) -> Self {
        Self { poses: vec![Pose::identity(); tree.len()], twists: vec![Twist::zero(); tree.len()] }
    }

    /// Kinetic energy (J).
    pub fn kinetic_energy(&self, tree: &Tree<S>) -> S {
        let energies = tree.bodies().iter().zip(&self.twists).map(|(b, v)| b.inertia.kinetic_energy(*v));
        energies.fold(S::constant(0.0), |sum, e| sum + e)
    }

    /// Potential energy (J) in the field `gravity` (m/s²), zero at the world's origin.
    pub fn potential_energy(&self, tree: &Tree<S>, gravity: Vector<S>) -> S {
        let energies =
            tree.bodies().iter().zip(&self.poses).map(|(b, x)| b.inertia.mass * gravity.dot(x.point(b.inertia.centre)));
        energies.fold(S::constant(0.0), |sum, e| sum - e)
    }
}

/// Poses and twists of all bodies at `q`, `u`.
///
/// # Panics
/// If a length is wrong.
pub fn frames<S: Scalar>(tree: &Tree<S>, q: &[S], u: &[S], work: &mut Workspace<S>, frames: &mut Frames<S>) {
    assert!(q.len() == tree.nq() && u.len() == tree.nu(), "a length is wrong");
    for b in 0..tree.len() {
        work.place(tree, b, q);
        let (parent, u) = (tree.bodies()[b].parent, &u[tree.u_range(b)]);
        let X_PB = in_parent(tree, work, b);
        frames.poses[b] = parent.map_or(X_PB, |p| frames.poses[p] * X_PB);
        frames.twists[b] = with_joint!(tree, work, b, |joint| match parent {
            None => joint.motion(u),
            Some(p) => joint.add_motion(joint.motion_into(frames.twists[p]), u),
        });
    }
}

/// `X_PB` from the positions that the workspace holds.
fn in_parent<S: Scalar>(tree: &Tree<S>, work: &Workspace<S>, b: usize) -> Pose<S> {
    let (link, place) = (&tree.links[b], &work.places[b]);
    let about = |axis| Pose::new(Rotation::about_sin_cos(axis, place.sin, place.cos), link.position);
    match link.kernel {
        Kernel::RevoluteX => about(Axis::X),
        Kernel::RevoluteY => about(Axis::Y),
        Kernel::RevoluteZ => about(Axis::Z),
        Kernel::MountedX | Kernel::MountedY | Kernel::MountedZ => Pose::new(work.rotations[b], link.position),
        Kernel::Straight => Pose::at(place.position),
        Kernel::Turned => Pose::new(work.rotations[b], place.position),
    }
}

/// `J` with `V_WB_B = J u`: one twist a quasi-velocity, with the positions that the workspace holds.
///
/// # Panics
/// If `jacobian.len() != nu`.
pub fn body_jacobian<S: Scalar>(tree: &Tree<S>, body: usize, work: &Workspace<S>, jacobian: &mut [Twist<S>]) {
    assert!(jacobian.len() == tree.nu(), "one column a quasi-velocity");
    jacobian.fill(Twist::zero());
    let mut X_AB = Pose::identity(); // of the body in its ancestor
    let mut at = body;
    loop {
        for k in tree.u_range(at) {
            jacobian[k] = column(tree, work, at, k).into_frame(&X_AB);
        }
        let Some(parent) = tree.bodies()[at].parent else { return };
        X_AB = in_parent(tree, work, at) * X_AB;
        at = parent;
    }
}
