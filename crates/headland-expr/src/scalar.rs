//! [`Scalar`]: what the mechanics is written over.

use std::ops::{Add, Div, Mul, Neg, Sub};
use std::sync::Arc;

use crate::field::{Field, field_value};
use crate::spline::Spline;

/// What the mechanics is written over: `f64`, SIMD lanes, a dual number, an interval or an expression.
///
/// There is no `<`: a branch is [`Scalar::select`], so that every scalar can take it. Both branches are
/// evaluated: guard an argument before the operation (a square root at zero has an infinite derivative), never after.
pub trait Scalar:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// The constant `x`.
    fn constant(x: f64) -> Self;
    /// `xⁿ`, integer `n`.
    fn powi(self, n: i32) -> Self;
    /// `xʸ`; real only for `x > 0`.
    fn pow(self, y: Self) -> Self;
    /// Square root.
    fn sqrt(self) -> Self;
    /// Exponential.
    fn exp(self) -> Self;
    /// Natural logarithm.
    fn ln(self) -> Self;
    /// Sine, argument in radians.
    fn sin(self) -> Self;
    /// Cosine, argument in radians.
    fn cos(self) -> Self;
    /// Tangent, argument in radians.
    fn tan(self) -> Self;
    /// Inverse sine in radians.
    fn asin(self) -> Self;
    /// Inverse cosine in radians.
    fn acos(self) -> Self;
    /// Inverse tangent in radians.
    fn atan(self) -> Self;
    /// Angle of the point `(x, self)` in radians.
    fn atan2(self, x: Self) -> Self;
    /// Hyperbolic sine.
    fn sinh(self) -> Self;
    /// Hyperbolic cosine.
    fn cosh(self) -> Self;
    /// Hyperbolic tangent.
    fn tanh(self) -> Self;
    /// Absolute value.
    fn abs(self) -> Self;
    /// −1, 0 or 1.
    fn sign(self) -> Self;
    /// The smaller of two.
    fn min(self, other: Self) -> Self;
    /// The larger of two.
    fn max(self, other: Self) -> Self;
    /// `a` where `cond ≥ 0`, else `b`. Both are evaluated: guard arguments before.
    fn select(cond: Self, a: Self, b: Self) -> Self;
    /// The `order`-th derivative of a spline at `self`.
    fn spline(self, table: &Spline, order: u8) -> Self;
    /// A part of a field at a point: its value (part 0) or a derivative, see [`field_part`](crate::field_part).
    ///
    /// What lies beyond the third order is unknown: NaN for numbers, in a graph a node that
    /// [`Graph::beyond_fields`](crate::Graph::beyond_fields) finds.
    fn field(point: [Self; 3], field: &Arc<dyn Field>, part: usize) -> Self;
    /// All parts up to `order` (at most 3) into the [`FIELD_PARTS`](crate::FIELD_PARTS)`[order]` places of `out`; numbers
    /// and lanes take one evaluation of the field a point.
    fn field_parts(point: [Self; 3], field: &Arc<dyn Field>, order: usize, out: &mut [Self]) {
        assert_eq!(out.len(), crate::FIELD_PARTS[order], "places for the parts of a field");
        for (part, out) in out.iter_mut().enumerate() {
            *out = Self::field(point, field, part);
        }
    }
    /// Sine and cosine together.
    fn sin_cos(self) -> (Self, Self) {
        (self.sin(), self.cos())
    }
}

impl Scalar for f64 {
    fn constant(x: f64) -> Self {
        x
    }
    /// By repeated squaring, so that every back end multiplies in the same order.
    fn powi(self, n: i32) -> Self {
        let mut base = self;
        let mut left = n.unsigned_abs();
        let mut product = 1.0;
        while left > 0 {
            if left & 1 == 1 {
                product *= base;
            }
            left >>= 1;
            if left > 0 {
                base *= base;
            }
        }
        if n < 0 { 1.0 / product } else { product }
    }
    fn pow(self, y: Self) -> Self {
        self.powf(y)
    }
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }
    fn exp(self) -> Self {
        f64::exp(self)
    }
    fn ln(self) -> Self {
        f64::ln(self)
    }
    fn sin(self) -> Self {
        f64::sin(self)
    }
    fn cos(self) -> Self {
        f64::cos(self)
    }
    fn tan(self) -> Self {
        f64::tan(self)
    }
    fn asin(self) -> Self {
        f64::asin(self)
    }
    fn acos(self) -> Self {
        f64::acos(self)
    }
    fn atan(self) -> Self {
        f64::atan(self)
    }
    fn atan2(self, x: Self) -> Self {
        f64::atan2(self, x)
    }
    fn sinh(self) -> Self {
        f64::sinh(self)
    }
    fn cosh(self) -> Self {
        f64::cosh(self)
    }
    fn tanh(self) -> Self {
        f64::tanh(self)
    }
    fn abs(self) -> Self {
        f64::abs(self)
    }
    fn sign(self) -> Self {
        if self > 0.0 {
            1.0
        } else if self < 0.0 {
            -1.0
        } else {
            self // keeps 0 and NaN
        }
    }
    /// NaN in either operand gives NaN, unlike `f64::min`: nothing is hidden.
    fn min(self, other: Self) -> Self {
        if self.is_nan() || self < other { self } else { other }
    }
    fn max(self, other: Self) -> Self {
        if self.is_nan() || self > other { self } else { other }
    }
    fn select(cond: Self, a: Self, b: Self) -> Self {
        if cond >= 0.0 { a } else { b }
    }
    fn spline(self, table: &Spline, order: u8) -> Self {
        table.eval(self, order)
    }
    fn field(point: [Self; 3], field: &Arc<dyn Field>, part: usize) -> Self {
        field_value(&**field, point, part)
    }
    fn field_parts(point: [Self; 3], field: &Arc<dyn Field>, order: usize, out: &mut [Self]) {
        field.eval(point, order, out);
    }
    fn sin_cos(self) -> (Self, Self) {
        f64::sin_cos(self)
    }
}
