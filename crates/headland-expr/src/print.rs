//! Printers (being written).
use crate::graph::{Graph, NodeId};
/// Text of a node.
pub fn text(graph: &Graph, id: NodeId) -> String {
    format!("{:?}", graph.node(id))
}
