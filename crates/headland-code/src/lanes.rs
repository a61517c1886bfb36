//! [`Lanes4`] and [`Lanes8`]: four or eight points in one SIMD register (or a few, where the machine has shorter ones).
//!
//! Arithmetic, comparisons and the square root are SIMD and correctly rounded, so each lane has the bits of `f64`. The
//! transcendental functions go lane by lane through `f64`: a vectorised sine would be faster and differ in the last
//! bit, and a run must not depend on how many points were evaluated together.

use std::ops::{Add, Div, Mul, Neg, Sub};
use std::sync::Arc;

use headland_expr::field::field_value;
use headland_expr::{FIELD_PARTS, Field, Scalar, Spline};
use wide::{f64x4, f64x8};

/// A scalar that holds [`WIDTH`](Lanes::WIDTH) points.
pub trait Lanes: Scalar {
    /// Number of points.
    const WIDTH: usize;
    /// The first `WIDTH` of `x`.
    ///
    /// # Panics
    /// If there are fewer.
    fn load(x: &[f64]) -> Self;
    /// Writes the first `WIDTH` of `y`.
    ///
    /// # Panics
    /// If there are fewer.
    fn store(self, y: &mut [f64]);
}

impl Lanes for f64 {
    const WIDTH: usize = 1;
    #[inline]
    fn load(x: &[f64]) -> Self {
        x[0]
    }
    #[inline]
    fn store(self, y: &mut [f64]) {
        y[0] = self;
    }
}

macro_rules! by_operator {
    ($Lanes:ident: $($Trait:ident $method:ident),*) => { $(
        impl $Trait for $Lanes {
            type Output = Self;
            #[inline]
            fn $method(self, other: Self) -> Self {
                Self(self.0.$method(other.0))
            }
        }
    )* };
}

macro_rules! lane_by_lane {
    ($($method:ident),*) => { $(
        #[inline]
        fn $method(self) -> Self {
            self.map(<f64 as Scalar>::$method)
        }
    )* };
}

