//! [`Road`]: ground as a smooth function of x and y, a sum of random unevenness, obstacles and a slope.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use headland_expr::{FIELD_PARTS, Field, field_part};
use rand_core::{Rng, SeedableRng};
use rand_pcg::Pcg64Mcg;
use wide::f64x4;

use crate::profile::{Obstacle, RoadError, demand};

/// How the heights of two parallel tracks belong together.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Coherence {
    /// The ground looks the same in all directions: long waves are common to both tracks, short ones are not.
    #[default]
    Isotropic,
    /// Both tracks are equal: unevenness varies along x only.
    Full,
}

/// A random road by ISO 8608, as a sum of plane waves.
///
/// ```text
/// G_d(n) = G_d(n_0)(n/n_0)⁻²      n_0 = 0.1 1/m; G_d(n_0) = 16·4ᵏ · 10⁻⁶ m³ for the classes A (k = 0) to H (k = 7)
/// z(x, y) = Σ a_i cos(2π ρ_i (x cos β_i + y sin β_i) + φ_i)
/// isotropic    a_i² = 2 ∫ (π/2) G_d(ρ) dρ over the i-th band, β_i spread over the half circle
/// full         a_i² = 2 ∫ G_d(ρ) dρ,  β_i = 0
/// ```
/// The bands divide the range of `ρ` evenly by its logarithm; `ρ_i` is random in its band, `φ_i` in the circle, `β_i` goes on by
/// the golden section from a random start, so that every few bands have all directions.
///
/// Isotropic ground with `G_d ~ n⁻²` along every line has the density `½ n_0² G_d(n_0) ρ⁻³` over the half plane of wave numbers,
/// which makes `(π/2) G_d(ρ) dρ` in a ring. What is shorter than the range has is missing: along a line the density is
/// `G_d(n) √(1 − (n/n_max)²)`, less by 6 % at a third of the range's end. The coherence of two tracks at the distance b is
/// `u K_1(u)`, `u = 2π n b`, `K_1` a modified Bessel function.
///
/// # References
/// ISO 8608:2016; Dodds and Robson, *The description of road surface roughness*, J. Sound Vib. 31, 1973; Kamash and Robson,
/// *Implications of isotropy in random surfaces*, J. Sound Vib. 54, 1977.
#[derive(Clone, PartialEq, Debug)]
pub struct RandomRoad {
    /// `[2πρ cos β, 2πρ sin β, a cos φ, −a sin φ]` of four waves a row; the last row is filled up with waves of no height.
    waves: Vec<[f64x4; 4]>,
    shortest: f64,
}

/// What a random road is made from.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Roughness {
    /// `G_d(n_0)`, m³; see [`Roughness::class`].
    pub density: f64,
    /// Range of spatial frequencies, 1/m; ISO 8608 has 0.01 to 10.
    pub range: [f64; 2],
    /// Number of waves.
    pub waves: usize,
    /// Seed: the same one makes the same road on every machine.
    pub seed: u64,
    /// How tracks belong together.
    pub coherence: Coherence,
}

impl Roughness {
    /// Geometric mean `G_d(n_0)` in m³ of a class, 'A' to 'H'; `None` for other letters.
    pub fn class(letter: char) -> Option<f64> {
        let k = "ABCDEFGH".find(letter.to_ascii_uppercase())?;
        Some(16e-6 * 4f64.powi(k as i32))
    }

    /// A road of the class with 256 waves from 0.01 to 10 1/m.
    pub fn of_class(letter: char, seed: u64) -> Option<Self> {
        let density = Self::class(letter)?;
        Some(Self { density, range: [0.01, 10.0], waves: 256, seed, coherence: Coherence::Isotropic })
    }
}

