//! Reference problems (being written).

/// How one problem went.
pub struct CaseResult {
    /// Its name.
    pub name: String,
    /// Largest error over tolerance.
    pub ratio: f64,
}

impl CaseResult {
    /// Whether it is within tolerance.
    pub fn passed(&self) -> bool {
        self.ratio <= 1.0
    }
}

/// Names of all problems.
pub fn names() -> Vec<&'static str> {
    Vec::new()
}

/// Runs the problems whose names contain one of the given ones.
pub fn run(_names: &[String]) -> Vec<CaseResult> {
    Vec::new()
}

/// As a table.
pub fn to_table(_results: &[CaseResult]) -> String {
    String::new()
}

/// As JSON.
pub fn to_json(_results: &[CaseResult]) -> String {
    String::new()
}
