//! [`Graph`]: a hash-consed arena of operations, simplified as they are made.
//!
//! Equal operations are one node; operands stand before what uses them, so a loop over ids is an evaluation order and
//! nothing here recurses. Ids depend on the order of construction alone: the same model gives the same bytes.

use std::cell::RefCell;
use std::sync::Arc;

use rustc_hash::FxHashMap;

use crate::expr::Expr;
use crate::field::{FIELD_BEYOND, Field};
use crate::ops::{Op, apply};
use crate::scalar::Scalar;
use crate::spline::Spline;

/// Index of a node in its [`Graph`].
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct NodeId(pub(crate) u32);

impl NodeId {
    /// Position in the order of construction.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// One operation: 16 bytes. Immediate arguments stand in the operand fields.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct Node {
    /// The operator.
    pub op: Op,
    /// `Field`: the part, a [`field_part`](crate::field_part) or [`FIELD_BEYOND`]; else 0.
    pub part: u8,
    /// `Field`: index of the field; else 0.
    pub field: u16,
    /// Operands; `Const`: index of the number, `Input`: index of the input, `Powi`: operand and exponent,
    /// `Spline`: operand, table, order of the derivative; `Field`: the point.
    pub args: [u32; 3],
}

impl Node {
    /// A node without a field.
    pub(crate) fn new(op: Op, args: [u32; 3]) -> Self {
        Self { op, part: 0, field: 0, args }
    }
    /// Ids of the operands.
    pub fn operands(&self) -> impl Iterator<Item = NodeId> + use<> {
        let args = self.args;
        (0..self.op.arity()).map(move |i| NodeId(args[i]))
    }
    /// The exponent of a `Powi`.
    pub fn exponent(&self) -> i32 {
        self.args[1] as i32
    }
}

#[derive(Default)]
pub(crate) struct Arena {
    pub(crate) nodes: Vec<Node>,
    pub(crate) numbers: Vec<f64>,
    pub(crate) inputs: Vec<(String, NodeId)>,
    pub(crate) splines: Vec<Arc<Spline>>,
    pub(crate) fields: Vec<Arc<dyn Field>>,
    index: FxHashMap<Node, u32>,
    number_index: FxHashMap<u64, u32>,
}

/// A hash-consed graph of expressions. Cheap handles to it are [`Expr`]; stored ids are [`NodeId`].
#[derive(Default)]
pub struct Graph {
    arena: RefCell<Arena>,
}

impl std::fmt::Debug for Graph {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Graph({} nodes, {} inputs)", self.len(), self.input_count())
    }
}

impl Clone for Graph {
    fn clone(&self) -> Self {
        let a = self.arena.borrow();
        let arena = Arena {
            nodes: a.nodes.clone(),
            numbers: a.numbers.clone(),
            inputs: a.inputs.clone(),
            splines: a.splines.clone(),
            fields: a.fields.clone(),
            index: a.index.clone(),
            number_index: a.number_index.clone(),
        };
        Self { arena: RefCell::new(arena) }
    }
}

impl Graph {
    /// An empty graph.
    pub fn new() -> Self {
        Self::default()
    }

