//! Results as a table and as JSON.

use std::fmt::Write;

use crate::case::{CaseResult, Moment};

/// An aligned table, one problem a line; a failed one is followed by what was worst.
#[must_use]
pub fn to_table(results: &[CaseResult]) -> String {
    let width = results.iter().map(|r| r.name.len()).max().unwrap_or(0).max("problem".len());
    let mut text = format!(
        "{:width$}  {:>6}  {:>9}  {:>9}  {:>9}  {:>9}  result\n",
        "problem", "values", "error", "allowed", "balance", "time"
    );
    for r in results {
        let number = |x: Option<f64>| x.map_or("–".to_string(), |x| format!("{x:.1e}"));
        let _ = writeln!(
            text,
            "{:width$}  {:>6}  {:>9}  {:>9}  {:>9}  {:>6.0} ms  {}",
            r.name,
            r.compared,
            number(r.worst.as_ref().map(|w| w.error)),
            number(r.worst.as_ref().map(|w| w.allowed)),
            number(r.energy_balance),
            r.seconds * 1e3,
            if r.passed() { "ok".to_string() } else { format!("FAILED: {}", why(r)) }
        );
    }
    let failed = results.iter().filter(|r| !r.passed()).count();
    let values: usize = results.iter().map(|r| r.compared).sum();
    let _ = writeln!(text, "{} problems, {values} values, {failed} failed", results.len());
    text
}

/// What was worst.
fn why(r: &CaseResult) -> String {
    if let Some(failure) = &r.failure {
        return failure.clone();
    }
    match (&r.worst, r.energy_balance) {
        (Some(w), _) if w.ratio() > 1.0 => {
            let when = match w.moment {
                Moment::At(t) => format!("at t = {t} s"),
                Moment::Least => "(least)".into(),
                Moment::Most => "(most)".into(),
            };
            format!("{} {when} is {:.12e}, reference {:.12e}", w.quantity, w.value, w.reference)
        }
        (_, Some(defect)) => format!("work and energy differ by {defect:.1e}, allowed {:.1e}", r.allowed_balance),
        _ => "nothing was compared".into(),
    }
}

/// The results as JSON, one object a problem.
#[must_use]
pub fn to_json(results: &[CaseResult]) -> String {
    let list: Vec<serde_json::Value> = results
        .iter()
        .map(|r| {
            let mut object = serde_json::to_value(r).unwrap_or_default();
            object["passed"] = r.passed().into();
            object
        })
        .collect();
    format!("{:#}", serde_json::Value::from(list))
}
