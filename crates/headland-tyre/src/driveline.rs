//! What turns and stops wheels: engine, governor, differential, brake.

use headland_expr::{Scalar, Spline};

use crate::guard::{clamp, num, smooth_step};

/// An engine by its full-load curve.
///
/// ```text
/// T = u T_full(ω) − (1 − u) T_drag ω/ω_r      0 ≤ u ≤ 1: the fraction of fuel
/// ```
/// Beyond the table the curve goes on as a line; torque does not become negative by it.
#[derive(Clone, Debug)]
pub struct Engine<S> {
    /// Full-load torque in N·m by speed in rad/s.
    pub full_load: Spline,
    /// Drag `T_drag` at the rated speed without fuel, N·m.
    pub drag: S,
    /// Rated speed `ω_r`, rad/s.
    pub rated: S,
}

impl<S: Scalar> Engine<S> {
    /// Torque in N·m by speed in rad/s and the fraction of fuel.
    pub fn torque(&self, speed: S, fuel: S) -> S {
        let u = clamp(fuel, num(0.0), num(1.0));
        let full = speed.spline(&self.full_load, 0).max(num(0.0));
        u * full - (num::<S>(1.0) - u) * self.drag * speed / self.rated
    }
}

/// A speed governor: fuel falls from full to none over a droop of speed, with the lag of its actuator.
///
/// ```text
/// u* = s((ω_set (1 + δ) − ω) / (δ ω_set))        s: smooth step from 0 to 1;  full fuel at ω_set, none at (1 + δ) ω_set
/// τ u' = u* − u
/// ```
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Governor<S> {
    /// Speed at which full fuel begins to be taken back, `ω_set`, rad/s.
    pub set: S,
    /// Droop `δ > 0`, a fraction.
    pub droop: S,
    /// Lag `τ > 0`, s.
    pub lag: S,
}

impl<S: Scalar> Governor<S> {
    /// Fraction of fuel `u*` asked for at a speed in rad/s.
    pub fn fuel(&self, speed: S) -> S {
        let band = self.droop * self.set;
        smooth_step((self.set + band - speed) / band)
    }

    /// Rate `u'` of the actuator's state, 1/s.
    pub fn rate(&self, speed: S, fuel: S) -> S {
        (self.fuel(speed) - fuel) / self.lag
    }
}

/// A bevel differential with a final drive of ratio `i`, input over output.
///
/// ```text
/// open     ω_in = i (ω_l + ω_r)/2      T_l = T_r = i T/2          a relation of velocities and its dual
/// locked   ω_l = ω_r                                              a constraint, or a stiff clutch:
/// lock     L = clamp(k Δ + d (ω_l − ω_r), ±L_max),  Δ' = ω_l − ω_r,   T_l = i T/2 − L,  T_r = i T/2 + L
/// ```
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Differential<S> {
    /// `i`.
    pub ratio: S,
}

/// A lock of a [`Differential`] that gives.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Lock<S> {
    /// `k`, N·m/rad.
    pub stiffness: S,
    /// `d`, N·m·s/rad.
    pub damping: S,
    /// `L_max`, N·m: a limited-slip differential has a small one.
    pub limit: S,
}

impl<S: Scalar> Differential<S> {
    /// Speed of the input shaft, rad/s.
    pub fn input_speed(&self, left: S, right: S) -> S {
        num::<S>(0.5) * self.ratio * (left + right)
    }

    /// Torques `[left, right]` in N·m of an open differential.
    pub fn open(&self, input: S) -> [S; 2] {
        let half = num::<S>(0.5) * self.ratio * input;
        [half, half]
    }

    /// Torques `[left, right]` in N·m with a lock; `twist` is the angle `Δ` since it was engaged.
    pub fn locked(&self, input: S, lock: &Lock<S>, twist: S, left: S, right: S) -> [S; 2] {
        let half = num::<S>(0.5) * self.ratio * input;
        let moment = clamp(lock.stiffness * twist + lock.damping * (left - right), -lock.limit, lock.limit);
        [half - moment, half + moment]
    }

    /// Row of the constraint `ω_l − ω_r = 0` of a rigid lock, by `[ω_in, ω_l, ω_r]`, and of the final drive.
    pub fn rows(&self) -> [[S; 3]; 2] {
        let (zero, one) = (num::<S>(0.0), num::<S>(1.0));
        let half = num::<S>(-0.5) * self.ratio;
        [[one, half, half], [zero, one, -one]]
    }
}

/// A brake that holds: friction with a state, the elastic windup of its pads.
///
/// ```text
/// θ_b s' = ω − |ω| s                     s → sign ω where it slips, a spring below
/// T = −T_max (s + τ(ω) s')               τ(ω) = τ_0 / (1 + (ω/ω_d)²)
/// ```
/// At rest the torque is any between `±T_max` that holds the wheel, without creep; the pressed level `T_max ≥ 0` may change at
/// any time. The damping `τ_0` stills the wheel on the spring of the pads and fades with speed.
///
/// # References
/// Dahl, *A solid friction model*, Aerospace Corp. 1968; Canudas de Wit et al., *A new model for control of systems with
/// friction*, IEEE Trans. Autom. Control 40, 1995 (the fading damping).
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Brake<S> {
    /// Windup `θ_b > 0` at which the brake slips, rad.
    pub windup: S,
    /// Damping `τ_0`, s.
    pub damping: S,
    /// Speed `ω_d > 0` at which damping has halved, rad/s.
    pub fade: S,
}

