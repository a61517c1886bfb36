//! [`JointTree`]: the joints of an assembly as links hung from each other, for the recursive algorithms.

use headland_expr::NodeId;

use crate::model::VectorNodes;

/// Links, parents first; each moves in its parent by the motion of one joint, or of a part of it.
#[derive(Clone, Debug, Default)]
pub struct JointTree {
    /// The links.
    pub links: Vec<Link>,
    /// Acceleration of free fall in the world.
    pub gravity: Option<VectorNodes>,
}

/// A rigid part of the tree, or a massless one between two motions of a joint.
#[derive(Clone, Debug)]
pub struct Link {
    /// The link that carries it; `None` is the world.
    pub parent: Option<usize>,
    /// Orientation of the joint's frame on the parent, by rows; `None` where the axes are parallel.
    pub rotation: Option<[VectorNodes; 3]>,
    /// Place of the joint's frame on the parent.
    pub position: VectorNodes,
    /// How it moves.
    pub motion: LinkMotion,
    /// Its coordinates, by position.
    pub q: Vec<usize>,
    /// Its velocities, by position among all velocities (rates of the coordinates, then quasi-velocities).
    pub u: Vec<usize>,
    /// Mass.
    pub mass: NodeId,
    /// Mass centre in the link's frame.
    pub centre: VectorNodes,
    /// Tensor about the mass centre in the link's axes: xx, yy, zz, xy, xz, yz.
    pub tensor: [NodeId; 6],
}

/// The motion of a link in its parent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LinkMotion {
    /// None.
    Fixed,
    /// Turn about a unit vector.
    Turn([f64; 3]),
    /// Shift along a unit vector.
    Slide([f64; 3]),
    /// Quaternion; angular velocity in the link's axes.
    Ball,
    /// Position, then quaternion; angular velocity in the link's axes, then rates of the position.
    Free,
}
