//! [`Quaternion`]: an orientation in four numbers without a singularity.

use std::ops::Mul;

use headland_expr::Scalar;

use crate::rotation::Rotation;
use crate::vector::Vector;

/// `[w, x, y, z]`, scalar part first. Its length carries no meaning; `q` and `−q` are the same orientation.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Quaternion<S>(pub [S; 4]);

impl<S: Scalar> Quaternion<S> {
    /// From scalar and vector part.
    #[inline]
    pub fn new(w: S, v: Vector<S>) -> Self {
        Self([w, v[0], v[1], v[2]])
    }
    /// No rotation: (1, 0, 0, 0).
    #[inline]
    pub fn identity() -> Self {
        Self::new(S::constant(1.0), Vector::zero())
    }
    /// Rotation by `angle` (rad) about the unit vector `a`.
    #[inline]
    pub fn about_unit(a: Vector<S>, angle: S) -> Self {
        let (sin, cos) = (angle * S::constant(0.5)).sin_cos();
        Self::new(cos, a * sin)
    }
    /// Vector part.
    #[inline]
    pub fn vector(&self) -> Vector<S> {
        Vector([self.0[1], self.0[2], self.0[3]])
    }
    /// `|q|²`.
    #[inline]
    pub fn squared_norm(&self) -> S {
        let [w, x, y, z] = self.0;
        w * w + x * x + y * y + z * z
    }
    /// `|q|`.
    #[inline]
    pub fn norm(&self) -> S {
        self.squared_norm().sqrt()
    }
    /// `(w, −x, −y, −z)`: of a unit quaternion the inverse.
    #[inline]
    pub fn conjugate(&self) -> Self {
        Self::new(self.0[0], -self.vector())
    }
    /// Unit length.
    #[inline]
    pub fn unit(&self) -> Self {
        let norm = self.norm();
        Self(self.0.map(|x| x / norm))
    }
    /// `R_AB`, formed with `2/|q|²`.
    #[inline]
    pub fn rotation(&self) -> Rotation<S> {
        Rotation::from_quaternion(*self)
    }
    /// `q̇ = ½ q (0, ω)`, ω (rad/s) of B in A written in B's axes. Keeps `|q|`.
    #[inline]
    pub fn rate_from_body(&self, w: Vector<S>) -> Self {
        let [q0, q1, q2, q3] = self.0;
        let [a, b, c] = (w * S::constant(0.5)).0;
        Self([
            -(q1 * a + q2 * b + q3 * c),
            q0 * a + q2 * c - q3 * b,
            q0 * b + q3 * a - q1 * c,
            q0 * c + q1 * b - q2 * a,
        ])
    }
    /// `q̇ = ½ (0, ω) q`, ω (rad/s) of B in A written in A's axes. Keeps `|q|`.
    #[inline]
    pub fn rate_from_world(&self, w: Vector<S>) -> Self {
        let [q0, q1, q2, q3] = self.0;
        let [a, b, c] = (w * S::constant(0.5)).0;
        Self([
            -(q1 * a + q2 * b + q3 * c),
            q0 * a + q3 * b - q2 * c,
            q0 * b + q1 * c - q3 * a,
            q0 * c + q2 * a - q1 * b,
        ])
    }
}

impl<S: Scalar> Mul for Quaternion<S> {
    type Output = Self;
    /// Hamilton's product: `R(p q) = R(p) R(q)`.
    #[inline]
    fn mul(self, q: Self) -> Self {
        let ([a, b, c, d], [w, x, y, z]) = (self.0, q.0);
        Self([
            a * w - b * x - c * y - d * z,
            a * x + b * w + c * z - d * y,
            a * y - b * z + c * w + d * x,
            a * z + b * y - c * x + d * w,
        ])
    }
}

impl Rotation<f64> {
    /// The unit quaternion with `w ≥ 0` of this rotation.
    ///
    /// # References
    /// Shepperd, *Quaternion from rotation matrix*, 1978: the largest of the four is found first, so nothing cancels.
    pub fn quaternion(&self) -> Quaternion<f64> {
        let r = &self.0;
        let trace = r[0][0] + r[1][1] + r[2][2];
        let largest = (0..3).fold(3, |best, i| {
            let of = |i: usize| if i == 3 { trace } else { r[i][i] };
            if of(i) > of(best) { i } else { best }
        });
        let mut q = [0.0; 4];
        if largest == 3 {
            q = [1.0 + trace, r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1]];
        } else {
            let (i, j, k) = (largest, (largest + 1) % 3, (largest + 2) % 3);
            q[0] = r[k][j] - r[j][k];
            q[1 + i] = 1.0 + 2.0 * r[i][i] - trace;
            q[1 + j] = r[j][i] + r[i][j];
            q[1 + k] = r[k][i] + r[i][k];
        }
        let norm = q.iter().map(|x| x * x).sum::<f64>().sqrt();
        let sign = if q[0] < 0.0 { -norm } else { norm };
        Quaternion(q.map(|x| x / sign))
    }
}
