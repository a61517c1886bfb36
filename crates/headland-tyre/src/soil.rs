//! [`Soil`]: soft ground under a rigid wheel, pressure by sinkage and shear by displacement.
//!
//! ```text
//! p = (k_c/b + k_φ) zⁿ                         pressure under a plate of width b sunk by z        Bekker
//! τ = (c + p tan φ)(1 − exp(−j/K))             shear stress by shear displacement j              Janosi and Hanamoto
//! ```
//! Under a rigid wheel of radius R and width b the pressure acts radially from the entry angle `θ_0`,
//! `cos θ_0 = 1 − z_0/R`, to the bottom (Wong's simplification: no pressure behind it):
//!
//! ```text
//! z(θ) = R (cos θ − cos θ_0)       j(θ) = R (θ_0 − θ − (1 − i)(sin θ_0 − sin θ))       i: slip
//! W = b R ∫ (p cos θ + τ sin θ) dθ        load
//! R_c = b R ∫ p sin θ dθ = b (k_c/b + k_φ) z_0ⁿ⁺¹ / (n + 1)        compaction resistance
//! H = b R ∫ τ cos θ dθ        thrust            T = b R² ∫ τ dθ        torque
//! ```
//!
//! # References
//! Wong, *Theory of Ground Vehicles*, 4th ed. 2008, sec. 2.4 and 2.6; Bekker, *Introduction to Terrain-Vehicle Systems*, 1969.

use headland_expr::Scalar;

use crate::guard::{clamp, num, power};

/// Parameters of a soil, SI units.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Soil<S> {
    /// Exponent of sinkage `n`.
    pub exponent: S,
    /// Cohesive modulus `k_c`, N/mⁿ⁺¹.
    pub cohesive: S,
    /// Frictional modulus `k_φ`, N/mⁿ⁺².
    pub frictional: S,
    /// Cohesion `c`, Pa.
    pub cohesion: S,
    /// Angle of internal friction `φ`, rad.
    pub friction_angle: S,
    /// Shear modulus of deformation `K`, m.
    pub shear: S,
}

/// A soil of the literature; `None` where the source has no number.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct KnownSoil {
    /// Name.
    pub name: &'static str,
    /// `n`.
    pub exponent: f64,
    /// `k_c`, kN/mⁿ⁺¹.
    pub cohesive_kn: f64,
    /// `k_φ`, kN/mⁿ⁺².
    pub frictional_kn: f64,
    /// `c`, kPa.
    pub cohesion_kpa: Option<f64>,
    /// `φ`, degrees.
    pub friction_angle_deg: Option<f64>,
    /// `K`, m.
    pub shear_m: Option<f64>,
    /// Where the numbers are from.
    pub source: &'static str,
}

const WONG: &str = "Wong, Theory of Ground Vehicles, table 2.3";

/// Soils with numbers from the literature, in the units of the sources.
pub const SOILS: &[KnownSoil] = &[
    KnownSoil {
        name: "dry_sand",
        exponent: 1.1,
        cohesive_kn: 0.99,
        frictional_kn: 1528.43,
        cohesion_kpa: Some(1.04),
        friction_angle_deg: Some(28.0),
        // the source gives 0.010 to 0.025
        shear_m: Some(0.025),
        source: WONG,
    },
    KnownSoil {
        name: "sandy_loam",
        exponent: 0.7,
        cohesive_kn: 5.27,
        frictional_kn: 1515.04,
        cohesion_kpa: None,
        friction_angle_deg: None,
        shear_m: None,
        source: WONG,
    },
    KnownSoil {
        name: "clayey_soil",
        exponent: 0.5,
        cohesive_kn: 13.19,
        frictional_kn: 692.15,
        cohesion_kpa: Some(4.14),
        friction_angle_deg: Some(13.0),
        shear_m: Some(0.006),
        source: "Wong, Theory of Ground Vehicles, table 2.3; K: Ding et al. 2015",
    },
    KnownSoil {
        name: "lete_sand",
        exponent: 0.793,
        cohesive_kn: 102.0,
        frictional_kn: 5301.0,
        cohesion_kpa: Some(1.3),
        friction_angle_deg: Some(31.1),
        shear_m: Some(0.012),
        source: "Wong, Theory of Ground Vehicles (LETE sand)",
    },
    KnownSoil {
        name: "lunar",
        exponent: 1.0,
        cohesive_kn: 1.4,
        frictional_kn: 820.0,
        cohesion_kpa: Some(0.17),
        friction_angle_deg: Some(35.0),
        shear_m: Some(0.0178),
        source: "lunar soil after Ding et al. 2015",
    },
];

