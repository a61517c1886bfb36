//! [`Model`]: checked and frozen; runs, and gives its equations.

use std::ffi::CString;
use std::sync::{Mutex, PoisonError};

use headland::{Algorithm, Run, RunOptions, Status, summary};
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::exceptions::{PyKeyboardInterrupt, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::number;
use crate::equations::Equations;
use crate::errors::{diagnostic, interrupted, result_class, run_error, start_error, warning_class};
use crate::interrupt::Signals;

/// A checked scene, ready to run. It is never changed: many threads may run it at once.
#[pyclass(module = "headland", frozen)]
pub(crate) struct Model {
    /// Nothing is derived from this one but from clones: a derivation adds to the graph, so the second would differ.
    model: Mutex<headland::Model>,
}

impl Model {
    pub(crate) fn new(model: headland::Model) -> Self {
        Self { model: Mutex::new(model) }
    }

    fn with<T>(&self, f: impl FnOnce(&headland::Model) -> T) -> T {
        f(&self.model.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

#[pymethods]
impl Model {
    /// Derive, compile, integrate.
    #[pyo3(signature = (
        *, until = None, tolerance = None, at = None, method = None, points = None, max_step = None, balance = true
    ))]
    fn run<'py>(
        &self,
        py: Python<'py>,
        until: Option<f64>,
        tolerance: Option<f64>,
        at: Option<&Bound<'py, PyAny>>,
        method: Option<String>,
        points: Option<usize>,
        max_step: Option<f64>,
        balance: bool,
    ) -> PyResult<Bound<'py, PyAny>> {
        let at = at.map(times).transpose()?;
        let model = self.with(headland::Model::clone);
        let mut options = RunOptions::of(&model);
        if let Some(last) = at.iter().flatten().copied().reduce(f64::max) {
            options.until = last;
        }
        options.at = at;
        options.until = finite("until", until)?.unwrap_or(options.until);
        options.tolerance = finite("tolerance", tolerance)?.unwrap_or(options.tolerance);
        options.max_step = finite("max_step", max_step)?.unwrap_or(options.max_step);
        options.method = method.unwrap_or(options.method);
        options.points = points.unwrap_or(options.points);
        options.balance = balance;
        if options.points == 0 {
            return Err(PyValueError::new_err("points is 0; expected at least one output interval"));
        }
        let (model, run, raised) = py.detach(move || {
            let mut signals = Signals::new();
            let run = headland::run(&model, &options, &mut signals);
            (model, run, signals.raised)
        });
        let run = run.map_err(|e| start_error(py, &model, &e))?;
        for entry in run.report.log.iter().filter(|entry| entry.message.starts_with("warning: ")) {
            let text = format!("t = {} s: {}", entry.t, entry.message.trim_start_matches("warning: "));
            PyErr::warn(py, warning_class(py)?, &CString::new(text.replace('\0', ""))?, 1)?;
        }
        let status = run.report.status.clone();
        let t_end = run.report.t_end;
        let result = to_result(py, run)?;
        match (raised, status) {
            (Some(raised), _) if raised.is_instance_of::<PyKeyboardInterrupt>(py) => {
                Err(interrupted(py, &format!("interrupted at t = {t_end} s"), result))
            }
            (Some(raised), _) => {
                let _ = raised.value(py).setattr("result", result); // a handler's own exception
                Err(raised)
            }
            (None, Status::Failed(reason)) => Err(run_error(py, &reason, result)),
            (None, _) => Ok(result),
        }
    }

    /// Derive the equations of motion.
    #[pyo3(signature = (algorithm = "cheaper"))]
    fn equations(&self, py: Python<'_>, algorithm: &str) -> PyResult<Equations> {
        let algorithm = match algorithm {
            "cheaper" => Algorithm::Cheaper,
            "direct" => Algorithm::Direct,
            "combine" => Algorithm::Combine,
            other => {
                let message = format!("algorithm is `{other}`; expected `cheaper`, `direct` or `combine`");
                return Err(PyValueError::new_err(message));
            }
        };
        Equations::derive(py, self.with(headland::Model::clone), algorithm)
    }

    /// The title of the scene.
    #[getter]
    fn title(&self) -> String {
        self.with(|m| m.title.clone())
    }

    /// Names of the coordinates; the prescribed ones are no states and are left out.
    #[getter]
    fn coordinates(&self) -> Vec<String> {
        self.with(|m| m.coordinates.iter().map(|c| c.name.clone()).collect())
    }

    /// Parameters with their values in SI units.
    #[getter]
    fn parameters<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let parameters: Vec<(String, f64)> =
            self.with(|m| m.parameters.iter().map(|p| (p.name.clone(), p.value)).collect());
        let dict = PyDict::new(py);
        parameters.into_iter().try_for_each(|(name, value)| dict.set_item(name, value))?;
        Ok(dict)
    }

    /// Names of the columns that a run gives.
    #[getter]
    fn columns(&self) -> Vec<String> {
        self.with(|m| m.outputs.iter().map(|o| o.name.clone()).collect())
    }

    /// What deserves attention but is not wrong.
    #[getter]
    fn warnings<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyAny>>> {
        let (source, warnings) = self.with(|m| (m.source.clone(), m.warnings.clone()));
        warnings.iter().map(|d| diagnostic(py, &source, d)).collect()
    }

    fn __repr__(&self) -> String {
        self.with(|m| format!("<headland.Model {:?}: {} coordinates>", m.title, m.coordinates.len()))
    }
}

/// One time or a sequence of times.
fn times(at: &Bound<'_, PyAny>) -> PyResult<Vec<f64>> {
    let times: Vec<f64> = match number(at) {
        Some(t) => vec![t],
        None => at.try_iter()?.map(|t| t?.extract::<f64>()).collect::<PyResult<_>>()?,
    };
    times.into_iter().map(|t| finite("at", Some(t)).map(|_| t)).collect()
}

fn finite(name: &str, x: Option<f64>) -> PyResult<Option<f64>> {
    match x {
        Some(x) if !x.is_finite() => Err(PyValueError::new_err(format!("{name} is {x}; expected a finite number"))),
        x => Ok(x),
    }
}

/// `headland.Result`: arrays, names, units, the summary as JSON.
fn to_result(py: Python<'_>, run: Run) -> PyResult<Bound<'_, PyAny>> {
    let Run { trajectory, report } = run;
    let (rows, columns) = (trajectory.t.len(), trajectory.names.len());
    let data = PyArray1::from_vec(py, trajectory.rows.concat()).reshape([rows, columns])?;
    let data: Bound<'_, PyArray2<f64>> = data;
    let t = PyArray1::from_vec(py, trajectory.t);
    result_class(py)?.call1((t, data, trajectory.names, trajectory.units, summary(&report).to_string()))
}
