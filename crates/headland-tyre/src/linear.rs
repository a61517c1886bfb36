//! [`Linear`]: forces proportional to slip.

use headland_expr::Scalar;

use crate::guard::num;
use crate::law::{Forces, Slip, SlipLaw};

/// The linear tyre.
///
/// ```text
/// F_x = λ C_κ κ     F_y = −λ (C_α tan α + C_γ γ)     M_z = −t d F_α,  F_α = −λ C_α tan α     λ = F_z/F_z0, or 1
/// ```
/// `d` is the direction of rolling. There is no bound of friction: it holds for small slip only, and `friction` is not used.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Linear<S> {
    /// `C_κ`, N.
    pub longitudinal: S,
    /// `C_α`, N/rad.
    pub cornering: S,
    /// `C_γ`, N/rad.
    pub camber: S,
    /// Pneumatic trail `t`, m.
    pub trail: S,
    /// Load `F_z0` in N at which the stiffnesses hold; `None`: they do not depend on the load.
    pub load: Option<S>,
}

impl<S: Scalar> Linear<S> {
    fn share(&self, load: S) -> S {
        self.load.map_or(num(1.0), |nominal| load / nominal)
    }
}

impl<S: Scalar> SlipLaw<S> for Linear<S> {
    fn forces(&self, load: S, _friction: S, slip: &Slip<S>) -> Forces<S> {
        let [along, across] = self.stiffness(load);
        let side = -across * slip.tan_alpha;
        Forces {
            fx: along * slip.kappa,
            fy: side - self.share(load) * self.camber * slip.camber,
            mz: -self.trail * slip.direction * side,
            ..Forces::zero()
        }
    }

    fn stiffness(&self, load: S) -> [S; 2] {
        let share = self.share(load);
        [share * self.longitudinal, share * self.cornering]
    }
}
