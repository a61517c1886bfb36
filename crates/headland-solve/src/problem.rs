//! What an integrator is handed: functions of `(t, y)`, and nothing of where they come from.

use std::fmt;

/// Why a function could not be evaluated.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum EvalFailure {
    /// Outside the function's domain: the integrator tries a smaller step.
    Recoverable,
    /// Nothing will help: the integrator gives up at once.
    Fatal,
}

/// An initial value problem `ẏ = f(t, y)` with events and a constraint manifold.
///
/// ```text
/// ẏ = f(t, y)        J = ∂f/∂y        event i: g_i(t, y) changes sign        y on { c(t, y) = 0 }
/// ```
/// Only [`len`](Self::len) and [`rhs`](Self::rhs) are needed; everything else has a default. The
/// functions take `&mut self`, so that a problem can own its scratch memory. A value that is NaN or
/// infinite counts as [`EvalFailure::Recoverable`].
pub trait OdeProblem {
    /// Number of components of `y`.
    fn len(&self) -> usize;

    /// Whether there are no components at all.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Writes `ẏ = f(t, y)`.
    ///
    /// # Errors
    /// If `f` cannot be evaluated there.
    fn rhs(&mut self, t: f64, y: &[f64], dy: &mut [f64]) -> Result<(), EvalFailure>;

    /// Where `∂f/∂y` may differ from zero; `None` means that there is no exact Jacobian, and that
    /// implicit methods take differences of [`rhs`](Self::rhs). Must not change between two starts.
    fn pattern(&self) -> Option<&Pattern> {
        None
    }

    /// Writes the values of `∂f/∂y` in the order of [`pattern`](Self::pattern).
    ///
    /// # Errors
    /// If the Jacobian cannot be evaluated there.
    fn jacobian(&mut self, t: f64, y: &[f64], values: &mut [f64]) -> Result<(), EvalFailure> {
        let _ = (t, y, values);
        Err(EvalFailure::Fatal)
    }

    /// Number of event functions. Must not change between two starts.
    fn event_count(&self) -> usize {
        0
    }

    /// Writes the event functions `g(t, y)`.
    ///
    /// # Errors
    /// If they cannot be evaluated there; as the step is accepted by then, this ends the run.
    fn events(&mut self, t: f64, y: &[f64], g: &mut [f64]) -> Result<(), EvalFailure> {
        let _ = (t, y, g);
        Ok(())
    }

    /// Whether [`project`](Self::project) is to be called after each step.
    fn has_projection(&self) -> bool {
        false
    }

    /// Writes the correction `Δ` that brings `y + Δ` back to the constraint manifold.
    ///
    /// # Errors
    /// If no such correction is found: the step is tried again, smaller.
    fn project(&mut self, t: f64, y: &[f64], correction: &mut [f64]) -> Result<(), EvalFailure> {
        let _ = (t, y);
        correction.fill(0.0);
        Ok(())
    }

    /// Name of a component, for messages.
    fn component_name(&self, i: usize) -> String {
        format!("y[{i}]")
    }

    /// Name of an event function, for messages.
    fn event_name(&self, i: usize) -> String {
        format!("event[{i}]")
    }
}

/// Sparsity of a matrix, compressed by columns.
///
/// The rows of column `j` are `row_idx[col_ptr[j]..col_ptr[j + 1]]`, ascending; values are kept in
/// the same order.
///
/// ```
/// let p = headland_solve::Pattern::from_entries(2, 2, [(1, 0), (0, 1), (1, 1)]);
/// assert_eq!(p.col_ptr(), [0, 1, 3]);
/// assert_eq!(p.row_idx(), [1, 0, 1]);
/// ```
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Pattern {
    rows: usize,
    col_ptr: Vec<usize>,
    row_idx: Vec<usize>,
}

