//! [`Field`]: a function of a point that is computed outside of the graph, with its derivatives.

use crate::interval::Interval;

/// A function of three variables that is known by numbers only: the distance from a surface, the height of measured ground.
///
/// An evaluation answers with the value and all partial derivatives up to an order, so that whatever costs, a search for a
/// nearest point say, is done once:
///
/// ```text
/// order 0:  f
/// order 1:  f_x  f_y  f_z
/// order 2:  f_xx f_xy f_xz f_yy f_yz f_zz
/// order 3:  f_xxx f_xxy f_xxz f_xyy f_xyz f_xzz f_yyy f_yyz f_yzz f_zzz
/// ```
/// What does not depend on a variable has zeros there. A field is a fact: the same point gives the same numbers, to the
/// last bit, whatever order is asked for.
///
/// In expressions ([`Scalar::field`](crate::Scalar::field)) a field may be differentiated three times. A fourth derivative
/// is unknown, not zero: it becomes a node of its own ([`FIELD_BEYOND`]), which [`Graph::beyond_fields`](crate::Graph::beyond_fields)
/// finds before anything is evaluated; evaluated all the same, it is NaN.
pub trait Field: std::fmt::Debug + Send + Sync {
    /// Its name, for printed equations and messages.
    fn name(&self) -> &str;

    /// Writes value and derivatives up to `order` (at most 3) to `out`, which has [`FIELD_PARTS`]`[order]` places. Where the
    /// field has no value it writes NaN.
    fn eval(&self, point: [f64; 3], order: usize, out: &mut [f64]);

    /// Bounds of a part over a box; the whole line, where nothing is known.
    fn range(&self, _boxed: [Interval; 3], _part: usize) -> Interval {
        Interval::WHOLE
    }

    /// How many of x, y, z it depends on: 2 for a height over the plane. The others are left out of expressions and of
    /// what is printed.
    fn variables(&self) -> usize {
        3
    }
}

/// How many numbers a field has up to each order.
pub const FIELD_PARTS: [usize; 4] = [1, 4, 10, 20];

/// Place of the derivative that is taken `i`, `j` and `k` times along x, y and z, `i + j + k ≤ 3`.
pub const fn field_part(i: usize, j: usize, k: usize) -> usize {
    let order = i + j + k;
    let before = if order == 0 { 0 } else { FIELD_PARTS[order - 1] };
    // within an order: those with fewer x come later, then those with fewer y
    let without_x = order - i;
    before + without_x * (without_x + 1) / 2 + k
}

/// The part that stands for every derivative of fourth or higher order, which no field has.
pub const FIELD_BEYOND: usize = FIELD_PARTS[3];

/// How often a part is taken along x, y and z; `None` for [`FIELD_BEYOND`].
pub fn field_exponents(part: usize) -> Option<[usize; 3]> {
    let order = field_order(part)?;
    let mut within = part - if order == 0 { 0 } else { FIELD_PARTS[order - 1] };
    let mut without_x = 0;
    while within > without_x {
        within -= without_x + 1;
        without_x += 1;
    }
    Some([order - without_x, without_x - within, within])
}

/// Order of a part; `None` for [`FIELD_BEYOND`].
pub fn field_order(part: usize) -> Option<usize> {
    FIELD_PARTS.iter().position(|&end| part < end)
}

/// The part that is `part` taken once more along an axis.
pub fn field_derived(part: usize, axis: usize) -> usize {
    match field_exponents(part) {
        Some([i, j, k]) if i + j + k < 3 => {
            field_part(i + usize::from(axis == 0), j + usize::from(axis == 1), k + usize::from(axis == 2))
        }
        _ => FIELD_BEYOND,
    }
}

/// One part of a field at a point of numbers; NaN for [`FIELD_BEYOND`].
pub fn field_value(field: &dyn Field, point: [f64; 3], part: usize) -> f64 {
    let Some(order) = field_order(part) else { return f64::NAN };
    let mut parts = [0.0; FIELD_PARTS[3]];
    field.eval(point, order, &mut parts[..FIELD_PARTS[order]]);
    parts[part]
}

/// A part and its derivatives along x, y and z, by one evaluation.
pub fn field_slopes(field: &dyn Field, point: [f64; 3], part: usize) -> (f64, [f64; 3]) {
    let Some(order) = field_order(part) else { return (f64::NAN, [f64::NAN; 3]) };
    let order = (order + 1).min(3);
    let mut parts = [0.0; FIELD_PARTS[3]];
    field.eval(point, order, &mut parts[..FIELD_PARTS[order]]);
    let slope = |axis: usize| match field_derived(part, axis) {
        _ if axis >= field.variables() => 0.0,
        FIELD_BEYOND => f64::NAN,
        derived => parts[derived],
    };
    (parts[part], [slope(0), slope(1), slope(2)])
}

/// A field in closed form, to try things with: `sin(a₁ x + b₁) sin(a₂ y + b₂) sin(a₃ z + b₃)`.
#[derive(Clone, Debug, PartialEq)]
pub struct Wave {
    /// Its name.
    pub name: String,
    /// `a`: how fast it goes along x, y and z.
    pub rate: [f64; 3],
    /// `b`: where it is at the origin, rad.
    pub phase: [f64; 3],
}

impl Wave {
    /// One part, `field_exponents` of it given.
    fn part(&self, point: [f64; 3], times: [usize; 3]) -> f64 {
        let factor = |axis: usize| {
            let (a, angle) = (self.rate[axis], self.rate[axis] * point[axis] + self.phase[axis]);
            match times[axis] {
                0 => angle.sin(),
                1 => a * angle.cos(),
                2 => -(a * a) * angle.sin(),
                _ => -(a * a * a) * angle.cos(),
            }
        };
        factor(0) * factor(1) * factor(2)
    }
}

impl Field for Wave {
    fn name(&self) -> &str {
        &self.name
    }
    fn eval(&self, point: [f64; 3], order: usize, out: &mut [f64]) {
        for (part, out) in out[..FIELD_PARTS[order]].iter_mut().enumerate() {
            *out = field_exponents(part).map_or(f64::NAN, |times| self.part(point, times));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_numbered_in_order() {
        let mut next = 0;
        for order in 0..4 {
            for i in (0..=order).rev() {
                for j in (0..=order - i).rev() {
                    let k = order - i - j;
                    assert_eq!(field_part(i, j, k), next);
                    assert_eq!(field_exponents(next), Some([i, j, k]));
                    assert_eq!(field_order(next), Some(order));
                    let more = |part: usize| if order < 3 { part } else { FIELD_BEYOND };
                    assert_eq!(field_derived(next, 0), more(field_part(i + 1, j, k)));
                    assert_eq!(field_derived(next, 1), more(field_part(i, j + 1, k)));
                    assert_eq!(field_derived(next, 2), more(field_part(i, j, k + 1)));
                    next += 1;
                }
            }
            assert_eq!(next, FIELD_PARTS[order]);
        }
        assert_eq!((field_exponents(FIELD_BEYOND), field_order(FIELD_BEYOND)), (None, None));
        assert_eq!(field_derived(FIELD_BEYOND, 1), FIELD_BEYOND);
    }
}
