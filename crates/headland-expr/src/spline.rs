//! [`Spline`]: table interpolation by a natural cubic spline, twice continuously differentiable everywhere.

use std::sync::Arc;

/// A natural cubic spline through given points, continued linearly outside of them (so it stays C²).
///
/// ```text
/// s(x) = c₀ + c₁ d + c₂ d² + c₃ d³,  d = x − x_i   on [x_i, x_(i+1)],   s″ = 0 at both ends
/// ```
/// Error `O(h⁴)` inside, `O(h²)` near an end where the data's second derivative is not zero.
///
/// # References
/// de Boor, *A Practical Guide to Splines*, 1978, ch. IV.
#[derive(Clone, Debug, PartialEq)]
pub struct Spline {
    name: Arc<str>,
    x: Arc<[f64]>,
    /// `c₀ … c₃` of each interval; one row more for the line beyond the last point.
    c: Arc<[[f64; 4]]>,
}

/// Why a table cannot be interpolated.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SplineError {
    /// The columns do not match.
    #[error("table `{name}` has {x} abscissas but {y} ordinates")]
    Lengths {
        /// Name of the table.
        name: String,
        /// Number of abscissas.
        x: usize,
        /// Number of ordinates.
        y: usize,
    },
    /// Fewer than two points.
    #[error("table `{name}` has {found} point(s); at least 2 are needed")]
    TooShort {
        /// Name of the table.
        name: String,
        /// Number of points.
        found: usize,
    },
    /// Abscissas must grow.
    #[error("table `{name}`: abscissas must grow, but x[{index}] = {x} does not exceed x[{}] = {before}", index - 1)]
    NotGrowing {
        /// Name of the table.
        name: String,
        /// Position, counted from 1.
        index: usize,
        /// The abscissa.
        x: f64,
        /// The one before.
        before: f64,
    },
    /// A value is NaN or infinite.
    #[error("table `{name}`: point {index} is not finite")]
    NotFinite {
        /// Name of the table.
        name: String,
        /// Position, counted from 1.
        index: usize,
    },
}

