//! [`Dual`]: a value with a derivative, over any scalar.

use std::ops::{Add, Div, Mul, Neg, Sub};
use std::sync::Arc;

use crate::field::{Field, field_derived};
use crate::ops::{Op, apply, partials};
use crate::scalar::Scalar;
use crate::spline::Spline;

/// A value and its derivative in one direction; exact derivatives of generic code without symbols.
///
/// Its rules are the operator table's, so it is an independent check of what a graph *does* with them, not of the rules.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<S> {
    /// Value.
    pub value: S,
    /// Derivative.
    pub dot: S,
}

impl<S: Scalar> Dual<S> {
    /// A variable with the given derivative.
    pub fn new(value: S, dot: S) -> Self {
        Self { value, dot }
    }

    fn lift(op: Op, a: Self, b: Self, c: Self) -> Self {
        let value = apply(op, a.value, b.value, c.value);
        let mut dot = S::constant(0.0);
        for (p, x) in partials(op, a.value, b.value, c.value, value).into_iter().zip([a, b, c]) {
            if let Some(p) = p {
                dot = dot + p * x.dot;
            }
        }
        Self { value, dot }
    }

    fn unary(self, op: Op) -> Self {
        let zero = Self::constant(0.0);
        Self::lift(op, self, zero, zero)
    }

    fn binary(self, op: Op, other: Self) -> Self {
        Self::lift(op, self, other, Self::constant(0.0))
    }
}

macro_rules! operator {
    ($Trait:ident, $method:ident, $Op:ident) => {
        impl<S: Scalar> $Trait for Dual<S> {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                self.binary(Op::$Op, other)
            }
        }
    };
}
operator!(Add, add, Add);
operator!(Sub, sub, Sub);
operator!(Mul, mul, Mul);
operator!(Div, div, Div);

impl<S: Scalar> Neg for Dual<S> {
    type Output = Self;
    fn neg(self) -> Self {
        self.unary(Op::Neg)
    }
}

macro_rules! forward {
    ($($method:ident $Op:ident),*) => { $(fn $method(self) -> Self { self.unary(Op::$Op) })* };
}

impl<S: Scalar> Scalar for Dual<S> {
    fn constant(x: f64) -> Self {
        Self { value: S::constant(x), dot: S::constant(0.0) }
    }
    fn powi(self, n: i32) -> Self {
        let slope = S::constant(f64::from(n)) * self.value.powi(n - 1);
        Self { value: self.value.powi(n), dot: if n == 0 { S::constant(0.0) } else { slope * self.dot } }
    }
    fn pow(self, y: Self) -> Self {
        self.binary(Op::Pow, y)
    }
    forward!(sqrt Sqrt, exp Exp, ln Ln, sin Sin, cos Cos, tan Tan, asin Asin, acos Acos, atan Atan,
        sinh Sinh, cosh Cosh, tanh Tanh, abs Abs, sign Sign);
    fn atan2(self, x: Self) -> Self {
        self.binary(Op::Atan2, x)
    }
    fn min(self, other: Self) -> Self {
        self.binary(Op::Min, other)
    }
    fn max(self, other: Self) -> Self {
        self.binary(Op::Max, other)
    }
    fn select(cond: Self, a: Self, b: Self) -> Self {
        // Not by the table: 0 · NaN of the branch not taken would poison the derivative.
        Self { value: S::select(cond.value, a.value, b.value), dot: S::select(cond.value, a.dot, b.dot) }
    }
    fn spline(self, table: &Spline, order: u8) -> Self {
        Self { value: self.value.spline(table, order), dot: self.value.spline(table, order + 1) * self.dot }
    }
    fn field(point: [Self; 3], field: &Arc<dyn Field>, part: usize) -> Self {
        let at = point.map(|x| x.value);
        let dots = point.iter().take(field.variables()).enumerate();
        let dot = dots.map(|(axis, x)| S::field(at, field, field_derived(part, axis)) * x.dot);
        Self { value: S::field(at, field, part), dot: dot.reduce(Add::add).unwrap_or(S::constant(0.0)) }
    }
}
