//! [`Resistance`]: torques that brake rolling and spinning of one body on another.

use headland_expr::Scalar;
use headland_spatial::Vector;

/// Torques by normal force and a lever each, rounded off over a small angular velocity like friction over a small slip.
///
/// ```text
/// rolling     M = −b N ω_t/√(ω_t² + w²)     ω_t: angular velocity across the normal
/// spinning    M = −d N ω_n/√(ω_n² + w²) n   ω_n: along it
/// ```
/// `b` is the distance by which the normal force acts ahead of the contact, `d = 3π/16 μ a` for a Hertzian contact of
/// radius a that spins: K. L. Johnson, *Contact Mechanics* (1985), on rolling and torsion.
#[derive(Clone, Copy, Debug)]
pub struct Resistance<S> {
    /// `b ≥ 0`, m.
    pub rolling: S,
    /// `d ≥ 0`, m.
    pub spinning: S,
    /// `w > 0`, rad/s.
    pub speed: S,
}

/// What brakes rolling, and what brakes spinning.
#[derive(Clone, Copy, Debug)]
pub struct Torques<S> {
    /// Across the normal, N m.
    pub rolling: Vector<S>,
    /// Along the normal, N m.
    pub spinning: Vector<S>,
}

impl<S: Scalar> Resistance<S> {
    /// Torques on the body by normal force in N, angular velocity relative to the ground in rad/s, and unit normal.
    pub fn torques(&self, force: S, spin: Vector<S>, normal: Vector<S>) -> Torques<S> {
        let along = normal.dot(spin);
        let across = spin - normal * along;
        let rounded = |square: S| (square + self.speed * self.speed).sqrt();
        Torques {
            rolling: across * -(self.rolling * force / rounded(across.squared_norm())),
            spinning: normal * -(self.spinning * force * along / rounded(along * along)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use headland_expr::Dual;
    use proptest::prelude::*;

    const LAW: Resistance<f64> = Resistance { rolling: 1e-3, spinning: 2e-4, speed: 1e-2 };

    #[test]
    fn levers_times_normal_force_when_it_turns() {
        let t = LAW.torques(50.0, Vector::new(300.0, 400.0, -500.0), Vector::new(0.0, 0.0, 1.0));
        let expected = [-1e-3 * 50.0 * 0.6, -1e-3 * 50.0 * 0.8, 2e-4 * 50.0];
        let total = t.rolling + t.spinning;
        (0..3).for_each(|i| assert_relative_eq!(total[i], expected[i], max_relative = 1e-8));
        assert_eq!((t.rolling.z(), t.spinning.x()), (0.0, 0.0));
    }

    #[test]
    fn derivatives_are_finite_at_rest() {
        let lift = Dual::constant;
        let law = Resistance { rolling: lift(1e-3), spinning: lift(2e-4), speed: lift(1e-2) };
        let n = Vector::new(lift(0.0), lift(0.0), lift(1.0));
        let t = law.torques(lift(50.0), Vector::new(Dual::new(0.0, 1.0), lift(0.0), Dual::new(0.0, 1.0)), n);
        assert_relative_eq!(t.rolling.x().dot, -1e-3 * 50.0 / 1e-2, max_relative = 1e-14);
        assert_relative_eq!(t.spinning.z().dot, -2e-4 * 50.0 / 1e-2, max_relative = 1e-14);
    }

    proptest! {
        #[test]
        fn it_only_takes_energy(w in prop::array::uniform3(-10.0..10.0), n in prop::array::uniform3(-1.0..1.0), force in 0.0..1e3) {
            prop_assume!(Vector(n).norm() > 0.1);
            let (w, n) = (Vector(w), Vector(n).unit());
            let t = LAW.torques(force, w, n);
            prop_assert!(t.rolling.dot(w) <= 1e-15 * force && t.spinning.dot(w) <= 0.0);
            prop_assert!(t.rolling.norm() <= 1e-3 * force && t.spinning.norm() <= 2e-4 * force * (1.0 + 1e-14));
        }
    }
}
