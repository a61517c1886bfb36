//! [`Interval`]: bounds of an expression over a box, by natural interval extension.

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::ops::{Add, Div, Mul, Neg, Sub};
use std::sync::Arc;

use crate::field::Field;
use crate::scalar::Scalar;
use crate::spline::Spline;

/// All numbers between two bounds; as a [`Scalar`], bounds of a function over a box.
///
/// ```text
/// x ∈ X, y ∈ Y  ⇒  x ∘ y ∈ X ∘ Y
/// ```
/// Results are widened by a few units in the last place, so the bounds hold as far as the library's functions err by
/// no more than that. They hold at points where every operation is defined: where an argument lies partly outside of a
/// domain (`√`, `ln`, `asin`, `acos`), the result bounds what is defined; where all of it does, or a divisor may be
/// zero, the result is the whole line. A quantity used twice is taken as two independent ones: bounds are seldom tight.
///
/// ```
/// use headland_expr::{Interval, Scalar};
///
/// let y = Interval::new(0.0, 1.0).sin() + Interval::constant(2.0);
/// assert!(y.contains(2.0) && y.contains(2.84) && !y.contains(2.85));
/// ```
///
/// # References
/// Moore, Kearfott, Cloud, *Introduction to Interval Analysis*, 2009, ch. 5.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Lower bound, perhaps −∞.
    pub lo: f64,
    /// Upper bound, perhaps +∞.
    pub hi: f64,
}

impl Interval {
    /// The whole line.
    pub const WHOLE: Self = Self { lo: f64::NEG_INFINITY, hi: f64::INFINITY };

    /// The numbers from `lo` to `hi`; a bound that is NaN is no bound.
    pub fn new(lo: f64, hi: f64) -> Self {
        Self { lo: if lo.is_nan() { f64::NEG_INFINITY } else { lo }, hi: if hi.is_nan() { f64::INFINITY } else { hi } }
    }

    /// True if `x` lies in it, bounds included.
    pub fn contains(self, x: f64) -> bool {
        self.lo <= x && x <= self.hi
    }

    /// `hi − lo`.
    pub fn width(self) -> f64 {
        self.hi - self.lo
    }

    /// The smallest interval that holds both.
    pub fn hull(self, other: Self) -> Self {
        Self::new(self.lo.min(other.lo), self.hi.max(other.hi))
    }

    /// What both have in common; `self` if rounding has left nothing.
    pub fn meet(self, other: Self) -> Self {
        let (lo, hi) = (self.lo.max(other.lo), self.hi.min(other.hi));
        if lo <= hi { Self { lo, hi } } else { self }
    }

    /// The largest absolute value in it.
    pub fn magnitude(self) -> f64 {
        self.lo.abs().max(self.hi.abs())
    }

    /// Widened by `ulps` units in the last place.
    fn outward(self, ulps: f64) -> Self {
        let margin = |x: f64| {
            if x.is_finite() { ulps * (x.abs() * f64::EPSILON + f64::from_bits(1)) } else { 0.0 }
        };
        Self::new(self.lo - margin(self.lo), self.hi + margin(self.hi))
    }

    /// Kept between the given bounds, which the exact result cannot leave.
    fn clamped(self, lo: f64, hi: f64) -> Self {
        Self { lo: self.lo.clamp(lo, hi), hi: self.hi.clamp(lo, hi) }
    }

    /// Image under a growing function whose range is `[lo, hi]`.
    fn growing(self, f: impl Fn(f64) -> f64, lo: f64, hi: f64) -> Self {
        Self::new(f(self.lo), f(self.hi)).outward(LIBRARY).clamped(lo, hi)
    }

    /// The part inside of a domain; `None` if there is none.
    fn within(self, lo: f64, hi: f64) -> Option<Self> {
        (self.lo <= hi && self.hi >= lo).then(|| self.clamped(lo, hi))
    }

    fn corners(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        let v = [f(self.lo, other.lo), f(self.lo, other.hi), f(self.hi, other.lo), f(self.hi, other.hi)];
        if v.iter().any(|x| x.is_nan()) {
            return Self::WHOLE;
        }
        Self {
            lo: v.iter().copied().fold(f64::INFINITY, f64::min),
            hi: v.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        }
    }

