//! [`Field`]: a function of a point that is computed outside of the graph, with its derivatives.

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
/// What does not depend on a variable has zeros there. A field is a fact: the same point gives the same numbers.
pub trait Field: std::fmt::Debug + Send + Sync {
    /// Its name, for printed equations and messages.
    fn name(&self) -> &str;

    /// Writes value and derivatives up to `order` (at most 3) to `out`, which has [`FIELD_PARTS`]`[order]` places. Where the
    /// field has no value it writes NaN.
    fn eval(&self, point: [f64; 3], order: usize, out: &mut [f64]);
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_numbered_in_order() {
        let mut next = 0;
        for order in 0..4 {
            for i in (0..=order).rev() {
                for j in (0..=order - i).rev() {
                    assert_eq!(field_part(i, j, order - i - j), next);
                    next += 1;
                }
            }
            assert_eq!(next, FIELD_PARTS[order]);
        }
    }
}
