//! [`Scene`]: a scene file, read and changed.

use headland::model::{Data, Value};
use pyo3::exceptions::{PyKeyError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyList, PyString};

use crate::arrays::number as plain_number;
use crate::errors::scene_error;
use crate::model::Model;

/// Sections in which a plain name is looked for, in this order: those of `headland::Scene::set`.
const SEARCHED: [&str; 5] = ["parameters", "prescribed", "definitions", "initial", "indices"];

/// What a scene file says. Reading it tells everything that is wrong with its form, `build` all the rest.
#[pyclass(module = "headland")]
pub(crate) struct Scene {
    scene: headland::Scene,
}

#[pymethods]
impl Scene {
    /// Read a scene file.
    #[staticmethod]
    #[pyo3(text_signature = "(path)")]
    fn load(py: Python<'_>, path: &Bound<'_, PyAny>) -> PyResult<Self> {
        let path = py.import("pathlib")?.call_method1("Path", (path,))?;
        let text: String = path.call_method1("read_text", ("utf-8",))?.extract()?; // Python's own errors for files
        Self::parse(py, &text, &path.str()?.to_string())
    }

    /// Read a scene from a text; `name` stands for the file in messages.
    #[staticmethod]
    #[pyo3(signature = (text, name = "scene"))]
    fn parse(py: Python<'_>, text: &str, name: &str) -> PyResult<Self> {
        let scene = headland::Scene::parse(name, text).map_err(|e| scene_error(py, &e))?;
        Ok(Self { scene })
    }

    /// Change a value, as `--set NAME=VALUE` does: a number, a quantity, an expression, an array.
    fn set(&mut self, py: Python<'_>, name: &str, value: &Bound<'_, PyAny>) -> PyResult<()> {
        let text = setting(name, value, 0)?;
        self.scene.set(name, &text).map_err(|e| scene_error(py, &e))
    }

    fn __setitem__(&mut self, py: Python<'_>, name: &str, value: &Bound<'_, PyAny>) -> PyResult<()> {
        self.set(py, name, value)
    }

    /// The value as it is written now: a number, a text, a list.
    fn __getitem__<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        let plain = || SEARCHED.iter().find_map(|section| self.scene.get(section, name));
        let keyed = || name.split_once('.').and_then(|(section, key)| self.scene.get(section, key));
        match plain().or_else(keyed) {
            Some(value) => to_python(py, value),
            None => Err(PyKeyError::new_err(name.to_string())),
        }
    }

    /// Make a model: names, units, families, dimensions are checked, all errors told in one `SceneError`.
    fn build(&self, py: Python<'_>) -> PyResult<Model> {
        let model = py.detach(|| self.scene.build()).map_err(|e| scene_error(py, &e))?;
        Ok(Model::new(model))
    }

    /// A copy that can be changed without changing this one.
    fn copy(&self) -> Self {
        Self { scene: self.scene.clone() }
    }

    fn __copy__(&self) -> Self {
        self.copy()
    }

    fn __deepcopy__(&self, _memo: &Bound<'_, PyAny>) -> Self {
        self.copy()
    }

    /// The title.
    #[getter]
    fn title(&self) -> &str {
        let title = self.scene.top.iter().find(|e| e.key == "title").map(|e| &e.value.data);
        if let Some(Data::Text(title)) = title { title } else { "" }
    }

    /// The name of the file, or that given to `parse`.
    #[getter]
    fn name(&self) -> &str {
        &self.scene.source.name
    }

    fn __repr__(&self) -> String {
        format!("<headland.Scene {:?}>", self.title())
    }
}

/// A value as the command line writes it. Numbers keep all their digits.
fn setting(name: &str, value: &Bound<'_, PyAny>, depth: usize) -> PyResult<String> {
    if let Ok(text) = value.cast::<PyString>() {
        return Ok(text.to_string());
    }
    if let Ok(flag) = value.cast::<PyBool>() {
        return Ok(flag.is_true().to_string());
    }
    if let Some(x) = plain_number(value) {
        return number(name, x);
    }
    let is_sequence = depth < 4 && value.hasattr("__len__")? && !value.hasattr("keys")?;
    if let (true, Ok(members)) = (is_sequence, value.try_iter()) {
        let members: Vec<String> = members.map(|m| setting(name, &m?, depth + 1)).collect::<PyResult<_>>()?;
        return Ok(format!("[{}]", members.join(", ")));
    }
    match value.extract() {
        Ok(x) => number(name, x), // NumPy's numbers, fractions
        Err(_) => Err(PyTypeError::new_err(format!(
            "`{name}` is set to a number, a text (quantity or expression) or a sequence of these, not to {}",
            value.get_type().name()?
        ))),
    }
}

fn number(name: &str, x: f64) -> PyResult<String> {
    if !x.is_finite() {
        return Err(PyValueError::new_err(format!("`{name}` is set to {x}, which is no finite number")));
    }
    Ok(format!("{x:?}"))
}

fn to_python<'py>(py: Python<'py>, value: &Value) -> PyResult<Bound<'py, PyAny>> {
    Ok(match &value.data {
        Data::Number(x) => x.into_pyobject(py)?.into_any(),
        Data::Text(text) => text.into_pyobject(py)?.into_any(),
        Data::Flag(flag) => flag.into_pyobject(py)?.to_owned().into_any(),
        Data::Array(values) => {
            let members: Vec<_> = values.iter().map(|v| to_python(py, v)).collect::<PyResult<_>>()?;
            PyList::new(py, members)?.into_any()
        }
        Data::Table(entries) => {
            let table = pyo3::types::PyDict::new(py);
            for entry in entries {
                table.set_item(&entry.key, to_python(py, &entry.value)?)?;
            }
            table.into_any()
        }
    })
}
