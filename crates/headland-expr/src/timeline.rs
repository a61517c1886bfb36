//! [`Timeline`]: what an integrator must know about the functions of time in a graph before it steps over them.
//!
//! `kinks` finds where they or their derivatives may jump, `windows` where they vary quickly; both by
//! bisection over intervals, which cannot miss what lies between two samples.

mod kinks;
mod tape;
mod windows;

use crate::graph::{Graph, NodeId};
use crate::ops::Op;

/// Functions of time in a graph, as [`timeline`] finds them.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Timeline {
    /// Times, growing, at which a function of time or one of its derivatives may jump; steps should end there.
    pub breakpoints: Vec<f64>,
    /// Spans in which a function of time varies quickly; they may overlap, the smallest step then holds.
    pub windows: Vec<Window>,
}

/// A span of time in which steps must not be long.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    /// Its beginning.
    pub start: f64,
    /// Its end.
    pub end: f64,
    /// The longest step that resolves what happens in it.
    pub longest_step: f64,
    /// Whether a step that comes from before must end at `start`; not so where the span is most of all time.
    pub stop: bool,
}

/// Work that a search may spend, in evaluations of one operation on an interval with its derivative (some 100 ns each).
const BUDGET: usize = 120_000;

/// Breakpoints and windows of the functions of time below `roots`, between `t0` and `t1`.
///
/// `time_input` is time's place among the inputs; inputs for which `varying` holds are states, and what depends on them
/// is no function of time; the others have the values given in `inputs`. Breakpoints are where the condition of a
/// branch or the argument of `abs` or `sign` changes sign or `atan2` passes its cut, where the operands of `min` or `max` are
/// equal, and where the argument of a table passes a point of it; a condition that is not zero in reality but within
/// rounding may add one. A window is published where the fastest function would go through half of its range in a step
/// much shorter than the whole span; what is faster than `1e-9` of the span is taken for a jump or a pole and left to the
/// integrator's error control, and so are fields: they are smooth, and known at points only. The work is bounded: past a few thousand breakpoints or leaves, coarser windows stand for the rest.
///
/// ```
/// use headland_expr::{Expr, Graph, Scalar, timeline::timeline};
///
/// let graph = Graph::new();
/// let t = graph.input("t");
/// let load = Expr::select(t - Expr::Const(3.0), Expr::Const(1.0), Expr::Const(0.0));
/// let found = timeline(&graph, &[graph.id(load)], 0, &[0.0], |_| false, 0.0, 10.0);
/// assert_eq!(found.breakpoints, [3.0]);
/// assert!(found.windows.is_empty());
/// ```
///
/// # Panics
/// If fewer inputs are given than the graph has.
pub fn timeline(
    graph: &Graph,
    roots: &[NodeId],
    time_input: usize,
    inputs: &[f64],
    varying: impl Fn(usize) -> bool,
    t0: f64,
    t1: f64,
) -> Timeline {
    let (t0, t1) = (t0.min(t1), t0.max(t1));
    if !(t0 < t1 && (t1 - t0).is_finite()) {
        return Timeline::default();
    }
    let kinds = Kinds::new(graph, roots, time_input, &varying);
    if !kinds.any_time {
        return Timeline::default();
    }
    let values = kinds.values(graph, inputs);
    let span = Span { t0, t1 };
    let (breakpoints, mut windows) = kinks::find(graph, &kinds, &values, span);
    windows.extend(windows::find(graph, &kinds, &values, roots, span, &breakpoints));
    Timeline { breakpoints, windows: windows::join(windows, span) }
}

/// The time looked at.
#[derive(Clone, Copy)]
struct Span {
    t0: f64,
    t1: f64,
}

impl Span {
    fn length(self) -> f64 {
        self.t1 - self.t0
    }
    /// What is shorter than this counts as an instant.
    fn instant(self) -> f64 {
        (1e-9 * self.length()).max(4.0 * f64::EPSILON * self.t0.abs().max(self.t1.abs()))
    }
}

/// What a node depends on.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Kind {
    /// Not needed.
    Unused,
    /// On parameters only.
    Fixed,
    /// On time, not on states.
    Time,
    /// On states.
    State,
}

/// The kind of each node below the roots.
struct Kinds {
    kind: Vec<Kind>,
    any_time: bool,
}

impl Kinds {
    fn new(graph: &Graph, roots: &[NodeId], time_input: usize, varying: &dyn Fn(usize) -> bool) -> Self {
        let needed = graph.needed(roots);
        let arena = graph.arena().borrow();
        let mut kind = vec![Kind::Unused; needed.len()];
        for i in (0..needed.len()).filter(|&i| needed[i]) {
            let node = arena.nodes[i];
            kind[i] = match node.op {
                Op::Input if node.args[0] as usize == time_input => Kind::Time,
                Op::Input if varying(node.args[0] as usize) => Kind::State,
                // Numbers at points bound nothing between them: what a field makes of time is the error control's.
                Op::Field if node.operands().any(|a| kind[a.index()] != Kind::Fixed) => Kind::State,
                _ => node.operands().map(|a| kind[a.index()]).max().unwrap_or(Kind::Fixed),
            };
        }
        let any_time = kind.contains(&Kind::Time);
        Self { kind, any_time }
    }

    fn of(&self, id: NodeId) -> Kind {
        self.kind[id.index()]
    }

    /// Ids of needed nodes.
    fn nodes(&self) -> impl Iterator<Item = NodeId> + '_ {
        let used = |&i: &usize| self.kind[i] != Kind::Unused;
        (0..self.kind.len()).filter(used).map(|i| NodeId(i as u32))
    }

    /// Values of the fixed nodes.
    fn values(&self, graph: &Graph, inputs: &[f64]) -> Vec<f64> {
        let arena = graph.arena().borrow();
        let mut value = vec![0.0; self.kind.len()];
        for i in (0..self.kind.len()).filter(|&i| self.kind[i] == Kind::Fixed) {
            value[i] = arena.eval_node(arena.nodes[i], inputs, |a| value[a as usize]);
        }
        value
    }
}

#[cfg(test)]
mod tests;
