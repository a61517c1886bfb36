//! [`Grid`]: smooth ground through measured heights.
//!
//! A tensor-product spline of degree 5 through all points of an even grid: derivatives are continuous up to the fourth, so
//! curvature and its rate never jump. Its error is of order 6 in the spacing, up to the edge: the two knots next to an edge
//! are no knots (the fifth derivative is continuous there).
//!
//! ```text
//! f(x, y) = Σ c_ij B(x/Δx − i) B(y/Δy − j)        B: the cardinal B-spline of degree 5, support 6
//! ```
//! Beyond an edge its coefficients go on linearly: within three spacings the curvature across the edge fades out, then the
//! ground runs straight on. Nothing jumps at the edge.
//!
//! # References
//! de Boor, *A Practical Guide to Splines*, 1978, ch. IX, XIII, XVII.

mod band;
mod bounds;
mod csv;

use std::sync::Arc;

use headland_expr::{FIELD_PARTS, Field, Interval, field_part};

use crate::height::{Bounds, Ground};
use bounds::Pyramid;

pub use csv::{Layout, read_csv};

/// Fewest points along a side: those of one polynomial of degree 5.
pub const FEWEST: usize = 6;

/// A smooth height through points `z[row][column]` at `x = x₀ + column Δx`, `y = y₀ + row Δy`.
#[derive(Clone, Debug)]
pub struct Grid {
    name: String,
    origin: [f64; 2],
    spacing: [f64; 2],
    coefficients: Arc<Table>,
    pyramid: Arc<Pyramid>,
}

/// Numbers by row and column.
#[derive(Clone, Debug)]
pub(crate) struct Table {
    pub columns: usize,
    pub rows: usize,
    pub values: Vec<f64>,
}

impl Table {
    fn get(&self, column: usize, row: usize) -> f64 {
        self.values[row * self.columns + column]
    }
}

/// Why heights make no ground. Rows and columns count from 1.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GridError {
    /// Not enough points for a spline of degree 5.
    #[error("the grid `{name}` has {rows} row(s) and {columns} column(s); at least {FEWEST} of each are needed")]
    TooSmall {
        /// Name of the grid.
        name: String,
        /// Number of rows.
        rows: usize,
        /// Number of columns.
        columns: usize,
    },
    /// A row that is shorter or longer than the first.
    #[error("the grid `{name}` has {found} height(s) in row {row}, but {expected} in row 1")]
    Ragged {
        /// Name of the grid.
        name: String,
        /// The row.
        row: usize,
        /// Its heights.
        found: usize,
        /// Heights of the first row.
        expected: usize,
    },
    /// A hole: a height that is missing or not finite.
    #[error("the grid `{name}` has no height in row {row}, column {column} (`{found}`); fill the hole")]
    Hole {
        /// Name of the grid.
        name: String,
        /// Row of the hole.
        row: usize,
        /// Column of the hole.
        column: usize,
        /// What is there.
        found: String,
    },
    /// A spacing that is none, or an origin.
    #[error("the grid `{name}` has the {what} {value:?} m; it must be finite, and a spacing positive")]
    Frame {
        /// Name of the grid.
        name: String,
        /// Spacing or origin.
        what: &'static str,
        /// Along x and y.
        value: [f64; 2],
    },
    /// Points whose spacing is not even.
    #[error(
        "the grid `{name}` is uneven along {axis}: {found} m between {axis} = {from} m and the next, but {expected} m \
         between the first two"
    )]
    Uneven {
        /// Name of the grid.
        name: String,
        /// Axis.
        axis: char,
        /// Where, m.
        from: f64,
        /// Spacing there, m.
        found: f64,
        /// Spacing of the first two, m.
        expected: f64,
    },
    /// A point that is there twice.
    #[error("the grid `{name}` has the point x = {x} m, y = {y} m twice, the second time in line {line}")]
    Twice {
        /// Name of the grid.
        name: String,
        /// Place, m.
        x: f64,
        /// Place, m.
        y: f64,
        /// Line of the file.
        line: u64,
    },
    /// A file that cannot be read.
    #[error("the grid `{name}` cannot be read: {reason}")]
    Read {
        /// Name of the grid.
        name: String,
        /// Why.
        reason: String,
    },
}

