//! Friction by slip velocity: [`Coulomb`] rounded off where the slip turns round, [`LuGre`] with a bristle that bends.

use headland_expr::Scalar;
use headland_spatial::Vector;

/// Square of a speed below which there is no direction.
const NOTHING: f64 = 1e-40;

/// The length of a vector, not below 1e-20, so that its derivative is finite; at the origin the derivative is zero.
pub fn speed<S: Scalar>(v: Vector<S>) -> S {
    v.squared_norm().max(S::constant(NOTHING)).sqrt()
}

/// Coefficient of friction by slip speed, with more friction where it hardly slips.
///
/// ```text
/// μ(s) = μ_k + (μ_s − μ_k) exp(−(s/v_s)²)
/// ```
/// B. Armstrong-Hélouvry, P. Dupont, C. Canudas de Wit, Automatica 30 (1994), after Stribeck (1902).
#[derive(Clone, Copy, Debug)]
pub struct Coefficient<S> {
    /// `μ_k ≥ 0`, when it slips.
    pub kinetic: S,
    /// `(μ_s, v_s)`: the coefficient where it begins to slip, and the speed over which it falls, m/s.
    pub stribeck: Option<(S, S)>,
}

impl<S: Scalar> Coefficient<S> {
    /// `μ` at a slip velocity in m/s.
    pub fn at(&self, slip: Vector<S>) -> S {
        let Some((still, speed)) = self.stribeck else { return self.kinetic };
        self.kinetic + (still - self.kinetic) * (-(slip.squared_norm() / (speed * speed))).exp()
    }
}

/// How the sign of the slip is rounded off, over a speed `v`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Regularization {
    /// `s/√(s² + v²)`.
    Root,
    /// `tanh(s/v)`.
    Tanh,
}

/// Coulomb's friction, rounded off over a small speed: below it the force grows with the slip.
///
/// ```text
/// F = −μ(|s|) N s/√(s² + v²)   or   −μ(|s|) N tanh(|s|/v) s/|s|
/// ```
/// What should stick creeps: under a tangential force `T` at a speed of about `v T/(μ N)`.
#[derive(Clone, Copy, Debug)]
pub struct Coulomb<S> {
    /// `μ`.
    pub coefficient: Coefficient<S>,
    /// `v > 0`, m/s.
    pub speed: S,
    /// Which.
    pub regularization: Regularization,
}

impl<S: Scalar> Coulomb<S> {
    /// Force in N by normal force in N and slip velocity in m/s.
    pub fn force(&self, normal: S, slip: Vector<S>) -> Vector<S> {
        slip * -(self.by_slip(slip) * normal)
    }

    /// `μ` over what is slipped: the force by slip and normal force, s/m.
    pub fn by_slip(&self, slip: Vector<S>) -> S {
        let v = self.speed;
        let by_slip = match self.regularization {
            Regularization::Root => S::constant(1.0) / (slip.squared_norm() + v * v).sqrt(),
            Regularization::Tanh => {
                // tanh(s)/s has no value of its own at zero: not below 1e-8 of v, where it is 1 but for rounding
                let s = (slip.squared_norm() / (v * v)).max(S::constant(1e-16)).sqrt();
                s.tanh() / (s * v)
            }
        };
        self.coefficient.at(slip) * by_slip
    }
}

/// LuGre's friction: a bristle bends under the slip until it gives way.
///
/// ```text
/// z′ = s − σ₀ |s| z/μ(|s|),      F = −N (σ₀ z + σ₁ z′ + σ₂ s)
/// ```
/// A steady slip bends it to `z = μ s/(σ₀ |s|)`: Coulomb's force and a viscous one. Below it is a spring that holds.
/// For two directions, with friction by normal force: C. Canudas de Wit, P. Tsiotras, E. Velenis, M. Basset, G. Gissinger,
/// Vehicle System Dynamics 39 (2003); the law: C. Canudas de Wit, H. Olsson, K. J. Åström, P. Lischinsky,
/// IEEE Trans. Autom. Control 40 (1995).
#[derive(Clone, Copy, Debug)]
pub struct LuGre<S> {
    /// `μ > 0`.
    pub coefficient: Coefficient<S>,
    /// `σ₀ > 0`: stiffness of the bristle by normal force, 1/m.
    pub stiffness: S,
    /// `σ₁ ≥ 0`: its damping by normal force, s/m.
    pub damping: S,
    /// `σ₂ ≥ 0`: viscous friction by normal force, s/m.
    pub viscous: S,
}

