//! [`Symmetric`]: a symmetric 3 × 3 matrix in six numbers.

use std::ops::{Add, Mul, Sub};

use headland_expr::Scalar;

use crate::vector::Vector;

/// Where entry `(i, j)` stands in the six numbers.
const PLACE: [[usize; 3]; 3] = [[0, 3, 4], [3, 1, 5], [4, 5, 2]];

/// A symmetric matrix: entries `[xx, yy, zz, xy, xz, yz]`.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Symmetric<S>(pub [S; 6]);

impl<S: Scalar> Symmetric<S> {
    /// From the entries of the matrix.
    #[inline]
    pub fn new(xx: S, yy: S, zz: S, xy: S, xz: S, yz: S) -> Self {
        Self([xx, yy, zz, xy, xz, yz])
    }
    /// The null matrix.
    #[inline]
    pub fn zero() -> Self {
        Self([S::constant(0.0); 6])
    }
    /// A diagonal matrix.
    #[inline]
    pub fn diagonal(xx: S, yy: S, zz: S) -> Self {
        let zero = S::constant(0.0);
        Self([xx, yy, zz, zero, zero, zero])
    }
    /// From `entry(i, j)`, asked for the upper triangle.
    #[inline]
    pub fn from_fn(mut entry: impl FnMut(usize, usize) -> S) -> Self {
        Self([entry(0, 0), entry(1, 1), entry(2, 2), entry(0, 1), entry(0, 2), entry(1, 2)])
    }
    /// Entry `(i, j)`.
    #[inline]
    pub fn get(&self, i: usize, j: usize) -> S {
        self.0[PLACE[i][j]]
    }
    /// Entry `(i, j)`, and with it `(j, i)`.
    #[inline]
    pub fn get_mut(&mut self, i: usize, j: usize) -> &mut S {
        &mut self.0[PLACE[i][j]]
    }
    /// Sum of the diagonal.
    #[inline]
    pub fn trace(&self) -> S {
        self.0[0] + self.0[1] + self.0[2]
    }
    /// `k (|d|² 1 − d dᵀ)`: the tensor of a point mass `k` at `d`, about the origin.
    #[inline]
    pub fn of_point(k: S, d: Vector<S>) -> Self {
        let [x, y, z] = d.0;
        let (kx, ky, kz) = (k * x, k * y, k * z);
        let (xx, yy, zz) = (kx * x, ky * y, kz * z);
        Self([yy + zz, zz + xx, xx + yy, -(kx * y), -(kx * z), -(ky * z)])
    }
}

impl<S: Scalar> Add for Symmetric<S> {
    type Output = Self;
    #[inline]
    fn add(self, b: Self) -> Self {
        Self(std::array::from_fn(|i| self.0[i] + b.0[i]))
    }
}

impl<S: Scalar> Sub for Symmetric<S> {
    type Output = Self;
    #[inline]
    fn sub(self, b: Self) -> Self {
        Self(std::array::from_fn(|i| self.0[i] - b.0[i]))
    }
}

impl<S: Scalar> Mul<S> for Symmetric<S> {
    type Output = Self;
    #[inline]
    fn mul(self, k: S) -> Self {
        Self(self.0.map(|x| x * k))
    }
}

impl<S: Scalar> Mul<Vector<S>> for Symmetric<S> {
    type Output = Vector<S>;
    #[inline]
    fn mul(self, v: Vector<S>) -> Vector<S> {
        let [xx, yy, zz, xy, xz, yz] = self.0;
        let [x, y, z] = v.0;
        Vector([xx * x + xy * y + xz * z, xy * x + yy * y + yz * z, xz * x + yz * y + zz * z])
    }
}
