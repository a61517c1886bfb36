//! [`Twist`]: how a frame moves.

use std::ops::{Add, Mul, Neg, Sub};

use headland_expr::Scalar;

use crate::pose::Pose;
use crate::vector::Vector;
use crate::wrench::Wrench;

/// `V = [ω; v]` of a body at the origin of a frame, in this frame's axes: rad/s and m/s. Accelerations are twists too.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Twist<S> {
    /// Angular velocity ω (rad/s).
    pub angular: Vector<S>,
    /// Velocity of the body's point at the frame's origin (m/s).
    pub linear: Vector<S>,
}

impl<S: Scalar> Twist<S> {
    /// From angular velocity and velocity of the origin.
    #[inline]
    pub fn new(angular: Vector<S>, linear: Vector<S>) -> Self {
        Self { angular, linear }
    }
    /// At rest.
    #[inline]
    pub fn zero() -> Self {
        Self::new(Vector::zero(), Vector::zero())
    }
    /// The same motion, given at A in A's axes, at the origin of B and in B's axes; `x` is `X_AB`.
    ///
    /// ```text
    /// ω_B = Rᵀ ω_A      v_B = Rᵀ (v_A + ω_A × p)
    /// ```
    #[inline]
    pub fn into_frame(self, x: &Pose<S>) -> Self {
        let linear = self.linear + self.angular.cross(x.position);
        Self::new(x.rotation.apply_inverse(self.angular), x.rotation.apply_inverse(linear))
    }
    /// The same motion, given at B in B's axes, at the origin of A and in A's axes; `x` is `X_AB`.
    #[inline]
    pub fn out_of_frame(self, x: &Pose<S>) -> Self {
        let angular = x.rotation * self.angular;
        Self::new(angular, x.rotation * self.linear + x.position.cross(angular))
    }
    /// Velocity of the body's point at `p` (m), in the frame's axes.
    #[inline]
    pub fn at_point(self, p: Vector<S>) -> Vector<S> {
        self.linear + self.angular.cross(p)
    }
    /// Motion × motion: the rate of `m`, constant in axes that move with `self`.
    ///
    /// ```text
    /// V × m = [ω × m_ω; ω × m_v + v × m_ω]
    /// ```
    #[inline]
    pub fn cross(self, m: Self) -> Self {
        Self::new(self.angular.cross(m.angular), self.angular.cross(m.linear) + self.linear.cross(m.angular))
    }
    /// Motion × force: the rate of `f`, constant in axes that move with `self`.
    ///
    /// ```text
    /// V ×* f = [ω × τ + v × f; ω × f]
    /// ```
    #[inline]
    pub fn cross_wrench(self, f: Wrench<S>) -> Wrench<S> {
        Wrench::new(self.angular.cross(f.torque) + self.linear.cross(f.force), self.angular.cross(f.force))
    }
    /// `τ · ω + f · v` (W).
    #[inline]
    pub fn power(self, f: Wrench<S>) -> S {
        self.angular.dot(f.torque) + self.linear.dot(f.force)
    }
}

impl<S: Scalar> Add for Twist<S> {
    type Output = Self;
    #[inline]
    fn add(self, b: Self) -> Self {
        Self::new(self.angular + b.angular, self.linear + b.linear)
    }
}

impl<S: Scalar> Sub for Twist<S> {
    type Output = Self;
    #[inline]
    fn sub(self, b: Self) -> Self {
        Self::new(self.angular - b.angular, self.linear - b.linear)
    }
}

impl<S: Scalar> Neg for Twist<S> {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self::new(-self.angular, -self.linear)
    }
}

impl<S: Scalar> Mul<S> for Twist<S> {
    type Output = Self;
    #[inline]
    fn mul(self, k: S) -> Self {
        Self::new(self.angular * k, self.linear * k)
    }
}