macro_rules! lanes {
    ($(#[$doc:meta])* $Lanes:ident, $Simd:ident, $width:literal) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct $Lanes(pub $Simd);

        impl $Lanes {
            #[inline]
            fn map(self, f: impl Fn(f64) -> f64) -> Self {
                Self($Simd::new(self.0.to_array().map(f)))
            }
            #[inline]
            fn zip(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
                let (a, b) = (self.0.to_array(), other.0.to_array());
                Self($Simd::new(std::array::from_fn(|i| f(a[i], b[i]))))
            }
        }

        by_operator!($Lanes: Add add, Sub sub, Mul mul, Div div);

        impl Neg for $Lanes {
            type Output = Self;
            #[inline]
            fn neg(self) -> Self {
                Self(-self.0)
            }
        }

        impl Lanes for $Lanes {
            const WIDTH: usize = $width;
            #[inline]
            fn load(x: &[f64]) -> Self {
                Self($Simd::new(std::array::from_fn(|i| x[..$width][i])))
            }
            #[inline]
            fn store(self, y: &mut [f64]) {
                y[..$width].copy_from_slice(self.0.as_array());
            }
        }

        impl Scalar for $Lanes {
            #[inline]
            fn constant(x: f64) -> Self {
                Self($Simd::splat(x))
            }
            fn powi(self, n: i32) -> Self {
                self.map(|x| Scalar::powi(x, n))
            }
            fn pow(self, y: Self) -> Self {
                self.zip(y, <f64 as Scalar>::pow)
            }
            #[inline]
            fn sqrt(self) -> Self {
                Self(self.0.sqrt())
            }
            lane_by_lane!(exp, ln, sin, cos, tan, asin, acos, atan, sinh, cosh, tanh);
            fn atan2(self, x: Self) -> Self {
                self.zip(x, <f64 as Scalar>::atan2)
            }
            #[inline]
            fn abs(self) -> Self {
                Self(self.0.abs())
            }
            #[inline]
            fn sign(self) -> Self {
                let zero = $Simd::splat(0.0);
                let down = self.0.simd_lt(zero).select($Simd::splat(-1.0), self.0);
                Self(self.0.simd_gt(zero).select($Simd::splat(1.0), down))
            }
            #[inline]
            fn min(self, other: Self) -> Self {
                Self((self.0.is_nan() | self.0.simd_lt(other.0)).select(self.0, other.0))
            }
            #[inline]
            fn max(self, other: Self) -> Self {
                Self((self.0.is_nan() | self.0.simd_gt(other.0)).select(self.0, other.0))
            }
            #[inline]
            fn select(cond: Self, a: Self, b: Self) -> Self {
                Self(cond.0.simd_ge($Simd::splat(0.0)).select(a.0, b.0))
            }
            fn spline(self, table: &Spline, order: u8) -> Self {
                self.map(|x| table.eval(x, order))
            }
            fn field(point: [Self; 3], field: &Arc<dyn Field>, part: usize) -> Self {
                let [x, y, z] = point.map(|p| p.0.to_array());
                let value = |i: usize| field_value(&**field, [x[i], y[i], z[i]], part);
                Self($Simd::new(std::array::from_fn(value)))
            }
            fn field_parts(point: [Self; 3], field: &Arc<dyn Field>, order: usize, out: &mut [Self]) {
                let [x, y, z] = point.map(|p| p.0.to_array());
                let mut lanes = [[0.0; $width]; FIELD_PARTS[3]];
                let mut parts = [0.0; FIELD_PARTS[3]];
                for i in 0..$width {
                    field.eval([x[i], y[i], z[i]], order, &mut parts[..FIELD_PARTS[order]]);
                    lanes.iter_mut().zip(&parts).for_each(|(row, &part)| row[i] = part);
                }
                out.iter_mut().zip(lanes).for_each(|(out, row)| *out = Self($Simd::new(row)));
            }
            fn sin_cos(self) -> (Self, Self) {
                let both = self.0.to_array().map(f64::sin_cos);
                (Self($Simd::new(both.map(|p| p.0))), Self($Simd::new(both.map(|p| p.1))))
            }
        }
    };
}

lanes! {
    /// Four points.
    Lanes4, f64x4, 4
}
lanes! {
    /// Eight points.
    Lanes8, f64x8, 8
}

#[cfg(test)]
mod tests {
    use super::*;
    use headland_expr::ops::{OPS, apply};

    const SPECIAL: [f64; 12] =
        [0.0, -0.0, 1.0, -1.5, 0.3, -0.3, f64::INFINITY, f64::NEG_INFINITY, f64::NAN, 1e-310, -7.0, 1e300];

    fn same(a: f64, b: f64) -> bool {
        a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan())
    }

    fn store<L: Lanes>(y: L) -> Vec<f64> {
        let mut out = vec![0.0; L::WIDTH];
        y.store(&mut out);
        out
    }

    fn every_operator<L: Lanes>() {
        let n = SPECIAL.len();
        let pick =
            |i: usize, stride: usize| -> Vec<f64> { (0..L::WIDTH).map(|l| SPECIAL[(i / stride + l) % n]).collect() };
        for row in OPS {
            for i in 0..n * n * n {
                let (a, b, c) = (pick(i, 1), pick(i, n), pick(i, n * n));
                let y = store(apply(row.op, L::load(&a), L::load(&b), L::load(&c)));
                for l in 0..L::WIDTH {
                    let expected = apply(row.op, a[l], b[l], c[l]);
                    assert!(same(y[l], expected), "{}({}, {}, {}): {} {expected}", row.name, a[l], b[l], c[l], y[l]);
                }
            }
        }
    }

    fn powers_and_sin_cos<L: Lanes>() {
        for i in 0..SPECIAL.len() {
            let x: Vec<f64> = (0..L::WIDTH).map(|l| SPECIAL[(i + l) % SPECIAL.len()]).collect();
            let (sin, cos) = L::load(&x).sin_cos();
            for n in [-3, -1, 0, 1, 2, 5, 8, i32::MAX, i32::MIN] {
                let y = store(L::load(&x).powi(n));
                assert!(x.iter().zip(&y).all(|(&x, &y)| same(y, Scalar::powi(x, n))), "{x:?}^{n} = {y:?}");
            }
            for ((x, s), c) in x.iter().zip(store(sin)).zip(store(cos)) {
                assert!(same(s, x.sin()) && same(c, x.cos()), "{x}");
            }
        }
    }

    #[test]
    fn lanes_have_the_bits_of_f64() {
        every_operator::<Lanes4>();
        every_operator::<Lanes8>();
        powers_and_sin_cos::<Lanes4>();
        powers_and_sin_cos::<Lanes8>();
    }
}
