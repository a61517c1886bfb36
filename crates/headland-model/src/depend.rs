//! [`Dependence`]: on which kinds of inputs an expression depends, found once for each node of the graph.

use headland_expr::{Expr, Graph, NodeId, Op};

/// A kind of input of the graph, as one bit.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Kinds(u8);

impl Kinds {
    /// Time.
    pub const TIME: Self = Self(1);
    /// Parameters.
    pub const PARAMETER: Self = Self(2);
    /// Coordinates.
    pub const COORDINATE: Self = Self(4);
    /// Their rates.
    pub const RATE: Self = Self(8);
    /// Quasi-velocities.
    pub const QUASI: Self = Self(16);
    /// Second rates of coordinates and rates of quasi-velocities.
    pub const ACCELERATION: Self = Self(32);
    /// Velocities of joints.
    pub const JOINT: Self = Self(64);
    /// Virtual displacements of joints and their rates, zero in the end.
    pub const VIRTUAL: Self = Self(128);

    /// Any of both.
    pub const fn or(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Everything else.
    pub const fn not(self) -> Self {
        Self(!self.0)
    }
}

/// The kind of each input, and of what each node depends on.
#[derive(Default, Debug)]
pub struct Dependence {
    inputs: Vec<Kinds>,
    nodes: Vec<u8>,
}

impl Dependence {
    /// A new input of the graph, of a kind.
    pub fn input(&mut self, graph: &Graph, name: &str, kind: Kinds) -> NodeId {
        debug_assert_eq!(self.inputs.len(), graph.input_count(), "every input is declared here");
        self.inputs.push(kind);
        graph.id(graph.input(name))
    }

    /// Whether an expression depends on an input of one of the kinds. Each node is looked at once in all.
    pub fn any(&mut self, e: Expr<'_>, kinds: Kinds) -> bool {
        let Expr::Node(graph, id) = e else { return false };
        for i in self.nodes.len()..graph.len() {
            let node = graph.node(graph.node_at(i));
            let mask = match node.op {
                Op::Input => self.inputs[node.args[0] as usize].0,
                _ => node.operands().fold(0, |mask, a| mask | self.nodes[a.index()]),
            };
            self.nodes.push(mask);
        }
        self.nodes[id.index()] & kinds.0 != 0
    }

    /// The name of an input of one of the kinds on which an expression depends.
    pub fn name(&mut self, e: Expr<'_>, kinds: Kinds) -> Option<String> {
        if !self.any(e, kinds) {
            return None;
        }
        let Expr::Node(graph, id) = e else { return None };
        let needed = graph.needed(&[id]);
        (0..graph.input_count())
            .find(|&i| {
                let there = needed.get(graph.input_id(i).index()).copied().unwrap_or(false);
                there && self.inputs[i].0 & kinds.0 != 0
            })
            .map(|i| graph.input_name(i))
    }
}
