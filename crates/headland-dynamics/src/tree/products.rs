//! [`Products`]: what the recursions ask of a joint; each is given in the form that costs least for it.
//!
//! P is the parent's frame, B the body's. Twists and wrenches of a body are taken at its origin, in its axes.

use headland_expr::Scalar;
use headland_spatial::{OriginInertia, Symmetric, Twist, Vector, Wrench};

use super::articulated::{Articulated, Pivot};

/// A joint at one position.
pub(super) trait Products<S: Scalar> {
    /// `v_P = R_PB v_B`.
    fn out(&self, v: Vector<S>) -> Vector<S>;
    /// `v_B = R_BP v_P`.
    fn back(&self, v: Vector<S>) -> Vector<S>;
    /// `R T Rᵀ`.
    fn tensor_out(&self, t: &Symmetric<S>) -> Symmetric<S>;
    /// `p_PB`.
    fn position(&self) -> Vector<S>;
    /// `S u`, the motion in the joint.
    fn motion(&self, u: &[S]) -> Twist<S>;
    /// `V + S u`.
    fn add_motion(&self, v: Twist<S>, u: &[S]) -> Twist<S> {
        v + self.motion(u)
    }
    /// `Ṡ u + V × S u` of the body moving with `v`: its acceleration beside the parent's and `S u̇`.
    fn bias(&self, v: Twist<S>, u: &[S]) -> Twist<S>;
    /// `τ = Sᵀ F`.
    fn project(&self, f: Wrench<S>, tau: &mut [S]);
    /// Lets the joint's freedoms move under `tau`; `p` becomes the bias wrench of what is left, accelerated with `bias`.
    fn eliminate(
        &self,
        i: &mut Articulated<S>,
        p: &mut Wrench<S>,
        bias: Bias<'_, S>,
        tau: &[S],
        pivots: &mut [Pivot<S>],
    );
    /// `u̇` and the body's acceleration from the acceleration `a` that the parent gives.
    fn solve(&self, a: Twist<S>, pivots: &[Pivot<S>], acceleration: &mut [S]) -> Twist<S>;
    /// What is left after the elimination, at P's origin in P's axes.
    fn reduced_out(&self, i: &Articulated<S>) -> Articulated<S>;

    /// The parent's motion at B's origin in B's axes.
    #[inline]
    fn motion_into(&self, v: Twist<S>) -> Twist<S> {
        Twist::new(self.back(v.angular), self.back(v.linear + v.angular.cross(self.position())))
    }
    /// The body's wrench at P's origin in P's axes.
    #[inline]
    fn wrench_out(&self, f: Wrench<S>) -> Wrench<S> {
        let force = self.out(f.force);
        Wrench::new(self.out(f.torque) + self.position().cross(force), force)
    }
    /// A rigid body's inertia at P's origin in P's axes.
    ///
    /// ```text
    /// h′ = R h + m p      I′ = R I Rᵀ + 2 (p · g) 1 − (p gᵀ + g pᵀ),  g = R h + ½ m p
    /// ```
    #[inline]
    fn rigid_out(&self, i: &OriginInertia<S>) -> OriginInertia<S> {
        let p = self.position();
        let (h, mp) = (self.out(i.moment), p * i.mass);
        let g = h + mp * S::constant(0.5);
        let [x, y, z] = std::array::from_fn(|k| p[k] * g[k]);
        let two = S::constant(2.0);
        let product = |a: usize, b: usize| -(p[a] * g[b] + p[b] * g[a]);
        let shift =
            Symmetric([two * (y + z), two * (x + z), two * (x + y), product(0, 1), product(0, 2), product(1, 2)]);
        OriginInertia { mass: i.mass, moment: h + mp, tensor: self.tensor_out(&i.tensor) + shift }
    }
}

/// What [`Products::eliminate`] needs for the bias acceleration.
#[derive(Clone, Copy)]
pub(super) struct Bias<'a, S> {
    pub twist: Twist<S>,
    pub u: &'a [S],
}

/// Binds `$j` to the products of body `$b`'s joint and evaluates `$e`, compiled once for each kind of joint.
macro_rules! with_joint {
    ($tree:expr, $work:expr, $b:expr, |$j:ident| $e:expr) => {{
        use $crate::tree::bodies::Kernel;
        use $crate::tree::general::{General, Straight};
        use $crate::tree::revolute::{Mounted, Revolute};
        let (link, place) = (&$tree.links[$b], &$work.places[$b]);
        let (sin, cos) = (place.sin, place.cos);
        match link.kernel {
            Kernel::RevoluteX => {
                let $j = Revolute::<_, 0> { sin, cos, position: link.position };
                $e
            }
            Kernel::RevoluteY => {
                let $j = Revolute::<_, 1> { sin, cos, position: link.position };
                $e
            }
            Kernel::RevoluteZ => {
                let $j = Revolute::<_, 2> { sin, cos, position: link.position };
                $e
            }
            Kernel::MountedX => {
                let joint = Revolute::<_, 0> { sin, cos, position: link.position };
                let $j = Mounted { joint, rotation: $work.rotations[$b] };
                $e
            }
            Kernel::MountedY => {
                let joint = Revolute::<_, 1> { sin, cos, position: link.position };
                let $j = Mounted { joint, rotation: $work.rotations[$b] };
                $e
            }
            Kernel::MountedZ => {
                let joint = Revolute::<_, 2> { sin, cos, position: link.position };
                let $j = Mounted { joint, rotation: $work.rotations[$b] };
                $e
            }
            Kernel::Straight => {
                let $j = General { turn: Straight, place: *place, body: &$tree.bodies()[$b] };
                $e
            }
            Kernel::Turned => {
                let $j = General { turn: $work.rotations[$b], place: *place, body: &$tree.bodies()[$b] };
                $e
            }
        }
    }};
}
pub(super) use with_joint;