impl Pattern {
    /// From its compressed columns.
    ///
    /// # Panics
    /// If `col_ptr` does not have `cols + 1` ascending entries from 0 to `row_idx.len()`, or if the
    /// rows of a column are not strictly ascending and below `rows`.
    #[must_use]
    pub fn new(rows: usize, cols: usize, col_ptr: Vec<usize>, row_idx: Vec<usize>) -> Self {
        assert_eq!(col_ptr.len(), cols + 1, "col_ptr needs cols + 1 entries");
        assert_eq!(col_ptr[0], 0, "col_ptr starts at 0");
        assert_eq!(col_ptr[cols], row_idx.len(), "col_ptr ends at row_idx.len()");
        for (j, ends) in col_ptr.windows(2).enumerate() {
            assert!(ends[0] <= ends[1], "col_ptr falls at column {j}");
            let column = &row_idx[ends[0]..ends[1]];
            assert!(
                column.windows(2).all(|r| r[0] < r[1]) && column.last().is_none_or(|&r| r < rows),
                "rows of column {j} must be strictly ascending and below {rows}"
            );
        }
        Self { rows, col_ptr, row_idx }
    }

    /// From pairs `(row, column)` in any order; repeated pairs count once.
    ///
    /// # Panics
    /// If a pair lies outside the matrix.
    #[must_use]
    pub fn from_entries(rows: usize, cols: usize, entries: impl IntoIterator<Item = (usize, usize)>) -> Self {
        let mut pairs: Vec<(usize, usize)> = entries.into_iter().map(|(r, c)| (c, r)).collect();
        pairs.sort_unstable();
        pairs.dedup();
        let mut col_ptr = vec![0; cols + 1];
        for &(c, r) in &pairs {
            assert!(r < rows && c < cols, "entry ({r}, {c}) is outside {rows} × {cols}");
            col_ptr[c + 1] += 1;
        }
        for j in 0..cols {
            col_ptr[j + 1] += col_ptr[j];
        }
        let row_idx = pairs.into_iter().map(|(_, r)| r).collect();
        Self::new(rows, cols, col_ptr, row_idx)
    }

    /// Every entry of a `rows × cols` matrix.
    #[must_use]
    pub fn dense(rows: usize, cols: usize) -> Self {
        let col_ptr = (0..=cols).map(|j| j * rows).collect();
        let row_idx = (0..cols).flat_map(|_| 0..rows).collect();
        Self::new(rows, cols, col_ptr, row_idx)
    }

    /// Number of rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of columns.
    #[must_use]
    pub fn cols(&self) -> usize {
        self.col_ptr.len() - 1
    }

    /// Number of entries.
    #[must_use]
    pub fn nnz(&self) -> usize {
        self.row_idx.len()
    }

    /// Where each column starts in [`row_idx`](Self::row_idx), and the end of the last.
    #[must_use]
    pub fn col_ptr(&self) -> &[usize] {
        &self.col_ptr
    }

    /// Row of each entry.
    #[must_use]
    pub fn row_idx(&self) -> &[usize] {
        &self.row_idx
    }

    /// The entries `(row, column)` in their order.
    pub fn entries(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        (0..self.cols())
            .flat_map(move |j| self.row_idx[self.col_ptr[j]..self.col_ptr[j + 1]].iter().map(move |&r| (r, j)))
    }
}

/// Which function was being evaluated.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[non_exhaustive]
pub enum Function {
    /// [`OdeProblem::rhs`]
    Rhs,
    /// [`OdeProblem::jacobian`]
    Jacobian,
    /// [`OdeProblem::events`]
    Events,
    /// [`OdeProblem::project`]
    Projection,
    /// `DaeProblem::residual`
    Residual,
    /// `DaeProblem::start_residual`
    StartResidual,
}

impl fmt::Display for Function {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Rhs => "right-hand side",
            Self::Jacobian => "Jacobian",
            Self::Events => "event functions",
            Self::Projection => "projection onto the constraints",
            Self::Residual => "residual of the equations",
            Self::StartResidual => "residual of the conditions on the start",
        })
    }
}