impl RandomRoad {
    /// Draws the waves.
    ///
    /// # Errors
    /// [`RoadError::Range`].
    pub fn new(of: &Roughness) -> Result<Self, RoadError> {
        let [from, to] = of.range;
        demand(of.density >= 0.0 && of.density.is_finite(), "density of a random road", of.density, "at least zero")?;
        demand(from > 0.0 && from.is_finite(), "least frequency of a random road", from, "above zero")?;
        demand(to > from && to.is_finite(), "greatest frequency of a random road", to, "above the least one")?;
        demand((1..=100_000).contains(&of.waves), "number of waves", of.waves as f64, "1 to 100000")?;
        let mut random = Pcg64Mcg::seed_from_u64(of.seed);
        let ratio = (to / from).powf(1.0 / of.waves as f64);
        let start = uniform(&mut random);
        let waves = (0..of.waves).map(|i| {
            let low = from * ratio.powi(i as i32);
            let k = TAU * low * ratio.powf(uniform(&mut random));
            let phase = TAU * uniform(&mut random);
            // ∫ G dρ = G(n₀) n₀² (1/ρ₁ − 1/ρ₂)
            let square = 2.0 * of.density * 0.01 * (1.0 - 1.0 / ratio) / low;
            let (turn, square) = match of.coherence {
                Coherence::Isotropic => (PI * (start + GOLDEN * i as f64).fract(), FRAC_PI_2 * square),
                Coherence::Full => (0.0, square),
            };
            let amplitude = square.sqrt();
            [k * turn.cos(), k * turn.sin(), amplitude * phase.cos(), -amplitude * phase.sin()]
        });
        Ok(Self { waves: rows(&waves.collect::<Vec<_>>()), shortest: 1.0 / to })
    }

    /// Adds height and derivatives along x and y up to `order` to `out[i][j]`, `i` times x, `j` times y.
    fn add(&self, x: f64, y: f64, order: usize, out: &mut [[f64; 4]; 4]) {
        let (x, y) = (f64x4::splat(x), f64x4::splat(y));
        let mut sums = [[f64x4::ZERO; 4]; 4];
        for [kx, ky, a, b] in &self.waves {
            let (sin, cos) = (*kx * x + *ky * y).sin_cos();
            // value and the first three derivatives by the phase
            let (f, g) = (*a * cos + *b * sin, *b * cos - *a * sin);
            let by_phase = [f, g, -f, -g];
            let mut x_power = f64x4::ONE;
            for i in 0..=order {
                let mut power = x_power;
                for j in 0..=order - i {
                    sums[i][j] += power * by_phase[i + j];
                    power *= *ky;
                }
                x_power *= *kx;
            }
        }
        for i in 0..=order {
            for j in 0..=order - i {
                out[i][j] += sums[i][j].reduce_add();
            }
        }
    }
}

/// Four waves a row.
fn rows(waves: &[[f64; 4]]) -> Vec<[f64x4; 4]> {
    let entry = |four: &[[f64; 4]], i: usize| {
        let of = |k: usize| four.get(k).map_or(0.0, |wave| wave[i]);
        f64x4::new([of(0), of(1), of(2), of(3)])
    };
    waves.chunks(4).map(|four| std::array::from_fn(|i| entry(four, i))).collect()
}

/// The golden section, `(√5 − 1)/2`.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

/// Uniform in [0, 1): the upper 53 bits, so that it does not depend on a distribution's code.
fn uniform(random: &mut Pcg64Mcg) -> f64 {
    (random.next_u64() >> 11) as f64 / (1u64 << 53) as f64
}

/// Part of a road.
#[derive(Clone, PartialEq, Debug)]
pub enum Part {
    /// Random unevenness.
    Random(RandomRoad),
    /// A bump, ditch or ramp.
    Obstacle(Obstacle),
    /// A plane `z = z_0 + g_x x + g_y y`.
    Plane {
        /// `z_0`, m.
        height: f64,
        /// `[g_x, g_y]`, rise over run.
        slope: [f64; 2],
    },
}

/// The height of the ground over x and y: a [`Field`] that does not depend on its third variable.
///
/// ```
/// use headland_expr::Field;
/// use headland_tyre::profile::{Obstacle, Profile};
/// use headland_tyre::road::{Part, RandomRoad, Road, Roughness};
/// let rough = RandomRoad::new(&Roughness::of_class('C', 7).unwrap()).unwrap();
/// let bump = Obstacle::across(Profile::CosineBump { height: 0.1, length: 0.5 }, 20.0);
/// let road = Road::new("field_track", vec![Part::Random(rough), Part::Obstacle(bump)]).unwrap();
/// let mut out = [0.0; 4];
/// road.eval([20.25, 0.9, 0.0], 1, &mut out); // z and its three derivatives
/// assert!(out[0].abs() < 0.3);
/// ```
#[derive(Clone, PartialEq, Debug)]
pub struct Road {
    name: String,
    parts: Vec<Part>,
}

