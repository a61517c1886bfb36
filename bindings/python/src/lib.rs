//! headland for Python: the private module `headland._core`.
//!
//! Thin: a scene, a model, its equations, with NumPy arrays in and out. What is pleasant in Python and nowhere else (the
//! result of a run, the exceptions, named tuples) is written in Python, in `headland/`, and made from here.
//!
//! In order: [`scene`] reads and sets, [`model`] runs, [`equations`] evaluates; [`arrays`] takes states from NumPy,
//! [`errors`] makes one exception class a stage, [`interrupt`] lets a signal end a run.

mod arrays;
mod equations;
mod errors;
mod interrupt;
mod model;
mod scene;

use pyo3::prelude::*;

#[pymodule(gil_used = false)]
fn _core(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("methods", headland::method_names())?;
    module.add_class::<scene::Scene>()?;
    module.add_class::<model::Model>()?;
    module.add_class::<equations::Equations>()
}