impl Grid {
    /// Through heights by rows, m; rows go along y, columns along x.
    ///
    /// # Errors
    /// [`GridError`] names row and column.
    pub fn new(name: &str, origin: [f64; 2], spacing: [f64; 2], heights: &[Vec<f64>]) -> Result<Self, GridError> {
        check(name, origin, spacing, heights)?;
        let (rows, columns) = (heights.len(), heights[0].len());
        let along_x = band::Interpolation::new(columns);
        let along_y = band::Interpolation::new(rows);
        let by_row: Vec<Vec<f64>> = heights.iter().map(|row| along_x.coefficients(row)).collect();
        let mut table = Table { columns: columns + 4, rows: rows + 4, values: vec![0.0; (columns + 4) * (rows + 4)] };
        for column in 0..columns + 4 {
            let through: Vec<f64> = by_row.iter().map(|row| row[column]).collect();
            for (row, c) in along_y.coefficients(&through).into_iter().enumerate() {
                table.values[row * table.columns + column] = c;
            }
        }
        let pyramid = Arc::new(Pyramid::new(&table, spacing));
        Ok(Self { name: name.into(), origin, spacing, coefficients: Arc::new(table), pyramid })
    }

    /// The same ground in other units: `z` times `by[2]` at `x` times `by[0]`, `y` times `by[1]`; factors positive for x and y.
    pub fn scaled(&self, by: [f64; 3]) -> Self {
        let mut table = (*self.coefficients).clone();
        table.values.iter_mut().for_each(|c| *c *= by[2]);
        let spacing = [0, 1].map(|i| self.spacing[i] * by[i]);
        let pyramid = Arc::new(Pyramid::new(&table, spacing));
        let origin = [0, 1].map(|i| self.origin[i] * by[i]);
        Self { name: self.name.clone(), origin, spacing, coefficients: Arc::new(table), pyramid }
    }

    /// The rectangle of the points, m: `[x₀, x₁], [y₀, y₁]`.
    pub fn extent(&self) -> [[f64; 2]; 2] {
        let points = [self.coefficients.columns - 4, self.coefficients.rows - 4];
        [0, 1].map(|i| [self.origin[i], self.origin[i] + self.spacing[i] * (points[i] - 1) as f64])
    }

    /// What it goes through: the place of the first point, m, the distances of columns and rows, m, and the heights by rows.
    pub fn points(&self) -> ([f64; 2], [f64; 2], Vec<Vec<f64>>) {
        let along = |axis: usize, i: usize| self.origin[axis] + self.spacing[axis] * i as f64;
        let mut height = [0.0];
        let rows = (0..self.coefficients.rows - 4).map(|row| {
            let columns = (0..self.coefficients.columns - 4).map(|column| {
                self.eval([along(0, column), along(1, row), 0.0], 0, &mut height);
                height[0]
            });
            columns.collect()
        });
        (self.origin, self.spacing, rows.collect())
    }

    /// Bounds over all of the points' rectangle: how high it is, how sharp it bends.
    pub fn overall(&self) -> Bounds {
        let [x, y] = self.extent();
        self.bounds(x, y)
    }
}

fn check(name: &str, origin: [f64; 2], spacing: [f64; 2], heights: &[Vec<f64>]) -> Result<(), GridError> {
    let name = || name.to_string();
    for (value, what, positive) in [(origin, "origin", false), (spacing, "spacing", true)] {
        if value.iter().any(|x| !x.is_finite() || (positive && *x <= 0.0)) {
            return Err(GridError::Frame { name: name(), what, value });
        }
    }
    let columns = heights.first().map_or(0, Vec::len);
    for (i, row) in heights.iter().enumerate() {
        if row.len() != columns {
            return Err(GridError::Ragged { name: name(), row: i + 1, found: row.len(), expected: columns });
        }
        if let Some(j) = row.iter().position(|z| !z.is_finite()) {
            let found = row[j].to_string();
            return Err(GridError::Hole { name: name(), row: i + 1, column: j + 1, found });
        }
    }
    if heights.len() < FEWEST || columns < FEWEST {
        return Err(GridError::TooSmall { name: name(), rows: heights.len(), columns });
    }
    Ok(())
}

/// Pieces of B, times 120, from the coefficient that is leaving to the one that is coming: powers of the place in a cell.
const PIECES: [[f64; 6]; 6] = [
    [1.0, -5.0, 10.0, -10.0, 5.0, -1.0],
    [26.0, -50.0, 20.0, 20.0, -20.0, 5.0],
    [66.0, 0.0, -60.0, 0.0, 30.0, -10.0],
    [26.0, 50.0, 20.0, -20.0, -20.0, 10.0],
    [1.0, 5.0, 10.0, 10.0, 5.0, -5.0],
    [0.0, 0.0, 0.0, 0.0, 0.0, 1.0],
];