impl Road {
    /// The sum of parts.
    ///
    /// # Errors
    /// [`RoadError::Range`] of a part.
    pub fn new(name: &str, parts: Vec<Part>) -> Result<Self, RoadError> {
        for part in &parts {
            match part {
                Part::Random(_) => {}
                Part::Obstacle(obstacle) => obstacle.check()?,
                Part::Plane { height, slope } => {
                    for x in [*height, slope[0], slope[1]] {
                        demand(x.is_finite(), "height or slope of a plane", x, "finite")?;
                    }
                }
            }
        }
        Ok(Self { name: name.to_string(), parts })
    }

    /// Height and derivatives along x and y, `out[i][j]` taken `i` times along x and `j` along y, for `i + j ≤ order ≤ 3`.
    pub fn derivatives(&self, x: f64, y: f64, order: usize) -> [[f64; 4]; 4] {
        let mut out = [[0.0; 4]; 4];
        for part in &self.parts {
            match part {
                Part::Random(road) => road.add(x, y, order, &mut out),
                Part::Obstacle(obstacle) => obstacle.add(x, y, order, &mut out),
                Part::Plane { height, slope } => {
                    out[0][0] += height + slope[0] * x + slope[1] * y;
                    out[1][0] += slope[0];
                    out[0][1] += slope[1];
                }
            }
        }
        out
    }

    /// Height, m.
    pub fn height(&self, x: f64, y: f64) -> f64 {
        self.derivatives(x, y, 0)[0][0]
    }

    /// The shortest length over which the height changes, m: an integrator's step must not pass over it. Infinite for a plane.
    pub fn shortest(&self) -> f64 {
        let of_part = |part: &Part| match part {
            Part::Random(road) => road.shortest,
            Part::Obstacle(o) => o.profile.shortest().min(o.width.map_or(f64::INFINITY, |[_, flank]| flank)),
            Part::Plane { .. } => f64::INFINITY,
        };
        self.parts.iter().map(of_part).fold(f64::INFINITY, f64::min)
    }
}

impl Field for Road {
    fn name(&self) -> &str {
        &self.name
    }

    fn eval(&self, point: [f64; 3], order: usize, out: &mut [f64]) {
        let z = self.derivatives(point[0], point[1], order);
        out[..FIELD_PARTS[order]].fill(0.0);
        for i in 0..=order {
            for j in 0..=order - i {
                out[field_part(i, j, 0)] = z[i][j];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The lanes' own sines against those of the library, wave by wave, also a hundred kilometres away.
    #[test]
    fn the_sum_over_lanes_is_the_sum_over_waves() {
        let road = RandomRoad::new(&Roughness { waves: 63, ..Roughness::of_class('E', 2).unwrap() }).unwrap();
        for (x, y) in [(0.0, 0.0), (12.3, -0.9), (1.2e3, 88.0), (1e5, -3e4)] {
            let mut out = [[0.0; 4]; 4];
            road.add(x, y, 3, &mut out);
            let (mut height, mut twist) = (0.0, 0.0);
            for [kx, ky, a, b] in road.waves.iter().flat_map(|row| (0..4).map(|k| row.map(|v| v.to_array()[k]))) {
                let phase = kx * x + ky * y;
                height += a * phase.cos() + b * phase.sin();
                twist += kx * kx * ky * (a * phase.sin() - b * phase.cos());
            }
            assert!((out[0][0] - height).abs() < 1e-14, "{x}: {} {height}", out[0][0]);
            assert!((out[2][1] - twist).abs() < 1e-9 * twist.abs().max(1.0), "{x}: {} {twist}", out[2][1]);
        }
    }
}