    /// Whether some `phase + k · period` may lie in it (rounding counted against).
    fn meets_lattice(self, phase: f64, period: f64) -> bool {
        let margin = 8.0 * f64::EPSILON * (1.0 + self.magnitude());
        let first = ((self.lo - margin - phase) / period).ceil();
        first * period + phase <= self.hi + margin
    }
}

/// Units in the last place by which results of the mathematical library are widened.
const LIBRARY: f64 = 4.0;
/// The same for one rounded arithmetic operation.
const ARITHMETIC: f64 = 1.0;
/// Arguments of periodic functions beyond which nothing is said.
const LARGE_ANGLE: f64 = 1e12;

/// `0 · ∞ = 0`: an infinite bound stands for numbers without bound, not for a value.
fn times(a: f64, b: f64) -> f64 {
    if a == 0.0 || b == 0.0 { 0.0 } else { a * b }
}

impl Add for Interval {
    type Output = Self;
    fn add(self, b: Self) -> Self {
        Self::new(self.lo + b.lo, self.hi + b.hi).outward(ARITHMETIC)
    }
}

impl Sub for Interval {
    type Output = Self;
    fn sub(self, b: Self) -> Self {
        Self::new(self.lo - b.hi, self.hi - b.lo).outward(ARITHMETIC)
    }
}

impl Mul for Interval {
    type Output = Self;
    fn mul(self, b: Self) -> Self {
        let zero = Self::constant(0.0);
        if self == zero || b == zero {
            return zero;
        }
        self.corners(b, times).outward(ARITHMETIC)
    }
}

impl Div for Interval {
    type Output = Self;
    fn div(self, b: Self) -> Self {
        if b.contains(0.0) {
            return Self::WHOLE;
        }
        self.corners(b, |x, y| if y.is_infinite() { 0.0 } else { x / y }).outward(ARITHMETIC)
    }
}

impl Neg for Interval {
    type Output = Self;
    fn neg(self) -> Self {
        Self { lo: -self.hi, hi: -self.lo }
    }
}

