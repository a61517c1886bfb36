//! Small functions by which laws stay finite, with finite derivatives, at zero slip, at standstill and without load.
//!
//! A [`Scalar`] has no `<` and evaluates both branches of a `select`: what would divide by zero is kept away from zero
//! before the operation.

use headland_expr::Scalar;

/// The constant `x`.
#[inline]
pub(crate) fn num<S: Scalar>(x: f64) -> S {
    S::constant(x)
}

/// `√(x² + y²)`, not below 1e-20, so that its derivative is finite; at the origin the derivative is zero.
#[inline]
pub fn length<S: Scalar>(x: S, y: S) -> S {
    (x * x + y * y).max(num(1e-40)).sqrt()
}

/// `x` between two bounds.
#[inline]
pub fn clamp<S: Scalar>(x: S, low: S, high: S) -> S {
    x.max(low).min(high)
}

/// `√(x² + ε²)`: the absolute value, rounded off over `ε > 0`.
#[inline]
pub fn smooth_abs<S: Scalar>(x: S, epsilon: S) -> S {
    (x * x + epsilon * epsilon).sqrt()
}

/// `x / √(x² + ε²)`: the sign, rounded off over `ε > 0`.
#[inline]
pub fn smooth_sign<S: Scalar>(x: S, epsilon: S) -> S {
    x / smooth_abs(x, epsilon)
}

/// A step from 0 to 1 for `x` from 0 to 1, once continuously differentiable: `3 x² − 2 x³` between.
#[inline]
pub fn smooth_step<S: Scalar>(x: S) -> S {
    let u = clamp(x, num(0.0), num(1.0));
    u * u * (num::<S>(3.0) - num::<S>(2.0) * u)
}

/// `xᵖ` for `x ≥ 0`, taken at 1e-12 below that: a power has no derivative at zero that every exponent shares.
#[inline]
pub fn power<S: Scalar>(x: S, exponent: S) -> S {
    x.max(num(1e-12)).pow(exponent)
}

#[cfg(test)]
mod tests {
    use super::*;
    use headland_expr::Dual;

    #[test]
    fn derivatives_are_finite_where_they_would_not_be() {
        let zero = Dual::new(0.0, 1.0);
        let epsilon = Dual::constant(0.1);
        for y in [
            length(zero, zero),
            smooth_abs(zero, epsilon),
            smooth_sign(zero, epsilon),
            smooth_step(zero),
            power(zero, Dual::constant(0.4)),
            clamp(zero, zero, zero),
        ] {
            assert!(y.value.is_finite() && y.dot.is_finite(), "{y:?}");
        }
        assert_eq!(length(3.0, 4.0), 5.0);
        assert_eq!(smooth_sign(zero, epsilon).dot, 10.0);
    }
}