impl KnownSoil {
    /// The soil of that name.
    pub fn named(name: &str) -> Option<&'static Self> {
        SOILS.iter().find(|soil| soil.name == name)
    }

    /// In SI units; `None` where the source lacks a number of shear.
    pub fn soil<S: Scalar>(&self) -> Option<Soil<S>> {
        let (c, phi, shear) = (self.cohesion_kpa?, self.friction_angle_deg?, self.shear_m?);
        Some(Soil {
            exponent: num(self.exponent),
            cohesive: num(1e3 * self.cohesive_kn),
            frictional: num(1e3 * self.frictional_kn),
            cohesion: num(1e3 * c),
            friction_angle: num(phi.to_radians()),
            shear: num(shear),
        })
    }
}

/// A rigid wheel on soft ground.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct SoftWheel<S> {
    /// The soil.
    pub soil: Soil<S>,
    /// Radius, m.
    pub radius: S,
    /// Width, m.
    pub width: S,
}

/// What soft ground does to a wheel.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct SoftForces<S> {
    /// Load carried, N.
    pub load: S,
    /// Resistance by compaction, N, at least zero.
    pub resistance: S,
    /// Thrust by shear, N; negative for a braked wheel.
    pub thrust: S,
    /// Torque about the axle that the thrust needs, N·m.
    pub torque: S,
}

/// Gauss-Legendre of 12 points on (0, 1): half of the abscissas about the middle, with weights.
///
/// Abramowitz and Stegun, *Handbook of Mathematical Functions*, 1964, table 25.4.
const GAUSS: [(f64, f64); 6] = [
    (0.125_233_408_511_468_9, 0.249_147_045_813_402_77),
    (0.367_831_498_998_180_2, 0.233_492_536_538_354_82),
    (0.587_317_954_286_617_4, 0.203_167_426_723_065_92),
    (0.769_902_674_194_304_7, 0.160_078_328_543_346_24),
    (0.904_117_256_370_474_9, 0.106_939_325_995_318_43),
    (0.981_560_634_246_719_2, 0.047_175_336_386_511_83),
];

impl<S: Scalar> Soil<S> {
    /// Pressure in Pa under a plate of `width` sunk by `z ≥ 0`.
    pub fn pressure(&self, z: S, width: S) -> S {
        (self.cohesive / width + self.frictional) * power(z, self.exponent)
    }

    /// Shear stress in Pa by pressure and displacement `j`, of its sign.
    pub fn shear_stress(&self, pressure: S, j: S) -> S {
        let strength = self.cohesion + pressure * self.friction_angle.tan();
        let share = num::<S>(1.0) - (-(j.abs() / self.shear)).exp();
        strength * share * j.sign()
    }
}

impl<S: Scalar> SoftWheel<S> {
    /// Forces at the sinkage `z_0` in m (below zero: none) and slip `i = 1 − V/(R Ω)` for a driven wheel, −1 to 1.
    pub fn forces(&self, sinkage: S, slip: S) -> SoftForces<S> {
        let (zero, one) = (num::<S>(0.0), num::<S>(1.0));
        let depth = clamp(sinkage / self.radius, num(1e-9), num(1.0));
        let cos0 = one - depth;
        // cos θ₀ = 1 − z₀/R; the root keeps its accuracy where acos loses it
        let sin0 = (depth * (num::<S>(2.0) - depth)).sqrt();
        let entry = sin0.atan2(cos0);
        let mut sums = [zero; 4];
        for (abscissa, weight) in GAUSS.into_iter().flat_map(|(x, w)| [(x, w), (-x, w)]) {
            // in s with θ = θ₀ (1 − s²): the pressure starts as a power of θ₀ − θ that no polynomial follows
            let s = 0.5 + 0.5 * abscissa;
            let theta = entry * num(1.0 - s * s);
            let (sin, cos) = theta.sin_cos();
            let weight = entry * num(weight * s);
            let p = self.soil.pressure(self.radius * (cos - cos0), self.width);
            let j = self.radius * (entry - theta - (one - slip) * (sin0 - sin));
            let tau = self.soil.shear_stress(p, j);
            let parts = [p * cos + tau * sin, p * sin, tau * cos, self.radius * tau];
            sums = std::array::from_fn(|i| sums[i] + weight * parts[i]);
        }
        let [load, resistance, thrust, torque] = sums.map(|x| S::select(-sinkage, zero, x * self.width * self.radius));
        SoftForces { load, resistance, thrust, torque }
    }

    /// Sinkage in m by Bekker's closed form for loads without shear, good below `z_0 = R/3`.
    ///
    /// ```text
    /// z_0 = (3 W / (b (3 − n)(k_c/b + k_φ) √D))^(2/(2n+1))        D = 2R
    /// ```
    pub fn bekker_sinkage(&self, load: S) -> S {
        let (two, three) = (num::<S>(2.0), num::<S>(3.0));
        let n = self.soil.exponent;
        let modulus = self.soil.cohesive / self.width + self.soil.frictional;
        let size = self.width * (three - n) * modulus * (two * self.radius).sqrt();
        power(three * load / size, two / (two * n + num(1.0)))
    }