/// Six neighbouring coefficients along an axis and their weights.
struct Window {
    first: usize,
    /// `weights[order][coefficient]`, of the derivatives by place.
    weights: [[f64; 6]; 4],
}

impl Window {
    /// At a place in spacings from the first point, of so many stored coefficients.
    fn at(place: f64, spacing: f64, stored: usize, order: usize) -> Self {
        let cell = place.floor();
        let t = place - cell;
        // stored coefficients begin two before the first point, a cell's six do so too
        let first = cell.clamp(0.0, (stored - 6) as f64);
        let mut weights = [[0.0; 6]; 4];
        for (k, piece) in PIECES.iter().enumerate() {
            // outside, c_i = c_end + (i - end) (c_end - c_before)
            let at = cell - first + k as f64;
            let (end, next, beyond) = match at {
                at if at < 0.0 => (0, 1, -at),
                at if at > 5.0 => (5, 4, at - 5.0),
                at => (at as usize, 0, 0.0),
            };
            let mut unit = 1.0 / 120.0;
            for (m, weights) in weights.iter_mut().enumerate().take(order + 1) {
                let w = unit * derivative(piece, t, m);
                weights[end] += w * (1.0 + beyond);
                weights[next] -= w * beyond;
                unit /= spacing;
            }
        }
        Self { first: first as usize, weights }
    }
}

/// The `m`-th derivative of a polynomial of degree 5, `m ≤ 3`.
fn derivative(powers: &[f64; 6], t: f64, m: usize) -> f64 {
    const FACTORS: [[f64; 6]; 4] = [
        [1.0, 1.0, 1.0, 1.0, 1.0, 1.0],
        [0.0, 1.0, 2.0, 3.0, 4.0, 5.0],
        [0.0, 0.0, 2.0, 6.0, 12.0, 20.0],
        [0.0, 0.0, 0.0, 6.0, 24.0, 60.0],
    ];
    (m..6).rev().fold(0.0, |sum, k| sum * t + powers[k] * FACTORS[m][k])
}

impl Field for Grid {
    fn name(&self) -> &str {
        &self.name
    }

    fn variables(&self) -> usize {
        2
    }

    /// Of the height and of its second derivatives, which lie between the bends along all directions.
    fn range(&self, boxed: [Interval; 3], part: usize) -> Interval {
        let [x, y] = [0, 1].map(|i| [boxed[i].lo, boxed[i].hi]);
        if [x, y].iter().flatten().any(|place| !place.is_finite()) {
            return Interval::WHOLE;
        }
        const VALUE: usize = field_part(0, 0, 0);
        const SECOND: [usize; 3] = [field_part(2, 0, 0), field_part(0, 2, 0), field_part(1, 1, 0)];
        let Bounds { height, bend: [least, most] } = self.bounds(x, y);
        match SECOND.iter().position(|second| *second == part) {
            None if part == VALUE => Interval::new(height[0], height[1]),
            None => Interval::WHOLE,
            Some(2) => Interval::new(0.5 * (least - most), 0.5 * (most - least)),
            Some(_) => Interval::new(least, most),
        }
    }

    fn eval(&self, point: [f64; 3], order: usize, out: &mut [f64]) {
        let table = &*self.coefficients;
        let place = |i: usize| (point[i] - self.origin[i]) / self.spacing[i];
        if !(place(0).is_finite() && place(1).is_finite()) {
            out[..FIELD_PARTS[order]].fill(f64::NAN);
            return;
        }
        out[..FIELD_PARTS[order]].fill(0.0);
        let x = Window::at(place(0), self.spacing[0], table.columns, order);
        let y = Window::at(place(1), self.spacing[1], table.rows, order);
        for row in 0..6 {
            let from = (y.first + row) * table.columns + x.first;
            let c = &table.values[from..from + 6];
            for i in 0..=order {
                let sum: f64 = c.iter().zip(&x.weights[i]).map(|(c, w)| c * w).sum();
                for j in 0..=order - i {
                    out[field_part(i, j, 0)] += sum * y.weights[j][row];
                }
            }
        }
    }
}

impl Ground for Grid {
    fn bounds(&self, x: [f64; 2], y: [f64; 2]) -> Bounds {
        let places = |axis: usize, range: [f64; 2]| range.map(|v| (v - self.origin[axis]) / self.spacing[axis]);
        self.pyramid.bounds(places(0, x), places(1, y))
    }
}