impl Scalar for Interval {
    fn constant(x: f64) -> Self {
        Self::new(x, x)
    }
    fn powi(self, n: i32) -> Self {
        if n == 0 {
            return Self::constant(1.0);
        }
        if n < 0 {
            // The exponent of the smallest integer has no positive twin.
            return n.checked_neg().map_or(Self::WHOLE, |m| Self::constant(1.0) / self.powi(m));
        }
        let (lo, hi) = (Scalar::powi(self.lo, n), Scalar::powi(self.hi, n));
        let ends = Self::new(lo.min(hi), lo.max(hi)).outward(f64::from(n) + ARITHMETIC);
        match n % 2 {
            0 if self.contains(0.0) => Self { lo: 0.0, hi: ends.hi },
            0 => ends.clamped(0.0, f64::INFINITY),
            _ => ends,
        }
    }
    fn pow(self, y: Self) -> Self {
        if self.lo < 0.0 {
            return Self::WHOLE;
        }
        // Monotone in either argument with the other held, so its extremes are at corners.
        self.corners(y, f64::powf).outward(LIBRARY).clamped(0.0, f64::INFINITY)
    }
    fn sqrt(self) -> Self {
        self.within(0.0, f64::INFINITY).map_or(Self::WHOLE, |x| x.growing(f64::sqrt, 0.0, f64::INFINITY))
    }
    fn exp(self) -> Self {
        self.growing(f64::exp, 0.0, f64::INFINITY)
    }
    fn ln(self) -> Self {
        self.within(0.0, f64::INFINITY).map_or(Self::WHOLE, |x| x.growing(f64::ln, f64::NEG_INFINITY, f64::INFINITY))
    }
    fn sin(self) -> Self {
        if self.magnitude() > LARGE_ANGLE || self.width() >= TAU {
            return Self::new(-1.0, 1.0);
        }
        let (a, b) = (self.lo.sin(), self.hi.sin());
        let ends = Self::new(a.min(b), a.max(b)).outward(LIBRARY).clamped(-1.0, 1.0);
        Self {
            lo: if self.meets_lattice(-FRAC_PI_2, TAU) { -1.0 } else { ends.lo },
            hi: if self.meets_lattice(FRAC_PI_2, TAU) { 1.0 } else { ends.hi },
        }
    }
    fn cos(self) -> Self {
        if self.magnitude() > LARGE_ANGLE || self.width() >= TAU {
            return Self::new(-1.0, 1.0);
        }
        let (a, b) = (self.lo.cos(), self.hi.cos());
        let ends = Self::new(a.min(b), a.max(b)).outward(LIBRARY).clamped(-1.0, 1.0);
        Self {
            lo: if self.meets_lattice(PI, TAU) { -1.0 } else { ends.lo },
            hi: if self.meets_lattice(0.0, TAU) { 1.0 } else { ends.hi },
        }
    }
    fn tan(self) -> Self {
        if self.magnitude() > LARGE_ANGLE || self.width() >= PI || self.meets_lattice(FRAC_PI_2, PI) {
            return Self::WHOLE;
        }
        self.growing(f64::tan, f64::NEG_INFINITY, f64::INFINITY)
    }
    fn asin(self) -> Self {
        self.within(-1.0, 1.0).map_or(Self::WHOLE, |x| x.growing(f64::asin, -FRAC_PI_2, FRAC_PI_2))
    }
    fn acos(self) -> Self {
        self.within(-1.0, 1.0).map_or(Self::WHOLE, |x| (-x).growing(|x| (-x).acos(), 0.0, PI))
    }
    fn atan(self) -> Self {
        self.growing(f64::atan, -FRAC_PI_2, FRAC_PI_2)
    }
    fn atan2(self, x: Self) -> Self {
        // The angle jumps across the negative half axis and is anything at the origin.
        if self.contains(0.0) && x.lo <= 0.0 {
            return Self::new(-PI, PI);
        }
        self.corners(x, f64::atan2).outward(LIBRARY).clamped(-PI, PI)
    }
    fn sinh(self) -> Self {
        self.growing(f64::sinh, f64::NEG_INFINITY, f64::INFINITY)
    }
    fn cosh(self) -> Self {
        let (a, b) = (self.lo.cosh(), self.hi.cosh());
        let lo = if self.contains(0.0) { 1.0 } else { a.min(b) };
        Self::new(lo, a.max(b)).outward(LIBRARY).clamped(1.0, f64::INFINITY)
    }
    fn tanh(self) -> Self {
        self.growing(f64::tanh, -1.0, 1.0)
    }
    fn abs(self) -> Self {
        let (a, b) = (self.lo.abs(), self.hi.abs());
        Self { lo: if self.contains(0.0) { 0.0 } else { a.min(b) }, hi: a.max(b) }
    }
    fn sign(self) -> Self {
        Self::new(Scalar::sign(self.lo), Scalar::sign(self.hi))
    }
    fn min(self, other: Self) -> Self {
        Self { lo: self.lo.min(other.lo), hi: self.hi.min(other.hi) }
    }
    fn max(self, other: Self) -> Self {
        Self { lo: self.lo.max(other.lo), hi: self.hi.max(other.hi) }
    }
    fn select(cond: Self, a: Self, b: Self) -> Self {
        if cond.lo >= 0.0 {
            a
        } else if cond.hi < 0.0 {
            b
        } else {
            a.hull(b)
        }
    }
    /// The exact range of the cubic pieces that the interval meets.
    fn spline(self, table: &Spline, order: u8) -> Self {
        let (knots, pieces) = (table.knots(), table.coefficients());
        let piece_of = |x: f64| knots.partition_point(|&knot| knot <= x);
        let mut range: Option<Self> = None;
        for i in piece_of(self.lo)..=piece_of(self.hi) {
            let [c0, c1, c2, c3] = pieces[i.max(1) - 1];
            let start = knots[i.max(1) - 1];
            let cubic = if i == 0 { [c0, c1, 0.0, 0.0] } else { [c0, c1, c2, c3] };
            let from = if i == 0 { self.lo } else { self.lo.max(start) } - start;
            let to = knots.get(i).map_or(self.hi, |&end| end.min(self.hi)) - start;
            let piece = polynomial_range(derived(cubic, order), from, to);
            range = Some(range.map_or(piece, |r| r.hull(piece)));
        }
        range.unwrap_or(Self::WHOLE)
    }
    /// The whole line: a field says nothing about what lies between two points.
    fn field(point: [Self; 3], field: &Arc<dyn Field>, part: usize) -> Self {
        field.range(point, part)
    }
}

