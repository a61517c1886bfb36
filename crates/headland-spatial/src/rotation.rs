//! [`Rotation`]: the orientation of one frame in another as a matrix.

use std::ops::Mul;

use headland_expr::Scalar;

use crate::quaternion::Quaternion;
use crate::symmetric::Symmetric;
use crate::vector::{Axis, Vector};

/// `R_AB`, by rows: `v_A = R_AB v_B`; its columns are B's axes written in A.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Rotation<S>(pub [[S; 3]; 3]);

impl<S: Scalar> Rotation<S> {
    /// B's axes are A's.
    #[inline]
    pub fn identity() -> Self {
        let (o, i) = (S::constant(0.0), S::constant(1.0));
        Self([[i, o, o], [o, i, o], [o, o, i]])
    }

    /// B is A turned by `angle` (rad) about one of its axes; the other entries are structural 0 and 1.
    #[inline]
    pub fn about(axis: Axis, angle: S) -> Self {
        let (sin, cos) = angle.sin_cos();
        Self::about_sin_cos(axis, sin, cos)
    }

    /// [`about`](Self::about) with sine and cosine of the angle given.
    #[inline]
    pub fn about_sin_cos(axis: Axis, sin: S, cos: S) -> Self {
        let (_, j, k) = axis.cycle();
        let mut r = Self::identity();
        r.0[j][j] = cos;
        r.0[k][k] = cos;
        r.0[j][k] = -sin;
        r.0[k][j] = sin;
        r
    }

    /// B is A turned by `angle` (rad) about the *unit* vector `a`, which has the same components in both.
    ///
    /// ```text
    /// R = cos φ 1 + sin φ [a]× + (1 − cos φ) a aᵀ
    /// ```
    /// # References
    /// Rodrigues, 1840.
    #[inline]
    pub fn about_unit(a: Vector<S>, angle: S) -> Self {
        let (sin, cos) = angle.sin_cos();
        let Vector([x, y, z]) = a;
        let Vector([ux, uy, uz]) = a * (S::constant(1.0) - cos);
        let (xy, xz, yz) = (ux * y, ux * z, uy * z);
        let (sx, sy, sz) = (sin * x, sin * y, sin * z);
        Self([
            [cos + ux * x, xy - sz, xz + sy],
            [xy + sz, cos + uy * y, yz - sx],
            [xz - sy, yz + sx, cos + uz * z], //
        ])
    }

    /// From a quaternion of any length but zero: formed with `2/|q|²`, so that drift of the norm is harmless.
    #[inline]
    pub fn from_quaternion(q: Quaternion<S>) -> Self {
        let [w, x, y, z] = q.0;
        let s = S::constant(2.0) / q.squared_norm();
        let (sx, sy, sz) = (s * x, s * y, s * z);
        let (wx, wy, wz) = (sx * w, sy * w, sz * w);
        let (xx, xy, xz) = (sx * x, sx * y, sx * z);
        let (yy, yz, zz) = (sy * y, sy * z, sz * z);
        let one = S::constant(1.0);
        Self([
            [one - (yy + zz), xy - wz, xz + wy],
            [xy + wz, one - (xx + zz), yz - wx],
            [xz - wy, yz + wx, one - (xx + yy)], //
        ])
    }

    /// `Rz(yaw) Ry(pitch) Rx(roll)`, angles in rad: yaw first, about the axes as they have been turned.
    #[inline]
    pub fn from_roll_pitch_yaw(roll: S, pitch: S, yaw: S) -> Self {
        Self::about(Axis::Z, yaw) * Self::about(Axis::Y, pitch) * Self::about(Axis::X, roll)
    }

    /// `(roll, pitch, yaw)` in rad with `R = Rz(yaw) Ry(pitch) Rx(roll)`, `|pitch| ≤ π/2`.
    ///
    /// At `|pitch| = π/2` roll and yaw have no meaning of their own (and derivatives are infinite).
    #[inline]
    pub fn roll_pitch_yaw(&self) -> (S, S, S) {
        let r = &self.0;
        let level = (r[0][0] * r[0][0] + r[1][0] * r[1][0]).sqrt();
        (r[2][1].atan2(r[2][2]), (-r[2][0]).atan2(level), r[1][0].atan2(r[0][0]))
    }

    /// `R_BA`.
    #[inline]
    pub fn transpose(&self) -> Self {
        Self(std::array::from_fn(|i| std::array::from_fn(|j| self.0[j][i])))
    }

    /// `R_BA`; a rotation's inverse is its transpose.
    #[inline]
    pub fn inverse(&self) -> Self {
        self.transpose()
    }

    /// `v_A = R_AB v_B`.
    #[inline]
    pub fn apply(&self, v: Vector<S>) -> Vector<S> {
        let [x, y, z] = self.0;
        Vector([Vector(x).dot(v), Vector(y).dot(v), Vector(z).dot(v)])
    }

    /// `v_B = R_ABᵀ v_A`.
    #[inline]
    pub fn apply_inverse(&self, v: Vector<S>) -> Vector<S> {
        let r = &self.0;
        Vector(std::array::from_fn(|j| r[0][j] * v[0] + r[1][j] * v[1] + r[2][j] * v[2]))
    }

    /// `R T Rᵀ`: a tensor written in B, written in A.
    #[inline]
    pub fn apply_to_tensor(&self, t: &Symmetric<S>) -> Symmetric<S> {
        let rows = self.0.map(|row| *t * Vector(row)); // T Rᵀ, by columns
        Symmetric::from_fn(|i, j| Vector(self.0[i]).dot(rows[j]))
    }

    /// Column `i`: B's axis written in A.
    #[inline]
    pub fn axis(&self, i: Axis) -> Vector<S> {
        Vector(self.0.map(|row| row[i.index()]))
    }
}

impl<S: Scalar> Mul for Rotation<S> {
    type Output = Self;
    /// `R_AC = R_AB R_BC`.
    #[inline]
    fn mul(self, other: Self) -> Self {
        let (a, b) = (&self.0, &other.0);
        Self(std::array::from_fn(|i| {
            std::array::from_fn(|j| a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j])
        }))
    }
}

impl<S: Scalar> Mul<Vector<S>> for Rotation<S> {
    type Output = Vector<S>;
    #[inline]
    fn mul(self, v: Vector<S>) -> Vector<S> {
        self.apply(v)
    }
}
