//! Coefficients of a spline of degree 5 through points: a banded system.

/// Most entries of a row left or right of the diagonal.
const BAND: usize = 6;
/// With those that pivoting brings in.
const WIDTH: usize = 3 * BAND + 1;

/// The factors of the interpolation through so many points.
pub(super) struct Interpolation {
    /// Row `i` holds the columns from `i − BAND` on, after elimination.
    upper: Vec<[f64; WIDTH]>,
    /// Of each step: the row swapped in, and the multiples subtracted below.
    steps: Vec<(usize, [f64; BAND])>,
}

impl Interpolation {
    /// Equations in order: two knots that are none, one for each point, two knots that are none.
    pub fn new(points: usize) -> Self {
        let size = points + 4;
        let mut rows = vec![[0.0; WIDTH]; size];
        let mut fill = |row: usize, first: usize, entries: &[f64]| {
            for (k, &entry) in entries.iter().enumerate() {
                rows[row][first + k + BAND - row] = entry;
            }
        };
        // the jump of the fifth derivative
        let no_knot = [1.0, -6.0, 15.0, -20.0, 15.0, -6.0, 1.0];
        fill(0, 0, &no_knot);
        fill(1, 1, &no_knot);
        fill(size - 2, size - 8, &no_knot);
        fill(size - 1, size - 7, &no_knot);
        for point in 0..points {
            fill(point + 2, point, &[1.0, 26.0, 66.0, 26.0, 1.0].map(|w| w / 120.0));
        }
        let steps = factor(&mut rows);
        Self { upper: rows, steps }
    }

    /// Coefficients from two before the first point to two after the last.
    pub fn coefficients(&self, values: &[f64]) -> Vec<f64> {
        let size = self.upper.len();
        let mut x = vec![0.0; size];
        x[2..size - 2].copy_from_slice(values);
        for (k, (pivot, multiples)) in self.steps.iter().enumerate() {
            x.swap(k, *pivot);
            for (i, m) in multiples.iter().enumerate().take(size - 1 - k) {
                x[k + 1 + i] -= m * x[k];
            }
        }
        for k in (0..size).rev() {
            let known: f64 =
                (1..=2 * BAND).take_while(|d| k + d < size).map(|d| self.upper[k][BAND + d] * x[k + d]).sum();
            x[k] = (x[k] - known) / self.upper[k][BAND];
        }
        x
    }
}

/// Gaussian elimination with partial pivoting within the band.
fn factor(rows: &mut [[f64; WIDTH]]) -> Vec<(usize, [f64; BAND])> {
    let size = rows.len();
    // entry of a row in an absolute column
    let place = |row: usize, column: usize| column + BAND - row;
    (0..size)
        .map(|k| {
            let last = (k + BAND).min(size - 1);
            let pivot = (k..=last).fold(k, |best, i| {
                if rows[i][place(i, k)].abs() > rows[best][place(best, k)].abs() { i } else { best }
            });
            let columns = k..(k + 2 * BAND + 1).min(size);
            if pivot != k {
                for j in columns.clone() {
                    let a = rows[k][place(k, j)];
                    let (p, q) = (place(pivot, j), place(k, j));
                    rows[k][q] = rows[pivot][p];
                    rows[pivot][p] = a;
                }
            }
            let mut multiples = [0.0; BAND];
            for i in k + 1..=last {
                let m = rows[i][place(i, k)] / rows[k][BAND];
                multiples[i - k - 1] = m;
                for j in columns.clone() {
                    rows[i][place(i, j)] -= m * rows[k][place(k, j)];
                }
            }
            (pivot, multiples)
        })
        .collect()
}
