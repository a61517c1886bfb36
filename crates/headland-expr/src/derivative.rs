//! Derivatives of graphs, forward and reverse, as new expressions of the same graph.

use crate::expr::Expr;
use crate::field::field_derived;
use crate::graph::{Graph, Node, NodeId};
use crate::ops::{Op, partials};
use crate::scalar::Scalar;

/// Partial derivatives of one node with respect to its operands; `None` is zero.
fn node_partials<'g>(graph: &'g Graph, id: NodeId, node: Node) -> [Option<Expr<'g>>; 3] {
    let operand = |k: usize| if k < node.op.arity() { graph.expr(NodeId(node.args[k])) } else { Expr::Const(0.0) };
    match node.op {
        Op::Const | Op::Input => [None; 3],
        Op::Powi => {
            let n = node.exponent();
            [Some(Expr::Const(f64::from(n)) * operand(0).powi(n - 1)), None, None]
        }
        Op::Spline => {
            let order = node.args[2] as u8;
            [(order < 3).then(|| operand(0).spline(&graph.spline(node.args[1]), order + 1)), None, None]
        }
        Op::Field => {
            let (point, field) = ([operand(0), operand(1), operand(2)], graph.field(node.field));
            [0, 1, 2].map(|axis| match point[axis] {
                Expr::Const(_) => None,
                _ => Some(Expr::field(point, &field, field_derived(usize::from(node.part), axis))),
            })
        }
        op => partials(op, operand(0), operand(1), operand(2), graph.expr(id)),
    }
}

impl Graph {
    /// Directional derivatives `ẏ = Σ (∂y/∂xᵢ) ẋᵢ`, one forward pass over what the roots need.
    ///
    /// `seed(i)` is `ẋᵢ` of input `i`, or `None` for zero. Cost: about two new operations for each one that depends on a seed.
    pub fn tangent<'g>(&'g self, roots: &[NodeId], seed: impl Fn(usize) -> Option<Expr<'g>>) -> Vec<Expr<'g>> {
        let needed = self.needed(roots);
        let mut dot: Vec<Option<Expr<'g>>> = vec![None; needed.len()];
        for i in 0..needed.len() {
            if !needed[i] {
                continue;
            }
            let id = NodeId(i as u32);
            let node = self.node(id);
            if node.op == Op::Input {
                dot[i] = seed(node.args[0] as usize).filter(|e| !e.is(0.0));
                continue;
            }
            if node.operands().all(|a| dot[a.index()].is_none()) {
                continue;
            }
            if node.op == Op::Select {
                // Chosen, not multiplied by 0 and 1: the branch not taken may have no derivative.
                let branch = |k: usize| dot[node.args[k] as usize].unwrap_or(Expr::Const(0.0));
                dot[i] =
                    Some(Expr::select(self.expr(NodeId(node.args[0])), branch(1), branch(2))).filter(|e| !e.is(0.0));
                continue;
            }
            if let Some((double_angle, angle)) = self.squared_sine(node) {
                dot[i] = dot[angle.index()].map(|d| double_angle * d);
                continue;
            }
            let partial = node_partials(self, id, node);
            let mut sum = Expr::Const(0.0);
            for (k, operand) in node.operands().enumerate() {
                if let (Some(p), Some(d)) = (partial[k], dot[operand.index()]) {
                    sum = sum + p * d;
                }
            }
            dot[i] = (!sum.is(0.0)).then_some(sum);
        }
        roots.iter().map(|r| dot[r.index()].unwrap_or(Expr::Const(0.0))).collect()
    }

    /// For `sin² a` or `cos² a`: its derivative `±2 sin a cos a` by the angle, in one form for both so that they share it,
    /// and the angle.
    fn squared_sine(&self, node: Node) -> Option<(Expr<'_>, NodeId)> {
        if node.op != Op::Powi || node.exponent() != 2 {
            return None;
        }
        let inner = self.node(NodeId(node.args[0]));
        let angle = NodeId(inner.args[0]);
        let product = || Expr::Const(2.0) * (self.expr(angle).sin() * self.expr(angle).cos());
        match inner.op {
            Op::Sin => Some((product(), angle)),
            Op::Cos => Some((-product(), angle)),
            _ => None,
        }
    }

    /// Gradient `∂y/∂xᵢ` of one root with respect to the given inputs, one reverse pass.
    pub fn gradient<'g>(&'g self, root: NodeId, inputs: &[NodeId]) -> Vec<Expr<'g>> {
        let needed = self.needed(&[root]);
        let mut bar: Vec<Option<Expr<'g>>> = vec![None; needed.len()];
        bar[root.index()] = Some(Expr::Const(1.0));
        for i in (0..needed.len()).rev() {
            let Some(adjoint) = bar[i] else { continue };
            let id = NodeId(i as u32);
            let node = self.node(id);
            let partial = node_partials(self, id, node);
            for (k, operand) in node.operands().enumerate() {
                if let Some(p) = partial[k] {
                    let term = adjoint * p;
                    let slot = &mut bar[operand.index()];
                    *slot = Some(slot.map_or(term, |sum| sum + term));
                }
            }
        }
        let zero = Expr::Const(0.0);
        inputs.iter().map(|x| bar.get(x.index()).copied().flatten().unwrap_or(zero)).collect()
    }

    /// Sparse Jacobian `∂yᵢ/∂xⱼ`, column by column: `(row, column, derivative)`, structural zeros left out.
    ///
    /// One forward pass a column over the nodes that depend on it.
    pub fn jacobian<'g>(&'g self, roots: &[NodeId], inputs: &[NodeId]) -> Vec<(usize, usize, Expr<'g>)> {
        let mut entries = Vec::new();
        for (j, input) in inputs.iter().enumerate() {
            let index = self.node(*input).args[0] as usize;
            let column = self.tangent(roots, |i| (i == index).then_some(Expr::Const(1.0)));
            entries.extend(column.into_iter().enumerate().filter(|(_, e)| !e.is(0.0)).map(|(i, e)| (i, j, e)));
        }
        entries
    }
}
