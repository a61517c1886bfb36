//! [`SlipLaw`]: forces and moments by load and slip, what all slip laws have in common.

use headland_expr::Scalar;

/// Slip of a wheel in its contact frame C: x along the wheel's plane forward, y to the left, z normal to the ground.
///
/// ```text
/// κ = −V_sx / |V_x|     tan α = V_sy / |V_x|     V_s: velocity of the slip point of the tyre in the ground
/// ```
/// `κ > 0` drives, `α > 0` slips to the left and gives a force to the right, `γ > 0` leans to the right (axes of
/// ISO 8855, as in TYDEX-W). Where slip has [relaxation](crate::Relaxation) states, they stand here.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Slip<S> {
    /// Longitudinal slip `κ`.
    pub kappa: S,
    /// Lateral slip `tan α`.
    pub tan_alpha: S,
    /// Camber `γ`, rad.
    pub camber: S,
    /// Forward speed `V_x`, m/s; negative backwards.
    pub speed: S,
    /// Direction of rolling: 1 forward, −1 backward, between at creep ([`Motion::direction`](crate::Motion::direction)).
    pub direction: S,
}

impl<S: Scalar> Slip<S> {
    /// Longitudinal and lateral slip of an upright wheel that rolls forward at 1 m/s.
    pub fn forward(kappa: S, tan_alpha: S) -> Self {
        let one = S::constant(1.0);
        Self { kappa, tan_alpha, camber: S::constant(0.0), speed: one, direction: one }
    }

    /// Slip by the speeds of sliding against the belt's, `[σ_x, σ_y] = [κ, tan α] / |1 + d κ|`: `−V_s / |V_r|` up to the sign
    /// of y, `V_r = V_x − V_sx`, d the direction of rolling. A wheel near lock-up is taken at `|1 + d κ| = 1e-3`, where
    /// every tyre slides.
    ///
    /// # References
    /// Pacejka, *Tire and Vehicle Dynamics*, 3rd ed. 2012, sec. 3.2.
    pub fn theoretical(&self) -> [S; 2] {
        let belt = (self.direction * self.kappa + S::constant(1.0)).abs().max(S::constant(1e-3));
        [self.kappa / belt, self.tan_alpha / belt]
    }
}

/// Forces and moments of the ground on the tyre at the contact point, in C; the load itself is not among them.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Forces<S> {
    /// Longitudinal force, N.
    pub fx: S,
    /// Lateral force, N.
    pub fy: S,
    /// Overturning moment, N·m.
    pub mx: S,
    /// Rolling-resistance moment, N·m; against the rolling.
    pub my: S,
    /// Aligning moment, N·m.
    pub mz: S,
}

impl<S: Scalar> Forces<S> {
    /// No force at all.
    pub fn zero() -> Self {
        let zero = S::constant(0.0);
        Self { fx: zero, fy: zero, mx: zero, my: zero, mz: zero }
    }

    /// The same tyre on the other side of the vehicle: what points sideways changes sign.
    pub fn mirrored(self) -> Self {
        Self { fy: -self.fy, mx: -self.mx, mz: -self.mz, ..self }
    }

    /// Sum of two.
    pub fn plus(self, b: Self) -> Self {
        Self { fx: self.fx + b.fx, fy: self.fy + b.fy, mx: self.mx + b.mx, my: self.my + b.my, mz: self.mz + b.mz }
    }
}

/// Forces by load and slip.
pub trait SlipLaw<S: Scalar> {
    /// Forces at the load `F_z ≥ 0` in N; `friction` multiplies the friction of the law's data (1: as measured, above zero).
    fn forces(&self, load: S, friction: S, slip: &Slip<S>) -> Forces<S>;

    /// Slip stiffnesses `[C_κ, C_α]` at zero slip, N per unit slip, both positive.
    fn stiffness(&self, load: S) -> [S; 2];
}
