//! [`Signals`]: lets Python's signal handlers end a run.

use std::time::{Duration, Instant};

use headland::Observer;
use pyo3::prelude::*;

/// How often signals are looked at: a step may take a microsecond, and looking needs the interpreter.
const INTERVAL: Duration = Duration::from_millis(50);

/// Looks at pending signals between steps; an exception raised by a handler ends the run.
pub(crate) struct Signals {
    looked: Instant,
    /// What a handler raised.
    pub(crate) raised: Option<PyErr>,
}

impl Signals {
    pub(crate) fn new() -> Self {
        Self { looked: Instant::now(), raised: None }
    }
}

impl Observer for Signals {
    fn stop(&mut self) -> Option<String> {
        if self.looked.elapsed() < INTERVAL {
            return None;
        }
        self.raised = Python::attach(|py| py.check_signals()).err();
        self.looked = Instant::now();
        self.raised.as_ref().map(|_| "interrupted".into())
    }
}
