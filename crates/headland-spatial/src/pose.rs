//! [`Pose`]: where one frame is in another.

use std::ops::Mul;

use headland_expr::Scalar;

use crate::rotation::Rotation;
use crate::vector::Vector;

/// `X_AB`, the pose of frame B in frame A: `p_AP = R_AB p_BP + p_AB`, lengths in m.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Pose<S> {
    /// `R_AB`.
    pub rotation: Rotation<S>,
    /// B's origin in A, `p_AB` (m).
    pub position: Vector<S>,
}

impl<S: Scalar> Pose<S> {
    /// From rotation and position.
    #[inline]
    pub fn new(rotation: Rotation<S>, position: Vector<S>) -> Self {
        Self { rotation, position }
    }
    /// B is A.
    #[inline]
    pub fn identity() -> Self {
        Self::new(Rotation::identity(), Vector::zero())
    }
    /// Shifted, not turned.
    #[inline]
    pub fn at(position: Vector<S>) -> Self {
        Self::new(Rotation::identity(), position)
    }
    /// `X_BA`.
    #[inline]
    pub fn inverse(&self) -> Self {
        Self::new(self.rotation.transpose(), -self.rotation.apply_inverse(self.position))
    }
    /// Coordinates in A of the point with coordinates `p` in B.
    #[inline]
    pub fn point(&self, p: Vector<S>) -> Vector<S> {
        self.rotation * p + self.position
    }
    /// Coordinates in B of the point with coordinates `p` in A.
    #[inline]
    pub fn point_inverse(&self, p: Vector<S>) -> Vector<S> {
        self.rotation.apply_inverse(p - self.position)
    }
}

impl<S: Scalar> Mul for Pose<S> {
    type Output = Self;
    /// `X_AC = X_AB X_BC`.
    #[inline]
    fn mul(self, other: Self) -> Self {
        Self::new(self.rotation * other.rotation, self.point(other.position))
    }
}
