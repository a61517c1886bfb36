//! [`Motion`]: pose, velocity and acceleration of a frame, built outward from the world, one step of a joint at a time.

use headland_expr::{Expr, Scalar};
use headland_spatial::{Pose, Quaternion, Rotation, Vector};

/// How a frame moves: functions of q; of q, q′, u; of q, q′, u, q″, u′. Vectors stand in the frame's own axes unless
/// they say otherwise.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Motion<'g> {
    /// Axes in the world.
    pub(crate) rotation: Rotation<Expr<'g>>,
    /// Origin in the world.
    pub(crate) position: Vector<Expr<'g>>,
    /// Angular velocity.
    pub(crate) spin: Vector<Expr<'g>>,
    /// Velocity of the origin.
    pub(crate) velocity: Vector<Expr<'g>>,
    /// Rate of the components of the angular velocity: the angular acceleration.
    pub(crate) spin_rate: Vector<Expr<'g>>,
    /// Acceleration of the origin.
    pub(crate) acceleration: Vector<Expr<'g>>,
    /// Gravity.
    pub(crate) gravity: Vector<Expr<'g>>,
    /// Velocity and acceleration of the origin in the world's axes, where they are the simpler form.
    pub(crate) level: Option<(Vector<Expr<'g>>, Vector<Expr<'g>>)>,
    /// Angular velocity and acceleration in the world's axes, where they are the simpler form.
    pub(crate) level_spin: Option<(Vector<Expr<'g>>, Vector<Expr<'g>>)>,
}

/// A coordinate, or a given function of time, with its first and second rates.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Drive<'g> {
    pub(crate) value: Expr<'g>,
    pub(crate) rate: Expr<'g>,
    pub(crate) acceleration: Expr<'g>,
    /// The coordinate that it is, and its sign; `None` for a given function of time.
    pub(crate) of: Option<(usize, f64)>,
}

/// A part of a joint's motion.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Step<'g> {
    /// Turn about a unit vector.
    Turn(Vector<Expr<'g>>, Drive<'g>),
    /// Shift along a unit vector.
    Slide(Vector<Expr<'g>>, Drive<'g>),
    /// Turn by a quaternion; angular velocity in the turned axes, and its rate.
    Ball(Ball<'g>),
}

/// A free turn.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ball<'g> {
    pub(crate) quaternion: Quaternion<Expr<'g>>,
    /// Angular velocity in the turned axes.
    pub(crate) spin: Vector<Expr<'g>>,
    /// Rate of its components.
    pub(crate) rate: Vector<Expr<'g>>,
    /// Coordinates and quasi-velocities that these are, by position.
    pub(crate) of: Option<([usize; 4], [usize; 3])>,
    /// The same in the axes before the turn, where the quasi-velocities stand there.
    pub(crate) level: Option<(Vector<Expr<'g>>, Vector<Expr<'g>>)>,
}

impl<'g> Drive<'g> {
    fn negated(self) -> Self {
        let of = self.of.map(|(i, sign)| (i, -sign));
        Self { value: -self.value, rate: -self.rate, acceleration: -self.acceleration, of }
    }

    /// The drive times a constant.
    pub(crate) fn scaled(self, k: Expr<'g>) -> Self {
        Self { value: self.value * k, rate: self.rate * k, acceleration: self.acceleration * k, of: None }
    }
}

impl<'g> Step<'g> {
    /// The step of the other body relative to this one.
    pub(crate) fn reversed(self) -> Self {
        match self {
            Step::Turn(axis, drive) => Step::Turn(axis, drive.negated()),
            Step::Slide(axis, drive) => Step::Slide(axis, drive.negated()),
            Step::Ball(ball) => {
                // d(R w)/dt = R w′, for w × w = 0
                let r = Rotation::from_quaternion(ball.quaternion);
                let (spin, rate) = (-r.apply(ball.spin), -r.apply(ball.rate));
                Step::Ball(Ball { quaternion: ball.quaternion.conjugate(), spin, rate, of: None, level: None })
            }
        }
    }
}

/// Rotation about a constant unit vector, with structural zeros where it is an axis.
fn about<'g>(axis: Vector<Expr<'g>>, angle: Expr<'g>) -> Rotation<Expr<'g>> {
    use headland_spatial::Axis;
    for a in Axis::ALL {
        let along = |sign: f64| (0..3).all(|i| axis[i].is(if i == a.index() { sign } else { 0.0 }));
        if along(1.0) {
            return Rotation::about(a, angle);
        }
        if along(-1.0) {
            return Rotation::about(a, -angle);
        }
    }
    Rotation::about_unit(axis, angle)
}

