//! [`Dimension`]: powers of kilogram, metre and second, with unknowns that unification finds.
//!
//! A literal without a unit takes the dimension that its place needs: it starts as an unknown, and every sum,
//! comparison and function argument is one linear equation between exponents. Only declared units can conflict.

use std::fmt::Write;
use std::ops::{Add, Neg, Sub};

/// A rational exponent.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Ratio {
    n: i64,
    d: i64,
}

impl Ratio {
    /// Zero.
    pub const ZERO: Self = Self { n: 0, d: 1 };
    /// One.
    pub const ONE: Self = Self { n: 1, d: 1 };

    /// `n/d` in lowest terms.
    ///
    /// # Panics
    /// If `d` is zero.
    pub fn new(n: i64, d: i64) -> Self {
        assert!(d != 0, "denominator of an exponent");
        let (mut a, mut b) = (n.unsigned_abs(), d.unsigned_abs());
        while b != 0 {
            (a, b) = (b, a % b);
        }
        let g = (a.max(1) as i64) * d.signum();
        Self { n: n / g, d: d / g }
    }

    /// The exponent `x`, if it is a fraction with a small denominator.
    pub fn from_f64(x: f64) -> Option<Self> {
        (1..=12_i64).find_map(|d| {
            let n = x * d as f64;
            (n.abs() < 1e6 && (n - n.round()).abs() < 1e-12).then(|| Self::new(n.round() as i64, d))
        })
    }

    fn is_zero(self) -> bool {
        self.n == 0
    }

    /// Exponents stay far from overflow: a model that reaches such powers is refused elsewhere, here they saturate.
    fn times(self, other: Self) -> Self {
        let clamp = |x: i64| x.clamp(-(1 << 30), 1 << 30);
        Self::new(clamp(self.n) * clamp(other.n), clamp(self.d) * clamp(other.d))
    }
    fn plus(self, other: Self) -> Self {
        let clamp = |x: i64| x.clamp(-(1 << 30), 1 << 30);
        Self::new(clamp(self.n) * clamp(other.d) + clamp(other.n) * clamp(self.d), clamp(self.d) * clamp(other.d))
    }
    fn inverse(self) -> Self {
        Self::new(self.d, self.n)
    }
}

const SYMBOLS: [&str; 3] = ["kg", "m", "s"];

/// Exponents of kg, m and s, plus unknown dimensions to rational powers.
#[derive(Clone, PartialEq, Debug)]
pub struct Dimension {
    known: [Ratio; 3],
    /// `(unknown, power)`, sorted by unknown, no zero powers.
    unknown: Vec<(u32, Ratio)>,
}

impl Dimension {
    /// A pure number or an angle.
    pub const NONE: Self = Self { known: [Ratio::ZERO; 3], unknown: Vec::new() };

    /// `kg^a m^b s^c`.
    pub fn of(kg: i64, m: i64, s: i64) -> Self {
        Self { known: [Ratio::new(kg, 1), Ratio::new(m, 1), Ratio::new(s, 1)], unknown: Vec::new() }
    }

    /// Seconds.
    pub fn time() -> Self {
        Self::of(0, 0, 1)
    }

    /// The dimension to a power.
    pub fn power(&self, p: Ratio) -> Self {
        if p.is_zero() {
            return Self::NONE;
        }
        Self {
            known: self.known.map(|k| k.times(p)),
            unknown: self.unknown.iter().map(|(v, k)| (*v, k.times(p))).collect(),
        }
    }

    /// True if nothing is left to find.
    pub fn is_known(&self) -> bool {
        self.unknown.is_empty()
    }

    /// True for seconds to any power.
    pub fn is_power_of_time(&self) -> bool {
        self.known[0].is_zero() && self.known[1].is_zero() && self.unknown.is_empty()
    }

    /// True for pure numbers and angles.
    pub fn is_none(&self) -> bool {
        self.known.iter().all(|k| k.is_zero()) && self.unknown.is_empty()
    }

    /// Written with SI units: `kg*m/s^2` is `N`; unknowns are left out.
    pub fn unit(&self, angle: bool) -> String {
        if self.known.iter().all(|k| k.is_zero()) {
            return if angle { "rad".into() } else { "1".into() };
        }
        const NAMED: &[([i64; 3], &str)] = &[
            ([1, 1, -2], "N"),
            ([1, 2, -3], "W"),
            ([1, 2, -2], "N*m"),
            ([1, 0, -2], "N/m"),
            ([1, 0, -1], "N*s/m"),
            ([1, 2, -1], "N*m*s"),
            ([1, -1, -2], "Pa"),
        ];
        for (powers, name) in NAMED {
            if self.known == powers.map(|p| Ratio::new(p, 1)) {
                return (*name).to_string();
            }
        }
        if angle && self.known == [Ratio::ZERO, Ratio::ZERO, Ratio::new(-1, 1)] {
            return "rad/s".into();
        }
        if angle && self.known == [Ratio::ZERO, Ratio::ZERO, Ratio::new(-2, 1)] {
            return "rad/s^2".into();
        }
        let factor = |sign: i64| {
            let mut text = String::new();
            for (k, symbol) in self.known.iter().zip(SYMBOLS) {
                if k.n * sign > 0 {
                    let n = k.n * sign;
                    if !text.is_empty() {
                        text.push('*');
                    }
                    text.push_str(symbol);
                    match (n, k.d) {
                        (1, 1) => {}
                        (n, 1) => write!(text, "^{n}").expect("writing to a string"),
                        (n, d) => write!(text, "^({n}/{d})").expect("writing to a string"),
                    }
                }
            }
            text
        };
        let (above, below) = (factor(1), factor(-1));
        match (above.as_str(), below.as_str()) {
            (a, "") => a.to_string(),
            ("", b) => format!("1/{}", if b.contains('*') { format!("({b})") } else { b.to_string() }),
            (a, b) if b.contains('*') => format!("{a}/({b})"),
            (a, b) => format!("{a}/{b}"),
        }
    }

