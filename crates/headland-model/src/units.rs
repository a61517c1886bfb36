//! Units and quantities: `"4 m"`, `"30 deg"`, `"12 kN"`, `"65 km/h"`, `"1.2e4 N*m/rad"`.

use headland_expr::parse::suggestion;

use crate::dimension::{Dimension, Ratio};

/// A unit: a dimension and the factor to SI, kept as a quotient so that 65 km/h is 65·1000/3600 exactly rounded once.
#[derive(Clone, Debug, PartialEq)]
pub struct Unit {
    /// Its dimension.
    pub dimension: Dimension,
    /// True if it counts angles.
    pub angle: bool,
    numerator: f64,
    denominator: f64,
}

impl Unit {
    /// The unit 1.
    pub fn one() -> Self {
        Self { dimension: Dimension::NONE, angle: false, numerator: 1.0, denominator: 1.0 }
    }

    /// `x` of this unit, in SI.
    pub fn to_si(&self, x: f64) -> f64 {
        x * self.numerator / self.denominator
    }

    /// An SI value, in this unit.
    pub fn from_si(&self, x: f64) -> f64 {
        x * self.denominator / self.numerator
    }

    fn times(&self, other: &Self, sign: i64) -> Self {
        let (n, d) = if sign > 0 { (other.numerator, other.denominator) } else { (other.denominator, other.numerator) };
        let dimension = &self.dimension + &other.dimension.power(Ratio::new(sign, 1));
        let angle = self.angle || other.angle && sign > 0;
        Self { dimension, angle, numerator: self.numerator * n, denominator: self.denominator * d }
    }

    fn power(&self, n: i32) -> Self {
        (0..n.unsigned_abs()).fold(Self::one(), |u, _| u.times(self, i64::from(n.signum())))
    }
}

const PI: f64 = std::f64::consts::PI;

/// Name, kg, m, s, angle, numerator, denominator.
const UNITS: &[(&str, i64, i64, i64, bool, f64, f64)] = &[
    ("1", 0, 0, 0, false, 1.0, 1.0),
    ("%", 0, 0, 0, false, 1.0, 100.0),
    ("rad", 0, 0, 0, true, 1.0, 1.0),
    ("mrad", 0, 0, 0, true, 1.0, 1e3),
    ("deg", 0, 0, 0, true, PI, 180.0),
    ("°", 0, 0, 0, true, PI, 180.0),
    ("rev", 0, 0, 0, true, 2.0 * PI, 1.0),
    ("rpm", 0, 0, -1, true, 2.0 * PI, 60.0),
    ("m", 0, 1, 0, false, 1.0, 1.0),
    ("km", 0, 1, 0, false, 1e3, 1.0),
    ("dm", 0, 1, 0, false, 1.0, 10.0),
    ("cm", 0, 1, 0, false, 1.0, 100.0),
    ("mm", 0, 1, 0, false, 1.0, 1e3),
    ("um", 0, 1, 0, false, 1.0, 1e6),
    ("in", 0, 1, 0, false, 0.0254, 1.0),
    ("ft", 0, 1, 0, false, 0.3048, 1.0),
    ("kg", 1, 0, 0, false, 1.0, 1.0),
    ("g", 1, 0, 0, false, 1.0, 1e3),
    ("t", 1, 0, 0, false, 1e3, 1.0),
    ("lb", 1, 0, 0, false, 0.453_592_37, 1.0),
    ("s", 0, 0, 1, false, 1.0, 1.0),
    ("ms", 0, 0, 1, false, 1.0, 1e3),
    ("us", 0, 0, 1, false, 1.0, 1e6),
    ("min", 0, 0, 1, false, 60.0, 1.0),
    ("h", 0, 0, 1, false, 3600.0, 1.0),
    ("Hz", 0, 0, -1, false, 1.0, 1.0),
    ("N", 1, 1, -2, false, 1.0, 1.0),
    ("mN", 1, 1, -2, false, 1.0, 1e3),
    ("kN", 1, 1, -2, false, 1e3, 1.0),
    ("MN", 1, 1, -2, false, 1e6, 1.0),
    ("Nm", 1, 2, -2, false, 1.0, 1.0),
    ("kNm", 1, 2, -2, false, 1e3, 1.0),
    ("J", 1, 2, -2, false, 1.0, 1.0),
    ("kJ", 1, 2, -2, false, 1e3, 1.0),
    ("MJ", 1, 2, -2, false, 1e6, 1.0),
    ("W", 1, 2, -3, false, 1.0, 1.0),
    ("kW", 1, 2, -3, false, 1e3, 1.0),
    ("MW", 1, 2, -3, false, 1e6, 1.0),
    ("Pa", 1, -1, -2, false, 1.0, 1.0),
    ("kPa", 1, -1, -2, false, 1e3, 1.0),
    ("MPa", 1, -1, -2, false, 1e6, 1.0),
    ("GPa", 1, -1, -2, false, 1e9, 1.0),
    ("bar", 1, -1, -2, false, 1e5, 1.0),
];

