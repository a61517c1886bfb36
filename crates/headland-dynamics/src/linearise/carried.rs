//! Axes that go with a steady motion, but do not spin with a body: a disc that rolls straight or in a circle.
//!
//! The angular velocity w of a body on a ball is written in the body's axes. In axes that coincide with them at the start
//! and in which the body spins by a constant σ, fixed in it, `w̃ = R w`, `R′ = R [σ]×`:
//!
//! ```text
//! w̃′ = R (w′ + σ × w) = 0   of a steady motion:   w″ = −σ × w′,   σ = −w′ × w″/|w′|²;     w′ = 0:   σ = w
//! s̃ = R s,  N = [σ]×:       Ã = P A Pᵀ + N        P: R on turns and velocities
//! ```
//! A turn about the spin's axis e alone turns w with the body; with `ŵ = w̃ + t e × w₀` it changes nothing. The turns are
//! counted about e (*spin*), about an axis p on which no rate of velocities depends (*precession*), and across both (*lean*):
//! `s̃ = lean a + precession p + spin e`.
//!
//! Whether all that was right is seen by the matrices, which must be constant.

use nalgebra::{DMatrix, Matrix3, Rotation3, Vector3};

use super::derivatives::Point;

/// Turns and velocities of a ball: positions among the displacements and among the velocities.
#[derive(Clone, Debug)]
pub(super) struct Triple {
    name: String,
    pub(super) turns: [usize; 3],
    pub(super) velocities: [usize; 3],
}

/// The balls of which all three turns and velocities are independent.
pub(super) fn triples(turns: &[&str], velocities: &[&str]) -> Vec<Triple> {
    let first = velocities.iter().filter_map(|v| v.strip_suffix(".wx"));
    let complete = first.filter_map(|name| {
        let of = |axis: &str| {
            let velocity = format!("{name}.{axis}");
            let turn = turns.iter().position(|t| t.strip_prefix('∫') == Some(&velocity))?;
            Some((turn, velocities.iter().position(|v| *v == velocity)?))
        };
        let (x, y, z) = (of("wx")?, of("wy")?, of("wz")?);
        Some(Triple { name: name.to_string(), turns: [x.0, y.0, z.0], velocities: [x.1, y.1, z.1] })
    });
    complete.collect()
}

/// Axes that do not spin with a body.
#[derive(Clone, Debug)]
pub(super) struct Carried {
    pub(super) triple: Triple,
    /// Angular velocity of the body in these axes, in its own.
    spin: Vector3<f64>,
    /// `[a, p, e]` by columns.
    axes: Matrix3<f64>,
    inverse: Matrix3<f64>,
    /// `e × w₀`
    turned: Vector3<f64>,
}

impl Carried {
    /// From w, w′, w″ and A at the start, with `ns` displacements; none if the body does not turn.
    pub(super) fn new(
        triple: Triple,
        w: [f64; 3],
        rate: [f64; 3],
        second: [f64; 3],
        a: &DMatrix<f64>,
        ns: usize,
    ) -> Option<Self> {
        let [w, rate, second] = [w, rate, second].map(Vector3::from);
        let changes = rate.norm() > 1e-9 * w.norm_squared();
        let spin = if changes { -rate.cross(&second) / rate.norm_squared() } else { w };
        let e = spin.try_normalize(1e-12 * w.norm())?;
        // turns on which no rate of a velocity depends
        let columns = DMatrix::from_fn(a.nrows() - ns, 3, |i, j| a[(ns + i, triple.turns[j])]);
        let svd = columns.transpose().svd(true, false); // all three left vectors, however few the velocities
        let u = svd.u?;
        let nothing = 1e-9 * a.amax();
        let neutral = |k: usize| svd.singular_values.get(k).is_none_or(|s| *s <= nothing);
        let candidates = (0..u.ncols().min(3)).filter(|k| neutral(*k)).map(|k| Vector3::from_fn(|i, _| u[(i, k)]));
        let across = |v: &Vector3<f64>| (v - e * e.dot(v)).norm();
        let best = candidates.max_by(|a, b| across(a).total_cmp(&across(b))).filter(|v| across(v) > 1e-6);
        let any = if e.x.abs() < 0.6 { Vector3::x() } else { Vector3::z() };
        let p = match best {
            // where turns about e are neutral as well, any mixture with them is: at right angles then
            Some(v) if (columns * e).amax() <= nothing => (v - e * e.dot(&v)).normalize(),
            Some(v) => v,
            None => (any - e * e.dot(&any)).normalize(),
        };
        let axes = Matrix3::from_columns(&[p.cross(&e).normalize(), p, e]);
        let inverse = axes.try_inverse()?;
        Some(Self { triple, spin, axes, inverse, turned: e.cross(&w) })
    }

    /// Names of the turns.
    pub(super) fn names(&self) -> [String; 3] {
        ["lean", "precession", "spin"].map(|turn| format!("{turn} of {}", self.triple.name))
    }

    /// Rates and matrices in these axes, the given time after they coincided with the body's.
    pub(super) fn apply(&self, point: &mut Point, after: f64, u: &[f64], nq: usize, ns: usize) {
        let turn = *Rotation3::new(self.spin * after).matrix();
        let at = self.triple.velocities.map(|k| nq + k);
        let [w, rate] = [self.triple.velocities.map(|k| u[k]), at.map(|k| point.rates[k])].map(Vector3::from);
        let steady = turn * (rate + self.spin.cross(&w));
        at.into_iter().zip(steady.iter()).for_each(|(k, value)| point.rates[k] = *value);

        let n = point.a.nrows();
        let velocities = self.triple.velocities.map(|k| ns + k);
        let mut change = DMatrix::identity(n, n); // x̂ = S P x
        let mut back = DMatrix::identity(n, n);
        let mut drift = DMatrix::zeros(n, n); // S N S⁻¹, of which N commutes with P
        let [turns, turns_back] = [self.inverse * turn, turn.transpose() * self.axes];
        let cross = self.spin.cross_matrix();
        // ŵ = w̃ + (e × w₀) t, t the last of the turns
        let shift = Matrix3::from_columns(&[Vector3::zeros(), Vector3::zeros(), self.turned]);
        let drift_of_turns = self.inverse * cross * self.axes;
        let blocks = [
            (self.triple.turns, self.triple.turns, turns, turns_back, drift_of_turns),
            (velocities, velocities, turn, turn.transpose(), cross),
            (
                velocities,
                self.triple.turns,
                shift * turns,
                -(turn.transpose() * shift),
                shift * drift_of_turns - cross * shift,
            ),
        ];
        for (rows, columns, forward, inverse, of_drift) in blocks {
            for i in 0..3 {
                for j in 0..3 {
                    change[(rows[i], columns[j])] = forward[(i, j)];
                    back[(rows[i], columns[j])] = inverse[(i, j)];
                    drift[(rows[i], columns[j])] = of_drift[(i, j)];
                }
            }
        }
        point.a = &change * &point.a * back + drift;
        point.b = change * &point.b;
    }
}
