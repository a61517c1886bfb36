//! [`Program`]: the part of a graph that the outputs need, in a form that threads can share.
//!
//! A [`Graph`] grows behind a `RefCell` and carries an index for hash-consing; a program is the bare nodes, packed.

use std::sync::Arc;

use headland_expr::graph::Node;
use headland_expr::ops::apply;
use headland_expr::{Expr, Field, Graph, NodeId, Op, Scalar, Spline};

/// Nodes in evaluation order, each needed by an output; `args` are positions in this program.
#[derive(Debug, Default)]
pub(crate) struct Program {
    pub(crate) inputs: usize,
    pub(crate) nodes: Vec<Node>,
    pub(crate) numbers: Vec<f64>,
    pub(crate) splines: Vec<Arc<Spline>>,
    pub(crate) fields: Vec<Arc<dyn Field>>,
    pub(crate) outputs: Vec<u32>,
}

impl Program {
    /// What the outputs need, packed.
    pub(crate) fn from_graph(graph: &Graph, outputs: &[NodeId]) -> Self {
        let end = outputs.iter().map(|id| id.index() + 1).max().unwrap_or(0);
        let mut needed: Vec<Option<(NodeId, Node)>> = vec![None; end];
        for &id in outputs {
            needed[id.index()] = Some((id, graph.node(id)));
        }
        for i in (0..end).rev() {
            if let Some((_, node)) = needed[i] {
                for operand in node.operands() {
                    needed[operand.index()].get_or_insert_with(|| (operand, graph.node(operand)));
                }
            }
        }
        let number = |id: Option<NodeId>| id.and_then(|id| graph.constant_value(id)).expect("a constant has a number");
        pack(
            graph.input_count(),
            needed.iter().map(|n| n.map(|(_, node)| node)),
            |position, _| number(needed[position].map(|(id, _)| id)),
            |table| graph.spline(table),
            |field| graph.field(field),
            outputs.iter().map(|id| id.index()),
        )
    }

    /// The program of some of the outputs.
    pub(crate) fn keep_outputs(&self, keep: &[usize]) -> Self {
        let mut needed = vec![false; self.nodes.len()];
        for &k in keep {
            needed[self.outputs[k] as usize] = true;
        }
        for i in (0..needed.len()).rev() {
            if needed[i] {
                for operand in self.nodes[i].operands() {
                    needed[operand.index()] = true;
                }
            }
        }
        pack(
            self.inputs,
            needed.iter().zip(&self.nodes).map(|(needed, node)| needed.then_some(*node)),
            |_, index| self.numbers[index as usize],
            |table| self.splines[table as usize].clone(),
            |field| self.fields[usize::from(field)].clone(),
            keep.iter().map(|&k| self.outputs[k] as usize),
        )
    }

    /// The program with some inputs fixed, rebuilt through a graph so that everything folds.
    pub(crate) fn bind(&self, known: &[(usize, f64)]) -> Self {
        let graph = Graph::new();
        let mut x: Vec<Expr<'_>> = (0..self.inputs).map(|i| graph.input(&format!("x{i}"))).collect();
        for &(i, value) in known {
            assert!(i < self.inputs, "bind: input {i} of {}", self.inputs);
            x[i] = Expr::Const(value);
        }
        let outputs: Vec<NodeId> = self.eval(&x).into_iter().map(|e| graph.id(e)).collect();
        Self::from_graph(&graph, &outputs)
    }

    /// Number of operations.
    pub(crate) fn operations(&self) -> usize {
        self.nodes.iter().filter(|node| node.op.arity() > 0).count()
    }

    /// The outputs over any scalar; over expressions it is a copy into another graph.
    fn eval<S: Scalar>(&self, x: &[S]) -> Vec<S> {
        let mut value: Vec<S> = Vec::with_capacity(self.nodes.len());
        for node in &self.nodes {
            let get = |k: usize| {
                if k < node.op.arity() { value[node.args[k] as usize] } else { S::constant(0.0) }
            };
            value.push(match node.op {
                Op::Const => S::constant(self.numbers[node.args[0] as usize]),
                Op::Input => x[node.args[0] as usize],
                Op::Powi => get(0).powi(node.exponent()),
                Op::Spline => get(0).spline(&self.splines[node.args[1] as usize], node.args[2] as u8),
                Op::Field => {
                    let point = [get(0), get(1), get(2)];
                    S::field(point, &self.fields[usize::from(node.field)], usize::from(node.part))
                }
                op => apply(op, get(0), get(1), get(2)),
            });
        }
        self.outputs.iter().map(|&i| value[i as usize]).collect()
    }
}

/// Renumbers the nodes that are there; `number(position, index)`, `spline(index)` and `field(index)` look up the immediates.
fn pack(
    inputs: usize,
    nodes: impl ExactSizeIterator<Item = Option<Node>>,
    number: impl Fn(usize, u32) -> f64,
    spline: impl Fn(u32) -> Arc<Spline>,
    field: impl Fn(u16) -> Arc<dyn Field>,
    outputs: impl Iterator<Item = usize>,
) -> Program {
    let mut place = vec![u32::MAX; nodes.len()];
    let mut tables: Vec<u32> = Vec::new(); // index of before
    let mut fields: Vec<u16> = Vec::new(); // the same
    let mut packed = Program { inputs, ..Program::default() };
    for (i, node) in nodes.enumerate() {
        let Some(mut node) = node else { continue };
        for k in 0..node.op.arity() {
            node.args[k] = place[node.args[k] as usize];
        }
        match node.op {
            Op::Const => {
                packed.numbers.push(number(i, node.args[0]));
                node.args[0] = packed.numbers.len() as u32 - 1;
            }
            Op::Spline => {
                let known = tables.iter().position(|&table| table == node.args[1]);
                let table = known.unwrap_or_else(|| {
                    tables.push(node.args[1]);
                    packed.splines.push(spline(node.args[1]));
                    tables.len() - 1
                });
                node.args[1] = table as u32;
            }
            Op::Field => {
                let known = fields.iter().position(|&field| field == node.field);
                let index = known.unwrap_or_else(|| {
                    fields.push(node.field);
                    packed.fields.push(field(node.field));
                    fields.len() - 1
                });
                node.field = index as u16;
            }
            _ => {}
        }
        place[i] = packed.nodes.len() as u32;
        packed.nodes.push(node);
    }
    packed.nodes.shrink_to_fit();
    packed.outputs.extend(outputs.map(|i| place[i]));
    packed
}
