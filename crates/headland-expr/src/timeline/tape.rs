//! A few functions of time taken out of a graph, evaluated on numbers and on intervals with derivatives.

use std::cell::RefCell;

use rustc_hash::FxHashMap;

use super::{Kind, Kinds};
use crate::dual::Dual;
use crate::graph::{Graph, Node, NodeId};
use crate::interval::Interval;
use crate::ops::Op;
use crate::scalar::Scalar;

/// Functions of time: the fixed values they need and their operations, slot 0 being time.
pub(super) struct Tape<'a> {
    graph: &'a Graph,
    fixed: Vec<f64>,
    operations: Vec<Node>,
    outputs: Vec<usize>,
    numbers: RefCell<Vec<Dual<f64>>>,
    ranges: RefCell<Vec<Range>>,
}

/// Ranges of an output and of its derivative.
pub(super) type Range = Dual<Interval>;

impl<'a> Tape<'a> {
    /// The tape of the given time nodes.
    pub(super) fn new(graph: &'a Graph, kinds: &Kinds, values: &[f64], outputs: &[NodeId]) -> Self {
        let arena = graph.arena().borrow();
        let mut needed: Vec<u32> = Vec::new();
        let mut seen: FxHashMap<u32, u32> = FxHashMap::default(); // slots, once known
        let mut stack: Vec<u32> = outputs.iter().map(|id| id.0).collect();
        while let Some(i) = stack.pop() {
            if seen.insert(i, 0).is_none() {
                needed.push(i);
                if kinds.of(NodeId(i)) == Kind::Time {
                    stack.extend(arena.nodes[i as usize].operands().map(|a| a.0));
                }
            }
        }
        needed.sort_unstable();
        let (mut fixed, mut time) = (Vec::new(), Vec::new());
        for i in needed {
            match (kinds.of(NodeId(i)), arena.nodes[i as usize].op) {
                (Kind::Fixed, _) => {
                    fixed.push(values[i as usize]);
                    seen.insert(i, fixed.len() as u32);
                }
                (_, Op::Input) => {
                    seen.insert(i, 0);
                }
                _ => time.push(i),
            }
        }
        let first = 1 + fixed.len() as u32;
        let mut operations = Vec::with_capacity(time.len());
        for i in time {
            let mut node = arena.nodes[i as usize];
            for k in 0..node.op.arity() {
                node.args[k] = seen[&node.args[k]];
            }
            seen.insert(i, first + operations.len() as u32);
            operations.push(node);
        }
        let outputs = outputs.iter().map(|id| seen[&id.0] as usize).collect();
        Self { graph, fixed, operations, outputs, numbers: RefCell::default(), ranges: RefCell::default() }
    }

    /// Replaces the two outputs by their difference.
    pub(super) fn into_difference(mut self) -> Self {
        let args = [self.outputs[0] as u32, self.outputs[1] as u32, 0];
        self.operations.push(Node::new(Op::Sub, args));
        self.outputs = vec![self.fixed.len() + self.operations.len()];
        self
    }

    /// Cost of one evaluation, its bookkeeping included.
    pub(super) fn cost(&self) -> usize {
        self.operations.len() + 4
    }

    fn run<S: Scalar>(&self, t: Dual<S>, slots: &mut Vec<Dual<S>>) {
        let arena = self.graph.arena().borrow();
        slots.clear();
        slots.push(t);
        slots.extend(self.fixed.iter().map(|&x| Dual::new(S::constant(x), S::constant(0.0))));
        for &node in &self.operations {
            let value = arena.eval_node(node, &[], |a| slots[a as usize]);
            slots.push(value);
        }
    }

    /// Values and derivatives at an instant.
    pub(super) fn at(&self, t: f64) -> Vec<Dual<f64>> {
        let slots = &mut *self.numbers.borrow_mut();
        self.run(Dual::new(t, 1.0), slots);
        self.outputs.iter().map(|&slot| slots[slot]).collect()
    }

    /// The first output at an instant.
    pub(super) fn first_at(&self, t: f64) -> Dual<f64> {
        let slots = &mut *self.numbers.borrow_mut();
        self.run(Dual::new(t, 1.0), slots);
        slots[self.outputs[0]]
    }

    /// Ranges over a span; derivatives are those between jumps, and `false` comes with them if one may be inside.
    pub(super) fn over(&self, from: f64, to: f64) -> (Vec<Range>, bool) {
        let slots = &mut *self.ranges.borrow_mut();
        self.run(Dual::new(Interval::new(from, to), Interval::constant(1.0)), slots);
        let smooth = self.operations.iter().all(|node| self.smooth(node, slots));
        (self.outputs.iter().map(|&slot| slots[slot]).collect(), smooth)
    }

    /// Whether an operation cannot jump for the operands it has.
    fn smooth(&self, node: &Node, slots: &[Dual<Interval>]) -> bool {
        let operand = |k: usize| slots[node.args[k] as usize].value;
        match node.op {
            Op::Select => operand(0).lo >= 0.0 || operand(0).hi < 0.0,
            Op::Sign => operand(0).lo > 0.0 || operand(0).hi < 0.0,
            Op::Atan2 => !operand(0).contains(0.0) || operand(1).lo > 0.0,
            Op::Spline if node.args[2] >= 3 => {
                let table = self.graph.arena().borrow().splines[node.args[1] as usize].clone();
                !table.knots().iter().any(|&x| operand(0).contains(x))
            }
            _ => true,
        }
    }
}
