//! [`Profile`]: bumps, ditches, ramps and steps along one line; [`Obstacle`]: one of them laid across the ground.

use std::f64::consts::{PI, TAU};

/// Height by distance along one line, zero before it begins.
///
/// ```text
/// CosineBump   h/2 (1 − cos 2πs/L)           0 ≤ s ≤ L      slope continuous
/// SineBump     h sin πs/L                    0 ≤ s ≤ L      slope jumps by ±πh/L at both ends
/// Ditch        −h S(s/f) up to f, −h between, back over the last f          all derivatives to the third continuous
/// Ramp         h S(s/L), then h
/// ```
/// `S(u) = 35u⁴ − 84u⁵ + 70u⁶ − 20u⁷`. A negative height turns a bump into a hollow.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Profile {
    /// A full cosine.
    CosineBump {
        /// `h`, m.
        height: f64,
        /// `L`, m.
        length: f64,
    },
    /// Half a sine.
    SineBump {
        /// `h`, m.
        height: f64,
        /// `L`, m.
        length: f64,
    },
    /// A ditch with rounded flanks.
    Ditch {
        /// `h`, m.
        depth: f64,
        /// From edge to edge, m.
        length: f64,
        /// Length of each flank, at most half of it, m.
        flank: f64,
    },
    /// A rise from one level to another.
    Ramp {
        /// `h`, m.
        height: f64,
        /// `L`, m.
        length: f64,
    },
}

/// Why a piece of ground cannot be.
#[derive(Clone, PartialEq, Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RoadError {
    /// A number out of range.
    #[error("{what} is {found}, but must be {wanted}")]
    Range {
        /// What is wrong.
        what: &'static str,
        /// What was given.
        found: f64,
        /// What is allowed.
        wanted: &'static str,
    },
}

/// Refuses a number that is not `wanted`.
pub(crate) fn demand(fits: bool, what: &'static str, found: f64, wanted: &'static str) -> Result<(), RoadError> {
    if fits { Ok(()) } else { Err(RoadError::Range { what, found, wanted }) }
}

impl Profile {
    /// Height in m and its first three derivatives at the distance `s` in m.
    pub fn eval(&self, s: f64) -> [f64; 4] {
        match *self {
            Self::CosineBump { height, length } => {
                let k = TAU / length;
                let (sin, cos) = (k * s).sin_cos();
                let a = 0.5 * height;
                within(s, length, [a * (1.0 - cos), a * k * sin, a * k * k * cos, -a * k * k * k * sin])
            }
            Self::SineBump { height, length } => {
                let k = PI / length;
                let (sin, cos) = (k * s).sin_cos();
                within(s, length, [sin, k * cos, -k * k * sin, -k * k * k * cos].map(|x| height * x))
            }
            Self::Ditch { depth, length, flank } => {
                let down = step(s, flank);
                let up = step(s - (length - flank), flank);
                std::array::from_fn(|i| depth * (up[i] - down[i]))
            }
            Self::Ramp { height, length } => step(s, length).map(|x| height * x),
        }
    }

    /// Distances at which a derivative up to the third jumps.
    pub fn breakpoints(&self) -> Vec<f64> {
        match *self {
            Self::CosineBump { length, .. } | Self::SineBump { length, .. } => vec![0.0, length],
            // smooth to the third derivative, but a step of an integrator must not pass over them
            Self::Ditch { length, flank, .. } => vec![0.0, flank, length - flank, length],
            Self::Ramp { length, .. } => vec![0.0, length],
        }
    }

    /// The shortest length over which the height changes, m: an integrator's step must not be longer.
    pub fn shortest(&self) -> f64 {
        match *self {
            Self::CosineBump { length, .. } | Self::SineBump { length, .. } | Self::Ramp { length, .. } => length,
            Self::Ditch { flank, .. } => flank,
        }
    }

    /// Refuses lengths that are none.
    ///
    /// # Errors
    /// [`RoadError::Range`].
    pub fn check(&self) -> Result<(), RoadError> {
        let positive = |what, x: f64| demand(x > 0.0 && x.is_finite(), what, x, "above zero and finite");
        let finite = |what, x: f64| demand(x.is_finite(), what, x, "finite");
        match *self {
            Self::CosineBump { height, length } | Self::SineBump { height, length } | Self::Ramp { height, length } => {
                finite("height of a profile", height)?;
                positive("length of a profile", length)
            }
            Self::Ditch { depth, length, flank } => {
                finite("depth of a ditch", depth)?;
                positive("length of a ditch", length)?;
                positive("flank of a ditch", flank)?;
                demand(flank <= 0.5 * length, "flank of a ditch", flank, "at most half its length")
            }
        }
    }
}

/// A profile along a direction on the ground, as wide as wanted.
///
/// ```text
/// z = f(s) g(t)      s = (x − x_0) cos ψ + (y − y_0) sin ψ,   t = −(x − x_0) sin ψ + (y − y_0) cos ψ
/// ```
/// `g` is 1, or with a width falls from 1 to 0 outside `|t| ≤ w/2` over the length of its flank.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Obstacle {
    /// The profile along `s`.
    pub profile: Profile,
    /// Where it begins, `(x_0, y_0)`, m.
    pub start: [f64; 2],
    /// Direction `ψ` in which `s` runs, from x, rad.
    pub heading: f64,
    /// `[width, flank]` in m, or all across.
    pub width: Option<[f64; 2]>,
}

impl Obstacle {
    /// A profile across the whole ground that begins at `x = start`.
    pub fn across(profile: Profile, start: f64) -> Self {
        Self { profile, start: [start, 0.0], heading: 0.0, width: None }
    }

