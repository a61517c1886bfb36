//! `M u′ = F`, equation (9): `L D Lᵀ` and Crout's LU, written once over any scalar, so unrolled or numeric.

use headland_expr::Scalar;

/// Position of entry `(i, j)`, `j ≤ i`, in a packed lower triangle.
pub fn packed(i: usize, j: usize) -> usize {
    debug_assert!(j <= i);
    i * (i + 1) / 2 + j
}

/// Solves `M x = f` by `M = L D Lᵀ` without pivoting; `m` holds the lower triangle row by row and is overwritten by L
/// and D, `f` by x. `n³/6` multiplications.
///
/// M must be positive definite; a pivot `D ≤ 0` shows in `m[packed(i, i)]` afterwards.
///
/// # References
/// Golub & Van Loan, *Matrix Computations*, 4th ed., algorithm 4.1.2.
pub fn solve_ldl<S: Scalar>(m: &mut [S], f: &mut [S]) {
    let n = f.len();
    for j in 0..n {
        // L_ij D_j stands in row i until the row is done
        for k in 0..j {
            let scaled = m[packed(j, k)];
            let l = scaled / m[packed(k, k)];
            m[packed(j, k)] = l;
            m[packed(j, j)] = m[packed(j, j)] - l * scaled;
            f[j] = f[j] - l * f[k];
        }
        for i in j + 1..n {
            let mut sum = m[packed(i, j)];
            for k in 0..j {
                sum = sum - m[packed(i, k)] * m[packed(j, k)];
            }
            m[packed(i, j)] = sum;
        }
    }
    for i in 0..n {
        f[i] = f[i] / m[packed(i, i)];
    }
    for i in (0..n).rev() {
        for j in 0..i {
            f[j] = f[j] - m[packed(i, j)] * f[i];
        }
    }
}

/// Solves `A x = f` by Crout's `A = L U` (U with unit diagonal), as the article does; `a` is row by row and is
/// overwritten, `f` by x. Without pivoting: M is positive definite. `n³/3` multiplications.
///
/// # References
/// Crout, *A short method for evaluating determinants and solving systems of linear equations*, 1941.
pub fn solve_crout<S: Scalar>(a: &mut [S], f: &mut [S]) {
    let n = f.len();
    for j in 0..n {
        for i in j..n {
            for k in 0..j {
                a[i * n + j] = a[i * n + j] - a[i * n + k] * a[k * n + j];
            }
        }
        for i in j + 1..n {
            for k in 0..j {
                a[j * n + i] = a[j * n + i] - a[j * n + k] * a[k * n + i];
            }
            a[j * n + i] = a[j * n + i] / a[j * n + j];
        }
        for k in 0..j {
            f[j] = f[j] - a[j * n + k] * f[k];
        }
        f[j] = f[j] / a[j * n + j];
    }
    for i in (0..n).rev() {
        for j in i + 1..n {
            f[i] = f[i] - a[i * n + j] * f[j];
        }
    }
}

/// The full matrix of a packed lower triangle, row by row.
pub fn unpack<S: Scalar>(m: &[S], n: usize) -> Vec<S> {
    (0..n * n).map(|k| (k / n, k % n)).map(|(i, j)| m[packed(i.max(j), i.min(j))]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn both_solve_a_known_system() {
        // M = A Aᵀ + I for A_ij = 1/(i + 2 j + 1), x known
        for n in 1..9 {
            let a = |i: usize, j: usize| 1.0 / (i + 2 * j + 1) as f64;
            let entry =
                |i: usize, j: usize| (0..n).map(|k| a(i, k) * a(j, k)).sum::<f64>() + f64::from(u8::from(i == j));
            let x: Vec<f64> = (0..n).map(|i| (i as f64).cos()).collect();
            let f: Vec<f64> = (0..n).map(|i| (0..n).map(|j| entry(i, j) * x[j]).sum()).collect();
            let mut m: Vec<f64> = (0..n).flat_map(|i| (0..=i).map(move |j| (i, j))).map(|(i, j)| entry(i, j)).collect();
            let mut full = unpack(&m, n);
            let (mut ldl, mut crout) = (f.clone(), f);
            solve_ldl(&mut m, &mut ldl);
            solve_crout(&mut full, &mut crout);
            for i in 0..n {
                assert_relative_eq!(ldl[i], x[i], epsilon = 1e-13);
                assert_relative_eq!(crout[i], x[i], epsilon = 1e-13);
            }
        }
    }
}
