//! [`Draught`]: the pull that a tillage tool needs, by speed and depth.

use headland_expr::Scalar;

use crate::guard::{clamp, num, smooth_sign};

/// Draught of a tool in the form of ASABE D497.
///
/// ```text
/// D = F (A + B S + C S²) w d        S: speed in km/h,  d: depth in cm,  w: width in m or number of tools,  D in N
/// ```
/// `A`, `B`, `C` belong to the tool and `F` to the texture of the soil (1 for fine); they are those of the standard, in its
/// units, and are not shipped here: a scene gives them with their source. The force acts against the motion, smoothly through
/// standstill, and vanishes above the ground.
///
/// # References
/// ASABE D497, *Agricultural Machinery Management Data*, clause 4; Harrigan and Rotz, *Draft relationships for tillage and
/// seeding equipment*, Applied Eng. in Agric. 11, 1995.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Draught<S> {
    /// `F`.
    pub soil: S,
    /// `A`, N/(m·cm).
    pub constant: S,
    /// `B`, N·h/(m·cm·km).
    pub linear: S,
    /// `C`, N·h²/(m·cm·km²).
    pub quadratic: S,
    /// `w`, m or number of tools.
    pub width: S,
    /// Speed `> 0` over which the direction of the force turns, m/s.
    pub creep: S,
    /// Greatest depth, m; deeper is taken as this.
    pub depth: S,
}

impl<S: Scalar> Draught<S> {
    /// Force on the tool along its direction of travel, N, by speed in m/s and depth in m; negative forward.
    pub fn force(&self, speed: S, depth: S) -> S {
        let s = num::<S>(3.6) * speed.abs();
        let d = num::<S>(100.0) * clamp(depth, num(0.0), self.depth);
        let size = self.soil * (self.constant + s * (self.linear + self.quadratic * s)) * self.width * d;
        -(size * smooth_sign(speed, self.creep))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use headland_expr::Dual;

    /// Round numbers, illustrative.
    fn tool<S: Scalar>() -> Draught<S> {
        let [soil, constant, linear, quadratic, width, creep, depth] = [0.7, 600.0, 2.0, 5.0, 1.5, 1e-3, 0.3].map(num);
        Draught { soil, constant, linear, quadratic, width, creep, depth }
    }

    #[test]
    fn units_are_those_of_the_standard() {
        // 7.2 km/h, 20 cm
        let by_hand = 0.7 * (600.0 + 2.0 * 7.2 + 5.0 * 7.2 * 7.2) * 1.5 * 20.0;
        assert_relative_eq!(tool::<f64>().force(2.0, 0.2), -by_hand, max_relative = 1e-6);
        assert_relative_eq!(tool::<f64>().force(-2.0, 0.2), by_hand, max_relative = 1e-6);
        assert_eq!(tool::<f64>().force(2.0, -0.1), 0.0);
        assert_eq!(tool::<f64>().force(2.0, 0.9), tool::<f64>().force(2.0, 0.3));
    }

    #[test]
    fn it_takes_power_and_is_smooth_at_standstill() {
        for v in [-3.0, -1e-6, 0.0, 1e-6, 3.0] {
            let f = tool::<Dual<f64>>().force(Dual::new(v, 1.0), num(0.2));
            assert!(f.value * v <= 0.0 && f.dot.is_finite() && f.dot <= 0.0, "{v}: {f:?}");
        }
    }
}