impl<S: Scalar> LuGre<S> {
    /// Rate `z′` of the bristle in m/s, by its deflection `z` in m and the slip velocity in m/s, both across the normal.
    pub fn rate(&self, z: Vector<S>, slip: Vector<S>) -> Vector<S> {
        slip - z * (self.stiffness * speed(slip) / self.coefficient.at(slip))
    }

    /// Force in N.
    pub fn force(&self, normal: S, z: Vector<S>, slip: Vector<S>) -> Vector<S> {
        (z * self.stiffness + self.rate(z, slip) * self.damping + slip * self.viscous) * -normal
    }

    /// The largest `σ₁` with which it gives back no more than the bristle has stored, for slips up to `fastest`, m/s.
    ///
    /// `F·s + N (σ₀ z²/2)′` is a quadratic form in z and s, nowhere positive while `σ₁ ≤ 4 μ/|s|`: N. Barabanov, R. Ortega,
    /// IEEE Trans. Autom. Control 45 (2000).
    pub fn passive_damping(&self, fastest: S) -> S {
        S::constant(4.0) * self.coefficient.kinetic / fastest
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use headland_expr::Dual;
    use proptest::prelude::*;

    const STRIBECK: Coefficient<f64> = Coefficient { kinetic: 0.3, stribeck: Some((0.5, 0.01)) };

    fn coulomb(regularization: Regularization) -> Coulomb<f64> {
        Coulomb { coefficient: STRIBECK, speed: 1e-3, regularization }
    }

    fn lifted(c: Coefficient<f64>) -> Coefficient<Dual<f64>> {
        let lift = |x| Dual::constant(x);
        Coefficient { kinetic: lift(c.kinetic), stribeck: c.stribeck.map(|(a, b)| (lift(a), lift(b))) }
    }

    #[test]
    fn limits() {
        for kind in [Regularization::Root, Regularization::Tanh] {
            let law = coulomb(kind);
            let far = law.force(10.0, Vector::new(3.0, -4.0, 0.0));
            assert_relative_eq!(far.x(), -0.3 * 10.0 * 0.6, max_relative = 1e-7);
            assert_relative_eq!(far.y(), 0.3 * 10.0 * 0.8, max_relative = 1e-7);
            // at small slip a damper of μ_s N/v
            let near = law.force(10.0, Vector::new(1e-9, 0.0, 0.0));
            assert_relative_eq!(near.x(), -0.5 * 10.0 * 1e-9 / 1e-3, max_relative = 1e-9);
            assert_eq!(law.force(10.0, Vector::zero()).0.map(f64::abs), [0.0; 3]);
        }
        assert_relative_eq!(STRIBECK.at(Vector::new(0.01, 0.0, 0.0)), 0.3 + 0.2 / 1.0_f64.exp(), max_relative = 1e-15);
    }

    #[test]
    fn derivatives_are_finite_without_slip() {
        for kind in [Regularization::Root, Regularization::Tanh] {
            let law = Coulomb { coefficient: lifted(STRIBECK), speed: Dual::constant(1e-3), regularization: kind };
            let f = law.force(
                Dual::constant(10.0),
                Vector::new(Dual::new(0.0, 1.0), Dual::constant(0.0), Dual::constant(0.0)),
            );
            assert_relative_eq!(f.x().dot, -0.5 * 10.0 / 1e-3, max_relative = 1e-12);
            assert_eq!(f.y().dot, 0.0);
        }
        let s = speed(Vector::new(Dual::new(0.0, 1.0), Dual::constant(0.0), Dual::constant(0.0)));
        assert_eq!(s.dot, 0.0);
    }

    fn lugre() -> LuGre<f64> {
        LuGre { coefficient: STRIBECK, stiffness: 1e4, damping: 2.0, viscous: 0.1 }
    }

    #[test]
    fn a_steady_slip_is_coulombs() {
        let (law, s) = (lugre(), Vector::new(0.03, -0.04, 0.0));
        let mu = STRIBECK.at(s);
        let z = s * (mu / (1e4 * 0.05));
        let rate = law.rate(z, s);
        assert!(rate.norm() < 1e-17);
        let f = law.force(20.0, z, s);
        let expected = s * -(20.0 * (mu / 0.05 + 0.1));
        (0..2).for_each(|i| assert_relative_eq!(f[i], expected[i], max_relative = 1e-13));
        // a short slip from rest: a spring σ₀ N
        let f = law.force(20.0, Vector::new(1e-7, 0.0, 0.0), Vector::zero());
        assert_relative_eq!(f.x(), -20.0 * 1e4 * 1e-7, max_relative = 1e-14);
    }

    /// A slip held at s from rest bends the bristle by `z = (μ/σ₀)(1 − e^{−σ₀ s t/μ})`.
    #[test]
    fn the_bristle_follows_in_closed_form() {
        let (law, s) = (lugre(), Vector::new(0.02, 0.0, 0.0));
        let mu = STRIBECK.at(s);
        let (n, until) = (2000, 0.002);
        let h = until / f64::from(n);
        let mut z = Vector::zero();
        for _ in 0..n {
            let a = law.rate(z, s);
            let b = law.rate(z + a * (h / 2.0), s);
            z = z + law.rate(z + (b * 2.0 - a) * h, s) * (h / 6.0) + a * (h / 6.0) + b * (4.0 * h / 6.0);
        }
        assert_relative_eq!(z.x(), mu / 1e4 * (1.0 - (-1e4 * 0.02 * until / mu).exp()), max_relative = 1e-9);
    }

    proptest! {
        #[test]
        fn it_only_takes_energy(x in -2.0..2.0, y in -2.0..2.0, n in 0.0..1e4, small in 0u8..2) {
            let s = Vector::new(x, y, 0.0) * if small == 1 { 1e-6 } else { 1.0 };
            for kind in [Regularization::Root, Regularization::Tanh] {
                let f = coulomb(kind).force(n, s);
                prop_assert!(f.dot(s) <= 0.0);
                prop_assert!(f.norm() <= STRIBECK.at(s) * n * (1.0 + 1e-14));
            }
        }

        /// `N` constant: what goes in is stored in the bristle or lost.
        #[test]
        fn lugre_is_passive_with_little_damping(
            a in 0.0..6.3, b in 0.0..6.3, bent in 0.0..1.0, s in 1e-6..0.5,
        ) {
            let mut law = lugre();
            law.damping = law.passive_damping(0.5);
            let limit = STRIBECK.kinetic / law.stiffness;
            let z = Vector::new(f64::cos(a), f64::sin(a), 0.0) * (bent * limit);
            let slip = Vector::new(f64::cos(b), f64::sin(b), 0.0) * s;
            let stored = law.stiffness * z.dot(law.rate(z, slip));
            prop_assert!(law.force(1.0, z, slip).dot(slip) + stored <= 1e-15);
        }

        #[test]
        fn duals_agree_with_differences(x in -0.02..0.02, y in -0.02..0.02, zx in -3e-5..3e-5) {
            let h = 1e-7;
            let at = |x: f64| Vector::new(x, y, 0.0);
            let dual = Vector::new(Dual::new(x, 1.0), Dual::constant(y), Dual::constant(0.0));
            for regularization in [Regularization::Root, Regularization::Tanh] {
                let law = Coulomb { coefficient: STRIBECK, speed: 1e-2, regularization };
                let d = Coulomb { coefficient: lifted(STRIBECK), speed: Dual::constant(1e-2), regularization };
                let f = d.force(Dual::constant(1.0), dual);
                for i in 0..2 {
                    let slope = (law.force(1.0, at(x + h))[i] - law.force(1.0, at(x - h))[i]) / (2.0 * h);
                    prop_assert!((f[i].dot - slope).abs() < 1e-6 * 50.0, "{} {slope}", f[i].dot);
                }
            }
            prop_assume!(x.hypot(y) > 1e-4);
            let (law, lift) = (lugre(), Dual::constant);
            let d = LuGre { coefficient: lifted(STRIBECK), stiffness: lift(1e4), damping: lift(2.0), viscous: lift(0.1) };
            let z = Vector::new(zx, 1e-5, 0.0);
            let rate = d.rate(z.map(lift), dual);
            let slope = (law.rate(z, at(x + h)).x() - law.rate(z, at(x - h)).x()) / (2.0 * h);
            prop_assert!((rate.x().dot - slope).abs() < 1e-5, "{} {slope}", rate.x().dot);
        }
    }
}