impl<'g> Motion<'g> {
    /// The world.
    pub(crate) fn world(gravity: Vector<Expr<'g>>) -> Self {
        let zero = Vector::zero();
        Self {
            rotation: Rotation::identity(),
            position: zero,
            spin: zero,
            velocity: zero,
            spin_rate: zero,
            acceleration: zero,
            gravity,
            level: None,
            level_spin: None,
        }
    }

    /// A frame fixed to this one.
    pub(crate) fn fixed(&self, x: &Pose<Expr<'g>>) -> Self {
        let (r, turn) = (x.position, &x.rotation);
        let still = (0..3).all(|i| r[i].is(0.0));
        let at = |v: Vector<Expr<'g>>, arm: Vector<Expr<'g>>| turn.apply_inverse(v + arm);
        let arm = self.spin.cross(r);
        let arm_rate = self.spin_rate.cross(r) + self.spin.cross(arm);
        Self {
            rotation: self.rotation * *turn,
            position: if still { self.position } else { self.position + self.rotation.apply(r) },
            spin: turn.apply_inverse(self.spin),
            velocity: at(self.velocity, arm),
            spin_rate: turn.apply_inverse(self.spin_rate),
            acceleration: at(self.acceleration, arm_rate),
            gravity: turn.apply_inverse(self.gravity),
            level: self.level.map(|(v, a)| (v + self.rotation.apply(arm), a + self.rotation.apply(arm_rate))),
            level_spin: self.level_spin,
        }
    }

    /// The frame after one step of a joint.
    pub(crate) fn step(&self, step: &Step<'g>) -> Self {
        match step {
            Step::Slide(axis, drive) => self.slide(*axis, drive),
            Step::Turn(axis, drive) => {
                let (w, rate) = (*axis * drive.rate, *axis * drive.acceleration);
                self.turn(&about(*axis, drive.value), w, rate)
            }
            Step::Ball(ball) => {
                let turned = self.turn(&Rotation::from_quaternion(ball.quaternion), ball.spin, ball.rate);
                let stands = (0..3).all(|i| self.spin[i].is(0.0));
                let level_spin = ball.level.filter(|_| stands);
                let level_spin = level_spin.map(|(w, rate)| (self.rotation.apply(w), self.rotation.apply(rate)));
                Self { level_spin, ..turned }
            }
        }
    }

    /// Turned by R with the relative angular velocity w and its rate, both in the turned axes.
    fn turn(&self, r: &Rotation<Expr<'g>>, w: Vector<Expr<'g>>, rate: Vector<Expr<'g>>) -> Self {
        let carried = r.apply_inverse(self.spin);
        let stands = (0..3).all(|i| self.spin[i].is(0.0));
        Self {
            rotation: self.rotation * *r,
            position: self.position,
            spin: carried + w,
            velocity: r.apply_inverse(self.velocity),
            spin_rate: r.apply_inverse(self.spin_rate) + rate + carried.cross(w),
            acceleration: r.apply_inverse(self.acceleration),
            gravity: r.apply_inverse(self.gravity),
            level: self.level.filter(|_| stands),
            level_spin: None,
        }
    }

    /// Shifted along an axis. On a base that does not turn, the world's axes are the simpler form from here on.
    fn slide(&self, axis: Vector<Expr<'g>>, drive: &Drive<'g>) -> Self {
        let shifted = self.fixed(&Pose::at(axis * drive.value));
        let (v, a) = (axis * drive.rate, axis * drive.acceleration);
        let coriolis = self.spin.cross(v) * Expr::constant(2.0);
        let stands = (0..3).all(|i| self.spin[i].is(0.0));
        let level = stands.then(|| (shifted.velocity_in_world(), shifted.acceleration_in_world()));
        Self {
            velocity: shifted.velocity + v,
            acceleration: shifted.acceleration + coriolis + a,
            level: level.map(|(v0, a0)| (v0 + self.rotation.apply(v), a0 + self.rotation.apply(a))),
            ..shifted
        }
    }

    /// Angular velocity in the world's axes.
    pub(crate) fn spin_in_world(&self) -> Vector<Expr<'g>> {
        self.level_spin.map_or_else(|| self.rotation.apply(self.spin), |(w, _)| w)
    }

    /// Velocity of the origin in the world's axes.
    pub(crate) fn velocity_in_world(&self) -> Vector<Expr<'g>> {
        self.level.map_or_else(|| self.rotation.apply(self.velocity), |(v, _)| v)
    }

    /// Acceleration of the origin in the world's axes.
    pub(crate) fn acceleration_in_world(&self) -> Vector<Expr<'g>> {
        self.level.map_or_else(|| self.rotation.apply(self.acceleration), |(_, a)| a)
    }
}
