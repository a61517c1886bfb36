//! [`Motion`]: how a wheel moves over the ground; [`Relaxation`]: how its slip follows.
//!
//! ```text
//! a  axle, to the left       n  normal of the ground          x = a × n / |a × n|,  y = n × x
//! r = −R_l (x × a)           from the centre to the contact point, in the wheel's plane
//! V = v + (ω − Ω a) × r      of the contact point, as if the wheel did not spin;  Ω = ω·a
//! V_sx = V_x − R_e Ω         V_sy = V_y        sin γ = a·n       ψ' = (ω − Ω a)·n
//! ```
//!
//! # References
//! Pacejka, *Tire and Vehicle Dynamics*, 3rd ed. 2012, sec. 2.2.

use std::f64::consts::PI;

use headland_expr::Scalar;
use headland_spatial::Vector;

use crate::guard::{clamp, num, smooth_abs, smooth_sign};
use crate::law::Slip;

/// Motion of a wheel relative to the ground, in the axes of its contact frame.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Motion<S> {
    /// `V_x`, m/s.
    pub forward: S,
    /// `V_sx`, m/s: zero in free rolling.
    pub slip_x: S,
    /// `V_sy = V_y`, m/s.
    pub slip_y: S,
    /// `Ω`, rad/s: positive rolls forward.
    pub spin: S,
    /// `γ`, rad.
    pub camber: S,
    /// `ψ'`, rad/s.
    pub turn: S,
}

/// Axes of the contact frame, written in the frame of the vectors given.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct ContactAxes<S> {
    /// Forward, along the wheel's plane and the ground.
    pub x: Vector<S>,
    /// To the left along the ground.
    pub y: Vector<S>,
    /// Normal of the ground.
    pub z: Vector<S>,
}

impl<S: Scalar> ContactAxes<S> {
    /// Axes by the wheel's axle and the ground's normal, both of length one and not parallel: a wheel that lies on its
    /// side has no direction, and the axes are then not finite.
    pub fn new(axle: Vector<S>, normal: Vector<S>) -> Self {
        let x = axle.cross(normal).unit();
        Self { x, y: normal.cross(x), z: normal }
    }

    /// From the wheel's centre to its lowest point, `−R_l (x × a)`, in m.
    pub fn lowest_point(&self, axle: Vector<S>, loaded_radius: S) -> Vector<S> {
        self.x.cross(axle) * -loaded_radius
    }
}

impl<S: Scalar> Motion<S> {
    /// By the velocity `v` of the wheel's centre and its angular velocity `ω`, both relative to the ground; `loaded` is the
    /// distance from the centre to the contact point and `effective` the radius of free rolling, m.
    pub fn new(
        v: Vector<S>,
        omega: Vector<S>,
        axle: Vector<S>,
        axes: &ContactAxes<S>,
        loaded: S,
        effective: S,
    ) -> Self {
        let spin = omega.dot(axle);
        let carrier = omega - axle * spin;
        let contact = v + carrier.cross(axes.lowest_point(axle, loaded));
        let forward = contact.dot(axes.x);
        let lean = clamp(axle.dot(axes.z), num(-1.0 + 1e-12), num(1.0 - 1e-12));
        Self {
            forward,
            slip_x: forward - effective * spin,
            slip_y: contact.dot(axes.y),
            spin,
            camber: lean.asin(),
            turn: carrier.dot(axes.z),
        }
    }

    /// Slip without delay, the speed rounded off over `creep > 0` in m/s: below it slip falls to `−V_s / creep`, a damper.
    ///
    /// ```text
    /// κ = −V_sx / √(V_x² + ε²)     tan α = V_sy / √(V_x² + ε²)
    /// ```
    pub fn slip(&self, creep: S) -> Slip<S> {
        let speed = smooth_abs(self.forward, creep);
        self.with_slip(-self.slip_x / speed, self.slip_y / speed, creep)
    }

    /// Slip given from elsewhere, say from relaxation states.
    pub fn with_slip(&self, kappa: S, tan_alpha: S, creep: S) -> Slip<S> {
        Slip { kappa, tan_alpha, camber: self.camber, speed: self.forward, direction: self.direction(creep) }
    }

    /// 1 forward, −1 backward, `V_x / √(V_x² + ε²)`.
    pub fn direction(&self, creep: S) -> S {
        smooth_sign(self.forward, creep)
    }

