//! [`Equations`]: the equations of motion, written down and evaluated.

use std::sync::{Mutex, PoisonError};

use headland::dynamics::DeriveError;
use headland::sim::StateEvaluator;
use headland::{Algorithm, DeriveOptions, Form, StateFunction, StateFunctions, equations_text, initial_state};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::arrays::{Argument, states};
use crate::errors::{derive_error, names_class, state_class};

/// States from which the interpreter is let go while they are evaluated.
const MANY: usize = 32;

/// `q′ = G u + g`, `M u′ = F`, for the independent rates that suit the start. Threads may share it.
#[pyclass(module = "headland", frozen)]
pub(crate) struct Equations {
    derived: Mutex<Derived>,
    functions: StateFunctions,
    /// Scratch that no thread uses at present.
    idle: Mutex<Vec<StateEvaluator>>,
    q: Vec<String>,
    u: Vec<String>,
    algorithm: &'static str,
    why: String,
    freedom: String,
    start: Result<(f64, Vec<f64>), DeriveError>,
}

struct Derived {
    model: headland::Model,
    equations: headland::Equations,
}

impl Equations {
    pub(crate) fn derive(py: Python<'_>, model: headland::Model, algorithm: Algorithm) -> PyResult<Self> {
        let (model, derived) = py.detach(move || {
            let derived = headland::derive(&model, &DeriveOptions { algorithm, ..DeriveOptions::default() });
            let derived = derived.map(|equations| (StateFunctions::new(&model, &equations), equations));
            (model, derived)
        });
        let (functions, equations) = derived.map_err(|e| derive_error(py, &model, &e))?;
        Ok(Self {
            functions,
            idle: Mutex::default(),
            q: model.coordinates.iter().map(|c| c.name.clone()).collect(),
            u: equations.kinematics.quasi.iter().map(|u| u.name.clone()).collect(),
            algorithm: equations.algorithm,
            why: equations.why.clone(),
            freedom: equations.freedom(&model),
            start: initial_state(&model, &equations).map(|y| (model.run.from, y)),
            derived: Mutex::new(Derived { model, equations }),
        })
    }

    fn eval<'py>(
        &self,
        py: Python<'py>,
        what: StateFunction,
        t: &Bound<'py, PyAny>,
        q: &Bound<'py, PyAny>,
        u: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let states = states(t, &Argument::vector("q", q, &self.q)?, &Argument::vector("u", u, &self.u)?)?;
        let (rows, columns) = self.functions.shape(what);
        let mut out = vec![0.0; states.t.len() * rows * columns];
        let mut evaluate = || {
            let idle = || self.idle.lock().unwrap_or_else(PoisonError::into_inner);
            let taken = idle().pop();
            let mut evaluator = taken.unwrap_or_else(|| self.functions.evaluator());
            evaluator.eval(what, &states.t, &states.y, &mut out);
            idle().push(evaluator);
        };
        if states.t.len() < MANY {
            evaluate()
        } else {
            py.detach(evaluate)
        }
        let values = PyArray1::from_vec(py, out);
        let is_matrix = matches!(what, StateFunction::Mass | StateFunction::Jacobian);
        Ok(match (states.many, is_matrix) {
            (false, false) => values.into_any(),
            (false, true) => values.reshape([rows, columns])?.into_any(),
            (true, false) => values.reshape([states.t.len(), rows])?.into_any(),
            (true, true) => values.reshape([states.t.len(), rows, columns])?.into_any(),
        })
    }
}

#[pymethods]
impl Equations {
    /// Mass matrix M.
    fn mass<'py>(
        &self,
        py: Python<'py>,
        t: &Bound<'py, PyAny>,
        q: &Bound<'py, PyAny>,
        u: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        self.eval(py, StateFunction::Mass, t, q, u)
    }

    /// Right-hand side F of `M u' = F`.
    fn force<'py>(
        &self,
        py: Python<'py>,
        t: &Bound<'py, PyAny>,
        q: &Bound<'py, PyAny>,
        u: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        self.eval(py, StateFunction::Force, t, q, u)
    }

    /// `u' = M⁻¹ F`.
    fn acceleration<'py>(
        &self,
        py: Python<'py>,
        t: &Bound<'py, PyAny>,
        q: &Bound<'py, PyAny>,
        u: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        self.eval(py, StateFunction::Accelerations, t, q, u)
    }

    /// Rates of the coordinates, `q' = G u + g`.
    fn rates<'py>(
        &self,
        py: Python<'py>,
        t: &Bound<'py, PyAny>,
        q: &Bound<'py, PyAny>,
        u: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        self.eval(py, StateFunction::Rates, t, q, u)
    }

    /// Exact Jacobian `∂[q', u']/∂[q, u]`.
    fn jacobian<'py>(
        &self,
        py: Python<'py>,
        t: &Bound<'py, PyAny>,
        q: &Bound<'py, PyAny>,
        u: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        self.eval(py, StateFunction::Jacobian, t, q, u)
    }

    /// The equations as text, LaTeX or C.
    #[pyo3(signature = (form = "text"))]
    fn text(&self, py: Python<'_>, form: &str) -> PyResult<String> {
        let form = match form {
            "text" => Form::Text,
            "latex" => Form::Latex,
            "c" => Form::C,
            other => {
                let message = format!("form is `{other}`; expected `text`, `latex` or `c`");
                return Err(PyValueError::new_err(message));
            }
        };
        Ok(py.detach(|| {
            let derived = self.derived.lock().unwrap_or_else(PoisonError::into_inner);
            equations_text(&derived.model, &derived.equations, form)
        }))
    }

    /// The start of the scene: `t`, `q`, `u`.
    #[getter]
    fn state0<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        match &self.start {
            Ok((t, y)) => {
                let (q, u) = y.split_at(self.q.len());
                state_class(py)?.call1((*t, PyArray1::from_slice(py, q), PyArray1::from_slice(py, u)))
            }
            Err(error) => {
                let derived = self.derived.lock().unwrap_or_else(PoisonError::into_inner);
                Err(derive_error(py, &derived.model, error))
            }
        }
    }

    /// Names of the states: coordinates q, quasi-velocities u.
    #[getter]
    fn names<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        names_class(py)?.call1((self.q.clone(), self.u.clone()))
    }

    /// The algorithm that was kept: `direct` or `combine`.
    #[getter]
    fn algorithm(&self) -> &'static str {
        self.algorithm
    }

    /// Why that one.
    #[getter]
    fn why(&self) -> &str {
        &self.why
    }

    /// Degrees of freedom in a sentence.
    #[getter]
    fn freedom(&self) -> &str {
        &self.freedom
    }

    fn __repr__(&self) -> String {
        format!("<headland.Equations: {}>", self.freedom)
    }
}
