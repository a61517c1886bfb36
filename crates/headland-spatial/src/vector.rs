//! [`Vector`]: three components in the axes of some frame; [`Axis`]: one of these axes.

use std::ops::{Add, Index, IndexMut, Mul, Neg, Sub};

use headland_expr::Scalar;

/// One of the three axes of a frame.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Axis {
    /// First axis.
    X,
    /// Second axis.
    Y,
    /// Third axis.
    Z,
}

impl Axis {
    /// All three in order.
    pub const ALL: [Axis; 3] = [Axis::X, Axis::Y, Axis::Z];

    /// 0, 1 or 2.
    #[inline]
    pub fn index(self) -> usize {
        self as usize
    }
    /// This axis and the two that follow it cyclically: `(i, j, k)` with `e_i × e_j = e_k`.
    #[inline]
    pub fn cycle(self) -> (usize, usize, usize) {
        let i = self.index();
        (i, (i + 1) % 3, (i + 2) % 3)
    }
    /// `x`, `y` or `z`.
    pub fn name(self) -> &'static str {
        ["x", "y", "z"][self.index()]
    }
}

/// Components `[x, y, z]` in the axes of a frame.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Vector<S>(pub [S; 3]);

impl<S: Scalar> Vector<S> {
    /// From components.
    #[inline]
    pub fn new(x: S, y: S, z: S) -> Self {
        Self([x, y, z])
    }
    /// The null vector.
    #[inline]
    pub fn zero() -> Self {
        Self([S::constant(0.0); 3])
    }
    /// A constant vector.
    #[inline]
    pub fn constant(x: [f64; 3]) -> Self {
        Self(x.map(S::constant))
    }
    /// `length` along an axis, structural zeros elsewhere.
    #[inline]
    pub fn along(axis: Axis, length: S) -> Self {
        let mut v = Self::zero();
        v[axis.index()] = length;
        v
    }
    /// First component.
    #[inline]
    pub fn x(self) -> S {
        self.0[0]
    }
    /// Second component.
    #[inline]
    pub fn y(self) -> S {
        self.0[1]
    }
    /// Third component.
    #[inline]
    pub fn z(self) -> S {
        self.0[2]
    }
    /// `a · b`.
    #[inline]
    pub fn dot(self, b: Self) -> S {
        self.0[0] * b.0[0] + self.0[1] * b.0[1] + self.0[2] * b.0[2]
    }
    /// `a × b`.
    #[inline]
    pub fn cross(self, b: Self) -> Self {
        let [ax, ay, az] = self.0;
        let [bx, by, bz] = b.0;
        Self([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx])
    }
    /// `|a|²`.
    #[inline]
    pub fn squared_norm(self) -> S {
        self.dot(self)
    }
    /// `|a|`; its derivative at zero is infinite.
    #[inline]
    pub fn norm(self) -> S {
        self.squared_norm().sqrt()
    }
    /// `a / |a|`.
    #[inline]
    pub fn unit(self) -> Self {
        let norm = self.norm();
        self.map(|x| x / norm)
    }
    /// A function of each component.
    #[inline]
    pub fn map<T>(self, f: impl FnMut(S) -> T) -> Vector<T> {
        Vector(self.0.map(f))
    }
}

impl<S> Index<usize> for Vector<S> {
    type Output = S;
    #[inline]
    fn index(&self, i: usize) -> &S {
        &self.0[i]
    }
}

impl<S> IndexMut<usize> for Vector<S> {
    #[inline]
    fn index_mut(&mut self, i: usize) -> &mut S {
        &mut self.0[i]
    }
}

impl<S: Scalar> Add for Vector<S> {
    type Output = Self;
    #[inline]
    fn add(self, b: Self) -> Self {
        Self([self.0[0] + b.0[0], self.0[1] + b.0[1], self.0[2] + b.0[2]])
    }
}

impl<S: Scalar> Sub for Vector<S> {
    type Output = Self;
    #[inline]
    fn sub(self, b: Self) -> Self {
        Self([self.0[0] - b.0[0], self.0[1] - b.0[1], self.0[2] - b.0[2]])
    }
}

impl<S: Scalar> Neg for Vector<S> {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self([-self.0[0], -self.0[1], -self.0[2]])
    }
}

impl<S: Scalar> Mul<S> for Vector<S> {
    type Output = Self;
    #[inline]
    fn mul(self, k: S) -> Self {
        Self([self.0[0] * k, self.0[1] * k, self.0[2] * k])
    }
}