    /// Turn slip `φ = −(ψ' + Ω sin γ) / √(V_x² + ε²)`, 1/m; no law here uses it.
    ///
    /// # References
    /// Pacejka 2012, sec. 2.2, without the factor of camber reduction.
    pub fn turn_slip(&self, creep: S) -> S {
        -(self.turn + self.spin * self.camber.sin()) / smooth_abs(self.forward, creep)
    }

    /// Power of the slip forces that a law gave, W: what the contact takes from the motion is its negative.
    ///
    /// ```text
    /// P = F_x V_sx + F_y V_sy + M_y Ω + M_z (ψ' + Ω sin γ)
    /// ```
    pub fn slip_power(&self, f: &crate::law::Forces<S>) -> S {
        f.fx * self.slip_x + f.fy * self.slip_y + f.my * self.spin + f.mz * (self.turn + self.spin * self.camber.sin())
    }
}

/// First-order relaxation of slip: the tyre's carcass is a spring between rim and contact.
///
/// ```text
/// σ_κ κ' + |V_x| κ = −V_sx − b(κ)        σ_α τ' + |V_x| τ = V_sy − b(τ),  τ = tan α
/// slip for the law:  κ − (k/C_κ) w V_sx,  τ + (k/C_α) w V_sy      w = ½ (1 + cos π min(1, |V_x|/V_low))
/// b(s) = w |V_s| sign(s) max(0, |s|/s_max − 1)²
/// ```
/// There is no division by the speed: at standstill the states are deflections over `σ`, which hold a vehicle on a slope;
/// the damping `k` takes out the oscillation of the vehicle on that spring, at low speed only. `b` bounds a state to
/// `2 s_max` where the wheel slides without rolling; above `V_low` both vanish and the steady slip is the kinematic one. The
/// equations are the same backwards.
///
/// # References
/// Pacejka 2012, sec. 7.2 and 8.6 (the damping after Besselink, *Shimmy of Aircraft Main Landing Gears*,
/// 2000); there a state stops at its bound, here it is drawn back continuously.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Relaxation<S> {
    /// Relaxation lengths `[σ_κ, σ_α]`, m, positive.
    pub length: [S; 2],
    /// `V_low`, m/s, positive.
    pub low_speed: S,
    /// Damping at standstill `[k_x, k_y]`, N·s/m.
    pub damping: [S; 2],
    /// `s_max` of both states: well beyond the slip of greatest force, and below ½ along the wheel, so that `|κ|` stays
    /// below 1 where laws use [theoretical slip](Slip::theoretical).
    pub limit: [S; 2],
}

impl<S: Scalar> Relaxation<S> {
    /// Rates of the states `[κ, tan α]`, 1/s.
    pub fn rates(&self, state: [S; 2], motion: &Motion<S>) -> [S; 2] {
        let speed = motion.forward.abs();
        let window = self.window(speed);
        let drive = [-motion.slip_x, motion.slip_y];
        std::array::from_fn(|i| {
            let beyond = (state[i].abs() / self.limit[i] - num(1.0)).max(num(0.0));
            let back = window * drive[i].abs() * state[i].sign() * beyond * beyond;
            (drive[i] - speed * state[i] - back) / self.length[i]
        })
    }

    /// Slip for a law: the states, damped at low speed by the law's slip stiffnesses `C` at this load.
    pub fn slip(&self, state: [S; 2], motion: &Motion<S>, stiffness: [S; 2], creep: S) -> Slip<S> {
        let window = self.window(motion.forward.abs());
        let drive = [-motion.slip_x, motion.slip_y];
        // without load there is no stiffness and no force either
        let damped = |i: usize| state[i] + self.damping[i] / stiffness[i].max(num(1.0)) * window * drive[i];
        motion.with_slip(damped(0), damped(1), creep)
    }

    /// Damping `k = 2 ζ √(C m / σ)` that gives the mass `m` on the standing wheel's spring the damping ratio `ζ`.
    pub fn critical_damping(&self, stiffness: [S; 2], mass: S, ratio: S) -> [S; 2] {
        std::array::from_fn(|i| num::<S>(2.0) * ratio * (stiffness[i] * mass / self.length[i]).max(num(0.0)).sqrt())
    }

    fn window(&self, speed: S) -> S {
        let part = (speed / self.low_speed).min(num(1.0));
        num::<S>(0.5) * (num::<S>(1.0) + (num::<S>(PI) * part).cos())
    }
}

/// Rate of a relaxing slip angle `α` (the angle itself, for laws linear in it): `σ α' + |V_x| α = |V_x| α_kin`.
pub fn relax_towards<S: Scalar>(alpha: S, kinematic: S, speed: S, length: S) -> S {
    speed.abs() * (kinematic - alpha) / length
}
