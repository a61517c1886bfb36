//! [`Tangent`]: a number with its derivatives in as many directions as there are lanes.

use std::ops::{Add, Div, Mul, Neg, Sub};
use std::sync::Arc;

use headland_code::Lanes;
use headland_expr::field::field_slopes;
use headland_expr::ops::{Op, apply, partials};
use headland_expr::{Field, Scalar, Spline};

/// A value and its derivatives in [`Lanes::WIDTH`] directions. The value is computed once for all of them, which
/// `Dual<L>` would do in every lane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tangent<L> {
    /// Value.
    pub value: f64,
    /// Derivatives.
    pub dot: L,
}

impl<L: Lanes> Tangent<L> {
    /// A variable with the given derivatives.
    #[inline]
    pub fn new(value: f64, dot: L) -> Self {
        Self { value, dot }
    }

    #[inline]
    fn scaled(value: f64, slope: f64, dot: L) -> Self {
        Self { value, dot: L::constant(slope) * dot }
    }

    /// By the table of operators: for what is not worth writing out.
    fn lift(op: Op, [a, b]: [Self; 2]) -> Self {
        let value = apply(op, a.value, b.value, 0.0);
        let mut dot = L::constant(0.0);
        for (p, x) in partials(op, a.value, b.value, 0.0, value).into_iter().zip([a, b]) {
            if let Some(p) = p {
                dot = dot + L::constant(p) * x.dot;
            }
        }
        Self { value, dot }
    }
}

impl<L: Lanes> Add for Tangent<L> {
    type Output = Self;
    #[inline]
    fn add(self, b: Self) -> Self {
        Self { value: self.value + b.value, dot: self.dot + b.dot }
    }
}

impl<L: Lanes> Sub for Tangent<L> {
    type Output = Self;
    #[inline]
    fn sub(self, b: Self) -> Self {
        Self { value: self.value - b.value, dot: self.dot - b.dot }
    }
}

impl<L: Lanes> Mul for Tangent<L> {
    type Output = Self;
    #[inline]
    fn mul(self, b: Self) -> Self {
        let dot = self.dot * L::constant(b.value) + L::constant(self.value) * b.dot;
        Self { value: self.value * b.value, dot }
    }
}

impl<L: Lanes> Div for Tangent<L> {
    type Output = Self;
    #[inline]
    fn div(self, b: Self) -> Self {
        let (value, inverse) = (self.value / b.value, 1.0 / b.value);
        Self { value, dot: (self.dot - L::constant(value) * b.dot) * L::constant(inverse) }
    }
}

impl<L: Lanes> Neg for Tangent<L> {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self { value: -self.value, dot: -self.dot }
    }
}

macro_rules! by_table {
    ($($method:ident $Op:ident),*) => { $(fn $method(self) -> Self { Self::lift(Op::$Op, [self, self]) })* };
}

macro_rules! by_table_of_two {
    ($($method:ident $Op:ident),*) => { $(fn $method(self, b: Self) -> Self { Self::lift(Op::$Op, [self, b]) })* };
}

impl<L: Lanes> Scalar for Tangent<L> {
    #[inline]
    fn constant(x: f64) -> Self {
        Self { value: x, dot: L::constant(0.0) }
    }
    fn powi(self, n: i32) -> Self {
        let slope = if n == 0 { 0.0 } else { f64::from(n) * Scalar::powi(self.value, n - 1) };
        Self::scaled(Scalar::powi(self.value, n), slope, self.dot)
    }
    #[inline]
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = self.value.sin_cos();
        (Self::scaled(sin, cos, self.dot), Self::scaled(cos, -sin, self.dot))
    }
    by_table!(sqrt Sqrt, exp Exp, ln Ln, sin Sin, cos Cos, tan Tan, asin Asin, acos Acos, atan Atan, sinh Sinh,
        cosh Cosh, tanh Tanh, abs Abs, sign Sign);
    by_table_of_two!(pow Pow, atan2 Atan2, min Min, max Max);
    fn select(cond: Self, a: Self, b: Self) -> Self {
        if cond.value >= 0.0 { a } else { b }
    }
    fn spline(self, table: &Spline, order: u8) -> Self {
        Self::scaled(self.value.spline(table, order), self.value.spline(table, order + 1), self.dot)
    }
    fn field(point: [Self; 3], field: &Arc<dyn Field>, part: usize) -> Self {
        let (value, slopes) = field_slopes(&**field, point.map(|x| x.value), part);
        let dots = point.iter().zip(slopes).map(|(x, slope)| L::constant(slope) * x.dot);
        Self { value, dot: dots.reduce(Add::add).unwrap_or(L::constant(0.0)) }
    }
}

#[cfg(test)]
mod tests {
    use headland_expr::ops::OPS;
    use headland_expr::{Dual, FIELD_PARTS, Wave};

    use super::*;

    #[test]
    fn every_operator_has_the_derivative_of_dual_numbers() {
        for row in OPS {
            for sample in row.samples {
                for direction in 0..3 {
                    let seed = |i: usize| f64::from(u8::from(i == direction)) * 0.7;
                    let duals: [_; 3] = std::array::from_fn(|i| Dual::new(sample[i], seed(i)));
                    let tangents: [_; 3] = std::array::from_fn(|i| Tangent::<f64>::new(sample[i], seed(i)));
                    let (d, t) = (
                        apply(row.op, duals[0], duals[1], duals[2]),
                        apply(row.op, tangents[0], tangents[1], tangents[2]),
                    );
                    assert_eq!(d.value, t.value, "{}", row.name);
                    assert!((d.dot - t.dot).abs() <= 1e-14 * (1.0 + d.dot.abs()), "{}: {} {}", row.name, d.dot, t.dot);
                }
            }
        }
        let x = Tangent::<f64>::new(1.3, 0.7);
        let (sin, cos) = x.sin_cos();
        assert_eq!((sin.dot, cos.dot), (0.7 * 1.3f64.cos(), -0.7 * 1.3f64.sin()));
        assert_eq!((x.powi(3).dot, x.powi(0).dot), (0.7 * (3.0 * (1.3 * 1.3)), 0.0));
    }

    #[test]
    fn fields_have_the_derivatives_of_dual_numbers() {
        let wave = Wave { name: "wave".into(), rate: [0.7, -1.1, 0.4], phase: [0.1, 1.3, -0.6] };
        let field: Arc<dyn Field> = Arc::new(wave);
        let (at, along) = ([0.3, -0.8, 1.1], [0.2, 0.5, -0.9]);
        for part in 0..FIELD_PARTS[2] {
            let d = Dual::field(std::array::from_fn(|i| Dual::new(at[i], along[i])), &field, part);
            let t = Tangent::<f64>::field(std::array::from_fn(|i| Tangent::new(at[i], along[i])), &field, part);
            assert_eq!((d.value, d.dot), (t.value, t.dot), "part {part}");
        }
    }
}
