//! [`Normal`]: the force that presses two bodies apart, and what stiffness two elastic bodies have.

use headland_expr::Scalar;

/// Depth below which a power is not taken, m: no exponent above 1 makes anything of it.
const NOTHING: f64 = 1e-30;

/// A spring by a power of the depth, with a damper that has no force where the spring has none.
///
/// ```text
/// N = k δⁿ max(0, 1 + c δ′)   δ > 0      δ: depth
/// N = 0                       δ ≤ 0
/// ```
/// `n = 1` is a linear spring, `n = 3/2` Hertz' contact of round bodies. It never pulls: where the bodies part so fast that
/// the damper outweighs the spring, there is no force.
///
/// K. H. Hunt, F. R. E. Crossley, *Coefficient of restitution interpreted as damping in vibroimpact*, J. Appl. Mech. 42
/// (1975), there with `λ = k c`.
#[derive(Clone, Copy, Debug)]
pub struct Normal<S> {
    /// `k > 0`, N/mⁿ.
    pub stiffness: S,
    /// `n ≥ 1`.
    pub exponent: S,
    /// `c ≥ 0`, s/m.
    pub damping: S,
}

impl<S: Scalar> Normal<S> {
    /// Force in N by depth in m and its rate in m/s; never negative.
    pub fn force(&self, depth: S, rate: S) -> S {
        self.elastic(depth) * self.damper(rate)
    }

    /// The factor `max(0, 1 + c δ′)` by which the damper changes the spring's force.
    pub fn damper(&self, rate: S) -> S {
        (S::constant(1.0) + self.damping * rate).max(S::constant(0.0))
    }

    /// The spring's force `k δⁿ`, N.
    pub fn elastic(&self, depth: S) -> S {
        let (zero, d) = (S::constant(0.0), depth.max(S::constant(NOTHING)));
        S::select(-depth, zero, self.stiffness * d.pow(self.exponent))
    }

    /// The energy stored in the spring, `k δⁿ⁺¹/(n + 1)`, J.
    pub fn energy(&self, depth: S) -> S {
        let (zero, d) = (S::constant(0.0), depth.max(S::constant(NOTHING)));
        let n = self.exponent + S::constant(1.0);
        S::select(-depth, zero, self.stiffness * d.pow(self.exponent) * d / n)
    }
}

/// An isotropic elastic material.
#[derive(Clone, Copy, Debug)]
pub struct Material<S> {
    /// Young's modulus `E > 0`, Pa.
    pub modulus: S,
    /// Poisson's ratio `ν`, −1 to 1/2.
    pub poisson: S,
}

/// Hertz' stiffness `k` of `N = k δ^{3/2}` for two spheres, N/m^{3/2}.
///
/// ```text
/// k = 4/3 E* √ρ,    1/E* = (1 − ν₁²)/E₁ + (1 − ν₂²)/E₂,    1/ρ = 1/r + κ
/// ```
/// `radius` is r, that of the ball; `curvature` is κ of what it touches, 1/m: `1/R` on a sphere, 0 on a plane, `−1/R` in a
/// spherical recess, `R > r`. The place of contact must be small beside both radii: where a ball almost fills its recess,
/// Hertz' theory does not hold.
///
/// K. L. Johnson, *Contact Mechanics* (1985), eqs. (4.22)-(4.24).
pub fn hertz_stiffness<S: Scalar>(radius: S, curvature: S, ball: Material<S>, ground: Material<S>) -> S {
    let one = S::constant(1.0);
    let compliance = |m: Material<S>| (one - m.poisson * m.poisson) / m.modulus;
    let modulus = one / (compliance(ball) + compliance(ground));
    let relative = one / radius + curvature;
    S::constant(4.0 / 3.0) * modulus / relative.sqrt()
}

