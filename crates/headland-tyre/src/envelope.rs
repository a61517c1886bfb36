//! [`Envelope`]: the plane that a tyre of some size sees of uneven ground, by heights at several points.
//!
//! ```text
//! z_e = Σ w_k z_k        ∂z/∂x = Σ w_k ξ_k z_k / Σ w_k ξ_k²        ∂z/∂y likewise with η_k        Σ w_k = 1
//! ```
//! `(ξ_k, η_k)` are places about the contact point, along and across the wheel, symmetric, so that the three are the plane of
//! least weighted squares. A contact patch of length L averages a wave of frequency n to `sin(πnL)/(πnL)` of its height: waves
//! shorter than the patch do not reach the wheel.
//!
//! # References
//! Rill, *Road Vehicle Dynamics*, 2012, sec. 3.2 (four points); Captain, Boghani and Wormley, *Analytical tire models for dynamic
//! vehicle simulation*, Veh. Syst. Dyn. 8, 1979 (fixed footprint).

use headland_expr::Scalar;

use crate::guard::num;
use crate::profile::{RoadError, demand};

/// Places about the contact point with their weights.
#[derive(Clone, PartialEq, Debug)]
pub struct Envelope {
    /// `[ξ, η, w]`, m and a pure number.
    points: Vec<[f64; 3]>,
    /// `Σ w ξ²`, `Σ w η²`, m².
    spread: [f64; 2],
}

/// A plane over x and y at the contact point.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct GroundPlane<S> {
    /// Height, m.
    pub height: S,
    /// Rise over run along the wheel and across it.
    pub slope: [S; 2],
}

impl Envelope {
    /// Rill's four points: `dx` before and behind, `dy` to the left and to the right; a tenth of the radius and three tenths of
    /// the width are usual.
    ///
    /// # Errors
    /// [`RoadError::Range`].
    pub fn four_points(dx: f64, dy: f64) -> Result<Self, RoadError> {
        for d in [dx, dy] {
            demand(d > 0.0 && d.is_finite(), "distance of an enveloping wheel's points", d, "above zero and finite")?;
        }
        Ok(Self::new(vec![[dx, 0.0, 0.25], [-dx, 0.0, 0.25], [0.0, dy, 0.25], [0.0, -dy, 0.25]]))
    }

    /// The patch `length × width` by Gauss's points, `along` times `across` of them, 2 to 20 each.
    ///
    /// # Errors
    /// [`RoadError::Range`].
    pub fn patch(length: f64, width: f64, along: usize, across: usize) -> Result<Self, RoadError> {
        for d in [length, width] {
            demand(d > 0.0 && d.is_finite(), "size of a contact patch", d, "above zero and finite")?;
        }
        for n in [along, across] {
            demand((2..=20).contains(&n), "number of points of a contact patch", n as f64, "2 to 20")?;
        }
        let (x, y) = (gauss_legendre(along), gauss_legendre(across));
        let cell = |a: &[f64; 2], b: &[f64; 2]| [0.5 * length * a[0], 0.5 * width * b[0], 0.25 * a[1] * b[1]];
        Ok(Self::new(x.iter().flat_map(|a| y.iter().map(move |b| cell(a, b))).collect()))
    }

    fn new(points: Vec<[f64; 3]>) -> Self {
        let spread = [0, 1].map(|i| points.iter().map(|p| p[2] * p[i] * p[i]).sum());
        Self { points, spread }
    }

    /// Places `[ξ, η]` along and across the wheel, m, at which heights are wanted.
    pub fn points(&self) -> impl ExactSizeIterator<Item = [f64; 2]> + '_ {
        self.points.iter().map(|p| [p[0], p[1]])
    }

    /// The plane by the heights at all [points](Self::points), in their order.
    ///
    /// # Panics
    /// If there are not as many heights as points.
    pub fn plane<S: Scalar>(&self, heights: &[S]) -> GroundPlane<S> {
        assert_eq!(heights.len(), self.points.len(), "one height a point");
        let mut sums = [num::<S>(0.0); 3];
        for (z, [x, y, w]) in heights.iter().zip(&self.points) {
            for (sum, factor) in sums.iter_mut().zip([*w, w * x / self.spread[0], w * y / self.spread[1]]) {
                if factor != 0.0 {
                    *sum = *sum + num::<S>(factor) * *z;
                }
            }
        }
        GroundPlane { height: sums[0], slope: [sums[1], sums[2]] }
    }
}