    /// A new input (variable); its index is the number of inputs before it.
    pub fn input(&self, name: &str) -> Expr<'_> {
        let mut arena = self.arena.borrow_mut();
        let index = arena.inputs.len() as u32;
        let id = arena.insert(Node::new(Op::Input, [index, 0, 0]));
        arena.inputs.push((name.to_string(), id));
        Expr::Node(self, id)
    }

    /// The handle of a stored id; a constant comes back as a number.
    pub fn expr(&self, id: NodeId) -> Expr<'_> {
        let arena = self.arena.borrow();
        let node = arena.nodes[id.index()];
        match node.op {
            Op::Const => Expr::Const(arena.numbers[node.args[0] as usize]),
            _ => Expr::Node(self, id),
        }
    }

    /// Handles of stored ids.
    pub fn exprs(&self, ids: &[NodeId]) -> Vec<Expr<'_>> {
        ids.iter().map(|&id| self.expr(id)).collect()
    }

    /// The id to store; a number becomes a node.
    pub fn id(&self, e: Expr<'_>) -> NodeId {
        match e {
            Expr::Const(x) => NodeId(self.arena.borrow_mut().number(x)),
            Expr::Node(graph, id) => {
                debug_assert!(std::ptr::eq(graph, self), "expression of another graph");
                id
            }
        }
    }

    /// Registers a table and gives its index.
    pub fn table(&self, spline: Arc<Spline>) -> u32 {
        let mut arena = self.arena.borrow_mut();
        if let Some(i) = arena.splines.iter().position(|s| **s == *spline) {
            return i as u32;
        }
        arena.splines.push(spline);
        (arena.splines.len() - 1) as u32
    }

    /// Registers a field and gives its index; the same `Arc` is the same field.
    ///
    /// # Panics
    /// If there are more than 65536 fields.
    pub fn register_field(&self, field: &Arc<dyn Field>) -> u16 {
        let mut arena = self.arena.borrow_mut();
        let known = arena.fields.iter().position(|f| Arc::ptr_eq(f, field));
        let index = known.unwrap_or_else(|| {
            arena.fields.push(field.clone());
            arena.fields.len() - 1
        });
        u16::try_from(index).expect("at most 65536 fields in a graph")
    }

    /// A registered field.
    pub fn field(&self, index: u16) -> Arc<dyn Field> {
        self.arena.borrow().fields[usize::from(index)].clone()
    }

    /// The first field, if there is one, of which the given nodes need a derivative beyond the third order: such nodes
    /// have no value (they evaluate to NaN), so whoever derives asks before evaluating.
    pub fn beyond_fields(&self, roots: &[NodeId]) -> Option<Arc<dyn Field>> {
        let needed = self.needed(roots);
        let arena = self.arena.borrow();
        let beyond = |node: &Node| node.op == Op::Field && usize::from(node.part) == FIELD_BEYOND;
        let first = needed.iter().zip(&arena.nodes).find(|(needed, node)| **needed && beyond(node));
        first.map(|(_, node)| arena.fields[usize::from(node.field)].clone())
    }

    /// The node at a position in the order of construction.
    ///
    /// # Panics
    /// If there are fewer nodes.
    pub fn node_at(&self, index: usize) -> NodeId {
        assert!(index < self.len(), "node {index} of {}", self.len());
        NodeId(index as u32)
    }

    /// Number of nodes.
    pub fn len(&self) -> usize {
        self.arena.borrow().nodes.len()
    }

    /// True before anything was made.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Number of inputs.
    pub fn input_count(&self) -> usize {
        self.arena.borrow().inputs.len()
    }

    /// Name of an input.
    pub fn input_name(&self, index: usize) -> String {
        self.arena.borrow().inputs[index].0.clone()
    }

    /// The node of an input.
    pub fn input_id(&self, index: usize) -> NodeId {
        self.arena.borrow().inputs[index].1
    }

    /// A copy of a node.
    pub fn node(&self, id: NodeId) -> Node {
        self.arena.borrow().nodes[id.index()]
    }

    /// The number of a constant node.
    pub fn constant_value(&self, id: NodeId) -> Option<f64> {
        let arena = self.arena.borrow();
        let node = arena.nodes[id.index()];
        (node.op == Op::Const).then(|| arena.numbers[node.args[0] as usize])
    }

    /// A registered table.
    pub fn spline(&self, index: u32) -> Arc<Spline> {
        self.arena.borrow().splines[index as usize].clone()
    }

    /// Marks what the given nodes need, themselves included; shape `[largest id + 1]`.
    pub fn needed(&self, roots: &[NodeId]) -> Vec<bool> {
        let arena = self.arena.borrow();
        let end = roots.iter().map(|r| r.index() + 1).max().unwrap_or(0);
        let mut needed = vec![false; end];
        for r in roots {
            needed[r.index()] = true;
        }
        for i in (0..end).rev() {
            if needed[i] {
                for operand in arena.nodes[i].operands() {
                    needed[operand.index()] = true;
                }
            }
        }
        needed
    }

    /// Number of operations (constants and inputs are free) that the given nodes need.
    pub fn operations(&self, roots: &[NodeId]) -> usize {
        let needed = self.needed(roots);
        let arena = self.arena.borrow();
        needed.iter().zip(&arena.nodes).filter(|(needed, node)| **needed && node.op.arity() > 0).count()
    }

    /// For each root, whether it depends on an input for which `is_seed` holds.
    pub fn depends(&self, roots: &[NodeId], is_seed: impl Fn(usize) -> bool) -> Vec<bool> {
        let needed = self.needed(roots);
        let arena = self.arena.borrow();
        let mut active = vec![false; needed.len()];
        for i in 0..needed.len() {
            if needed[i] {
                let node = arena.nodes[i];
                active[i] = match node.op {
                    Op::Input => is_seed(node.args[0] as usize),
                    _ => node.operands().any(|a| active[a.index()]),
                };
            }
        }
        roots.iter().map(|r| active[r.index()]).collect()
    }

    /// Evaluates over any scalar, in the order of construction: the reference semantics of a graph.
    ///
    /// # Panics
    /// If fewer inputs are given than the graph has.
    pub fn eval<S: Scalar>(&self, roots: &[NodeId], inputs: &[S]) -> Vec<S> {
        let needed = self.needed(roots);
        let arena = self.arena.borrow();
        let mut value = vec![S::constant(0.0); needed.len()];
        for i in 0..needed.len() {
            if needed[i] {
                value[i] = arena.eval_node(arena.nodes[i], inputs, |a| value[a as usize]);
            }
        }
        roots.iter().map(|r| value[r.index()]).collect()
    }

    /// Copies the given nodes into `target`, with each input replaced by what `input` gives; simplified again on the way.
    pub fn rebuild<'t>(&self, roots: &[NodeId], target: &'t Graph, input: impl Fn(usize) -> Expr<'t>) -> Vec<Expr<'t>> {
        let needed = self.needed(roots);
        let arena = self.arena.borrow();
        assert!(!std::ptr::eq(self, target), "rebuild needs another graph; use substitute");
        let mut copy: Vec<Expr<'t>> = vec![Expr::Const(0.0); needed.len()];
        for i in 0..needed.len() {
            if needed[i] {
                let node = arena.nodes[i];
                copy[i] = match node.op {
                    Op::Const => Expr::Const(arena.numbers[node.args[0] as usize]),
                    Op::Input => input(node.args[0] as usize),
                    Op::Powi => copy[node.args[0] as usize].powi(node.exponent()),
                    Op::Spline => {
                        copy[node.args[0] as usize].spline(&arena.splines[node.args[1] as usize], node.args[2] as u8)
                    }
                    Op::Field => {
                        let point = node.args.map(|a| copy[a as usize]);
                        Expr::field(point, &arena.fields[usize::from(node.field)], usize::from(node.part))
                    }
                    op => {
                        let operand =
                            |k: usize| if k < op.arity() { copy[node.args[k] as usize] } else { Expr::Const(0.0) };
                        apply(op, operand(0), operand(1), operand(2))
                    }
                };
            }
        }
        roots.iter().map(|r| copy[r.index()]).collect()
    }

    /// The given nodes with inputs replaced; `None` keeps an input.
    pub fn substitute<'g>(&'g self, roots: &[NodeId], input: impl Fn(usize) -> Option<Expr<'g>>) -> Vec<Expr<'g>> {
        let needed = self.needed(roots);
        let mut copy: Vec<Option<Expr<'g>>> = vec![None; needed.len()]; // None: unchanged
        for i in 0..needed.len() {
            if !needed[i] {
                continue;
            }
            let node = self.node(NodeId(i as u32));
            let get = |k: usize| copy[node.args[k] as usize].unwrap_or_else(|| self.expr(NodeId(node.args[k])));
            let changed = node.operands().any(|a| copy[a.index()].is_some());
            copy[i] = match node.op {
                Op::Const => None,
                Op::Input => input(node.args[0] as usize),
                _ if !changed => None,
                Op::Powi => Some(get(0).powi(node.exponent())),
                Op::Spline => Some(get(0).spline(&self.spline(node.args[1]), node.args[2] as u8)),
                Op::Field => {
                    Some(Expr::field([get(0), get(1), get(2)], &self.field(node.field), usize::from(node.part)))
                }
                op => {
                    let operand = |k: usize| if k < op.arity() { get(k) } else { Expr::Const(0.0) };
                    Some(apply(op, operand(0), operand(1), operand(2)))
                }
            };
        }
        roots.iter().map(|r| copy[r.index()].unwrap_or_else(|| self.expr(*r))).collect()
    }

    pub(crate) fn arena(&self) -> &RefCell<Arena> {
        &self.arena
    }

    pub(crate) fn into_arena(self) -> Arena {
        self.arena.into_inner()
    }
}