impl Spline {
    /// The spline through `(x_i, y_i)`; at least two points, `x` growing.
    ///
    /// # Errors
    /// [`SplineError`] says which point is wrong.
    pub fn new(name: &str, x: &[f64], y: &[f64]) -> Result<Self, SplineError> {
        let n = x.len();
        let name_owned = || name.to_string();
        if y.len() != n {
            return Err(SplineError::Lengths { name: name_owned(), x: n, y: y.len() });
        }
        if n < 2 {
            return Err(SplineError::TooShort { name: name_owned(), found: n });
        }
        for i in 0..n {
            if !(x[i].is_finite() && y[i].is_finite()) {
                return Err(SplineError::NotFinite { name: name_owned(), index: i + 1 });
            }
            if i > 0 && x[i] <= x[i - 1] {
                return Err(SplineError::NotGrowing { name: name_owned(), index: i + 1, x: x[i], before: x[i - 1] });
            }
        }
        let curvature = second_derivatives(x, y);
        let mut c: Vec<[f64; 4]> = (0..n - 1)
            .map(|i| {
                let h = x[i + 1] - x[i];
                let (m0, m1) = (curvature[i], curvature[i + 1]);
                [y[i], (y[i + 1] - y[i]) / h - h * (2.0 * m0 + m1) / 6.0, 0.5 * m0, (m1 - m0) / (6.0 * h)]
            })
            .collect();
        let h = x[n - 1] - x[n - 2];
        let [_, c1, c2, c3] = c[n - 2];
        c.push([y[n - 1], c1 + h * (2.0 * c2 + 3.0 * h * c3), 0.0, 0.0]);
        Ok(Self { name: name.into(), x: x.into(), c: c.into() })
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The abscissas: where the third derivative jumps.
    pub fn knots(&self) -> &[f64] {
        &self.x
    }

    /// `c₀ … c₃` from each abscissa on, the line beyond the last one included; before the first, `c₀ + c₁ d` of it.
    pub fn coefficients(&self) -> &[[f64; 4]] {
        &self.c
    }

    /// The `order`-th derivative at `x`; NaN gives NaN.
    pub fn eval(&self, x: f64, order: u8) -> f64 {
        let i = self.x.partition_point(|&knot| knot <= x);
        let (start, [c0, c1, c2, c3]) = if i == 0 {
            let [c0, c1, ..] = self.c[0];
            (self.x[0], [c0, c1, 0.0, 0.0])
        } else {
            (self.x[i - 1], self.c[i - 1])
        };
        let d = x - start;
        match order {
            0 => c0 + d * (c1 + d * (c2 + d * c3)),
            1 => c1 + d * (2.0 * c2 + d * 3.0 * c3),
            2 => 2.0 * c2 + d * 6.0 * c3,
            3 => 6.0 * c3 + 0.0 * d,
            _ => 0.0 * d,
        }
    }
}

/// Second derivatives at the points of the natural spline: a tridiagonal system, by elimination without pivoting
/// (it is diagonally dominant).
fn second_derivatives(x: &[f64], y: &[f64]) -> Vec<f64> {
    let n = x.len();
    let mut m = vec![0.0; n];
    let mut upper = vec![0.0; n];
    for i in 1..n - 1 {
        let (h0, h1) = (x[i] - x[i - 1], x[i + 1] - x[i]);
        let rhs = 6.0 * ((y[i + 1] - y[i]) / h1 - (y[i] - y[i - 1]) / h0);
        let pivot = 2.0 * (h0 + h1) - h0 * upper[i - 1];
        upper[i] = h1 / pivot;
        m[i] = (rhs - h0 * m[i - 1]) / pivot;
    }
    for i in (1..n - 1).rev() {
        m[i] -= upper[i] * m[i + 1];
    }
    m
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn natural_spline_is_exact_where_theory_says_so() {
        let line = Spline::new("line", &[0.0, 1.0, 4.0], &[1.0, 3.0, 9.0]).unwrap();
        for x in [-2.0, 0.0, 0.3, 1.0, 2.5, 4.0, 7.0] {
            assert_relative_eq!(line.eval(x, 0), 1.0 + 2.0 * x, epsilon = 1e-14);
            assert_relative_eq!(line.eval(x, 1), 2.0, epsilon = 1e-14);
        }
    }

    #[test]
    fn is_c2_and_converges_at_order_four_inside() {
        let error = |n: usize| {
            let x: Vec<f64> = (0..=n).map(|i| std::f64::consts::PI * i as f64 / n as f64).collect();
            let y: Vec<f64> = x.iter().map(|x| x.sin()).collect();
            let s = Spline::new("sine", &x, &y).unwrap();
            for &k in &x {
                let e = 1e-9;
                for order in 0..3 {
                    assert_relative_eq!(s.eval(k - e, order), s.eval(k + e, order), epsilon = 1e-7);
                }
            }
            (0..1000).map(|i| 3.1 * f64::from(i) / 1000.0).map(|t| (s.eval(t, 0) - t.sin()).abs()).fold(0.0, f64::max)
        };
        let order = (error(20) / error(40)).log2();
        assert!((order - 4.0).abs() < 0.2, "order {order}");
    }

    #[test]
    fn wrong_tables_are_refused() {
        assert!(matches!(Spline::new("a", &[0.0], &[1.0]), Err(SplineError::TooShort { .. })));
        assert!(matches!(Spline::new("a", &[0.0, 0.0], &[1.0, 2.0]), Err(SplineError::NotGrowing { index: 2, .. })));
        assert!(matches!(Spline::new("a", &[0.0, 1.0], &[1.0]), Err(SplineError::Lengths { .. })));
        assert!(matches!(Spline::new("a", &[0.0, f64::NAN], &[1.0, 1.0]), Err(SplineError::NotFinite { .. })));
    }
}
