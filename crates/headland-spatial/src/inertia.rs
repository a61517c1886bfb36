//! [`Inertia`]: mass, mass centre and inertia tensor of a rigid body; [`OriginInertia`]: the same about the origin.

use std::ops::Add;

use headland_expr::Scalar;

use crate::pose::Pose;
use crate::symmetric::Symmetric;
use crate::twist::Twist;
use crate::vector::Vector;
use crate::wrench::Wrench;

/// Inertia of a rigid body in a frame fixed to it.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Inertia<S> {
    /// Mass (kg).
    pub mass: S,
    /// Mass centre in the frame (m).
    pub centre: Vector<S>,
    /// Tensor about the *mass centre* in the frame's axes (kg·m²).
    ///
    /// Entries of the matrix, so the products carry its sign: `xy = −∫ x y dm`.
    pub tensor: Symmetric<S>,
}

impl<S: Scalar> Inertia<S> {
    /// From mass (kg), mass centre (m) and the tensor about the mass centre (kg·m²).
    #[inline]
    pub fn new(mass: S, centre: Vector<S>, tensor: Symmetric<S>) -> Self {
        Self { mass, centre, tensor }
    }
    /// A body without inertia, as between the two halves of a universal joint.
    #[inline]
    pub fn zero() -> Self {
        Self::new(S::constant(0.0), Vector::zero(), Symmetric::zero())
    }
    /// A point mass at `centre`.
    #[inline]
    pub fn point(mass: S, centre: Vector<S>) -> Self {
        Self::new(mass, centre, Symmetric::zero())
    }
    /// The same body with its mass centre moved to `centre`.
    #[inline]
    pub fn with_centre(self, centre: Vector<S>) -> Self {
        Self { centre, ..self }
    }
    /// Tensor about the point `p` (m) of the frame, in the frame's axes (Steiner): `I_p = I_c + m (|d|² 1 − d dᵀ)`.
    #[inline]
    pub fn tensor_about(&self, p: Vector<S>) -> Symmetric<S> {
        self.tensor + Symmetric::of_point(self.mass, self.centre - p)
    }
    /// Mass, first moment and tensor about the frame's origin: what the recursions work with.
    #[inline]
    pub fn about_origin(&self) -> OriginInertia<S> {
        OriginInertia {
            mass: self.mass,
            moment: self.centre * self.mass,
            tensor: self.tensor + Symmetric::of_point(self.mass, self.centre),
        }
    }
    /// Momentum `[L_O; P]` at the frame's origin of the body moving with `v`: kg·m²/s and kg·m/s.
    #[inline]
    pub fn momentum(&self, v: Twist<S>) -> Wrench<S> {
        let force = v.at_point(self.centre) * self.mass;
        Wrench::new(self.tensor * v.angular + self.centre.cross(force), force)
    }
    /// Kinetic energy (J) of the body moving with `v`.
    #[inline]
    pub fn kinetic_energy(&self, v: Twist<S>) -> S {
        let centre = v.at_point(self.centre);
        (self.mass * centre.squared_norm() + v.angular.dot(self.tensor * v.angular)) * S::constant(0.5)
    }
    /// The same body, given in frame B, in frame A; `x` is `X_AB`.
    #[inline]
    pub fn out_of_frame(&self, x: &Pose<S>) -> Self {
        Self::new(self.mass, x.point(self.centre), x.rotation.apply_to_tensor(&self.tensor))
    }
    /// The same body, given in frame A, in frame B; `x` is `X_AB`.
    #[inline]
    pub fn into_frame(&self, x: &Pose<S>) -> Self {
        self.out_of_frame(&x.inverse())
    }
}

impl<S: Scalar> Add for Inertia<S> {
    type Output = Self;
    /// Two bodies of one frame made one. The masses must not sum to zero; [`OriginInertia`] has no such bound.
    #[inline]
    fn add(self, b: Self) -> Self {
        let mass = self.mass + b.mass;
        let share = b.mass / mass;
        let d = b.centre - self.centre;
        let steiner = Symmetric::of_point(self.mass * share, d);
        Self::new(mass, self.centre + d * share, self.tensor + b.tensor + steiner)
    }
}

/// Inertia about the frame's origin: sums without a division.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct OriginInertia<S> {
    /// Mass m (kg).
    pub mass: S,
    /// First moment `h = m c` (kg·m).
    pub moment: Vector<S>,
    /// Tensor about the origin (kg·m²).
    pub tensor: Symmetric<S>,
}

impl<S: Scalar> OriginInertia<S> {
    /// Momentum `[I ω + h × v; m v + ω × h]`.
    #[inline]
    pub fn momentum(&self, v: Twist<S>) -> Wrench<S> {
        Wrench::new(
            self.tensor * v.angular + self.moment.cross(v.linear),
            v.linear * self.mass + v.angular.cross(self.moment),
        )
    }
    /// `V ×* M V`, the gyroscopic and centrifugal wrench, in its shortest form.
    ///
    /// ```text
    /// τ = ω × I ω + h × (ω × v)      f = m (ω × v) + ω × (ω × h)
    /// ```
    #[inline]
    pub fn gyroscopic(&self, v: Twist<S>) -> Wrench<S> {
        let a = v.angular.cross(v.linear);
        Wrench::new(
            v.angular.cross(self.tensor * v.angular) + self.moment.cross(a),
            a * self.mass + v.angular.cross(v.angular.cross(self.moment)),
        )
    }
    /// `M A + V ×* M V`: the wrench that gives the body moving with `v` the (spatial) acceleration `a`.
    #[inline]
    pub fn rate_of_momentum(&self, v: Twist<S>, a: Twist<S>) -> Wrench<S> {
        let w = v.angular;
        let origin = a.linear + w.cross(v.linear); // the acceleration of the body's point there
        Wrench::new(
            self.tensor * a.angular + w.cross(self.tensor * w) + self.moment.cross(origin),
            origin * self.mass + a.angular.cross(self.moment) + w.cross(w.cross(self.moment)),
        )
    }
}

impl<S: Scalar> Add for OriginInertia<S> {
    type Output = Self;
    #[inline]
    fn add(self, b: Self) -> Self {
        Self { mass: self.mass + b.mass, moment: self.moment + b.moment, tensor: self.tensor + b.tensor }
    }
}