impl Arena {
    /// The node, made if it is new.
    pub(crate) fn insert(&mut self, node: Node) -> NodeId {
        let next = self.nodes.len() as u32;
        let id = *self.index.entry(node).or_insert(next);
        if id == next {
            self.nodes.push(node);
        }
        NodeId(id)
    }

    /// The node if it is there.
    pub(crate) fn find(&self, node: Node) -> Option<NodeId> {
        self.index.get(&node).map(|&id| NodeId(id))
    }

    /// The node of a number; −0 and 0 are one.
    pub(crate) fn number(&mut self, x: f64) -> u32 {
        let x = if x == 0.0 { 0.0 } else { x };
        let next = self.numbers.len() as u32;
        let index = *self.number_index.entry(x.to_bits()).or_insert(next);
        if index == next {
            self.numbers.push(x);
        }
        self.insert(Node::new(Op::Const, [index, 0, 0])).0
    }

    /// Value of one node from its operands' values.
    pub(crate) fn eval_node<S: Scalar>(&self, node: Node, inputs: &[S], get: impl Fn(u32) -> S) -> S {
        match node.op {
            Op::Const => S::constant(self.numbers[node.args[0] as usize]),
            Op::Input => inputs[node.args[0] as usize],
            Op::Powi => get(node.args[0]).powi(node.exponent()),
            Op::Spline => get(node.args[0]).spline(&self.splines[node.args[1] as usize], node.args[2] as u8),
            Op::Field => S::field(node.args.map(get), &self.fields[usize::from(node.field)], usize::from(node.part)),
            op => {
                let operand = |k: usize| if k < op.arity() { get(node.args[k]) } else { S::constant(0.0) };
                apply(op, operand(0), operand(1), operand(2))
            }
        }
    }
}
