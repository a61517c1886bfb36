//! [`General`]: every other joint, by the table of its freedoms in the body's axes.

use headland_expr::Scalar;
use headland_spatial::{Axis, Rotation, Symmetric, Twist, Vector, Wrench};

use super::articulated::{Articulated, Pivot};
use super::bodies::{Body, Mount};
use super::joint::Joint;
use super::products::{Bias, Products};
use super::workspace::Place;

/// `R_PB` or the absence of one.
pub(super) trait Turn<S: Scalar> {
    fn out(&self, v: Vector<S>) -> Vector<S>;
    fn back(&self, v: Vector<S>) -> Vector<S>;
    fn tensor_out(&self, t: &Symmetric<S>) -> Symmetric<S>;
    fn matrix_out(&self, m: &[[S; 3]; 3]) -> [[S; 3]; 3];
}

/// The body's axes are the parent's.
#[derive(Clone, Copy)]
pub(super) struct Straight;

impl<S: Scalar> Turn<S> for Straight {
    #[inline]
    fn out(&self, v: Vector<S>) -> Vector<S> {
        v
    }
    #[inline]
    fn back(&self, v: Vector<S>) -> Vector<S> {
        v
    }
    #[inline]
    fn tensor_out(&self, t: &Symmetric<S>) -> Symmetric<S> {
        *t
    }
    #[inline]
    fn matrix_out(&self, m: &[[S; 3]; 3]) -> [[S; 3]; 3] {
        *m
    }
}

impl<S: Scalar> Turn<S> for Rotation<S> {
    #[inline]
    fn out(&self, v: Vector<S>) -> Vector<S> {
        self.apply(v)
    }
    #[inline]
    fn back(&self, v: Vector<S>) -> Vector<S> {
        self.apply_inverse(v)
    }
    #[inline]
    fn tensor_out(&self, t: &Symmetric<S>) -> Symmetric<S> {
        self.apply_to_tensor(t)
    }
    #[inline]
    fn matrix_out(&self, m: &[[S; 3]; 3]) -> [[S; 3]; 3] {
        (*self * Rotation(*m) * self.transpose()).0
    }
}

/// A joint without products of its own.
pub(super) struct General<'a, S, T> {
    pub turn: T,
    pub place: Place<S>,
    pub body: &'a Body<S>,
}

impl<S: Scalar, T: Turn<S>> General<'_, S, T> {
    /// The freedoms that are single entries of a twist in the body's axes (0-2 turn, 3-5 slide), in the order of
    /// [`selected`](Self::selected).
    fn freedoms(&self) -> &'static [usize] {
        match self.body.joint {
            Joint::Revolute(axis) => &[[0], [1], [2]][axis.index()],
            Joint::Prismatic(axis) => &[[3], [4], [5]][axis.index()],
            Joint::Spherical => &[0, 1, 2],
            Joint::Planar => &[2, 3, 4],
            Joint::Free => &[0, 1, 2, 3, 4, 5],
            Joint::Fixed | Joint::RevoluteAbout(_) | Joint::PrismaticAlong(_) | Joint::Helical { .. } => &[],
        }
    }

    /// The freedom that is not a single entry of a twist.
    fn screw(&self) -> Option<Twist<S>> {
        match self.body.joint {
            Joint::RevoluteAbout(a) => Some(Twist::new(a, Vector::zero())),
            Joint::PrismaticAlong(a) => Some(Twist::new(Vector::zero(), a)),
            Joint::Helical { axis, pitch } => {
                Some(Twist::new(Vector::along(axis, S::constant(1.0)), Vector::along(axis, pitch)))
            }
            _ => None,
        }
    }

    /// From F's axes to the body's.
    fn inboard_into(&self, v: Vector<S>) -> Vector<S> {
        match self.body.mount {
            Mount::At(_) => self.turn.back(v),
            Mount::Pose(x) => self.turn.back(x.rotation * v),
        }
    }

    /// From the body's axes to F's.
    fn inboard_out(&self, v: Vector<S>) -> Vector<S> {
        match self.body.mount {
            Mount::At(_) => self.turn.out(v),
            Mount::Pose(x) => x.rotation.apply_inverse(self.turn.out(v)),
        }
    }

    /// Velocities (or torques) of the joint to entries in the body's axes, in the order of [`freedoms`](Self::freedoms).
    fn selected(&self, u: &[S]) -> [S; 6] {
        let Place { sin, cos, .. } = self.place;
        let mut s = [S::constant(0.0); 6];
        s[..u.len()].copy_from_slice(u);
        match self.body.joint {
            Joint::Planar => [s[0], s[1], s[2]] = [u[2], cos * u[0] + sin * u[1], cos * u[1] - sin * u[0]],
            Joint::Free => [s[3], s[4], s[5]] = self.inboard_into(Vector([u[3], u[4], u[5]])).0,
            _ => {}
        }
        s
    }

    /// The inverse, which is the transpose, of [`selected`](Self::selected).
    fn unselected(&self, s: [S; 6], u: &mut [S]) {
        let Place { sin, cos, .. } = self.place;
        u.copy_from_slice(&s[..u.len()]);
        match self.body.joint {
            Joint::Planar => u.copy_from_slice(&[cos * s[1] - sin * s[2], sin * s[1] + cos * s[2], s[0]]),
            Joint::Free => u[3..].copy_from_slice(&self.inboard_out(Vector([s[3], s[4], s[5]])).0),
            _ => {}
        }
    }
}

