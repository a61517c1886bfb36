//! [`Ellipsoid`]: distance from an ellipsoid, from outside and from inside.

use headland_expr::{FIELD_PARTS, Field};
use nalgebra::{Matrix3, Vector3};

use crate::implicit::{self, Level};
use crate::shape::{ShapeError, Side};

/// An ellipsoid about the origin, its semi-axes along x, y and z.
///
/// The foot is the largest root `t` of
///
/// ```text
/// Σ (a_i c_i / (t + a_i²))² = 1        p_i = a_i² c_i / (t + a_i²)
/// ```
/// found by Newton's method from below, where the left side is convex and falls: no other start is needed. On the flat
/// piece inside where two feet are equally near, there is a distance, and the derivatives are NaN.
///
/// # References
/// D. Eberly, *Distance from a Point to an Ellipse, an Ellipsoid, or a Hyperellipsoid*, 2013.
#[derive(Clone, Debug)]
pub struct Ellipsoid {
    name: String,
    axes: [f64; 3],
    side: Side,
}

impl Ellipsoid {
    /// From its semi-axes, m.
    ///
    /// # Errors
    /// [`ShapeError::Size`] for one that is not positive and finite.
    pub fn new(name: &str, axes: [f64; 3], side: Side) -> Result<Self, ShapeError> {
        for (value, size) in axes.into_iter().zip(["semi-axis along x", "semi-axis along y", "semi-axis along z"]) {
            if !(value > 0.0 && value.is_finite()) {
                return Err(ShapeError::Size { shape: "ellipsoid", size, value });
            }
        }
        Ok(Self { name: name.to_string(), axes, side })
    }

    /// Semi-axes along x, y and z, m.
    pub fn axes(&self) -> [f64; 3] {
        self.axes
    }

    /// Whether a ball of radius `ball`, m, can touch it everywhere: inside, it must be smaller than the sharpest bend.
    ///
    /// # Errors
    /// [`ShapeError::TooLarge`], [`ShapeError::Ball`].
    pub fn fits(&self, ball: f64) -> Result<(), ShapeError> {
        if !(ball > 0.0 && ball.is_finite()) {
            return Err(ShapeError::Ball { value: ball });
        }
        let least = self.axes.into_iter().fold(f64::INFINITY, f64::min);
        let most = self.axes.into_iter().fold(0.0, f64::max);
        let room = if self.side == Side::Inside { least * least / most } else { f64::INFINITY };
        if ball < room { Ok(()) } else { Err(ShapeError::TooLarge { shape: "ellipsoid's sharpest bend", ball, room }) }
    }

    /// A nearest point, and whether it is the only one; `None` for a point that is not finite.
    pub fn foot(&self, c: [f64; 3]) -> Option<([f64; 3], bool)> {
        if c.iter().any(|x| !x.is_finite()) {
            return None;
        }
        let least = (0..3).min_by(|&i, &j| self.axes[i].total_cmp(&self.axes[j])).unwrap_or(0);
        // beyond the least axis, so that nothing cancels: t + a_i² = s + beyond_i
        let beyond = self.axes.map(|a| (a - self.axes[least]) * (a + self.axes[least]));
        let reach: [f64; 3] = std::array::from_fn(|i| self.axes[i] * c[i].abs());
        let mut s = (0..3).map(|i| reach[i] - beyond[i]).fold(0.0, f64::max);
        let inside_all =
            |s: f64| (0..3).filter(|&i| reach[i] > 0.0).map(|i| (reach[i] / (s + beyond[i])).powi(2)).sum::<f64>();
        if s == 0.0 && inside_all(0.0) <= 1.0 {
            return Some(self.foot_on_flat(c, least, &beyond));
        }
        for _ in 0..200 {
            let slope: f64 =
                (0..3).filter(|&i| reach[i] > 0.0).map(|i| -2.0 * reach[i] * reach[i] / (s + beyond[i]).powi(3)).sum();
            // of one over the root of the sum, which is nearly straight in s
            let value = inside_all(s).sqrt();
            let step = 2.0 * value * value * (value - 1.0) / -slope;
            s += step.max(0.0);
            if step <= 2e-16 * s || step.is_nan() {
                break;
            }
        }
        let p =
            std::array::from_fn(
                |i| if c[i] == 0.0 { 0.0 } else { self.axes[i] * self.axes[i] * c[i] / (s + beyond[i]) },
            );
        Some((p, true))
    }

    /// Inside, across the least axis: feet on both sides of it.
    fn foot_on_flat(&self, c: [f64; 3], least: usize, beyond: &[f64; 3]) -> ([f64; 3], bool) {
        let mut p = [0.0; 3];
        for i in (0..3).filter(|&i| i != least && c[i] != 0.0) {
            p[i] = self.axes[i] * self.axes[i] * c[i] / beyond[i];
        }
        let used: f64 = (0..3).map(|i| (p[i] / self.axes[i]).powi(2)).sum();
        p[least] = self.axes[least] * (1.0 - used).max(0.0).sqrt();
        (p, p[least] == 0.0)
    }
}

impl Field for Ellipsoid {
    fn name(&self) -> &str {
        &self.name
    }

    fn eval(&self, point: [f64; 3], order: usize, out: &mut [f64]) {
        let sign = self.side.sign::<f64>();
        let Some((foot, single)) = self.foot(point) else {
            out[..FIELD_PARTS[order]].fill(f64::NAN);
            return;
        };
        let weight: Vector3<f64> = Vector3::from(self.axes.map(|a| sign / (a * a)));
        let level = Level {
            gradient: 2.0 * weight.component_mul(&Vector3::from(foot)),
            hessian: Matrix3::from_diagonal(&(2.0 * weight)),
            third: [Matrix3::zeros(); 3],
        };
        implicit::write(point, foot, &level, order, out);
        if !single {
            out[1..FIELD_PARTS[order]].fill(f64::NAN);
        }
    }
}
