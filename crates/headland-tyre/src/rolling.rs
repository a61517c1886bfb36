//! [`RollingResistance`] and [`Overturning`]: the moments that the simple laws leave out.

use headland_expr::Scalar;

use crate::guard::num;

/// Rolling resistance as a moment about the axle.
///
/// ```text
/// M_y = −d f F_z R        f = f₀ + f₁ |V_x| + f₄ V_x⁴        d: direction of rolling, −1 to 1
/// ```
/// # References
/// Mitschke and Wallentowitz, *Dynamik der Kraftfahrzeuge*, 4th ed. 2004, sec. 2.2.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct RollingResistance<S> {
    /// `f₀`.
    pub constant: S,
    /// `f₁`, s/m.
    pub linear: S,
    /// `f₄`, s⁴/m⁴.
    pub quartic: S,
    /// `R`, m.
    pub radius: S,
}

impl<S: Scalar> RollingResistance<S> {
    /// `M_y` in N·m by the load, the speed `V_x` and the direction of rolling.
    pub fn moment(&self, load: S, speed: S, direction: S) -> S {
        let f = self.constant + self.linear * speed.abs() + self.quartic * speed.powi(4);
        -(direction * f * load * self.radius)
    }
}

/// Overturning moment: the load's centre of pressure moves sideways.
///
/// ```text
/// M_x = F_z (F_y / k_y − r_c sin γ)
/// ```
/// The carcass, with lateral stiffness `k_y`, lets the contact move with the lateral force; a tread whose crown has the
/// radius `r_c` rolls sideways onto its shoulder. Where the point of contact moves itself, as with a torus, `r_c = 0`.
///
/// # References
/// Pacejka 2012, sec. 4.3.4 and 9.3.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Overturning<S> {
    /// `1/k_y`, m/N.
    pub compliance: S,
    /// `r_c`, m.
    pub crown: S,
}

impl<S: Scalar> Overturning<S> {
    /// `M_x` in N·m.
    pub fn moment(&self, load: S, lateral: S, camber: S) -> S {
        load.max(num(0.0)) * (lateral * self.compliance - self.crown * camber.sin())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rolling_takes_power_and_lean_rights_itself_away_from_the_centre() {
        let law = RollingResistance { constant: 0.015, linear: 1e-4, quartic: 1e-9, radius: 0.5 };
        for (spin, direction) in [(3.0, 1.0), (-3.0, -1.0)] {
            assert!(law.moment(1e4, spin * 0.5, direction) * spin < 0.0);
        }
        assert_eq!(law.moment(1e4, 0.0, 0.0), 0.0);
        assert_eq!(law.moment(1e4, 2.0, 1.0), -(0.015 + 2e-4 + 1.6e-8) * 5e3);
        let law = Overturning { compliance: 1e-6, crown: 0.1 };
        // leaning to the right, the centre of pressure is on the right: the load turns the wheel back to the left
        assert!(law.moment(1e4, 0.0, 0.1) < 0.0);
        assert_eq!(law.moment(1e4, 2e3, 0.0), 20.0);
        assert_eq!(law.moment(-1.0, 2e3, 0.1), 0.0);
    }
}
