//! [`Vertical`]: the load on a tyre by its deflection, with lift-off and without adhesion.

use headland_expr::{Scalar, Spline};

use crate::guard::{num, power, smooth_step};

/// Force of the tyre's spring by deflection `d ≥ 0`.
#[derive(Clone, Debug)]
pub enum Stiffness<S> {
    /// `F = k d`.
    Linear {
        /// `k`, N/m.
        stiffness: S,
    },
    /// `F = k d + k₂ d²`, progressive.
    Quadratic {
        /// `k`, N/m.
        stiffness: S,
        /// `k₂`, N/m².
        progression: S,
    },
    /// `F = F₀ (d / d₀)ⁿ`.
    Power {
        /// `F₀`, N.
        load: S,
        /// Deflection `d₀` at that load, m.
        deflection: S,
        /// `n ≥ 1`.
        exponent: S,
    },
    /// A table of N by m; it must go through (0, 0).
    Table(Spline),
}

/// A spring and a damper that push only.
///
/// ```text
/// F_z = max(0, F(d) + c s(d / d₁) d')   d > 0      d: deflection, s: smooth step from 0 to 1
/// F_z = 0                               d ≤ 0
/// ```
/// The damper comes in over the deflection `d₁`, so that the force is continuous at touch-down whatever the speed. In
/// rebound the force is cut off at zero: the ground does not pull.
#[derive(Clone, Debug)]
pub struct Vertical<S> {
    /// The spring.
    pub spring: Stiffness<S>,
    /// `c`, N·s/m.
    pub damping: S,
    /// `d₁ > 0`, m.
    pub onset: S,
}

impl<S: Scalar> Vertical<S> {
    /// A linear spring with a damper that comes in over 1 mm.
    pub fn linear(stiffness: S, damping: S) -> Self {
        Self { spring: Stiffness::Linear { stiffness }, damping, onset: num(1e-3) }
    }

    /// Load `F_z` in N by deflection in m and its rate in m/s; never negative.
    pub fn load(&self, deflection: S, rate: S) -> S {
        let zero = num(0.0);
        let d = deflection.max(zero);
        let damper = self.damping * smooth_step(d / self.onset) * rate;
        S::select(-deflection, zero, (self.spring.force(d) + damper).max(zero))
    }

    /// Stiffness `dF/dd` of the spring in N/m at a deflection, for linearised models and error weights.
    pub fn stiffness(&self, deflection: S) -> S {
        self.spring.slope(deflection.max(num(0.0)))
    }
}

impl<S: Scalar> Stiffness<S> {
    /// Force in N; `d ≥ 0`.
    pub fn force(&self, d: S) -> S {
        match self {
            Self::Linear { stiffness } => *stiffness * d,
            Self::Quadratic { stiffness, progression } => (*stiffness + *progression * d) * d,
            Self::Power { load, deflection, exponent } => *load * power(d / *deflection, *exponent),
            Self::Table(table) => d.spline(table, 0).max(num(0.0)),
        }
    }

    /// Its derivative in N/m.
    pub fn slope(&self, d: S) -> S {
        match self {
            Self::Linear { stiffness } => *stiffness,
            Self::Quadratic { stiffness, progression } => *stiffness + num::<S>(2.0) * *progression * d,
            Self::Power { load, deflection, exponent } => {
                *load * *exponent / *deflection * power(d / *deflection, *exponent - num(1.0))
            }
            Self::Table(table) => d.spline(table, 1),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use headland_expr::Dual;

    fn springs<S: Scalar>() -> Vec<Stiffness<S>> {
        let table = Spline::new("tyre", &[0.0, 0.02, 0.05, 0.1], &[0.0, 5e3, 1.5e4, 4e4]).unwrap();
        vec![
            Stiffness::Linear { stiffness: num(3e5) },
            Stiffness::Quadratic { stiffness: num(2e5), progression: num(1e6) },
            Stiffness::Power { load: num(2e4), deflection: num(0.05), exponent: num(1.3) },
            Stiffness::Table(table),
        ]
    }

    #[test]
    fn pushes_only_and_is_continuous_at_touch_down() {
        for spring in springs::<f64>() {
            let law = Vertical { spring, damping: 5e3, onset: 1e-3 };
            for rate in [-20.0, -1.0, 0.0, 1.0, 20.0] {
                assert_eq!(law.load(-0.1, rate), 0.0);
                assert_eq!(law.load(0.0, rate), 0.0);
                assert!(law.load(1e-9, rate) < 1.0, "{law:?} {rate}");
                for d in [1e-6, 1e-3, 0.03, 0.2] {
                    assert!(law.load(d, rate) >= 0.0);
                }
            }
            assert_relative_eq!(law.load(0.05, 0.5) - law.load(0.05, 0.0), 2500.0, epsilon = 1e-9);
        }
    }

    #[test]
    fn slope_is_the_derivative() {
        for (spring, dual) in springs::<f64>().into_iter().zip(springs::<Dual<f64>>()) {
            for d in [1e-3, 0.03, 0.07] {
                assert_relative_eq!(spring.slope(d), dual.force(Dual::new(d, 1.0)).dot, max_relative = 1e-12);
            }
        }
    }

    #[test]
    fn derivatives_are_finite_everywhere() {
        for spring in springs::<Dual<f64>>() {
            let law = Vertical { spring, damping: num(5e3), onset: num(1e-3) };
            for d in [-1.0, 0.0, 1e-12, 0.05] {
                for rate in [-1.0, 0.0] {
                    let f = law.load(Dual::new(d, 1.0), Dual::new(rate, 0.5));
                    assert!(f.value.is_finite() && f.dot.is_finite(), "{law:?} at {d}: {f:?}");
                }
            }
        }
    }

    #[test]
    fn a_dropped_wheel_loses_no_more_than_its_damper_takes() {
        // without damper the wheel comes back to the height from which it fell
        let law = Vertical::linear(3e5, 0.0);
        let (mass, g, h) = (200.0, 9.81, 1e-5);
        let (mut d, mut v, mut top) = (-0.1, 0.0, f64::NEG_INFINITY);
        let mut touched = false;
        for _ in 0..60_000 {
            // velocity Verlet
            let a = |d: f64| g - law.load(d, 0.0) / mass;
            let half = v + 0.5 * h * a(d);
            d += h * half;
            v = half + 0.5 * h * a(d);
            touched |= d > 0.0;
            if touched {
                top = top.max(-d);
            }
        }
        assert!(touched);
        assert_relative_eq!(top, 0.1, epsilon = 1e-6);
    }
}
