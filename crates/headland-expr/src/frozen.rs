//! [`Frozen`]: expressions of a graph that nothing changes any more, to be evaluated from any thread over any scalar.

use crate::graph::{Arena, Graph, NodeId};
use crate::scalar::Scalar;

/// Some expressions of a graph, with all that they need.
///
/// ```
/// use headland_expr::{Frozen, Graph, Interval};
///
/// let graph = Graph::new();
/// let x = graph.input("x");
/// let square = Frozen::new(&graph, &[graph.id(x * x), graph.id(x + x)]);
/// assert_eq!(square.eval(2, &[3.0]), [9.0, 6.0]);
/// let bounds = square.eval(1, &[Interval::new(1.0, 2.0)])[0];
/// assert!(bounds.contains(1.0) && bounds.contains(4.0) && !bounds.contains(4.1));
/// ```
pub struct Frozen {
    arena: Arena,
    roots: Vec<NodeId>,
}

impl std::fmt::Debug for Frozen {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Frozen({} expressions, {} nodes)", self.roots.len(), self.arena.nodes.len())
    }
}

impl Frozen {
    /// Of the given nodes.
    pub fn new(graph: &Graph, roots: &[NodeId]) -> Self {
        let copy = Graph::new();
        let inputs: Vec<_> = (0..graph.input_count()).map(|i| copy.input(&graph.input_name(i))).collect();
        let expressions = graph.rebuild(roots, &copy, |i| inputs[i]);
        let roots = expressions.into_iter().map(|e| copy.id(e)).collect();
        Self { arena: copy.into_arena(), roots }
    }

    /// Values of the first `count` expressions; inputs are those of the graph.
    ///
    /// # Panics
    /// If there are fewer expressions, or fewer inputs than they use.
    pub fn eval<S: Scalar>(&self, count: usize, inputs: &[S]) -> Vec<S> {
        let roots = &self.roots[..count];
        let end = roots.iter().map(|root| root.index() + 1).max().unwrap_or(0);
        let mut values = Vec::with_capacity(end);
        for &node in &self.arena.nodes[..end] {
            let value = self.arena.eval_node(node, inputs, |a| values[a as usize]);
            values.push(value);
        }
        roots.iter().map(|root| values[root.index()]).collect()
    }
}
