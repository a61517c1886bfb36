//! States from NumPy: one, or many with the points along the first axis.

use std::borrow::Cow;

use numpy::{AllowTypeChange, PyArrayLikeDyn, PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyFloat, PyInt};

/// Times and states `y = [q, u]`, row by row.
pub(crate) struct States {
    pub(crate) t: Vec<f64>,
    pub(crate) y: Vec<f64>,
    /// Whether there is an axis of points; without it there is one state.
    pub(crate) many: bool,
}

/// Joins `t`, `q`, `u`; what has no axis of points goes with every point.
pub(crate) fn states(t: &Bound<'_, PyAny>, q: &Argument<'_>, u: &Argument<'_>) -> PyResult<States> {
    let (q, u) = (q.rows(), u.rows());
    if let (Some(t), None, None) = (number(t), q.points, u.points) {
        return Ok(States { t: vec![t], y: [q.row(0), u.row(0)].concat(), many: false });
    }
    let times = Argument::times(t)?;
    let times = times.rows();
    let counts = [("t", times.points), ("q", q.points), ("u", u.points)];
    let given: Vec<(&str, usize)> = counts.iter().filter_map(|(name, n)| n.map(|n| (*name, n))).collect();
    let points = given.first().map_or(1, |(_, n)| *n);
    if let Some((name, n)) = given.iter().find(|(_, n)| *n != points) {
        let message = format!("`{}` has {points} points but `{name}` has {n}", given[0].0);
        return Err(PyValueError::new_err(message));
    }
    let (mut all_t, mut y) = (Vec::with_capacity(points), Vec::with_capacity(points * (q.length + u.length)));
    for p in 0..points {
        all_t.extend_from_slice(times.row(p));
        y.extend_from_slice(q.row(p));
        y.extend_from_slice(u.row(p));
    }
    Ok(States { t: all_t, y, many: !given.is_empty() })
}

/// A plain number; an array of one entry is none.
pub(crate) fn number(x: &Bound<'_, PyAny>) -> Option<f64> {
    let plain = x.is_instance_of::<PyFloat>() || x.is_instance_of::<PyInt>();
    plain.then(|| x.extract().ok()).flatten()
}

/// The entries of an argument, row by row.
struct Rows<'a> {
    values: Cow<'a, [f64]>,
    length: usize,
    points: Option<usize>,
}

impl Rows<'_> {
    fn row(&self, point: usize) -> &[f64] {
        match self.points {
            None => &self.values,
            Some(_) => &self.values[point * self.length..(point + 1) * self.length],
        }
    }
}

/// An array argument: a vector of known length, or one at each point.
pub(crate) struct Argument<'py> {
    array: PyReadonlyArrayDyn<'py, f64>,
    length: usize,
    points: Option<usize>,
}

impl<'py> Argument<'py> {
    /// A vector of so many entries, or many of them.
    pub(crate) fn vector(name: &str, value: &Bound<'py, PyAny>, names: &[String]) -> PyResult<Self> {
        let array = Self::read(name, value)?;
        let points = match array.shape() {
            [n] if *n == names.len() => None,
            [points, n] if *n == names.len() => Some(*points),
            shape => {
                let wanted = names.len();
                return Err(PyValueError::new_err(format!(
                    "`{name}` has the shape {shape:?}; expected [{wanted}], or [points, {wanted}]: {}",
                    names.join(", ")
                )));
            }
        };
        Ok(Self { array, length: names.len(), points })
    }

    /// One time or one for each point.
    fn times(value: &Bound<'py, PyAny>) -> PyResult<Self> {
        let array = Self::read("t", value)?;
        let points = match array.shape() {
            [] => None,
            [points] => Some(*points),
            shape => {
                return Err(PyValueError::new_err(format!(
                    "`t` has the shape {shape:?}; expected a number or [points]"
                )));
            }
        };
        Ok(Self { array, length: 1, points })
    }

    fn read(name: &str, value: &Bound<'py, PyAny>) -> PyResult<PyReadonlyArrayDyn<'py, f64>> {
        let array: PyArrayLikeDyn<'py, f64, AllowTypeChange> = value.extract().map_err(|e: PyErr| {
            PyValueError::new_err(format!("`{name}` cannot be read as an array of numbers: {e}"))
        })?;
        Ok((*array).clone())
    }

    /// In the order of rows, whatever the order in memory.
    fn rows(&self) -> Rows<'_> {
        let view = self.array.as_array();
        let values = match view.to_slice() {
            Some(all) => Cow::Borrowed(all),
            None => Cow::Owned(view.iter().copied().collect()),
        };
        Rows { values, length: self.length, points: self.points }
    }
}