impl<S: Scalar, T: Turn<S>> Products<S> for General<'_, S, T> {
    #[inline]
    fn out(&self, v: Vector<S>) -> Vector<S> {
        self.turn.out(v)
    }

    #[inline]
    fn back(&self, v: Vector<S>) -> Vector<S> {
        self.turn.back(v)
    }

    #[inline]
    fn tensor_out(&self, t: &Symmetric<S>) -> Symmetric<S> {
        self.turn.tensor_out(t)
    }

    #[inline]
    fn position(&self) -> Vector<S> {
        self.place.position
    }

    #[inline]
    fn motion(&self, u: &[S]) -> Twist<S> {
        if let Some(s) = self.screw() {
            return s * u[0];
        }
        let mut v = Twist::zero();
        for (&k, x) in self.freedoms().iter().zip(self.selected(u)) {
            *entry(&mut v, k) = x;
        }
        v
    }

    #[inline]
    fn bias(&self, v: Twist<S>, u: &[S]) -> Twist<S> {
        let m = self.motion(u);
        let mut c = v.cross(m);
        if matches!(self.body.joint, Joint::Planar | Joint::Free) {
            c.linear = c.linear - m.angular.cross(m.linear); // the slides stay in F's axes
        }
        c
    }

    #[inline]
    fn project(&self, f: Wrench<S>, tau: &mut [S]) {
        if let Some(s) = self.screw() {
            tau[0] = s.power(f);
            return;
        }
        let mut f = Twist::new(f.torque, f.force);
        let mut s = [S::constant(0.0); 6];
        for (x, &k) in s.iter_mut().zip(self.freedoms()) {
            *x = *entry(&mut f, k);
        }
        self.unselected(s, tau);
    }

    #[inline]
    fn eliminate(
        &self,
        i: &mut Articulated<S>,
        p: &mut Wrench<S>,
        bias: Bias<'_, S>,
        tau: &[S],
        pivots: &mut [Pivot<S>],
    ) {
        if let Some(s) = self.screw() {
            pivots[0] = i.eliminate_screw(s, p, tau[0]);
        } else {
            let s = self.selected(tau);
            for ((&k, tau), pivot) in self.freedoms().iter().zip(s).zip(pivots) {
                *pivot = i.eliminate_entry(k, p, tau);
            }
        }
        *p = *p + i.apply(self.bias(bias.twist, bias.u));
    }

    #[inline]
    fn solve(&self, a: Twist<S>, pivots: &[Pivot<S>], acceleration: &mut [S]) -> Twist<S> {
        let mut a = a;
        if let Some(s) = self.screw() {
            let Pivot { column: g, rest, .. } = pivots[0];
            acceleration[0] = rest - a.power(Wrench::new(Vector([g[0], g[1], g[2]]), Vector([g[3], g[4], g[5]])));
            return a + s * acceleration[0];
        }
        let freedoms = self.freedoms();
        let mut s = [S::constant(0.0); 6];
        for n in (0..freedoms.len()).rev() {
            let Pivot { column: g, rest, .. } = pivots[n];
            let mut sum = *entry(&mut a, freedoms[n]);
            for k in (0..6).filter(|k| *k != freedoms[n]) {
                sum = sum + g[k] * *entry(&mut a, k);
            }
            s[n] = rest - sum;
            let own = entry(&mut a, freedoms[n]);
            *own = *own + s[n];
        }
        self.unselected(s, acceleration);
        a
    }

    #[inline]
    fn reduced_out(&self, i: &Articulated<S>) -> Articulated<S> {
        let turned = Articulated {
            angular: self.turn.tensor_out(&i.angular),
            coupling: self.turn.matrix_out(&i.coupling),
            linear: self.turn.tensor_out(&i.linear),
        };
        turned.shifted(self.place.position)
    }
}

#[inline]
fn entry<S>(v: &mut Twist<S>, k: usize) -> &mut S {
    if k < 3 { &mut v.angular.0[k] } else { &mut v.linear.0[k - 3] }
}

/// Where the joint is: sine and cosine of its angle if it has one, `R_PB` and `p_PB`.
pub(super) fn place<S: Scalar>(body: &Body<S>, q: &[S], place: &mut Place<S>, rotation: &mut Rotation<S>) {
    let X_FM = body.joint.pose(q);
    if matches!(body.joint, Joint::Planar) {
        let x = X_FM.rotation.axis(Axis::X);
        (place.cos, place.sin) = (x[0], x[1]);
    }
    match body.mount {
        Mount::At(p) => {
            *rotation = X_FM.rotation;
            place.position = p + X_FM.position;
        }
        Mount::Pose(x) => {
            let X_PB = x * X_FM;
            *rotation = X_PB.rotation;
            place.position = X_PB.position;
        }
    }
}
