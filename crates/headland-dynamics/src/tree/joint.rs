//! [`Joint`]: how a body may move in its parent, and the coordinates that say where it is.

use headland_expr::Scalar;
use headland_spatial::{Axis, Pose, Quaternion, Rotation, Vector};

/// A joint between the inboard frame F, fixed to the parent, and the body's own frame M.
///
/// | joint | q | u |
/// |---|---|---|
/// | `Fixed` | | |
/// | `Revolute`, `RevoluteAbout` | angle (rad) | its rate |
/// | `Prismatic`, `PrismaticAlong` | length (m) | its rate |
/// | `Helical` | angle (rad) | its rate |
/// | `Spherical` | quaternion w, x, y, z of M in F | angular velocity of M in F, in M's axes (rad/s) |
/// | `Planar` | x, y (m), angle about z (rad) | their rates |
/// | `Free` | position x, y, z of M in F (m), quaternion w, x, y, z | angular velocity in M's axes (rad/s), then rates of the position, in F's axes (m/s) |
///
/// A free body spinning in space so has constant linear quasi-velocities, whatever its rotation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Joint<S> {
    /// No motion: M is F.
    Fixed,
    /// Turns about an axis that F and M share.
    Revolute(Axis),
    /// Slides along an axis of F.
    Prismatic(Axis),
    /// Turns about a unit vector with the same components in F and M.
    RevoluteAbout(Vector<S>),
    /// Slides along a unit vector.
    PrismaticAlong(Vector<S>),
    /// Turns about an axis and moves along it by `pitch · angle`.
    Helical {
        /// Axis of F and M.
        axis: Axis,
        /// Way along the axis by angle (m/rad).
        pitch: S,
    },
    /// A ball joint.
    Spherical,
    /// Slides in F's x-y plane and turns about z.
    Planar,
    /// All six freedoms.
    Free,
}

impl<S: Scalar> Joint<S> {
    /// Number of coordinates.
    pub fn nq(&self) -> usize {
        match self {
            Joint::Fixed => 0,
            Joint::Spherical => 4,
            Joint::Planar => 3,
            Joint::Free => 7,
            _ => 1,
        }
    }

    /// Number of quasi-velocities.
    pub fn nu(&self) -> usize {
        match self {
            Joint::Fixed => 0,
            Joint::Spherical | Joint::Planar => 3,
            Joint::Free => 6,
            _ => 1,
        }
    }

    /// Coordinates at which M is F.
    pub fn neutral(&self) -> Vec<S> {
        let (zero, one) = (S::constant(0.0), S::constant(1.0));
        match self {
            Joint::Spherical => vec![one, zero, zero, zero],
            Joint::Free => vec![zero, zero, zero, one, zero, zero, zero],
            other => vec![zero; other.nq()],
        }
    }

    /// `X_FM(q)`.
    pub fn pose(&self, q: &[S]) -> Pose<S> {
        match *self {
            Joint::Fixed => Pose::identity(),
            Joint::Revolute(axis) => Pose::new(Rotation::about(axis, q[0]), Vector::zero()),
            Joint::Prismatic(axis) => Pose::at(Vector::along(axis, q[0])),
            Joint::RevoluteAbout(a) => Pose::new(Rotation::about_unit(a, q[0]), Vector::zero()),
            Joint::PrismaticAlong(a) => Pose::at(a * q[0]),
            Joint::Helical { axis, pitch } => Pose::new(Rotation::about(axis, q[0]), Vector::along(axis, pitch * q[0])),
            Joint::Spherical => Pose::new(quaternion(q).rotation(), Vector::zero()),
            Joint::Planar => Pose::new(Rotation::about(Axis::Z, q[2]), Vector([q[0], q[1], S::constant(0.0)])),
            Joint::Free => Pose::new(quaternion(&q[3..]).rotation(), Vector([q[0], q[1], q[2]])),
        }
    }

    /// Rates of the coordinates, `q̇ = G(q) u`.
    pub fn q_dot(&self, q: &[S], u: &[S], q_dot: &mut [S]) {
        match self {
            Joint::Spherical => q_dot.copy_from_slice(&quaternion(q).rate_from_body(Vector([u[0], u[1], u[2]])).0),
            Joint::Free => {
                q_dot[..3].copy_from_slice(&u[3..6]);
                q_dot[3..].copy_from_slice(&quaternion(&q[3..]).rate_from_body(Vector([u[0], u[1], u[2]])).0);
            }
            _ => q_dot.copy_from_slice(u),
        }
    }

    /// The same joint over another scalar.
    pub fn map<T: Scalar>(&self, mut f: impl FnMut(S) -> T) -> Joint<T> {
        match *self {
            Joint::Fixed => Joint::Fixed,
            Joint::Revolute(axis) => Joint::Revolute(axis),
            Joint::Prismatic(axis) => Joint::Prismatic(axis),
            Joint::RevoluteAbout(a) => Joint::RevoluteAbout(a.map(f)),
            Joint::PrismaticAlong(a) => Joint::PrismaticAlong(a.map(f)),
            Joint::Helical { axis, pitch } => Joint::Helical { axis, pitch: f(pitch) },
            Joint::Spherical => Joint::Spherical,
            Joint::Planar => Joint::Planar,
            Joint::Free => Joint::Free,
        }
    }
}

fn quaternion<S: Scalar>(q: &[S]) -> Quaternion<S> {
    Quaternion([q[0], q[1], q[2], q[3]])
}