/// Coefficients of the `order`-th derivative of a cubic.
fn derived(c: [f64; 4], order: u8) -> [f64; 4] {
    (0..order.min(4)).fold(c, |[_, c1, c2, c3], _| [c1, 2.0 * c2, 3.0 * c3, 0.0])
}

/// Range of a cubic between `from` and `to`: its ends and where its slope vanishes.
fn polynomial_range(c: [f64; 4], from: f64, to: f64) -> Interval {
    let value = |d: f64| {
        let terms = [c[0], times(c[1], d), times(c[2], d * d), times(c[3], d * d * d)];
        let error = 4.0 * f64::EPSILON * terms.iter().map(|x| x.abs()).sum::<f64>();
        let sum: f64 = terms.iter().sum();
        Interval::new(sum - error, sum + error)
    };
    let mut range = value(from).hull(value(to));
    let (a, b) = (3.0 * c[3], c[2]); // slope a d² + 2 b d + c₁
    let discriminant = b * b - a * c[1];
    if discriminant >= 0.0 {
        // The root that does not cancel, and the other by their product.
        let q = -(b + discriminant.sqrt().copysign(b));
        for d in [q / a, c[1] / q] {
            if d > from && d < to {
                range = range.hull(value(d));
            }
        }
    }
    range
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(x: Interval, lo: f64, hi: f64) {
        assert!((x.lo - lo).abs() < 1e-12 && (x.hi - hi).abs() < 1e-12, "{x:?} is not [{lo}, {hi}]");
    }

    #[test]
    fn periodic_functions_know_their_extremes() {
        close(Interval::new(0.0, 2.0).sin(), 0.0, 1.0);
        close(Interval::new(2.0, 5.0).sin(), -1.0, 2f64.sin());
        close(Interval::new(100.0, 100.1).cos(), 100f64.cos(), 100.1f64.cos());
        close(Interval::new(-0.1, 0.2).cos(), 0.2f64.cos(), 1.0);
        close(Interval::new(-1.0, 1.0).tan(), -1f64.tan(), 1f64.tan());
        assert_eq!(Interval::new(1.0, 2.0).tan(), Interval::WHOLE);
    }

    #[test]
    fn powers_and_domains() {
        close(Interval::new(-1.0, 2.0).powi(2), 0.0, 4.0);
        close(Interval::new(-1.0, 2.0).powi(3), -1.0, 8.0);
        close(Interval::new(1.0, 2.0).powi(-2), 0.25, 1.0);
        assert_eq!(Interval::new(-1.0, 2.0).powi(-1), Interval::WHOLE);
        close(Interval::new(-1.0, 4.0).sqrt(), 0.0, 2.0);
        assert_eq!(Interval::new(-2.0, -1.0).sqrt(), Interval::WHOLE);
        assert_eq!(Interval::new(-2.0, 1.0).ln().lo, f64::NEG_INFINITY);
        close(Interval::new(0.5, 2.0).acos(), 0.0, 0.5f64.acos());
    }

    #[test]
    fn spline_range_is_exact() {
        let table = Spline::new("bump", &[0.0, 1.0, 2.0], &[0.0, 1.0, 0.0]).unwrap();
        let sampled = (0..=2000).map(|i| table.eval(f64::from(i) * 1e-3, 0)).fold(0.0, f64::max);
        close(Interval::new(0.0, 2.0).spline(&table, 0), 0.0, sampled);
        close(Interval::new(0.5, 0.5).spline(&table, 1), table.eval(0.5, 1), table.eval(0.5, 1));
        assert!(Interval::new(0.5, 1.5).spline(&table, 3).contains(table.eval(0.9, 3)));
        assert_eq!(Interval::WHOLE.spline(&table, 0).lo, f64::NEG_INFINITY);
    }
}