/// Abscissas and weights on (−1, 1), by Newton's method on Legendre's polynomial.
fn gauss_legendre(n: usize) -> Vec<[f64; 2]> {
    let count = n as f64;
    (0..n)
        .map(|i| {
            let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / (count + 0.5)).cos();
            let mut slope = 1.0;
            for _ in 0..8 {
                let (mut p, mut before) = (x, 1.0);
                for k in 2..=n {
                    let k = k as f64;
                    (p, before) = (((2.0 * k - 1.0) * x * p - (k - 1.0) * before) / k, p);
                }
                slope = count * (x * p - before) / (x * x - 1.0);
                x -= p / slope;
            }
            [x, 2.0 / ((1.0 - x * x) * slope * slope)]
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use std::f64::consts::{PI, TAU};

    fn all() -> Vec<Envelope> {
        vec![
            Envelope::four_points(0.06, 0.09).unwrap(),
            Envelope::patch(0.3, 0.25, 2, 2).unwrap(),
            Envelope::patch(0.3, 0.25, 7, 4).unwrap(),
            Envelope::patch(0.3, 0.25, 20, 3).unwrap(),
        ]
    }

    fn seen(of: &Envelope, z: impl Fn(f64, f64) -> f64) -> GroundPlane<f64> {
        of.plane(&of.points().map(|[x, y]| z(x, y)).collect::<Vec<_>>())
    }

    #[test]
    fn a_plane_is_seen_as_it_is() {
        for of in all() {
            let plane = seen(&of, |x, y| 0.3 + 0.2 * x - 0.5 * y);
            assert_relative_eq!(plane.height, 0.3, max_relative = 1e-13);
            assert_relative_eq!(plane.slope[0], 0.2, max_relative = 1e-13);
            assert_relative_eq!(plane.slope[1], -0.5, max_relative = 1e-13);
        }
    }

    /// Averages over an interval of a wave and of its first moment, in closed form.
    #[test]
    fn waves_are_averaged_over_the_patch() {
        let length = 0.3;
        let of = Envelope::patch(length, 0.25, 12, 2).unwrap();
        for n in [0.1, 1.0, 2.0, 1.0 / 0.3, 6.0] {
            let a = PI * n * length;
            let cosine = seen(&of, |x, _| (TAU * n * x).cos());
            assert_relative_eq!(cosine.height, a.sin() / a, epsilon = 1e-9);
            let sine = seen(&of, |x, _| (TAU * n * x).sin());
            let moment = (a.sin() - a * a.cos()) / (a * a) * 0.5 * length;
            assert_relative_eq!(sine.slope[0], moment / (length * length / 12.0), epsilon = 1e-7);
            assert!(sine.height.abs() < 1e-14);
        }
    }

    #[test]
    fn gauss_is_exact_for_polynomials() {
        for n in 2..=20 {
            for degree in 0..2 * n {
                let sum: f64 = gauss_legendre(n).iter().map(|[x, w]| w * x.powi(degree as i32)).sum();
                let exact = if degree % 2 == 0 { 2.0 / (degree as f64 + 1.0) } else { 0.0 };
                assert_relative_eq!(sum, exact, epsilon = 1e-13);
            }
        }
    }

    #[test]
    fn wrong_sizes_are_messages() {
        assert_eq!(
            Envelope::patch(0.3, 0.2, 1, 4).unwrap_err().to_string(),
            "number of points of a contact patch is 1, but must be 2 to 20"
        );
        assert!(Envelope::four_points(0.0, 0.1).is_err());
    }
}
