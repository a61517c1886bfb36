//! Printers: expressions to text, LaTeX and C.
//!
//! Operators are written as their row of [`OPS`](crate::ops::OPS) says; only numbers, inputs, powers, splines and
//! branches are known here by name. Nothing recurses, and a shared operation is written once: a [`Listing`] names it.
//!
//! [`names`] styles names, `algebra` writes one expression as a page would have it, [`listing`](mod@listing)
//! lays out definitions, temporaries and results in order, [`c`] makes a compilable function of them.

mod algebra;
pub mod c;
pub mod listing;
pub mod names;

use std::borrow::Cow;

use rustc_hash::FxHashMap;

use crate::graph::{Graph, NodeId};

pub use c::{C_PRELUDE, c_file, c_function, c_tables};
pub use listing::{Listing, ListingOptions, listing};
pub use names::{c_name, latex_name};

/// The language of a printed expression.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Style {
    /// As in a scene file: it parses back.
    Text,
    /// LaTeX mathematics.
    Latex,
    /// C99, the operations in the order in which the graph evaluates them.
    C,
}

/// Nesting and bytes after which the text of a node is cut off.
const SHORT: Limits = Limits { depth: 24, length: 240 };
const UNLIMITED: Limits = Limits { depth: u32::MAX, length: usize::MAX };

/// Short text of a node, for messages; `…` stands for what was left out.
pub fn text(graph: &Graph, id: NodeId) -> String {
    Writer { graph, style: Style::Text, names: &FxHashMap::default(), limits: SHORT }.write(id)
}

/// All of a node as one expression. Shared operations are repeated: for large graphs, use [`listing`](fn@listing).
pub fn expression(graph: &Graph, style: Style, id: NodeId) -> String {
    Writer { graph, style, names: &FxHashMap::default(), limits: UNLIMITED }.write(id)
}

#[derive(Clone, Copy)]
struct Limits {
    depth: u32,
    length: usize,
}

/// Something left to write.
enum Task {
    Text(Cow<'static, str>),
    /// A node where at least strength `level` is needed; `unsigned`: its minus sign has been written.
    Node {
        id: NodeId,
        level: u8,
        unsigned: bool,
        depth: u32,
    },
}

impl Task {
    fn text(s: &'static str) -> Self {
        Task::Text(Cow::Borrowed(s))
    }
    fn owned(s: String) -> Self {
        Task::Text(Cow::Owned(s))
    }
}

/// Strengths beside those of the table (sums 1, products 2, signs 3).
const SUM: u8 = 1;
const PRODUCT: u8 = 2;
const PREFIX: u8 = 3;
const POWER: u8 = 4;
const ATOM: u8 = 5;

/// Writes expressions with an explicit stack; nodes in `names` are written by name.
struct Writer<'a> {
    graph: &'a Graph,
    style: Style,
    names: &'a FxHashMap<NodeId, String>,
    limits: Limits,
}

impl Writer<'_> {
    /// The definition of a node: itself not by its name.
    fn write(&self, id: NodeId) -> String {
        let mut text = String::new();
        let mut parts = Vec::new();
        let mut stack = vec![Task::Node { id, level: 0, unsigned: false, depth: 0 }];
        while let Some(task) = stack.pop() {
            if text.len() > self.limits.length {
                text.push('…');
                break;
            }
            match task {
                Task::Text(s) => text.push_str(&s),
                Task::Node { depth, .. } if depth > self.limits.depth => text.push('…'),
                Task::Node { id, level, unsigned, depth } => {
                    match self.style {
                        Style::C => self.expand_c(id, level, depth, &mut parts),
                        _ => self.expand_algebra(id, level, unsigned, depth, &mut parts),
                    }
                    stack.extend(parts.drain(..).rev());
                }
            }
        }
        text
    }

    /// The name of a node that has one; the node being defined (`depth` 0) has none.
    fn name(&self, id: NodeId, depth: u32) -> Option<&str> {
        if depth == 0 { None } else { self.names.get(&id).map(String::as_str) }
    }

    fn input_name(&self, index: usize) -> String {
        names::styled(self.style, &self.graph.input_name(index))
    }

    /// A number without its sign.
    fn number(&self, x: f64) -> String {
        let digits = format!("{:?}", x.abs());
        match self.style {
            Style::C if x.is_nan() => "NAN".into(),
            Style::C if x.is_infinite() => "INFINITY".into(),
            Style::C => digits,
            Style::Text => digits.strip_suffix(".0").map_or(digits.clone(), Into::into),
            Style::Latex => algebra::latex_number(x.abs()),
        }
    }
}

#[cfg(test)]
mod tests;
