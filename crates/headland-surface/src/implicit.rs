//! Distance with all derivatives up to order 3 from one equation `φ = 0` of the surface and the nearest point on it.
//!
//! ```text
//! N = ∇φ / |∇φ|                        unit normal beside the surface
//! p = c − d n,  n(c) = N(p(c))         foot and normal of a point c
//! (I + d DN) H   = DN P                P = I − n nᵀ
//! (I + d DN) T_jk = D²N [p_j, p_k] − DN (H_jk n + n_j H_k + n_k H_j)        p_j = P_j − d H_j
//! ```
//! The second line differentiated once and twice gives the others; `H` is the gradient of the normal, `T` that of `H`.

use headland_expr::{FIELD_PARTS, field_part};
use nalgebra::{Matrix3, Vector3};

/// Derivatives of `φ` at a point of the surface; `φ` grows towards the free side.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Level {
    /// `∇φ`.
    pub gradient: Vector3<f64>,
    /// `∇∇φ`.
    pub hessian: Matrix3<f64>,
    /// `∂φ_ij/∂x_k`, one matrix for each k.
    pub third: [Matrix3<f64>; 3],
}

/// Writes distance and derivatives up to `order` at `c`, whose nearest point is `foot`; NaN from order 2 on where `c` is a
/// centre of curvature.
pub(crate) fn write(c: [f64; 3], foot: [f64; 3], level: &Level, order: usize, out: &mut [f64]) {
    let size = level.gradient.norm();
    let n = level.gradient / size;
    let d = n.dot(&(Vector3::from(c) - Vector3::from(foot)));
    out[0] = d;
    if order == 0 {
        return;
    }
    out[1..4].copy_from_slice(n.as_slice());
    if order == 1 {
        return;
    }
    let along = level.hessian * n; // gradient of |∇φ|
    let dn = (level.hessian - n * along.transpose()) / size;
    let Some(inverse) = (Matrix3::identity() + dn * d).try_inverse() else {
        out[4..FIELD_PARTS[order]].fill(f64::NAN);
        return;
    };
    let tangent = Matrix3::identity() - n * n.transpose();
    let h = inverse * dn * tangent;
    write_second(&h, out);
    if order == 2 {
        return;
    }
    let foot_rate = tangent - h * d;
    let d2n = second_of_normal(level, &n, size, &along, &dn);
    for j in 0..3 {
        for k in j..3 {
            let (a, b) = (foot_rate.column(j), foot_rate.column(k));
            let bend = Vector3::from_fn(|i, _| a.dot(&(d2n[i] * b)));
            let turn = n * h[(j, k)] + h.column(k) * n[j] + h.column(j) * n[k];
            let t = inverse * (bend - dn * turn);
            for i in 0..=j {
                out[part(&[i, j, k])] = t[i];
            }
        }
    }
}

/// `∂²N_i/∂x_a∂x_b`, one matrix for each i: from `|∇φ| N = ∇φ` differentiated twice.
fn second_of_normal(
    level: &Level,
    n: &Vector3<f64>,
    size: f64,
    along: &Vector3<f64>,
    dn: &Matrix3<f64>,
) -> [Matrix3<f64>; 3] {
    let third = |i: usize, a: usize, b: usize| level.third[b][(i, a)];
    let of_size = Matrix3::from_fn(|a, b| {
        (0..3).map(|m| dn[(m, b)] * level.hessian[(m, a)] + n[m] * third(m, a, b)).sum::<f64>()
    });
    [0, 1, 2].map(|i| {
        Matrix3::from_fn(|a, b| {
            (third(i, a, b) - along[b] * dn[(i, a)] - along[a] * dn[(i, b)] - of_size[(a, b)] * n[i]) / size
        })
    })
}

/// Writes the second derivatives, made symmetric to the last bit.
pub(crate) fn write_second(h: &Matrix3<f64>, out: &mut [f64]) {
    for i in 0..3 {
        for j in i..3 {
            out[part(&[i, j])] = 0.5 * (h[(i, j)] + h[(j, i)]);
        }
    }
}

/// Place of a derivative along the given variables.
pub(crate) fn part(variables: &[usize]) -> usize {
    let times = |v| variables.iter().filter(|&&x| x == v).count();
    field_part(times(0), times(1), times(2))
}
