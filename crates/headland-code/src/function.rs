//! [`Function`] and [`Evaluator`]: what every back end offers.

use headland_expr::{Graph, NodeId};

/// `y = f(x)`, compiled: immutable, shared between threads, cheap to clone.
///
/// Every back end computes what [`Graph::eval`] computes, to the last bit (a NaN is a NaN, its payload is free), and
/// proves it by passing [`evaluator_tests!`](crate::evaluator_tests).
pub trait Function: Clone + Send + Sync {
    /// The scratch that evaluates it.
    type Evaluator: Evaluator;

    /// Compiles the given nodes as outputs `y`; `x` are all inputs of the graph, in its order.
    ///
    /// Only what the outputs need is compiled. Outputs may repeat, and may be inputs or constants.
    fn compile(graph: &Graph, outputs: &[NodeId]) -> Self;

    /// Length of `x`.
    fn inputs(&self) -> usize;

    /// Length of `y`.
    fn outputs(&self) -> usize;

    /// Number of operations of the graph that the outputs need; constants and inputs are free.
    fn operations(&self) -> usize;

    /// The same function without what the other outputs needed; output `k` is output `keep[k]` of before.
    ///
    /// The values do not change, to the last bit.
    ///
    /// # Panics
    /// If an index is not that of an output.
    fn keep_outputs(&self, keep: &[usize]) -> Self;

    /// The same function with some inputs fixed, `(index, value)`, and folded away.
    ///
    /// The others keep their numbers: `x` is as long as before and the fixed entries are ignored. Folding
    /// simplifies, so the values agree with those of before to rounding, not to the last bit.
    ///
    /// # Panics
    /// If an index is not that of an input.
    fn bind(&self, known: &[(usize, f64)]) -> Self;

    /// New scratch; one a thread.
    fn evaluator(&self) -> Self::Evaluator;
}

/// Owns the slots of one thread, and the function with them.
pub trait Evaluator: Send {
    /// `y = f(x)` at one point. Allocates nothing.
    ///
    /// # Panics
    /// If `x.len()` is not the number of inputs.
    fn eval(&mut self, x: &[f64]) -> &[f64];

    /// Many points at once, `x[input][point]`; the result is `y[output][point]`.
    ///
    /// The same bits as [`eval`](Self::eval) point by point. Allocates nothing once it has seen as many points. A
    /// function without inputs is evaluated at one point.
    ///
    /// # Panics
    /// If `x.len()` is not the number of inputs, or its rows differ in length.
    fn eval_many(&mut self, x: &[&[f64]]) -> &[Vec<f64>];
}