    /// What a person calls it: `a length`, `an angle`, `a force`.
    pub fn kind(&self, angle: bool) -> &'static str {
        const KINDS: &[([i64; 3], &str)] = &[
            ([0, 1, 0], "a length"),
            ([0, 0, 1], "a time"),
            ([1, 0, 0], "a mass"),
            ([0, 1, -1], "a speed"),
            ([0, 1, -2], "an acceleration"),
            ([0, 0, -1], "a rate"),
            ([1, 1, -2], "a force"),
            ([1, 2, -2], "a torque or an energy"),
            ([1, 2, -3], "a power"),
            ([1, 2, 0], "a moment of inertia"),
            ([0, 2, 0], "an area"),
        ];
        if self.is_none() {
            return if angle { "an angle" } else { "a pure number" };
        }
        KINDS
            .iter()
            .find(|(powers, _)| self.known == powers.map(|p| Ratio::new(p, 1)))
            .map_or("a quantity", |(_, kind)| kind)
    }
}

impl Add for &Dimension {
    type Output = Dimension;
    /// Dimension of a product.
    fn add(self, other: Self) -> Dimension {
        let mut known = self.known;
        for (k, o) in known.iter_mut().zip(other.known) {
            *k = k.plus(o);
        }
        let mut unknown = self.unknown.clone();
        for (v, p) in &other.unknown {
            match unknown.binary_search_by_key(v, |(v, _)| *v) {
                Ok(i) => {
                    unknown[i].1 = unknown[i].1.plus(*p);
                    if unknown[i].1.is_zero() {
                        unknown.remove(i);
                    }
                }
                Err(i) => unknown.insert(i, (*v, *p)),
            }
        }
        Dimension { known, unknown }
    }
}

impl Neg for &Dimension {
    type Output = Dimension;
    /// Dimension of the inverse.
    fn neg(self) -> Dimension {
        self.power(Ratio::new(-1, 1))
    }
}

impl Sub for &Dimension {
    type Output = Dimension;
    /// Dimension of a quotient.
    fn sub(self, other: Self) -> Dimension {
        self + &-other
    }
}

/// What has been found out about unknown dimensions.
#[derive(Default, Debug)]
pub struct Unifier {
    found: Vec<Option<Dimension>>,
}

impl Unifier {
    /// A new unknown.
    pub fn unknown(&mut self) -> Dimension {
        self.found.push(None);
        Dimension { known: [Ratio::ZERO; 3], unknown: vec![(self.found.len() as u32 - 1, Ratio::ONE)] }
    }

    /// The dimension with all that is known put in.
    pub fn resolve(&self, d: &Dimension) -> Dimension {
        if d.unknown.iter().all(|(v, _)| self.found[*v as usize].is_none()) {
            return d.clone();
        }
        let mut result = Dimension { known: d.known, unknown: Vec::new() };
        for (v, p) in &d.unknown {
            let part = match &self.found[*v as usize] {
                Some(found) => self.resolve(found).power(*p),
                None => Dimension { known: [Ratio::ZERO; 3], unknown: vec![(*v, *p)] },
            };
            result = &result + &part;
        }
        result
    }

    /// Makes two dimensions equal by finding an unknown.
    ///
    /// # Errors
    /// Both, resolved, if nothing unknown is left and they differ.
    pub fn unify(&mut self, a: &Dimension, b: &Dimension) -> Result<(), Box<(Dimension, Dimension)>> {
        if a.unknown.is_empty() && b.unknown.is_empty() && a.known == b.known {
            return Ok(());
        }
        let (a, b) = (self.resolve(a), self.resolve(b));
        let mut difference = &a - &b;
        match difference.unknown.pop() {
            Some((v, p)) => {
                self.found[v as usize] = Some(difference.power(Ratio::new(-1, 1).times(p.inverse())));
                Ok(())
            }
            None if difference.is_none() => Ok(()),
            None => Err(Box::new((a, b))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn literals_take_the_dimension_of_their_place() {
        // tanh((t - 3)/1.0): 3 is a time, 1.0 is a time
        let mut u = Unifier::default();
        let t = Dimension::time();
        let (three, one) = (u.unknown(), u.unknown());
        u.unify(&t, &three).unwrap();
        let argument = &t - &one;
        u.unify(&argument, &Dimension::NONE).unwrap();
        assert_eq!(u.resolve(&three), t);
        assert_eq!(u.resolve(&one), t);
    }

    #[test]
    fn declared_units_conflict() {
        let mut u = Unifier::default();
        let (length, time) = (Dimension::of(0, 1, 0), Dimension::time());
        assert!(u.unify(&length, &time).is_err());
        let x = u.unknown();
        u.unify(&x.power(Ratio::new(2, 1)), &length).unwrap(); // x = m^(1/2)
        assert!(u.unify(&x, &length).is_err());
        assert_eq!(u.resolve(&x).unit(false), "m^(1/2)");
    }

    #[test]
    fn units_read_well() {
        assert_eq!(Dimension::of(1, 1, -2).unit(false), "N");
        assert_eq!(Dimension::of(0, 1, -1).unit(false), "m/s");
        assert_eq!(Dimension::of(1, 2, 0).unit(false), "kg*m^2");
        assert_eq!(Dimension::of(0, 0, -1).unit(true), "rad/s");
        assert_eq!(Dimension::of(0, 0, -2).unit(false), "1/s^2");
        assert_eq!(Dimension::NONE.unit(true), "rad");
    }
}
