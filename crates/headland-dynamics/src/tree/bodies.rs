//! [`Tree`]: bodies, each hung from one before it.

use std::ops::Range;

use headland_expr::Scalar;
use headland_spatial::{Axis, Inertia, OriginInertia, Pose, Rotation, Symmetric, Vector};

use super::joint::Joint;

/// Where a joint's inboard frame F sits on the parent.
///
/// Say `At` where F's axes are the parent's: the recursions then need no rotation beyond the joint's own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Mount<S> {
    /// F's origin in the parent's frame (m), axes parallel.
    At(Vector<S>),
    /// `X_PF`.
    Pose(Pose<S>),
}

impl<S: Scalar> Mount<S> {
    /// F is the parent's frame.
    pub fn origin() -> Self {
        Mount::At(Vector::zero())
    }
    /// `X_PF`.
    pub fn pose(&self) -> Pose<S> {
        match *self {
            Mount::At(p) => Pose::at(p),
            Mount::Pose(x) => x,
        }
    }
}

impl<S> From<Vector<S>> for Mount<S> {
    fn from(p: Vector<S>) -> Self {
        Mount::At(p)
    }
}

impl<S> From<Pose<S>> for Mount<S> {
    fn from(x: Pose<S>) -> Self {
        Mount::Pose(x)
    }
}

/// A body with its joint to the parent. Its frame is the joint's outboard frame M.
#[derive(Clone, Copy, Debug)]
pub struct Body<S> {
    /// The parent; `None` is the world.
    pub parent: Option<usize>,
    /// The joint's place on the parent.
    pub mount: Mount<S>,
    /// The joint.
    pub joint: Joint<S>,
    /// Inertia in the body's frame.
    pub inertia: Inertia<S>,
}

/// Which products a body's joint has: revolutes' specialised ones, and two kinds of general ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kernel {
    RevoluteX,
    RevoluteY,
    RevoluteZ,
    /// Revolute on a mount with a rotation.
    MountedX,
    MountedY,
    MountedZ,
    /// The body never turns in its parent.
    Straight,
    /// A full rotation matrix.
    Turned,
}

/// What the recursions read of a body, side by side.
#[derive(Clone, Copy, Debug)]
pub(super) struct Link<S> {
    /// Slot of the parent: its index + 1, the world is 0.
    pub parent: usize,
    pub kernel: Kernel,
    /// First coordinate and the one after the last.
    pub q: (usize, usize),
    /// First quasi-velocity and the one after the last.
    pub u: (usize, usize),
    /// `p_PF`.
    pub position: Vector<S>,
    pub rigid: OriginInertia<S>,
    /// Nothing hangs from it.
    pub leaf: bool,
    /// Of its parent's children the last: the first that a pass from the leaves comes by.
    pub last: bool,
}

/// Bodies joined to a tree, parents first. `q` and `u` hold the joints' parts in the order of the bodies.
#[derive(Clone, Debug)]
pub struct Tree<S> {
    bodies: Vec<Body<S>>,
    pub(super) links: Vec<Link<S>>,
    nq: usize,
    nu: usize,
}

impl<S: Scalar> Default for Tree<S> {
    fn default() -> Self {
        Self::new()
    }
}

impl<S: Scalar> Tree<S> {
    /// Without bodies.
    pub fn new() -> Self {
        Self { bodies: Vec::new(), links: Vec::new(), nq: 0, nu: 0 }
    }

    /// Hangs a body from `parent` (`None`: the world) and gives its index.
    ///
    /// # Panics
    /// If there is no such parent yet.
    pub fn push(
        &mut self,
        parent: Option<usize>,
        mount: impl Into<Mount<S>>,
        joint: Joint<S>,
        inertia: Inertia<S>,
    ) -> usize {
        let index = self.bodies.len();
        assert!(parent.is_none_or(|p| p < index), "parent {parent:?} of body {index} is not there yet");
        let mount = mount.into();
        if let Some(p) = parent {
            let leaf = std::mem::replace(&mut self.links[p].leaf, false);
            let sibling = if leaf { None } else { self.links.iter_mut().rev().find(|l| l.parent == p + 1) };
            if let Some(sibling) = sibling {
                sibling.last = false;
            }
        }
        self.links.push(Link {
            parent: parent.map_or(0, |p| p + 1),
            kernel: kernel(&mount, &joint),
            q: (self.nq, self.nq + joint.nq()),
            u: (self.nu, self.nu + joint.nu()),
            position: mount.pose().position,
            rigid: inertia.about_origin(),
            leaf: true,
            last: true,
        });
        self.nq += joint.nq();
        self.nu += joint.nu();
        self.bodies.push(Body { parent, mount, joint, inertia });
        index
    }

