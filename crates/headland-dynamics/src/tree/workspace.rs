//! [`Workspace`]: the scratch of one thread, and [`Loads`]: what acts beside the joints' own forces.

use headland_expr::Scalar;
use headland_spatial::{OriginInertia, Rotation, Twist, Vector, Wrench};

use super::articulated::{Articulated, Pivot};
use super::bodies::{Kernel, Mount, Tree};
use super::general;
use super::joint::Joint;
use super::revolute::turned;

/// Gravity and wrenches on bodies.
#[derive(Clone, Copy, Debug)]
pub struct Loads<'a, S> {
    /// Acceleration of free fall in the world's axes (m/s²).
    pub gravity: Vector<S>,
    /// A wrench a body, at the origin of the body's frame in its axes; empty: none at all.
    pub wrenches: &'a [Wrench<S>],
}

impl<S: Scalar> Loads<'_, S> {
    /// Neither gravity nor wrenches.
    pub fn none() -> Self {
        Self { gravity: Vector::zero(), wrenches: &[] }
    }
    /// Gravity alone.
    pub fn gravity(gravity: Vector<S>) -> Self {
        Self { gravity, wrenches: &[] }
    }
}

/// Where a joint is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place<S> {
    pub sin: S,
    pub cos: S,
    pub position: Vector<S>,
}

/// How a body moves and what acts on it; slot 0 is the world.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slot<S> {
    pub twist: Twist<S>,
    /// Spatial acceleration, that of free fall subtracted.
    pub acceleration: Twist<S>,
    pub wrench: Wrench<S>,
}

/// Scratch for one tree; one a thread. No evaluation allocates.
#[derive(Clone, Debug)]
pub struct Workspace<S> {
    pub(super) places: Vec<Place<S>>,
    pub(super) rotations: Vec<Rotation<S>>,
    pub(super) slots: Vec<Slot<S>>,
    pub(super) articulated: Vec<Articulated<S>>,
    pub(super) composite: Vec<OriginInertia<S>>,
    pub(super) pivots: Vec<Pivot<S>>,
    pub(super) column: Vec<S>,
    pub(super) force: Vec<S>,
}

impl<S: Scalar> Workspace<S> {
    /// For this tree, or another of the same size.
    pub fn new(tree: &Tree<S>) -> Self {
        let (n, zero) = (tree.len(), S::constant(0.0));
        let slot = Slot { twist: Twist::zero(), acceleration: Twist::zero(), wrench: Wrench::zero() };
        let nothing = OriginInertia { mass: zero, moment: Vector::zero(), tensor: headland_spatial::Symmetric::zero() };
        Self {
            places: tree.links.iter().map(|l| Place { sin: zero, cos: zero, position: l.position }).collect(),
            rotations: vec![Rotation::identity(); n],
            slots: vec![slot; n + 1],
            articulated: vec![Articulated::zero(); n + 1],
            composite: vec![nothing; n],
            pivots: vec![Pivot::zero(); tree.nu()],
            column: vec![zero; tree.nu()],
            force: vec![zero; tree.nu()],
        }
    }

    /// Sines, cosines, rotations and positions of body `b`'s joint.
    #[inline]
    pub(super) fn place(&mut self, tree: &Tree<S>, b: usize, q: &[S]) {
        let link = &tree.links[b];
        match link.kernel {
            Kernel::RevoluteX | Kernel::RevoluteY | Kernel::RevoluteZ => {
                let place = &mut self.places[b];
                (place.sin, place.cos) = q[link.q.0].sin_cos();
            }
            Kernel::MountedX | Kernel::MountedY | Kernel::MountedZ => {
                let body = &tree.bodies()[b];
                if let (Mount::Pose(x), Joint::Revolute(axis)) = (body.mount, body.joint) {
                    self.rotations[b] = turned(&x.rotation, axis, q[link.q.0].sin_cos());
                }
            }
            Kernel::Straight | Kernel::Turned => {
                let q = &q[tree.q_range(b)];
                general::place(&tree.bodies()[b], q, &mut self.places[b], &mut self.rotations[b]);
            }
        }
    }

    /// The world at rest, and falling upward so that everything else need not fall.
    pub(super) fn set_world(&mut self, gravity: Vector<S>) {
        self.slots[0].twist = Twist::zero();
        self.slots[0].acceleration = Twist::new(Vector::zero(), -gravity);
    }

    /// The pivots `D` of the last [`aba`](super::aba()), one a quasi-velocity: the inertia that each freedom sees.
    ///
    /// One that is not positive tells of a freedom without inertia.
    pub fn pivots(&self) -> impl Iterator<Item = S> + '_ {
        self.pivots.iter().map(|p| p.pivot)
    }
}