impl<S: Scalar> Brake<S> {
    /// Rate of the state `s`, 1/s, by the speed of the wheel in rad/s.
    pub fn rate(&self, speed: S, state: S) -> S {
        (speed - speed.abs() * state) / self.windup
    }

    /// Torque on the wheel in N·m at the pressed level `T_max` in N·m.
    pub fn torque(&self, level: S, speed: S, state: S) -> S {
        let ratio = speed / self.fade;
        let tau = self.damping / (num::<S>(1.0) + ratio * ratio);
        -level.max(num(0.0)) * (state + tau * self.rate(speed, state))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    fn engine() -> Engine<f64> {
        let full_load = Spline::new("engine", &[80.0, 150.0, 220.0], &[500.0, 600.0, 450.0]).unwrap();
        Engine { full_load, drag: 60.0, rated: 220.0 }
    }

    #[test]
    fn the_engine_is_its_curve_at_full_fuel_and_drags_without() {
        let e = engine();
        assert_relative_eq!(e.torque(150.0, 1.0), 600.0);
        assert_relative_eq!(e.torque(150.0, 7.0), 600.0);
        assert_relative_eq!(e.torque(220.0, 0.0), -60.0);
        assert!(e.torque(2000.0, 1.0) >= 0.0);
    }

    /// With the governor the engine settles where its torque is the load's, within the droop.
    #[test]
    fn the_governor_settles_within_its_droop() {
        let (e, g) = (engine(), Governor { set: 200.0, droop: 0.08, lag: 0.05 });
        assert_eq!([g.fuel(150.0), g.fuel(200.0), g.fuel(216.0), g.fuel(230.0)], [1.0, 1.0, 0.0, 0.0]);
        let (mut speed, mut fuel) = (100.0, 0.5);
        for _ in 0..200_000 {
            let torque = e.torque(speed, fuel) - 300.0;
            (speed, fuel) = (speed + 1e-4 * torque / 1.5, fuel + 1e-4 * g.rate(speed, fuel));
        }
        assert!(speed > 200.0 && speed < 216.0, "{speed}");
        assert_relative_eq!(e.torque(speed, g.fuel(speed)), 300.0, max_relative = 1e-6);
    }

    #[test]
    fn a_differential_loses_no_power_but_in_its_lock() {
        let d = Differential { ratio: 4.0 };
        let lock = Lock { stiffness: 1e4, damping: 50.0, limit: 300.0 };
        let (left, right, input) = (7.0, 9.0, 120.0);
        let power = |t: [f64; 2]| t[0] * left + t[1] * right;
        assert_relative_eq!(power(d.open(input)), input * d.input_speed(left, right));
        let locked = d.locked(input, &lock, 0.0, left, right);
        assert_relative_eq!(power(locked), input * d.input_speed(left, right) - 50.0 * 4.0);
        assert_relative_eq!(locked[0] + locked[1], 480.0);
        assert_eq!(d.locked(0.0, &lock, 1.0, left, right), [-300.0, 300.0]);
        let [drive, rigid] = d.rows();
        let at = [d.input_speed(8.0, 8.0), 8.0, 8.0];
        for row in [drive, rigid] {
            assert_eq!(row[0] * at[0] + row[1] * at[1] + row[2] * at[2], 0.0);
        }
    }

    /// A wheel with a load below the brake's level stands still; above it, it accelerates by the difference.
    #[test]
    fn the_brake_holds_and_slips() {
        let brake = Brake { windup: 1e-3, damping: 0.02, fade: 0.1 };
        let run = |load: f64, time: f64| {
            let (inertia, level, h) = (5.0, 1000.0, 1e-4);
            let (mut angle, mut speed, mut s) = (0.0, 0.0, 0.0);
            let mut samples = Vec::new();
            for step in 0..(time / h) as usize {
                let rates = |w: f64, s: f64| ((load + brake.torque(level, w, s)) / inertia, brake.rate(w, s));
                let (a1, s1) = rates(speed, s);
                let (a2, s2) = rates(speed + 0.5 * h * a1, s + 0.5 * h * s1);
                angle += h * (speed + 0.5 * h * a1);
                (speed, s) = (speed + h * a2, s + h * s2);
                if step % 50_000 == 49_999 {
                    samples.push(angle);
                }
            }
            (samples, speed)
        };
        let (angles, speed) = run(800.0, 60.0);
        assert!(angles[0] > 0.0 && angles[0] < 3e-3);
        assert!((angles[angles.len() - 1] - angles[1]).abs() < 1e-9);
        assert!(speed.abs() < 1e-9);
        let (_, speed) = run(1500.0, 10.0);
        assert_relative_eq!(speed, 500.0 / 5.0 * 10.0, max_relative = 1e-2);
        assert_eq!(brake.torque(0.0, 3.0, 1.0), 0.0);
        assert_relative_eq!(brake.torque(1000.0, 50.0, 1.0), -1000.0);
        assert_relative_eq!(brake.torque(1000.0, -50.0, -1.0), 1000.0);
    }
}
