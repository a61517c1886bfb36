//! The two derivations at random states: the check that comes for nothing.

use headland_expr::{Expr, NodeId, Scalar};
use headland_model::Model;

use crate::direct::MassForm;
use crate::error::DeriveError;
use crate::sample::spread_inputs;
use crate::structures::Structures;

/// Compares M and F of two derivations at several states; gives the largest difference, relative to the largest entry
/// and, in F, to what is added up there: forces that cancel leave nothing but rounding.
///
/// # Errors
/// [`DeriveError::Disagreement`] if they differ by more than rounding explains.
pub fn compare_derivations(
    model: &Model,
    direct: &MassForm<'_>,
    combined: &MassForm<'_>,
    s: &Structures<'_>,
) -> Result<f64, DeriveError> {
    let graph = &model.graph;
    let added = summands(model, direct.f.len(), s);
    let ids = |form: &MassForm<'_>| -> Vec<NodeId> { form.m.iter().chain(&form.f).map(|e| graph.id(*e)).collect() };
    let (a, b) = (ids(direct), ids(combined));
    let mut worst = 0.0_f64;
    for k in 0..5 {
        let inputs = spread_inputs(model, k);
        let (x, y) = (graph.eval(&a, &inputs), graph.eval(&b, &inputs));
        let split = direct.m.len();
        for range in [0..split, split..x.len()] {
            let mut size = range.clone().map(|i| x[i].abs().max(y[i].abs())).fold(0.0, f64::max);
            if range.start == split {
                size = graph.eval(&added, &inputs).into_iter().filter(|x| x.is_finite()).fold(size, f64::max);
            }
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

/// `Σ |W| (|J bias| + |P|)`, one a quasi-velocity.
fn summands(model: &Model, n: usize, s: &Structures<'_>) -> Vec<NodeId> {
    let size = |e: usize| (s.inertia[e] * s.bias[e]).abs() + s.force[e].abs();
    let sum = |k: usize| (0..s.w.len()).fold(Expr::Const(0.0), |sum, e| sum + s.w[e][k].abs() * size(e));
    (0..n).map(|k| model.graph.id(sum(k))).collect()
}