/// Speed after an impact by that before it, for a body that hits a wall at `speed` v in m/s by the law of [`Normal`].
///
/// Whatever exponent, stiffness and mass are, `m v dv = −k δⁿ (1 + c v) dδ` gives, with the speed `e v` after,
///
/// ```text
/// c v − ln(1 + c v) = −c e v − ln(1 − c e v)
/// ```
/// `e ≈ 1 − 2/3 c v` for small `c v`; `e c v < 1` always, so that the damper is never cut off in it.
///
/// D. W. Marhefka, D. E. Orin, IEEE Trans. Syst. Man Cybern. A 29 (1999). NaN if `damping` or `speed` is negative.
pub fn restitution(damping: f64, speed: f64) -> f64 {
    let x = damping * speed;
    if x.is_nan() || x < 0.0 || speed < 0.0 {
        return f64::NAN;
    }
    if x < 1e-4 {
        // both sides lose all their digits; the series of the same equation
        return 1.0 - x * (2.0 / 3.0 - 4.0 / 9.0 * x);
    }
    let wanted = x - x.ln_1p();
    let (mut low, mut high) = (0.0, 1.0_f64.min(x)); // of y = c e v
    for _ in 0..200 {
        let y = 0.5 * (low + high);
        if -y - (-y).ln_1p() < wanted { low = y } else { high = y }
    }
    0.5 * (low + high) / x
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use headland_expr::Dual;
    use proptest::prelude::*;

    fn law(exponent: f64) -> Normal<f64> {
        Normal { stiffness: 3e5, exponent, damping: 0.4 }
    }

    #[test]
    fn pushes_only_and_touches_smoothly() {
        for n in [1.0, 1.5, 2.2] {
            for rate in [-20.0, -2.6, 0.0, 7.0] {
                assert_eq!(law(n).force(-1e-3, rate), 0.0);
                assert_eq!(law(n).force(0.0, rate), 0.0);
                assert!(law(n).force(1e-12, rate) < 1e-4);
                assert!(law(n).force(1e-3, rate) >= 0.0);
            }
            assert_eq!(law(n).force(1e-3, -2.6), 0.0, "1 + c δ' < 0: nothing is left of the spring");
        }
    }

    #[test]
    fn derivatives_are_finite_where_it_touches() {
        for n in [1.0, 1.5] {
            let law = Normal { stiffness: 3e5, exponent: n, damping: 0.4 };
            let law = Normal {
                stiffness: Dual::constant(law.stiffness),
                exponent: Dual::constant(n),
                damping: Dual::constant(0.4),
            };
            for depth in [-1.0, -1e-300, 0.0, 1e-300, 1e-20] {
                let f = law.force(Dual::new(depth, 1.0), Dual::new(0.1, 1.0));
                let e = law.energy(Dual::new(depth, 1.0));
                assert!(f.value.is_finite() && f.dot.is_finite() && e.dot.is_finite(), "{n} {depth}: {f:?} {e:?}");
            }
        }
    }

    proptest! {
        #[test]
        fn duals_agree_with_differences_and_energy_with_force(
            n in 1.0..3.0, depth in 1e-4..1e-2, rate in -2.0..5.0,
        ) {
            let l = law(n);
            let dual = Normal {
                stiffness: Dual::constant(l.stiffness), exponent: Dual::constant(n), damping: Dual::constant(l.damping),
            };
            let h = 1e-5 * depth;
            let central = |f: &dyn Fn(f64) -> f64| (f(depth + h) - f(depth - h)) / (2.0 * h);
            let by_depth = dual.force(Dual::new(depth, 1.0), Dual::constant(rate)).dot;
            let scale = l.force(depth, rate) / depth + 1e-9;
            prop_assert!((by_depth - central(&|d| l.force(d, rate))).abs() < 1e-7 * scale);
            let slope = central(&|d| l.energy(d));
            prop_assert!((slope - l.elastic(depth)).abs() < 1e-7 * l.elastic(depth));
            let energy = dual.energy(Dual::new(depth, 1.0)).dot;
            prop_assert!((energy - l.elastic(depth)).abs() < 1e-12 * l.elastic(depth));
        }

        #[test]
        fn the_damper_only_takes(n in 1.0..3.0, depth in -1e-2..1e-2, rate in -10.0..10.0) {
            let l = law(n);
            // power on the bodies: depth grows against the force
            prop_assert!(-(l.force(depth, rate) - l.elastic(depth)) * rate <= 0.0);
        }
    }

    /// Two equal steel balls of 1 cm pressed by 100 N approach by `(9 F²/(16 E*² ρ))^{1/3}`, Johnson eq. (4.23).
    #[test]
    fn hertz() {
        let steel = Material { modulus: 2.1e11, poisson: 0.3 };
        let k = hertz_stiffness(0.01, 1.0 / 0.01, steel, steel);
        let modulus = 2.1e11 / (2.0 * (1.0 - 0.09));
        let depth = (9.0 * 100.0_f64.powi(2) / (16.0 * modulus * modulus * 0.005)).cbrt();
        let law = Normal { stiffness: k, exponent: 1.5, damping: 0.0 };
        assert_relative_eq!(law.force(depth, 0.0), 100.0, max_relative = 1e-12);
        // a recess is stiffer than a plane, and a plane than a ball
        let of = |curvature| hertz_stiffness(0.01, curvature, steel, steel);
        assert_relative_eq!(of(-1.0 / 0.04) / of(0.0), (4.0_f64 / 3.0).sqrt(), max_relative = 1e-14);
        assert!(of(0.0) > of(100.0));
    }

    #[test]
    fn restitution_of_an_impact_integrated() {
        for (damping, v, n) in [(0.2, 1.0, 1.5), (1.0, 2.0, 1.0), (0.01, 3.0, 1.5)] {
            let law = Normal { stiffness: 1e4, exponent: n, damping };
            // m = 1, classical Runge-Kutta until it has left; the end by the last two steps
            let f = |[d, u]: [f64; 2]| [u, -law.force(d, u)];
            let (h, mut y) = (1e-6, [0.0, v]);
            let mut last = y;
            while y[0] >= 0.0 {
                last = y;
                let step = |k: [f64; 2], c: f64| [y[0] + c * h * k[0], y[1] + c * h * k[1]];
                let a = f(y);
                let b = f(step(a, 0.5));
                let c = f(step(b, 0.5));
                let d = f(step(c, 1.0));
                y = [0, 1].map(|i| y[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]));
            }
            let share = last[0] / (last[0] - y[0]);
            let out = -(last[1] + share * (y[1] - last[1]));
            assert_relative_eq!(restitution(damping, v), out / v, max_relative = 1e-7);
        }
        // where the series goes over into the equation, both say the same
        let x = 1.01e-4;
        assert_relative_eq!(restitution(x, 1.0), 1.0 - x * (2.0 / 3.0 - 4.0 / 9.0 * x), epsilon = 2e-11);
        assert!((restitution(1e-3, 1.0) - (1.0 - 2.0 / 3.0 * 1e-3)).abs() < 1e-6);
        assert!(restitution(-1.0, 1.0).is_nan());
        assert_eq!(restitution(0.0, 1.0), 1.0);
    }
}
