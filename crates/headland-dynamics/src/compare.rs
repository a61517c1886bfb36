//! The two derivations at random states: the check that comes for nothing.

use headland_expr::NodeId;
use headland_model::Model;

use crate::direct::MassForm;
use crate::error::DeriveError;
use crate::sample::spread_inputs;

/// Compares M and F of two derivations at several states; gives the largest relative difference.
///
/// # Errors
/// [`DeriveError::Disagreement`] if they differ by more than rounding explains.
pub fn compare_derivations(model: &Model, direct: &MassForm<'_>, combined: &MassForm<'_>) -> Result<f64, DeriveError> {
    let graph = &model.graph;
    let ids = |form: &MassForm<'_>| -> Vec<NodeId> { form.m.iter().chain(&form.f).map(|e| graph.id(*e)).collect() };
    let (a, b) = (ids(direct), ids(combined));
    let mut worst = 0.0_f64;
    for k in 0..5 {
        let inputs = spread_inputs(model, k);
        let (x, y) = (graph.eval(&a, &inputs), graph.eval(&b, &inputs));
        let split = direct.m.len();
        for range in [0..split, split..x.len()] {
            let size = range.clone().map(|i| x[i].abs().max(y[i].abs())).fold(0.0, f64::max);
            for i in range {
                let difference = (x[i] - y[i]).abs() / size.max(f64::MIN_POSITIVE);
                if !difference.is_finite() {
                    continue; // outside the domain
                }
                worst = worst.max(difference);
                if difference > 1e-8 {
                    let what = if i < split { format!("M, entry {i}") } else { format!("F, entry {}", i - split) };
                    return Err(DeriveError::Disagreement { what, direct: x[i], combined: y[i] });
                }
            }
        }
    }
    Ok(worst)
}
