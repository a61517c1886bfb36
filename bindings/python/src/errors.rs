//! One exception class a stage; the classes themselves are Python, in `headland/_errors.py`.

use headland::model::{Diagnostic, Place, Source};
use headland::{DeriveError, Model, ModelError, RunError};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyType;

/// A class of the package, imported once.
macro_rules! class {
    ($name:ident, $module:literal, $class:literal) => {
        pub(crate) fn $name(py: Python<'_>) -> PyResult<&Bound<'_, PyType>> {
            static CLASS: PyOnceLock<Py<PyType>> = PyOnceLock::new();
            CLASS.import(py, $module, $class)
        }
    };
}
class!(result_class, "headland._result", "Result");
class!(state_class, "headland._result", "State");
class!(names_class, "headland._result", "Names");
class!(diagnostic_class, "headland._errors", "Diagnostic");
class!(scene_error_class, "headland._errors", "SceneError");
class!(derive_error_class, "headland._errors", "DeriveError");
class!(solve_error_class, "headland._errors", "SolveError");
class!(run_error_class, "headland._errors", "RunError");
class!(interrupted_class, "headland._errors", "Interrupted");
class!(warning_class, "headland._errors", "RunWarning");

/// An exception of a class, or the exception that making it raised.
fn make<'py>(class: PyResult<&Bound<'py, PyType>>, args: impl pyo3::call::PyCallArgs<'py>) -> PyErr {
    match class.and_then(|class| class.call1(args)) {
        Ok(value) => PyErr::from_value(value),
        Err(error) => error,
    }
}

/// `file:line:column: message` with the line and a mark, as the program shows it.
pub(crate) fn show(source: &Source, diagnostic: &Diagnostic) -> String {
    match &diagnostic.place {
        Place::Setting(text) => format!("`{}`: {}", setting(text), diagnostic.message),
        _ => source.show(diagnostic),
    }
}

/// `NAME=VALUE`, without the option of the command line.
fn setting(text: &str) -> &str {
    text.trim_start_matches("--set ")
}

/// A diagnostic as Python's named tuple.
pub(crate) fn diagnostic<'py>(py: Python<'py>, source: &Source, d: &Diagnostic) -> PyResult<Bound<'py, PyAny>> {
    let (line, column) = match &d.place {
        Place::File(range) => {
            let (line, column) = source.position(range.start);
            (Some(line), Some(column))
        }
        _ => (None, None),
    };
    let set = match &d.place {
        Place::Setting(text) => Some(setting(text)),
        _ => None,
    };
    diagnostic_class(py)?.call1((&source.name, line, column, &d.message, set))
}

/// `SceneError` with all diagnostics.
pub(crate) fn scene_error(py: Python<'_>, error: &ModelError) -> PyErr {
    let shown: Vec<String> = error.diagnostics.iter().map(|d| show(&error.source, d)).collect();
    match error.diagnostics.iter().map(|d| diagnostic(py, &error.source, d)).collect::<PyResult<Vec<_>>>() {
        Ok(diagnostics) => make(scene_error_class(py), (shown.join("\n"), diagnostics)),
        Err(error) => error,
    }
}

/// `DeriveError`, with the place in the scene where there is one.
pub(crate) fn derive_error(py: Python<'_>, model: &Model, error: &DeriveError) -> PyErr {
    let message = error.to_string();
    let placed = error.place(model).map(|place| Diagnostic { place, message: message.clone() });
    let shown = placed.as_ref().map_or(message, |d| show(&model.source, d));
    match placed.map(|d| diagnostic(py, &model.source, &d)).transpose() {
        Ok(diagnostic) => make(derive_error_class(py), (shown, diagnostic)),
        Err(error) => error,
    }
}

/// Why a run could not start.
pub(crate) fn start_error(py: Python<'_>, model: &Model, error: &RunError) -> PyErr {
    match error {
        RunError::Derive(error) => derive_error(py, model, error),
        RunError::Solve(error) => make(solve_error_class(py), (error.to_string(),)),
        other => make(run_error_class(py), (other.to_string(),)),
    }
}

/// `RunError` of a run that failed on the way, with what it had computed.
pub(crate) fn run_error<'py>(py: Python<'py>, reason: &str, result: Bound<'py, PyAny>) -> PyErr {
    make(run_error_class(py), (reason, result))
}

/// `Interrupted`, a `KeyboardInterrupt` with what had been computed.
pub(crate) fn interrupted<'py>(py: Python<'py>, reason: &str, result: Bound<'py, PyAny>) -> PyErr {
    make(interrupted_class(py), (reason, result))
}
