//! [`Brush`]: Fiala's tyre, a row of bristles under a parabolic pressure.

use headland_expr::Scalar;

use crate::guard::{length, num};
use crate::law::{Forces, Slip, SlipLaw};

/// The brush model with combined slip.
///
/// ```text
/// g = (C_κ σ_x, −C_α σ_y)      G = |g|      φ = G / (3 μ F_z)      σ: theoretical slip
/// F = g (1 − φ + φ²/3)                   φ ≤ 1, part of the contact adheres
/// F = g μ F_z / G                        φ > 1, all of it slides
/// M_z = −t d F_y                         t = ⅓ a (1 − φ)³ / (1 − φ + φ²/3),  0 where all slides
/// ```
/// `C_κ`, `C_α` are proportional to the load up to their nominal value (`C = C₀ F_z/F_z0`), or constant. Camber adds `C_γ γ`
/// to `g` as a lateral slip does. `a` is half the contact length at nominal load and grows with the root of the load.
///
/// # References
/// Fiala, *Seitenkräfte am rollenden Luftreifen*, VDI-Z 96, 1954; Pacejka 2012, sec. 3.2.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Brush<S> {
    /// `C_κ` at the nominal load, N.
    pub longitudinal: S,
    /// `C_α` at the nominal load, N/rad.
    pub cornering: S,
    /// `C_γ` at the nominal load, N/rad.
    pub camber: S,
    /// Coefficient of friction `μ`.
    pub friction: S,
    /// Half the contact length `a` at the nominal load, m.
    pub half_length: S,
    /// Nominal load `F_z0`, N.
    pub load: S,
    /// True: stiffnesses grow with the load; false: they do not depend on it.
    pub proportional: bool,
}

impl<S: Scalar> Brush<S> {
    fn share(&self, load: S) -> S {
        if self.proportional { load / self.load } else { num(1.0) }
    }
}

impl<S: Scalar> SlipLaw<S> for Brush<S> {
    fn forces(&self, load: S, friction: S, slip: &Slip<S>) -> Forces<S> {
        let [along, across] = self.stiffness(load);
        let [sx, sy] = slip.theoretical();
        let g = [along * sx, -across * sy - self.share(load) * self.camber * slip.camber];
        let size = length(g[0], g[1]);
        let grip = (self.friction * friction * load).max(num(0.0));
        let third = num::<S>(1.0 / 3.0);
        // both branches are evaluated: φ ≤ 1 in the one, G well above zero in the other
        let phi = (third * size / grip.max(num(1e-9))).min(num(1.0));
        let adhering = num::<S>(1.0) - phi + third * phi * phi;
        let slides = num::<S>(3.0) * grip - size;
        let factor = S::select(slides, adhering, grip / size.max(num(1e-9)));
        let left = num::<S>(1.0) - phi;
        let share = (load / self.load).max(num(1e-12));
        let trail = third * self.half_length * share.sqrt() * left * left * left / adhering;
        let fy = factor * g[1];
        Forces { fx: factor * g[0], fy, mz: -trail * slip.direction * fy, ..Forces::zero() }
    }

    fn stiffness(&self, load: S) -> [S; 2] {
        let share = self.share(load);
        [share * self.longitudinal, share * self.cornering]
    }
}