    /// Two revolute joints in one place, `first` on the parent's side, with a massless cross between them.
    pub fn push_universal(
        &mut self,
        parent: Option<usize>,
        mount: impl Into<Mount<S>>,
        [first, second]: [Axis; 2],
        inertia: Inertia<S>,
    ) -> usize {
        let cross = self.push(parent, mount, Joint::Revolute(first), Inertia::zero());
        self.push(Some(cross), Mount::origin(), Joint::Revolute(second), inertia)
    }

    /// A revolute and a prismatic joint along one axis (angle, then length), with a massless sleeve between them.
    pub fn push_cylindrical(
        &mut self,
        parent: Option<usize>,
        mount: impl Into<Mount<S>>,
        axis: Axis,
        inertia: Inertia<S>,
    ) -> usize {
        let sleeve = self.push(parent, mount, Joint::Revolute(axis), Inertia::zero());
        self.push(Some(sleeve), Mount::origin(), Joint::Prismatic(axis), inertia)
    }

    /// Another inertia for a body.
    ///
    /// # Panics
    /// If there is no such body.
    pub fn set_inertia(&mut self, body: usize, inertia: Inertia<S>) {
        self.bodies[body].inertia = inertia;
        self.links[body].rigid = inertia.about_origin();
    }

    /// The bodies, parents first.
    #[inline]
    pub fn bodies(&self) -> &[Body<S>] {
        &self.bodies
    }
    /// Number of bodies.
    #[inline]
    pub fn len(&self) -> usize {
        self.bodies.len()
    }
    /// True without bodies.
    pub fn is_empty(&self) -> bool {
        self.bodies.is_empty()
    }
    /// Number of coordinates.
    pub fn nq(&self) -> usize {
        self.nq
    }
    /// Number of quasi-velocities.
    pub fn nu(&self) -> usize {
        self.nu
    }
    /// The body's coordinates in `q`.
    #[inline]
    pub fn q_range(&self, body: usize) -> Range<usize> {
        let (start, end) = self.links[body].q;
        start..end
    }
    /// The body's quasi-velocities in `u`.
    #[inline]
    pub fn u_range(&self, body: usize) -> Range<usize> {
        let (start, end) = self.links[body].u;
        start..end
    }

    /// Coordinates at which every body's frame is its joint's inboard frame.
    pub fn neutral(&self) -> Vec<S> {
        self.bodies.iter().flat_map(|b| b.joint.neutral()).collect()
    }

    /// Rates of the coordinates, `q̇ = G(q) u`.
    ///
    /// # Panics
    /// If a length is wrong.
    pub fn q_dot(&self, q: &[S], u: &[S], q_dot: &mut [S]) {
        for (b, body) in self.bodies.iter().enumerate() {
            let (at, of) = (self.q_range(b), self.u_range(b));
            body.joint.q_dot(&q[at.clone()], &u[of], &mut q_dot[at]);
        }
    }

    /// The same tree over another scalar: constants of `f64` become lanes, dual numbers or expressions.
    pub fn map<T: Scalar>(&self, mut f: impl FnMut(S) -> T) -> Tree<T> {
        let mut tree = Tree::new();
        for body in &self.bodies {
            let mount = match body.mount {
                Mount::At(p) => Mount::At(p.map(&mut f)),
                Mount::Pose(x) => {
                    let rotation = Rotation(x.rotation.0.map(|row| row.map(&mut f)));
                    Mount::Pose(Pose::new(rotation, x.position.map(&mut f)))
                }
            };
            let i = &body.inertia;
            let inertia = Inertia::new(f(i.mass), i.centre.map(&mut f), Symmetric(i.tensor.0.map(&mut f)));
            tree.push(body.parent, mount, body.joint.map(&mut f), inertia);
        }
        tree
    }
}

fn kernel<S: Scalar>(mount: &Mount<S>, joint: &Joint<S>) -> Kernel {
    match (mount, joint) {
        (Mount::At(_), Joint::Revolute(Axis::X)) => Kernel::RevoluteX,
        (Mount::At(_), Joint::Revolute(Axis::Y)) => Kernel::RevoluteY,
        (Mount::At(_), Joint::Revolute(Axis::Z)) => Kernel::RevoluteZ,
        (Mount::Pose(_), Joint::Revolute(Axis::X)) => Kernel::MountedX,
        (Mount::Pose(_), Joint::Revolute(Axis::Y)) => Kernel::MountedY,
        (Mount::Pose(_), Joint::Revolute(Axis::Z)) => Kernel::MountedZ,
        (Mount::At(_), Joint::Fixed | Joint::Prismatic(_) | Joint::PrismaticAlong(_)) => Kernel::Straight,
        _ => Kernel::Turned,
    }
}