/// Reads a unit: names with integer powers, joined by `*`, `·`, a space or `/`, with parentheses.
///
/// # Errors
/// A sentence that says which name is unknown, with a suggestion.
pub fn parse_unit(text: &str) -> Result<Unit, String> {
    let mut reader = Reader { text, at: 0, depth: 0 };
    let unit = reader.product()?;
    reader.skip_space();
    if reader.at < text.len() {
        return Err(format!("`{}` cannot be read in the unit `{text}`", &text[reader.at..]));
    }
    Ok(unit)
}

/// Reads a whole quantity, a number with an optional unit; `None` if the text does not start with a number or is an expression.
pub fn parse_quantity(text: &str) -> Option<Result<(f64, Option<Unit>), String>> {
    let text = text.trim();
    let sign = if text.starts_with('-') { -1.0 } else { 1.0 };
    let digits = text.trim_start_matches(['-', '+']).trim_start();
    if text.len() - digits.len() > 2 || !digits.starts_with(|c: char| c.is_ascii_digit() || c == '.') {
        return None;
    }
    let end = number_end(digits);
    let x: f64 = digits[..end].parse().ok()?;
    let too_large = || format!("the number `{}` is too large", &digits[..end]);
    let unit = digits[end..].trim();
    if unit.is_empty() {
        return Some(if x.is_finite() { Ok((sign * x, None)) } else { Err(too_large()) });
    }
    if !unit.starts_with(|c: char| c.is_alphabetic() || c == '%' || c == '°') {
        return None;
    }
    let quantity = parse_unit(unit).map(|u| (sign * u.to_si(x), Some(u)));
    Some(quantity.and_then(|(x, u)| if x.is_finite() { Ok((x, u)) } else { Err(too_large()) }))
}

fn number_end(text: &str) -> usize {
    let bytes = text.as_bytes();
    let mut end = 0;
    while end < bytes.len() && (bytes[end].is_ascii_digit() || bytes[end] == b'.') {
        end += 1;
    }
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
        if bytes.get(end + 1 + sign).is_some_and(u8::is_ascii_digit) {
            end += 1 + sign;
            while end < bytes.len() && bytes[end].is_ascii_digit() {
                end += 1;
            }
        }
    }
    end
}

struct Reader<'t> {
    text: &'t str,
    at: usize,
    depth: usize,
}

