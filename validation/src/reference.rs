//! Reference files: JSON with numbers as texts, so that no digit is lost before the comparison.

use serde_json::Value;

use crate::case::Expected;

/// A reference file, compiled in.
pub(crate) struct Reference(Value);

impl Reference {
    /// # Panics
    /// If the text is not JSON; the files are part of the crate.
    pub(crate) fn new(text: &str) -> Self {
        Self(serde_json::from_str(text).expect("reference files are JSON"))
    }

    /// The number at a JSON pointer.
    ///
    /// # Panics
    /// If there is none.
    pub(crate) fn number(&self, pointer: &str) -> f64 {
        let value = self.0.pointer(pointer);
        let number = match value {
            Some(Value::String(text)) => text.parse().ok(),
            Some(value) => value.as_f64(),
            None => None,
        };
        number.unwrap_or_else(|| panic!("no number at {pointer} of a reference file: {value:?}"))
    }

    /// `(key, column)` pairs at times that are keys below `pointer`.
    pub(crate) fn rows(&self, pointer: &str, times: &[&str], pairs: &[(&str, &str)]) -> Vec<Expected> {
        let mut expected = Vec::new();
        for t in times {
            let seconds = t.parse().expect("times are numbers");
            for (key, column) in pairs {
                expected.push(Expected::at(seconds, *column, self.number(&format!("{pointer}/{t}/{key}"))));
            }
        }
        expected
    }
}
