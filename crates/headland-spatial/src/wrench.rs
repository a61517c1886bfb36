//! [`Wrench`]: what acts on a body.

use std::ops::{Add, Mul, Neg, Sub};

use headland_expr::Scalar;

use crate::pose::Pose;
use crate::vector::Vector;

/// `F = [τ; f]`: torque about a frame's origin and force, in this frame's axes: N·m and N. Momenta are wrenches too.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Wrench<S> {
    /// Torque about the frame's origin (N·m).
    pub torque: Vector<S>,
    /// Force (N).
    pub force: Vector<S>,
}

impl<S: Scalar> Wrench<S> {
    /// From torque about the origin and force.
    #[inline]
    pub fn new(torque: Vector<S>, force: Vector<S>) -> Self {
        Self { torque, force }
    }
    /// Nothing acts.
    #[inline]
    pub fn zero() -> Self {
        Self::new(Vector::zero(), Vector::zero())
    }
    /// A force at the point `p` (m).
    #[inline]
    pub fn of_force(force: Vector<S>, p: Vector<S>) -> Self {
        Self::new(p.cross(force), force)
    }
    /// The same wrench, given at A in A's axes, about the origin of B and in B's axes; `x` is `X_AB`.
    #[inline]
    pub fn into_frame(self, x: &Pose<S>) -> Self {
        let torque = self.torque - x.position.cross(self.force);
        Self::new(x.rotation.apply_inverse(torque), x.rotation.apply_inverse(self.force))
    }
    /// The same wrench, given at B in B's axes, about the origin of A and in A's axes; `x` is `X_AB`.
    ///
    /// ```text
    /// f_A = R f_B      τ_A = R τ_B + p × f_A
    /// ```
    #[inline]
    pub fn out_of_frame(self, x: &Pose<S>) -> Self {
        let force = x.rotation * self.force;
        Self::new(x.rotation * self.torque + x.position.cross(force), force)
    }
}

impl<S: Scalar> Add for Wrench<S> {
    type Output = Self;
    #[inline]
    fn add(self, b: Self) -> Self {
        Self::new(self.torque + b.torque, self.force + b.force)
    }
}

impl<S: Scalar> Sub for Wrench<S> {
    type Output = Self;
    #[inline]
    fn sub(self, b: Self) -> Self {
        Self::new(self.torque - b.torque, self.force - b.force)
    }
}

impl<S: Scalar> Neg for Wrench<S> {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self::new(-self.torque, -self.force)
    }
}

impl<S: Scalar> Mul<S> for Wrench<S> {
    type Output = Self;
    #[inline]
    fn mul(self, k: S) -> Self {
        Self::new(self.torque * k, self.force * k)
    }
}