impl Reader<'_> {
    fn rest(&self) -> &str {
        &self.text[self.at..]
    }

    fn skip_space(&mut self) {
        self.at += self.rest().len() - self.rest().trim_start().len();
    }

    fn product(&mut self) -> Result<Unit, String> {
        let mut unit = self.factor()?;
        loop {
            self.skip_space();
            let Some(next) = self.rest().chars().next() else { return Ok(unit) };
            let sign = match next {
                '*' | '·' | '/' => {
                    self.at += next.len_utf8();
                    if next == '/' { -1 } else { 1 }
                }
                c if c.is_alphabetic() || c == '(' => 1,
                _ => return Ok(unit),
            };
            unit = unit.times(&self.factor()?, sign);
        }
    }

    fn factor(&mut self) -> Result<Unit, String> {
        self.skip_space();
        let unit = if self.rest().starts_with('(') {
            self.at += 1;
            self.depth += 1;
            if self.depth > 20 {
                return Err(format!(
                    "the unit `{}…` is nested too deeply",
                    self.text.chars().take(20).collect::<String>()
                ));
            }
            let unit = self.product()?;
            self.skip_space();
            if !self.rest().starts_with(')') {
                return Err(format!("`(` without `)` in the unit `{}`", self.text));
            }
            self.at += 1;
            unit
        } else {
            self.name()?
        };
        let n = self.exponent()?;
        Ok(if n == 1 { unit } else { unit.power(n) })
    }

    fn name(&mut self) -> Result<Unit, String> {
        let rest = self.rest();
        let is_name = |c: char| (c.is_alphabetic() || c == '%' || c == '°') && !"²³".contains(c);
        let length = match rest.chars().next() {
            Some('1') => 1,
            _ => rest.find(|c| !is_name(c)).unwrap_or(rest.len()),
        };
        let name = &rest[..length];
        let Some((_, kg, m, s, angle, numerator, denominator)) = UNITS.iter().find(|u| u.0 == name) else {
            let shown = if name.is_empty() { rest } else { name };
            let inside = if shown == self.text { String::new() } else { format!(" in `{}`", self.text) };
            let hint = suggestion(shown, UNITS.iter().map(|u| u.0));
            return Err(format!("unknown unit `{shown}`{inside}{hint}"));
        };
        self.at += length;
        let dimension = Dimension::of(*kg, *m, *s);
        Ok(Unit { dimension, angle: *angle, numerator: *numerator, denominator: *denominator })
    }

    fn exponent(&mut self) -> Result<i32, String> {
        for (mark, n) in [("²", 2), ("³", 3)] {
            if self.rest().starts_with(mark) {
                self.at += mark.len();
                return Ok(n);
            }
        }
        if !self.rest().starts_with('^') {
            return Ok(1);
        }
        self.at += 1;
        let rest = self.rest();
        let signs = usize::from(rest.starts_with(['-', '+']));
        let end = rest[signs..].find(|c: char| !c.is_ascii_digit()).map_or(rest.len(), |i| i + signs);
        let n: i32 =
            rest[..end].parse().map_err(|_| format!("an integer must follow `^` in the unit `{}`", self.text))?;
        if n.abs() > 12 {
            return Err(format!("power {n} in the unit `{}` is out of range (-12 to 12)", self.text));
        }
        self.at += end;
        Ok(n)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    fn si(text: &str) -> f64 {
        parse_quantity(text).unwrap().unwrap().0
    }

    #[test]
    fn quantities() {
        assert_eq!(si("4 m"), 4.0);
        assert_eq!(si("65 km/h"), 65.0 * 1000.0 / 3600.0);
        assert_relative_eq!(si("30 deg"), PI / 6.0, max_relative = 1e-15);
        assert_eq!(si("12 kN"), 12_000.0);
        assert_eq!(si("-1.5e-3"), -1.5e-3);
        assert_eq!(si("2 kg*m^2"), 2.0);
        assert_eq!(si("2 kg m²"), 2.0);
        assert_eq!(si("3 N/(m/s)"), 3.0);
        assert_eq!(si("2 g/cm^3"), 2000.0);
        assert!(parse_quantity("2*l").is_none());
        assert!(parse_quantity("l").is_none());
        assert_eq!(parse_quantity("3 N/(m/s)").unwrap().unwrap().1.unwrap().dimension, Dimension::of(1, 0, -1));
    }

    #[test]
    fn wrong_units_are_named() {
        assert_eq!(parse_unit("kM").unwrap_err(), "unknown unit `kM`; did you mean `km`?");
        assert!(parse_unit("m^x").unwrap_err().contains("integer"));
        assert!(parse_unit("(m").unwrap_err().contains("without"));
        assert!(parse_unit(&"(".repeat(10_000)).unwrap_err().contains("nested"));
        assert!(parse_unit("m^999").unwrap_err().contains("range"));
    }
}
