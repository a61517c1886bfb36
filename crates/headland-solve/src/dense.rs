//! Small dense matrices, by rows: what consistent starts and diagnoses need.

/// Solves `(A Aᵀ + μ I) z = b` for an `m × n` matrix by Cholesky's method; `None` if rounding has made
/// the matrix indefinite.
pub(crate) fn solve_normal(a: &[f64], m: usize, n: usize, mu: f64, b: &[f64]) -> Option<Vec<f64>> {
    let row = |i: usize| &a[i * n..(i + 1) * n];
    let mut l = vec![0.0; m * m];
    for i in 0..m {
        for j in 0..=i {
            let mut s = dot(row(i), row(j)) - dot(&l[i * m..i * m + j], &l[j * m..j * m + j]);
            if i == j {
                s += mu;
                if s.is_nan() || s <= 0.0 {
                    return None;
                }
                l[i * m + i] = s.sqrt();
            } else {
                l[i * m + j] = s / l[j * m + j];
            }
        }
    }
    let mut z = b.to_vec();
    for i in 0..m {
        z[i] = (z[i] - dot(&l[i * m..i * m + i], &z[..i])) / l[i * m + i];
    }
    for i in (0..m).rev() {
        let s: f64 = (i + 1..m).map(|k| l[k * m + i] * z[k]).sum();
        z[i] = (z[i] - s) / l[i * m + i];
    }
    Some(z)
}

pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// `Aᵀ z`.
pub(crate) fn transposed_product(a: &[f64], n: usize, z: &[f64]) -> Vec<f64> {
    let mut x = vec![0.0; n];
    for (row, z) in a.chunks_exact(n.max(1)).zip(z) {
        for (x, a) in x.iter_mut().zip(row) {
            *x += a * z;
        }
    }
    x
}

pub(crate) fn transposed(a: &[f64], m: usize, n: usize) -> Vec<f64> {
    let mut b = vec![0.0; m * n];
    for i in 0..m {
        for j in 0..n {
            b[j * m + i] = a[i * n + j];
        }
    }
    b
}

/// Sets of rows that depend on each other: for each row that adds nothing to the rank, itself and the
/// rows it is made of.
///
/// Elimination with complete pivoting of the matrix balanced by rows and columns; pivots below
/// `tolerance` count as zero. A row that is zero stands alone in its set.
pub(crate) fn dependent_rows(a: &[f64], m: usize, n: usize, tolerance: f64) -> Vec<Vec<usize>> {
    // Beside the matrix the rows' combinations: `work = combination · a`.
    let width = n + m;
    let mut work = vec![0.0; m * width];
    let balanced = balance(a, m, n);
    for i in 0..m {
        work[i * width..i * width + n].copy_from_slice(&balanced[i * n..(i + 1) * n]);
        work[i * width + n + i] = 1.0;
    }
    let mut open_rows: Vec<usize> = (0..m).collect();
    let mut open_columns: Vec<usize> = (0..n).collect();
    while !open_rows.is_empty() && !open_columns.is_empty() {
        let (mut best, mut at) = (tolerance, None);
        for (k, &i) in open_rows.iter().enumerate() {
            for (l, &j) in open_columns.iter().enumerate() {
                if work[i * width + j].abs() > best {
                    (best, at) = (work[i * width + j].abs(), Some((k, l)));
                }
            }
        }
        let Some((k, l)) = at else { break };
        let (pivot, column) = (open_rows.swap_remove(k), open_columns.swap_remove(l));
        let pivot_row = work[pivot * width..(pivot + 1) * width].to_vec();
        for &i in &open_rows {
            let factor = work[i * width + column] / pivot_row[column];
            if factor != 0.0 {
                for (w, p) in work[i * width..(i + 1) * width].iter_mut().zip(&pivot_row) {
                    *w -= factor * p;
                }
            }
        }
    }
    open_rows.sort_unstable();
    let sets = open_rows.iter().map(|&i| {
        let weights = &work[i * width + n..(i + 1) * width];
        let largest = weights.iter().fold(0.0, |s: f64, w| s.max(w.abs()));
        (0..m).filter(|&k| weights[k].abs() > 1e-4 * largest).collect()
    });
    sets.collect()
}

/// The matrix with its rows and columns scaled, so that their largest elements come close to 1.
fn balance(a: &[f64], m: usize, n: usize) -> Vec<f64> {
    let mut b = a.to_vec();
    for _ in 0..4 {
        for i in 0..m {
            let largest = b[i * n..(i + 1) * n].iter().fold(0.0, |s: f64, v| s.max(v.abs()));
            if largest > 0.0 {
                b[i * n..(i + 1) * n].iter_mut().for_each(|v| *v /= largest.sqrt());
            }
        }
        for j in 0..n {
            let largest = (0..m).fold(0.0, |s: f64, i| s.max(b[i * n + j].abs()));
            if largest > 0.0 {
                (0..m).for_each(|i| b[i * n + j] /= largest.sqrt());
            }
        }
    }
    b
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn least_change_that_satisfies_two_equations() {
        // x + y + z = 3, x - y = 1
        let a = [1.0, 1.0, 1.0, 1.0, -1.0, 0.0];
        let z = solve_normal(&a, 2, 3, 0.0, &[3.0, 1.0]).unwrap();
        let x = transposed_product(&a, 3, &z);
        for (x, expected) in x.iter().zip([1.5, 0.5, 1.0]) {
            assert!((x - expected).abs() < 1e-15);
        }
        assert!(solve_normal(&[1.0, 1.0], 2, 1, 0.0, &[1.0, 1.0]).is_none());
    }

    #[test]
    fn rows_that_depend_on_each_other_are_named() {
        let a = [1e6, 2e6, 0.0, 0.0, 0.0, 5.0, 0.0, 1e-3, 1.0, 2.0, 0.0, 1e-3];
        assert!(dependent_rows(&a, 3, 4, 1e-12).is_empty());
        let a = [1e6, 2e6, 0.0, 0.0, 1.0, 0.0, 3.0, 6.0, 0.0];
        assert_eq!(dependent_rows(&a, 3, 3, 1e-12), [[0, 2]]);
        let a = [1.0, 0.0, 0.0, 0.0];
        assert_eq!(dependent_rows(&a, 2, 2, 1e-12), [[1]]);
        assert_eq!(transposed(&[1.0, 2.0, 3.0, 4.0], 2, 2), [1.0, 3.0, 2.0, 4.0]);
    }
}