    /// Resistance in N by Bekker's closed form `b (k_c/b + k_φ) z_0ⁿ⁺¹/(n + 1)`.
    pub fn bekker_resistance(&self, sinkage: S) -> S {
        let n1 = self.soil.exponent + num(1.0);
        self.width * (self.soil.cohesive / self.width + self.soil.frictional) * power(sinkage, n1) / n1
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use headland_expr::Dual;

    fn wheel<S: Scalar>(name: &str) -> SoftWheel<S> {
        let soil = KnownSoil::named(name).unwrap().soil().unwrap();
        SoftWheel { soil, radius: num(0.6), width: num(0.4) }
    }

    const COMPLETE: [&str; 4] = ["dry_sand", "clayey_soil", "lete_sand", "lunar"];

    #[test]
    fn integrals_agree_with_a_fine_sum_and_the_closed_form() {
        for name in COMPLETE {
            let w = wheel::<f64>(name);
            for (z0, slip) in [(0.01, 0.0), (0.05, 0.2), (0.15, 0.6), (0.1, -0.3)] {
                let f = w.forces(z0, slip);
                let entry = f64::acos(1.0 - z0 / w.radius);
                let n = 400_000;
                let (mut load, mut thrust) = (0.0, 0.0);
                for i in 0..n {
                    let theta = entry * (f64::from(i) + 0.5) / f64::from(n);
                    let p = w.soil.pressure(w.radius * (theta.cos() - entry.cos()), w.width);
                    let j = w.radius * (entry - theta - (1.0 - slip) * (entry.sin() - theta.sin()));
                    let tau = (w.soil.cohesion + p * w.soil.friction_angle.tan())
                        * (1.0 - (-j.abs() / w.soil.shear).exp())
                        * j.signum();
                    load += p * theta.cos() + tau * theta.sin();
                    thrust += tau * theta.cos();
                }
                let h = w.width * w.radius * entry / f64::from(n);
                assert_relative_eq!(f.load, load * h, max_relative = 3e-4);
                assert_relative_eq!(f.thrust, thrust * h, max_relative = 3e-3, epsilon = 0.1);
                assert_relative_eq!(f.resistance, w.bekker_resistance(z0), max_relative = 3e-5);
            }
        }
    }

    /// Bekker takes `1 − n/3` for `∫_0^1 (1 − x²)ⁿ dx`: right for n = 1, for n = ½ the integral is π/4.
    #[test]
    fn bekkers_sinkage_is_that_of_small_sinkage() {
        for (name, integral) in [("lunar", 2.0 / 3.0), ("clayey_soil", std::f64::consts::FRAC_PI_4)] {
            let mut w = wheel::<f64>(name);
            // without shear, as in his derivation
            (w.soil.cohesion, w.soil.friction_angle) = (0.0, 0.0);
            let (z0, n) = (0.001, w.soil.exponent);
            let back = w.bekker_sinkage(w.forces(z0, 0.0).load);
            let expected = z0 * (integral / (1.0 - n / 3.0)).powf(2.0 / (2.0 * n + 1.0));
            assert_relative_eq!(back, expected, max_relative = 1e-3);
        }
    }

    /// The numbers of the sources are the same in SI: a plate of 0.1 m at 0.1 m in dry sand by hand.
    #[test]
    fn units_of_the_sources_are_converted() {
        let soil = KnownSoil::named("dry_sand").unwrap().soil::<f64>().unwrap();
        let kpa = (0.99 / 0.1 + 1528.43) * f64::powf(0.1, 1.1);
        assert_relative_eq!(soil.pressure(0.1, 0.1), 1e3 * kpa, max_relative = 1e-14);
        let full = soil.shear_stress(1e4, 10.0);
        assert_relative_eq!(full, 1040.0 + 1e4 * f64::tan(28.0 * std::f64::consts::PI / 180.0), max_relative = 1e-14);
        assert_relative_eq!(soil.shear_stress(1e4, 0.025), full * (1.0 - f64::exp(-1.0)), max_relative = 1e-14);
        assert_eq!(soil.shear_stress(1e4, -0.025), -soil.shear_stress(1e4, 0.025));
        assert!(KnownSoil::named("sandy_loam").unwrap().soil::<f64>().is_none(), "its source has no shear");
    }

    #[test]
    fn a_wheel_above_ground_feels_nothing_and_derivatives_are_finite() {
        let w = wheel::<f64>("lunar");
        let f = w.forces(-0.01, 0.2);
        assert_eq!([f.load, f.resistance, f.thrust, f.torque], [0.0; 4]);
        let dual = wheel::<Dual<f64>>("dry_sand");
        for z in [-0.1, 0.0, 1e-6, 0.05, 2.0] {
            for i in [-1.0, 0.0, 1.0] {
                let f = dual.forces(Dual::new(z, 1.0), Dual::new(i, 0.3));
                for x in [f.load, f.resistance, f.thrust, f.torque] {
                    assert!(x.value.is_finite() && x.dot.is_finite(), "{z} {i} {f:?}");
                }
            }
        }
    }
}