    /// Refuses what cannot be evaluated.
    ///
    /// # Errors
    /// [`RoadError::Range`].
    pub fn check(&self) -> Result<(), RoadError> {
        self.profile.check()?;
        for x in [self.start[0], self.start[1], self.heading] {
            demand(x.is_finite(), "place or heading of an obstacle", x, "finite")?;
        }
        let [width, flank] = self.width.unwrap_or([1.0, 1.0]);
        demand(width >= 0.0 && width.is_finite(), "width of an obstacle", width, "at least zero and finite")?;
        demand(flank > 0.0 && flank.is_finite(), "flank of an obstacle's width", flank, "above zero and finite")
    }

    /// Adds height and derivatives along x and y up to `order` to `out[i][j]`, `i` times x, `j` times y.
    pub(crate) fn add(&self, x: f64, y: f64, order: usize, out: &mut [[f64; 4]; 4]) {
        let (sin, cos) = self.heading.sin_cos();
        let (dx, dy) = (x - self.start[0], y - self.start[1]);
        let f = self.profile.eval(dx * cos + dy * sin);
        let g = self.across_factor(dy * cos - dx * sin);
        for i in 0..=order {
            for j in 0..=order - i {
                out[i][j] += turned(&f, &g, cos, sin, i, j);
            }
        }
    }

    fn across_factor(&self, t: f64) -> [f64; 4] {
        let Some([width, flank]) = self.width else { return [1.0, 0.0, 0.0, 0.0] };
        let from = step(t + 0.5 * width + flank, flank);
        let to = step(t - 0.5 * width, flank);
        std::array::from_fn(|i| from[i] - to[i])
    }
}

/// `(c ∂_s − n ∂_t)ⁱ (n ∂_s + c ∂_t)ʲ f(s) g(t)`.
fn turned(f: &[f64; 4], g: &[f64; 4], c: f64, n: f64, i: usize, j: usize) -> f64 {
    // coefficients by the number of ∂_s
    let mut terms = [1.0, 0.0, 0.0, 0.0];
    let mut degree = 0;
    for (of_s, of_t) in std::iter::repeat_n((c, -n), i).chain(std::iter::repeat_n((n, c), j)) {
        degree += 1;
        for k in (0..=degree).rev() {
            terms[k] = of_t * terms[k] + if k > 0 { of_s * terms[k - 1] } else { 0.0 };
        }
    }
    (0..=degree).map(|k| terms[k] * f[k] * g[degree - k]).sum()
}

/// Values where `0 ≤ s ≤ length`, zero elsewhere.
fn within(s: f64, length: f64, values: [f64; 4]) -> [f64; 4] {
    // NaN is not outside: it goes on
    if s < 0.0 || s > length { [0.0; 4] } else { values }
}

/// `S(s/length)` with its derivatives by `s`.
fn step(s: f64, length: f64) -> [f64; 4] {
    let u = s / length;
    if u <= 0.0 {
        return [0.0; 4];
    }
    if u >= 1.0 {
        return [1.0, 0.0, 0.0, 0.0];
    }
    let v = 1.0 - u;
    let value = u.powi(4) * (35.0 + u * (-84.0 + u * (70.0 - 20.0 * u)));
    let first = 140.0 * (u * v).powi(3);
    let second = 420.0 * (u * v).powi(2) * (1.0 - 2.0 * u);
    let third = 840.0 * u * v * (1.0 - 5.0 * u * v);
    [value, first / length, second / (length * length), third / length.powi(3)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    const ALL: [Profile; 4] = [
        Profile::CosineBump { height: 0.1, length: 2.0 },
        Profile::SineBump { height: 0.1, length: 2.0 },
        Profile::Ditch { depth: 0.3, length: 2.0, flank: 0.6 },
        Profile::Ramp { height: 0.5, length: 2.0 },
    ];

    #[test]
    fn derivatives_agree_with_differences() {
        let e = 1e-5;
        for p in ALL {
            p.check().unwrap();
            for s in [-0.5, 0.3, 0.55, 1.0, 1.7, 2.5] {
                let (a, b) = (p.eval(s + e), p.eval(s - e));
                for i in 0..3 {
                    assert_relative_eq!(p.eval(s)[i + 1], (a[i] - b[i]) / (2.0 * e), epsilon = 1e-6);
                }
            }
        }
    }

    #[test]
    fn heights_are_those_named() {
        assert_relative_eq!(ALL[0].eval(1.0)[0], 0.1);
        assert_relative_eq!(ALL[1].eval(1.0)[0], 0.1);
        assert_relative_eq!(ALL[2].eval(1.0)[0], -0.3);
        assert_eq!(ALL[3].eval(9.0)[0], 0.5);
        for p in ALL {
            assert_eq!(p.eval(-1e-9)[0], 0.0);
        }
        for p in &ALL[..3] {
            assert!(p.eval(2.0 + 1e-9)[0].abs() < 1e-12);
        }
        // smooth to the third derivative
        for s in [0.0, 0.6, 1.4, 2.0] {
            let (a, b) = (ALL[2].eval(s - 1e-9), ALL[2].eval(s + 1e-9));
            for i in 0..4 {
                assert_relative_eq!(a[i], b[i], epsilon = 1e-5);
            }
        }
    }

    #[test]
    fn wrong_numbers_are_messages() {
        let error = Profile::Ditch { depth: 0.3, length: 1.0, flank: 0.6 }.check().unwrap_err().to_string();
        assert_eq!(error, "flank of a ditch is 0.6, but must be at most half its length");
        assert!(Profile::Ramp { height: 1.0, length: 0.0 }.check().is_err());
        assert!(Profile::CosineBump { height: f64::NAN, length: 1.0 }.check().is_err());
    }
}
