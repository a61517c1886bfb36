//! [`Listing`]: definitions, temporaries and results, each before what uses it.

use rustc_hash::{FxHashMap, FxHashSet};

use super::names::Names;
use super::{Style, UNLIMITED, Writer};
use crate::graph::{Graph, NodeId};
use crate::ops::Op;

/// Lines `name = expression`; what a line uses stands before it.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub struct Listing {
    /// Name and expression, as printed.
    pub lines: Vec<(String, String)>,
}

impl std::fmt::Display for Listing {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.lines.iter().try_for_each(|(name, expression)| writeln!(f, "{name} = {expression}"))
    }
}

/// When an operation is worth a line of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ListingOptions {
    /// A subexpression used more than once is named if it has at least so many operations (signs are free).
    pub shared: usize,
    /// One used once is named where the line would come to have more operations than this.
    pub longest: usize,
}

impl ListingOptions {
    /// What reads well in the given style; C names every shared operation.
    pub fn of(style: Style) -> Self {
        match style {
            Style::Text | Style::Latex => Self { shared: 3, longest: 60 },
            Style::C => Self { shared: 1, longest: 40 },
        }
    }
}

/// Prints `roots` with the definitions they need.
///
/// `named` are nodes that have a name: wherever one occurs below a line, its name is printed, and its definition stands
/// in the listing if a line uses it. Shared subexpressions become temporaries `x_1, x_2, …` (C: `w1, …`), another letter
/// where names of the graph begin with `x_`. Then come the roots, in the order given; one that another root uses is
/// named like a definition, stands among them, and is not repeated. Inputs and numbers keep their own name; a node named
/// twice goes by the first name.
pub fn listing(
    graph: &Graph,
    style: Style,
    roots: &[(String, NodeId)],
    named: &[(NodeId, String)],
    options: &ListingOptions,
) -> Listing {
    let ids: Vec<NodeId> = roots.iter().map(|(_, id)| *id).collect();
    let mut all = named.to_vec();
    all.extend(roots.iter().map(|(name, id)| (*id, name.clone())));
    let mut plan = Plan::new(graph, style, &ids, &all, options);
    let mut taken = std::mem::take(&mut plan.taken);
    let writer = Writer { graph, style, names: &plan.names, limits: UNLIMITED };
    let mut lines: Vec<_> = plan.steps.iter().map(|id| (plan.names[id].clone(), writer.write(*id))).collect();
    let mut printed: FxHashSet<NodeId> = plan.steps.iter().copied().collect();
    for (name, id) in roots {
        let first = all.iter().find(|(known, _)| known == id).is_some_and(|(_, first)| first == name);
        let is_operation = graph.node(*id).op.arity() > 0;
        if first && is_operation {
            if printed.insert(*id) {
                lines.push((plan.names[id].clone(), writer.write(*id)));
            }
        } else if is_operation && !printed.contains(id) {
            lines.push((taken.take(style, name), writer.write(*id)));
        } else {
            let value = plan.names.get(id).cloned().unwrap_or_else(|| writer.write(*id));
            lines.push((taken.take(style, name), value));
        }
    }
    Listing { lines }
}

/// What has a name, and which definitions stand in which order.
pub(super) struct Plan {
    pub(super) names: FxHashMap<NodeId, String>,
    /// Definitions by growing id, which is an order of evaluation.
    pub(super) steps: Vec<NodeId>,
    pub(super) taken: Names,
}

impl Plan {
    pub(super) fn new(
        graph: &Graph,
        style: Style,
        roots: &[NodeId],
        named: &[(NodeId, String)],
        options: &ListingOptions,
    ) -> Self {
        let mut taken = Names::default();
        let needed = graph.needed(roots);
        let (inner_uses, root_uses) = uses(graph, &needed, roots);
        let mut names = FxHashMap::default();
        for i in (0..needed.len()).filter(|&i| needed[i]) {
            let node = graph.node(NodeId(i as u32));
            if node.op == Op::Input {
                names.insert(NodeId(i as u32), taken.take(style, &graph.input_name(node.args[0] as usize)));
            }
        }
        let mut is_named = vec![false; needed.len()];
        for (id, name) in named {
            let known = id.index() < needed.len() && needed[id.index()] && !is_named[id.index()];
            if known && graph.node(*id).op.arity() > 0 {
                is_named[id.index()] = true;
                names.insert(*id, taken.take(style, name));
            }
        }
        let temporary = taken.temporaries(style);
        let mut is_step = vec![false; needed.len()];
        let mut is_temporary = vec![false; needed.len()];
        let mut size = vec![0usize; needed.len()]; // operations that a use would write; 0 behind a name
        for i in (0..needed.len()).filter(|&i| needed[i]) {
            let node = graph.node(NodeId(i as u32));
            let below: usize = node.operands().map(|a| size[a.index()]).sum();
            size[i] = below + usize::from(node.op.arity() > 0 && node.op != Op::Neg);
            if is_named[i] {
                is_step[i] = inner_uses[i] > 0;
                size[i] = 0;
                continue;
            }
            let shared = inner_uses[i] + root_uses[i] > 1 && size[i] >= options.shared;
            // Its base is written more than once, and would be evaluated as often.
            if style == Style::C && node.op == Op::Powi && size[node.args[0] as usize] > 0 {
                let base = node.args[0] as usize;
                (is_temporary[base], size[base], size[i]) = (true, 0, 1);
            }
            if node.op == Op::Neg && (shared || size[i] > options.longest) && size[i] > 0 {
                let inner = node.args[0] as usize; // the sign is repeated, not what it stands before
                (is_temporary[inner], size[inner], size[i]) = (true, 0, 0);
            } else if (shared || size[i] > options.longest && inner_uses[i] > 0) && size[i] > 0 {
                (is_temporary[i], size[i]) = (true, 0);
            }
        }
        let mut count = 0;
        for i in (0..needed.len()).filter(|&i| is_temporary[i]) {
            count += 1;
            names.insert(NodeId(i as u32), temporary(count));
            is_step[i] = true;
        }
        let steps = (0..needed.len()).filter(|&i| is_step[i]).map(|i| NodeId(i as u32)).collect();
        Self { names, steps, taken }
    }

    /// What a root's line says: its name if it has been defined, else its definition.
    pub(super) fn root(&self, writer: &Writer<'_>, id: NodeId) -> String {
        let is_input = writer.graph.node(id).op == Op::Input;
        match self.names.get(&id) {
            Some(name) if is_input || self.steps.binary_search(&id).is_ok() => name.clone(),
            _ => writer.write(id),
        }
    }
}

/// How often each node is an operand of a needed one, and how often it is a root.
fn uses(graph: &Graph, needed: &[bool], roots: &[NodeId]) -> (Vec<u32>, Vec<u32>) {
    let mut inner = vec![0u32; needed.len()];
    let mut root = vec![0u32; needed.len()];
    for i in (0..needed.len()).filter(|&i| needed[i]) {
        for operand in graph.node(NodeId(i as u32)).operands() {
            inner[operand.index()] = inner[operand.index()].saturating_add(1);
        }
    }
    for id in roots {
        root[id.index()] += 1;
    }
    (inner, root)
}
