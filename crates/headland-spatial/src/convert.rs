//! To and from nalgebra, at the `f64` edge only.

use nalgebra::{Matrix3, Vector3};

use crate::rotation::Rotation;
use crate::symmetric::Symmetric;
use crate::vector::Vector;

impl From<Vector3<f64>> for Vector<f64> {
    fn from(v: Vector3<f64>) -> Self {
        Self([v.x, v.y, v.z])
    }
}

impl From<Vector<f64>> for Vector3<f64> {
    fn from(v: Vector<f64>) -> Self {
        Vector3::from(v.0)
    }
}

impl From<Rotation<f64>> for Matrix3<f64> {
    fn from(r: Rotation<f64>) -> Self {
        Matrix3::from_fn(|i, j| r.0[i][j])
    }
}

impl Rotation<f64> {
    /// The matrix as it is; nothing checks that it is a rotation.
    pub fn from_matrix(m: &Matrix3<f64>) -> Self {
        Self(std::array::from_fn(|i| std::array::from_fn(|j| m[(i, j)])))
    }
}

impl From<Symmetric<f64>> for Matrix3<f64> {
    fn from(s: Symmetric<f64>) -> Self {
        Matrix3::from_fn(|i, j| s.get(i, j))
    }
}
